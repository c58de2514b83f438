"""A joint under a load: each number by another way, and the band of a fit by brute force."""

from itertools import product

import numpy as np
import pytest

import cylcontact as cc
from cylcontact import CylinderPair, InputError, Material, laws, limits
from cylcontact.bodies.iso286 import IsoFit
from cylcontact.datasets.finite_element import Setup, solve
from cylcontact.joint.check import check_joint
from cylcontact.laws import compare
from cylcontact.laws.compare import accuracy, comparison
from tests.support.samples import sampled

STEEL, BRONZE = Material.named("high-strength steel"), Material.named("bronze")
LUG = laws.Sector(60, "pulled")
PAIR = CylinderPair.internal(10.0, 9.95, pin=STEEL, hole=BRONZE, length=10.0)


@pytest.mark.parametrize("clamp", sampled([LUG, "rim"], [LUG]))
def test_a_joint_in_a_housing_by_finite_elements(clamp):
    check = check_joint(PAIR, 1000.0, housing=laws.Housing(20.0, clamp))
    setup = Setup(
        hole_radius=10.0, outer_ratio=2.0, E=110e3, nu=0.34, pin_E=207e3, pin_nu=0.3, clamp=clamp
    )
    (case,) = solve(setup, 0.05, [1000.0])
    assert check.numbers.penetration_um == pytest.approx(1e3 * case.penetration, rel=0.01)
    assert check.numbers.peak_pressure_MPa == pytest.approx(case.pressure.max(), rel=0.02)
    place = np.degrees(case.arc[np.argmax(case.pressure)] / 10.0)
    assert check.numbers.peak_at_deg == pytest.approx(place, abs=4.0)
    edge = case.arc[case.pressure > 0].max() / 10.0
    angle = np.radians(check.numbers.contact_angle_deg)
    assert angle == pytest.approx(edge, rel=0.05)
    assert check.numbers.width_mm == pytest.approx(20.0 * np.sin(angle), rel=1e-9)
    slopes = solve(setup, 0.05, [990.0, 1010.0])
    slope = 20.0 / (slopes[1].penetration - slopes[0].penetration)
    assert check.numbers.stiffness_N_per_mm2 == pytest.approx(slope, rel=0.02)
    total = check.numbers.total_stiffness_N_per_mm
    assert total == pytest.approx(10.0 * check.numbers.stiffness_N_per_mm2, rel=1e-12)


def test_rollers_are_hertz_and_johnson():
    rollers = CylinderPair.external(15.0, 30.0, STEEL, 10.0)
    numbers = check_joint(rollers, 100.0).numbers
    R, E_star = 10.0, float(rollers.E_star)
    width = 2 * np.sqrt(4 * 100 * R / (np.pi * E_star))
    assert numbers.width_mm == pytest.approx(width, rel=1e-12)
    assert numbers.peak_pressure_MPa == pytest.approx(
        np.sqrt(100 * E_star / (np.pi * R)), rel=1e-12
    )
    # First yield under a line contact: p0 = 1.79 yield stresses for ν = 0.3.
    peak = np.sqrt(numbers.first_yield_N_per_mm * E_star / (np.pi * R))
    assert peak / STEEL.yield_stress == pytest.approx(1.79, abs=0.01)


@pytest.mark.parametrize(
    ("temperature", "rel"), [(None, 3e-3), ((120.0, 40.0), 0.02)], ids=["cold", "some seize"]
)
def test_the_percentiles_of_a_band_are_those_of_many_pairs(temperature, rel):
    fit, load = IsoFit.read("20H7/g6"), 200.0
    check = check_joint(PAIR, load, iso=fit, temperature=temperature)
    draw = np.random.default_rng(7)
    hole, pin = (
        (low + high) / 2 + (high - low) / 6 * draw.normal(size=40_000) for low, high in fit.limits
    )
    # The radii grow by α·R·(T − 20 °C).
    warmer = np.subtract(temperature or (20.0, 20.0), 20.0)
    growths = warmer * [STEEL.thermal_expansion, BRONZE.thermal_expansion]
    turns = hole * (1 + growths[1]) > pin * (1 + growths[0])
    pair = CylinderPair.internal(hole[turns], pin[turns], pin=STEEL, hole=BRONZE)
    pair = pair if temperature is None else limits.at_temperature(pair, *temperature)
    depth = 1e3 * laws.Conformal().penetration(load, pair)
    for name, value in {
        "mean": np.mean(depth), "5 %": np.quantile(depth, 0.05), "95 %": np.quantile(depth, 0.95)
    }.items():  # fmt: skip
        assert check.band[name].penetration_um == pytest.approx(value, rel=rel)
    assert check.joint.seized == pytest.approx(1 - turns.mean(), abs=3e-3)
    middle = 0.012 - 10.0 * (growths[0] - growths[1])  # 2 µm of the radius do not matter
    assert check.pair.dR == pytest.approx(middle, abs=1e-5)
    assert (check.joint.seized > 0.01) == (temperature is not None)


def test_a_transition_fit_answers_for_the_pairs_with_clearance():
    check = check_joint(PAIR, 200.0, iso="20H7/k6")
    assert check.band["tightest"].first_yield == "no clearance"
    assert np.isfinite(check.band["loosest"].penetration_um)
    assert check.joint.seized == pytest.approx(0.3126, abs=1e-3)
    assert "no clearance" in str(check)
    assert check.to_dict()["numbers"]["tightest"]["penetration_um"] is None


def test_the_law_to_use_and_its_error():
    one = CylinderPair.internal(10.0, 9.95, material=STEEL)
    check = check_joint(one, 500.0)
    assert check.law == "explicit"
    exact, explicit = (law.penetration(500.0, one) for law in (laws.Persson(), laws.Explicit()))
    assert check.error_percent == pytest.approx(100 * float(explicit / exact - 1), abs=1e-9)
    assert check_joint(PAIR, 500.0).law == "conformal"


def test_print_html_and_plot():
    check = cc.check_joint(PAIR, 500.0, iso="20H7/g6", housing=laws.Housing(20.0))
    assert len(str(check).splitlines()) <= 25
    assert "<table>" in check._repr_html_()
    axes = check.plot()
    lines = {line.get_label(): line for line in axes.lines}
    load = 400.0
    depths = [np.interp(load, *lines[name].get_data()) for name in ("tightest", "loosest")]
    assert depths[0] < depths[1]
    for name in ("tightest", "middle", "loosest"):  # each ends where its pair yields
        assert lines[name].get_xdata()[-1] == check.band[name].first_yield_N_per_mm
    name, worst = check.worst
    (mark,) = (line for label, line in lines.items() if f"({name})" in label)
    assert mark.get_xdata()[0] == worst.first_yield_N_per_mm
    assert "20H7/g6" in axes.get_title(loc="left")


def test_mistakes():
    with pytest.raises(InputError, match=r"pair = '20H7/g6': must be a CylinderPair"):
        check_joint("20H7/g6", 100.0)
    with pytest.raises(InputError, match="load = 0: must be positive"):
        check_joint(PAIR, 0)
    with pytest.raises(InputError, match="radii"):
        check_joint(CylinderPair.from_dR("internal", 0.05, STEEL), 100.0)
    on_plane = CylinderPair.external(15.0, np.inf, STEEL, material_j=BRONZE)
    width = float(limits.hertz_half_width(100.0, on_plane))
    with pytest.raises(InputError, match="must be at least ten half-widths"):
        check_joint(on_plane, 100.0, depth=9.9 * width)
    assert check_joint(on_plane, 100.0, depth=10.1 * width).numbers.penetration_um > 0


# --- all laws ---


def test_the_comparison_of_laws_is_that_of_each_alone():
    table = comparison(PAIR, 500.0).set_index("law")
    for name in ("johnson", "explicit", "enhanced"):
        depth = laws.LAWS[name]().penetration(500.0, PAIR)
        assert table.loc[name, "penetration_um"] == pytest.approx(1e3 * float(depth), rel=1e-12)
    exact = laws.Conformal().penetration(500.0, PAIR)
    off = 100 * (laws.Johnson().penetration(500.0, PAIR) / exact - 1)
    assert table.loc["johnson", "off_percent"] == pytest.approx(float(off), rel=1e-9)


def test_the_accuracy_of_johnsons_law_at_its_end():
    """At 4π/e² its penetration is 47.8 % below that of conformal contact."""
    table = accuracy("internal").set_index("law")
    assert table.loc["johnson", "largest_percent"] == pytest.approx(47.8, abs=1.5)
    assert table.loc["explicit", "largest_percent"] < 0.12
    # The mean of squares over the grid, one joint after the other.
    (low, high), gaps = compare.RANGES["internal"]
    squares = []
    for E, dR in product(np.geomspace(low, high, 15), np.geomspace(*gaps, 15)):
        pair = CylinderPair.from_dR("internal", dR, Material("any", E, 0.3))
        loads = np.geomspace(*compare.LOADS, 15)
        loads = loads[loads <= laws.Johnson().max_load(pair)]
        ratio = laws.Johnson().penetration(loads, pair) / laws.Conformal().penetration(loads, pair)
        squares += [*np.log(ratio) ** 2]
    assert table.loc["johnson", "rms"] == pytest.approx(np.sqrt(np.nanmean(squares)), rel=1e-6)
