"""The console: progress bars, what is printed, and what a signal does."""
