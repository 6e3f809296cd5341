"""Tables of keys and effects for the README files, made of what the program knows."""

import inspect
from typing import get_args

import msgspec

from fvcollapse.case.case import Case
from fvcollapse.case.case import describe_keys as describe_case_keys
from fvcollapse.effects.catalogue import CATALOGUE, NUISANCE, OBSERVATION
from fvcollapse.measure.experiment_keys import describe_keys as describe_experiment_keys
from runs.readme_tables import table

KIND = {OBSERVATION: " (observation)", NUISANCE: " (error of the set-up)"}


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


def sections():
    """{name: section class} of `[effects]`, in the order of the case file."""
    effects = type(Case().effects)
    types = {field.name: field.type for field in msgspec.structs.fields(effects)}
    return {name: (get_args(kind) or (kind,))[0] for name, kind in types.items()}


def effects():
    """The catalogue: what each effect changes, and its parameters."""
    classes = sections()
    rows = []
    for name, effect in CATALOGUE.items():
        keys = [info for info in msgspec.structs.fields(classes[name])]
        meaning = inspect.cleandoc(classes[name].__doc__).splitlines()[0]
        parameters = ", ".join(f"`{key.name}`" for key in keys)
        rows.append((f"`{name}`{KIND.get(effect.kind, '')}", meaning, parameters))
    return table(("section", "meaning", "keys"), rows)


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
