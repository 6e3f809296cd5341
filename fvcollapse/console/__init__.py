"""Log, progress bar and signals."""
