"""First yield by von Mises and Tresca."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from cylcontact import CylinderPair, Material, laws, limits
from cylcontact.limits.stress import pressure_along
from tests.laws.test_stress import michell

STEEL = Material("steel", 207e3, 0.3, yield_stress=250.0)
ALUMINIUM = Material("aluminium", 70e3, 0.33, yield_stress=150.0)
PEEK = Material("PEEK", 3.6e3, 0.38, yield_stress=100.0)


def snug(hole, pin, stress_to_stiffness, plane="strain"):
    """A pair with R = 1 mm and E*·ΔR = 1 N/mm over σ_Y of the hole, by scaling the clearance."""
    sheet = CylinderPair.from_dR("internal", 1.0, hole, material_j=pin, plane=plane)
    dR = hole.yield_stress / (sheet.E_star * stress_to_stiffness)
    R_i = dR / 2 + np.sqrt(1 + dR**2 / 4)  # √(R_i·R_j) = 1
    return CylinderPair.from_dR("internal", dR, hole, R_i=R_i, material_j=pin, plane=plane)


def von_mises(rr, hoop, shear, nu):
    across = nu * (rr + hoop)
    sides = (rr - hoop) ** 2 + (hoop - across) ** 2 + (across - rr) ** 2
    return np.sqrt(sides / 2 + 3 * shear**2)


def tresca(rr, hoop, shear, nu):
    radius, middle = np.hypot((rr - hoop) / 2, shear), (rr + hoop) / 2
    principal = np.stack([middle - radius, middle + radius, nu * (rr + hoop)])
    return principal.max(axis=0) - principal.min(axis=0)


EQUIVALENT = {"von Mises": von_mises, "Tresca": tresca}


def hertz_constant(nu, criterion):
    """The largest equivalent stress below an elliptic pressure of peak 1, and its depth over b."""

    def stress(z):
        root = np.hypot(1, z)
        along, down = -((1 + 2 * z**2) / root - 2 * z), -1 / root
        return float(-EQUIVALENT[criterion](along, down, 0.0, nu))

    inside = minimize_scalar(stress, bounds=(0.1, 2), method="bounded", options={"xatol": 1e-10})
    return max((-inside.fun, inside.x), (-stress(0.0), 0.0))


# --- rollers ------------------------------------------------------------------------------------


@pytest.mark.parametrize("criterion", EQUIVALENT)
@pytest.mark.parametrize("nu", [0.0, 0.1, 0.2, 0.3, 0.45])
def test_rollers_yield_where_hertz_s_stresses_on_the_axis_do(nu, criterion):
    constant, depth = hertz_constant(nu, criterion)
    for R_j in (7.0, np.inf):
        pair = CylinderPair.external(10.0, R_j, Material("any", 1e5, nu, yield_stress=300.0))
        at = limits.first_yield(pair, criterion)
        assert limits.hertz_stress(at.load, pair) * constant == pytest.approx(300.0, rel=1e-6)
        assert at.depth == pytest.approx(depth * limits.hertz_half_width(at.load, pair), rel=1e-2)
        assert at.body == "i"


# --- a pin in a hole ----------------------------------------------------------------------------

PAIRS = [(STEEL, STEEL), (ALUMINIUM, STEEL), (STEEL, ALUMINIUM), (STEEL, PEEK), (PEEK, STEEL)]
# T of the hole.
STIFFNESS = [0.4, *(pytest.param(T, marks=pytest.mark.slow) for T in (0.1, 1.5))]


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("criterion", ["von Mises", "Tresca"])
@pytest.mark.parametrize("T", STIFFNESS)
@pytest.mark.parametrize("materials", PAIRS, ids=lambda pair: "/".join(m.name for m in pair))
def test_at_first_yield_michell_s_stresses_reach_the_yield_stress_of_that_body_alone(
    materials, T, criterion, plane
):
    pair = snug(*materials, T, plane)
    at = limits.first_yield(pair, criterion)
    b = np.tan(np.radians(laws.Conformal().contact_angle(at.load, pair)) / 2)
    depth = np.append(np.geomspace(0.15, 3, 60) * b, np.linspace(0.3, 0.98, 20))
    depth = np.append(depth[depth < 0.98], at.depth)
    for name, material, kappa in zip(("hole", "pin"), materials, pair.kolosov, strict=True):
        r = 1 - depth if name == "pin" else 1 + depth
        body = "pin" if name == "pin" else "plate"
        nu = material.nu if plane == "strain" else 0.0
        stress = michell(r.astype(complex), body, float(b), float(pair.beta), float(kappa))
        inside = at.load * EQUIVALENT[criterion](*stress, nu)
        rim = surface(at.load, pair, name, kappa)
        largest = max(inside[depth > 0].max(), EQUIVALENT[criterion](*rim, 0.0, nu))
        if name == at.body:
            assert largest == pytest.approx(material.yield_stress, rel=1e-3)
            there = EQUIVALENT[criterion](*rim, 0.0, nu) if at.depth == 0 else inside[-1]
            assert there == pytest.approx(material.yield_stress, rel=1e-3)
        else:
            assert largest <= material.yield_stress * (1 + 1e-3)


def surface(load, pair, name, kappa):
    """σ_rr and σ_θθ of the rim at θ = 0, R = 1."""
    peak = float(laws.Conformal().peak_pressure(load, pair))
    if name == "pin":
        return -peak, -peak
    b = np.tan(np.radians(laws.Conformal().contact_angle(load, pair)) / 2)
    H = 2 * np.pi * pressure_along(np.array([b]), float(pair.beta)).mean.item()
    return -peak, -peak + load * (H / np.pi + 2 * kappa / (np.pi * (kappa + 1)))


# --- the warning --------------------------------------------------------------------------------


def test_a_load_above_first_yield_is_warned_of():
    pair = CylinderPair.internal(10.0, 9.5, STEEL, material_j=ALUMINIUM)
    at = limits.first_yield(pair)
    sentence = limits.yield_warning([1.0, np.nan, 5000.0], pair)
    assert f"5,000 N/mm, is above first yield at {at.load:,.0f} N/mm" in sentence
    assert f"in the pin, {at.depth:.2g} mm below its surface" in sentence
    assert limits.yield_warning([1.0, 0.99 * at.load], pair) is None
    sheets = CylinderPair.external(10.0, 9.5, STEEL, plane="stress")
    assert "in body i, at its surface" in limits.yield_warning(1e6, sheets)
    several = CylinderPair.internal(10.0, [9.5, 9.99], STEEL)
    assert "array" in str(limits.first_yield(several))
    unknown = Material("unknown", 1e5, 0.3)
    for pair in (
        CylinderPair.from_dR("internal", 0.5, STEEL),
        CylinderPair.internal(10.0, 9.5, STEEL, material_j=unknown),
    ):
        assert limits.yield_warning(1e9, pair) is None
