"""The verification problems, by group."""
