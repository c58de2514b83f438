import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp

from cylcontact import CylinderPair, Material
from cylcontact.bodies.material import material_in_MPa
from cylcontact.laws import Johnson, lambert
from tests.support.strategies import ROUNDING, fractions, gaps, moduli, pairs, ratios

LAW = Johnson()
TINY = 10.0 ** -np.linspace(0, 300, 121)[1:]
MIDDLE = np.linspace(0.01, 0.9, 90)
NEAR = 1 - 10.0 ** -np.linspace(1, 16, 121)
LAST = 1 - np.arange(20) * 2.0**-53
SWEEP = np.concatenate([TINY[::10], MIDDLE[::10]])
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


def error_in_roundings(value, exact):
    return float(abs(mp.mpf(float(value)) / exact - 1)) / ROUNDING


@pytest.fixture(autouse=True)
def forty_digits():
    with mp.workdps(40):
        yield


# --- the branch of Lambert's function -----------------------------------------------------------

DENSE = np.concatenate([
    10.0 ** -np.linspace(0.001, 300, 501), 1 - 10.0 ** -np.linspace(1, 16, 301),
    1 - np.arange(1, 65) * 2.0**-53,  # the last 64 numbers below 1
    np.arange(1, 20) * 5e-324,  # the first subnormals
])  # fmt: skip


def test_w_is_right_to_a_few_roundings_at_both_ends_and_between():
    """In arrays of any layout and for one number; against mpmath's own Lambert function."""
    exact = [-mp.lambertw(-mp.mpf(float(p)) / mp.e, -1).real - 1 for p in DENSE]
    in_arrays = lambert.branch_distance(np.repeat(DENSE, 4).reshape(-1, 4).T[1])
    for w in (in_arrays, np.array([lambert.branch_distance_of_number(p) for p in DENSE])):
        errors = [abs(mp.mpf(float(x)) / y - 1) for x, y in zip(w, exact, strict=True)]
        assert max(errors) < 7 * ROUNDING
    for ask in (lambert.branch_distance, lambert.branch_distance_of_number):
        ends = [float(ask(p)) for p in (1.0, 0.0, -0.0, 1.1, np.nan)]
        np.testing.assert_array_equal(ends, [0.0, np.inf, np.inf, np.nan, np.nan])


def test_numbers_arrays_and_compiled_code_are_equal_to_the_bit(monkeypatch):
    """The loop over arrays and NumPy's passes, of a whole array, of parts and of single numbers."""
    p = np.concatenate(
        [DENSE, np.random.default_rng(1).uniform(size=2000), [0.0, 1.0, 1.1, np.nan]]
    )
    by_numpy = lambert.branch_share(p)
    singles = [lambert.branch_share(x) for x in p]
    monkeypatch.setattr(lambert, "_PAYS_AFTER", 0)
    for shares in (
        singles,
        lambert.branch_share(p),
        lambert.branch_share(np.stack([p, p]))[1],
    ):
        np.testing.assert_array_equal(shares, by_numpy)
    assert lambert.compiled_shares().signatures  # the compiled loop has run
    np.testing.assert_array_equal(by_numpy[-4:], [0, 1, np.nan, np.nan])


# --- the law against Eq 1 ---------------------------------------------------------------------


def test_penetration_is_that_of_eq_1_and_load_is_its_root(case):
    pair = build(*case)
    exact = Exact(pair)
    for load in np.concatenate([SWEEP, NEAR, LAST[1:]]) * LAW.max_load(pair):
        assert error_in_roundings(LAW.penetration(load, pair), exact.penetration(load)) < 8
    for delta in np.concatenate([SWEEP, NEAR]) * LAW.max_penetration(pair):
        assert error_in_roundings(delta, exact.penetration(LAW.load(delta, pair))) < 8


# --- the round trip and the ends of the domain ------------------------------------------------


@given(pairs)
def test_the_law_ends_with_the_last_number_up_to_its_limit(pair):
    deepest, largest = LAW.max_penetration(pair), LAW.max_load(pair)
    assert (LAW.load(deepest, pair), LAW.penetration(largest, pair)) == (largest, deepest)
    beyond = [ask(np.nextafter(deepest, np.inf), pair) for ask in (LAW.load, LAW.stiffness)]
    assert np.isnan([*beyond, LAW.penetration(np.nextafter(largest, np.inf), pair)]).all()


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
