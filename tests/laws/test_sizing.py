"""Bands of a fit, temperatures and the inverse, each against a second way to the same number."""

from itertools import product

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws, limits
from cylcontact.bodies.fits import Fit
from cylcontact.limits.sizing import bands, find, half_width

STEEL = Material("steel", 207e3, 0.3, 500.0, 12e-6)
BRONZE = Material("bronze", 110e3, 0.34, 220.0, 18e-6)
PAIR = CylinderPair.from_dR("internal", 0.01, pin=STEEL, hole=BRONZE, length=10.0, R_i=10.0)
LAW = laws.Conformal()


# --- bands --------------------------------------------------------------------------------------


def corner_pair(fit, hole, pin):
    (low, high), (least, most) = fit.limits
    return CylinderPair.internal(
        high if hole else low, most if pin else least, pin=STEEL, hole=BRONZE
    )


@pytest.mark.parametrize("code", ["20H7/g6", "50H8/f7", "10H11/c11"])
def test_a_band_ends_at_the_worst_of_four_corners(code):
    fit, f = Fit.read(code), 300.0
    over = bands(fit, PAIR, f, samples=10).each
    corners = [corner_pair(fit, *ends) for ends in product((0, 1), repeat=2)]
    by_name = {
        "radial clearance": [1e3 * pair.dR for pair in corners],
        "penetration": [1e3 * LAW.penetration(f, pair) for pair in corners],
        "stiffness": [LAW.stiffness(LAW.penetration(f, pair), pair) for pair in corners],
        "Johnson's end": [limits.johnson_limit_load(pair) for pair in corners],
        "first yield": [limits.first_yield(pair).load for pair in corners],
        "peak pressure": [laws.Conformal().peak_pressure(f, pair) for pair in corners],
    }
    for name, values in by_name.items():
        assert over[name].least == pytest.approx(min(values), rel=1e-6), name
        assert over[name].largest == pytest.approx(max(values), rel=1e-6), name
    assert over["half-width"].least < over["half-width"].middle < over["half-width"].largest


@pytest.mark.parametrize("distribution", ["uniform", "normal"])
def test_monte_carlo_agrees_with_quadrature(distribution):
    """Mean and deviation of the penetration by Gauss-Legendre over both diameters."""
    fit, f, count = Fit.read("20H7/g6"), 200.0, 40_000
    x, weights = np.polynomial.legendre.leggauss(24)
    if distribution == "normal":  # ±3σ within the limits: σ is a third of the half-width
        weights = weights * np.exp(-((3 * x) ** 2) / 2)
    weights = weights / weights.sum()
    R_i, R_j = (sum(ends) / 2 + x * (ends[1] - ends[0]) / 2 for ends in fit.limits)
    grid = CylinderPair.internal(R_i[:, None], R_j[None, :], pin=STEEL, hole=BRONZE)
    depth = 1e3 * LAW.penetration(f, grid)
    mean = weights @ depth @ weights
    deviation = np.sqrt(weights @ (depth - mean) ** 2 @ weights)
    band = bands(fit, PAIR, f, distribution=distribution, samples=count).each["penetration"]
    assert abs(band.mean - mean) < 4 * deviation / np.sqrt(count)
    assert np.std(band.samples) == pytest.approx(deviation, rel=0.03)
    assert band.least < band.central[0] < band.middle < band.central[1] < band.largest


def test_a_soft_pin_that_is_held_past_90_degrees_is_as_wide_as_the_hole():
    rubber = Material("rubber", "5 MPa", 0.5)
    pair = CylinderPair.internal(10.0, 9.999, pin=rubber, hole=Material("steel", 207e3, 0.0))
    assert laws.Conformal().contact_angle(10.0, pair) > 150
    assert half_width(10.0, pair) == 10.0


def test_zero_clearance_is_a_limit_with_values():
    over = bands("20H7/h6", PAIR, 100.0, samples=100).each
    assert all(np.isfinite(band.least) and np.isfinite(band.largest) for band in over.values())
    closer = CylinderPair.internal(10.0, 10.0 - 1e-8, pin=STEEL, hole=BRONZE)
    limit = 1e3 * laws.Conformal().penetration(100.0, closer)
    assert over["penetration"].least == pytest.approx(limit, rel=1e-3)


# --- temperature --------------------------------------------------------------------------------


def test_a_steel_pin_in_a_bronze_hole_gains_clearance_when_it_is_warmed_by_60_K():
    pair = CylinderPair.internal(10.0, 9.99, pin=STEEL, hole=BRONZE).at_temperature(80, 80)
    assert pair.dR == pytest.approx(0.01 + 10 * 18e-6 * 60 - 9.99 * 12e-6 * 60, rel=1e-12)
    assert pair.dR == pytest.approx(pair.R_i - pair.R_j)
    over = bands("20H7/g6", PAIR, 100.0, samples=10, pin_temperature=80, hole_temperature=80)
    assert over.each["radial clearance"].least == pytest.approx(3.5 + 3.6 + 0.00252, abs=1e-6)


def test_a_bronze_pin_in_a_steel_hole_seizes_at_the_temperature_that_the_error_says():
    tight = CylinderPair.internal(10.0, 9.9965, pin=BRONZE, hole=STEEL)
    at = 20 + 0.0035 / (9.9965 * 18e-6 - 10 * 12e-6)
    with pytest.raises(InputError, match=rf"seizes the pin: no clearance is left at {at:.1f} °C;"):
        tight.at_temperature(pin=80, hole=80)
    assert tight.at_temperature(pin=at - 0.01, hole=at - 0.01).dR < 1e-5
    hot = 0.0035 / (9.9965 * 18e-6 * 60) * 60 + 20
    with pytest.raises(InputError, match=f"at {hot:.1f} °C of the pin and 20.0 °C of the hole"):
        tight.at_temperature(pin=80)


def test_a_temperature_needs_expansions_radii_and_a_hole():
    unknown = Material("rubber", "5 MPa", 0.49)
    with pytest.raises(InputError, match=r"rubber.thermal_expansion: is not known"):
        CylinderPair.internal(10.0, 9.9, unknown).at_temperature(50, 50)
    with pytest.raises(InputError, match="needs both radii"):
        CylinderPair.from_dR("internal", 0.1, STEEL).at_temperature(50, 50)
    with pytest.raises(InputError, match="no pin and no hole"):
        CylinderPair.external(10.0, 9.9, STEEL).at_temperature(50, 50)
    with pytest.raises(InputError, match="temperature = nan: must be a temperature above"):
        PAIR.at_temperature(np.nan, 20)
    with pytest.raises(InputError, match=r"thermal_expansion = 12\.0: is beyond any material"):
        Material("steel", 207e3, 0.3, thermal_expansion=12.0)


# --- the inverse --------------------------------------------------------------------------------


@pytest.mark.parametrize("law", [LAW, laws.Conformal(), laws.Johnson()], ids=lambda law: law.name)
@pytest.mark.parametrize("dR", [0.01, 0.05, 0.5])
def test_the_clearance_comes_back(law, dR):
    pair = CylinderPair.from_dR("internal", dR, pin=STEEL, hole=BRONZE, R_i=10.0)
    depth = law.penetration(50.0, pair)
    by_depth = find("dR", pair, 50.0, penetration=depth, law=law)
    by_slope = find("dR", pair, 50.0, stiffness=law.stiffness(depth, pair), law=law)
    assert (by_depth, by_slope) == pytest.approx((dR, dR), rel=1e-10)


def test_modulus_and_length_come_back():
    depth = LAW.penetration(500.0, PAIR)
    assert find("E", PAIR, 500.0, penetration=depth) == pytest.approx(207e3, rel=1e-10)
    total = 10.0 * LAW.stiffness(depth, PAIR)
    assert find("length", PAIR, 5000.0, stiffness=total) == pytest.approx(10.0, rel=1e-10)


def test_next_to_the_end_of_a_law_a_stiffness_is_met_again_and_not_found():
    law, soft = laws.Johnson(), Material("gel", "5 MPa", 0.5)
    rollers = CylinderPair.external(20.0, 20.0, soft)
    length = find("length", rollers, 500.0, stiffness=300.0)
    assert 300.0 == pytest.approx(
        length * law.stiffness(law.penetration(500.0 / length, rollers), rollers), rel=1e-9
    )
    assert length > 100.0  # at the other, 2.4 mm, rollers of 20 mm penetrate by 22 mm


def test_a_band_has_no_housing():
    with pytest.raises(InputError, match="has a housing; each radius"):
        bands("20H7/g6", PAIR, 100.0, law=laws.Conformal(laws.Housing(20.0)))


@pytest.mark.parametrize(
    ("given", "rule"),
    [({"stiffness": 1e9}, "is met by no dR from 1e-05 to 5 mm, which give"),
     ({"penetration": 10.0}, "is met by no dR"), ({}, "is missing"),
     ({"stiffness": 1e5, "penetration": 1e-3}, "beside a penetration"),
     ({"stiffness": -1.0}, "must be positive")],
)  # fmt: skip
def test_what_no_clearance_gives_is_said(given, rule):
    with pytest.raises(InputError, match=rule):
        find("dR", PAIR, 100.0, **given)
