"""Remake the tables and figures that a change of the solver has made stale.

    python -m runs.remake --list                        what is of the present solver, and what each costs
    python -m runs.remake [--data FOLDER]               remake all that is not, the cheap and the important first
    python -m runs.remake --only acceptance "paper statements"

`--only` takes names of tasks, or their beginnings. `--data` is the folder of the published data; without it the tasks
that need it are passed over and named. Runs and unfinished tables stay below `out/remake/<solver>`, so that the same
command goes on after an interruption, and a changed solver begins anew. A table replaces the committed one when it is
finished; its stamp goes to `runs/stamps.json`.
"""

import argparse
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

from fvcollapse.errors import FvcollapseError, InputError
from fvcollapse.output.fingerprint import solver_version
from runs.remake_tasks import TASKS
from runs.stamps import PRESENT, ROOT, digest_of_all, read_stamps, state, write_stamps
from runs.study import refuse

CPU = "cpu_s.txt"


# -- what there is -------------------------------------------------------------------------------


def files_of(patterns, root=ROOT):
    """Paths below the repository that match, sorted; a pattern without a match stands for itself."""
    found = []
    for pattern in patterns:
        matching = [str(path.relative_to(root)) for path in root.glob(pattern)]
        found += sorted(matching) or [pattern]
    return found


def stamp_now(task, root=ROOT):
    """What the stamp of a task says if it is made today."""
    if not task.reads:
        return {"solver": solver_version(task.effects)}
    read = [name for name in files_of(task.reads, root) if (root / name).is_file()]
    return {"tables": digest_of_all(root, read)}


def states(task, tasks=TASKS, root=ROOT):
    """{file: state} of what a task makes; a file that follows from a stale table is stale."""
    now = stamp_now(task, root)
    found = {name: state(root, name, now) for name in files_of(task.makes, root)}
    if task.reads and not all(fresh(of, tasks, root) for of in made_from(task, tasks, root)):
        return {name: "stale" if of == PRESENT else of for name, of in found.items()}
    return found


def fresh(task, tasks, root):
    """Whether all that a task makes is of the present solver."""
    return set(states(task, tasks, root).values()) == {PRESENT}


def made_from(task, tasks, root):
    """The tasks that make what a task reads."""
    read = set(files_of(task.reads, root))
    return [of for of in tasks if of is not task and read & set(files_of(of.makes, root))]


def lines(tasks, everything=TASKS, root=ROOT):
    """The lines of `--list`: state, file, task and its cost."""
    stamps = read_stamps(root)
    for task in tasks:
        for name, found in states(task, everything, root).items():
            measured = stamps.get(name, {}).get("cpu_s")
            spent = f"{measured:.0f} CPU s" if measured else f"about {task.cpu_s:.0f} CPU s"
            data = ", needs --data" if task.needs_data else ""
            yield f"{found:<23} {name}  ({task.name}: {spent}{data})"


# -- remaking ------------------------------------------------------------------------------------


def remake(task, options, tasks=TASKS, root=ROOT):
    """Run a task, replace the files that it makes, and stamp them; a line if it did not succeed."""
    if task.needs_data and options.data is None:
        return f"{task.name}: needs --data"
    place = root / "out" / "remake" / solver_version()
    tables = place / "tables"
    for pattern in task.makes if not task.reads else ():
        (tables / pattern.removeprefix("runs/")).parent.mkdir(parents=True, exist_ok=True)
    lacking = prepare(task, tables, tasks, root)
    if lacking:
        return f"{task.name}: needs {', '.join(lacking)}"
    status = call(task, place, tables, options, root)
    if status:
        return f"{task.name}: exit status {status}; the same command goes on"
    made = files_of(task.makes, root) if task.reads else installed(task, tables, root)
    if not made:
        return f"{task.name}: made none of {', '.join(task.makes)}"
    about = stamp_now(task, root)
    if not task.reads:
        about |= {"code": solver_version(), "cpu_s": spent(place, task)}
    write_stamps(root, made, about)
    return ""


def prepare(task, tables, tasks, root):
    """Put the tables that a task reads beside those that it makes; the names of tasks that have to be done first."""
    before = [of for of in tasks if of.name in task.after]
    lacking = [of.name for of in before if not fresh(of, tasks, root)]
    if lacking:
        return lacking
    for name in (name for of in before for name in files_of(of.makes, root)):
        target = tables / name.removeprefix("runs/")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(root / name, target)
    return []


def call(task, place, tables, options, root):
    """Run the command of a task, and add its CPU time to that of earlier calls; its exit status."""
    values = {"out": place, "tables": tables, "data": options.data, "workers": options.workers}
    command = [part.format(**values) for part in task.command]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = os.environ | {"PYTHONPATH": str(root)}
    try:
        done = subprocess.run([sys.executable, "-m", *command], cwd=root, env=environment)
    finally:
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        more = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        path = cpu_file(place, task)
        total = spent(place, task) + more
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"{total:.3f}\n", encoding="utf-8")
    return done.returncode


def cpu_file(place, task):
    """Where the CPU time of a task is kept."""
    return place / "cost" / task.name.replace(" ", "_")[:80] / CPU


def spent(place, task):
    """CPU time that a task has taken so far [s]."""
    path = cpu_file(place, task)
    return float(path.read_text(encoding="utf-8")) if path.exists() else 0.0


def installed(task, tables, root):
    """Copy what a task has made to where it belongs; the paths below the repository."""
    names = []
    for pattern in task.makes:
        for path in sorted(tables.glob(pattern.removeprefix("runs/"))):
            name = f"runs/{path.relative_to(tables)}"
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, root / name)
            names.append(name)
    return names


# -- the call ------------------------------------------------------------------------------------


def parse(arguments):
    """The options of a call, checked.

    Raises
    ------
    InputError
    """
    parser = argparse.ArgumentParser(
        prog="python -m runs.remake", description=__doc__.split("\n")[0]
    )
    parser.add_argument("--list", action="store_true", help="say what is stale; run nothing")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="tasks, or beginnings of names")
    parser.add_argument("--data", type=Path, metavar="FOLDER", help="the published data")
    parser.add_argument("--workers", type=int, default=2, metavar="N", help="processes; default 2")
    options = parser.parse_args(arguments)
    if options.workers < 1:
        refuse("--workers", f"{options.workers}", "a whole number >= 1")
    if options.data is not None:
        if not options.data.is_dir():
            refuse("--data", f"{options.data}", "a folder")
        options.data = options.data.absolute()
    for name in options.only or ():
        if not any(task.name.startswith(name) for task in TASKS):
            raise InputError("command line", "--only", name, ", ".join(task.name for task in TASKS))
    return options


def chosen(options):
    """The tasks that are asked for, in their order."""
    return [
        task
        for task in TASKS
        if options.only is None or any(task.name.startswith(name) for name in options.only)
    ]


def main(arguments=None):
    """List or remake; return the exit status: 0 done, 1 something is not made, 2 bad input, 130 interrupted."""
    try:
        options = parse(arguments)
        if options.list:
            print(*lines(chosen(options)), sep="\n")
            return 0
        problems = []
        for task in chosen(options):
            if not fresh(task, TASKS, ROOT):
                print(f"{task.name} …", flush=True)
                problems.append(remake(task, options))
    except FvcollapseError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("interrupted; the same command goes on", file=sys.stderr)
        return 130
    for problem in filter(None, problems):
        print(problem, file=sys.stderr)
    return 1 if any(problems) else 0


if __name__ == "__main__":
    sys.exit(main())
