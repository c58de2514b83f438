"""The curve of conformal contact against the arcs that it is made of, and at its ends."""

import numpy as np
import pytest
from mpmath import mp

from cylcontact import CylinderPair, Material
from cylcontact.bodies.material import material_in_MPa
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.laws.conformal.arcs import Bodies
from tests.support.samples import sampled

STEEL, ALUMINIUM = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
BRONZE, PTFE = Material("bronze", 110e3, 0.34), Material("PTFE", "500 MPa", 0.46)
RUBBER, CONSTANT = Material("rubber", "10 MPa", 0.5), Material("of constant volume", 110e3, 0.5)


def pair_of(pin, hole):
    return CylinderPair.internal(R_i=10.0, R_j=9.95, pin=pin, hole=hole, length=20.0)


PAIR = pair_of(STEEL, BRONZE)
CASES = {
    "steel in steel": (pair_of(STEEL, STEEL), "johnson"),
    "steel in aluminium": (pair_of(STEEL, ALUMINIUM), "johnson"),
    "a number as datum": (pair_of(STEEL, ALUMINIUM), 3.0),
    "PTFE in steel": (pair_of(PTFE, STEEL), "johnson"),
    "steel in PTFE": (pair_of(STEEL, PTFE), "johnson"),
    "rubber in steel": (pair_of(RUBBER, STEEL), "johnson"),
    "steel in rubber": (pair_of(STEEL, RUBBER), "johnson"),
    "ring 2": (PAIR, Housing(20.0)),
    "ring 1.2": (PAIR, Housing(12.0)),
    "ring of constant volume": (pair_of(STEEL, CONSTANT), Housing(20.0)),
    "rubber ring": (pair_of(STEEL, RUBBER), Housing(20.0)),
    "far 60": (PAIR, Housing(20.0, Sector(60, "pulled"))),
    "near 60": (PAIR, Housing(20.0, Sector(60, "pushed"))),
    "layers": (PAIR, Housing(20.0, layers=[(STEEL, 12.0)])),
    "PTFE bush": (pair_of(STEEL, PTFE), Housing(20.0, layers=[(STEEL, 12.0)])),
    "thin far 60": (pair_of(STEEL, STEEL), Housing(13.0, Sector(60, "pulled"))),
    "thin far 300": (PAIR, Housing(13.0, Sector(300, "pulled"))),
    "very thin far 60": (pair_of(STEEL, STEEL), Housing(11.0, Sector(60, "pulled"))),
}
# A case of each kind; the others have other numbers.
FEW = ("steel in aluminium", "a number as datum", "rubber in steel", "ring of constant volume",
       "near 60", "layers", "thin far 60", "PTFE bush")  # fmt: skip
every_case = pytest.mark.parametrize("name", sampled(CASES, FEW))


@every_case
def test_the_curve_is_that_of_the_arcs_from_tiny_loads_to_huge_ones(name):
    pair, datum = CASES[name]
    curve = Conformal(datum).curve(pair)
    thin = 10 if "thin" in name else 1
    phi = np.geomspace(1e-12, min(1e6, curve.end[0] * (1 - 1e-9)), 3001)
    arc = curve.bodies.with_slopes(curve.bodies.arc_of_load(phi))
    phi = arc.phi
    d = phi * arc.L / np.pi
    np.testing.assert_allclose(curve.load(d), phi, rtol=1e-10 * thin)
    np.testing.assert_allclose(curve.penetration(phi), d, rtol=1e-10 * thin)
    np.testing.assert_allclose(curve.angle(phi), arc.angle, rtol=1e-9)
    compliance = arc.L + arc.L_slope / arc.phi_slope
    np.testing.assert_allclose(curve.stiffness(d), np.pi / compliance, rtol=1e-9 * thin)
    energy = phi * d * curve.bodies.work(arc)
    np.testing.assert_allclose(curve.energy(d), energy, rtol=1e-10 * thin)
    # In eyes the largest pressure leaves the line of the load, where its curve has a bend.
    peak, _ = curve.bodies.pressure(arc)
    allowed = 1e-5 if "far" in name else 1e-8
    np.testing.assert_allclose(curve.peak(phi), peak, rtol=allowed)


@every_case
def test_load_and_penetration_are_inverse(name):
    pair, datum = CASES[name]
    law = Conformal(datum)
    rng = np.random.default_rng(63)
    last = min(1e6, 0.999 * law.curve(pair).end[0])
    f = np.exp(rng.uniform(np.log(1e-40), np.log(last), 3000)) * pair.E_star * pair.dR
    delta = law.penetration(f, pair)
    np.testing.assert_allclose(law.load(delta, pair), f, rtol=1e-12)
    np.testing.assert_allclose(law.penetration(law.load(delta, pair), pair), delta, rtol=1e-12)


@every_case
def test_the_energy_is_the_integral_of_the_load(name):
    pair, datum = CASES[name]
    law = Conformal(datum)
    last = min(30.0, 0.999 * law.curve(pair).end[0])
    f = np.geomspace(1e-18, last, 9) * pair.E_star * pair.dR
    deepest = law.penetration(f, pair)
    x, weights = np.polynomial.legendre.leggauss(1000)
    s = (1 + x) / 2
    wanted = deepest * (weights * s * law.load(deepest[:, None] * s**2, pair)).sum(axis=1)
    np.testing.assert_allclose(law.energy(deepest, pair), wanted, rtol=2e-10)


@pytest.mark.parametrize("exponent", [-18, -12, -6, -2, 0, 2])
def test_the_energy_of_one_material_is_the_closed_form(exponent):
    """U = φ·(d − (H − 1))/2 at sixty digits, with H − 1 = 2S − 1 − c²·ln(c)/S."""
    pair = CylinderPair.from_dR("internal", 1.0, material_in_MPa("unit", E=2.0, nu=0.0))
    with mp.workdps(60):
        b2 = mp.mpf(10) ** exponent / (1 + mp.mpf(10) ** exponent) * mp.mpf("0.83")
        S = b2 / (1 + b2)
        c = 1 - S
        H = 2 * S - c**2 * mp.log(c) / S
        phi = mp.pi / (c**2 / S - H / 2)
        d = phi / mp.pi * (-mp.log(S) + S**2 / 2 + H / 2 + 2 * mp.log(2) - mp.mpf(3) / 2)
        energy = phi * (d - H + 1) / 2
    assert Conformal().energy(float(d), pair) == pytest.approx(float(energy), rel=1e-10)


def test_numbers_at_the_ends_of_the_scale():
    law, pair = Conformal(), pair_of(STEEL, ALUMINIUM)
    numbers = [-np.inf, -1.0, 0.0, np.inf, np.nan]
    zero_below, nan_below = [0, 0, 0, np.inf, np.nan], [np.nan, np.nan, 0, np.inf, np.nan]
    for ask in (law.load, law.energy):
        np.testing.assert_array_equal(ask(numbers, pair), zero_below)
    for ask in (law.penetration, law.peak_pressure):
        np.testing.assert_array_equal(ask(numbers, pair), nan_below)
    last = np.degrees(law.curve(pair).bodies.last.angle)
    expected = [np.nan, np.nan, 0, last, np.nan]
    np.testing.assert_allclose(law.contact_angle(numbers, pair), expected, rtol=1e-12)
    stiffness = law.stiffness(numbers, pair)
    np.testing.assert_array_equal(stiffness[:3], 0)
    assert stiffness[3] == pytest.approx(float(law.load(1e20, pair)) / 1e20, rel=1e-9)
    assert np.isnan(stiffness[4])


# --- the end of a hole that keeps its volume ------------------------------------------------------


def test_a_hole_of_constant_volume_is_the_limit_of_others():
    numbers = np.array([0.01, 1.0, 100.0])
    answers = []
    for nu in (0.4999, 0.49999, 0.5):
        pair = pair_of(STEEL, Material("soft", "10 MPa", nu))
        law = Conformal(Housing(20.0))
        answers.append(law.penetration(numbers * pair.E_star * pair.dR, pair))
    first, second = (np.abs(answer / answers[-1] - 1) for answer in answers[:2])
    assert np.all(second < 0.2 * first)
    assert np.all(second < 1e-3)


def test_a_hole_of_constant_volume_answers_up_to_its_end():
    pair, law = pair_of(STEEL, RUBBER), Conformal(Housing(20.0))
    largest, deepest = law.max_load(pair), law.max_penetration(pair)
    assert np.isfinite([largest, deepest]).all()
    assert law.contact_angle(largest * (1 - 1e-9), pair) == pytest.approx(165.0, abs=1e-3)
    near = 1 - 1e-9
    assert law.load(deepest * near, pair) == pytest.approx(float(largest), rel=1e-7)
    assert np.isnan(law.load(deepest * 1.001, pair))
    assert np.isnan(law.penetration(largest * 1.001, pair))
    loads = law.load(np.geomspace(1e-12, near, 500) * deepest, pair)
    assert np.all(np.diff(loads) > 0)


# --- rows ---------------------------------------------------------------------------------------


def test_rows_of_every_possible_pair_are_their_own_series():
    """Over α and β up to their limits, next to β = 0 as well."""
    rng = np.random.default_rng(5)
    alpha = np.concatenate([rng.uniform(-0.999, 0.999, 20), [0.999, 0.999, -0.999, 0.5]])
    beta = (alpha - 1) / 4 + rng.uniform(0, 1, 24) / 2
    beta[20:] = 1e-6, -1e-4, -1e-3, 3e-5
    phi = np.geomspace(1e-9, 1e6, 40)
    rows = CylinderPair.from_dundurs(alpha[:, None], beta[:, None])
    d = Conformal().penetration(phi, rows)
    w_i, C = (1 - alpha) / 2, 2 * np.log(2) - 2 + (1 + alpha) / 2
    for k in range(alpha.size):
        bodies = Bodies(np.float64(w_i[k]), float(beta[k]), np.float64(C[k]))
        np.testing.assert_allclose(d[k], bodies.penetration(phi), rtol=1e-10)


@pytest.mark.parametrize("loads", [3, 300])
def test_a_band_of_housings_is_its_members(loads):
    R_i = 10 + np.array([[0.0], [0.005], [0.0105]])
    R_j = R_i - np.array([[0.0035], [0.012], [0.0205]])
    band = CylinderPair("internal", R_i - R_j, BRONZE, STEEL, R_i, R_j)
    law, f = Conformal(Housing(13.0, Sector(60, "pulled"))), np.geomspace(1.0, 1e3, loads)
    delta = law.penetration(f, band)
    assert delta.shape == (3, loads)
    for k in range(3):
        one = CylinderPair.internal(float(R_i[k, 0]), float(R_j[k, 0]), pin=STEEL, hole=BRONZE)
        np.testing.assert_allclose(delta[k], law.penetration(f, one), rtol=1e-10)
