import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp
from scipy.integrate import solve_ivp

from cylcontact import CylinderPair, Material
from cylcontact.impact import (
    FACTORS,
    achieved_restitution,
    bounded_ratio,
    dissipative_load,
    dynamic_correction,
    exact_factor,
    friction_load,
    hysteresis_factor,
)
from cylcontact.joint import contact
from cylcontact.laws import Enhanced, Johnson, PowerLaw
from tests.support.strategies import ROUNDING

PUBLISHED = [name for name in FACTORS if name != "exact"]

V0, V1 = 1.0, 5.0

velocities = st.one_of(st.floats(-1e6, 1e6), st.floats(-2 * V1, 2 * V1))


# --- an isolated impact, simulated ------------------------------------------------------------

SHAFT = CylinderPair.internal(10.0, 9.5, Material("steel", E=207e3, nu=0.3), length=10.0)
ROLLERS = CylinderPair.external(80.0, 60.0, Material("steel", E=207e3, nu=0.3), length=10.0)
IMPACTS = {
    "power, n = 1.1": (PowerLaw(n=1.1, K=3e5), SHAFT),
    "johnson, external": (Johnson(), ROLLERS),
    "enhanced, internal": (Enhanced(), SHAFT),
}


def simulated_restitution(law, pair, chi, speed, mass=1e-4):
    """Let 0.1 kg (mass in tonnes) meet the other body at `speed` in mm/s, and bounce off."""

    def rates(_time, state):
        depth, rate = state
        # A trial step may end just outside, where a law has no answer.
        elastic = pair.length * law.load(max(depth, 0.0), pair)
        return rate, -dissipative_load(elastic, rate, speed, chi) / mass

    def separation(_time, state):
        return state[0]

    separation.terminal, separation.direction = True, -1
    flight = solve_ivp(
        rates, (0.0, 1.0), (0.0, speed), "DOP853",
        events=separation, rtol=1e-11, atol=(1e-16, 1e-11 * speed),
    )  # fmt: skip
    assert flight.status == 1, "the bodies did not part"
    return -flight.y_events[0][0, 1] / speed


# Speed in mm/s and mass in tonnes do not matter.
@pytest.mark.parametrize(("chi", "speed", "mass"), [(0.1425, 10.0, 1e-4), (9.0, 500.0, 1e-6)])
@pytest.mark.parametrize("impact", IMPACTS)
def test_a_simulated_impact_achieves_what_the_closed_form_says(impact, chi, speed, mass):
    achieved = simulated_restitution(*IMPACTS[impact], chi, speed, mass)
    assert achieved == pytest.approx(achieved_restitution(chi), abs=1e-9)


# --- achieved restitution and exact factor, against high precision ----------------------------


def exact_restitution(chi):
    """[1 + W₀(−(1 + χ)·exp(−(1 + χ)))]/χ with 120 digits, of which the branch point takes 80."""
    with mp.workdps(120):
        chi = mp.mpf(float(chi))
        return (1 + mp.lambertw(-(1 + chi) * mp.exp(-(1 + chi))).real) / chi


def exact_chi(restitution):
    """The root of χ(1 + e) = ln[(1 + χ)/(1 − χe)], sought in ln(1 − χe), with 80 digits."""
    with mp.workdps(80):
        e = mp.mpf(float(restitution))

        def chi(log):
            return -mp.expm1(log) / e

        def residual(log):
            # Over log² it has no double root at χ = 0 and changes sign once.
            return (mp.log1p(chi(log)) - log - chi(log) * (1 + e)) / log**2

        ends = (-(1 + e) / e - 1, -(1 - e) / 2)
        return chi(mp.findroot(residual, ends, solver="ridder"))


def test_restitution_and_factor_are_exact_to_a_few_roundings():
    for chi in [*np.geomspace(1e-12, 1e3, 61), *np.linspace(1.0, 6.0, 41)]:
        assert abs(achieved_restitution(chi) / exact_restitution(chi) - 1) < 8 * ROUNDING, chi
    near = 1 - np.geomspace(1e-15, 0.1, 31)
    for e in [*np.linspace(0.01, 0.99, 50), *near, *np.geomspace(3e-4, 0.9, 20)]:
        assert abs(exact_factor(e) / exact_chi(e) - 1) < 8 * ROUNDING, e


# --- the published factors --------------------------------------------------------------------

# By hand: at e = 1/2, at 9/10, and close to 1 over 1 − e, where 3/2 is exact.
BY_HAND = {
    "hunt-crossley": (3 / 4, 3 / 20, 3 / 2),
    "herbert-mcwhannell": (1.0, 15 / 91, 3 / 2),
    "lee-wang": (3 / 8, 3 / 40, 3 / 4),
    "lankarani-nikravesh": (9 / 16, 57 / 400, 3 / 2),
    "gonthier": (3 / 2, 19 / 90, 2.0),
    "zhiying-qishao": (9 / 16 * math.e, 57 / 400 * math.exp(0.2), 3 / 2),
    "flores": (8 / 5, 8 / 45, 8 / 5),
    "hu-guo": (3 / 2, 1 / 6, 3 / 2),
}


@pytest.mark.parametrize("name", PUBLISHED)
def test_a_published_factor_has_the_values_worked_out_by_hand(name):
    *values, slope = BY_HAND[name]
    factor = hysteresis_factor(name)
    np.testing.assert_allclose(factor([0.5, 0.9]), values, rtol=1e-15)
    # Close to an elastic impact it loses its share of what it should.
    lost = (1 - achieved_restitution(factor(1 - 1e-6))) / 1e-6
    assert lost == pytest.approx(slope / 1.5, rel=1e-5)


# --- the load ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rate", "factor", "load"),
    # K = 2, n = 1.5, δ = 4 mm make 16 N, and 4 mm/s at first touch; then fast parting, unknowns.
    [(3.0, 0.5, 22.0), (-4.0, 1.0, 0.0), (-3.0, 1.0, 4.0), (-1e6, 1.0, 0.0), (np.nan, 1.0, np.nan)],
)
def test_the_load_is_eq_3_and_never_pulls(rate, factor, load):
    np.testing.assert_equal(dissipative_load(16.0, rate, 4.0, factor), load)
    np.testing.assert_equal(dissipative_load(np.nan, rate, 4.0, factor), np.nan)
    np.testing.assert_equal(dissipative_load(16.0, rate, np.nan, factor), np.nan)


@pytest.mark.parametrize("impact_rate", [2.0, 1e-300, 0.0, -5.0])
def test_below_the_floor_the_floor_counts(impact_rate):
    assert dissipative_load(100.0, 3.0, impact_rate, 0.5, floor=2.0) == 175.0
    assert dissipative_load(100.0, 3.0, 6.0, 0.5, floor=2.0) == 125.0


@given(st.floats(-1e300, 1e300))
def test_the_damping_is_bounded_and_that_of_the_paper_in_an_isolated_impact(u):
    bounded = float(bounded_ratio(u))
    assert bounded == pytest.approx(contact.bounded_ratio(u), rel=1e-15, abs=0)
    assert bounded == u if abs(u) <= 10 else 10 <= abs(bounded) <= min(20, abs(u))
    assert bounded == -bounded_ratio(-u)


# --- friction, Eqs 14 and 15 ------------------------------------------------------------------


def test_the_correction_is_eq_15():
    speeds = [0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 7.0, np.inf]
    expected = [0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0]
    assert dynamic_correction(speeds, V0, V1).tolist() == expected
    assert dynamic_correction([0.0, 1.0, 2.0, 4.0], 0.0, 4.0).tolist() == [0.0, 0.25, 0.5, 1.0]
    assert dynamic_correction(1e308, 0.0, 1e-308) == 1.0


def test_the_friction_is_eq_14():
    """50 N, c_f = 0.1: 5 N in full sliding, a quarter of that at v0 + (v1 − v0)/4."""
    velocities = [-20.0, -2.0, -1.0, -0.0, 0.0, 1.0, 2.0, 20.0]
    expected = [5.0, 1.25, 0.0, 0.0, 0.0, 0.0, -1.25, -5.0]
    load = friction_load(50.0, velocities, 0.1, V0, V1)
    assert load.tolist() == expected
    assert not np.signbit(load[3:5]).any()  # no negative zero
    assert np.isnan(friction_load([-1.0, -1e-300, -np.inf, np.nan], 20.0, 0.1, V0, V1)).all()
    assert np.isnan(friction_load(50.0, np.nan, 0.1, V0, V1))
