"""Powers of the penetration, and the enhanced law: Eqs 5 and 6."""

from dataclasses import asdict

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp

from cylcontact import CylinderPair, Material, laws
from cylcontact.bodies.material import material_in_MPa
from cylcontact.laws import Enhanced, InternalCoefficients, LankaraniNikravesh, PowerLaw
from tests.support.paper_equations import e_star, factor_and_exponent
from tests.support.strategies import materials, powers_of_ten

STEEL = Material("steel", E=207e3, nu=0.3)
UNIT = CylinderPair.from_dR("internal", 1.0, material_in_MPa("", 1, 0))


@given(st.floats(0.5, 2.0), powers_of_ten(0, 8), powers_of_ten(-9, 0))
def test_load_and_stiffness_hold_at_forty_digits(n, K, delta):
    law = PowerLaw(n=n, K=K)
    with mp.workdps(40):
        load = mp.mpf(K) * mp.mpf(delta) ** mp.mpf(n)
        slope = mp.diff(lambda d: mp.mpf(K) * d ** mp.mpf(n), mp.mpf(delta), h=delta * 1e-12)
    assert law.load(delta, UNIT) == pytest.approx(float(load), rel=1e-15, abs=0)
    # n − 1 is rounded for n < 1, which a power of 1e-9 amplifies by its logarithm.
    assert law.stiffness(delta, UNIT) == pytest.approx(float(slope), rel=3e-15, abs=0)


@given(materials, st.floats(0.01, 500.0), st.floats(1.0, 2.0), st.floats(1e-6, 1.0))
def test_C_makes_the_law_dimensionless(material, dR, n, d):
    pair = CylinderPair.from_dR("external", dR, material)
    law, unit = PowerLaw(n=n, C=0.58), pair.E_star * dR
    assert law.load(d * dR, pair) / unit == pytest.approx(0.58 * d**n, rel=1e-12)
    scaled = PowerLaw(n=n, K_star=0.58 * dR ** (2 - n))
    assert law.load(d * dR, pair) == pytest.approx(float(scaled.load(d * dR, pair)), rel=1e-13)


BENT = {"A": 0.88, "p": 0.72, "n0": 1.13, "n1": -0.02, "q": 0.012, "n2": 0.001}


@given(materials, powers_of_ten(-2, 1), powers_of_ten(-6, -1))
def test_factor_and_exponent_follow_the_clearance_at_forty_digits(material, dR, delta):
    pair = CylinderPair.from_dR("internal", dR, material)
    A, p, n0, n1, q, n2 = map(mp.mpf, BENT.values())
    with mp.workdps(40):
        x = mp.log(mp.mpf(dR))
        K = A * mp.mpf(dR) ** p * mp.exp(q * x**2) * mp.mpf(float(pair.E_star)) / mp.mpf(dR)
        load = K * mp.mpf(delta) ** (n0 + n1 * x + n2 * x**2)
    assert laws.PowerClearance(**BENT).load(delta, pair) == pytest.approx(float(load), rel=1e-14)


@pytest.mark.parametrize("n", [1.5, 1.2])
def test_lankarani_and_nikravesh_is_eq_2_over_the_length(n, pair):
    E_star, R, length = 207e3 / (2 * 0.91), 10.0 * 9.5 / 0.5, 12.0
    total = 4 / 3 * E_star * R**0.5 * 0.002**n
    law = LankaraniNikravesh() if n == 1.5 else LankaraniNikravesh(n=n)
    assert law.load(0.002, pair) == pytest.approx(total / length, rel=2e-15)
    assert law.stiffness(0.002, pair) == pytest.approx(n * total / length / 0.002, rel=2e-15)


# --- the enhanced law -----------------------------------------------------------------------------

# ΔR in mm over the whole range that Eq 6 states, on both sides of the switch of Y, and beyond it.
INTERNAL = [0.005, 0.0075, 0.05, 0.1, 0.3, 0.349, 0.35, 0.5, 1.0, 3.0, np.nextafter(10.0, 0)]
EXTERNAL = [1.0, 5.0, 140.0, 500.0]
OUTSIDE = [1e-9, 0.001, 0.002, np.nextafter(0.005, 0.0), 10.0, 20.0]


@pytest.mark.parametrize(("contact", "gaps"), [("internal", INTERNAL), ("external", EXTERNAL)])
def test_the_published_law_is_eqs_5_and_6(contact, gaps):
    for dR in gaps:
        pair = CylinderPair.from_dR(contact, dR, STEEL)
        K, n = factor_and_exponent(e_star(207e3, 0.3), dR, contact)
        for load in (1.0, 10.0, 1000.0):
            delta = (load / K) ** (1 / n)
            assert Enhanced().penetration(load, pair) == pytest.approx(delta, rel=4e-15, abs=0)
            assert Enhanced().load(delta, pair) == pytest.approx(load, rel=4e-15)


def test_factor_and_exponent_follow_other_coefficients():
    """The switch of Y stays at the printed 0.34954 mm, and its branches may leave a jump."""
    own = InternalCoefficients(a=0.5, b=0.25, Y_offset=1.18, n_exponent=-0.1)
    dR, law = np.array([0.3, 0.35]), Enhanced(own)
    pair = CylinderPair.from_dR("internal", dR, STEEL)
    Y = np.array([1.51 * np.log(300.0) ** -0.151, 0.0151 * 0.35 + 1.18])
    np.testing.assert_allclose(law.exponent(pair), Y * dR**-0.1, rtol=1e-15)
    np.testing.assert_allclose(law.factor(pair), (0.5 * dR + 0.25) * pair.E_star / dR, rtol=1e-15)


@pytest.mark.parametrize(
    ("gaps", "changed"),
    [
        (OUTSIDE, {}), (0.05, {"b": -0.2}), (0.05, {"a": 0.0, "b": 0.0}),
        (0.05, {"Y_log_scale": -1.0, "Y_slope": 0.0, "Y_offset": 0.0}),
    ],
)  # fmt: skip
def test_where_the_law_has_no_stiffness_it_is_nan(gaps, changed):
    """A negative or zero factor or exponent would give a load of the wrong sign, or none."""
    law = Enhanced(asdict(InternalCoefficients()) | changed)
    pair = CylinderPair.from_dR("internal", np.array(gaps), STEEL)
    answers = [ask(1e-3, pair) for ask in (law.load, law.penetration, law.stiffness)]
    assert np.isnan([*answers, law.max_load(pair), law.max_penetration(pair)]).all()
    assert changed or np.isnan([law.factor(pair), law.exponent(pair)]).all()


def test_a_stiffer_law_differs_by_a_negative_percentage(pair):
    """Eq 9."""
    soft, stiff = PowerLaw(n=1.0, K=1.0), PowerLaw(n=1.0, K=4.0)
    laws_of = [(stiff, soft), (soft, stiff), (soft, soft)]
    percent = [laws.difference_percent(*each, 7.0, pair) for each in laws_of]
    assert percent == [-75.0, 300.0, 0.0]
