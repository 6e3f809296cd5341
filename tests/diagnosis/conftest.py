"""What several test files of the diagnosis look at, and what takes long to make: it is made once."""

import pytest


@pytest.fixture(scope="session")
def report():
    """The small example of a report; files about another one have a fixture of this name."""
    from report_page import small

    return small()


@pytest.fixture(scope="session")
def drawn_page(report, tmp_path_factory):
    """The small example of a report with its page and all its figures."""
    from report_page import drawn_page

    return drawn_page(report, tmp_path_factory.mktemp("report"))


@pytest.fixture(scope="session")
def folder(drawn_page):
    """Its folder."""
    return drawn_page.folder


@pytest.fixture(scope="session")
def page(drawn_page):
    """The `Page` in it."""
    return drawn_page.page


@pytest.fixture(scope="session")
def drawn(drawn_page):
    """Its figures by name."""
    return drawn_page.figures


@pytest.fixture(scope="session")
def experiments(tmp_path_factory):
    """Three experiments of a toy laboratory: two slopes and, on the steeper one, two widths."""
    from toy_laboratory import three_films

    from fvcollapse import load_experiment

    return tuple(map(load_experiment, three_films(tmp_path_factory.mktemp("toy"))))


@pytest.fixture(scope="session")
def cases(experiments):
    """Their baseline cases by name."""
    from fvcollapse.diagnosis.baseline import baseline_cases

    return baseline_cases(experiments)


@pytest.fixture(scope="session")
def swelling(tmp_path_factory):
    """The analysis of two films with a change of the volume that no effect knows."""
    from gaps_by_hand import analysed

    return analysed(tmp_path_factory.mktemp("swelling"), swelling=0.08)
