"""Tables of keys and effects for the README files, made of what the program knows."""

from fvcollapse.case.case import describe_keys as describe_case_keys
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.table import catalogue_table
from fvcollapse.measure.experiment_keys import describe_keys as describe_experiment_keys
from runs.readme_tables import table


def key_rows(infos):
    """Rows of a table of keys."""
    for info in infos:
        yield f"`{info.name}`", f"`{info.default}`", info.unit, info.description, info.allowed


def case_keys():
    """All keys of a case file."""
    return table(
        ("key", "default", "unit", "meaning", "allowed"), list(key_rows(describe_case_keys()))
    )


def experiment_keys():
    """All keys of `experiment.toml`."""
    rows = list(key_rows(describe_experiment_keys()))
    return table(("key", "default", "unit", "meaning", "allowed"), rows)


def effects():
    """The catalogue: what each effect changes, its keys and priors."""
    return catalogue_table() + "\n"


def priors():
    """The prior of every parameter, with its grade and source."""
    units = {info.name: info.unit for info in describe_case_keys()}
    rows = []
    for name, effect in CATALOGUE.items():
        for key, prior in effect.priors.items():
            unit = units[f"effects.{name}.{key}"]
            rows.append((f"`{name}`", f"`{key}`", unit, spread(prior), prior.grade, prior.source))
    return table(("effect", "parameter", "unit", "prior", "grade", "source"), rows)


def spread(prior):
    """A prior in short: U uniform, L log-uniform, N(mean, standard deviation), H half-normal."""
    first, second = f"{prior.first:g}", f"{prior.second:g}"
    return {
        "uniform": f"U {first} to {second}",
        "loguniform": f"L {first} to {second}",
        "normal": f"N({first}, {second})",
        "halfnormal": f"H {second}",
    }[prior.kind]
