"""One time step: one file per term of the balance; `advance` has their order."""
