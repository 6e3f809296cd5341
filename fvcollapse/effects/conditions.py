"""Conditions that several effects share: what a case must be for them to act in it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fvcollapse.case.grammar import show

if TYPE_CHECKING:
    from fvcollapse.case.case import Case


def needs_friction(case: "Case", name: str) -> Iterator[tuple[str, str, str]]:
    """Refuse an effect on the friction coefficient where the law has none, or the solve is not the coupled one."""
    method, law = case.numerics.method, case.rheology.law
    if method != "coupled":
        yield "numerics.method", show(method), f'"coupled" with effects.{name}'
    if law not in ("mu_I", "drucker_prager"):
        yield "rheology.law", show(law), f'"mu_I" or "drucker_prager" with effects.{name}'
