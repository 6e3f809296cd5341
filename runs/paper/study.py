"""The paper, figure by figure: run every case, write the tables and the statements.

    python -m runs.paper.study [PART …] [--workers 2] [--cell-size 0.006]

A part is a group of cases; default all. The runs stay below --out. The tables, `runs/paper/<group>/*.csv`, are
written from them at the end, then `statements.csv` and `statements.md`. The figures follow from the tables:
`python -m plots.paper`. Give another --out after a change of the solver.
"""

import multiprocessing
import sys
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from functools import partial

from tqdm import tqdm

from runs.paper import statements
from runs.paper.cases import GROUPS, SENSITIVITIES, runs
from runs.paper.members import rows_of_run
from runs.study import Study, run_in_folders
from runs.study import main as call
from runs.table import CURVE, CURVES, LABELS, RUN, SCALARS, write_table


def do_groups(options):
    """Run the groups that are asked for, and write all that follows; return a line for each missing run."""
    wanted = runs(options.parts, options.cell_size)
    run_in_folders({options.out / run: about[-1] for run, about in wanted.items()}, options.workers)
    missing = write_tables(wanted, options)
    statements.main(options.tables)
    return missing


def write_tables(wanted, options):
    """Write the tables of the groups; return a line for each run that is missing."""
    missing, of_group = [], {}
    found = extracted(wanted, options.out, options.workers)
    for (group, *_), (row, lines, problem) in zip(wanted.values(), found, strict=True):
        if problem:
            missing.append(problem)
            continue
        numbers, curves = of_group.setdefault(group, ([], []))
        numbers.append(row)
        curves += lines
    for group, (numbers, curves) in of_group.items():
        write_table(options.tables / group / SCALARS, numbers)
        write_table(options.tables / group / CURVES, curves, (*RUN, *CURVE))
        if group == "sensitivity":
            write_labels(options.tables / group / LABELS)
    return missing


def write_labels(path):
    """Write what each case of the sensitivities changes, in words."""
    rows = (
        {"case": f"{name}_a22_winf", "label": words} for name, (words, _) in SENSITIVITIES.items()
    )
    write_table(path, rows)


def extracted(wanted, out, workers):
    """What `rows_of_run` gives for each run, in their order, with a bar."""
    jobs = [(out / run, *about) for run, about in wanted.items()]
    with ExitStack() as stack:
        bar = stack.enter_context(tqdm(total=len(jobs), unit="table row"))
        over = map
        if workers > 1:
            pool = ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"))
            over = stack.enter_context(pool).map
        for found in over(rows_of_run, jobs):
            bar.update()
            yield found


STUDY = Study(
    "paper",
    __doc__,
    GROUPS,
    uses=("cell_size",),
    cell_size=0.006,
    all_parts=True,
    together=do_groups,
)
main = partial(call, STUDY)


if __name__ == "__main__":
    sys.exit(main())
