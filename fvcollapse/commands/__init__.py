"""The command line: one file per command, each with its arguments and what it calls."""
