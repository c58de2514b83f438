"""First yield in a housing: against finite elements of its ring, the plate, and printed loads."""

import numpy as np
import pytest

from cylcontact import CylinderPair, Material, limits
from cylcontact.laws import Housing, Sector
from cylcontact.limits import housing_stress
from tests.support.ring_elements import Pressed, RingOfElements
from tests.support.samples import sampled

STEEL = Material("steel", 207e3, 0.3, yield_stress=250.0)
BRONZE = Material("bronze", 110e3, 0.34, yield_stress=200.0)
CLAMPS = {
    "full": "rim",
    "near60": Sector(60, "pushed"),
    "far180": Sector(180, "pulled"),
    "far60": Sector(60, "pulled"),
}


def snug(T, hole=STEEL, pin=STEEL):
    """A pair with R = 1 mm and σ_Y·R/(E*·ΔR) = T."""
    sheet = CylinderPair.from_dR("internal", 1.0, hole, material_j=pin)
    dR = hole.yield_stress / (float(sheet.E_star) * T)
    R_i = dR / 2 + np.sqrt(1 + dR**2 / 4)
    return CylinderPair.from_dR("internal", dR, hole, R_i=R_i, material_j=pin)


# f_Y/(σ_Y·R) of the housing at φ = .1, 1 and 5, from finite elements of another program; printed.
PRINTED = {
    ("full", 1.3): (0.69, 1.46, 2.01),
    ("full", 2): (0.77, 1.39, 1.60),
    ("full", 10): (0.82, 1.46, 1.44),
    ("near60", 2): (0.75, 1.04, 0.98),
    ("far180", 1.3): (0.19, 0.34, 0.42),
    ("far180", 2): (0.66, 0.80, 0.91),
    ("far180", 3): (0.84, 1.21, 1.25),
    ("far60", 1.5): (0.20, 0.31, 0.36),
    ("far60", 2): (0.45, 0.56, 0.63),
}


EACH = [(*housing, k) for housing in PRINTED for k in range(3)]


# One of the three loads of each housing, in turn.
@pytest.mark.parametrize(("clamp", "rho", "k"), sampled(EACH, EACH[::4]))
def test_first_yield_is_as_printed(clamp, rho, k):
    printed, phi = PRINTED[clamp, rho][k], (0.1, 1.0, 5.0)[k]
    pair = snug(phi / printed)  # f = φ·E*·ΔR and f_Y = printed·σ_Y·R there
    first = limits.first_yield(pair, housing=Housing(rho * float(pair.R_i), CLAMPS[clamp]))
    assert first.load / 250.0 == pytest.approx(printed, rel=0.012, abs=0.008)
    assert first.body == "hole"
    if clamp == "far60":
        assert first.depth == 0
        assert 55 < first.angle < 115


def largest_by_elements(pair, housing, load, cells, ring=(0.0, 9.9)):
    """The largest equivalent stress under the pressure of the series, and where, between radii."""
    under = Pressed(pair, housing, load)
    elements = RingOfElements(under.radii, under.materials, housing.clamp, cells, under.arc)
    r, theta, mises = elements.stresses(elements.moved(elements.pressed(under.pressure)))
    mises = np.where((r.mean(axis=1) > ring[0]) & (r.mean(axis=1) < ring[1]), mises.T, 0).T
    mises = under.away_from_the_clamp(r, theta, mises)
    at = mises.argmax()
    return mises.max(), r.flat[at], np.degrees(theta.flat[at])


CASES = [  # σ_Y·R/(E*·ΔR) of the hole
    ("full", 1.3, 0.3, STEEL),
    ("far60", 1.5, 0.5, STEEL),
    ("full", 2.0, 0.05, BRONZE),
    ("near60", 2.0, 1.0, STEEL),
    ("far180", 1.3, 0.02, STEEL),  # above the contact on the rim
    ("far180", 1.3, 0.5, BRONZE),
    ("far60", 2.0, 3.0, STEEL),
    ("far60", 1.5, 0.5, BRONZE),
]


@pytest.mark.parametrize(("clamp", "rho", "T", "hole"), sampled(CASES, CASES[:2]))
def test_at_first_yield_elements_of_the_ring_reach_the_yield_stress(clamp, rho, T, hole):
    pair = snug(T, hole)
    housing = Housing(rho * float(pair.R_i), CLAMPS[clamp])
    first = limits.first_yield(pair, housing=housing)
    assert first.body == "hole"
    for cells, error in ((6, 0.02), (12, 0.0015)):
        m, r, angle = largest_by_elements(pair, housing, first.load, cells)
        assert m * first.load == pytest.approx(hole.yield_stress, rel=error)
        assert r - 1 == pytest.approx(first.depth, abs=0.02)
        assert angle == pytest.approx(first.angle, abs=4)


def test_a_bush_in_a_lug_yields_where_elements_say():
    """The bush is strong, so that the lug around it yields first."""
    bush, lug = Material("bush", 110e3, 0.34, 400.0), Material("lug", 70e3, 0.33, 60.0)
    pair = snug(3.0, bush)
    R_i = float(pair.R_i)
    housing = Housing(2 * R_i, layers=[(lug, 1.2 * R_i)])
    first = limits.first_yield(pair, housing=housing)
    assert first.body == "layer 1"
    assert f"in layer 1, {first.depth:.2g} mm below the hole's surface" in str(first)
    m, r, _ = largest_by_elements(pair, housing, first.load, 12, (1.2, 2.0))
    assert m * first.load == pytest.approx(60.0, rel=0.003)
    assert r - 1 == pytest.approx(first.depth, abs=0.02)
    m, *_ = largest_by_elements(pair, housing, first.load, 12, (1.0, 1.2))
    assert m * first.load < 400.0


def test_a_pin_that_leaves_its_eye_before_anything_yields_has_no_load():
    strong = Material("aluminium", 70e3, 0.33, 5e3)
    pair = CylinderPair.internal(10.0, 9.99, strong, material_j=STEEL)
    first = limits.first_yield(pair, yield_stress=5e3, housing=Housing(13.0, Sector(300, "pulled")))
    assert np.isnan(first.load)
    assert "no load at which the pin touches its housing along one arc" in str(first)


def test_what_was_computed_before_changes_no_yield_load():
    """Joints of one shape share their arcs: whichever order, and worker, a joint is answered in."""
    loads = []
    for gaps in ([0.01, 0.02, 0.045], [0.045, 0.02, 0.01]):
        housing_stress._arcs_of.cache_clear()
        pairs = (CylinderPair.internal(10.0, 10.0 - gap, hole=BRONZE, pin=STEEL) for gap in gaps)
        eye = Housing(20.0, Sector(60, "pulled"))
        loads.append({p.dR: float(limits.first_yield(p, housing=eye).load) for p in pairs})
    assert loads[0] == pytest.approx(loads[1], rel=1e-11)
