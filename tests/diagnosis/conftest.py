"""What several test files of the diagnosis look at, and what takes long to make: it is made once."""

import pytest


@pytest.fixture(scope="session")
def drawn_page(tmp_path_factory):
    """The small example of a report with its page and all its figures."""
    from report_page import drawn_page, small

    return drawn_page(small(), tmp_path_factory.mktemp("report"))


@pytest.fixture(scope="session")
def swelling(tmp_path_factory):
    """The analysis of two films with a change of the volume that no effect knows."""
    from gaps_by_hand import analysed

    return analysed(tmp_path_factory.mktemp("swelling"), swelling=0.08)
