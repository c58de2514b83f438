"""The page of outside references, and their numbers by hand."""

import math

import pytest

from benchmarks.references import PAGE, compared, page

CASES = [(about, *row) for about, rows in compared() for row in rows]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case[1]["what"])
def test_we_are_as_close_to_others_as_the_file_says(case):
    _, value, _, off = case
    assert abs(off) < value["within"]


def test_the_page_is_that_of_the_numbers():
    assert PAGE.read_text(encoding="utf-8") == page()


@pytest.mark.parametrize(
    ("source", "deflection"),
    [
        ("ISO/TS 16281", lambda F, L: (F / (35948 * L ** (8 / 9))) ** 0.9),
        ("A. Palmgren", lambda F, L: 2 * 3.84e-5 * F**0.9 / L**0.8),
    ],
)
def test_the_deflection_of_a_roller_of_10_mm_is_the_formula(source, deflection):
    theirs = [v["theirs"] for about, v, *_ in CASES if about["citation"].startswith(source)]
    assert theirs == pytest.approx([1e3 * deflection(10 * f, 10) for f in (20, 100, 500)], rel=1e-6)


def test_the_cylinder_on_a_block_by_hand():
    E_star = 1 / ((1 - 0.09) / 210e3 + (1 - 0.09) / 70e3)
    ours = [mine for about, _, mine, _ in CASES if about["pair"]["contact"] == "external"]
    peak = math.sqrt(35000 * E_star / (math.pi * 50))
    assert ours == pytest.approx([peak, 2 * 35000 / (math.pi * peak), peak], rel=1e-12)
