"""The table of observables: what is measured of a collapse, and everything that the code knows of it.

Curves and numbers of an experiment folder, their columns, units, uncertainties, words and points of
comparison follow from `QUANTITIES`. A new observable is a row here, a reading in `observe` and a test.
"""

from typing import NamedTuple


class Default(NamedTuple):
    """Standard deviation where none is stated: a value, or a part of the quantity (`relative`)."""

    unit: str
    value: float
    relative: bool
    reason: str


class Shown(NamedTuple):
    """How a number is printed: factor from SI, and the unit behind it."""

    factor: float
    unit: str


class Quantity(NamedTuple):
    """One observable.

    Attributes
    ----------
    name : str
        Of its file without the suffix, or of its row in `scalars.csv`.
    unit : str
        SI.
    words : str
    too_large, too_small : str
        Words for simulated > measured and simulated < measured.
    value_shown, gap_shown : Shown
        How a value and how a difference of two values are printed.
    uncertainty : str
        Key of `[uncertainty]` that holds where the file gives no standard deviation.
    default : Default or None
        The standard deviation of that key; None where another quantity, of the same key, gives it.
    columns : tuple of str
        t_s, x_m if there is a place, and the value; empty for a number.
    reading : str
        Name in the long form that `observations` prints; empty: `name`.
    is_height : bool
        An error of the scale of the picture changes it in proportion.
    clock, origin : float
        Change of a number per second by which the clock is ahead, and per metre by which every X is read
        too large; the same of the origin for a curve over time.
    phase : str
        Phase of the collapse that a number belongs to.
    discrepancy : str
        Quantity whose model error it shares; empty: its own.
    moments : tuple
        (phase, share of it) at which a profile is compared.
    places : int
        Number of abscissae at which a profile is compared.
    times : tuple
        Numbers of times at which a curve over time is compared: until the front stops, and after.
    """

    name: str
    unit: str
    words: str
    too_large: str
    too_small: str
    value_shown: Shown
    gap_shown: Shown
    uncertainty: str
    default: Default | None = None
    columns: tuple = ()
    reading: str = ""
    is_height: bool = False
    clock: float = 0.0
    origin: float = 0.0
    phase: str = ""
    discrepancy: str = ""
    moments: tuple = ()
    places: int = 0
    times: tuple = ()

    @property
    def is_curve(self) -> bool:
        """Whether it has a file of its own."""
        return bool(self.columns)

    @property
    def is_profile(self) -> bool:
        """Whether it varies along the bed."""
        return len(self.columns) == 3

    @property
    def sigma_column(self) -> str:
        """Optional column of the standard deviation."""
        return "sigma" if self.unit == "1" else f"sigma_{self.unit}"


CENTIMETRE = Shown(100.0, "cm")  # the unit of every length, so that a page has one
SECOND, SPEED = Shown(1.0, "s"), Shown(1.0, "m/s")
PERCENT, COLUMN_PERCENT = Shown(100.0, "%"), Shown(100.0, "% of the column")

TABLE = (
    Quantity(
        "front",
        "m",
        "front position",
        "too far",
        "not far enough",
        CENTIMETRE,
        CENTIMETRE,
        "front",
        Default(
            "m",
            0.010,
            False,
            "beads that jump ahead: +-2 cm (Farin et al. 2014), two standard deviations",
        ),
        columns=("t_s", "x_front_m"),
        origin=1.0,
        times=(20, 5),
    ),
    Quantity(
        "profiles",
        "m",
        "thickness",
        "too large",
        "too small",
        CENTIMETRE,
        CENTIMETRE,
        "thickness",
        Default(
            "m", 0.002, False, "front thresholds from 1 to 7 mm are in use (Rousseau et al. 2023)"
        ),
        columns=("t_s", "x_m", "h_m"),
        reading="thickness",
        is_height=True,
        # the moment t = 0 says nothing
        moments=((0, 0.7), (1, 0.2), (1, 0.6), (2, 0.0), (2, 0.5), (3, 0.0), (3, 1.0)),
        places=22,
    ),
    Quantity(
        "volume",
        "1",
        "relative volume",
        "too large",
        "too small",
        PERCENT,
        COLUMN_PERCENT,
        "relative_volume",
        Default(
            "-", 0.01, False, "area under h of thin sloping layers, in a simulation grain by grain"
        ),
        columns=("t_s", "relative_volume_change"),
        times=(8, 2),
    ),
    Quantity(
        "interface",
        "m",
        "static\N{EN DASH}flowing interface",
        "too high",
        "too low",
        CENTIMETRE,
        CENTIMETRE,
        "interface",
        Default(
            "m",
            0.003,
            False,
            "2 mm of reading in a simulation grain by grain, and the 2 mm of the thickness",
        ),
        columns=("t_s", "x_m", "z_static_m"),
        reading="static_height",
        is_height=True,
        moments=((0, 0.7), (1, 0.1), (1, 0.4), (1, 0.7), (2, 0.0)),  # at rest it is the surface
        places=8,
    ),
    Quantity(
        "runout",
        "m",
        "runout",
        "too far",
        "not far enough",
        CENTIMETRE,
        CENTIMETRE,
        "front",
        origin=1.0,
        phase="deposit",
        discrepancy="front",
    ),
    Quantity(
        "final_height",
        "m",
        "final height",
        "too large",
        "too small",
        CENTIMETRE,
        CENTIMETRE,
        "thickness",
        is_height=True,
        phase="deposit",
        discrepancy="profiles",
    ),
    Quantity(
        "time_stop",
        "s",
        "time of arrest",
        "too late",
        "too early",
        SECOND,
        SECOND,
        "time_stop",
        Default("s", 0.1, False, "chosen: the last grains creep"),
        clock=1.0,
        phase="arrest",
    ),
    Quantity(
        "peak_front_velocity",
        "m/s",
        "peak front velocity",
        "too high",
        "too low",
        SPEED,
        SPEED,
        "peak_front_velocity",
        Default("m/s", 0.1, False, "chosen: curves of few points"),
        phase="spreading",
    ),
)
QUANTITIES = {quantity.name: quantity for quantity in TABLE}
CURVES = {name: quantity for name, quantity in QUANTITIES.items() if quantity.is_curve}
PROFILES = tuple(name for name, quantity in CURVES.items() if quantity.is_profile)
HEIGHTS = tuple(name for name, quantity in QUANTITIES.items() if quantity.is_height)
SCALAR_UNITS = {
    name: quantity.unit for name, quantity in QUANTITIES.items() if not quantity.is_curve
}
MEASURED_DEFAULTS = {
    quantity.uncertainty: quantity.default for quantity in TABLE if quantity.default is not None
}


def shown_gap(name: str, unit: str) -> Shown:
    """How a gap of an observable is printed; one that is not in the table keeps its `unit`."""
    return QUANTITIES[name].gap_shown if name in QUANTITIES else Shown(1.0, plain_unit(unit))


def shown_value(name: str, unit: str) -> Shown:
    """How a value of an observable is printed; one that is not in the table keeps its `unit`."""
    return QUANTITIES[name].value_shown if name in QUANTITIES else Shown(1.0, plain_unit(unit))


def observable_words(name: str) -> str:
    """An observable in words."""
    return QUANTITIES[name].words if name in QUANTITIES else name.replace("_", " ")


def direction_words(name: str, gap: float) -> str:
    """Words for the sign of simulated - measured."""
    if name not in QUANTITIES:
        return "too high" if gap > 0.0 else "too low"
    return QUANTITIES[name].too_large if gap > 0.0 else QUANTITIES[name].too_small


def plain_unit(unit: str) -> str:
    """A unit as printed: empty where there is none."""
    return "" if unit in ("1", "-") else unit
