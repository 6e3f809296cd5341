"""Two hundred random legal cases end by themselves with a right word, and lose no volume."""

import pytest
from random_cases import LAWS, NAMED, ending_of, random_case

from fvcollapse.effects.catalogue import CATALOGUE

COUNT = 200
VOLUME = 0.002  # of the volume at the start, at all times; with dilatancy, beyond what it allows


def every_case(count):
    cases = [random_case(number) for number in range(count)]
    for case in cases:
        assert case.geometry.height_max / case.grid.cell_size_z > 5.999
    return cases


def test_the_cases_are_fixed_and_resolved():
    cases = every_case(10)
    assert cases[7] == random_case(7)
    assert {case.rheology.law for case in cases} == set(LAWS)


@pytest.mark.slow
def test_the_cases_are_of_every_kind():
    cases = every_case(COUNT)
    for name in CATALOGUE:
        assert sum(getattr(case.effects, name) is not None for case in cases) >= 5, name
    assert sum(case.geometry.polygon is not None for case in cases) >= 20
    assert {case.boundary.right_end for case in cases} == {"grow", "open", "error"}
    assert {case.boundary.ends for case in cases} == {"walls", "periodic"}
    assert len({case.gate.speed for case in cases}) >= 6


@pytest.mark.slow
@pytest.mark.parametrize("number", range(COUNT))
def test_a_random_legal_case_ends_with_a_right_word_and_its_volume(number, tmp_path):
    ending = ending_of(number, tmp_path)
    assert ending.word == "complete" or ending.word.startswith(NAMED)
    assert ending.drift <= VOLUME, ending.word
