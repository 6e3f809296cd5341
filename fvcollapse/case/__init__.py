"""What is to be run: the case file, its keys, sections and rules."""
