"""Compiled contact of pin and bearing: Eqs 11–15 with any law of the package.

Body *i* carries the bearing, body *j* the pin. With the eccentricity e = r_i − r_j (Eq 11),
n = e/|e| points from the pin's centre to the bearing's, and the bodies touch on the side of −n.
Both contact forces act at one point, C = r_i − R_i·n on the bearing's surface, so that the pair
exchanges no net angular momentum. Relative to the pin's centre, C is at −(R_j − δ)·n, at the pin's
radius minus the penetration.

The velocities of the two bodies at C give the tangential velocity, with t = [n_y, −n_x],

    v_t = (v_i − v_j)·t = ė·t + ω_i·R_i − ω_j·(R_j − δ),

and the normal velocity is the penetration rate, (v_i − v_j)·n = ė·n = δ̇, because a rotation about
either centre moves C along t only.

**Units.** The mechanics is in SI, the laws in mm and N/mm. Only `elastic_force` and `stored_energy`
convert between them. `evaluate` and `accept` take and give the joint's own unit of length.

`cylcontact.export` translates `evaluate`, `accept`, `ahead` and what they call: they keep to the
rules of `export.plain`. The functions below them are for the integrator alone.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from cylcontact.impact import RATIO_BEND
from cylcontact.laws.kernels import inlined_load, kernel_energy
from cylcontact.support.arrays import FloatArray
from cylcontact.support.numba_cache import called, compiled, inlined

# The force is smooth in pieces. An integrator holds a piece through a step, beyond its ends if need
# be, and changes it at events. Branches of friction: slip (±2), ramp (±1), none (0). Regimes of the
# load: the law, or the straight line that continues it. ANY chooses by the state.
LAW, LINE = 0, 1
ANY = 9

# First what a run changes: whether there is contact, δ̇⁽⁻⁾ at the onset and bounded from below in
# m/s, and the pieces. Penetrations at which the law ends are in mm, all else is in SI.
JOINT = np.dtype(
    [
        *((name, np.int64) for name in ("touching", "branch", "regime")),
        *((name, np.float64) for name in ("onset_rate", "impact_rate")),
        *((name, np.float64) for name in ("chi", "friction", "v0", "v1", "rate_floor")),
        *((name, np.float64) for name in ("clearance", "R_bearing", "R_pin", "length")),
        *((name, np.float64) for name in ("last_penetration", "last_load", "last_slope")),
        ("stop_penetration", np.float64),
        # The law's kind, and the centres of hole and pin in the axes of their bodies.
        ("kernel", np.int64),
        *((name, np.float64) for name in ("x_i", "y_i", "x_j", "y_j")),
        # The unit of length of a joint by itself in m, and its elastic force at first yield in N.
        *((name, np.float64) for name in ("metres", "first_yield")),
    ]
)
STATE = np.dtype([("impact_rate", np.float64)])
WRENCH = np.dtype(
    [
        *(("force_bearing", np.float64, 2), ("moment_bearing", np.float64)),
        *(("force_pin", np.float64, 2), ("moment_pin", np.float64)),
        *((name, np.float64) for name in ("penetration", "penetration_rate")),
        *((name, np.float64) for name in ("normal_force", "friction_force", "tangential_velocity")),
        *(("dissipated_power", np.float64), ("flag", np.int64)),
    ]
)
# The arguments of compiled functions: records, the law's numbers, and x, y, angle and their rates.
Joint = Annotated[Any, JOINT]
State = Annotated[Any, STATE]
Wrench = Annotated[Any, WRENCH]
Law = FloatArray
Body = Annotated[FloatArray, 6]

# The bits of a wrench's flag; a joint in space has others too.
YIELDS, BEYOND_LAW, LEFT_HOLE, NOT_A_NUMBER = 1, 2, 32, 128
# Assumed: a penetration above this share of the hole's radius means that the pin has left its hole.
# Strains are then of the same size, far above those of any elastic contact.
DEEPEST_SHARE = 0.1


class Arms(NamedTuple):
    """From the reference points to the centres of hole and pin in m, along the world's axes."""

    x_i: float
    y_i: float
    x_j: float
    y_j: float


class Motion(NamedTuple):
    """e in m, its rate in m/s, and the spins of the bodies with the hole and with the pin."""

    e_x: float
    e_y: float
    u_x: float
    u_y: float
    omega_i: float
    omega_j: float


class Relative(NamedTuple):
    """n, the penetration in m and its rate, and the tangential velocity in m/s."""

    n_x: float
    n_y: float
    delta: float
    rate: float
    v_t: float


class Forces(NamedTuple):
    """Forces in N, moments in N m, powers in W; δ in m.

    The force is f_i of Eq 13a, on the bearing at C. The moments are those of this force about the
    bearing's centre and of the opposite force about the pin's, positive anticlockwise.
    """

    x: float
    y: float
    moment_i: float
    moment_j: float
    normal: float
    normal_power: float
    friction_power: float
    delta: float
    elastic: float


@inlined
def load_at(depth: float, joint: Joint, law: Law) -> float:
    """Return the load in N/mm at a penetration in mm."""
    return float(inlined_load(joint.kernel, law, depth))


@inlined
def elastic_force(delta: float, on_line: bool, joint: Joint, law: Law) -> float:
    """Return the elastic force in N at δ in m, by the law or along its tangent."""
    depth = 1e3 * delta
    if depth <= 0.0:
        return 0.0
    if on_line:
        load = joint.last_load + joint.last_slope * (depth - joint.last_penetration)
    else:
        load = load_at(depth, joint, law)
    return float(load * joint.length)


@inlined
def bounded_ratio(ratio: float) -> float:
    """Return a ratio of rates, bounded smoothly where it is above ten."""
    v = abs(ratio) / RATIO_BEND - 1.0
    if v <= 0.0:
        return ratio
    return math.copysign(RATIO_BEND * (1.0 + v / math.hypot(1.0, v)), ratio)


@inlined
def normal_force(elastic: float, rate: float, impact_rate: float, joint: Joint) -> float:
    """Return the elastic force with its damping, never negative."""
    return float(max(elastic * (1.0 + joint.chi * bounded_ratio(rate / impact_rate)), 0.0))


@inlined
def friction_share(v_t: float, joint: Joint) -> float:
    """Return c_d*sgn(v_t) of Eq 15: none at v0, all at v1."""
    return math.copysign(min(max((abs(v_t) - joint.v0) / (joint.v1 - joint.v0), 0.0), 1.0), v_t)


@inlined
def relative_motion(motion: Motion, joint: Joint) -> Relative:
    """Return the gap and its rates; centres that coincide have the normal (1, 0)."""
    distance = math.sqrt(motion.e_x * motion.e_x + motion.e_y * motion.e_y)
    n_x, n_y = 1.0, 0.0
    if not distance <= 0.0:  # NaN too
        per_distance = 1.0 / distance
        n_x, n_y = motion.e_x * per_distance, motion.e_y * per_distance
    delta = distance - joint.clearance
    rate = motion.u_x * n_x + motion.u_y * n_y
    v_t = motion.u_x * n_y - motion.u_y * n_x + motion.omega_i * joint.R_bearing
    v_t -= motion.omega_j * (joint.R_pin - delta)
    return Relative(n_x, n_y, delta, rate, v_t)


@called
def arms_of(bearing: Body, pin: Body, joint: Joint) -> Arms:
    """Return the arms of both bodies; a centre at the reference point takes no sines."""
    x_i = joint.x_i
    y_i = joint.y_i
    if abs(joint.x_i) + abs(joint.y_i) > 0.0:
        c_i = math.cos(bearing[2])
        s_i = math.sin(bearing[2])
        x_i = c_i * joint.x_i - s_i * joint.y_i
        y_i = s_i * joint.x_i + c_i * joint.y_i
    x_j = joint.x_j
    y_j = joint.y_j
    if abs(joint.x_j) + abs(joint.y_j) > 0.0:
        c_j = math.cos(pin[2])
        s_j = math.sin(pin[2])
        x_j = c_j * joint.x_j - s_j * joint.y_j
        y_j = s_j * joint.x_j + c_j * joint.y_j
    return Arms(x_i, y_i, x_j, y_j)


@called
def motion_of(bearing: Body, pin: Body, arms: Arms, joint: Joint) -> Motion:
    """Return the motion of the joint from x, y, angle and rates of its bodies."""
    # An angle that is not a number makes the motion none, also without arms.
    still = 0.0 * (bearing[2] - pin[2])
    e_x = joint.metres * (bearing[0] - pin[0]) + arms.x_i - arms.x_j + still
    e_y = joint.metres * (bearing[1] - pin[1]) + arms.y_i - arms.y_j
    u_x = joint.metres * (bearing[3] - pin[3]) - bearing[5] * arms.y_i + pin[5] * arms.y_j
    u_y = joint.metres * (bearing[4] - pin[4]) + bearing[5] * arms.x_i - pin[5] * arms.x_j
    return Motion(e_x, e_y, u_x, u_y, bearing[5], pin[5])


@called
def evaluate(
    state: State, bearing: Body, pin: Body, wrench: Wrench, joint: Joint, law: Law
) -> None:
    """Write the wrench at a motion of both bodies and an impact rate, in the joint's units."""
    arms = arms_of(bearing, pin, joint)
    m = relative_motion(motion_of(bearing, pin, arms, joint), joint)
    beyond = 1e3 * m.delta > joint.last_penetration
    elastic, normal = 0.0, 0.0
    if not m.delta <= 0.0:  # NaN too
        onset = state.impact_rate * joint.metres
        if onset <= 0.0:
            onset = max(m.rate, joint.rate_floor)
        elastic = elastic_force(m.delta, beyond, joint, law)
        normal = normal_force(elastic, m.rate, onset, joint)
    tangential = -joint.friction * friction_share(m.v_t, joint) * normal
    f_x = -normal * m.n_x + tangential * m.n_y
    f_y = -normal * m.n_y - tangential * m.n_x
    # (-a*n) x (f_t*t) = a*f_t, as n x t = -1.
    moment_i = arms.x_i * f_y - arms.y_i * f_x + joint.R_bearing * tangential
    moment_j = -(arms.x_j * f_y - arms.y_j * f_x) - (joint.R_pin - m.delta) * tangential

    wrench.force_bearing[0] = f_x
    wrench.force_bearing[1] = f_y
    wrench.moment_bearing = moment_i / joint.metres
    wrench.force_pin[0] = -f_x
    wrench.force_pin[1] = -f_y
    wrench.moment_pin = moment_j / joint.metres
    wrench.penetration = m.delta / joint.metres
    wrench.penetration_rate = m.rate / joint.metres
    wrench.normal_force = normal
    wrench.friction_force = tangential
    wrench.tangential_velocity = m.v_t / joint.metres
    wrench.dissipated_power = ((normal - elastic) * m.rate - tangential * m.v_t) / joint.metres
    wrench.flag = 0
    if elastic > joint.first_yield:
        wrench.flag += YIELDS
    if beyond:
        wrench.flag += BEYOND_LAW
    if m.delta > DEEPEST_SHARE * joint.R_bearing:
        wrench.flag += LEFT_HOLE
    # A force or a moment that is not finite makes this NaN.
    if not abs(0.0 * (f_x + f_y + moment_i + moment_j)) <= 0.0:
        wrench.flag += NOT_A_NUMBER


@called
def accept(state: State, bearing: Body, pin: Body, joint: Joint) -> None:
    """Update the impact rate after an accepted step."""
    motion = motion_of(bearing, pin, arms_of(bearing, pin, joint), joint)
    m = relative_motion(motion, joint)
    if m.delta <= 0.0:
        state.impact_rate = 0.0
    elif state.impact_rate <= 0.0:
        state.impact_rate = max(m.rate, joint.rate_floor) / joint.metres


@called
def ahead(body: Body, time: float) -> None:
    """Move a body for a time at its velocity."""
    for k in range(3):
        body[k] += time * body[k + 3]


# --- for the integrator, which keeps to one piece of the force through a step ---


@inlined
def forces(motion: Motion, impact_rate: float, joint: Joint, law: Law) -> Forces:
    """Return the forces of a pair that touches, in the joint's present piece."""
    m = relative_motion(motion, joint)
    elastic = piece_force(m.delta, joint, law)
    normal = normal_force(elastic, m.rate, impact_rate, joint)
    tangential = -joint.friction * piece_share(m.v_t, joint) * normal
    return Forces(
        -normal * m.n_x + tangential * m.n_y, -normal * m.n_y - tangential * m.n_x,
        joint.R_bearing * tangential, -(joint.R_pin - m.delta) * tangential,
        normal, (normal - elastic) * m.rate, -tangential * m.v_t, m.delta, elastic,
    )  # fmt: skip


@inlined
def piece_force(delta: float, joint: Joint, law: Law) -> float:
    """Return the elastic force in N at δ in m in the joint's regime."""
    beyond = 1e3 * delta > joint.last_penetration
    on_line = joint.regime == LINE or (joint.regime == ANY and beyond)
    return elastic_force(delta, on_line, joint, law)


@inlined
def piece_share(v_t: float, joint: Joint) -> float:
    """Return c_d·sgn(v_t) on the joint's branch of friction."""
    if joint.branch == ANY:
        return friction_share(v_t, joint)
    if abs(joint.branch) == 1:
        return float((v_t - joint.branch * joint.v0) / (joint.v1 - joint.v0))
    return float(0.5 * joint.branch)


@compiled
def stored_energy(penetration: float, joint: Joint, law: Law) -> float:
    """Return ∫ F_el dδ in J up to a penetration in m."""
    turn = joint.last_penetration * 1e-3
    # N/mm·mm times the length in mm is N mm.
    within = kernel_energy(joint.kernel, law, 1e3 * min(penetration, turn)) * joint.length * 1e-3
    if penetration <= turn:
        return float(within)
    ends = piece_force(turn, joint, law) + piece_force(penetration, joint, law)
    return float(within + 0.5 * (penetration - turn) * ends)
