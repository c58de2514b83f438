"""Grids that a user might make: the runs agree on the best, and a warning says if they do not."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.own_grids import GRIDS, campaign_of
from cylcontact.fitting import calibrate, polish, verdicts
from cylcontact.fitting.assessment import SAME_BASIN
from cylcontact.fitting.calibration import problem_of, search_all
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.report import as_html
from cylcontact.progress import silent

# The runs of sixteen that reach the best.
ENOUGH = 12
FEW_POINTS = "the same, few points"
TINY = {"populations": [4], "generations": 1}


def objectives(campaign):
    """Return the problem of a campaign and the objective of each run."""
    problem, _ = problem_of(campaign, 1, silent)
    return problem, np.array([r.objective for r in search_all(problem, campaign, 2, silent)])


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
def test_at_least_twelve_of_sixteen_runs_reach_the_best(name):
    problem, values = objectives(campaign_of(name))
    best = min(values.min(), best_of_descents(problem, 100))
    assert at_best(values, best) >= ENOUGH


def test_too_few_runs_at_the_best_are_a_warning_above_the_table(monkeypatch):
    # Without hops most runs stay where one branch of Y is out of use.
    monkeypatch.setattr(polish, "_PATIENCE", 0)
    campaign = campaign_of(FEW_POINTS, runs=6, **TINY)
    campaign = replace(campaign, spec=campaign.spec.model_copy(update={"profiles": False}))
    result = calibrate(campaign)
    agreeing = at_best(np.array([run.objective for run in result.runs]), result.objective.value)
    assert agreeing < 3
    said = (
        f"only {agreeing} of 6 runs reached the best objective within 0.1 %, so a lower one may "
        "have been missed: make more runs (--runs 24), or hold a coefficient at a value (fixed = "
        "true in the campaign)"
    )
    assert verdicts(result)[0] == said
    above, below = str(result).split("\n\n", 1)
    assert f"! {said}" in " ".join(above.split())
    assert "- only" not in below
    assert f"{said}</p><table>" in as_html(result)
    assert f"<li>{said}" not in as_html(result)
