"""First yield of many joints at once against the search of each by itself."""

from itertools import product

import numpy as np
import pytest

from cylcontact import CylinderPair, Material, limits
from cylcontact.limits import many_yields, yield_search
from tests.support.samples import sampled


def joints(count, plane, seed=7):
    """Joints of ratios of moduli from 1e-3 to 1e3, ν from 0 to 0.499, and T from 0.003 to 30."""
    rng = np.random.default_rng(seed)
    ratio, nu = 10 ** rng.uniform(-3, 3, count), rng.uniform(0, 0.499, (2, count))
    nu[:, :2] = [[0.0, 0.499], [0.499, 0.0]]
    kappa, across = (3 - nu) / (1 + nu), 0 * nu
    modulus = np.stack([ratio, np.ones(count)])
    if plane == "strain":
        kappa, across, modulus = 3 - 4 * nu, nu, modulus / (1 - nu**2)
    w_i, w_j = modulus[::-1] / modulus.sum(axis=0)
    beta = w_j * (kappa[1] - 1) / (kappa[1] + 1) - w_i * (kappa[0] - 1) / (kappa[0] + 1)
    strengths = 10 ** rng.uniform(-2.5, 1.5, count) * 10 ** rng.uniform(-0.3, 0.3, (2, count))
    return [*strengths, w_i, beta, kappa[0], across[0], kappa[1], across[1]]


FEW = [(5, "von Mises", "stress"), (5, "Tresca", "strain")]
MORE = list(product([12], ["von Mises", "Tresca"], ["stress", "strain"]))


@pytest.mark.parametrize(("count", "criterion", "plane"), sampled(FEW + MORE, FEW))
def test_many_joints_yield_where_the_search_of_each_says(count, criterion, plane):
    rows = joints(count, plane)
    block = np.stack(rows)
    phi, in_pin, depth = many_yields.yields_of_many(block[2:], block[:2], criterion == "Tresca")
    exact, exact_in_pin, exact_depth = yield_search._searched(rows, criterion)
    np.testing.assert_allclose(phi, exact, rtol=2e-4)
    np.testing.assert_array_equal(in_pin, exact_in_pin)
    np.testing.assert_allclose(depth, exact_depth, atol=2e-3)


def varied(count):
    """Pairs of many materials, each with its own yield stress."""
    rng = np.random.default_rng(3)
    hole = Material("hole", 10 ** rng.uniform(4, 5.5, count), rng.uniform(0.1, 0.45, count))
    pin = Material("pin", 207e3, 0.3, yield_stress=300.0)
    R_j = 10 - 10 ** rng.uniform(-3, -0.5, count)
    return CylinderPair.internal(10.0, R_j, pin=pin, hole=hole)


@pytest.mark.parametrize("criterion", ["von Mises", "Tresca"])
def test_an_array_of_joints_is_each_of_them(criterion):
    """By the public function: more kinds than are searched by tables, each with its strength."""
    pair, strengths = varied(40), np.linspace(100.0, 800.0, 40)
    many = limits.first_yield(pair, criterion, yield_stress=strengths)
    for k in (0, 13, 39):
        hole = Material("hole", pair.material_i.E[k], pair.material_i.nu[k])
        one = CylinderPair.internal(10.0, pair.R_j[k], pin=pair.material_j, hole=hole)
        alone = limits.first_yield(one, criterion, yield_stress=strengths[k])
        assert many.load[k] == pytest.approx(float(alone.load), rel=2e-4)
        assert many.body[k] == alone.body
        assert many.depth[k] == pytest.approx(float(alone.depth), abs=0.02)
    assert limits.yield_load(pair, criterion, strengths).tolist() == many.load.tolist()


def test_blocks_change_no_bit_and_what_is_not_found_is_searched_by_tables(monkeypatch):
    pair = varied(9)
    whole = limits.first_yield(pair, yield_stress=250.0)
    monkeypatch.setattr(yield_search, "_ROWS", 4)
    np.testing.assert_array_equal(limits.first_yield(pair, yield_stress=250.0).load, whole.load)
    none = lambda *joints: np.full((3, joints[0].shape[1]), np.nan)  # noqa: E731
    monkeypatch.setattr(many_yields, "yields_of_many", none)
    few = CylinderPair.internal(10.0, pair.R_j, pin=pair.material_j, hole=pair.material_i)
    searched = limits.first_yield(few, yield_stress=250.0)
    np.testing.assert_allclose(searched.load, whole.load, rtol=2e-4)
    assert (searched.load != whole.load).any()
