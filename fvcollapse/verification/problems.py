"""All verification problems, by group; a new group is one more line here."""

from fvcollapse.verification import (
    problems_box,
    problems_chutes,
    problems_collapse,
    problems_growth,
    problems_manufactured,
    problems_motion,
    problems_steady,
    problems_surface,
)

GROUPS = (
    problems_steady,
    problems_motion,
    problems_chutes,
    problems_box,
    problems_manufactured,
    problems_surface,
    problems_collapse,
    problems_growth,
)
PROBLEMS = tuple(problem for group in GROUPS for problem in group.PROBLEMS)
