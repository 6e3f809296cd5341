"""The terminal: what is printed, and what a signal does."""
