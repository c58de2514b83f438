"""The joint in space: its potential, its limit in the plane, its impacts, mistakes in files."""

import itertools
from pathlib import Path

import numba
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from cylcontact import InputError
from cylcontact.mechanism import (
    JointState,
    SpatialJoint,
    SpatialState,
    joint_from,
    read_joint,
    spatial_forces,
)
from cylcontact.mechanism.spatial_forces import OUTSIDE, RIM_MISSING, UNLIKE, WORK
from cylcontact.spec import read_toml
from tests.support.spatial_cases import FIXED, body, joint_for, motions, run_library
from tests.support.spec_files import DROP, changed

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = read_toml(ROOT / "datasets/spatial_joint.toml")
THRUST = {"play": 0.2, "radius": 12.0, "stiffness": 2e5, "restitution": 0.5}
# Every part of the element.
KINDS = {
    "free rims": {"edge": {"kind": "none"}},
    "example": {},
    "thrust": {"thrust": THRUST},
    "ends": {"pin.ends": [-9.5, 9.0], "edge": {"c": 0.1, "b": 0.5}, "thrust": THRUST},
    "crown": {"pin.crown": 0.004, "edge": {"kind": "flush"}},
    "short and crowned": {"pin.crown": 0.004, "pin.ends": [-9, 9], "edge": {"c": 0.1, "b": 0.5}},
    "power": {"law": "lankarani-nikravesh", "units": "mm"},
}
each_kind = pytest.mark.parametrize("kind", KINDS)
ELASTIC = {"friction.coefficient": 0.0, "dissipation.restitution": 1.0}


def elastic_joint(kind):
    """Return a joint of a kind without friction and damping, in SI units."""
    faces = {"thrust.restitution": 1.0} if "thrust" in KINDS[kind] else {}
    return joint_for(**{**KINDS[kind], **ELASTIC, **faces, "units": "SI"})


def displaced(pin, step, at):
    """Return a pin moved along or turned about an axis of the world, at rest."""
    shift, turn = np.zeros(3), np.zeros(3)
    (shift if at < 3 else turn)[at % 3] = step
    rotation = Rotation.from_rotvec(turn) * Rotation.from_quat(pin[3:7], scalar_first=True)
    return body(pin[:3] + shift, rotation)


# --- the potential ---


def energy_of(joint, pin):
    """Return the energy in N mm by dense quadrature, of formulas written anew."""
    spec, pair = joint.spec, joint.planar.pair
    a = Rotation.from_quat(pin[3:7], scalar_first=True).apply([0.0, 0.0, 1.0])
    c, psi = 1e3 * pin[:3], -a[:2] / a[2]
    half, (R_i, R_j) = spec.length / 2, map(float, pair.radii("it"))
    low, high = spec.pin.ends or (-np.inf, np.inf)
    low, high = max(-half, c[2] + low * a[2]), min(half, c[2] + high * a[2])
    crown_at, crown_half = (
        np.mean(spec.pin.ends or (0, 0)),
        np.ptp(spec.pin.ends or (-half, half)) / 2,
    )

    def penetration(z):
        e = -c[:2] + (z - c[2])[..., None] * psi
        r = np.linalg.norm(e, axis=-1)
        q = np.sqrt(1 + (e @ psi / r) ** 2)
        off = (z - c[2] - crown_at) / crown_half
        return r + R_j * (q - 1) - pair.dR - spec.pin.crown * off**2

    v, weights = np.polynomial.legendre.leggauss(40)
    x, weights = ((v + 1) / 2) ** 4, 2 * ((v + 1) / 2) ** 3 * weights

    def density(z):
        delta = np.maximum(penetration(z), 0.0)[..., None]
        return (joint.planar.law.load(np.maximum(delta * x, 1e-300), pair) * delta) @ weights

    grid = np.linspace(low, high, 4001)
    turns = np.flatnonzero(np.diff(np.sign(penetration(grid))))
    cuts = [low, *(brentq(penetration, *grid[k : k + 2], xtol=1e-15) for k in turns), high]
    total = 0.0
    for first, last in itertools.pairwise(cuts):
        for start, stop in ((first, (first + last) / 2), (last, (first + last) / 2)):
            total += abs(stop - start) * (density(start + (stop - start) * x) @ weights)
    c_r, b = spec.edge.constants
    for z, sign in ((high, 1), (low, -1)):
        delta = float(penetration(np.array(z)))
        e = -c[:2] + (z - c[2]) * psi
        slope = max(sign * (psi @ e) / np.linalg.norm(e), 0.0)
        if delta > 0:
            chi = slope**2 / (slope**2 + (delta / (b * R_i)) ** 2)
            stiff = 0.4 * c_r * pair.E_star * np.sqrt(2 * R_i * R_j / pair.dR)
            total += stiff * delta**2.5 * chi
    if spec.thrust:
        phi = np.linspace(0, 2 * np.pi, 20001)[:-1]
        lean, T = np.linalg.norm(a[:2]), spec.thrust
        for sign in (1, -1):
            ring = c[2] + sign * a[2] * (half + T.play / 2) + T.radius * lean * np.cos(phi)
            delta = np.maximum(half - sign * ring, 0.0)
            total += T.stiffness / 2 * np.mean(delta**2)
    return total


@each_kind
def test_the_energy_is_that_of_a_dense_quadrature(kind):
    joint = joint_for(**{**KINDS[kind], "units": "SI"})
    pins = motions(joint, 40, seed=3)[1]
    energies = 1e3 * joint.evaluate(joint.start(), FIXED, pins).elastic_energy
    wanted = np.array([energy_of(joint, pin) for pin in pins])
    assert (wanted > 1e-6).sum() >= 6
    np.testing.assert_allclose(energies, wanted, rtol=1e-6, atol=1e-9 * wanted.max())


@each_kind
def test_the_elastic_wrench_is_the_slope_of_the_energy(kind):
    joint = elastic_joint(kind)
    count = 0
    for pin in motions(joint, 25, seed=4)[1]:
        pin[7:] = 0.0  # no damping
        wrench = joint.evaluate(joint.start(), FIXED, pin)
        if wrench.elastic_energy == 0 or np.abs(wrench.penetration).min() < 3e-7:
            continue
        count += 1
        wanted = []
        for at in range(6):
            step = 2e-8 if at < 3 else 2e-6
            moved = np.array([displaced(pin, k * step, at) for k in (-2, -1, 1, 2)])
            U = joint.evaluate(joint.start(), FIXED, moved).elastic_energy
            wanted.append(-(U[0] - 8 * U[1] + 8 * U[2] - U[3]) / (12 * step))
        scale = np.abs(wrench.force_pin).max() + 1.0
        np.testing.assert_allclose(wrench.force_pin, wanted[:3], atol=2e-5 * scale)
        np.testing.assert_allclose(wrench.moment_pin, wanted[3:], atol=2e-5 * scale * 0.01)
    assert count >= 4


LOOPS = ("free rims", "example", "thrust", "ends")


@pytest.mark.parametrize("kind", LOOPS)
@pytest.mark.parametrize("rims", [1, 2])
def test_no_work_is_left_around_closed_paths(kind, rims):
    """100 loops of all six coordinates, so small that the same rims stay in contact."""
    joint = elastic_joint(kind)
    _, pins = motions(joint, 4000, seed=8)
    before = joint.evaluate(joint.start(), FIXED, pins)
    start = before.penetration[:, :2]
    clear = (np.abs(before.penetration) > 3e-7).all(axis=1) & (
        np.count_nonzero(start > 0, axis=1) == rims
    )
    clear &= before.touched < 0.3 * before.touched.max()
    reserves, along = np.abs(before.penetration).min(axis=1), 1 if joint.spec.thrust else 300
    assert clear.sum() >= 15
    chosen = [k for k in np.flatnonzero(clear) if start[k].max() < 5e-6][:100]
    rng, t = np.random.default_rng(1), 2 * np.pi * np.arange(128) / 128
    ratios = []
    for pin, reserve in zip(pins[chosen], reserves[chosen], strict=True):
        size = 0.1 * reserve * np.array([1, 1, along, 60, 60, 1e3])
        phases = t[:, None] + rng.uniform(0, 2 * np.pi, 6)
        q, rate = size * np.cos(phases), -size * np.sin(phases)
        # Turned about x, then about the turned y, then about the turned z.
        first = Rotation.from_rotvec(q[:, 3:4] * [1, 0, 0])
        second = first * Rotation.from_rotvec(q[:, 4:5] * [0, 1, 0])
        spin = rate[:, 3:4] * [1, 0, 0] + first.apply(rate[:, 4:5] * [0, 1, 0])
        spin += second.apply(rate[:, 5:6] * [0, 0, 1])
        turn = second * Rotation.from_rotvec(q[:, 5:6] * [0, 0, 1])
        turn = turn * Rotation.from_quat(pin[3:7], scalar_first=True)
        moved = np.hstack([pin[:3] + q[:, :3], turn.as_quat(scalar_first=True), rate[:, :3], spin])
        w = joint.evaluate(joint.start(), FIXED, moved)
        power = (w.force_pin * rate[:, :3]).sum(axis=1) + (w.moment_pin * spin).sum(axis=1)
        ratios.append(abs(power.sum()) / np.abs(power).sum())
    assert max(ratios) <= 1e-10


# --- what holds in every motion ---


def test_without_tilt_it_is_the_planar_joint():
    """Damping and friction included, to 1e-12 of the peak of each column."""
    joint = joint_for(
        **{"edge.kind": "overhang", "bearing.point": [2, 3, 0], "pin.point": [-4, 1, 0]}
    )
    planar = joint_from(
        changed({k: v for k, v in EXAMPLE.items() if k not in ("kind", "edge")},
                {"bearing.axis": DROP, "pin.axis": DROP, "bearing.point": [2.0, 3.0],
                 "pin.point": [-4.0, 1.0]})
    )  # fmt: skip
    rng, n = np.random.default_rng(2), 4000
    angles, towards = rng.uniform(0, 6, (2, n)), rng.uniform(0, 6, n)
    away = 5e-5 * (1 + 10 ** rng.uniform(-2.5, -0.5, n))
    velocity, spin, rate = (
        rng.normal(0, 0.1, (2, n, 2)),
        rng.normal(0, 10, (2, n)),
        rng.uniform(0.01, 1, n),
    )
    position = np.zeros((2, n, 2))
    turned = [np.column_stack([np.cos(a), np.sin(a)]) for a in angles]
    for k, point in enumerate(([2e-3, 3e-3], [-4e-3, 1e-3])):
        c, s = turned[k].T
        position[k] -= np.column_stack([c * point[0] - s * point[1], s * point[0] + c * point[1]])
    position[1] += away[:, None] * np.column_stack([np.cos(towards), np.sin(towards)])
    flat = [np.column_stack([position[k], angles[k], velocity[k], spin[k]]) for k in range(2)]
    space = np.zeros((2, n, 13))
    for k in range(2):
        space[k, :, :2], space[k, :, 7:9], space[k, :, 12] = position[k], velocity[k], spin[k]
        space[k, :, 3], space[k, :, 6] = np.cos(angles[k] / 2), np.sin(angles[k] / 2)
    wanted = planar.evaluate(JointState(rate), *flat)
    rates = np.column_stack([rate, rate, 0 * rate, 0 * rate])
    w = joint.evaluate(SpatialState(rates), *space)
    assert np.abs(wanted.force_pin).max() > 1e4
    for got, plane in (
        (w.force_pin[:, :2], wanted.force_pin), (w.force_bearing[:, :2], wanted.force_bearing),
        (w.moment_pin[:, 2], wanted.moment_pin), (w.moment_bearing[:, 2], wanted.moment_bearing),
        (w.normal_force, wanted.normal_force), (w.dissipated_power, wanted.dissipated_power),
        (w.penetration[:, 0], wanted.penetration),
        (w.penetration_rate[:, 1], wanted.penetration_rate),
    ):  # fmt: skip
        np.testing.assert_allclose(got, plane, rtol=0, atol=1e-12 * np.abs(plane).max())
    peak = np.abs(w.moment_pin).max()
    np.testing.assert_allclose(w.force_pin[:, 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(w.moment_pin[:, :2], 0.0, atol=1e-12 * peak)
    assert (w.touched == 0.02).all()


@each_kind
def test_forces_balance_and_power_is_what_is_stored_and_lost(kind):
    joint = joint_for(**{**KINDS[kind], "units": "SI"})
    rates, pins = motions(joint, 1500, seed=5)
    rng = np.random.default_rng(6)
    bearing = np.hstack([rng.normal(0, 1e-3, (1500, 3)), *[np.tile([1.0, 0, 0, 0], (1500, 1))],
                         rng.normal(0, 0.1, (1500, 6))])  # fmt: skip
    pins[:, :3] += bearing[:, :3]
    w = joint.evaluate(SpatialState(rates), bearing, pins)
    np.testing.assert_array_equal(w.force_pin, -w.force_bearing)
    about = w.moment_pin + w.moment_bearing + np.cross(pins[:, :3] - bearing[:, :3], w.force_pin)
    np.testing.assert_allclose(about, 0.0, atol=2e-15 * np.abs(w.moment_pin).max())
    assert (w.dissipated_power >= 0).all()
    assert w.dissipated_power.max() > 1.0
    # All power that goes in is lost, or stored; the rate of the energy by a step of time.
    elastic = elastic_joint(kind).evaluate(joint.start(), bearing, pins)
    power, stored = (
        (x.force_pin * pins[:, 7:10]).sum(1) + (x.moment_pin * pins[:, 10:]).sum(1)
        + (x.force_bearing * bearing[:, 7:10]).sum(1) + (x.moment_bearing * bearing[:, 10:]).sum(1)
        for x in (w, elastic)
    )  # fmt: skip
    balance = power + w.dissipated_power - stored
    np.testing.assert_allclose(balance, 0.0, atol=1e-12 * np.abs(power).max())


@each_kind
def test_only_the_motion_against_each_other_matters(kind):
    """Both bodies as seen from a frame that is turned and moves and spins at will."""
    joint = joint_for(**{**KINDS[kind], "units": "SI"})
    rates, pins = motions(joint, 800, seed=7)
    origin, turn = np.array([3e-3, -2e-3, 1e-3]), Rotation.from_rotvec([0.4, -1.1, 0.7])
    drift, spin = np.array([0.5, 0.1, -0.2]), np.array([3.0, -5.0, 2.0])

    def seen(body):
        out = body.copy()
        out[..., :3] = turn.apply(body[..., :3]) + origin
        rotation = turn * Rotation.from_quat(body[..., 3:7], scalar_first=True)
        out[..., 3:7] = 3.0 * rotation.as_quat(scalar_first=True)
        from_origin = out[..., :3] - origin
        out[..., 7:10] = turn.apply(body[..., 7:10]) + drift + np.cross(spin, from_origin)
        out[..., 10:] = turn.apply(body[..., 10:]) + spin
        return out

    fixed = np.tile(FIXED, (len(pins), 1))
    plain, other = (
        joint.evaluate(SpatialState(rates), *b) for b in ((fixed, pins), (seen(fixed), seen(pins)))
    )
    # Far from the origin the rounding of the places, 5e-17 m at 0.4 m, makes more of a difference.
    # Without tilt a contact is integrated from either end, and damping bends inside.
    inside = (np.abs(plain.penetration) > 1e-7).all(axis=1)
    inside &= np.abs(np.diff(plain.penetration[:, :2]).ravel()) > 1e-9
    names = {"force_pin": 1e-12, "moment_pin": 1e-11, "moment_bearing": 1e-11}
    for name, tolerance in {**names, "penetration_rate": 1e-11}.items():
        wanted = getattr(plain, name)[inside]
        if name != "penetration_rate":
            wanted = turn.apply(wanted)
        np.testing.assert_allclose(
            getattr(other, name)[inside], wanted, rtol=0, atol=tolerance * np.abs(wanted).max()
        )


def test_an_axis_may_point_either_way_and_lie_anywhere():
    """A pin turned end to end, its faces and ends with it; and both axes along x."""
    plain, ends = joint_for(**KINDS["ends"]), {"pin.ends": [-9.0, 9.5], "pin.axis": [0, 0, -2]}
    rates, pins = motions(plain, 500, seed=9)
    pins = pins[np.linalg.norm(pins[:, 4:6], axis=1) > 1e-7]
    rates = rates[: len(pins)]
    wanted = run_library(plain, rates, FIXED, pins)
    turned = run_library(joint_for(**{**KINDS["ends"], **ends}), rates, FIXED, pins)
    np.testing.assert_array_equal(turned, wanted)
    along = Rotation.from_rotvec([0, np.pi / 2, 0])
    x = joint_for(**{**KINDS["ends"], "bearing.axis": [1, 0, 0], "pin.axis": [1, 0, 0]})
    bodies = []
    for numbers in (np.tile(FIXED, (len(pins), 1)), pins):
        rotation = Rotation.from_quat(numbers[:, 3:7], scalar_first=True) * along.inv()
        bodies.append(
            np.hstack([numbers[:, :3], rotation.as_quat(scalar_first=True), numbers[:, 7:]])
        )
    answers = run_library(x, rates, *bodies)
    peak = np.abs(wanted).max(axis=0) + 1e-12
    np.testing.assert_allclose(answers / peak, wanted / peak, rtol=0, atol=1e-9)


# --- impacts ---


def impact(joint, pose, inertia, start, load=0.0, state=None):
    """Integrate the motion in few coordinates until no rim touches, or only that at rest.

    `pose` gives the pin's numbers and the derivatives of its place by the coordinates. Yields the
    rim, its rate and the velocities at each onset and release.
    """
    n = len(inertia)
    state = joint.start() if state is None else state

    def slope(_, y, state):
        numbers, jacobian = pose(y[:n], y[n:])
        w = joint.evaluate(state, FIXED, numbers)
        pull = jacobian.T @ np.concatenate([w.force_pin, w.moment_pin])
        return np.concatenate([y[n:], (pull + load) / inertia])

    def event(rim):
        def penetration(_, y, state):
            numbers = pose(y[:n], y[n:])[0]
            return joint.evaluate(state, FIXED, numbers).penetration[rim]

        penetration.terminal = True
        return penetration

    y = start
    for _ in range(12):
        # Across the event, so that it is not seen again.
        y = y + 1e-9 * slope(0, y, state)
        state = joint.accept(state, FIXED, pose(y[:n], y[n:])[0])
        run = solve_ivp(
            slope, (0, 2e-3), y, "DOP853", events=[event(0), event(1)], args=(state,),
            rtol=1e-9, atol=1e-13, max_step=1e-5,
        )  # fmt: skip
        y = run.y[:, -1]
        rim = int(np.argmax([t.size for t in run.t_events]))
        w = joint.evaluate(state, FIXED, pose(y[:n], y[n:])[0])
        yield rim, float(w.penetration_rate[rim]), y[n:]


IMPACTS = {**KINDS["free rims"], "friction.coefficient": 0.0}


@pytest.mark.parametrize(("arm", "edge"), [(30.0, "none"), (100.0, "none"), (15.0, "overhang")])
def test_a_rim_that_a_hinged_pin_strikes_has_the_restitution_of_the_file(arm, edge):
    """The pin turns about a point on its axis, below rim B: one degree of freedom."""
    joint = joint_for(**{**IMPACTS, "edge.kind": edge})

    def pose(q, v):
        turn, z = Rotation.from_rotvec([0, q[0], 0]), -1e-3 * arm
        centre = np.array([0, 0, z]) - turn.apply([0, 0, z])
        spin = np.array([0, v[0], 0])
        velocity = np.cross(spin, centre - [0, 0, z])
        lever = np.cross([0, 1.0, 0], centre - [0, 0, z])
        return body(centre, turn, velocity, spin), np.array([[*lever, 0, 1.0, 0]]).T

    span = (10 + arm) * 1e-3
    angle = brentq(
        lambda q: joint.evaluate(joint.start(), FIXED, pose([q], [0.0])[0]).penetration[0],
        0.5 * 5e-5 / span, 2 * 5e-5 / span,
    )  # fmt: skip
    start = np.array([angle * (1 - 1e-7), 0.1 / span])
    events = impact(joint, pose, np.array([0.5 * span**2]), start)
    rim, rate, _ = next(events)
    assert rim == 0
    assert -rate / 0.1 == pytest.approx(0.8, abs=5e-3)


def in_plane(q, v):
    """Return a pin that moves along x and turns about y."""
    numbers = body([q[0], 0, 0], Rotation.from_rotvec([0, q[1], 0]), [v[0], 0, 0], [0, v[1], 0])
    return numbers, np.array([[1.0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 1, 0]]).T


@pytest.mark.parametrize("tilt", [0.0, 5e-4, 1e-3, 3e-3])
def test_a_free_pin_that_flies_tilted_has_nearly_the_restitution_of_the_file(tilt):
    """Along the impulse J until the rim is free again: e = -J.v_after/J.v_before."""
    joint = joint_for(**IMPACTS)
    inertia = np.array([0.5, 5e-5])

    def deeper(x):
        return joint.evaluate(joint.start(), FIXED, in_plane([x, tilt], [0, 0])[0]).penetration[0]

    before = np.array([0.2, 0.0])
    start = np.array([brentq(deeper, 0.0, 1e-4) - 1e-10, tilt, *before])
    after = next(v for rim, rate, v in impact(joint, in_plane, inertia, start) if rim == 0)
    impulse = inertia * (after - before)
    assert -(impulse @ after) / (impulse @ before) == pytest.approx(0.8, abs=0.015)


@pytest.mark.parametrize(("shift", "force"), [(5.08e-5, 4.7), (5.3e-5, 70.7)])
def test_a_pin_at_rest_on_one_rim_keeps_the_restitution_of_an_impact_at_the_other(shift, force):
    """Rim B is pressed by a force; the pin turns about it until rim A strikes."""
    joint = joint_for(**IMPACTS)
    state = SpatialState(np.array([0.0, joint.planar.rate_floor, 0.0, 0.0]))
    x, angle = 0.01 * 4.6e-3 - shift, 4.6e-3
    w = joint.evaluate(state, FIXED, in_plane([x, angle], [0, 0])[0])
    assert w.penetration[0] < 0 < w.penetration[1]
    assert w.force_pin[0] == pytest.approx(force, rel=0.01)
    load = -np.array([w.force_pin[0], w.moment_pin[1]])
    events = impact(
        joint, in_plane, np.array([0.5, 5e-5]), np.array([x, angle, 0.1, 10.0]), load, state
    )
    came, left = itertools.islice((rate for rim, rate, _ in events if rim == 0), 2)
    assert -left / came == pytest.approx(0.8, abs=0.01)


# --- how it is called, and mistakes ---


def test_accept_keeps_a_rate_for_each_rim_and_each_face():
    joint = joint_for(thrust=THRUST)
    tilted = Rotation.from_rotvec([0, 5e-3, 0])
    pressed = body([1e-5, 0, 1.2e-4], tilted, [0.1, 0, 0.3], [0, 0, 0])
    state = joint.accept(joint.start(), FIXED, pressed)
    w = joint.evaluate(state, FIXED, pressed)
    touching = w.penetration > 0
    assert touching.tolist() == [True, False, False, True] or touching[0]
    first = np.where(touching, np.maximum(w.penetration_rate, joint.planar.rate_floor), 0.0)
    np.testing.assert_allclose(state.impact_rate, first, rtol=1e-12)
    faster = pressed.copy()
    faster[7:10] *= 5
    np.testing.assert_array_equal(joint.accept(state, FIXED, faster).impact_rate, first)
    np.testing.assert_array_equal(joint.accept(state, FIXED, FIXED).impact_rate, 0.0)


def test_flags_tell_a_missing_rim_a_large_tilt_yield_and_unlike_materials():
    leaning = body([0, 0, 0], Rotation.from_rotvec([5.05e-3, 0, 0]))
    w = joint_for(**{"edge.kind": "none"}).evaluate(SpatialState(np.zeros(4)), FIXED, leaning)
    assert 0 < w.touched < 0.005
    assert w.flag == RIM_MISSING
    steep = body([0, 0, 0], Rotation.from_rotvec([0.11, 0, 0]))
    assert joint_for().evaluate(SpatialState(np.zeros(4)), FIXED, steep).flag & OUTSIDE
    soft = {"bearing.yield_stress": 100.0, "pin.yield_stress": 100.0}
    assert joint_for(**soft).evaluate(SpatialState(np.zeros(4)), FIXED, leaning).flag == 1
    for edge, flag in (({"kind": "flush"}, UNLIKE), ({"c": 0.1, "b": 0.5}, 0)):
        joint = joint_for(**{"bearing.E": 3.6, "edge": edge})
        assert joint.evaluate(joint.start(), FIXED, leaning).flag == flag


MISTAKES = {
    "crown": (
        {"pin.crown": 20.0},
        "pin.crown = 20.0: is more than the length of the bush; keep it",
    ),
    "end": (
        {"pin.ends": [-9, 9]},
        "edge.kind = 'overhang': is not known for an end of the pin ins",
    ),
    "ends": (
        {"pin.ends": [9, -9]},
        "pin.ends = (9.0, -9.0): leave no pin; give the lower one first",
    ),
    "axis": ({"pin.axis": [0, 0, 0]}, "pin.axis = (0.0, 0.0, 0.0): has no direction; give one, as"),
    "face": (
        {"thrust": {**THRUST, "stiffness": 1e8}},
        "thrust.stiffness = 100000000.0: is above that of a rigid collar; keep it below 3.18e+06",
    ),
    "ring": (
        {"thrust": {**THRUST, "radius": 9.0}},
        "thrust.radius = 9.0: is inside the hole; give",
    ),
    "no edge": ({"edge": DROP}, "edge: is required; add a table [edge], the stiffness of the rims"),
    "half an edge": ({"edge": {"c": 0.1}}, "edge: needs a kind, or both c and b; write kind = "),
    "planar key": ({"pin.R": 12.0, "clearance": DROP}, "pin.R = 12.0: does not fit in the hole"),
    "plane": ({"kind": DROP}, 'kind: is required; add "spatial"'),
}


@pytest.mark.parametrize(("changes", "message"), MISTAKES.values(), ids=MISTAKES)
def test_mistakes_in_a_file_take_one_line(changes, message):
    with pytest.raises(InputError) as caught:
        SpatialJoint.from_data(changed(EXAMPLE, changes), "mine.toml")
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_a_motion_that_is_none_and_a_file_for_the_other_joint_are_refused():
    joint = joint_for()
    with pytest.raises(InputError, match="must be thirteen numbers; give position, quaternion w x"):
        joint.evaluate(joint.start(), FIXED, np.zeros(6))
    with pytest.raises(InputError, match="has a quaternion of zeros"):
        joint.evaluate(joint.start(), FIXED, np.zeros(13))
    across = body([0, 0, 0], Rotation.from_rotvec([np.pi / 2, 0, 0]))
    with pytest.raises(InputError, match="has its axis near a right angle to that of the hole"):
        joint.evaluate(joint.start(), FIXED, across)
    with pytest.raises(InputError, match="is a spatial joint; read it with SpatialJoint"):
        read_joint(ROOT / "datasets/spatial_joint.toml")


@pytest.mark.slow
def test_a_door_that_rattles_keeps_its_energy():
    """A leaf of 2 kg on one hinge without dissipation: 0.3 s, some hundred impacts on both rims."""
    joint = joint_for(**ELASTIC, thrust={**THRUST, "restitution": 1.0})
    steps, size = 600_000, 5e-7
    start = np.zeros(13)
    start[3] = 1.0
    work, out = np.zeros(1, WORK)[0], np.zeros((steps, 3))
    law = joint.planar.kernel.parameters
    _fly(start, FIXED, 2.0, np.array([0.06, 0.0, 0.0]), np.array([2e-3, 4e-3, 3e-3]), steps, size,
         work, joint.record, law, out)  # fmt: skip
    onsets = np.count_nonzero(np.diff((out[:, 1:] > 0).astype(int), axis=0) > 0, axis=0)
    assert onsets.min() > 50
    assert abs(out[-1, 0] - out[0, 0]) < 1e-8


@numba.njit
def _fly(y, fixed, mass, centre, inertia, steps, size, w, joint, law, out):
    """Integrate the leaf with Runge-Kutta's method; write energy and penetrations of the rims.

    y is the hinge's point (which is that of the leaf's axes), quaternion, velocity of the centre of
    mass and spin in the axes of the leaf, whose moments of inertia are principal.
    """
    slopes, pin, arm, spin = np.zeros((4, 13)), np.zeros(13), np.zeros(3), np.zeros(3)
    state, moment, force = np.zeros(4), np.zeros(3), np.zeros(3)
    for step in range(steps):
        for stage in range(4):
            at = y.copy()
            if stage > 0:
                at += (size if stage == 3 else 0.5 * size) * slopes[stage - 1]
            q = at[3:7]
            spatial_forces.rotate(at, centre, arm)
            spatial_forces.rotate(at, at[10:], spin)
            pin[:] = at
            # The velocity of the hinge's point from that of the centre of mass.
            pin[7:10] = at[7:10] - np.cross(spin, arm)
            pin[10:] = spin
            spatial_forces.evaluate(state, fixed, pin, w, joint, law)
            for k in range(3):
                moment[k] = w.moment_pin[k]
                force[k] = w.force_pin[k]
            moment -= np.cross(arm, force)
            # Into the axes of the leaf, by the conjugate quaternion.
            back = at.copy()
            back[4:7] = -q[1:]
            own = np.zeros(3)
            spatial_forces.rotate(back, moment, own)
            if stage == 0:
                out[step, 0] = (
                    w.elastic_energy + 0.5 * mass * (at[7:10] ** 2).sum()
                    + 0.5 * (inertia * at[10:] ** 2).sum() + mass * 9.81 * (at[2] + arm[2])
                )  # fmt: skip
                out[step, 1], out[step, 2] = w.penetration[0], w.penetration[1]
            s = slopes[stage]
            s[:3] = pin[7:10]
            p, r = q[1:], at[10:]
            s[3] = -0.5 * (p * r).sum()
            s[4:7] = 0.5 * (q[0] * r + np.cross(p, r))
            s[7:10] = force / mass
            s[9] -= 9.81
            s[10:] = (own - np.cross(r, inertia * r)) / inertia
        y += size / 6 * (slopes[0] + 2 * slopes[1] + 2 * slopes[2] + slopes[3])
