"""The joint in space: its potential, its limit in the plane, its impacts, mistakes in files."""

import itertools
from pathlib import Path

import numba
import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from cylcontact import InputError
from cylcontact.files.spec import read_toml
from cylcontact.joint import spatial_forces
from cylcontact.joint.contact import LEFT_HOLE, NOT_A_NUMBER
from cylcontact.joint.spatial_forces import (
    OUTSIDE,
    RIM_MISSING,
    SLID_OUT,
    STATE,
    UNEVEN_HOUSING,
    UNLIKE,
    WORK,
    WRENCH,
)
from cylcontact.mechanism import (
    JointState,
    SpatialJoint,
    SpatialState,
    joint_from,
    read_joint,
)
from tests.support.samples import sampled
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
    "power": {"law": "lankarani-nikravesh"},
}
each_kind = pytest.mark.parametrize("kind", KINDS)
ELASTIC = {"friction.coefficient": 0.0, "dissipation.restitution": 1.0}


def elastic_joint(kind):
    """Return a joint of a kind without friction and damping."""
    faces = {"thrust.restitution": 1.0} if "thrust" in KINDS[kind] else {}
    return joint_for(**{**KINDS[kind], **ELASTIC, **faces})


# --- the potential ---


def energy_of(joint, pin):
    """Return the energy in N mm by dense quadrature, of formulas written anew."""
    spec, pair = joint.spec, joint.planar.pair
    a = Rotation.from_quat(pin[3:7], scalar_first=True).apply([0.0, 0.0, 1.0])
    c, psi = 1e3 * pin[:3], -a[:2] / a[2]
    half, (R_i, R_j) = spec.length / 2, map(float, pair.radii("it"))
    reach = 1.005 * half if spec.edge.kind == "flush" else np.inf
    low, high = spec.pin.ends or (-reach, reach)
    low, high = max(-half, c[2] + low * a[2]), min(half, c[2] + high * a[2])
    ends = spec.pin.ends or (-half, half)

    def penetration(z):
        e = -c[:2] + (z - c[2])[..., None] * psi
        r = np.linalg.norm(e, axis=-1)
        q = np.sqrt(1 + (e @ psi / r) ** 2)
        off = (z - c[2] - np.mean(ends)) / (np.ptp(ends) / 2)
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
        delta, e = float(penetration(np.array(z))), -c[:2] + (z - c[2]) * psi
        slope = max(sign * (psi @ e) / np.linalg.norm(e), 0.0)
        if delta > 0:
            chi = slope**2 / (slope**2 + (delta / (b * R_i)) ** 2)
            total += 0.4 * c_r * pair.E_star * np.sqrt(2 * R_i * R_j / pair.dR) * delta**2.5 * chi
    if spec.thrust:
        phi = np.linspace(0, 2 * np.pi, 20001)[:-1]
        lean, T = np.linalg.norm(a[:2]), spec.thrust
        for sign in (1, -1):
            ring = c[2] + sign * a[2] * (half + T.play / 2) + T.radius * lean * np.cos(phi)
            total += T.stiffness / 2 * np.mean(np.maximum(half - sign * ring, 0.0) ** 2)
    return total


@each_kind
def test_the_energy_is_that_of_a_dense_quadrature(kind):
    joint = joint_for(**KINDS[kind])
    pins = motions(joint, 40, seed=3)[1]
    energies = 1e3 * joint.evaluate(joint.start(), FIXED, pins).elastic_energy
    wanted = np.array([energy_of(joint, pin) for pin in pins])
    assert (wanted > 1e-6).sum() >= 6
    np.testing.assert_allclose(energies, wanted, rtol=1e-6, atol=1e-9 * wanted.max())


@each_kind
@pytest.mark.parametrize(
    ("rims", "loops"), [(1, 30), *(pytest.param(n, 100, marks=pytest.mark.slow) for n in (1, 2))]
)
def test_power_is_the_slope_of_the_energy_and_no_work_is_left_around_a_loop(kind, rims, loops):
    """Loops of all six coordinates, so small that the same rims and faces stay in contact.

    No end of the pin goes into the hole or out of it.
    """
    joint, N = elastic_joint(kind), 128
    pins = motions(joint, 4000, seed=8)[1]
    w = joint.evaluate(joint.start(), FIXED, pins)
    reserve = np.abs(w.penetration).min(axis=1)
    chosen = (reserve > 3e-7) & (w.penetration[:, :2].max(axis=1) < 5e-6)
    chosen &= ((w.penetration[:, :2] > 0).sum(axis=1) == rims) & (w.touched < 0.3 * w.touched.max())
    axial = 0.1 if joint.spec.thrust else 30
    ends = 1e3 * pins[:, 2:3] + [joint.record["pin_low"], joint.record["pin_high"]]
    beyond = np.abs(np.abs(ends) - joint.spec.length / 2).min(axis=1)
    chosen &= beyond > 1e3 * axial * reserve + 1e-3
    assert chosen.sum() >= 10
    pins = np.repeat(pins[chosen][:loops], N, axis=0)
    size = np.array([0.1, 0.1, axial, 6, 6, 100])
    size = np.repeat(reserve[chosen][:loops, None] * size, N, axis=0)
    rng, t = np.random.default_rng(1), np.tile(2 * np.pi * np.arange(N) / N, len(pins) // N)
    phase = t[:, None] + np.repeat(rng.uniform(0, 2 * np.pi, (len(pins) // N, 6)), N, axis=0)
    q, rate = size * np.cos(phase), -size * np.sin(phase)
    # Turned about x, then about the turned y, then about the turned z.
    first = Rotation.from_rotvec(q[:, 3:4] * [1, 0, 0])
    second = first * Rotation.from_rotvec(q[:, 4:5] * [0, 1, 0])
    spin = rate[:, 3:4] * [1, 0, 0] + first.apply(rate[:, 4:5] * [0, 1, 0])
    spin += second.apply(rate[:, 5:6] * [0, 0, 1])
    turn = second * Rotation.from_rotvec(q[:, 5:6] * [0, 0, 1])
    turn = (turn * Rotation.from_quat(pins[:, 3:7], scalar_first=True)).as_quat(scalar_first=True)
    moved = np.hstack([pins[:, :3] + q[:, :3], turn, rate[:, :3], spin])
    w = joint.evaluate(joint.start(), FIXED, moved)
    power = (w.force_pin * rate[:, :3]).sum(axis=1) + (w.moment_pin * spin).sum(axis=1)
    power = power.reshape(-1, N)
    left = np.abs(power.sum(axis=1)) / np.abs(power).sum(axis=1)
    assert left.max() <= 1e-10
    # Derivatives of periodic series. Of a half without contact the deepest place may jump.
    power = -power
    pairs = [(w.elastic_energy, power)]
    pairs += zip(w.penetration.T, w.penetration_rate.T, strict=True)
    for series, wanted in pairs:
        smooth = (series.reshape(-1, N) > 0).all(axis=1) | (joint.spec.pin.crown == 0.0)
        gain = np.fft.rfft(series.reshape(-1, N)[smooth]) * 1j * np.fft.rfftfreq(N, 1 / N)
        slope, rates = np.fft.irfft(gain), wanted.reshape(-1, N)[smooth]
        peak = np.abs(rates).max(axis=1, keepdims=True) + 1e-300
        # Where the deepest place of a crowned pin reaches the rim, the second derivative jumps.
        crowned = joint.spec.pin.crown > 0 and wanted is not power
        error = np.abs(slope - rates) / peak
        assert error.size == 0 or error.max() <= (1e-4 if crowned else 1e-6)
        assert error.size == 0 or np.median(error) <= 5e-7


# --- what holds in every motion ---


def test_without_tilt_it_is_the_planar_joint():
    """Damping and friction included, to 1e-12 of the peak of each number."""
    points = {"bearing.point": [2.0, 3.0], "pin.point": [-4.0, 1.0]}
    weak = {"bearing.yield_stress": 30.0, "pin.yield_stress": 30.0}
    joint = joint_for(**{key: [*point, 0.0] for key, point in points.items()}, **weak)
    plane = dict.fromkeys(("kind", "edge", "bearing.axis", "pin.axis"), DROP)
    planar = joint_from(changed(EXAMPLE, {**plane, **points, **weak}))
    rng, n = np.random.default_rng(2), 4000
    towards, rate = rng.uniform(0, 6, n), rng.uniform(0.01, 1, n)
    away = 5e-5 * (1 + 10 ** rng.uniform(-2.5, -0.5, n))
    away = away * [np.cos(towards), np.sin(towards), 0 * away]
    space, flat = [], []
    for place, point in zip((0.0, away.T), points.values(), strict=True):
        velocity, (angle, spin) = rng.normal(0, 0.1, (2, n)), rng.normal(0, 10, (2, n))
        turn = Rotation.from_rotvec(angle[:, None] * [0, 0, 1])
        position = place - turn.apply([1e-3 * x for x in (*point, 0)])
        numbers = np.array([*velocity, 0 * spin, 0 * spin, 0 * spin, spin]).T
        space.append(np.hstack([position, turn.as_quat(scalar_first=True), numbers]))
        flat.append(np.column_stack([position[:, :2], angle, *velocity, spin]))
    wanted = planar.evaluate(JointState(rate), *flat)
    w = joint.evaluate(SpatialState(np.column_stack([rate, rate, 0 * rate, 0 * rate])), *space)
    assert np.abs(wanted.force_pin).max() > 1e4
    parts = {"force": slice(2), "moment": 2, "penetration": 0}
    for name in set(w._fields) & set(wanted._fields) - {"flag"}:
        got, plane = getattr(w, name), getattr(wanted, name)
        if got.ndim > 1:
            got = got[:, parts[name.split("_")[0]]]
        np.testing.assert_allclose(got, plane, rtol=0, atol=1e-12 * np.abs(plane).max())
    above = wanted.flag & 1  # first yield
    assert 0.01 < above.mean() < 0.99
    np.testing.assert_array_equal(w.flag & 1, above)
    np.testing.assert_allclose(w.force_pin[:, 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(w.moment_pin[:, :2], 0.0, atol=1e-12 * np.abs(w.moment_pin).max())
    assert (w.touched == 0.02).all()


@each_kind
def test_forces_balance_and_only_the_motion_against_each_other_matters(kind):
    """Both bodies as seen from a frame that is turned and moves and spins at will."""
    joint = joint_for(**KINDS[kind])
    rates, pins = motions(joint, 1500, seed=7)
    origin, turn = np.array([3e-3, -2e-3, 1e-3]), Rotation.from_rotvec([0.4, -1.1, 0.7])
    drift, spin = np.array([0.5, 0.1, -0.2]), np.array([3.0, -5.0, 2.0])

    def seen(body):
        rotation = turn * Rotation.from_quat(body[:, 3:7], scalar_first=True)
        from_origin = turn.apply(body[:, :3])
        velocity = turn.apply(body[:, 7:10]) + drift + np.cross(spin, from_origin)
        quaternion = 3.0 * rotation.as_quat(scalar_first=True)
        angular = turn.apply(body[:, 10:]) + spin
        return np.hstack([from_origin + origin, quaternion, velocity, angular])

    fixed = np.tile(FIXED, (len(pins), 1))
    bearing, pin = seen(fixed), seen(pins)
    plain = joint.evaluate(SpatialState(rates), fixed, pins)
    w = joint.evaluate(SpatialState(rates), bearing, pin)
    # The turned directions are rounded to 1e-16, which is 1e-13 of a penetration of 10 µm. Without
    # tilt a contact is integrated from either end, and damping bends inside.
    inside = (np.abs(plain.penetration) > 1e-7).all(axis=1)
    inside &= np.abs(np.diff(plain.penetration[:, :2]).ravel()) > 1e-9
    vectors = ("force_pin", "moment_pin", "moment_bearing")
    for name, tolerance in {**dict.fromkeys(vectors, 1e-12), "penetration_rate": 2e-12}.items():
        wanted = getattr(plain, name)[inside]
        wanted = turn.apply(wanted) if name in vectors else wanted
        peak = np.abs(wanted).max()
        np.testing.assert_allclose(getattr(w, name)[inside], wanted, rtol=0, atol=tolerance * peak)
    np.testing.assert_array_equal(w.force_pin, -w.force_bearing)
    about = w.moment_pin + w.moment_bearing + np.cross(pin[:, :3] - bearing[:, :3], w.force_pin)
    np.testing.assert_allclose(about, 0.0, atol=2e-15 * np.abs(w.moment_pin).max())
    assert (w.dissipated_power >= 0).all()
    assert w.dissipated_power.max() > 1.0
    # All power that goes in is lost, or stored as without damping and friction.
    power, stored = (
        (x.force_pin * pin[:, 7:10]).sum(1) + (x.moment_pin * pin[:, 10:]).sum(1)
        + (x.force_bearing * bearing[:, 7:10]).sum(1) + (x.moment_bearing * bearing[:, 10:]).sum(1)
        for x in (w, elastic_joint(kind).evaluate(joint.start(), bearing, pin))
    )  # fmt: skip
    balance = power + w.dissipated_power - stored
    np.testing.assert_allclose(balance, 0.0, atol=1e-12 * np.abs(power).max())


def test_an_axis_may_point_either_way_and_lie_anywhere():
    """Both axes along x, the pin's turned end to end with its faces and ends."""
    plain = joint_for(**KINDS["ends"])
    rates, pins = motions(plain, 500, seed=9)
    tilted = np.linalg.norm(pins[:, 4:6], axis=1) > 1e-7
    rates, bodies = rates[tilted], [np.tile(FIXED, (tilted.sum(), 1)), pins[tilted]]
    wanted = run_library(plain, rates, *bodies)
    turned = {"bearing.axis": [1, 0, 0], "pin.axis": [-2, 0, 0], "pin.ends": [-9.0, 9.5]}
    for numbers in bodies:
        turn = Rotation.from_quat(numbers[:, 3:7], scalar_first=True)
        turn = turn * Rotation.from_rotvec([0, -np.pi / 2, 0])
        numbers[:, 3:7] = turn.as_quat(scalar_first=True)
    answers = run_library(joint_for(**{**KINDS["ends"], **turned}), rates, *bodies)
    peak = np.abs(wanted).max(axis=0) + 1e-12
    np.testing.assert_allclose(answers / peak, wanted / peak, rtol=0, atol=1e-9)


# --- impacts ---

IMPACTS = {**KINDS["free rims"], "friction.coefficient": 0.0}


def in_plane(x, turn, v=0.0, spin=0.0):
    """Return a pin that moves along x and turns about y."""
    return body([x, 0, 0], Rotation.from_rotvec([0, turn, 0]), [v, 0, 0], [0, spin, 0])


def onset(joint, pose, low, high):
    """Return where rim A begins to touch."""

    def penetration(q):
        return joint.evaluate(joint.start(), FIXED, pose(q)).penetration[0]

    return brentq(penetration, low, high, xtol=1e-15)


def impact(joint, along, inertia, q, v, state=None, load=0.0, step=2e-7):
    """Step by Runge and Kutta until rim A, which touches at once, is free again.

    The coordinates move the pin `along` (x, angle). Returns the rates of rim A at first and at
    last, and the velocities.
    """
    along, state = np.array(along), state or joint.start()

    def slope(y):
        w = joint.evaluate(state, FIXED, in_plane(*(y @ along).ravel()))
        pull = along @ [w.force_pin[0], w.moment_pin[1]]
        return np.array([y[1], (pull + load) / inertia])

    y, rates = np.array([q, v], dtype=float), []
    for _ in range(10_000):
        a = slope(y)
        b = slope(y + 0.5 * step * a)
        c = slope(y + 0.5 * step * b)
        y = y + step / 6 * (a + 2 * b + 2 * c + slope(y + step * c))
        pin = in_plane(*(y @ along).ravel())
        state = joint.accept(state, FIXED, pin)
        w = joint.evaluate(state, FIXED, pin)
        if rates and w.penetration[0] <= 0:
            break
        rates.append(w.penetration_rate[0])
    return rates[0], rates[-1], y[1]


ARMS = [(0.03, "none"), (0.1, "none"), (0.015, "overhang")]


@pytest.mark.parametrize(("arm", "edge"), sampled(ARMS, ARMS[::2]))
def test_a_rim_that_a_hinged_pin_strikes_has_the_restitution_of_the_file(arm, edge):
    """The pin turns about a point on its axis, below rim B."""
    joint = joint_for(**{**IMPACTS, "edge.kind": edge})
    span = arm + 0.01
    angle = onset(joint, lambda q: in_plane(arm * q, q), 2e-5 / span, 1e-4 / span)
    came, left, _ = impact(joint, [[arm, 1]], 0.5 * span**2, [angle], [0.1 / span])
    assert -left / came == pytest.approx(0.8, abs=5e-3)


@pytest.mark.parametrize("tilt", sampled([0.0, 5e-4, 1e-3, 3e-3], few=[0.0, 1e-3]))
def test_a_free_pin_that_flies_tilted_has_nearly_the_restitution_of_the_file(tilt):
    """Along the impulse J until the rim is free again: e = -J.v_after/J.v_before."""
    joint, inertia, before = joint_for(**IMPACTS), np.array([0.5, 5e-5]), np.array([0.2, 0.0])
    x = onset(joint, lambda x: in_plane(x, tilt), 0.0, 1e-4)
    after = impact(joint, np.eye(2), inertia, [x, tilt], before)[2]
    impulse = inertia * (after - before)
    assert -(impulse @ after) / (impulse @ before) == pytest.approx(0.8, abs=0.015)


@pytest.mark.parametrize(
    ("shift", "force"), sampled([(5.08e-5, 5), (5.3e-5, 70)], few=[(5.3e-5, 70)])
)
def test_a_pin_at_rest_on_one_rim_keeps_the_restitution_of_an_impact_at_the_other(shift, force):
    """Rim B is pressed by a force; the pin turns about it until rim A strikes."""
    joint = joint_for(**IMPACTS)
    state = SpatialState(np.array([0.0, joint.planar.rate_floor, 0.0, 0.0]))
    angle = onset(joint, lambda q: in_plane(0.01 * q - shift, q), 4e-3, 6e-3)
    start = [0.01 * angle - shift, angle]
    w = joint.evaluate(state, FIXED, in_plane(*start))
    assert w.force_pin[0] == pytest.approx(force, rel=0.1)
    load = -np.array([w.force_pin[0], w.moment_pin[1]])
    inertia = np.array([0.5, 5e-5])
    came, left, _ = impact(joint, np.eye(2), inertia, start, [0.1, 10.0], state, load)
    assert -left / came == pytest.approx(0.8, abs=0.01)


@pytest.mark.slow
def test_a_door_that_rattles_keeps_its_energy():
    """A leaf of 2 kg on one hinge without dissipation: 0.3 s, some hundred impacts on both rims."""
    joint = joint_for(**ELASTIC, thrust={**THRUST, "restitution": 1.0})
    out = np.zeros((600_000, 3))
    records = (np.zeros(1, kind)[0] for kind in (STATE, WRENCH, WORK))
    fly(FIXED.copy(), FIXED, *records, joint.record, joint.planar.kernel.parameters, out)
    onsets = np.count_nonzero(np.diff((out[:, 1:] > 0).astype(int), axis=0) > 0, axis=0)
    assert onsets.min() > 50
    assert abs(out[-1, 0] - out[0, 0]) < 1e-8


@numba.njit
def fly(pin, fixed, state, wrench, work, joint, law, out):
    """Integrate the leaf in its plane by Runge and Kutta; write energy and penetrations of rims.

    y has x and z of the centre of mass, the angle about y, and their rates.
    """
    mass, inertia, arm, size, slopes = 2.0, 4e-3, 0.06, 5e-7, np.zeros((4, 6))
    y = np.array([arm, 0.0, 0.0, 0.0, 0.0, 0.0])
    for step in range(len(out)):
        for stage in range(4):
            at = y + size * (0.0, 0.5, 0.5, 1.0)[stage] * slopes[stage - 1]
            across, down = arm * np.cos(at[2]), arm * np.sin(at[2])
            pin[0], pin[2] = at[0] - across, at[1] + down
            pin[3], pin[5] = np.cos(at[2] / 2), np.sin(at[2] / 2)
            pin[7], pin[9], pin[11] = at[3] + at[5] * down, at[4] + at[5] * across, at[5]
            spatial_forces.evaluate(state, fixed, pin, wrench, work, joint, law)
            force_x, force_z = wrench.force_pin[0], wrench.force_pin[2]
            moment = wrench.moment_pin[1] + down * force_x + across * force_z
            slopes[stage, :3] = at[3:]
            slopes[stage, 3:] = force_x / mass, force_z / mass - 9.81, moment / inertia
            if stage == 0:
                motion = 0.5 * mass * (at[3] ** 2 + at[4] ** 2) + 0.5 * inertia * at[5] ** 2
                out[step, 0] = wrench.elastic_energy + motion + mass * 9.81 * at[1]
                out[step, 1:] = wrench.penetration[0], wrench.penetration[1]
        y += size / 6 * (slopes[0] + 2 * slopes[1] + 2 * slopes[2] + slopes[3])


# --- how it is called, and mistakes ---


def test_accept_keeps_a_rate_for_each_rim_and_each_face():
    joint = joint_for(thrust=THRUST)
    tilted = Rotation.from_rotvec([0, 5e-3, 0])
    pressed = body([1e-5, 0, 1.2e-4], tilted, [0.1, 0, 0.3], [0, 0, 0])
    state = joint.accept(joint.start(), FIXED, pressed)
    w = joint.evaluate(state, FIXED, pressed)
    assert (w.penetration[[0, 3]] > 0).all()
    first = np.maximum(w.penetration_rate, joint.planar.rate_floor) * (w.penetration > 0)
    np.testing.assert_allclose(state.impact_rate, first, rtol=1e-12)
    slow = joint.accept(joint.start(), FIXED, pressed * np.repeat([1, -1], [7, 6])).impact_rate
    np.testing.assert_array_equal(slow[[0, 3]], joint.planar.rate_floor)
    pressed[7:10] *= 5
    np.testing.assert_array_equal(joint.accept(state, FIXED, pressed).impact_rate, first)
    np.testing.assert_array_equal(joint.accept(state, FIXED, FIXED).impact_rate, 0.0)


IN_HOUSING = {"law": "conformal", "housing": {"R_o": 20.0}, "edge": {"c": 0.1, "b": 0.5}}
ENDS = {"edge": {"c": 0.1, "b": 0.5}, "pin.ends": [-9, 9]}
FLUSH, SHIFTED = {"edge.kind": "flush"}, 5.1e-5
# What a file says, where the pin is, by how much it leans, and the flag besides that of the law.
FLAGS = {
    "no rims": ({"edge.kind": "none"}, 0, 5.05e-3, RIM_MISSING),
    "tilt": ({"length": 15.0}, 0, 0.11, OUTSIDE),
    "out of the hole": ({}, 0, 0.11, OUTSIDE + LEFT_HOLE),
    "yield": ({"bearing.yield_stress": 100.0, "pin.yield_stress": 100.0}, 0, 5.05e-3, 1),
    "unlike": ({"bearing.E": 3.6, **FLUSH}, 0, 5.05e-3, UNLIKE),
    "housing": (IN_HOUSING, 0, 5.05e-3, UNEVEN_HOUSING),
    "housing without tilt": (IN_HOUSING, [SHIFTED, 0, 0], 0, 0),
    "own rims": ({"bearing.E": 3.6, "edge": {"c": 0.1, "b": 0.5}}, 0, 5.05e-3, 0),
    "a face, 49.9 mm deep": ({"thrust": THRUST}, [0, 0, 0.05], 0, LEFT_HOLE),
    "far out": (FLUSH, [0, 0, 0.05], 0, SLID_OUT),
    "slid out": (FLUSH, [SHIFTED, 0, -2e-3], 0, SLID_OUT),
    "slid a little": (FLUSH, [SHIFTED, 0, 1e-4], 0, 0),
    "without an end": ({"edge.kind": "overhang"}, [SHIFTED, 0, 0.05], 0, 0),
    "ends inside": (ENDS, [SHIFTED, 0, 1e-3], 0, 0),
    "ends slid out": (ENDS, [SHIFTED, 0, 1.3e-3], 0, SLID_OUT),
    "no place": ({}, [np.nan, 0, 0], 0, NOT_A_NUMBER),
    "no place along": ({}, [SHIFTED, 0, np.inf], 0, NOT_A_NUMBER),
}


@pytest.mark.parametrize(("changes", "place", "tilt", "flag"), FLAGS.values(), ids=FLAGS)
def test_flags_tell_what_the_joint_does_not_know(changes, place, tilt, flag):
    joint = joint_for(**changes)
    pin = body(place or [0, 0, 0], Rotation.from_rotvec([tilt, 0, 0]))
    found = joint.evaluate(joint.start(), FIXED, pin).flag & ~2
    known = ~1 if place else ~0  # whether it yields there, the first test of yield says
    assert found & known == flag


@pytest.mark.parametrize("z", [0.04, 0.06, 1.0, 5.0, 19.9, 20.2, 50.0])
@pytest.mark.parametrize("crown", [0.0, 0.004])
def test_a_flush_pin_slides_out_of_its_hole(z, crown):
    """It loses the length that it says, and its axial force is the slope of its energy."""
    joint = joint_for(**{"edge.kind": "flush", "pin.crown": crown, **ELASTIC})
    pin = body([6e-5, 0, 1e-3 * z], Rotation.from_rotvec([0, 4e-4, 0]))
    w = joint.evaluate(joint.start(), FIXED, pin)
    shared = max(min(20.0, 20.05 - z), 0.0)
    assert 1e3 * w.touched == pytest.approx(shared, abs=1e-5)
    assert (w.flag & SLID_OUT > 0) == (shared < 19.8)
    moved = [body([6e-5, 0, 1e-3 * z + h], Rotation.from_rotvec([0, 4e-4, 0]))
             for h in (-1e-8, 1e-8)]  # fmt: skip
    less, more = joint.evaluate(joint.start(), FIXED, moved).elastic_energy
    assert w.force_pin[2] == pytest.approx((less - more) / 2e-8, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("crown", [0.0, 0.02])
@pytest.mark.parametrize("ends", [(-15.0, 15.0), (-8.0, 14.0), (-2.0, 15.0)])
def test_a_pin_described_from_its_other_end_has_the_same_wrench(ends, crown):
    """To the bit, of 300 poses."""
    one, other = (
        joint_for(**{"edge.kind": "none", "pin.crown": crown, "pin.axis": [0, 0, way],
                     "pin.ends": sorted(way * end for end in ends)})
        for way in (1, -1)
    )  # fmt: skip
    rates, pins = motions(one, 300, seed=6)
    wanted = run_library(one, rates, np.tile(FIXED, (300, 1)), pins)
    assert (wanted[:, 12] > 0).sum() > 50
    np.testing.assert_array_equal(run_library(other, rates, np.tile(FIXED, (300, 1)), pins), wanted)


@pytest.mark.parametrize("crown", [0.0, 0.004])
def test_forces_are_the_slope_of_the_energy_where_the_law_ends_inside_the_wall(crown):
    free = {"edge.kind": "none", "pin.crown": crown, "pin.ends": [-15.0, 15.0]}
    joint = joint_for(law="johnson", **free, **ELASTIC)
    last, rng, worst = float(joint.record["last_penetration"]), np.random.default_rng(1), []
    while len(worst) < 60:
        depth, lean, towards = last * rng.uniform(0.6, 1.8), last * rng.uniform(0.3, 2.0), 2.1
        away = 1e-3 * (joint.planar.radial + depth) * np.exp(1j * towards)
        turn = Rotation.from_rotvec([*rng.normal(size=2) * lean / joint.spec.length, 0])
        pin = body([away.real, away.imag, 0], turn)
        w = joint.evaluate(joint.start(), FIXED, pin)
        if not w.penetration[:2].min() < 1e-3 * last < w.penetration[:2].max():
            continue
        steps = 1e-9 * np.eye(3, 13)
        less, more = (joint.evaluate(joint.start(), FIXED, pin + s * steps) for s in (-1, 1))
        slope = (less.elastic_energy - more.elastic_energy) / 2e-9
        worst.append(np.abs(w.force_pin - slope).max() / np.abs(w.force_pin).max())
    assert np.median(worst) < 3e-6
    assert max(worst) < 1e-4


MISTAKES = {
    "crown": ({"pin.crown": 20.0}, "pin.crown = 20.0: is more than the length of the bush; keep"),
    "end": ({"pin.ends": [-9, 9]}, "edge.kind = 'overhang': is not known for an end of the pin in"),
    "ends": ({"pin.ends": [9, -9]}, "pin.ends = (9.0, -9.0): leave no pin; give the lower one fi"),
    "axis": ({"pin.axis": [0, 0, 0]}, "pin.axis = (0.0, 0.0, 0.0): has no direction; give one"),
    "face": (
        {"thrust": {**THRUST, "stiffness": 1e8}},
        "thrust.stiffness = 100000000.0: is above that of a rigid collar; keep it below 3.18e+06",
    ),
    "ring": ({"thrust": {**THRUST, "radius": 9.0}}, "thrust.radius = 9.0: is inside the hole"),
    "half an edge": ({"edge": {"c": 0.1}}, "edge: needs a kind, or both c and b; write kind = "),
    "plane": ({"kind": DROP}, 'kind: is required; add "spatial"'),
}


@pytest.mark.parametrize(("changes", "message"), MISTAKES.values(), ids=MISTAKES)
def test_mistakes_in_a_file_take_one_line(changes, message):
    with pytest.raises(InputError) as caught:
        SpatialJoint.from_data(changed(EXAMPLE, changes), "mine.toml")
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_a_motion_that_is_none_and_a_file_for_the_other_joint_are_refused():
    joint, across = joint_for(), body(rotation=Rotation.from_rotvec([np.pi / 2, 0, 0]))
    for pin, message in (
        (np.zeros(6), "must be thirteen numbers; give position, quaternion w x"),
        (np.zeros(13), "has a quaternion of zeros"),
        (across, "has its axis near a right angle to that of the hole"),
    ):
        with pytest.raises(InputError, match=message):
            joint.evaluate(joint.start(), FIXED, pin)
    with pytest.raises(InputError, match="is a spatial joint; read it with SpatialJoint"):
        read_joint(ROOT / "datasets/spatial_joint.toml")
