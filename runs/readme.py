"""The generated parts of the README files.

    python -m runs.readme NAME       print one part
    python -m runs.readme --write    remake all parts in their files

A part stands between `<!-- begin: python -m runs.readme NAME -->` and `<!-- end -->`. Everything outside of these
markers is written by hand. The parts are made of the keys, the catalogue of effects and the stored reports of the
studies; nothing is computed.
"""

import re
import sys
from pathlib import Path

from fvcollapse.errors import FvcollapseError, InputError
from fvcollapse.files.atomic import write_atomic
from runs.readme_acceptance import (
    matrix_says,
    random_cases,
    refinement,
    refinement_says,
    runouts,
)
from runs.readme_blind import blind_scores
from runs.readme_comparison import bars, bars_say, steady_front, steady_front_says
from runs.readme_convergence import axes, convergence, convergence_says
from runs.readme_cost import cost_of_cases, cost_of_effects, cost_of_sweeps, cost_shares
from runs.readme_facts import beds, facts, finer, grid, grid_rises, grid_says, grid_ways
from runs.readme_keys import case_keys, effects, experiment_keys, priors
from runs.readme_losses import confusion, losses
from runs.readme_next import held_out, next_experiments, next_kinds
from runs.readme_opened import opened_cases
from runs.readme_paper import statements_by_verdict
from runs.readme_particles import (
    cohesion,
    packings,
    shape,
    shape_says,
    validation,
)
from runs.readme_reports import (
    cross_code,
    cross_code_precision,
    diagnosis_example,
    laboratories,
    laboratory_columns,
    verification,
)
from runs.readme_stamps import made_by
from runs.readme_thin_layers import rule, thin_layers
from runs.readme_trust import trust
from runs.readme_walls import mobilised, mobilised_says, walls, walls_say

ROOT = Path(__file__).parents[1]
COMMAND = "python -m runs.readme"
PARTS = {
    "keys": case_keys,
    "experiment-keys": experiment_keys,
    "effects": effects,
    "priors": priors,
    "trust": trust,
    "verification": verification,
    "example": diagnosis_example,
    "blind": blind_scores,
    "blind-losses": losses,
    "blind-confusion": confusion,
    "blind-next": next_experiments,
    "blind-next-kinds": next_kinds,
    "blind-held-out": held_out,
    "cost": cost_of_cases,
    "cost-shares": cost_shares,
    "cost-sweeps": cost_of_sweeps,
    "cost-effects": cost_of_effects,
    "runouts": runouts,
    "acceptance": matrix_says,
    "acceptance-grid": refinement,
    "acceptance-grid-says": refinement_says,
    "acceptance-random": random_cases,
    "convergence": convergence,
    "convergence-says": convergence_says,
    "convergence-axes": axes,
    "bars": bars,
    "bars-say": bars_say,
    "steady-front": steady_front,
    "steady-front-says": steady_front_says,
    "facts": facts,
    "facts-finer": finer,
    "facts-beds": beds,
    "facts-grid": grid,
    "facts-grid-says": grid_says,
    "facts-grid-rises": grid_rises,
    "facts-grid-ways": grid_ways,
    "particles-opened": opened_cases,
    "particles-validation": validation,
    "particles-thin-layers": thin_layers,
    "particles-rule": rule,
    "particles-walls": walls,
    "particles-walls-say": walls_say,
    "particles-mobilised": mobilised,
    "particles-mobilised-says": mobilised_says,
    "particles-shape": shape,
    "particles-shape-says": shape_says,
    "particles-cohesion": cohesion,
    "particles-packings": packings,
    "stamps": made_by,
    "laboratory-columns": laboratory_columns,
    "paper": statements_by_verdict,
    "laboratories": laboratories,
    "cross-code": cross_code,
    "cross-code-precision": cross_code_precision,
}
PART = re.compile(r"<!-- begin: (?P<command>[^\n]*) -->\n(?P<body>.*?)<!-- end -->\n", re.DOTALL)


def readmes():
    """Paths of the README files of the repository."""
    below = [path for name in ("fvcollapse", "runs") for path in (ROOT / name).rglob("README.md")]
    return [ROOT / "README.md", *sorted(below)]


def parts_of(text):
    """The generated parts of a text, as (command, body) in their order."""
    return [(match["command"], match["body"]) for match in PART.finditer(text)]


def part(command):
    """The body of the part that a command makes.

    Raises
    ------
    InputError
        No part is made by this command.
    """
    name = command.removeprefix(f"{COMMAND} ")
    if name not in PARTS:
        raise InputError("command line", "NAME", name, "one of " + ", ".join(PARTS))
    return PARTS[name]()


def remade(text):
    """A text with all its parts made again."""

    def replace(match):
        body = part(match["command"])
        return f"<!-- begin: {match['command']} -->\n{body}<!-- end -->\n"

    return PART.sub(replace, text)


def main(arguments):
    """Print one part, or remake all of them; return the exit status."""
    try:
        if arguments == ["--write"]:
            for path in readmes():
                old = path.read_text(encoding="utf-8")
                new = remade(old)
                if new != old:
                    write_atomic(path, new.encode())
                    print(path.relative_to(ROOT))
        else:
            print(part(" ".join(arguments)), end="")
    except FvcollapseError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
