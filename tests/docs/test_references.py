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


def test_the_standards_deflection_is_its_formula():
    """F = c_L·δ^(10/9) with c_L = 35948·L^(8/9), for a roller of 10 mm."""
    theirs = [
        value["theirs"] for about, value, *_ in CASES if about["pair"]["contact"] != "external"
    ]
    loads = (20.0, 100.0, 500.0)
    formula = [1e3 * (10 * f / (35948 * 10 ** (8 / 9))) ** 0.9 for f in loads]
    assert theirs == pytest.approx(formula, rel=1e-6)


def test_the_cylinder_on_a_block_by_hand():
    E_star = 1 / ((1 - 0.09) / 210e3 + (1 - 0.09) / 70e3)
    ours = [mine for about, _, mine, _ in CASES if about["pair"]["contact"] == "external"]
    peak = math.sqrt(35000 * E_star / (math.pi * 50))
    assert ours == pytest.approx([peak, 2 * 35000 / (math.pi * peak), peak], rel=1e-12)
