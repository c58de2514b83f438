"""A law's formula: its stiffness, functions of one's own, and a cylinder on a plane."""

from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.integrate import quad

from cylcontact import CylinderPair, Material, laws
from cylcontact.laws.user import user_law

STEEL = Material("steel", E=207e3, nu=0.3)
BRONZE = Material("bronze", E=110e3, nu=0.34)
PAIR = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=12.0)
ROLLERS = CylinderPair.external(R_i=10.0, R_j=25.0, material=STEEL, length=12.0)
# Loads that the library computes, of δ, E* and ΔR and the constants, as printed.
PRINTED = {
    "explicit": lambda x, E, dR, c, A, B: (
        mp.pi * E * x
        / (c + mp.log(1 + A * dR / x * (c + mp.log(1 + A * dR / x * mp.log(B * dR / x)))))
    ),
    "liu": lambda x, E, dR: mp.pi / 2 * E * x * mp.sqrt(x / (2 * (dR + x))),
    "johnson": lambda x, E, dR, *_: (
        mp.pi * E * x / -mp.lambertw(-mp.e * x / (4 * dR), -1).real
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PRINTED)
def test_a_stiffness_by_hand_is_the_slope_of_the_printed_load_at_forty_digits(name):
    law = laws.LAWS[name]()
    constants = [mpf(x) for x in law.constants_for("internal").values()]
    E, dR = mpf(float(PAIR.E_star)), mpf(float(PAIR.dR))
    for depth in np.geomspace(1e-7, 0.01, 12):
        with mp.workdps(40):
            load = lambda x: PRINTED[name](x, E, dR, *constants)  # noqa: E731
            exact, slope = load(mpf(depth)), mp.diff(load, mpf(depth), h=mpf(depth) * 1e-12)
        assert law.load(depth, PAIR) == pytest.approx(float(exact), rel=2e-14)
        assert law.stiffness(depth, PAIR) == pytest.approx(float(slope), rel=1e-12)


# --- functions of one's own ----------------------------------------------------------------------


def test_a_function_of_ones_own_is_a_law():
    law = user_law("own_laws:power", Path(__file__).parents[1] / "support")
    exact, delta = laws.PowerLaw(n=1.2, C=0.4), np.geomspace(1e-6, 1e-2, 50)
    many = CylinderPair.from_dR("internal", np.array([[0.01], [0.03]]), STEEL)
    for pair in (PAIR, many):
        np.testing.assert_allclose(law.load(delta, pair), exact.load(delta, pair), rtol=1e-14)
        slope = exact.stiffness(delta, pair)
        np.testing.assert_allclose(law.stiffness(delta, pair), slope, rtol=1e-9)
    assert (law.needs, law.max_penetration(many).shape) == ((), (2, 1))


# --- a cylinder on a plane -----------------------------------------------------------------------


ON_PLANE = CylinderPair.external(R_i=10.0, R_j=np.inf, material=STEEL, material_j=BRONZE)
HALF_WIDTH = np.sqrt(4 * 100.0 * 10.0 / (np.pi * ON_PLANE.E_star))  # Hertz's, under 100 N/mm


def hertz(function):
    """Average a function of the distance from the middle over Hertz's pressure."""
    weight = lambda t: 4 / np.pi * np.sqrt(1 - t * t)  # noqa: E731
    return quad(lambda t: weight(t) * function(t * HALF_WIDTH), 0, 1, limit=200)[0]


def of_roller(E, nu, R):
    """The approach of a roller's centre to its contact (Johnson, half of a diameter)."""
    return 100.0 * (1 - nu**2) / (np.pi * E) * (2 * np.log(4 * R / HALF_WIDTH) - 1)


@pytest.mark.parametrize("depth", [20.0, 500.0])
def test_the_half_plane_is_flamants_integral_over_hertzs_pressure(depth):
    """u_z of a line load: −(1 + ν)f/(πE)·[2(1 − ν)·ln r − z²/r²], surface less the point below."""
    E, nu = 110e3, 0.34

    def flamant(x, z):
        r2 = x * x + z * z
        return -(1 + nu) / (np.pi * E) * ((1 - nu) * np.log(r2) - z * z / r2)

    plane = 100.0 * hertz(lambda x: flamant(x, 0.0) - flamant(x, depth))
    expected = plane + of_roller(207e3, 0.3, 10.0)
    # The closed form takes the width for small beside the depth.
    actual = laws.Johnson(datum=depth).penetration(100.0, ON_PLANE)
    assert actual == pytest.approx(expected, rel=1e-4)
    assert laws.Johnson(datum=depth).load(actual, ON_PLANE) == pytest.approx(100.0, rel=1e-13)
