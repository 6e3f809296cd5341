"""All verification problems, by group; a new group is one more line here."""

from fvcollapse.verification.problems import (
    box as problems_box,
)
from fvcollapse.verification.problems import (
    chutes as problems_chutes,
)
from fvcollapse.verification.problems import (
    collapse as problems_collapse,
)
from fvcollapse.verification.problems import (
    growth as problems_growth,
)
from fvcollapse.verification.problems import (
    manufactured as problems_manufactured,
)
from fvcollapse.verification.problems import (
    motion as problems_motion,
)
from fvcollapse.verification.problems import (
    steady as problems_steady,
)
from fvcollapse.verification.problems import (
    surface as problems_surface,
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
