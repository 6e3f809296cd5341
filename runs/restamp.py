"""Mark tables and answers as of the present solver, after a change of its code that gives the same numbers bit by bit.

    python -m runs.blind.study restamp --note NOTE
    python -m runs.restamp SOLVER --diagnosis DIGEST --note NOTE

The first command marks the verdict layers. The second marks what SOLVER made (`code` in `stamps.json`); tables of any
other solver stay as they are, and figures follow from tables. DIGEST is that of the diagnosis before the first
command, as `made_with` in the answers names it. NOTE says how it was shown that both solvers give the same numbers; it
stays in the stamps, with the version before.
"""

import argparse
import json
import sys

from fvcollapse.errors import FvcollapseError
from fvcollapse.files.atomic import write_atomic
from fvcollapse.output.fingerprint import solver_version
from runs.cross_code.study import DIAGNOSIS, digest_of
from runs.remake import files_of
from runs.remake_tasks import TASKS
from runs.stamps import ROOT, keep_stamps, read_stamps
from runs.study import refuse

ANSWERS = ("runs/cross_code/answers.json", "runs/laboratories/answers.json")
REPORTS = ("runs/example/report.json", "runs/particle_laboratory/labelled/*/report.json")


def restamped(stamps, before, note, tasks=TASKS, root=ROOT):
    """The stamps, those of the tables that the solver `before` made as of the present one."""
    done = dict(stamps)
    for task in (task for task in tasks if not task.reads):
        now = {"solver": solver_version(task.effects), "code": solver_version()}
        for name in files_of(task.makes, root):
            if stamps.get(name, {}).get("code") == before:
                history = [*stamps[name].get("restamped", []), {"from": before, "note": note}]
                done[name] = stamps[name] | now | {"restamped": history}
    return done


def restamp_answers(path, before, diagnosis):
    """Mark the answers in a file that `before` gave; of the present diagnosis too where theirs had this digest."""
    answers = json.loads(path.read_text(encoding="utf-8"))
    for made_with in (answer["made_with"] for answer in answers.values()):
        if made_with["solver"] == before:
            made_with["solver"] = solver_version()
            if made_with["diagnosis"] == diagnosis:
                made_with["diagnosis"] = digest_of(DIAGNOSIS)
    write_atomic(path, (json.dumps(answers, indent=1) + "\n").encode())


def restamp_report(path, before):
    """Name the present solver in a report that names `before`."""
    text = path.read_text(encoding="utf-8")
    write_atomic(path, text.replace(f'"{before}"', f'"{solver_version()}"').encode())


def main(arguments=None):
    """Restamp; return the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m runs.restamp", description=__doc__.split("\n")[0]
    )
    parser.add_argument("before", metavar="SOLVER", help="the solver that made them")
    parser.add_argument("--diagnosis", metavar="DIGEST", help="that of the diagnosis before")
    parser.add_argument(
        "--note", default="", help="how it was shown that both give the same numbers"
    )
    options = parser.parse_args(arguments)
    try:
        stamps = read_stamps()
        known = {stamp["code"] for stamp in stamps.values() if "code" in stamp}
        if options.before not in known:
            refuse("SOLVER", options.before, ", ".join(sorted(known)))
        if not options.note.strip():
            refuse("--note", "none", "why both solvers give the same numbers")
    except FvcollapseError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    done = restamped(stamps, options.before, options.note.strip())
    for name in ANSWERS:
        restamp_answers(ROOT / name, options.before, options.diagnosis)
    for name in files_of(REPORTS):
        restamp_report(ROOT / name, options.before)
    # last: SOLVER is known as long as they name it, so that a call that was cut short can be made again
    keep_stamps(ROOT, done)
    return 0


if __name__ == "__main__":
    sys.exit(main())
