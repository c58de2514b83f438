"""First yield of a pressed bush and its eye: the stress at rest, and a seat that slides."""

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, limits
from cylcontact.files.spec import parse_spec
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.laws.housing_spec import HousingSpec
from tests.support.ring_elements import Pressed, SlidingRings
from tests.support.samples import sampled

PIN = Material("pin", 207e3, 0.3, 9000.0, 12e-6)
BRONZE = Material("bronze", 110e3, 0.34, 220.0, 18e-6)
STEEL = Material("steel", 200e3, 0.3, 250.0, 12e-6)
PEEK = Material("PEEK", 3.3e3, 0.38, 70.0, 50e-6)
RADII = [10.0, 12.0, 20.0]
PULLED = Sector(60, "pulled")


def eye(seat, clamp=PULLED, lug=STEEL):
    return Housing(20.0, clamp, [(lug, 12.0)], seat=seat)


def pair_of(plane="stress", bush=BRONZE, dR=0.02):
    return CylinderPair.from_dR("internal", dR, bush, R_i=10.0, material_j=PIN, plane=plane)


# Finite elements of pin, bush and eye with the misfit, by another program.
KNOWN = {
    # seat, warmer: bush at the bore, its angle, eye, its angle, relative difference
    ("bonded", 60.0): (1014.9, 162, 1327.6, 93, 0.005),
    ("bonded", 0.0): (1929.5, 163, 1470.0, 93, 0.012),
    ("sliding", 0.0): (3534.6, 70, 808.9, 91, 0.016),
}


@pytest.mark.parametrize(("seat", "warmer"), KNOWN)
def test_a_pressed_bush_and_its_eye_yield_where_elements_of_three_bodies_say(seat, warmer):
    bush, bush_at, lug, lug_at, error = KNOWN[seat, warmer]
    rest = limits.at_rest([BRONZE, STEEL], RADII, 0.012, warmer)
    found = limits.first_yields(pair_of(), eye(seat), rest)
    assert [str(each.body) for each in found] == ["hole", "layer 1", "pin"]
    assert found[0].load == pytest.approx(bush, rel=error)
    assert found[1].load == pytest.approx(lug, rel=error)
    assert [found[0].angle, found[1].angle] == pytest.approx([bush_at, lug_at], abs=2)
    first = limits.first_yield(pair_of(), housing=eye(seat), at_rest=rest)
    assert first.load == pytest.approx(min(found[0].load, found[1].load))


def test_without_stress_at_rest_each_body_yields_where_the_first_of_all_does():
    found = limits.first_yields(pair_of(), eye("bonded"))
    assert [found[0].load, found[1].load] == pytest.approx([1535.4, 1805.6], rel=1e-4)
    assert limits.first_yield(pair_of(), housing=eye("bonded")).load == found[0].load
    none = limits.at_rest([BRONZE, STEEL], RADII)
    same = limits.first_yields(pair_of(), eye("bonded"), none)
    for one, other in zip(found[:2], same[:2], strict=True):
        assert one.load == pytest.approx(float(other.load), rel=1e-5)


# --- elements of this project -------------------------------------------------------------------


def largest_by_elements(pair, housing, rest, load, cells):
    """Von Mises' largest stress in MPa of bush and eye, and its angle, with the stress at rest."""
    under = Pressed(pair, housing, load)
    R, R_i = float(np.sqrt(pair.R_i * pair.R_j)), float(pair.R_i)
    sizes = under.radii, under.materials
    rings = SlidingRings(*sizes, housing.clamp, cells, under.arc, pair.plane)
    moved, found = rings.moved(under.pressure), []
    for k in range(len(under.materials)):
        r, theta, (xx, yy, xy, zz) = rings.stresses(moved, k)
        radial, hoop, axial = rest.stress(k, r * R_i)
        c, s = np.cos(theta), np.sin(theta)
        xx = xx * load / R + radial * c**2 + hoop * s**2
        yy = yy * load / R + radial * s**2 + hoop * c**2
        xy = xy * load / R + (radial - hoop) * s * c
        zz = zz * load / R + axial
        mises = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2)
        if k == len(under.materials) - 1:
            mises = under.away_from_the_clamp(r, theta, mises)
        found.append((mises.max(), np.degrees(theta.flat[mises.argmax()])))
    return found


CASES = {
    "bronze in a steel eye, plane stress": (pair_of(), eye("sliding"), BRONZE, 0.012, 0.0),
    "the same, warm": (pair_of(), eye("sliding"), BRONZE, 0.012, 60.0),
    "plane strain, a whole rim": (pair_of("strain"), eye("sliding", "rim"), BRONZE, 0.012, 0.0),
    "PEEK in a pushed eye, plane strain": (
        pair_of("strain", PEEK, 0.05), eye("sliding", Sector(60, "pushed")), PEEK, 0.02, 30.0,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", sampled(CASES, few=["plane strain, a whole rim"]))
def test_at_first_yield_elements_with_a_sliding_seat_reach_the_yield_stress(name):
    pair, housing, bush, interference, warmer = CASES[name]
    rest = limits.at_rest([bush, STEEL], RADII, interference, warmer)
    found = limits.first_yields(pair, housing, rest)
    for body in range(2):
        load, strength = float(found[body].load), (bush, STEEL)[body].yield_stress
        m, angle = largest_by_elements(pair, housing, rest, load, 12)[body]
        assert m == pytest.approx(strength, rel=0.004), body
        assert angle == pytest.approx(float(found[body].angle), abs=4)


# --- relations ----------------------------------------------------------------------------------


def test_a_seat_that_slides_in_one_material_is_softer_than_one_that_is_bonded():
    one = CylinderPair.from_dR("internal", 0.02, STEEL, R_i=10.0, material_j=PIN)
    whole = Conformal(Housing(20.0, PULLED)).penetration(1000.0, one)
    bonded, sliding = (
        Conformal(eye(seat)).penetration(1000.0, one) for seat in ("bonded", "sliding")
    )
    assert bonded == pytest.approx(float(whole), rel=1e-9)
    assert sliding > 1.05 * bonded


def test_a_bush_that_yields_by_its_press_fit_has_the_load_zero():
    rest = limits.at_rest([BRONZE, STEEL], RADII, 0.03)
    assert rest.von_mises(0, 10.0) > 220
    bush, lug, _ = limits.first_yields(pair_of(), eye("sliding"), rest)
    assert (bush.load, bush.depth, bush.angle) == (0, 0, 0)
    assert lug.load > 0
    assert limits.first_yield(pair_of(), housing=eye("sliding"), at_rest=rest).load == 0


def test_tresca_is_never_above_von_mises():
    rest = limits.at_rest([BRONZE, STEEL], RADII, 0.012)
    mises, tresca = (
        limits.first_yields(pair_of("strain"), eye("sliding"), rest, criterion)
        for criterion in ("von Mises", "Tresca")
    )
    for one, other in zip(mises[:2], tresca[:2], strict=True):
        assert 0.8 * one.load < other.load <= one.load


def test_a_seat_opens_where_the_radial_stress_of_the_load_takes_its_pressure_away():
    """By the elements: at that load the radial stress of the seat is zero somewhere."""
    rest, housing, pair = limits.at_rest([BRONZE, STEEL], RADII, 0.012), eye("sliding"), pair_of()
    load = float(limits.seat_opens(pair, housing, rest))
    assert 1.5 * limits.first_yields(pair, housing, rest)[1].load < load
    tighter = limits.at_rest([BRONZE, STEEL], RADII, 0.024)
    assert load < limits.seat_opens(pair, housing, tighter)
    radial = seat_by_elements(pair, housing, load, 12)
    assert radial == pytest.approx(float(rest.pressures[0]), rel=0.015)
    none = limits.at_rest([BRONZE, STEEL], RADII, 0.0)
    assert limits.seat_opens(pair, housing, none) == np.inf  # no pressure at rest


def seat_by_elements(pair, housing, load, cells):
    """The largest radial stress of the load at the seat in MPa."""
    under = Pressed(pair, housing, load)
    sizes = under.radii, under.materials
    rings = SlidingRings(*sizes, housing.clamp, cells, under.arc, pair.plane)
    r, theta, (xx, yy, xy, _) = rings.stresses(rings.moved(under.pressure), 0)  # its mesh is finer
    c, s = np.cos(theta), np.sin(theta)
    radial = (xx * c**2 + yy * s**2 + 2 * xy * s * c) * load / np.sqrt(pair.R_i * pair.R_j)
    return radial[np.abs(r - under.radii[1]) < 1e-9].max()


def test_a_weak_body_in_a_housing_yields_as_a_contact_of_hertz():
    weak = Material("weak", 207e3, 0.3, 1e-3)
    first = limits.first_yield(CylinderPair.internal(10, 9, weak), housing=Housing(20.0))
    plate = limits.first_yield(CylinderPair.internal(10, 9, weak))
    assert first.load == pytest.approx(float(plate.load), rel=1e-3)


@pytest.mark.parametrize(
    ("ask", "rule"),
    [
        (lambda: Housing(20.0, seat="sliding"), "seat = 'sliding': is for a ring around"),
        (lambda: Housing(20.0, layers=[(STEEL, 12.0)], seat="glued"), "must be 'bonded' or"),
        (lambda: limits.first_yields(pair_of(), eye("sliding"), limits.at_rest([STEEL], [10, 20])),
         "has 1 rings for 2 of the housing"),
        (lambda: limits.first_yield(pair_of(), at_rest=limits.at_rest([STEEL], [10, 20])),
         "at_rest: is of the rings of a housing"),
    ],
)  # fmt: skip
def test_what_a_seat_and_a_state_at_rest_refuse(ask, rule):
    with pytest.raises(InputError, match=rule):
        ask()


def test_a_file_of_a_joint_has_the_seat_of_its_layers():
    layer = {"R_i": 12.0, "E": 200.0, "nu": 0.3}
    for seat in (None, "bonded", "sliding"):
        data = {"R_o": 20.0, "layers": [layer]} | ({} if seat is None else {"seat": seat})
        assert parse_spec(HousingSpec, data, "file").housing.seat == (seat or "bonded")
    with pytest.raises(InputError, match=r"seat = 'sliding': is for layers"):
        parse_spec(HousingSpec, {"R_o": 20.0, "seat": "sliding"}, "file")


def test_a_curve_has_the_sliding_seat():
    pair, law = pair_of("strain"), Conformal(eye("sliding"))
    depth, unit = float(law.penetration(500.0, pair)), float(pair.E_star * pair.dR)
    at = law.curve(pair).bodies.penetration(500.0 / unit)
    assert pair.dR * at == pytest.approx(depth, rel=1e-9)
    assert depth > 1.05 * float(Conformal(eye("bonded")).penetration(500.0, pair))
