"""Parts of a report: how it was made, and what nobody measured."""

from fvcollapse.diagnosis.report.parts import Part


class Made(Part):
    """How a report was made.

    Attributes
    ----------
    command : str
        A command line that asks the same question.
    date : str
        Of the end of the diagnosis, ISO 8601 with the offset from UTC.
    version, solver : str
        Of the program, and of the solver with a digest of its sources.
    """

    command: str
    date: str
    version: str
    solver: str


class Assumption(Part):
    """A value that a diagnosis took although an experiment does not state it.

    Attributes
    ----------
    experiment, key : str
        Name of the experiment, key of the case.
    value, units : str
        As the case file has it.
    meaning : str
        One line.
    source : str
        "the case file", "absent means so", "default of the program", or the reason of an `Assumed`.
    """

    experiment: str
    key: str
    value: str
    units: str
    meaning: str
    source: str


class RunGroup(Part):
    """The runs of one experiment for one purpose; those that failed are among `runs`."""

    experiment: str
    purpose: str
    runs: int
    cached: int
    failed: int
