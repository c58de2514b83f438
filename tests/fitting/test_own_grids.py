"""Grids that a user might make: the runs agree on the best, and a warning says if they do not."""

import numpy as np
import pytest

from cylcontact.fitting.calibration import space_of
from cylcontact.fitting.records import SAME_BASIN
from cylcontact.fitting.runs import run_all, searches
from cylcontact.fitting.search import descend, polish
from cylcontact.support.progress import silent
from tests.support.own_grids import GRIDS, campaign_of

TINY = {"populations": [4], "generations": 1}


def objectives(campaign):
    """Return the space of a campaign and the objective of each run."""
    space, spec = space_of(campaign)[0], campaign.spec
    calls = searches(space, spec.genetic, spec.seed)
    return space, np.array([r.objective for r in run_all(calls, 2, silent, None, False)])


def at_best(values, best):
    return np.count_nonzero(values <= best * (1 + SAME_BASIN))


def best_of_descents(space, starts):
    """Return the lowest of descents from random points, a second way to the optimum."""
    ends, values = descend(space, space.scatter(np.random.default_rng(3), starts), 1e-8)
    return polish(space, ends[values.argmin()], 1e-8)[1]


def test_few_runs_agree_even_after_a_tiny_search():
    space, values = objectives(campaign_of("light alloys and steel", runs=4, **TINY))
    assert at_best(values, min(values.min(), best_of_descents(space, 20))) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("name", GRIDS)
def test_all_of_sixteen_runs_reach_the_best(name):
    space, values = objectives(campaign_of(name))
    best = min(values.min(), best_of_descents(space, 2000))
    assert at_best(values, best) == 16
