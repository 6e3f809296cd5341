"""A report in a notebook: table, figure, labelled arrays."""

import numpy as np
import pytest
from report_example import example

from fvcollapse.diagnosis.report.sentences import headline


@pytest.fixture(scope="module")
def report():
    return example("effect")


def test_the_table_says_the_answer(report):
    shown = report._repr_html_()
    assert headline(report).replace("&", "&amp;") in shown
    assert "How sure" in shown


def test_the_figure_has_a_bar_for_each_of_the_first_causes(report):
    axes = report.plot().axes[0]
    first = list(report.verdict.probability.values())
    widths = [bar.get_width() for bar in axes.patches]
    assert widths == pytest.approx(first[: len(widths)])
    assert 1 <= len(widths) <= 8


def test_arrays_are_what_was_compared(report):
    pytest.importorskip("xarray")
    tree = report.to_xarray()
    for one in report.details.comparisons:
        group = tree[one.experiment][one.observable]
        np.testing.assert_allclose(group["measured"], one.measured)
        assert group["measured"].attrs["units"] == one.units
        assert {f"simulated_{model}" for model in one.simulated} <= set(group.data_vars)
    assert tree.attrs["verdict"] == report.verdict.kind
