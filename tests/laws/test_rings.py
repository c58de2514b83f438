"""Rings at rest: closed forms, finite elements in r, and relations that hold for any rings."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.limits import at_rest, at_temperature, loose_temperatures

BRONZE = Material("bronze", 110e3, 0.34, 220.0, 18e-6)
STEEL = Material("steel", 200e3, 0.3, 250.0, 12e-6)
PEEK = Material("PEEK, hot", 3.3e3, 0.38, thermal_expansion=50e-6)
RUBBER = Material("rubber", 2e3, 0.5, thermal_expansion=1e-4)


# --- known numbers ------------------------------------------------------------------------------


def test_a_bush_in_a_ring_has_the_stresses_of_lame():
    state = at_rest([BRONZE, STEEL], [10.0, 13.0, 26.0], 0.0155)
    a, b, c = 10.0, 13.0, 26.0
    of_bush = ((b**2 + a**2) / (b**2 - a**2) - 0.34) / 110e3
    of_ring = ((c**2 + b**2) / (c**2 - b**2) + 0.3) / 200e3
    p = 0.0155 / (b * (of_bush + of_ring))
    assert p == pytest.approx(28.26459, abs=1e-5)
    np.testing.assert_allclose(state.pressures, [p, 0.0], atol=1e-12)
    assert state.stress(0, a)[1] == pytest.approx(-2 * p * b**2 / (b**2 - a**2))
    assert state.stress(1, b)[1] == pytest.approx(p * (c**2 + b**2) / (c**2 - b**2))
    assert 1e3 * state.bore == pytest.approx(-12.58687, abs=1e-5)
    (loose,) = loose_temperatures([BRONZE, STEEL], [a, b, c], 0.0155)
    assert loose == pytest.approx(-0.0155 / (13 * 6e-6))


def test_a_polymer_bush_in_a_frame_warm_and_cold():
    free, bonded = (at_rest([PEEK], [10, 13], 0.027, 60, STEEL, e) for e in ("free", "bonded"))
    known = {free: (-30.65739, 4.0863, 20.0169), bonded: (-37.16054, 5.6414, 23.9394)}
    for state, (moved, pressure, mises) in known.items():
        assert 1e3 * state.bore == pytest.approx(moved, abs=1e-5)
        assert state.pressures[0] == pytest.approx(pressure, abs=1e-4)
        assert state.von_mises(0, 10.0) == pytest.approx(mises, abs=1e-4)
    assert bonded.stress(0, 11.0)[2] == pytest.approx(-14.39923, abs=1e-5)
    assert loose_temperatures([PEEK], [10, 13], 0.027, STEEL) == pytest.approx(-54.656, abs=1e-3)
    cold = at_rest([PEEK], [10, 13], 0.027, -60, STEEL)
    assert cold.open.all()
    assert 1e3 * cold.bore == pytest.approx(-30.0)
    glued = at_rest([PEEK], [10, 13], 0.0, -60, STEEL, "bonded")
    assert glued.pressures[0] < 0  # the glue carries tension


def test_an_aluminium_ring_around_a_steel_bush_is_loose_in_the_heat():
    aluminium = Material("aluminium", 70e3, 0.33, thermal_expansion=23e-6)
    rings = [STEEL, aluminium], [10.0, 13.0, 26.0]
    (loose,) = loose_temperatures(*rings, 0.01)
    assert loose == pytest.approx(0.01 / (13 * 11e-6))
    assert at_rest(*rings, 0.01, loose - 0.1).pressures[0] > 0
    assert at_rest(*rings, 0.01, loose + 0.1).open[0]


# --- a second derivation ------------------------------------------------------------------------


def by_elements(materials, radii, fits, warmer, frame, ends, count=60):
    """The bore's displacement and each ring's σ_z: quadratic elements in r, energy of a solid."""
    n, nodes = len(materials), 2 * count + 1
    size = n * nodes + n  # displacements of each ring, then its axial strain
    K, load = np.zeros((size, size)), np.zeros(size)
    x, weights = np.polynomial.legendre.leggauss(3)
    shape = np.array([x * (x - 1) / 2, 1 - x**2, x * (x + 1) / 2])
    slope = np.array([x - 0.5, -2 * x, x + 0.5])
    for k, body in enumerate(materials):
        E, nu = body.E, body.nu
        D = E * (nu * np.ones((3, 3)) + (1 - 2 * nu) * np.eye(3)) / ((1 + nu) * (1 - 2 * nu))
        edges = np.linspace(radii[k], radii[k + 1], count + 1)
        for j, (a, b) in enumerate(pairwise(edges)):
            h = (b - a) / 2
            at = [k * nodes + 2 * j + i for i in range(3)] + [n * nodes + k]
            for q, w in enumerate(weights):
                r = (a + b) / 2 + h * x[q]
                B = np.zeros((3, 4))
                B[0, :3], B[1, :3], B[2, 3] = slope[:, q] / h, shape[:, q] / r, 1.0
                K[np.ix_(at, at)] += w * h * r * B.T @ D @ B
                load[at] += w * h * r * B.T @ D @ np.full(3, body.thermal_expansion * warmer[k])
    rows, right = [], []

    def tie(terms, value):
        row = np.zeros(size)
        for at, factor in terms:
            row[at] = factor
        rows.append(row)
        right.append(value)

    for k in range(n - 1):
        tie([((k + 1) * nodes - 1, -1.0), ((k + 1) * nodes, 1.0)], fits[k])
        if ends == "bonded":
            tie([(n * nodes + k, 1.0), (n * nodes + k + 1, -1.0)], 0.0)
    if frame is not None:
        tie([(n * nodes - 1, 1.0)], frame * radii[-1] - fits[-1])
        if ends == "bonded":
            tie([(size - 1, 1.0)], frame)
    C = np.array(rows).reshape(len(rows), size)
    zeros = np.zeros((len(rows),) * 2)
    solved = np.linalg.solve(np.block([[K, C.T], [C, zeros]]), np.append(load, right))[:size]
    return solved[0]


@pytest.mark.parametrize("ends", ["free", "bonded"])
@pytest.mark.parametrize("framed", [False, True])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_elements_in_r_give_the_same_bore(count, framed, ends):
    rng = np.random.default_rng([count, framed, ends == "free"])
    materials = [
        Material("", 10 ** rng.uniform(3.5, 5.4), rng.uniform(0.1, 0.45), None, a)
        for a in rng.uniform(8e-6, 3e-5, count + 1)
    ]
    *materials, frame = materials
    radii = np.cumsum([10.0, *rng.uniform(1.0, 6.0, count)])
    fits, warmer = rng.uniform(0.05, 0.08, count), rng.uniform(10.0, 80.0, count + 1)
    if ends == "bonded":
        fits *= 0  # the elements cannot press with free ends and warm with bonded ones
    touching = count if framed else count - 1
    state = at_rest(
        materials, radii, list(fits[:touching]), warmer[: count + framed],
        frame if framed else "free", ends,
    )  # fmt: skip
    growth = frame.thermal_expansion * warmer[-1] if framed else None
    moved = by_elements(materials, radii, fits, warmer, growth, ends)
    assert not state.open[..., :touching].any()
    assert state.bore == pytest.approx(moved, rel=1e-6, abs=1e-9)


# --- relations ----------------------------------------------------------------------------------


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("warm", [0.0, 80.0, -60.0])
@pytest.mark.parametrize("ends", ["free", "bonded"])
def test_one_material_heated_evenly_scales_its_clearance(plane, warm, ends):
    pair = CylinderPair.internal(10.0, [9.98, 9.99], STEEL, plane=plane)
    eye = laws.Housing(20.0, laws.Sector.lug())
    ring, two = laws.Housing(20.0), laws.Housing(20.0, layers=[(STEEL, 12.0)])
    around = [(None, None), (ring, "free"), (ring, STEEL), (two, "free"), (two, STEEL)]
    for housing, rim in [*around, (eye, "free")]:
        hot = at_temperature(pair, warm, warm, housing=housing, rim=rim, ends=ends)
        scale = 1 + 12e-6 * (warm - 20)
        for key in ("dR", "R_i", "R_j"):
            np.testing.assert_allclose(getattr(hot, key), scale * getattr(pair, key), rtol=1e-12)


@settings(deadline=None, max_examples=25)
@given(st.floats(1e3, 3e5), st.floats(0, 0.5), st.floats(-40, 120), st.floats(0, 0.02))
def test_an_array_of_pairs_is_each_pair_alone(E, nu, warm, interference):
    def pair(R_i, E):
        bush = Material("", np.asarray(E), nu, thermal_expansion=2e-5)
        return CylinderPair.internal(R_i, R_i - 0.3, pin=STEEL, hole=bush)

    housing = laws.Housing(20.0, layers=[(STEEL, 14.0)])
    given = {"housing": housing, "rim": "held", "interference": interference}
    R_i, E_i = np.array([10.0, 11.0, 12.0]), E * np.array([[1.0], [1.2]])
    both = at_temperature(pair(R_i, E_i), 20, warm, **given)
    for i, row in enumerate(E_i[:, 0]):
        for j, R in enumerate(R_i):
            alone = at_temperature(pair(R, row), 20, warm, **given)
            assert both.dR[i, j] == pytest.approx(float(alone.dR), rel=1e-12)


def test_an_incompressible_ring_is_the_limit_of_nearly_incompressible_ones():
    def bore(nu, ends):
        ring = Material("", 2e3, nu, thermal_expansion=1e-4)
        return at_rest([ring, STEEL], [10.0, 12.0, 20.0], 0.0, 60.0, ends=ends).bore

    for ends in ("free", "bonded"):
        assert bore(0.5, ends) == pytest.approx(bore(0.5 - 1e-9, ends), rel=1e-7)


def test_a_ring_that_expands_more_than_the_bush_within_comes_loose():
    state = at_rest([STEEL, RUBBER], [10.0, 12.0, 20.0], 0.0, 60.0)
    assert state.open[0]
    assert state.bore == pytest.approx(10 * 12e-6 * 60)  # that of the bush alone
    both = at_rest([STEEL, RUBBER], [10.0, [12.0, 13.0], 20.0], [np.array([0.0, 0.5])], 60.0)
    np.testing.assert_array_equal(both.open[:, 0], [True, False])


def test_only_the_interface_that_pulls_most_opens():
    """The middle ring shrinks onto the inner one and away from the outer one."""
    cold = at_rest([STEEL, BRONZE, STEEL], [10.0, 12.0, 14.0, 20.0], 0.0, -50.0)
    np.testing.assert_array_equal(cold.open, [False, True, True])
    assert cold.pressures[0] > 0


# --- a pair at its temperatures -----------------------------------------------------------------


def test_a_steel_pin_in_a_bronze_hole_gains_clearance_when_it_is_warmed_by_60_K():
    pair = at_temperature(CylinderPair.internal(10.0, 9.99, pin=STEEL, hole=BRONZE), 80, 80)
    assert pair.dR == pytest.approx(0.01 + 10 * 18e-6 * 60 - 9.99 * 12e-6 * 60, rel=1e-12)
    assert pair.dR == pytest.approx(pair.R_i - pair.R_j)


def test_a_pin_seizes_at_the_temperature_that_the_error_says():
    tight = CylinderPair.internal(10.0, 9.9965, pin=BRONZE, hole=STEEL)
    at = 20 + 0.0035 / (9.9965 * 18e-6 - 10 * 12e-6)
    with pytest.raises(InputError, match=rf"seizes the pin: no clearance is left at {at:.1f} °C;"):
        at_temperature(tight, pin=80, hole=80)
    assert at_temperature(tight, pin=at - 0.01, hole=at - 0.01).dR < 1e-5
    hot = 0.0035 / (9.9965 * 18e-6 * 60) * 60 + 20
    with pytest.raises(InputError, match=f"at {hot:.1f} °C of the pin and 20.0 °C of the hole"):
        at_temperature(tight, pin=80)
    cold = CylinderPair.internal(10.0, 9.9995, STEEL)
    with pytest.raises(InputError, match=r"at 20.0 °C of the pin and 15.8 °C of the hole"):
        at_temperature(cold, hole=0.0)


def test_a_bush_that_comes_loose_before_its_pin_seizes():
    """Its clearance bends with the temperature; the pin seizes where the free bush meets it."""
    pair = CylinderPair.internal(10.0, 9.975, pin=STEEL, hole=PEEK)
    around = {"housing": laws.Housing(13.0), "rim": STEEL, "interference": 0.0135}
    (loose,) = loose_temperatures([PEEK], [10, 13], 0.0135, STEEL)
    pressed = at_rest([PEEK], [10, 13], 0.0135, 0.0, STEEL).bore
    # Free: the bore is 10·50e-6·T from its unloaded radius, and the hole began at `pressed`.
    at = 20 - (0.025 - pressed) / (10 * 50e-6 - 9.975 * 12e-6)
    assert at < 20 + loose
    with pytest.raises(InputError, match=rf"no clearance is left at {at:.1f} °C;"):
        at_temperature(pair, -100.0, -100.0, **around)
    assert 0 < at_temperature(pair, at + 0.1, at + 0.1, **around).dR < 1e-4


def test_pin_and_hole_are_warmed_together():
    """At 100 °C the pin alone would seize; the hole widens with it."""
    pair = CylinderPair.internal(10.0, 9.995, STEEL, plane="stress")
    hot = at_temperature(pair, 100, 100, housing=laws.Housing(20.0), rim="free")
    assert 1e3 * hot.dR == pytest.approx(5.0048)


REFUSED = {
    "rim: is missing: .* give \"free\", \"held\", or the material": {"housing": laws.Housing(20.0)},
    "rim = 'fixed': is not a state": {"housing": laws.Housing(20.0), "rim": "fixed"},
    "rim = 'free': is for a housing": {"rim": "free"},
    "interference = 0.01: is for a housing": {"interference": 0.01},
    "is for a rim clamped all round": {
        "housing": laws.Housing(20.0, laws.Sector(60, "pulled")), "rim": "held",
    },
    "must be larger than the hole": {"housing": laws.Housing(9.0), "rim": "held"},
    "interference = 0.01: has 1 values for 0 edges": {
        "housing": laws.Housing(20.0), "rim": "free", "interference": 0.01,
    },
    "ends = 'glued': must be 'free' or 'bonded'": {
        "housing": laws.Housing(20.0), "rim": "free", "ends": "glued",
    },
    "needs the thermal_expansion of none, which is not known": {
        "housing": laws.Housing(20.0, layers=[(Material("none", 1e4, 0.3), 12.0)]), "rim": "free",
    },
    "is a polymer, whose modulus": {
        "housing": laws.Housing(20.0, layers=[(Material.named("PEEK"), 12.0)]), "rim": "free",
    },
    "is given by compliances": {
        "housing": laws.Housing.from_compliances([-0.1, 0.4, -0.05, -1e-5]), "rim": "free",
    },
}  # fmt: skip


@pytest.mark.parametrize("message", REFUSED)
def test_a_pair_at_a_temperature_refuses(message):
    pair = CylinderPair.internal(10.0, 9.95, pin=STEEL, hole=BRONZE)
    with pytest.raises(InputError, match=message):
        at_temperature(pair, 80, 80, **REFUSED[message])


def test_rings_refuse_radii_that_do_not_increase_and_wrong_counts():
    for radii in ([10.0, 13.0], [10.0, 13.0, 13.0], [0.0, 13.0, 20.0]):
        with pytest.raises(InputError, match=r"radii = .*: must be one more than the rings"):
            at_rest([BRONZE, STEEL], radii)
    with pytest.raises(InputError, match=r"warmer = .*: must be one, or one for each ring"):
        at_rest([BRONZE, STEEL], [10.0, 13.0, 20.0], warmer=[1.0, 2.0, 3.0])
