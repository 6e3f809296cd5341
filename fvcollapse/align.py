"""Public name of `fvcollapse.measure.align`: simulated values on the measured points."""

from fvcollapse.measure.align import align as align
