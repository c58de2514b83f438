import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp

from cylcontact import CylinderPair, Material
from cylcontact.laws import Johnson
from cylcontact.materials import material_in_MPa
from tests.support.strategies import ROUNDING, fractions, gaps, moduli, pairs, ratios

LAW = Johnson()
TINY = 10.0 ** -np.linspace(0, 300, 121)[1:]
MIDDLE = np.linspace(0.01, 0.9, 90)
NEAR = 1 - 10.0 ** -np.linspace(1, 16, 121)
LAST = 1 - np.arange(20) * 2.0**-53
DENSE = np.concatenate([TINY, MIDDLE, NEAR, LAST])

# A coarse sweep in front of the root finder; closer than 1e-15 to the limit the penetration's own
# rounding decides whether Eq 1 has a solution, and the round trip is the test there.
SWEEP = np.concatenate([TINY[::10], MIDDLE[::10], 1 - 10.0 ** -np.arange(1.0, 15.5, 0.5)])
PAIRS = {
    "paper's Fig 2": ("internal", 0.05, 207e3, 0.3),
    "clearance of microns": ("internal", 0.0075, 69e3, 0.33),
    "rollers": ("external", 140.0, 207e3, 0.3),
    "rubber": ("external", 500.0, 1.5, 0.5),
}


@pytest.fixture(params=PAIRS.values(), ids=PAIRS)
def case(request):
    return request.param


def build(contact, dR, E, nu):
    return CylinderPair.from_dR(contact, dR, material_in_MPa("any", E=E, nu=nu))


class Exact:
    """Eq 1 at 40 digits for one pair of equal materials, as the paper prints it."""

    def __init__(self, pair):
        self.E_star = mp.mpf(pair.material_i.E) / (2 * (1 - mp.mpf(pair.material_i.nu) ** 2))
        self.dR = mp.mpf(float(pair.dR))

    def penetration(self, load):
        f = mp.mpf(load)
        return f / (mp.pi * self.E_star) * (mp.log(4 * mp.pi * self.E_star * self.dR / f) - 1)

    def p(self, penetration):
        """The part of the way to the limit penetration, 4ΔR/e²."""
        return mp.mpf(penetration) * mp.e**2 / (4 * self.dR)

    def load_by_root_finding(self, penetration):
        """Solve Eq 1 for ln f between a bound far below the root and Eq 8."""
        delta = mp.mpf(penetration)
        top = mp.log(4 * mp.pi * self.E_star * self.dR)

        def residual(log_load):
            return mp.log(mp.pi * self.E_star * delta / (top - log_load - 1)) - log_load

        bracket = (top - 12 + 2 * mp.log(self.p(delta)), top - 2)
        return mp.exp(mp.findroot(residual, bracket, solver="bisect", maxsteps=200))

    def w(self, penetration):
        return -1 - mp.lambertw(-self.p(penetration) / mp.e, -1).real

    def load(self, penetration):
        return mp.pi * self.E_star * mp.mpf(penetration) / (1 + self.w(penetration))


def error_in_roundings(value, exact):
    return float(abs(mp.mpf(float(value)) / exact - 1)) / ROUNDING


@pytest.fixture(autouse=True)
def forty_digits():
    with mp.workdps(40):
        yield


# --- the law against Eq 1 ---------------------------------------------------------------------


def test_penetration_is_that_of_eq_1(case):
    pair = build(*case)
    exact = Exact(pair)
    for load in np.concatenate([SWEEP, NEAR, LAST[1:]]) * LAW.max_load(pair):
        assert error_in_roundings(LAW.penetration(load, pair), exact.penetration(load)) < 8


def test_load_is_the_root_of_eq_1(case):
    """The error is a few roundings times (1 + w)/w, the condition number of Eq 1's inverse."""
    pair = build(*case)
    exact = Exact(pair)
    for delta in SWEEP * LAW.max_penetration(pair):
        condition = 1 + (1 + exact.w(delta)) / exact.w(delta)
        error = error_in_roundings(LAW.load(delta, pair), exact.load_by_root_finding(delta))
        assert error < 6 * condition


def test_the_closed_form_with_lamberts_function_is_the_root_of_eq_1(case):
    exact = Exact(build(*case))
    for p in (1e-300, 1e-8, 0.1, 0.5, 0.99, 1 - 1e-12):
        delta = p * 4 * float(exact.dR) / np.e**2
        assert mp.almosteq(exact.load(delta), exact.load_by_root_finding(delta), rel_eps=1e-25)


@given(pairs, fractions)
def test_load_solves_eq_1_for_a_penetration_within_rounding_up_to_the_limit(pair, fraction):
    """Backward error: the exact penetration under the computed load is the one asked for."""
    delta = fraction * LAW.max_penetration(pair)
    with mp.workdps(40):
        exact = Exact(pair).penetration(LAW.load(delta, pair))
        assert error_in_roundings(delta, exact) < 8


def test_stiffness_is_the_derivative_of_the_load(case):
    """The condition number is (1 + w)/w², for the stiffness has a pole at the limit."""
    pair = build(*case)
    exact = Exact(pair)
    for p in (*TINY[::10], *MIDDLE[::10], *(1 - 10.0 ** -np.arange(1.0, 13))):
        delta = float(p * LAW.max_penetration(pair))
        with mp.workdps(80):
            step = mp.mpf(delta) * mp.mpf(10) ** -25
            above, below = exact.load(delta + step), exact.load(delta - step)
            slope = (above - below) / (2 * step)
        w = exact.w(delta)
        error = error_in_roundings(LAW.stiffness(delta, pair), slope)
        assert error < 6 * (1 + (1 + w) / w**2)


# --- the round trip and the ends of the domain ------------------------------------------------


def test_penetration_comes_back_from_its_load_over_a_dense_sweep(case):
    pair = build(*case)
    delta = DENSE * LAW.max_penetration(pair)
    back = LAW.penetration(LAW.load(delta, pair), pair)
    np.testing.assert_allclose(back, delta, rtol=1.5e-15)


@given(pairs)
def test_the_limits_belong_to_each_other_exactly(pair):
    assert LAW.load(LAW.max_penetration(pair), pair) == LAW.max_load(pair)
    assert LAW.penetration(LAW.max_load(pair), pair) == LAW.max_penetration(pair)


@given(pairs)
def test_one_unit_in_the_last_place_beyond_the_limit_there_is_no_law(pair):
    deeper = np.nextafter(LAW.max_penetration(pair), np.inf)
    assert np.isnan(LAW.load(deeper, pair))
    assert np.isnan(LAW.stiffness(deeper, pair))
    assert np.isnan(LAW.penetration(np.nextafter(LAW.max_load(pair), np.inf), pair))


def test_the_end_is_exact_beside_elements_outside_the_domain(pair):
    limit = LAW.max_penetration(pair)
    given = [0.0, limit, 2 * limit, np.nan, -1.0]
    np.testing.assert_array_equal(LAW.load(given, pair), [0, LAW.max_load(pair), np.nan, np.nan, 0])
    np.testing.assert_array_equal(LAW.stiffness(given[1:], pair), [np.inf, np.nan, np.nan, 0])


# --- one curve --------------------------------------------------------------------------------

UNIT = CylinderPair.from_dR("internal", 1.0, material_in_MPa("unit", E=2.0, nu=0.0))  # E* = ΔR = 1


@given(pairs, fractions)
def test_penetration_over_dR_depends_only_on_load_over_E_star_dR(pair, fraction):
    phi = 0.999 * fraction * LAW.max_load(UNIT)
    d = LAW.penetration(phi * pair.E_star * pair.dR, pair) / pair.dR
    assert d == pytest.approx(LAW.penetration(phi, UNIT), rel=1.5e-15, abs=0)


# --- different materials ----------------------------------------------------------------------


def half_planes(load, pair):
    """Johnson's derivation: each body compresses by (1−ν²)/(πE)·f·(2 ln(4R/a) − 1)."""
    bodies = ((pair.material_i, pair.R_i), (pair.material_j, pair.R_j))
    compliances = [(1 - mp.mpf(m.nu) ** 2) / mp.mpf(m.E) for m, _ in bodies]
    radii = [mp.mpf(float(R)) for _, R in bodies]
    R = radii[0] * radii[1] / mp.mpf(float(pair.dR))
    f = mp.mpf(load)
    a = mp.sqrt(4 * f * R * sum(compliances) / mp.pi)
    parts = zip(compliances, radii, strict=True)
    return sum(c * f / mp.pi * (2 * mp.log(4 * R_k / a) - 1) for c, R_k in parts)


@pytest.mark.parametrize("contact", ["internal", "external"])
@given(st.tuples(moduli, moduli), st.tuples(ratios, ratios), gaps, fractions)
def test_different_materials_add_the_compression_of_each_body(contact, E, nu, R_j, fraction):
    one, other = (Material("any", *values) for values in zip(E, nu, strict=True))
    pair = getattr(CylinderPair, contact)(2 * R_j, R_j, one, material_j=other)
    load = float(fraction * LAW.max_load(pair))
    with mp.workdps(40):
        error = error_in_roundings(LAW.penetration(load, pair), half_planes(load, pair))
    assert error < 12


@pytest.mark.parametrize("step", [1e-2, 1e-4, 1e-6, 1e-9, 1e-12, 1e-15])
def test_different_materials_become_equal_ones_continuously(step, steel):
    nearly = Material("nearly steel", E=steel.E * (1 + step), nu=steel.nu)
    equal = CylinderPair.internal(10.0, 9.0, steel)
    unequal = CylinderPair.internal(10.0, 9.0, steel, material_j=nearly)
    change = LAW.penetration(100.0, unequal) / LAW.penetration(100.0, equal) - 1
    assert abs(change) < step + 8 * ROUNDING


def test_materials_equal_in_stiffness_count_as_equal_and_need_no_radii(steel):
    twin = Material("twin", E=steel.E, nu=steel.nu)
    alone = CylinderPair.from_dR("internal", 0.5, steel)
    with_twin = CylinderPair.from_dR("internal", 0.5, steel, material_j=twin)
    assert LAW.load(1e-3, alone) == LAW.load(1e-3, with_twin)


def test_equal_elements_of_an_unequal_family_follow_the_equal_law(steel):
    family = Material("family", E=[207e3, 100e3], nu=0.3)
    mixed = CylinderPair.internal(10.0, 9.0, steel, material_j=family)
    alone = CylinderPair.internal(10.0, 9.0, steel)
    first, second = LAW.load(1e-3, mixed)
    assert first == pytest.approx(LAW.load(1e-3, alone), rel=1e-15)
    assert second < 0.7 * first


@given(pairs, fractions)
def test_swapping_the_bodies_of_an_external_pair_changes_nothing(pair, fraction):
    brass = Material("brass", 100e3, 0.34)
    R_i, R_j = float(pair.dR), 1.0
    there = CylinderPair.external(R_i, R_j, pair.material_i, material_j=brass)
    back = CylinderPair.external(R_j, R_i, brass, material_j=pair.material_i)
    load = 0.9 * fraction * LAW.max_load(there)
    once = LAW.penetration(load, there)
    assert LAW.penetration(load, back) == pytest.approx(once, rel=2e-15, abs=0)
