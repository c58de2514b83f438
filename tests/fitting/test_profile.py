"""Profiles: as low as many restarts find them, and intervals that end where they say."""

from pathlib import Path

import numpy as np
import pytest

from cylcontact.fitting import FitResult, read_campaign
from cylcontact.fitting.calibration import profiles_of, space_of
from cylcontact.fitting.parameters import LawModel, Parameter
from cylcontact.fitting.profile import Profiles
from cylcontact.fitting.search import beside, descend, minimise, polish, sharpen
from cylcontact.fitting.space import Space
from tests.support.own_grids import campaign_of

ROOT = Path(__file__).resolve().parents[2]


class Quadratic(Space):
    """x'Ax + 1 with a known A: the profile of a parameter is a parabola."""

    A = np.array([[2.0, 0.6], [0.6, 1.0]])

    def residuals(self, points):
        whole = self.complete(points) @ np.linalg.cholesky(self.A)
        return np.column_stack([whole, np.ones(len(points))])


def test_an_interval_of_a_sum_of_squares_is_the_one_by_hand():
    parameters = (Parameter("x", -3.0, 3.0), Parameter("y", -3.0, 0.5))
    space = Quadratic(LawModel("none", "internal", parameters, lambda _: None), parameters)
    values = [np.linspace(p.low, p.high, 8) for p in parameters]
    values = [np.union1d(each, [0.0]) for each in values]
    profiles = Profiles(space, np.zeros(2), values)
    ends = profiles.ends(lambda objective: np.sqrt(np.maximum(objective**2 - 1, 0.0)))
    # The sum rises by 1 at a distance of the root of the diagonal of the inverse.
    reach = np.sqrt(np.diag(np.linalg.inv(space.A)))
    assert ends[0] == pytest.approx([-reach[0], reach[0]], rel=1e-3)
    assert ends[1, 0] == pytest.approx(-reach[1], rel=1e-3)
    assert np.isnan(ends[1, 1])  # beyond the bound


def lowest(space, name, value, near, number=150):
    """Return the lowest objective with a parameter held, by many descents of two kinds."""
    held, rng = space.fixing(**{name: value}), np.random.default_rng(5)
    random = sharpen(held, held.scatter(rng, number))
    hops = beside(held, np.tile(held.point(near), (number, 1)), rng)
    return descend(held, np.vstack([random, hops]), 1e-8)[1].min()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["internal-E1000", "few points"])
def test_beyond_the_ends_of_an_interval_no_restart_finds_a_lower_objective(name):
    is_own = name == "few points"
    campaign = campaign_of("the same, few points") if is_own else read_campaign(
        ROOT / f"fitting/{name}.toml"
    )  # fmt: skip
    space, _ = space_of(campaign)
    point, value = min((minimise(space, space.low, seed) for seed in range(4)), key=lambda m: m[1])
    best = space.coefficients(point)
    for key, profile in profiles_of(space, [best]).items():
        assert min(profile.objective) >= value * (1 - 1e-9)
        for end, is_bound in (
            (profile.low, profile.low_is_bound),
            (profile.high, profile.high_is_bound),
        ):
            if not is_bound:
                beyond = best[key] + 1.02 * (end - best[key])
                assert lowest(space, key, beyond, best) > 1.01 * value
                held = space.fixing(**{key: end})
                assert polish(held, held.point(best))[1] >= 1.01 * value * (1 - 1e-4)


def test_committed_intervals_with_kinks_are_the_lowest_profiles():
    """Found by an independent search: Y_slope may fall to .00192 within 1 %, not to .00205."""
    profile = FitResult.read(ROOT / "fitting/results/internal-E1000.json").profiles["Y_slope"]
    assert profile.low == pytest.approx(0.00192, abs=5e-6)
