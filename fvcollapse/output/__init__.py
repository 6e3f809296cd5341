"""Output of a run: series, profiles and fields, checkpoint, result file."""
