"""The extract of a run: small, measured as the result is, and refused in another form."""

import io
from types import SimpleNamespace

import h5py
import numpy as np
import pytest

from fvcollapse import observe, open_result
from fvcollapse.case.case import Case
from fvcollapse.errors import InputError
from fvcollapse.output import run as output
from fvcollapse.output.extract import (
    INTERVAL,
    RESOLUTION,
    FinishedRun,
    extract_image,
    kept_rows,
    open_image,
)
from fvcollapse.output.result import Profiles, Result
from fvcollapse.output.stored_names import SERIES, STEPS
from fvcollapse.output.trust import Trust
from fvcollapse.studies import cache
from fvcollapse.studies.cache import RunCache

CASE = Case().replace(**{"grid.cell_size": 0.02, "time.end": 0.1})


def test_extract_measures_as_the_result(started, tmp_path):
    result = output.run(CASE.replace(**{"time.end": 0.4}))
    small = open_image(extract_image(result))
    assert small.case == result.case
    assert len(small.field_times) == 0
    full, thin = observe(result), observe(small)
    np.testing.assert_allclose(thin.profiles, full.profiles, atol=RESOLUTION)
    np.testing.assert_allclose(thin.interface, full.interface, atol=RESOLUTION)
    np.testing.assert_allclose(
        np.interp(full.front[:, 0], *thin.front.T), full.front[:, 1], atol=1e-3
    )
    totals = ("sweeps", "capped_steps", "residual_max", "wall_time", "runout", "final_thickness")
    for name in totals:
        assert small.summary()[name] == pytest.approx(result.summary()[name], rel=1e-6)
    lost = small.steps["volume_correction"].sum()
    assert lost == pytest.approx(result.steps["volume_correction"].sum())
    np.testing.assert_allclose(small.steps["dt"], np.diff(small.series["time"]), atol=1e-12)
    np.testing.assert_array_equal(small.steps["time"], small.series["time"][1:])


def test_series_keep_first_last_and_one_row_per_interval():
    time = np.concatenate([[0.0], np.cumsum(np.full(1000, 7e-4))])
    kept = time[kept_rows(time)]
    assert (kept[0], kept[-1]) == (time[0], time[-1])
    assert np.diff(kept)[:-1].min() > INTERVAL - 7e-4
    assert np.diff(kept).max() < INTERVAL + 7e-4
    assert kept_rows(np.array([0.0])).tolist() == [0]
    assert kept_rows(np.array([0.0, 1e-4])).tolist() == [0, 1]


def test_extract_of_a_long_fine_run_is_small():
    """2200 steps, 126 profiles of 370 nodes: 22 degrees on 6 mm cells."""
    random = np.random.default_rng(1)  # every last bit of the series is new
    time = np.linspace(0.0, 2.5, 2201)
    x = np.linspace(0.0, 2.2, 370)
    heights = 0.1 * np.exp(-((x / np.linspace(0.3, 1.2, 126)[:, None]) ** 2))
    result = SimpleNamespace(
        case=CASE,
        code_version="1",
        status="complete",
        trust=Trust("fine", ()),
        series={name: np.cumsum(random.random(2201)) for name in SERIES} | {"time": time},
        steps={name: random.random(2200) for name in STEPS},
        profiles=Profiles(np.linspace(0.0, 2.5, 126), x, heights, 0.5 * heights),
    )
    assert len(extract_image(result)) < 200_000


def test_extract_of_the_record_is_that_of_the_result(started, tmp_path):
    case = cache.cached_case(CASE)
    job = output.Job(case)
    job.march(SimpleNamespace(set_postfix_str=lambda *_, **__: None, update=lambda _: None, n=0.0))
    result = Result(io.BytesIO(job.result_image("complete")))
    assert extract_image(FinishedRun.of(job.recorder, case)) == extract_image(result)


def test_extract_of_another_form_is_refused(started, tmp_path):
    runs = RunCache(tmp_path)
    runs.run(CASE)
    path = runs.place(CASE) / "extract.h5"
    with h5py.File(path, "r+") as file:
        file["series/table"].attrs["names"] = '["runout"]'
    with pytest.raises(InputError, match="series/table: found .* rows .*; allowed: one name"):
        open_result(path)
    with h5py.File(path, "r+") as file:
        file["series/table"].attrs["names"] = "{"
    with pytest.raises(InputError, match="no names of its rows"):
        open_result(path)
