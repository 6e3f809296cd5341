"""Many runs: workers, the cache of runs, sweeps, convergence studies, benchmarks."""
