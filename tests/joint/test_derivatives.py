"""The Jacobian of a joint, its derivative along a direction, and the energy that it stores."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from cylcontact.files.spec import read_toml
from cylcontact.joint import joint_from
from cylcontact.joint.clearance import JointState
from tests.support.derivative_runners import RUNNERS
from tests.support.spec_files import changed

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = read_toml(ROOT / "datasets/joint.toml")
LAWS = ("conformal", "johnson", "enhanced", "explicit", "liu", "lankarani-nikravesh", "goldsmith")
# The units do the same to all laws.
each_law = pytest.mark.parametrize(
    ("law", "units"), [*((law, "SI") for law in LAWS), ("conformal", "mm"), ("johnson", "mm")]
)
POINTS = {"bearing.point": [3.0, -2.0], "pin.point": [-1.0, 4.0]}
# Rows and columns of one kind: forces or moments, by places, angles, velocities or spins.
ROWS = ([0, 1, 3, 4], [2, 5])
COLUMNS = ([0, 1, 3, 4], [2, 5], [6, 7, 9, 10], [8, 11])


@cache
def joint_for(law, units="SI", **more):
    return joint_from(changed(EXAMPLE, {"law": law, "units": units, **POINTS, **more}))


def motions(joint, rows, seed=11, deepest=20e-3):
    """Impact rates, and motions of both bodies in contact, on all branches of friction."""
    rng, unit = np.random.default_rng(seed), joint.in_mm
    turn = lambda angle, point: np.exp(1j * angle) * complex(*point)  # noqa: E731
    angles, spins = rng.uniform(-3, 3, (2, rows)), rng.uniform(-9, 9, (2, rows))
    away = joint.radial + 10 ** rng.uniform(-5, np.log10(deepest), rows)
    e = away * np.exp(1j * rng.uniform(0, 2 * np.pi, rows))
    u = 10 ** rng.uniform(0, 2, rows) * np.exp(1j * rng.uniform(0, 2 * np.pi, rows))
    arms = turn(angles[0], joint.point_bearing), turn(angles[1], joint.point_pin)
    place, speed = (
        rng.uniform(-5, 5, (rows, 2)) @ [1, 1j],
        rng.uniform(-50, 50, (rows, 2)) @ [1, 1j],
    )
    pin = place + arms[0] - arms[1] - e
    velocity = speed + 1j * spins[0] * arms[0] - 1j * spins[1] * arms[1] - u
    bodies = [
        np.column_stack([p.real, p.imag, a, v.real, v.imag, s])
        for p, a, v, s in (
            (place / unit, angles[0], speed / unit, spins[0]),
            (pin / unit, angles[1], velocity / unit, spins[1]),
        )
    ]
    rates = np.where(rng.random(rows) < 0.2, 0.0, 10 ** rng.uniform(0, 2, rows)) / unit
    return JointState(rates), *bodies


def forces(wrench):
    return np.column_stack(
        [wrench.force_bearing, wrench.moment_bearing, wrench.force_pin, wrench.moment_pin]
    )


def piece_of(joint, state, bearing, pin):
    """Which smooth pieces of the force a motion is in."""
    w, record, unit = joint.evaluate(state, bearing, pin), joint.block, joint.in_mm / 1e3
    floor = record["rate_floor"]
    onset = np.where(state.impact_rate > 0, state.impact_rate, w.penetration_rate)
    onset = np.maximum(onset * unit, floor)
    speed, rate = np.abs(w.tangential_velocity) * unit, w.penetration_rate * unit
    return np.column_stack(
        [w.penetration > 0, speed > record["v0"], speed > record["v1"], w.normal_force > 0,
         1e3 * w.penetration * unit > record["last_penetration"], rate > floor,
         np.abs(rate / onset) > 10]
    )  # fmt: skip


def whole(joint, state, bearing, pin):
    """The Jacobian by x, y, angle of bearing and pin, then by their rates."""
    return np.concatenate(joint.evaluate_jacobian(state, bearing, pin), axis=-1)


def moved(bearing, pin, column, step):
    """Both bodies with one of the twelve numbers changed."""
    bodies = [bearing.copy(), pin.copy()]
    body, place = divmod(column % 6, 3)
    bodies[body][:, place + 3 * (column >= 6)] += step
    return bodies


@each_law
def test_the_jacobian_is_that_of_differences(law, units):
    """By Richardson's extrapolation, to a part of the largest entry of each kind of block."""
    joint = joint_for(law, units)
    state, *bodies = motions(joint, 400)
    J, D = whole(joint, state, *bodies), np.empty((400, 6, 12))
    smooth, piece = np.ones(400, bool), piece_of(joint, state, *bodies)
    sizes = np.array([3e-7, 3e-7, 3e-8] * 2 + [3e-3, 3e-3, 3e-5] * 2)
    sizes[[0, 1, 3, 4, 6, 7, 9, 10]] /= joint.in_mm
    for column, size in enumerate(sizes):
        slopes = []
        for step in (size, size / 2):
            less, more = (moved(*bodies, column, way * step) for way in (-1, 1))
            for each in (less, more):
                smooth &= (piece_of(joint, state, *each) == piece).all(axis=1)
            change = forces(joint.evaluate(state, *more)) - forces(joint.evaluate(state, *less))
            body, place = divmod(column % 6, 3)
            exact = more[body] - less[body]  # the step that was taken
            slopes.append(change / exact[:, place + 3 * (column >= 6)][:, None])
        D[:, :, column] = (4 * slopes[1] - slopes[0]) / 3
    assert smooth.mean() > 0.99
    for rows in ROWS:
        for columns in COLUMNS:
            block = np.ix_(smooth.nonzero()[0], rows, columns)
            largest = np.abs(J[block]).max(axis=(1, 2), keepdims=True)
            error = np.abs((D - J)[block]) / np.where(largest > 0, largest, 1.0)
            assert np.median(error.max(axis=(1, 2))) < 2e-8
            assert error.max() < 3e-6


def complex_forces(joint, rate, q):
    """The wrench of complex numbers in SI and a power law, written anew."""
    r, (K, n) = joint.block, joint.kernel.parameters
    c, s = np.cos(q[[2, 8]]), np.sin(q[[2, 8]])
    points = np.array([joint.point_bearing, joint.point_pin]) * 1e-3
    arms = [np.array([c[k] * x - s[k] * y, s[k] * x + c[k] * y]) for k, (x, y) in enumerate(points)]
    e = q[:2] - q[6:8] + arms[0] - arms[1]
    across = lambda a: np.array([-a[1], a[0]])  # noqa: E731
    u = q[3:5] - q[9:11] + q[5] * across(arms[0]) - q[11] * across(arms[1])
    distance = np.sqrt(e @ e)
    n_ = e / distance
    t = np.array([n_[1], -n_[0]])
    delta, slip = distance - r["clearance"], u @ t + q[5] * r["R_bearing"]
    slip -= q[11] * (r["R_pin"] - delta)
    elastic = K * (1e3 * delta) ** n * r["length"]
    ratio = (u @ n_) / (rate if rate > 0 else np.maximum(0, u @ n_))
    v = (ratio if ratio.real > 0 else -ratio) / 10 - 1
    if v.real > 0:
        ratio = np.sign(ratio.real) * 10 * (1 + v / np.sqrt(1 + v * v))
    normal = elastic * (1 + r["chi"] * ratio)
    normal = normal if normal.real > 0 else 0.0
    speed = slip if slip.real > 0 else -slip
    part = (speed - r["v0"]) / (r["v1"] - r["v0"])
    part = 0.0 if part.real < 0 else 1.0 if part.real > 1 else part
    drag = -r["friction"] * part * np.sign(slip.real) * normal
    f = -normal * n_ + drag * t
    turn = arms[0][0] * f[1] - arms[0][1] * f[0] + r["R_bearing"] * drag
    back = -(arms[1][0] * f[1] - arms[1][1] * f[0]) - (r["R_pin"] - delta) * drag
    return np.array([*f, turn, *-f, back])


def test_the_jacobian_is_that_of_a_complex_step():
    """Of another derivation, with a step of 1e-40: no digits are lost to differences."""
    joint = joint_for("lankarani-nikravesh")
    state, *bodies = motions(joint, 300, seed=4)
    rate = joint.evaluate(state, *bodies).penetration_rate
    rows = (state.impact_rate > 0) | (rate > 2e-3)  # the floor has a test of its own below
    J, errors = whole(joint, state, *bodies), []
    order = [0, 1, 2, 6, 7, 8, 3, 4, 5, 9, 10, 11]
    for k in rows.nonzero()[0]:
        q, D = np.hstack([each[k] for each in bodies]).astype(complex), np.empty((6, 12))
        for column, place in enumerate(order):
            step = q.copy()
            step[place] += 1e-40j
            D[:, column] = complex_forces(joint, float(state.impact_rate[k]), step).imag / 1e-40
        for some, columns in ((a, b) for a in ROWS for b in COLUMNS):
            largest = np.abs(D[np.ix_(some, columns)]).max()
            if largest > 0:
                difference = np.abs((D - J[k])[np.ix_(some, columns)]).max()
                errors.append((difference / largest, largest / np.abs(D[some]).max()))
    error, share = np.array(errors).T
    assert np.median(error) < 2e-15
    # The largest errors are in blocks that are differences of far larger numbers.
    assert error[share > 1e-9].max() < 1e-9
    assert (error * share).max() < 1e-12


@pytest.mark.parametrize("law", LAWS)
def test_the_derivative_along_a_direction_is_that_of_the_jacobian_and_of_the_wrench(law):
    joint, rng = joint_for(law), np.random.default_rng(3)
    state, bearing, pin = motions(joint, 200, seed=7)
    first, second = rng.normal(size=(2, 200, 6))
    along = np.hstack([first[:, :3], second[:, :3], first[:, 3:], second[:, 3:]])
    wanted = np.einsum("nij,nj->ni", whole(joint, state, bearing, pin), along)
    change = joint.differentiate(state, bearing, pin, first, second)
    np.testing.assert_allclose(forces(change), wanted, rtol=0, atol=1e-13 * np.abs(wanted).max())
    assert (change.flag == 0).all()
    # All numbers of the wrench, by a difference along a direction that keeps to the piece.
    h = 1e-8
    less, more = (
        joint.evaluate(state, bearing + way * h * 1e-3 * first, pin + way * h * 1e-3 * second)
        for way in (-1, 1)
    )
    change = joint.differentiate(state, bearing, pin, 1e-3 * first, 1e-3 * second)
    for name in ("penetration", "penetration_rate", "normal_force", "friction_force",
                 "tangential_velocity", "dissipated_power"):  # fmt: skip
        slope, got = (getattr(more, name) - getattr(less, name)) / (2 * h), getattr(change, name)
        assert np.median(np.abs(slope - got)) < 1e-5 * np.abs(slope).max(), name


def test_kinks_take_the_piece_of_evaluate():
    # Without contact, up to the touch, all is zero.
    centred = joint_from(changed(EXAMPLE, {"law": "explicit"}))
    for place in (0.0, 4e-5, 4.9999999e-5):
        assert (whole(centred, centred.start(), np.zeros(6), [place, 0, 0, 0.1, 0, 0]) == 0).all()
    just = whole(centred, JointState(0.1), np.zeros(6), [5.00001e-5, 0, 0, 0.1, 0, 0])
    assert abs(just[3, 3]) > 1e8
    # Nothing pulls: the force is clipped, and so is its derivative.
    leaving = whole(centred, JointState(1e-3), np.zeros(6), [5.1e-5, 0, 0, -9.0, 0, 0])
    assert (leaving == 0).all()
    # Before the first accept the rates' ratio is 1 above the floor, whatever the rate.
    trial = centred.evaluate_jacobian(centred.start(), np.zeros(6), [5.1e-5, 0, 0, 0.1, 0, 0])
    assert trial.by_velocity[3, 3] == 0
    slow = centred.evaluate_jacobian(centred.start(), np.zeros(6), [5.1e-5, 0, 0, 5e-4, 0, 0])
    assert slow.by_velocity[3, 3] < 0
    number = whole(centred, centred.start(), np.zeros(6), [np.nan, 0, 0, 0, 0, 0])
    assert np.isnan(number).any()
    # Beyond the end of the law the stiffness is that of the tangent.
    johnson = joint_from(changed(EXAMPLE, {"law": "johnson"}))
    deep = np.array([[(0.05 + d) * 1e-3, 0, 0, 0, 0, 0] for d in (0.03, 0.04)])
    K = johnson.evaluate_jacobian(JointState(0.1), np.zeros(6), deep).by_position
    assert K[0, 3, 3] == K[1, 3, 3]
    assert K[0, 3, 3] == pytest.approx(-johnson.block["last_slope"] * 1e3 * 10.0, rel=1e-14)


@each_law
def test_the_energy_is_the_integral_of_the_load(law, units):
    joint = joint_for(law, units)
    length, (x, y) = joint.pair.length, np.divide(joint.point_bearing, joint.in_mm)
    pin_x, pin_y = np.divide(joint.point_pin, joint.in_mm)
    for depth in (-1e-3, 1e-7, 1e-5, 1e-3, 2e-2):
        away = (joint.radial + depth) / joint.in_mm
        pin = [x - pin_x - away, y - pin_y, 0.0, 0.0, 0.0, 0.0]
        energy = joint.elastic_energy(np.zeros(6), pin) * joint.in_mm / 1e3
        last = min(depth, joint.block["last_penetration"])
        load = lambda u: joint.kernel.load(u**4) * 4 * u**3  # noqa: E731
        wanted = quad(load, 0, max(last, 0) ** 0.25, epsabs=0, epsrel=1e-12)[0]
        more = max(depth - last, 0.0)
        wanted += more * (joint.block["last_load"] + more / 2 * joint.block["last_slope"])
        assert energy == pytest.approx(wanted * length * 1e-3, rel=2e-7, abs=1e-300)


def test_with_the_energy_the_ledger_of_a_pendulum_closes_in_contact():
    """Kinetic, potential and stored energy, and what was lost, at every step."""
    mass, inertia, arm, state = 0.5, 0.5 * 0.2**2 / 12, 0.1, JointState(0.01)
    joint = joint_from(changed(EXAMPLE, {"bearing.point": [0.0, 1e3 * arm]}))

    def wrench(y):
        return joint.evaluate(state, y[:6], np.zeros(6))

    def slope(_, y):
        w = wrench(y)
        pull = [w.force_bearing[0] / mass, w.force_bearing[1] / mass - 9.81]
        return np.array([*y[3:6], *pull, w.moment_bearing / inertia, w.dissipated_power])

    start = [np.sin(1.0) * arm, -np.cos(1.0) * arm, 1.0, 0.0, 0.0, 0.0, 0.0]
    start[0] += np.sin(1.0) * 5.05e-5
    start[1] -= np.cos(1.0) * 5.05e-5
    run = solve_ivp(slope, (0, 2e-3), start, method="LSODA", rtol=1e-10, atol=1e-14)
    y = run.y.T
    moving = 0.5 * mass * (y[:, 3] ** 2 + y[:, 4] ** 2) + 0.5 * inertia * y[:, 5] ** 2
    moving += mass * 9.81 * y[:, 1] + y[:, 6]
    stored = joint.elastic_energy(y[:, :6], np.zeros(6))
    assert (stored > 0).mean() > 0.8
    without, ledger = np.ptp(moving), np.ptp(moving + stored)
    assert without > 1e-5
    assert ledger < 1e-4 * without


# The stiffness of each law in each language is tested in tests/export.
@pytest.mark.parametrize(
    ("language", "law"),
    [("c", "conformal"), ("c", "explicit"), *((language, "johnson") for language in RUNNERS)],
)
def test_exports_differentiate_as_the_library(language, law, tmp_path):
    """Jacobian, a direction and energy of motions in contact, free, and none."""
    joint = joint_for(law, "mm" if law == "johnson" else "SI")
    state, bearing, pin = motions(joint, 40, seed=1)
    pin[:4, :2] = bearing[:4, :2]
    pin[4, 3] = np.nan
    first, second = np.random.default_rng(8).normal(size=(2, 40, 6))
    rows = np.column_stack([state.impact_rate, bearing, pin, first, second])
    wanted = np.column_stack([
        whole(joint, state, bearing, pin)[:, :, :6].reshape(40, 36),
        whole(joint, state, bearing, pin)[:, :, 6:].reshape(40, 36),
        *joint.differentiate(state, bearing, pin, first, second)[:-1],
        joint.elastic_energy(bearing, pin),
    ])  # fmt: skip
    answers = RUNNERS[language](joint, rows, tmp_path)
    # A file has a coarser curve of conformal contact.
    allowed = 1e-6 if law == "conformal" else 1e-11
    np.testing.assert_array_equal(np.isnan(answers), np.isnan(wanted))
    peak = np.nanmax(np.abs(wanted), axis=0) + 1e-300
    np.testing.assert_allclose(answers / peak, wanted / peak, rtol=0, atol=allowed)
