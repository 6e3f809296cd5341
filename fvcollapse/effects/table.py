"""The catalogue as a table in Markdown, for `effects/README.md`."""

from fvcollapse.case.grammar import Section, key_metas
from fvcollapse.effects.catalogue import CATALOGUE
from fvcollapse.effects.effect import NUISANCE, OBSERVATION, PHYSICAL, Effect

KINDS = {
    PHYSICAL: "changes the flow",
    OBSERVATION: "changes what is seen",
    NUISANCE: "error of the set-up",
}
LETTERS = {"uniform": "U", "loguniform": "L", "normal": "N", "halfnormal": "H"}


def catalogue_table() -> str:
    """A row for each effect: section, kind, keys with their units and priors, keys that hide it, meaning."""
    lines = [
        "| section | kind | keys, unit: prior (grade) | may hide in | meaning |",
        "|---|---|---|---|---|",
    ]
    for name, effect in CATALOGUE.items():
        section: type[Section] = effect.section
        keys = "; ".join(key_words(effect, key) for key in section.__struct_fields__)
        hidden = ", ".join(f"`{key}`" for key in effect.absorbed_in) or "–"
        meaning = (section.__doc__ or "").splitlines()[0].rstrip(".")
        row = (f"[`{name}`]({name}.py)", KINDS[effect.kind], keys, hidden, meaning)
        lines.append(f"| {' | '.join(row)} |")
    return "\n".join(lines)


def key_words(effect: Effect, key: str) -> str:
    """A key of an effect with its unit, and its prior if it has one."""
    unit = key_metas(effect.section)[key].extra["unit"]
    words = f"`{key}`" + ("" if unit == "-" else f" {unit}")
    prior = effect.priors.get(key)
    if prior is None:
        return words
    return f"{words}: {LETTERS[prior.kind]}({prior.first:g}, {prior.second:g}) ({prior.grade})"
