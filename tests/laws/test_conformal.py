"""Persson's law against forty digits and direct quadrature."""

import numpy as np
import pytest
from mpmath import mp

from cylcontact import CylinderPair
from cylcontact.bodies.material import material_in_MPa
from cylcontact.laws import Persson

LAW = Persson()
U = 0.8346152454776572  # the root of 2 − 2u² − ln(1 + u)
# With E* = 1 MPa and ΔR = 1 mm a load is φ and a penetration is δ/ΔR.
UNIT = CylinderPair.from_dR("internal", 1.0, material_in_MPa("unit", E=2.0, nu=0.0))
# R_i of a pair of ΔR = 1 mm and √(R_i·R_j) = 1 mm.
GOLDEN = (1 + 5**0.5) / 2
peak_pressure = LAW.peak_pressure


def contact_angle(load, pair):
    """The semi-angle in radians."""
    return np.radians(LAW.contact_angle(load, pair))


# --- the formulas at high precision -----------------------------------------------------------


def N_mp(u):
    return 2 - 2 * u**2 - mp.log(1 + u)


def U_mp():
    return mp.findroot(N_mp, mp.mpf(U))


def load_mp(u):
    return 2 * mp.pi * u * (1 + u) / N_mp(u)


def approach_mp(u):
    small = mp.log(1 + u) / (2 * u * (1 + u)) - 2 / (1 + u) + 1 / (2 * (1 + u) ** 2)
    return mp.log(4 * (1 + u) / u) + small


def pressure_mp(angle, u):
    """R·p/f, as Persson wrote it."""
    y, B = mp.tan(angle / 2), mp.sqrt(1 + u)
    s = mp.sqrt(abs(u - y**2))
    logarithm = mp.log((B + s) / (B - s)) / (2 * mp.pi * u * (1 + u))
    return 2 * s / (mp.pi * B * (1 + y**2)) + logarithm


def integral_over_arc(integrand, u, *points):
    """Integrate over θ from −ε to ε, with breaks at `points`."""
    epsilon = 2 * mp.atan(mp.sqrt(u))
    return mp.quad(integrand, sorted([-epsilon, mp.mpf(0), epsilon, *points]))


def gap_mp(angle, u):
    """π·E*/f·w(θ) by quadrature of the pressure, with the datum C = 2ln 2 − 3/2."""

    def integrand(other):
        alpha = angle - other
        log = mp.log(2 * abs(mp.sin(alpha / 2)))
        return pressure_mp(other, u) * (-2 * mp.cos(alpha) * log - mp.mpf(1) / 2)

    return integral_over_arc(integrand, u, angle) + (2 * mp.log(2) - 1.5) * mp.cos(angle)


ARCS = [1e-12, 1e-6, 1e-3, 0.05, 0.3, 0.7, 0.8346, U - 1e-9]


@pytest.mark.parametrize("part", [0.0, 0.3, 0.7, 1.0])
@pytest.mark.parametrize("u", ARCS)
def test_hole_and_pin_touch_all_along_the_arc(u, part):
    """w(θ) = δcos θ − ΔR(1 − cos θ), with δ in closed form and w by quadrature."""
    with mp.workdps(40):
        u = mp.mpf(u)
        angle = part * 2 * mp.atan(mp.sqrt(u))
        initial = mp.pi / load_mp(u) * (1 - mp.cos(angle))
        wanted = approach_mp(u) * mp.cos(angle) - initial
        assert abs(gap_mp(angle, u) - wanted) < 1e-18 * approach_mp(u)


@pytest.mark.parametrize("exponent", [-280, -100, -9, -3, -1, 0, 1, 3, 9, 100, 280])
def test_the_law_is_right_however_small_or_complete_the_arc(exponent):
    with mp.workdps(640):
        t = mp.mpf(10) ** exponent  # u/(U − u)
        u = U_mp() * t / (1 + t)
        log = mp.log(1 + u)
        phi, d = load_mp(u), load_mp(u) * approach_mp(u) / mp.pi
        load_slope = (1 + 2 * u) / (u * (1 + u)) + (4 * u + 1 / (1 + u)) / N_mp(u)
        Z_slope = -1 / (u * (1 + u)) + 2 / (1 + u) ** 2 - 1 / (1 + u) ** 3
        Z_slope += (1 / (1 + u) - log * (1 + 2 * u) / (u * (1 + u))) / (2 * u * (1 + u))
        compliance = (approach_mp(u) + Z_slope / load_slope) / mp.pi
        exact = [d, phi, 1 / compliance, 2 * mp.atan(mp.sqrt(u)), phi * pressure_mp(mp.mpf(0), u)]
        phi, d, *exact = (float(x) for x in (phi, d, *exact))
    wide = CylinderPair.from_dR("internal", 1.0, UNIT.material_i, R_i=GOLDEN)
    actual = (
        LAW.penetration(phi, UNIT),
        LAW.load(d, UNIT),
        LAW.stiffness(d, UNIT),
        contact_angle(phi, UNIT),
        peak_pressure(phi, wide),
    )
    off = np.abs(np.array(actual) / exact - 1)
    assert np.all(off < [1e-10, 1e-10, 1e-8, 1e-11, 1e-11])
