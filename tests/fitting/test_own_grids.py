"""Grids that a user might make: the runs agree on the best, and a warning says if they do not."""

from pathlib import Path

import numpy as np
import pytest

from cylcontact.fitting import polish, read_campaign
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.objectives import Problem
from cylcontact.fitting.profiles import profiles
from cylcontact.fitting.records import SAME_BASIN
from cylcontact.fitting.runs import run_all, searches
from cylcontact.support.progress import silent
from tests.support.own_grids import GRIDS, campaign_of

ROOT = Path(__file__).resolve().parents[2]
# The runs of sixteen that reach the best.
ENOUGH = 14
FEW_POINTS = "the same, few points"
TINY = {"populations": [4], "generations": 1}


def objectives(campaign):
    """Return the problem of a campaign and the objective of each run."""
    problem, _ = problem_of(campaign, 1, silent)
    spec = campaign.spec
    calls = searches(problem, spec.optimizer, spec.genetic, spec.seed, campaign.source)
    return problem, np.array([r.objective for r in run_all(calls, 2, silent, None, False)])


def at_best(values, best):
    return np.count_nonzero(values <= best * (1 + SAME_BASIN))


def best_of_descents(problem: Problem, starts: int) -> float:
    """Return the lowest of descents from random points, a second way to the optimum."""
    rng = np.random.default_rng(3)
    points = rng.uniform(problem.low, problem.high, (starts, problem.low.size))
    return min(polish.polish(problem, point, 1e-8)[1] for point in points)


def test_few_runs_agree_even_after_a_tiny_search():
    problem, values = objectives(campaign_of("light alloys and steel", runs=4, **TINY))
    assert at_best(values, min(values.min(), best_of_descents(problem, 20))) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("name", GRIDS)
def test_at_least_fourteen_of_sixteen_runs_reach_the_best(name):
    problem, values = objectives(campaign_of(name))
    best = min(values.min(), best_of_descents(problem, 100))
    assert at_best(values, best) >= ENOUGH


# --- the descents ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def few_points():
    return problem_of(campaign_of(FEW_POINTS), 1, silent)[0]


def starts(problem, number):
    return problem.scatter(np.random.default_rng(2), number)


def test_slopes_by_formula_are_differences_of_the_residuals(few_points):
    points = starts(few_points, 5)
    _, slopes = polish._linearised(few_points, points, 0.0)
    low, high = few_points.low, few_points.high
    differences = polish.central_differences(few_points.residuals, low, high, points)
    assert slopes == pytest.approx(differences, rel=1e-6, abs=1e-7)


def test_an_end_does_not_depend_on_the_others_of_its_batch(few_points):
    begun = starts(few_points, 7)
    together, _ = polish.descend(few_points, polish.climb_down(few_points, begun), 1e-6)
    for start, end in zip(begun, together, strict=True):
        down = polish.climb_down(few_points, start[None, :])
        alone, _ = polish.descend(few_points, down, 1e-6)
        assert np.array_equal(alone[0], end)


def test_what_is_held_is_as_good_as_fixed(few_points):
    """Columns that differ from start to start, against problems without those parameters."""
    begun = starts(few_points, 6)
    held = np.zeros(begun.shape, dtype=bool)
    held[np.arange(6), np.arange(6)] = True
    ends, values = polish.descend(few_points, begun, 1e-14, held)
    assert np.array_equal(ends[held], begun[held])
    for k, parameter in enumerate(few_points.free[:6]):
        fixed = few_points.fixing(**{parameter.name: float(begun[k, k])})
        rest = np.delete(begun[k], k)[None, :]
        assert polish.descend(fixed, rest, 1e-14)[1][0] == pytest.approx(values[k], rel=1e-6)


@pytest.mark.slow
def test_a_profile_is_as_low_as_many_restarts_find():
    problem, _ = problem_of(read_campaign(ROOT / "fitting/internal.toml"), 1, silent)
    runs = [polish.minimise(problem, problem.low, seed) for seed in range(16)]
    point, value = min(runs, key=lambda run: run[1])
    best = problem.coefficients(point)
    curve = profiles(problem, ["a"], best, None)["a"]
    assert min(curve.objective) >= value * (1 - 1e-9)
    for at in range(0, len(curve.values), 6):
        held = problem.fixing(a=curve.values[at])
        _, values = polish.descend(held, polish.climb_down(held, starts(held, 60)), 1e-8)
        assert curve.objective[at] <= values.min() * 1.001
    for end in (curve.low, curve.high):
        held = problem.fixing(a=end)
        assert polish.minimise(held, held.point(best))[1] == pytest.approx(1.01 * value, rel=1e-4)
