"""The module of an effect to fill in."""

import keyword

from fvcollapse.effects.catalogue import NAMES
from fvcollapse.errors import InputError

TEXT = '''"""{words}: what it is, in one line (the case file, the report and `fvcollapse keys` show it).

Equation: write it down here, with every symbol and its unit.
Limits: where it does not hold.
Sources: Author (year), Journal volume, page.
"""

from typing import TYPE_CHECKING, Annotated

from msgspec.structs import replace

from fvcollapse.case.grammar import Section, key
from fvcollapse.effects.effect import PHYSICAL, Effect, Prior, with_section

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


class {title}(Section):
    """{words}: what it is, in one line."""

    # one line per key: unit, meaning, range; the default is zero strength, with which nothing changes
    strength: Annotated[float, key("-", "added to rheology.mu_1 and mu_2", ge=0, le=1)] = 0.0


def change(case: "Case", section: {title}) -> "Case":
    """The case that the solver runs, with the effect put into the keys that it changes.

    This example adds to the friction of the grains. An effect that no key can express has a module of stage functions
    in fvcollapse/step (`term="<module>"` below); one that changes only what is seen has `see=Seeing(...)`.
    """
    law = case.rheology
    law = replace(law, mu_1=law.mu_1 + section.strength, mu_2=law.mu_2 + section.strength)
    return with_section(replace(case, rheology=law), "{name}", None)


EFFECT = Effect(
    "{name}",
    PHYSICAL,
    {title},
    # what is known of each key before any experiment: the form, its two numbers, a grade and the source (see Prior)
    priors={{"strength": Prior("uniform", 0.0, 0.1, "C", "a guess: replace it by a source")}},
    # keys of a case whose calibration may already hold the effect
    absorbed_in=("rheology.mu_1",),
    change=change,
)
'''


def effect_template(name: str) -> str:
    """The text of `<name>.py`, an effect that changes one key of the case.

    Raises
    ------
    InputError
        The name is none of a Python module, or taken.
    """
    allowed = "a name of small letters, digits and _ that begins with a letter and is not yet in the catalogue"
    is_name = name.isascii() and name.isidentifier() and name == name.lower()
    if not is_name or name.startswith("_") or keyword.iskeyword(name) or name in NAMES:
        found = f"{name!r}" + (", which is taken" if name in NAMES else "")
        raise InputError("command line", "NAME", found, allowed)
    words = name.replace("_", " ").capitalize()
    return TEXT.format(name=name, words=words, title=name.title().replace("_", ""))
