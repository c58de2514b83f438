"""The inverse of a law and the width of contact, against a second way to the same number."""

import pytest

from cylcontact import CylinderPair, InputError, Material, laws, limits
from cylcontact.limits.sizing import find, half_width

STEEL = Material("steel", 207e3, 0.3, 500.0, 12e-6)
BRONZE = Material("bronze", 110e3, 0.34, 220.0, 18e-6)
PAIR = CylinderPair.from_dR("internal", 0.01, pin=STEEL, hole=BRONZE, length=10.0, R_i=10.0)
LAW = laws.Conformal()


def test_a_soft_pin_that_is_held_past_90_degrees_is_as_wide_as_the_hole():
    rubber = Material("rubber", "5 MPa", 0.5)
    pair = CylinderPair.internal(10.0, 9.999, pin=rubber, hole=Material("steel", 207e3, 0.0))
    angle = laws.Conformal().contact_angle(10.0, pair)
    assert angle > 150
    assert half_width(angle, pair) == 10.0


# --- the inverse --------------------------------------------------------------------------------


@pytest.mark.parametrize("law", [LAW, laws.Johnson()], ids=lambda law: law.name)
@pytest.mark.parametrize("dR", [0.01, 0.05, 0.5])
def test_clearance_modulus_and_length_come_back(law, dR):
    pair = CylinderPair.from_dR("internal", dR, pin=STEEL, hole=BRONZE, R_i=10.0, length=10.0)
    depth = law.penetration(50.0, pair)
    slope = law.stiffness(depth, pair)
    assert find("clearance", pair, 50.0, penetration=depth, law=law) == pytest.approx(dR, rel=1e-10)
    assert find("clearance", pair, 50.0, stiffness=slope, law=law) == pytest.approx(dR, rel=1e-10)
    assert find("modulus", pair, 50.0, penetration=depth, law=law) == pytest.approx(
        207e3, rel=1e-10
    )
    length = find("length", pair, 500.0, stiffness=10 * slope, law=law)
    assert length == pytest.approx(10.0, rel=1e-9)


@pytest.mark.parametrize("key", ["penetration", "stiffness", "peak", "factor"])
def test_a_clearance_is_found_although_the_pin_would_seize_in_smaller_ones(key):
    warm = 120.0, 60.0
    cold = CylinderPair.from_dR("internal", 0.05, pin=BRONZE, hole=STEEL, R_i=10.0)
    pair = limits.at_temperature(cold, *warm)
    assert pair.dR < 0.04
    depth = LAW.penetration(50.0, pair)
    target = {
        "penetration": depth,
        "stiffness": LAW.stiffness(depth, pair),
        "peak": LAW.peak_pressure(50.0, pair),
        "factor": limits.yield_load(pair) / 50.0,
    }
    found = find("clearance", cold, 50.0, law=LAW, temperature=warm, **{key: float(target[key])})
    assert found == pytest.approx(0.05, rel=1e-9)


# A factor of a clearance or a modulus takes seconds, and several may have it.
@pytest.mark.parametrize(
    ("unknown", "target"),
    [("clearance", "peak"), ("modulus", "peak"), ("length", "peak"), ("length", "factor")],
)
def test_a_peak_and_a_factor_to_yield_come_back(unknown, target):
    peak, load = LAW.peak_pressure(50.0, PAIR), limits.yield_load(PAIR)
    wanted = {"peak": float(peak), "factor": float(load) / 50.0}[target]
    total = 500.0 if unknown == "length" else 50.0
    value = {"clearance": 0.01, "modulus": 207e3, "length": 10.0}[unknown]
    assert find(unknown, PAIR, total, **{target: wanted}) == pytest.approx(value, rel=1e-6)


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


@pytest.mark.parametrize("dR", [0.1, 0.33, 0.34954 - 1e-9, 0.34954 + 1e-9, 0.36, 2.0])
def test_a_clearance_on_either_side_of_a_jump_is_found(dR):
    """Of several that give the penetration, the largest."""
    pair = CylinderPair.from_dR("internal", 1.0, STEEL)
    found = find("clearance", pair, 100.0, penetration=depth_at(dR), law=FITTED)
    assert depth_at(found) == pytest.approx(depth_at(dR), rel=1e-9)
    assert found >= dR * (1 - 1e-9)


def test_a_penetration_that_a_law_jumps_over_is_refused():
    below, above = depth_at(0.34954 * (1 - 1e-15)), depth_at(0.34954)
    assert above / below - 1 == pytest.approx(FITTED.coefficients.jump, rel=1e-9)
    pair = CylinderPair.from_dR("internal", 1.0, STEEL)
    with pytest.raises(InputError, match=r"at 0\.34954 mm the law jumps from 0\.\d+ to 0\.\d+"):
        find("clearance", pair, 100.0, penetration=(below + above) / 2, law=FITTED)


def test_branches_that_meet_leave_no_note():
    assert abs(laws.InternalCoefficients().jump) < 1e-6
    assert laws.Enhanced().note == laws.Enhanced(laws.InternalCoefficients()).note == ""
    assert "% larger" in FITTED.note
