"""The fast laws for any two materials: their errors, limits, grids and campaigns."""

import json
from pathlib import Path

import numpy as np
import pytest
from cylcontact.fitting.objectives import collect_samples

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.datasets.grid import grid_from
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.table_campaign import read_campaign
from cylcontact.laws import explicit_pair, glauert, parametric
from cylcontact.support.progress import silent

ROOT = Path(__file__).resolve().parents[2]
STEEL, ALUMINIUM = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
PEEK = Material("PEEK", 3.6e3, 0.38)
PHI = np.geomspace(1e-6, 60.0, 60)
BOUNDS = {"parametric": 0.06, "explicit-pair": 1.1}  # percent, as their docstrings say
LAWS = {"parametric": laws.Parametric(), "explicit-pair": laws.ExplicitPair()}


def random_pairs(count, seed):
    """Pairs drawn evenly from all that two materials can have, their edges among them."""
    rng = np.random.default_rng(seed)
    alpha, place = rng.uniform(-0.999, 0.999, count), rng.uniform(-1, 1, count)
    place[:6] = [-1, -1, -1, 1, 1, 1]
    return CylinderPair.from_dundurs(alpha[:, None], (alpha + place)[:, None] / 4)


# --- how far they are from the reference ---------------------------------------------------------


@pytest.mark.parametrize("name", LAWS)
def test_the_error_over_pairs_drawn_at_random_is_below_what_is_said(name):
    pair = random_pairs(80, seed=20261122)
    d = laws.Conformal().penetration(PHI, pair)
    of_load = 100 * (LAWS[name].load(d, pair) / PHI - 1)
    of_penetration = 100 * (LAWS[name].penetration(PHI, pair) / d - 1)
    for error in (of_load, of_penetration):
        assert BOUNDS[name] / 3 < np.abs(error).max() < BOUNDS[name]


@pytest.mark.parametrize("alpha", [-0.95, -0.3, 0.0, 0.6, 0.999])
def test_the_parametric_law_is_exact_without_beta(alpha):
    pair = CylinderPair.from_dundurs(alpha, 0.0)
    delta = np.geomspace(1e-12, 1e3, 200)
    expected = laws.Conformal().load(delta, pair)
    np.testing.assert_allclose(laws.Parametric().load(delta, pair), expected, rtol=1e-13)


@pytest.mark.parametrize(
    ("pin", "hole"), [(STEEL, ALUMINIUM), (ALUMINIUM, STEEL), (PEEK, STEEL), (STEEL, PEEK)]
)
@pytest.mark.parametrize("datum", [1.5, 2.5])
def test_any_datum_shifts_the_law_as_it_shifts_the_reference(pin, hole, datum):
    pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=hole, material_j=pin)
    loads = PHI * pair.E_star * pair.dR
    expected = laws.Conformal(datum).penetration(loads, pair)
    found = laws.Parametric(datum).penetration(loads, pair)
    # δ is larger or smaller by the datum, the error in mm is the same.
    room = np.abs(5e-4 * laws.Conformal().penetration(loads, pair))
    assert (np.abs(found - expected) < room).all()
    shift = loads / (np.pi * pair.E_star)
    shift *= laws.Conformal(datum).constant(pair) - laws.Conformal().constant(pair)
    johnson = laws.Parametric().penetration(loads, pair)
    np.testing.assert_allclose(found, johnson + shift, rtol=1e-12)


def test_the_exact_constants_are_limits_of_the_series():
    """A0 and M0: what β adds to 2Â·S and M, over βu, as the arc vanishes."""
    beta, b = 0.3, np.array([2e-3, 1e-3])
    solution = glauert.glauert(b, beta)
    closed = glauert.closed_forms(b**2)
    u = b / np.sqrt(1 + b**2)
    slopes = (solution.a - closed.a) / (beta * u)
    limit = 2 * slopes[1] - slopes[0]  # Richardson, the next term being of order u
    assert parametric.CALIBRATED.A0 == pytest.approx(float(limit), rel=1e-4)


# --- grids of α, β and φ -------------------------------------------------------------------------

GRID = {
    "contact": "internal",
    "reference": "conformal",
    "axes": {
        "alpha": {"values": [-0.5, 0.0, 0.5]},
        "beta": {"values": [-0.3, 0.0, 0.3]},
        "phi": {"min": 0.01, "max": 1.0, "points": 3, "spacing": "log"},
    },
}


def test_a_grid_holds_the_pairs_that_are_possible():
    grid = grid_from(GRID, "inline")
    rows = list(zip(*grid.row_values(np.arange(grid.rows)), strict=True))
    assert rows == [(-0.5, -0.3), (-0.5, 0.0), (0.0, 0.0), (0.5, 0.0), (0.5, 0.3)]
    samples, counts = collect_samples(grid)
    assert (counts.samples, counts.masked) == (15, 0) == (grid.size, 0)
    np.testing.assert_allclose(samples.pair.E_star, 1, rtol=1e-14)
    for alpha, beta, phi, d in zip(
        samples.pair.alpha, samples.pair.beta, samples.load, samples.penetration, strict=True
    ):
        alone = CylinderPair.from_dundurs(alpha, beta)
        assert laws.Conformal().penetration(phi, alone) == pytest.approx(d, rel=1e-12)


def test_a_reference_that_needs_more_than_alpha_and_beta_is_told():
    with pytest.raises(InputError, match=r"reference = 'johnson': .* needs both radii"):
        grid_from(GRID | {"reference": "johnson"}, "inline")
    with pytest.raises(InputError, match="reference = 'persson'"):
        grid_from(GRID | {"reference": "persson"}, "inline")


# --- the campaigns -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "calibrated", "digits"),
    [("parametric", parametric.CALIBRATED, 4), ("explicit-pair", explicit_pair.CALIBRATED, 4)],
)
def test_the_constants_are_those_of_the_campaign(name, calibrated, digits):
    result = json.loads((ROOT / f"fitting/results/{name}.json").read_text())
    for key, value in result["coefficients"].items():
        assert getattr(calibrated, key) == pytest.approx(value, abs=0.51 * 10**-digits)
    assert result["objective"]["value"] < 0.9 * BOUNDS[name] or name == "explicit-pair"
    # Rounded, they are as good.
    problem, _ = problem_of(read_campaign(ROOT / f"fitting/{name}.toml"), 1, silent)
    rounded = {key: getattr(calibrated, key) for key in result["coefficients"]}
    assert problem.value_of(rounded) < 1.02 * result["objective"]["value"]
