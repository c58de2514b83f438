"""Any planar mechanism in Cartesian coordinates, with multipliers for its ideal joints (Eq 10).

The coordinates of a body are (x, y, θ) of its centre of mass; the ground is body −1, at rest at the
origin. The constraints Φ of a joint at a point a of body i and a point b of body j are

- of a revolute: r_i + A_i·a − r_j − A_j·b = 0;
- of a prismatic: the distance of b from the line through a in a direction (an angle in body i) is
  0, and θ_j − θ_i is constant;
- of a driver: θ_j − θ_i is a function of time.

With a diagonal mass matrix the accelerations follow from the multipliers,

    (Φ_q·M⁻¹·Φ_qᵀ)·λ = Φ_q·M⁻¹·g − γ*,    q̈ = M⁻¹·(g − Φ_qᵀ·λ),

and Baumgarte's stabilisation replaces γ of Φ_q·q̈ = γ by γ* = γ − 2α·dΦ/dt − β²·Φ. The matrix on the
left is symmetric and positive definite unless constraints are redundant, and is factored as L·D·Lᵀ.
A constraint concerns two bodies at most, and only their columns of Φ_q enter the products.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from cylcontact.joint import contact
from cylcontact.mechanism.model import Joint, Mechanism
from cylcontact.support.arrays import FloatArray, as_floats, require
from cylcontact.support.errors import InputError
from cylcontact.support.numba_cache import called, compiled, copy_to, inlined

REVOLUTE, PRISMATIC, DRIVER = 0, 1, 2
# The kind of a joint, and how many constraints it makes.
_KINDS = {"revolute": (REVOLUTE, 2), "prismatic": (PRISMATIC, 2), "driver": (DRIVER, 1)}

# The direction of a slide as its cosine and sine; the angle between two bodies at the start, and of
# a driver the speed and the time in which it is reached.
CONSTRAINT = np.dtype(
    [
        *((name, np.int64) for name in ("kind", "row", "rows", "i", "j")),
        *((name, np.float64) for name in ("x_i", "y_i", "x_j", "y_j")),
        *((name, np.float64) for name in ("along_x", "along_y", "angle", "speed", "ramp")),
    ]
)
# Springs with dampers between two points, or, turning, between two bodies. A driving torque is a
# turning one without stiffness.
SPRING = np.dtype(
    [
        *((name, np.int64) for name in ("turning", "i", "j")),
        *((name, np.float64) for name in ("x_i", "y_i", "x_j", "y_j")),
        *((name, np.float64) for name in ("stiffness", "damping", "rest", "torque")),
    ]
)
LOAD = np.dtype(
    [("body", np.int64), *((name, np.float64) for name in ("x", "y", "f_x", "f_y", "moment"))]
)


class Linkage(NamedTuple):
    """A mechanism as compiled functions take it.

    The rows of `inertia` are masses with moments of inertia, their reciprocals, and weights;
    `settings` are Baumgarte's α and β. In `work` functions keep what they write.
    They are few, as compiled functions take a tuple apart at every call.
    """

    inertia: FloatArray
    constraints: Any
    springs: Any
    loads: Any
    settings: FloatArray
    work: FloatArray


def linkage_of(mechanism: Mechanism) -> Linkage:
    """Return a mechanism with its ideal joints."""
    bodies = mechanism.bodies
    mass = np.array([[b.mass, b.mass, b.inertia] for b in bodies]).ravel()
    weight = (mass.reshape(-1, 3) * [*mechanism.gravity, 0.0]).ravel()
    table = constraint_table([j for j in mechanism.joints if j.clearance is None and not j.torque])
    springs = [
        (s.turning, s.i, s.j, *s.point_i, *s.point_j, s.stiffness, s.damping, s.rest, 0.0)
        for s in mechanism.springs
    ]
    drives = [(1, j.i, j.j, *7 * [0.0], j.torque) for j in mechanism.joints if j.torque]
    return Linkage(
        np.array([mass, 1 / mass, weight]),
        table,
        np.array(springs + drives, SPRING),
        np.array([(a.body, *a.point, *a.force, a.moment) for a in mechanism.loads], LOAD),
        np.array([mechanism.integration.alpha, mechanism.integration.beta]),
        np.zeros(work_size(len(bodies), table)),
    )


def work_size(bodies: int, table: Any) -> int:
    """Return the size of the array of `room`."""
    rows = int(table["rows"].sum())
    return 5 * bodies + 3 * rows + 2 * rows * 3 * bodies + rows * rows


class Room(NamedTuple):
    """Arrays to work in; those of `room` are parts of one.

    Cosine and sine of the angle of every body, forces, Φ, dΦ/dt, a right-hand side, Φ_q, which must
    be zero at first or that of an earlier call, M⁻¹·Φ_qᵀ transposed, the matrix of the multipliers.
    """

    turns: FloatArray
    force: FloatArray
    value: FloatArray
    rate: FloatArray
    right: FloatArray
    jacobian: FloatArray
    over_mass: FloatArray
    matrix: FloatArray


@inlined
def room(work: FloatArray, size: int, constraints: Any) -> Room:
    """Return the parts of an array to work in, for 3·bodies = `size` coordinates."""
    count = constraints.shape[0]
    rows = constraints[count - 1].row + constraints[count - 1].rows if count else 0
    turns, work = work[: 2 * size // 3].reshape(size // 3, 2), work[2 * size // 3 :]
    force, work = work[:size], work[size:]
    value, rate, right = work[:rows], work[rows : 2 * rows], work[2 * rows : 3 * rows]
    work, block = work[3 * rows :], rows * size
    jacobian = work[:block].reshape(rows, size)
    over_mass = work[block : 2 * block].reshape(rows, size)
    matrix = work[2 * block :].reshape(rows, rows)
    return Room(turns, force, value, rate, right, jacobian, over_mass, matrix)


def constraint_table(joints: list[Joint] | tuple[Joint, ...]) -> Any:
    """Return joints as records of the type `CONSTRAINT`."""
    rows, row = [], 0
    for joint in joints:
        (kind, count), points = _KINDS[joint.kind], (*joint.point_i, *joint.point_j)
        along = math.cos(joint.direction), math.sin(joint.direction)
        about = *along, joint.angle, joint.speed, joint.ramp
        rows.append((kind, row, count, joint.i, joint.j, *points, *about))
        row += count
    return np.array(rows, CONSTRAINT)


@inlined
def turn(q: FloatArray, turns: FloatArray) -> None:
    """Write cosine and sine of the angle of every body to `turns`, shape (bodies, 2)."""
    for body in range(turns.shape[0]):
        angle = q[3 * body + 2]
        turns[body, 0], turns[body, 1] = math.cos(angle), math.sin(angle)


@inlined
def point(
    q: FloatArray, v: FloatArray, turns: FloatArray, body: int, x: float, y: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return a body's point: arm from the centre, position, velocity (global axes) and spin."""
    if body < 0:
        return x, y, x, y, 0.0, 0.0, 0.0
    return _swung(q, v, turns[body, 0], turns[body, 1], body, x, y)


@inlined
def _swung(
    q: FloatArray, v: FloatArray, c: float, s: float, body: int, x: float, y: float
) -> tuple[float, float, float, float, float, float, float]:
    k = 3 * body
    arm_x, arm_y, spin = c * x - s * y, s * x + c * y, v[k + 2]
    x, y = q[k] + arm_x, q[k + 1] + arm_y
    return arm_x, arm_y, x, y, v[k] - spin * arm_y, v[k + 1] + spin * arm_x, spin


@inlined
def _put(jacobian: FloatArray, row: int, body: int, x: float, y: float, turn: float) -> None:
    """Write a body's three entries of a row of the Jacobian."""
    if body >= 0:
        k = 3 * body
        jacobian[row, k], jacobian[row, k + 1], jacobian[row, k + 2] = x, y, turn


@inlined
def driven(t: float, speed: float, ramp: float) -> tuple[float, float, float]:
    """Return the angle that a driver has turned in a time, its speed and its acceleration.

    The speed rises as 3x² − 2x³ over the share x of the ramp, without a jump of the acceleration.
    """
    if t >= ramp or ramp == 0.0:
        return speed * (t - 0.5 * ramp), speed, 0.0
    x = t / ramp
    turned = speed * ramp * x**3 * (1.0 - 0.5 * x)
    return turned, speed * x * x * (3.0 - 2.0 * x), 6.0 * speed * x * (1.0 - x) / ramp


@called
def constrain(t: float, q: FloatArray, v: FloatArray, constraints: Any, w: Room) -> None:
    """Write Φ, dΦ/dt, Φ_q and, as the right-hand side, γ of Φ_q·q̈ = γ (Eq 10)."""
    turns, value, rate, gamma, jacobian = w.turns, w.value, w.rate, w.right, w.jacobian
    turn(q, turns)
    for number in range(constraints.shape[0]):
        joint = constraints[number]
        row, i, j = joint.row, joint.i, joint.j
        angle_i, spin_i = (0.0, 0.0) if i < 0 else (q[3 * i + 2], v[3 * i + 2])
        if joint.kind == DRIVER:
            turned, speed, acceleration = driven(t, joint.speed, joint.ramp)
            value[row] = q[3 * j + 2] - angle_i - joint.angle - turned
            rate[row] = v[3 * j + 2] - spin_i - speed
            _put(jacobian, row, i, 0.0, 0.0, -1.0)
            _put(jacobian, row, j, 0.0, 0.0, 1.0)
            gamma[row] = acceleration
            continue
        a_x, a_y, i_x, i_y, vi_x, vi_y, _ = point(q, v, turns, i, joint.x_i, joint.y_i)
        b_x, b_y, j_x, j_y, vj_x, vj_y, spin_j = point(q, v, turns, j, joint.x_j, joint.y_j)
        d_x, d_y, u_x, u_y = j_x - i_x, j_y - i_y, vj_x - vi_x, vj_y - vi_y
        # Centripetal part of the relative acceleration of the two points.
        w_x = -spin_j * spin_j * b_x + spin_i * spin_i * a_x
        w_y = -spin_j * spin_j * b_y + spin_i * spin_i * a_y
        if joint.kind == REVOLUTE:
            value[row], value[row + 1] = -d_x, -d_y
            rate[row], rate[row + 1] = -u_x, -u_y
            _put(jacobian, row, i, 1.0, 0.0, -a_y)
            _put(jacobian, row, j, -1.0, 0.0, b_y)
            _put(jacobian, row + 1, i, 0.0, 1.0, a_x)
            _put(jacobian, row + 1, j, 0.0, -1.0, -b_x)
            gamma[row], gamma[row + 1] = w_x, w_y
        else:
            c, s = (1.0, 0.0) if i < 0 else (turns[i, 0], turns[i, 1])
            n_x = -(s * joint.along_x + c * joint.along_y)
            n_y = c * joint.along_x - s * joint.along_y
            along = n_y * d_x - n_x * d_y  # of the relative position; ṅ = −ω·(direction)
            value[row] = n_x * d_x + n_y * d_y
            rate[row] = n_x * u_x + n_y * u_y - spin_i * along
            _put(jacobian, row, i, -n_x, -n_y, n_x * a_y - n_y * a_x - along)
            _put(jacobian, row, j, n_x, n_y, n_y * b_x - n_x * b_y)
            gamma[row] = (
                2.0 * spin_i * (n_y * u_x - n_x * u_y)
                + spin_i * spin_i * (n_x * d_x + n_y * d_y)
                - (n_x * w_x + n_y * w_y)
            )
            value[row + 1] = q[3 * j + 2] - angle_i - joint.angle
            rate[row + 1] = spin_j - spin_i
            _put(jacobian, row + 1, i, 0.0, 0.0, -1.0)
            _put(jacobian, row + 1, j, 0.0, 0.0, 1.0)
            gamma[row + 1] = 0.0


@inlined
def _apply(force: FloatArray, body: int, f_x: float, f_y: float, moment: float) -> None:
    """Add a force and a moment to those on a body."""
    if body >= 0:
        force[3 * body] += f_x
        force[3 * body + 1] += f_y
        force[3 * body + 2] += moment


@inlined
def _placed(
    q: FloatArray, v: FloatArray, body: int, x: float, y: float
) -> tuple[float, float, float, float, float]:
    """Return position, velocity and spin of a body's point."""
    if body < 0:
        return x, y, 0.0, 0.0, 0.0
    angle = q[3 * body + 2]
    _, _, x, y, v_x, v_y, spin = _swung(q, v, math.cos(angle), math.sin(angle), body, x, y)
    return x, y, v_x, v_y, spin


@inlined
def joint_motion(q: FloatArray, v: FloatArray, joint: contact.Joint) -> contact.Motion:
    """Return the motion of a joint at a state."""
    i_x, i_y, vi_x, vi_y, spin_i = _placed(q, v, joint.i, joint.x_i, joint.y_i)
    j_x, j_y, vj_x, vj_y, spin_j = _placed(q, v, joint.j, joint.x_j, joint.y_j)
    return i_x - j_x, i_y - j_y, vi_x - vj_x, vi_y - vj_y, spin_i, spin_j


@called
def _touch(
    q: FloatArray, v: FloatArray, w: Room, joints: Any, laws: FloatArray, ledgers: FloatArray
) -> None:
    """Add the contact forces of Eq 13, and write the rates of the ledgers of all joints.

    These are the powers that normal and friction force dissipate, δ and the normal force, in SI.
    """
    turns, force = w.turns, w.force
    ledgers[:] = 0.0
    for k in range(joints.shape[0]):
        joint, n = joints[k], 4 * k
        if not joint.touching:
            continue
        law = laws[joint.first : joint.first + joint.size]
        ai_x, ai_y, i_x, i_y, vi_x, vi_y, spin_i = point(q, v, turns, joint.i, joint.x_i, joint.y_i)
        aj_x, aj_y, j_x, j_y, vj_x, vj_y, spin_j = point(q, v, turns, joint.j, joint.x_j, joint.y_j)
        motion = i_x - j_x, i_y - j_y, vi_x - vj_x, vi_y - vj_y, spin_i, spin_j
        f_x, f_y, moment_i, moment_j, normal, lost, rubbed, delta, _ = contact.forces(
            motion, joint.impact_rate, joint, law
        )
        _apply(force, joint.i, f_x, f_y, ai_x * f_y - ai_y * f_x + moment_i)
        _apply(force, joint.j, -f_x, -f_y, -(aj_x * f_y - aj_y * f_x) + moment_j)
        ledgers[n], ledgers[n + 1], ledgers[n + 2], ledgers[n + 3] = lost, rubbed, delta, normal


@called
def _push(q: FloatArray, v: FloatArray, w: Room, springs: Any, loads: Any) -> tuple[float, float]:
    """Add the forces of springs, dampers and loads; return the powers of drives and dampers."""
    turns, force, driving, damping = w.turns, w.force, 0.0, 0.0
    for number in range(springs.shape[0]):
        s = springs[number]
        if s.turning:
            angle_i, spin_i = (0.0, 0.0) if s.i < 0 else (q[3 * s.i + 2], v[3 * s.i + 2])
            angle_j, spin_j = (0.0, 0.0) if s.j < 0 else (q[3 * s.j + 2], v[3 * s.j + 2])
            spin = spin_j - spin_i
            moment = s.torque - s.stiffness * (angle_j - angle_i - s.rest) - s.damping * spin
            _apply(force, s.i, 0.0, 0.0, -moment)
            _apply(force, s.j, 0.0, 0.0, moment)
            driving += s.torque * spin
            damping += s.damping * spin * spin
            continue
        a_x, a_y, i_x, i_y, vi_x, vi_y, _ = point(q, v, turns, s.i, s.x_i, s.y_i)
        b_x, b_y, j_x, j_y, vj_x, vj_y, _ = point(q, v, turns, s.j, s.x_j, s.y_j)
        d_x, d_y = j_x - i_x, j_y - i_y
        distance = math.sqrt(d_x * d_x + d_y * d_y)
        if distance == 0.0:
            continue
        d_x, d_y = d_x / distance, d_y / distance
        rate = d_x * (vj_x - vi_x) + d_y * (vj_y - vi_y)
        pull = s.stiffness * (distance - s.rest) + s.damping * rate
        _apply(force, s.i, pull * d_x, pull * d_y, pull * (a_x * d_y - a_y * d_x))
        _apply(force, s.j, -pull * d_x, -pull * d_y, -pull * (b_x * d_y - b_y * d_x))
        damping += s.damping * rate * rate
    for number in range(loads.shape[0]):
        load = loads[number]
        a_x, a_y, _, _, _, _, _ = point(q, v, turns, load.body, load.x, load.y)
        moment = load.moment + a_x * load.f_y - a_y * load.f_x
        _apply(force, load.body, load.f_x, load.f_y, moment)
    return driving, damping


@called
def _solve_positive(matrix: FloatArray, right: FloatArray) -> None:
    """Solve a symmetric positive definite system in place, from its lower triangle."""
    n = right.size
    for k in range(n):
        for i in range(k):
            for l in range(i):  # noqa: E741
                matrix[k, i] -= matrix[k, l] * matrix[i, l]
        # So far row k holds L·D; the diagonal keeps 1/D.
        for i in range(k):
            product = matrix[k, i]
            matrix[k, i] *= matrix[i, i]
            matrix[k, k] -= product * matrix[k, i]
            right[k] -= matrix[k, i] * right[i]
        matrix[k, k] = 1.0 / matrix[k, k]
    for k in range(n - 1, -1, -1):
        right[k] *= matrix[k, k]
        for l in range(k + 1, n):  # noqa: E741
            right[k] -= matrix[l, k] * right[l]


@called
def _schur(constraints: Any, mobility: FloatArray, w: Room) -> None:
    """Write the lower triangle of Φ_q·M⁻¹·Φ_qᵀ, and add Φ_q·M⁻¹·g to the right-hand side."""
    force, right, jacobian = w.force, w.right, w.jacobian
    over_mass, matrix = w.over_mass, w.matrix
    for number in range(constraints.shape[0]):
        a = constraints[number]
        for row in range(a.row, a.row + a.rows):
            matrix[row, : row + 1] = 0.0
            for end in range(2):
                body = a.j if end else a.i
                if body < 0:
                    continue
                k = 3 * body
                x, y = jacobian[row, k] * mobility[k], jacobian[row, k + 1] * mobility[k + 1]
                z = jacobian[row, k + 2] * mobility[k + 2]
                over_mass[row, k], over_mass[row, k + 1], over_mass[row, k + 2] = x, y, z
                right[row] += x * force[k] + y * force[k + 1] + z * force[k + 2]
                for other in range(number + 1):
                    b = constraints[other]
                    if body not in (b.i, b.j):
                        continue
                    for s in range(b.row, min(b.row + b.rows, row + 1)):
                        j_x, j_y, j_z = jacobian[s, k], jacobian[s, k + 1], jacobian[s, k + 2]
                        matrix[row, s] += x * j_x + y * j_y + z * j_z


@called
def _constrained(
    constraints: Any, v: FloatArray, over_mass: FloatArray, lam: FloatArray, rates: FloatArray
) -> float:
    """Add −M⁻¹·Φ_qᵀ·λ to accelerations; return the power of the drivers."""
    driving = 0.0
    for number in range(constraints.shape[0]):
        joint = constraints[number]
        for body in (joint.i, joint.j):
            if body < 0:
                continue
            for r in range(joint.row, joint.row + joint.rows):
                for n in range(3 * body, 3 * body + 3):
                    rates[n] -= over_mass[r, n] * lam[r]
        if joint.kind == DRIVER:
            spin = v[3 * joint.j + 2] - (v[3 * joint.i + 2] if joint.i >= 0 else 0.0)
            driving -= lam[joint.row] * spin
    return driving


@called
def derivatives(
    t: float, y: FloatArray, rates: FloatArray, row: int, joints: Any, laws: FloatArray, m: Linkage
) -> None:
    """Write the rates of coordinates and ledgers to a row of `rates`."""
    size = m.inertia.shape[1]
    mobility, ledger = m.inertia[1], 2 * size
    w = room(m.work, size, m.constraints)
    q, v, lam = y[:size], y[size:], w.right
    constrain(t, q, v, m.constraints, w)
    copy_to(m.inertia[2], w.force)
    driving, damping = _push(q, v, w, m.springs, m.loads)
    _touch(q, v, w, joints, laws, rates[row, ledger + 2 :])
    for r in range(lam.size):
        # lam holds γ; the right-hand side is Φ_q·M⁻¹·g − γ*.
        lam[r] = 2.0 * m.settings[0] * w.rate[r] + m.settings[1] ** 2 * w.value[r] - lam[r]
    _schur(m.constraints, mobility, w)
    _solve_positive(w.matrix, lam)

    for n in range(size):
        rates[row, n], rates[row, size + n] = v[n], w.force[n] * mobility[n]
    driving += _constrained(m.constraints, v, w.over_mass, lam, rates[row, size:])
    rates[row, ledger], rates[row, ledger + 1] = driving, damping


def closure(
    table: Any, t: float, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return Φ, dΦ/dt, Φ_q and γ of the joints in a table."""
    work, records = np.zeros(work_size(q.size // 3, table)), table.view(np.recarray)
    w = room(work, q.size, records)
    constrain(t, q, v, records, w)
    return w.value, w.rate, w.jacobian, w.right


@compiled
def largest_gaps(
    time: FloatArray, q: FloatArray, v: FloatArray, m: Linkage, out: FloatArray
) -> None:
    """Write the largest |Φ| and |dΦ/dt| of each row, in m or rad and per s, shape (n, 2)."""
    w = room(m.work, q.shape[1], m.constraints)
    for k in range(time.size):
        constrain(time[k], q[k], v[k], m.constraints, w)
        for n in range(w.value.size):
            out[k, 0] = max(out[k, 0], abs(w.value[n]))
            out[k, 1] = max(out[k, 1], abs(w.rate[n]))


# --- assembly -----------------------------------------------------------------------------------

_ITERATIONS = 50
# In m and rad: a few units in the last place for a mechanism of a metre.
_CLOSED = 1e-15
# The largest gap that is accepted when rounding stops Newton's method, in m and rad.
_ASSEMBLED = 1e-13
# Rotation of the drivers between two solutions, in rad.
_DRIVER_STEP = 0.1


def assemble(mechanism: Mechanism, t: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Return coordinates and velocities at time t with every joint closed.

    This is the start of a simulation: pins are centred in their bearings and at rest in them, as if
    the joints were ideal. Newton's method finds the positions, first at the driver's angle of the
    spec's guess, from which the driver moves in small steps to its initial angle. What the joints
    leave free stays as near to the guess as it can, and at rest. It is an `InputError` if the
    joints cannot be closed, or hold a body twice.
    """
    joints = [joint for joint in mechanism.joints if not joint.torque]
    table = constraint_table(joints)
    q = np.concatenate([np.array(body.guess) for body in mechanism.bodies])
    ideal = constraint_table([joint for joint in joints if joint.clearance is None])
    rows = int(ideal["rows"].sum())
    rule, remedy = f"make {rows} constraints for {q.size} coordinates", "hold nothing twice"
    require(rows <= q.size, mechanism.source, "joint", len(joints), rule, remedy)
    drives, held = table["kind"] == DRIVER, table.copy()
    held["speed"] = 0.0
    angles = np.append(q[2::3], 0.0)  # last that of the ground, body −1
    guessed = angles[table["j"][drives]] - angles[table["i"][drives]]
    ahead = [driven(t, float(row["speed"]), float(row["ramp"]))[0] for row in table[drives]]
    initial = table["angle"][drives] + ahead
    way = float(np.abs(initial - guessed).max(initial=0.0))
    steps = max(2, math.ceil(way / _DRIVER_STEP) + 1)
    for angle in np.linspace(guessed, initial, steps):
        held["angle"][drives] = angle
        q = _close(mechanism, held, q)
    _solve(mechanism, closure(ideal, t, q, np.zeros_like(q))[2], np.zeros(rows))
    _, rate, jacobian, _ = closure(table, t, q, np.zeros_like(q))
    return q, -_solve(mechanism, jacobian, rate)


def _close(mechanism: Mechanism, table: Any, q: FloatArray) -> FloatArray:
    """Return the coordinates that close all joints, by Newton's method with the drivers at rest."""
    still = np.zeros_like(q)
    gap = np.inf
    for _ in range(_ITERATIONS):
        value, _, jacobian, _ = closure(table, 0.0, q, still)
        gap = float(np.abs(value).max(initial=0.0))
        if gap <= _CLOSED:
            break
        q = q - _solve(mechanism, jacobian, value)
    if not gap <= _ASSEMBLED:
        raise InputError(
            mechanism.source, "bodies", None,
            f"cannot be assembled: the joints stay {gap:.3g} m or rad apart",
            "check the lengths (a rod must reach from the crank to the slide) and the guesses",
        )  # fmt: skip
    return q


def _solve(mechanism: Mechanism, jacobian: FloatArray, right: FloatArray) -> FloatArray:
    """Solve for a step or for velocities, the least that will do."""
    # Redundant only where there are more constraints than coordinates: a body in many clearances.
    rows, coordinates = jacobian.shape
    try:
        if rows == coordinates:
            return as_floats(np.linalg.solve(jacobian, right))
        step, _, rank, _ = np.linalg.lstsq(jacobian, right)
        if rank == min(rows, coordinates):
            return as_floats(step)
    except np.linalg.LinAlgError:
        pass
    raise InputError(
        mechanism.source, "joint", None,
        "leave a body free, or hold one twice, where the mechanism starts",
        "check the joints, or start the driver at another angle",
    )  # fmt: skip
