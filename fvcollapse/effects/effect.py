"""An effect as plain data: what it acts on, its keys, and what is known of their values.

The file `effects/<name>.py` describes an effect and ends with its `EFFECT`; the catalogue lists the names.
"""

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec.structs import replace

if TYPE_CHECKING:
    from scipy.stats.distributions import rv_frozen

    from fvcollapse.case.case import Case
    from fvcollapse.case.grammar import Section

PHYSICAL, OBSERVATION, NUISANCE = "physical", "observation", "nuisance"


class Prior(NamedTuple):
    """What is known of a parameter before any comparison.

    Attributes
    ----------
    kind : str
        "uniform" or "loguniform" between `first` and `second`; "normal" with mean and standard
        deviation; "halfnormal" from `first` upwards with the scale `second`. In the unit of the key.
    grade : str
        A: read in the authors' own files; A2: in somebody else's; comp: computed from these; C:
        general knowledge, not verified, good for a wide prior only.
    source : str
        Where the values come from.
    strong_end : str
        "high" or "low": at which end of the distribution the effect is strongest.
    """

    kind: str
    first: float
    second: float
    grade: str
    source: str
    strong_end: str = "high"

    def distribution(self) -> "rv_frozen":
        """The frozen distribution of scipy.stats; its `ppf` is the quantile coordinate."""
        return frozen(self.kind, self.first, self.second)

    def at(self, strength: float) -> float:
        """Value at a strength in (0, 1): the quantile, counted from the end of the weak effect."""
        quantile = strength if self.strong_end == "high" else 1.0 - strength
        return float(self.distribution().ppf(quantile))


@cache
def frozen(kind: str, first: float, second: float) -> "rv_frozen":
    """The frozen distribution of a `Prior`; to make one takes a millisecond."""
    from scipy import stats

    if kind == "uniform":
        return stats.uniform(first, second - first)
    names = {"loguniform": "loguniform", "normal": "norm", "halfnormal": "halfnorm"}
    return getattr(stats, names[kind])(first, second)


class Field(NamedTuple):
    """A field that an effect adds to the state; `location` is one of `fvcollapse.step.state.location_shape`."""

    location: str
    units: str
    description: str


class Seeing(NamedTuple):
    """How an effect changes what is observed; an operator that is None leaves it as it is.

    Attributes
    ----------
    place : callable, optional
        (section, case, x) -> abscissae (n,) at which the grains at x (n,) are seen, m.
    front : callable, optional
        (section, case, time, front) -> front (n,) that is measured of a front (n,) at the times (n,); m, s.
    clock : callable, optional
        (section) -> simulated time at which the clock of the measurement shows zero, s.

    `section` is the table `[effects.<name>]`, `case` the resolved case.
    """

    place: Callable | None = None
    front: Callable | None = None
    clock: Callable | None = None


class Effect(NamedTuple):
    """An effect of the catalogue.

    Attributes
    ----------
    name : str
        The effect is switched on by the table `[effects.<name>]` of a case.
    kind : str
        PHYSICAL (changes the flow), OBSERVATION (changes what is seen of it) or NUISANCE (an error of
        the set-up: marginalised, never a verdict; its standard deviation is that of the experiment
        where it states one, else that of the prior).
    section : type
        The `Section` of its keys.
    priors : dict
        Parameter -> `Prior`.
    absorbed_in : tuple of str
        Keys of the case whose calibration can hide the effect.
    variants : tuple of dict
        Other keys of the section that select a closure, one dict for each; the first is the default.
        A parameter whose value is None in a variant belongs to the others.
    refuse : callable, optional
        (case, section) -> triples (key, what was found, what is allowed) of what the effect excludes.
    change : callable, optional
        (case, section) -> case in which the effect is put into the keys that it changes.
    see : Seeing, optional
        What the effect changes in the observation.
    seen_keys : tuple of str
        Keys of the section that change the observation and not the flow.
    term : str
        Module of `fvcollapse/step` whose stage functions the step calls while the effect is on; "" for none.
    fields : dict
        Name -> `Field` that the state carries while the effect is on.
    needs_walls : bool
        Whether the effect acts only between lateral walls.
    zero : tuple of dict
        Settings of the section with which the effect does nothing in the default case.
    """

    name: str
    kind: str
    section: type
    priors: dict
    absorbed_in: tuple = ()
    variants: tuple = ({},)
    refuse: Callable | None = None
    change: Callable | None = None
    see: Seeing | None = None
    seen_keys: tuple = ()
    term: str = ""
    fields: dict = {}  # noqa: RUF012
    needs_walls: bool = False
    zero: tuple = ({},)

    def keys(
        self, strength: float, variant: dict[str, float | str | None] | None = None
    ) -> dict[str, float | str]:
        """Keys of the section with every parameter at one strength in (0, 1); default: the first variant."""
        variant = self.variants[0] if variant is None else variant
        values = {name: prior.at(strength) for name, prior in self.priors.items()}
        return {name: value for name, value in (values | variant).items() if value is not None}

    @property
    def only_seen(self) -> bool:
        """Whether the effect leaves the flow as it is, whatever its keys."""
        return set(self.seen_keys) == set(self.section.__struct_fields__)


def section_of(case: "Case", name: str) -> Any:
    """The section of an effect in a case; None where the effect is off."""
    return getattr(case.effects, name)


def with_section(case: "Case", name: str, section: "Section | None") -> "Case":
    """The case with another section of an effect; None switches the effect off."""
    return replace(case, effects=replace(case.effects, **{name: section}))
