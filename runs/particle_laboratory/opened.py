"""The thirteen cases whose causes are told by now, diagnosed with the present verdict layer: opened.csv.

Their causes were withheld when `blind` answered them, and those answers stand. Since then they have taught closures and
priors. So these answers show what a change of the diagnosis does to cases that are well known, and test nothing.
"""

import json

from fvcollapse import diagnose
from fvcollapse.errors import InputError
from runs.study import refuse
from runs.table import write_table

LABELS = "opened.json"


def opened(arguments, baseline, controls):
    """Diagnose each case with the controls, and write the answers beside the causes.

    Parameters
    ----------
    arguments : argparse.Namespace
        Options of the study; --data holds `blind/` and the file of the causes.
    baseline : Path
        What is believed.
    controls : callable
        Of the folder of data: the experiments in which nothing is hidden.
    """
    causes, taught, rows = read_causes(arguments.data), controls(arguments.data), []
    for name, cause in causes.items():
        report = diagnose(
            [arguments.data / "blind" / name],
            baseline,
            workers=arguments.workers,
            folder=arguments.out / "opened" / name,
            cell_size=arguments.cell_size,
            controls=taught,
            cache=arguments.cache,
            quiet=False,
        )
        rows.append({"case": name, "cause": cause} | row_of(report.verdict, cause))
        print("  ".join(f"{key} {value}" for key, value in rows[-1].items()), flush=True)
        write_table(arguments.tables / "opened.csv", rows)


def read_causes(data):
    """{case: cause} of the file of the causes.

    Raises
    ------
    InputError
    """
    path = data / LABELS
    if not path.is_file():
        refuse("--data", f"{data}", f"a folder with {LABELS}, the causes of its blind cases")
    try:
        labels = json.loads(path.read_text(encoding="utf-8"))
        return {name: str(label["truth"]) for name, label in labels.items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        found = f"no causes ({type(error).__name__})"
        raise InputError(path, "file", found, '{case: {"truth": cause}}') from None


def row_of(verdict, cause):
    """What a verdict says, beside the true cause."""
    ranked = sorted(verdict.probability.items(), key=lambda item: -item[1])
    names = [name for name, _ in ranked]
    (first, chance), (second, _) = ranked[:2]
    return {
        "first": first,
        "probability": round(chance, 3),
        "second": second,
        "rank_of_cause": names.index(cause) + 1 if cause in names else "",
        "probability_of_cause": round(verdict.probability.get(cause, 0.0), 3),
        "in_the_set": cause in verdict.set,
        "names_in_set": len(verdict.set),
    }
