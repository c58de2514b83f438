import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp

from cylcontact import CylinderPair, InputError
from cylcontact.bodies.material import material_in_MPa
from cylcontact.laws import LankaraniNikravesh, PowerClearance, PowerLaw
from tests.support.strategies import materials, powers_of_ten

exponents = st.floats(1.0, 2.0)


# --- f = K·δⁿ ---------------------------------------------------------------------------------


@given(st.floats(0.5, 2.0), powers_of_ten(0, 8), powers_of_ten(-9, 0))
def test_load_and_stiffness_hold_at_forty_digits(n, K, delta):
    law, anywhere = (
        PowerLaw(n=n, K=K),
        CylinderPair.from_dR("internal", 1.0, material_in_MPa("", 1, 0)),
    )
    with mp.workdps(40):
        load = mp.mpf(K) * mp.mpf(delta) ** mp.mpf(n)
        slope = mp.diff(lambda d: mp.mpf(K) * d ** mp.mpf(n), mp.mpf(delta), h=delta * 1e-12)
    assert law.load(delta, anywhere) == pytest.approx(float(load), rel=1e-15, abs=0)
    # n − 1 is rounded for n < 1, which a power of 1e-9 amplifies by its logarithm.
    assert law.stiffness(delta, anywhere) == pytest.approx(float(slope), rel=3e-15, abs=0)


@given(materials, st.floats(0.01, 500.0), exponents, st.floats(1e-6, 1.0))
def test_C_makes_the_law_dimensionless(material, dR, n, d):
    pair = CylinderPair.from_dR("external", dR, material)
    law, unit = PowerLaw(n=n, C=0.58), pair.E_star * dR
    assert law.load(d * dR, pair) / unit == pytest.approx(0.58 * d**n, rel=1e-12)
    scaled = PowerLaw(n=n, K_star=0.58 * dR ** (2 - n))
    assert law.load(d * dR, pair) == pytest.approx(float(scaled.load(d * dR, pair)), rel=1e-13)


# --- factor and exponent by the clearance -----------------------------------------------------

BENT = {"A": 0.88, "p": 0.72, "n0": 1.13, "n1": -0.02, "q": 0.012, "n2": 0.001}


@given(materials, powers_of_ten(-2, 1), powers_of_ten(-6, -1))
def test_factor_and_exponent_follow_the_clearance_at_forty_digits(material, dR, delta):
    pair = CylinderPair.from_dR("internal", dR, material)
    A, p, n0, n1, q, n2 = map(mp.mpf, BENT.values())
    with mp.workdps(40):
        x = mp.log(mp.mpf(dR))
        K = A * mp.mpf(dR) ** p * mp.exp(q * x**2) * mp.mpf(float(pair.E_star)) / mp.mpf(dR)
        load = K * mp.mpf(delta) ** (n0 + n1 * x + n2 * x**2)
    assert PowerClearance(**BENT).load(delta, pair) == pytest.approx(float(load), rel=1e-14)


@pytest.mark.parametrize(("name", "value"), [("A", 0.0), ("A", np.nan), ("n1", np.inf)])
def test_constants_that_are_no_numbers_are_refused(name, value):
    with pytest.raises(InputError, match=f"PowerClearance: {name} = .*: must be finite"):
        PowerClearance(**{**BENT, name: value})


# --- Lankarani and Nikravesh ------------------------------------------------------------------


@pytest.mark.parametrize("n", [1.5, 1.2])
def test_lankarani_and_nikravesh_is_eq_2_over_the_length(n, pair):
    E_star, R, length = 207e3 / (2 * 0.91), 10.0 * 9.5 / 0.5, 12.0
    total = 4 / 3 * E_star * R**0.5 * 0.002**n
    law = LankaraniNikravesh() if n == 1.5 else LankaraniNikravesh(n=n)
    assert law.load(0.002, pair) == pytest.approx(total / length, rel=2e-15)
    assert law.stiffness(0.002, pair) == pytest.approx(n * total / length / 0.002, rel=2e-15)
