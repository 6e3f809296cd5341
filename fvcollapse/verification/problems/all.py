"""All verification problems, by group; a new group is a name in both lists, a new problem one in `names.py`."""

from fvcollapse.verification.problems import (
    adhesion,
    box,
    chutes,
    collapse,
    growth,
    manufactured,
    motion,
    steady,
    surface,
    thin_layers,
)

GROUPS = (
    steady,
    motion,
    chutes,
    thin_layers,
    adhesion,
    box,
    manufactured,
    surface,
    collapse,
    growth,
)
PROBLEMS = tuple(problem for group in GROUPS for problem in group.PROBLEMS)
