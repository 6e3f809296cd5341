"""What a run leaves behind: series, profiles and fields, checkpoint, result file."""
