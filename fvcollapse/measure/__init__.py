"""What is measured: observables of a run, curves of an experiment, and both side by side."""
