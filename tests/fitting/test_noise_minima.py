"""The deviations of the noise are the most likely ones, although few readings have several."""

import numpy as np
import pytest

import cylcontact as cc
from benchmarks.coverage import KINDS, PAIR
from cylcontact.fitting.noise import Covariance, Likelihood, NoiseModel, estimate


# Of 300 tables drawn so, six in which a search from one start ends elsewhere, and two others.
@pytest.mark.parametrize("seed", [14, 45, 165, 219, 230, 297, 0, 1])
def test_no_other_deviations_are_more_likely(seed):
    rng = np.random.default_rng(seed)
    size = int(rng.integers(6, 16))
    depth, zero = np.geomspace(1e-4, 2e-2, size), np.zeros(size)
    constant, proportional = 10 ** rng.uniform(-7, -4), 10 ** rng.uniform(-4, -1)
    errors = constant * rng.normal(size=size) + proportional * depth * rng.normal(size=size)
    noise = Covariance(
        model=NoiseModel(noise="both"),
        load=1e5 * depth,
        given=zero,
        depth=depth,
        series=zero.astype(np.intp),
        position=zero,
        deviations={},
    )
    likelihood = Likelihood(noise, errors, np.stack([depth, np.ones(size)], axis=1))
    found = likelihood(estimate(likelihood))
    shares = [0.0, *np.geomspace(1e-3, 10.0, 33)]
    typical = np.sqrt((errors**2).mean())
    others = [
        likelihood({"constant": typical * a, "proportional": typical / 1e-2 * b})
        for a in shares
        for b in shares
    ]
    assert found <= min(others) + 1e-6


@pytest.mark.parametrize("kind", ["both", "8 series with a drift"])
def test_the_last_digit_of_the_readings_does_not_change_what_verify_compares(kind):
    kind = KINDS[kind]
    table = kind.sample(np.random.default_rng(1))
    other = table.assign(penetration_um=table["penetration_um"] * (1 + 1e-15))
    one, other = (
        cc.fit(each, "explicit", PAIR, starts=1, **kind.options).objective.value
        for each in (table, other)
    )
    assert other == pytest.approx(one, rel=1e-10)
