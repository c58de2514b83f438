"""Verdicts and comparisons of results, on a committed one with numbers of it changed."""

from pathlib import Path

import pytest

from cylcontact.fitting import FitResult, compare

RESULTS = Path(__file__).resolve().parents[2] / "fitting/results"


@pytest.fixture
def result():
    return FitResult.read(RESULTS / "external.json")


def changed(result, objectives, published=None):
    """A result whose runs have these objectives."""
    runs = [
        run.model_copy(update={"objective": value})
        for run, value in zip(result.runs, objectives, strict=False)
    ]
    objective = result.objective.model_copy(update={"value": min(objectives)})
    paper = result.published.model_copy(update={"objective": published or 1.0})
    return result.model_copy(update={"runs": runs, "objective": objective, "published": paper})


def test_fewer_than_half_of_the_runs_at_the_best_are_a_warning(result):
    assert changed(result, [0.05, 0.07]).warnings == []
    few = changed(result, [0.05, 0.07, 0.08])
    assert "make more runs (--runs 12)" in few.verdicts[0]
    assert few.basins() == [(0.05, 1), (0.07, 1), (0.08, 1)]


def test_round_off_is_one_basin_and_the_optimum(result):
    verdicts = changed(result, [1.8e-8, 2.6e-8, 1e-3], published=2.6e-8).verdicts
    assert verdicts[0] == "the published coefficients are the optimum on this grid, within 0.1 %"
    assert "2 of 3 runs reached the best objective within 0.1 %" in verdicts


def test_one_result_is_compared_with_the_published_coefficients(result):
    (line,) = (line for line in compare([result]).splitlines() if line.startswith("b, mm"))
    published, fitted = result.published.coefficients["b"], result.coefficients["b"]
    expected = [f"{published:g}", f"{fitted:.5g}", f"{100 * (fitted / published - 1):+.1f}"]
    assert line.split()[-3:] == expected


def test_results_of_another_search_have_a_table_of_their_own(result):
    recovered = FitResult.read(RESULTS / "recovered-external.json")  # with n fixed
    tables = compare([result, recovered, result.model_copy(update={"name": "again"})])
    heads = [part.splitlines()[0].split() for part in tables.split("\n\n")]
    assert heads[0] == ["enhanced,", "external", "published", "external", "again"]
    assert heads[1][-3:] == ["recovered-external", "difference,", "%"]
    assert "n (fixed)" in tables
