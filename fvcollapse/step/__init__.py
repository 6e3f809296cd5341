"""One time step: one file per term of the balance; see `fvcollapse.simulation` for their order."""
