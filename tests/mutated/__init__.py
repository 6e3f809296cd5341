"""Inputs that are wrong in every way that a fixed seed draws, for all that reads a file or a line.

values    numbers, words and texts that break readers
text      mutations of bytes, lines, CSV cells, TOML values and JSON trees
hdf5      mutations of HDF5 files: types, shapes, values, links, storage
seeds     one valid input of every kind
oracle    what is physically impossible, independent of the checks of the package
suites    kind of input -> how it is mutated, read and judged
"""
