"""Temperatures and the inverse of a law, each against a second way to the same number."""

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.limits import at_temperature, bore_expansion
from cylcontact.limits.sizing import find, half_width

STEEL = Material("steel", 207e3, 0.3, 500.0, 12e-6)
BRONZE = Material("bronze", 110e3, 0.34, 220.0, 18e-6)
PAIR = CylinderPair.from_dR("internal", 0.01, pin=STEEL, hole=BRONZE, length=10.0, R_i=10.0)
LAW = laws.Conformal()


def test_a_soft_pin_that_is_held_past_90_degrees_is_as_wide_as_the_hole():
    rubber = Material("rubber", "5 MPa", 0.5)
    pair = CylinderPair.internal(10.0, 9.999, pin=rubber, hole=Material("steel", 207e3, 0.0))
    assert laws.Conformal().contact_angle(10.0, pair) > 150
    assert half_width(10.0, pair) == 10.0


# --- temperature --------------------------------------------------------------------------------


def test_a_steel_pin_in_a_bronze_hole_gains_clearance_when_it_is_warmed_by_60_K():
    pair = CylinderPair.internal(10.0, 9.99, pin=STEEL, hole=BRONZE).at_temperature(80, 80)
    assert pair.dR == pytest.approx(0.01 + 10 * 18e-6 * 60 - 9.99 * 12e-6 * 60, rel=1e-12)
    assert pair.dR == pytest.approx(pair.R_i - pair.R_j)


def test_a_bronze_pin_in_a_steel_hole_seizes_at_the_temperature_that_the_error_says():
    tight = CylinderPair.internal(10.0, 9.9965, pin=BRONZE, hole=STEEL)
    at = 20 + 0.0035 / (9.9965 * 18e-6 - 10 * 12e-6)
    with pytest.raises(InputError, match=rf"seizes the pin: no clearance is left at {at:.1f} °C;"):
        tight.at_temperature(pin=80, hole=80)
    assert tight.at_temperature(pin=at - 0.01, hole=at - 0.01).dR < 1e-5
    hot = 0.0035 / (9.9965 * 18e-6 * 60) * 60 + 20
    with pytest.raises(InputError, match=f"at {hot:.1f} °C of the pin and 20.0 °C of the hole"):
        tight.at_temperature(pin=80)


# The plane, layers with their outer radii, the rim, and the bore's displacement in µm by Lamé's
# formulas as in a textbook.
RINGS = [
    ("stress", ["PEEK", 13.0], "steel", -1.0),
    ("strain", ["PEEK", 13.0], "steel", -8.4),
    ("stress", ["bronze", 12.0, "steel", 20.0], "free", 7.2),
    ("strain", ["bronze", 12.0, "steel", 20.0], "free", 9.3),
    ("strain", ["bronze", 20.0], "held", None),
    ("stress", ["steel", 20.0], "free", 10 * 12e-6 * 60e3),
]
BODIES = {
    "PEEK": Material("PEEK, hot", 3.6e3, 0.38, thermal_expansion=47e-6),
    "bronze": BRONZE,
    "steel": STEEL,
}


def ring_by_elements(plane, layers, rim, R_i, warmer, count=400):
    """The bore's displacement by linear elements in r, with the energy of a heated ring."""
    stiffness, load = np.zeros((count + 1, count + 1)), np.zeros(count + 1)
    r = np.linspace(R_i, layers[-1], count + 1)
    outer = dict(zip(layers[1::2], layers[::2], strict=True))
    for k in range(count):
        a, b = r[k], r[k + 1]
        middle, h = (a + b) / 2, b - a
        body = BODIES[next(name for end, name in outer.items() if middle < end)]
        E, nu, alpha = float(body.E), float(body.nu), body.thermal_expansion
        if plane == "strain":
            E, nu, alpha = E / (1 - nu**2), nu / (1 - nu), (1 + nu) * alpha
        D = E / (1 - nu**2) * np.array([[1, nu], [nu, 1]])
        for x in (-1 / np.sqrt(3), 1 / np.sqrt(3)):
            at = middle + x * h / 2
            shape = np.array([(1 - x) / 2, (1 + x) / 2])
            B = np.array([[-1 / h, 1 / h], shape / at])
            weight = at * h / 2
            stiffness[k : k + 2, k : k + 2] += weight * B.T @ D @ B
            load[k : k + 2] += weight * B.T @ D @ np.full(2, alpha * warmer)
    if rim == "free":
        return np.linalg.solve(stiffness, load)[0]
    u = np.zeros(count + 1)
    u[-1] = 0.0 if rim == "held" else BODIES[rim].thermal_expansion * warmer * layers[-1]
    load -= stiffness @ u
    return np.linalg.solve(stiffness[:-1, :-1], load[:-1])[0]


@pytest.mark.parametrize(("plane", "layers", "rim", "known"), RINGS)
def test_the_bore_of_rings_moves_as_finite_elements_say(plane, layers, rim, known):
    more = list(zip(map(BODIES.get, layers[2::2]), layers[1:-1:2], strict=True))
    housing = laws.Housing(layers[-1], layers=more)
    state = BODIES.get(rim, rim)
    moved = bore_expansion(BODIES[layers[0]], 10.0, housing, 60.0, state, plane)
    # The layers' ends are nodes of the coarse and of the fine mesh; the error is of second order.
    coarse, fine = (ring_by_elements(plane, layers, rim, 10.0, 60.0, n) for n in (300, 600))
    assert moved == pytest.approx(fine + (fine - coarse) / 3, abs=1e-8)
    if known is not None:
        assert 1e3 * moved == pytest.approx(known, abs=0.05)


def test_a_warm_joint_in_a_housing_needs_the_state_of_its_rim():
    pair = CylinderPair.internal(10.0, 9.95, pin=STEEL, hole=BRONZE)
    housing = laws.Housing(20.0)
    with pytest.raises(
        InputError, match=r'rim: is missing: .* give "free", "held", or the material'
    ):
        at_temperature(pair, 80, 80, housing=housing)
    warm = at_temperature(pair, 80, 80, housing=housing, rim="held")
    moved = bore_expansion(BRONZE, 10.0, housing, 60.0, "held")
    assert warm.dR == pytest.approx(0.05 + moved - 9.95 * 12e-6 * 60, rel=1e-9)
    assert warm.dR == pytest.approx(warm.R_i - warm.R_j, rel=1e-9)
    eye = laws.Housing(20.0, laws.Sector(60, "far"))
    with pytest.raises(InputError, match="is for a rim clamped"):
        at_temperature(pair, 80, 80, housing=eye, rim="held")
    tight = CylinderPair.internal(10.0, 9.999, pin=BRONZE, hole=BRONZE)
    with pytest.raises(InputError, match="seizes the pin"):
        at_temperature(tight, 200, 200, housing=housing, rim="held")


# --- the inverse --------------------------------------------------------------------------------


@pytest.mark.parametrize("law", [LAW, laws.Johnson()], ids=lambda law: law.name)
@pytest.mark.parametrize("dR", [0.01, 0.05, 0.5])
def test_clearance_modulus_and_length_come_back(law, dR):
    pair = CylinderPair.from_dR("internal", dR, pin=STEEL, hole=BRONZE, R_i=10.0, length=10.0)
    depth = law.penetration(50.0, pair)
    slope = law.stiffness(depth, pair)
    assert find("dR", pair, 50.0, penetration=depth, law=law) == pytest.approx(dR, rel=1e-10)
    assert find("dR", pair, 50.0, stiffness=slope, law=law) == pytest.approx(dR, rel=1e-10)
    assert find("E", pair, 50.0, penetration=depth, law=law) == pytest.approx(207e3, rel=1e-10)
    length = find("length", pair, 500.0, stiffness=10 * slope, law=law)
    assert length == pytest.approx(10.0, rel=1e-9)


def test_next_to_the_end_of_a_law_a_stiffness_is_met_again_and_not_found():
    law, soft = laws.Johnson(), Material("gel", "5 MPa", 0.5)
    rollers = CylinderPair.external(20.0, 20.0, soft)
    length = find("length", rollers, 500.0, stiffness=300.0)
    assert 300.0 == pytest.approx(
        length * law.stiffness(law.penetration(500.0 / length, rollers), rollers), rel=1e-9
    )
    assert length > 100.0  # at the other, 2.4 mm, rollers of 20 mm penetrate by 22 mm


# --- a law that jumps -----------------------------------------------------------------------------

FITTED = laws.Enhanced(
    laws.InternalCoefficients(
        a=0.755, b=0.1095, Y_log_scale=1.376, Y_log_exponent=-0.121, Y_slope=0.0247,
        Y_offset=1.1132, n_exponent=-0.0225,
    )
)  # fmt: skip


def depth_at(dR, law=FITTED):
    return float(law.penetration(100.0, CylinderPair.from_dR("internal", dR, STEEL)))


@pytest.mark.parametrize("dR", [0.1, 0.33, np.nextafter(0.34954, 0), 0.34954, 0.36, 2.0])
def test_a_clearance_on_either_side_of_a_jump_is_found(dR):
    """Of several that give the penetration, the largest."""
    pair = CylinderPair.from_dR("internal", 1.0, STEEL)
    found = find("dR", pair, 100.0, penetration=depth_at(dR), law=FITTED)
    assert depth_at(found) == pytest.approx(depth_at(dR), rel=1e-9)
    assert found >= dR * (1 - 1e-9)


def test_a_penetration_that_a_law_jumps_over_is_refused():
    below, above = depth_at(np.nextafter(0.34954, 0)), depth_at(0.34954)
    assert above / below - 1 == pytest.approx(FITTED.coefficients.jump, rel=1e-9)
    pair = CylinderPair.from_dR("internal", 1.0, STEEL)
    with pytest.raises(InputError, match=r"jumps from 0\.\d+ to 0\.\d+ mm at 0\.34954 mm"):
        find("dR", pair, 100.0, penetration=(below + above) / 2, law=FITTED)


def test_branches_that_meet_leave_no_note():
    assert abs(laws.InternalCoefficients().jump) < 1e-6
    assert laws.Enhanced().note == laws.Enhanced(laws.InternalCoefficients()).note == ""
    assert "% larger" in FITTED.note
