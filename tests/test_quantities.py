"""The table of observables holds for everything that knows them."""

import pytest

from fvcollapse.measure.curves import CSV_FILES
from fvcollapse.measure.quantities import (
    CURVES,
    HEIGHTS,
    PROFILES,
    QUANTITIES,
    SCALAR_UNITS,
    observable_words,
    shown_gap,
)
from fvcollapse.measure.uncertainty import DEFAULTS, Uncertainty

PHASES = ("release", "spreading", "arrest", "deposit")


@pytest.mark.parametrize("quantity", QUANTITIES.values(), ids=lambda quantity: quantity.name)
def test_a_row_is_complete(quantity):
    assert quantity.uncertainty in DEFAULTS
    assert quantity.uncertainty in Uncertainty.__struct_fields__
    unit = DEFAULTS[quantity.uncertainty].unit
    assert unit.replace("-", "1") == quantity.unit
    for shown in (quantity.value_shown, quantity.gap_shown):
        assert shown.factor >= 1.0
        assert (shown.factor == 1.0) == (shown.unit == quantity.unit)
    assert quantity.discrepancy in ("", *CURVES)
    if quantity.is_curve:
        assert quantity.columns[0] == "t_s"
        assert bool(quantity.moments and quantity.places) == quantity.is_profile
        assert bool(quantity.times) != quantity.is_profile
    else:
        assert quantity.phase in PHASES


def test_curves_and_numbers_are_as_the_interface_says():
    assert list(CURVES) == ["front", "profiles", "volume", "interface"]
    assert CURVES["front"].columns == ("t_s", "x_front_m")
    assert CURVES["profiles"].columns == ("t_s", "x_m", "h_m")
    assert CURVES["volume"].columns == ("t_s", "relative_volume_change")
    assert CURVES["interface"].columns == ("t_s", "x_m", "z_static_m")
    assert [curve.sigma_column for curve in CURVES.values()] == [
        "sigma_m",
        "sigma_m",
        "sigma",
        "sigma_m",
    ]
    assert SCALAR_UNITS == {
        "runout": "m",
        "final_height": "m",
        "time_stop": "s",
        "peak_front_velocity": "m/s",
    }
    assert (*CURVES, "scalars") == CSV_FILES
    assert PROFILES == ("profiles", "interface")
    assert HEIGHTS == ("profiles", "interface", "final_height")


def test_what_is_not_in_the_table_is_printed_as_it_is():
    assert observable_words("wall_pressure") == "wall pressure"
    assert shown_gap("wall_pressure", "Pa") == (1.0, "Pa")
    assert shown_gap("wall_pressure", "-") == (1.0, "")
