"""Power-law fits at one pair, held against the numbers printed with Fig 2."""

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.fitting import fit_power, fit_power_to_law

STEEL = Material("steel", E=207e3, nu=0.3)


def test_fig_2_external_comes_close_with_the_same_recipe():
    pair = CylinderPair.from_dR("external", 140.0, STEEL)
    load = np.concatenate([[1.0], np.arange(100.0, 10001.0, 100.0)])
    fit = fit_power_to_law(laws.Johnson(), load, pair)
    assert fit.K == pytest.approx(44974.9, abs=0.05)
    assert fit.n == pytest.approx(1.09392, abs=5e-6)
    assert fit.K / 44935 == pytest.approx(1, abs=1e-3)
    assert fit.r_squared > 0.998


def test_agrees_with_numpy_polyfit():
    rng = np.random.default_rng(5)
    delta = rng.uniform(1e-4, 1e-2, 50)
    load = 2e5 * delta**1.1 * np.exp(rng.normal(scale=0.1, size=50))
    fit = fit_power(load, delta)
    slope, level = np.polyfit(np.log(delta), np.log(load), 1)
    assert fit.n == pytest.approx(slope, rel=1e-12)
    assert fit.K == pytest.approx(np.exp(level), rel=1e-12)
    residual = np.log(load) - level - slope * np.log(delta)
    assert fit.r_squared == pytest.approx(1 - residual.var() / np.log(load).var(), rel=1e-12)


@pytest.mark.parametrize(
    ("load", "penetration", "rule"),
    [
        ([1.0, -2.0], [1e-3, 2e-3], "positive and finite"),
        ([1.0, 2.0], [1e-3, np.nan], "positive and finite"),
        ([1.0, 2.0], [1e-3, 1e-3], "two different penetrations"),
        ([], [], "two different penetrations"),
    ],
)
def test_unusable_points_are_refused(load, penetration, rule):
    with pytest.raises(InputError, match=rule):
        fit_power(load, penetration)
