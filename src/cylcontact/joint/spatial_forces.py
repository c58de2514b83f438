"""Compiled forces of a pin that tilts in its hole, from one potential.

**Geometry.** In the hole's frame, from mid length with z along the axis, a point c of the pin's
axis, its direction a with a_z > 0, the velocity V of c and the spin W, both relative to the hole,
say all. The section at z has, with ψ = −a_xy/a_z, n = e/|e| and t = (−n_y, n_x),

    e = −c_xy + (z − c_z)·ψ,    g = ψ·n,    q = √(1 + g²),
    δ = |e| + R_j·(q − 1) − ΔR − crown.

The term of q is there because a tilted pin is cut in an ellipse. Rims A and B are the ends of the
length that hole and pin share.

**Wall.** U = ∫ w(δ) dz, with w = ∫ f dδ of the plane law, over the part that touches. The forces
are its derivatives, so that the work around a closed path vanishes: with G = ∂δ/∂e and P = ∂δ/∂ψ,

    F_xy = ∫ f·G dz,    F_z = ∫ f·∂δ/∂z dz,    K = ∫ f·((z − c_z)·G + P) dz,
    M_c = a × (K + (K·ψ)·k)/a_z.

A piece of the contact runs from where it touches first, or least, to a rim, at
z = start + (stop − start)·u³ with Gauss nodes in u. Integration by parts gives its energy from the
same loads: ∫ w dz = w_start·|ℓ| + ∫ f·∂δ/∂z·(stop − z) dz.

**Damping** is that of `contact`, with an impact rate v = p·v_A + (1 − p)·v_B from those of the
rims, p = x·δ_A/(x·δ_A + (1 − x)·δ_B) of their penetrations, x from 0 at rim B to 1 at rim A. A mean
of 1/v would let a rim at rest, whose v is small, damp an impact at the other one.

**Rim.** At a rim the material outside the contact helps to carry it, which slices do not know:

    U = A·δ^(5/2)·χ,   A = ⅖·c·E*·√(2·R_i·R_j/ΔR),   χ = s²/(s² + (δ/(b·R_i))²),

with s the slope of the penetration out of the hole; see `spatial.EdgeSpec` for c and b.

**Faces.** A ring on each collar is an elastic foundation against the face of the bush.

Lengths are in mm, forces in N. `cylcontact.export` translates the functions, so they keep to the
rules of `export.plain`.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np

from cylcontact.joint import contact
from cylcontact.joint.contact import (
    BEYOND_LAW,
    DEEPEST_SHARE,
    LEFT_HOLE,
    NOT_A_NUMBER,
    YIELDS,
    bounded_ratio,
)
from cylcontact.support.arrays import FloatArray
from cylcontact.support.numba_cache import called, inlined


def _numbers(names: str, size: int = 1) -> list[tuple[Any, ...]]:
    """Return fields of a record: numbers, or arrays of a size."""
    kind = (np.float64, size) if size > 1 else (np.float64,)
    return [(name, *kind) for name in names.split()]


# The numbers of a joint, and those of an evaluation: motion, section and sums.
SPATIAL = np.dtype(
    [
        *_numbers("point_b x_b y_b z_b point_p axis_p", 3),
        *_numbers("in_mm half R_hole R_pin clearance pin_low pin_high crown crown_at crown_half"),
        *_numbers("chi rate_floor friction v0 v1 edge edge_width unlike housed"),
        *_numbers("face_gap face_radius face_stiffness face_chi"),
        *_numbers("last_penetration last_load last_slope yields"),
        ("kernel", np.int64),
    ]
)
WORK = np.dtype(
    [
        *_numbers("x y z arm_b arm_p axis lever away moving turning c a V W force moment", 3),
        *_numbers("psi psi_rate K deepest_at", 2),
        *_numbers("low high tip_low tip_high crown_at arm r n_x n_y g across drop"),
        *_numbers("G_x G_y P_x P_y delta slope rate deepest rim_load start start_energy"),
        *_numbers("onset penetration penetration_rate", 4),
    ]
)
STATE = np.dtype(_numbers("impact_rate", 4))
WRENCH = np.dtype(
    [
        *_numbers("force_bearing moment_bearing force_pin moment_pin", 3),
        *_numbers("penetration penetration_rate", 4),
        *_numbers("normal_force dissipated_power elastic_energy touched"),
        ("flag", np.int64),
    ]
)
Joint = Annotated[Any, SPATIAL]
Work = Annotated[Any, WORK]
State = Annotated[Any, STATE]
Wrench = Annotated[Any, WRENCH]
# Position, quaternion w, x, y, z, velocity and angular velocity.
Body = Annotated[FloatArray, 13]
Vector = Annotated[FloatArray, 3]
Law = FloatArray

# The bits of a flag; `contact` has 1, 2, 32 and 128.
RIM_MISSING, OUTSIDE, UNLIKE, SLID_OUT, UNEVEN_HOUSING = 4, 8, 16, 64, 256
# Assumed: the least share of the length for which slices without the rim's stiffness are near
# three-dimensional elasticity, the largest tan of the tilt, and the axes' least cosine.
LEAST_SHARE, MOST_TILT, LEAST_COSINE = 0.25, 0.1, 0.1
# Assumed: below this share of the length that they share in the middle, the pin has slid out.
LEAST_SHARED = 0.99
# Assumed: a housing is loaded unevenly if one rim is less deep than this share of the other, or if
# less than this share of the length touches.
EVEN_SHARE = 0.9


def _graded(nodes: int) -> tuple[FloatArray, FloatArray]:
    """Return u³ of the Gauss nodes u on [0, 1], and the weights in it."""
    u, weight = np.polynomial.legendre.leggauss(nodes)
    return ((u + 1) / 2) ** 3, 1.5 * ((u + 1) / 2) ** 2 * weight


# Along a piece (8 nodes, 10 of a crowned pin), in the depth of a section, and along both halves of
# a face's arc.
PART, PART_WEIGHT = np.concatenate([_graded(8), _graded(10)], axis=1)
DEPTH, DEPTH_WEIGHT = _graded(20)
_u, _weight = np.polynomial.legendre.leggauss(8)
FACE_PART, FACE_WEIGHT = np.concatenate([1 + _u, -1 - _u]) / 2, np.tile(_weight, 2) / 2
# Along a half of a crowned pin, from the middle to the rim.
HALF_SAMPLES = 9
TINY = 1e-300


@inlined
def line_load(delta: float, joint: Joint, law: Law) -> float:
    """Return the load in N/mm, beyond the law's end along its tangent."""
    if delta > joint.last_penetration:
        return float(joint.last_load + joint.last_slope * (delta - joint.last_penetration))
    return contact.load_at(delta, joint, law)


@called
def energy_at(delta: float, joint: Joint, law: Law) -> float:
    """Return ∫ f dδ in N."""
    if delta <= 0.0:
        return 0.0
    inside = min(delta, joint.last_penetration)
    total = 0.0
    for k in range(20):
        total += DEPTH_WEIGHT[k] * line_load(inside * DEPTH[k], joint, law)
    total *= inside
    if delta > inside:
        total += 0.5 * (delta - inside) * (joint.last_load + line_load(delta, joint, law))
    return float(total)


@inlined
def rotate(body: Body, vector: Vector, out: Vector) -> None:
    """Write a vector in a body's axes in those of the world: v + 2·p × (p × v + p_w·v)/|p|²."""
    w = body[3]
    x = body[4]
    y = body[5]
    z = body[6]
    twice = 2.0 / (w * w + x * x + y * y + z * z)
    u_x = y * vector[2] - z * vector[1] + w * vector[0]
    u_y = z * vector[0] - x * vector[2] + w * vector[1]
    u_z = x * vector[1] - y * vector[0] + w * vector[2]
    out[0] = vector[0] + twice * (y * u_z - z * u_y)
    out[1] = vector[1] + twice * (z * u_x - x * u_z)
    out[2] = vector[2] + twice * (x * u_y - y * u_x)


@inlined
def resolve(vector: Vector, x: Vector, y: Vector, z: Vector, out: Vector) -> None:
    """Write a vector of the world in a frame of these axes."""
    out[0] = x[0] * vector[0] + x[1] * vector[1] + x[2] * vector[2]
    out[1] = y[0] * vector[0] + y[1] * vector[1] + y[2] * vector[2]
    out[2] = z[0] * vector[0] + z[1] * vector[1] + z[2] * vector[2]


@inlined
def cross(p: Annotated[FloatArray, 0], at: int, q: Vector, k: int) -> float:
    """Return the component k of a vector product; p begins `at` a place of its array."""
    i = (k + 1) % 3
    j = (k + 2) % 3
    return float(p[at + i] * q[j] - p[at + j] * q[i])


@called
def move(bearing: Body, pin: Body, w: Work, joint: Joint) -> None:
    """Write the motion of the pin in the hole's frame, and what the two share of the length."""
    rotate(bearing, joint.x_b, w.x)
    rotate(bearing, joint.y_b, w.y)
    rotate(bearing, joint.z_b, w.z)
    rotate(bearing, joint.point_b, w.arm_b)
    rotate(pin, joint.point_p, w.arm_p)
    rotate(pin, joint.axis_p, w.axis)
    for k in range(3):
        w.lever[k] = joint.in_mm * (pin[k] - bearing[k]) + w.arm_p[k]
        w.away[k] = w.lever[k] - w.arm_b[k]
        w.turning[k] = pin[10 + k] - bearing[10 + k]
    for k in range(3):
        # Of the pin's point, less that of the hole's body there.
        w.moving[k] = joint.in_mm * (pin[7 + k] - bearing[7 + k])
        w.moving[k] += cross(pin, 10, w.arm_p, k) - cross(bearing, 10, w.lever, k)
    resolve(w.away, w.x, w.y, w.z, w.c)
    resolve(w.axis, w.x, w.y, w.z, w.a)
    resolve(w.moving, w.x, w.y, w.z, w.V)
    resolve(w.turning, w.x, w.y, w.z, w.W)
    w.tip_low = joint.pin_low
    w.tip_high = joint.pin_high
    w.crown_at = joint.crown_at
    if w.a[2] < 0.0:
        w.crown_at = -joint.crown_at
        w.tip_low = -joint.pin_high
        w.tip_high = -joint.pin_low
        for k in range(3):
            w.a[k] = -w.a[k]
    w.a[2] = max(w.a[2], 1e-9)
    for k in range(2):
        w.psi[k] = -w.a[k] / w.a[2]
    spin_z = cross(w.W, 0, w.a, 2)
    for k in range(2):
        w.psi_rate[k] = -(cross(w.W, 0, w.a, k) + w.psi[k] * spin_z) / w.a[2]
    w.low = max(-joint.half, w.c[2] + w.a[2] * w.tip_low)
    w.high = min(joint.half, w.c[2] + w.a[2] * w.tip_high)


@inlined
def section(z: float, w: Work, joint: Joint) -> None:
    """Write δ, its derivatives and its rate at z."""
    arm = z - w.c[2]
    x = arm * w.psi[0] - w.c[0]
    y = arm * w.psi[1] - w.c[1]
    r = max(math.sqrt(x * x + y * y), TINY)
    per = 1.0 / r
    n_x = x * per
    n_y = y * per
    g = w.psi[0] * n_x + w.psi[1] * n_y
    across = w.psi[1] * n_x - w.psi[0] * n_y
    q = math.sqrt(1.0 + g * g)
    tilted = joint.R_pin * g / q
    bend = tilted * across * per
    off = (arm - w.crown_at) / joint.crown_half
    w.arm = arm
    w.r = r
    w.n_x = n_x
    w.n_y = n_y
    w.g = g
    w.across = across
    w.drop = 2.0 * joint.crown * off / joint.crown_half
    w.G_x = n_x - bend * n_y
    w.G_y = n_y + bend * n_x
    w.P_x = tilted * n_x
    w.P_y = tilted * n_y
    w.delta = r + joint.R_pin * g * g / (1.0 + q) - joint.clearance - joint.crown * off * off
    w.slope = w.G_x * w.psi[0] + w.G_y * w.psi[1] - w.drop
    w.rate = (
        w.G_x * (arm * w.psi_rate[0] - w.V[0])
        + w.G_y * (arm * w.psi_rate[1] - w.V[1])
        + w.P_x * w.psi_rate[0]
        + w.P_y * w.psi_rate[1]
        - w.slope * w.V[2]
    )


@called
def reach(w: Work, joint: Joint) -> None:
    """Write the penetrations of rims A and B and of faces A and B, and their rates."""
    for side in range(4):
        w.penetration[side] = -joint.clearance
        w.penetration_rate[side] = 0.0
    if w.low < w.high:
        spin_z = cross(w.W, 0, w.a, 2)
        # An end inside the hole moves along it.
        low_rate = w.V[2] + w.tip_low * spin_z if abs(w.low) < joint.half else 0.0
        high_rate = w.V[2] + w.tip_high * spin_z if abs(w.high) < joint.half else 0.0
        for side in range(2):
            z = w.high if side == 0 else w.low
            section(z, w, joint)
            w.penetration[side] = w.delta
            w.penetration_rate[side] = w.rate
            if abs(z) < joint.half:
                drift = high_rate if side == 0 else low_rate
                w.penetration_rate[side] += w.slope * drift
            if joint.crown > 0.0:
                seek(side, w, joint)
                section(w.deepest_at[side], w, joint)
                if w.delta > w.penetration[side]:
                    w.penetration[side] = w.delta
                    w.penetration_rate[side] = w.rate
                    # At the middle the slope is not zero, and the middle moves with the ends.
                    if abs(w.deepest_at[side] - 0.5 * (w.low + w.high)) <= 0.0:
                        w.penetration_rate[side] += w.slope * 0.5 * (low_rate + high_rate)
    if joint.face_stiffness > 0.0:
        reach_faces(w, joint)


@called
def reach_faces(w: Work, joint: Joint) -> None:
    """Write the penetrations of the faces and their rates."""
    lean = math.sqrt(w.a[0] * w.a[0] + w.a[1] * w.a[1])
    lean_rate = 0.0
    if lean > 0.0:
        lean_rate = (w.a[0] * cross(w.W, 0, w.a, 0) + w.a[1] * cross(w.W, 0, w.a, 1)) / lean
    for side in range(2):
        sign = 1.0 if side == 0 else -1.0
        w.penetration[2 + side] = (
            joint.half - sign * w.c[2] - w.a[2] * joint.face_gap + joint.face_radius * lean
        )
        w.penetration_rate[2 + side] = (
            joint.face_radius * lean_rate - sign * w.V[2] - joint.face_gap * cross(w.W, 0, w.a, 2)
        )


@called
def seek(side: int, w: Work, joint: Joint) -> None:
    """Write where a half of a crowned pin, the upper or the lower one, penetrates most."""
    middle = 0.5 * (w.low + w.high)
    rim = w.high if side == 0 else w.low
    step = (rim - middle) / (HALF_SAMPLES - 1)
    best = 0
    most = -math.inf
    for k in range(HALF_SAMPLES):
        section(middle + k * step, w, joint)
        if w.delta > most:
            most = w.delta
            best = k
    # At the rim itself, whose place has a rate of its own.
    z = middle + best * step if best < HALF_SAMPLES - 1 else rim
    section(z, w, joint)
    slope = w.slope
    # The penetration rises towards the next sample on that side, where it is less.
    other = best + 1 if slope * step > 0.0 else best - 1
    if other >= 0 and other < HALF_SAMPLES:
        last = middle + other * step
        section(last, w, joint)
        if slope * w.slope < 0.0:
            z = summit(z, last, w, joint)
    w.deepest_at[side] = z


@called
def summit(z: float, last: float, w: Work, joint: Joint) -> float:
    """Return where the slope of the penetration is zero between two places, by secants."""
    low = min(z, last)
    high = max(z, last)
    section(last, w, joint)
    before = w.slope
    for _k in range(12):
        section(z, w, joint)
        slope = w.slope
        if abs(slope - before) <= 0.0:
            break
        following = z - slope * (z - last) / (slope - before)
        last = z
        before = slope
        z = min(max(following, low), high)
    return z


@inlined
def slide(
    pressure: float,
    x: float,
    y: float,
    z: float,
    v_x: float,
    v_y: float,
    v_z: float,
    wrench: Wrench,
    w: Work,
    joint: Joint,
) -> None:
    """Add the friction at a point (x, y, z) from c that slides with a velocity."""
    speed = math.sqrt(v_x * v_x + v_y * v_y + v_z * v_z)
    part = min(max((speed - joint.v0) / (joint.v1 - joint.v0), 0.0), 1.0)
    if part > 0.0:
        per_speed = joint.friction * part * pressure / speed
        f_x = -per_speed * v_x
        f_y = -per_speed * v_y
        f_z = -per_speed * v_z
        w.force[0] += f_x
        w.force[1] += f_y
        w.force[2] += f_z
        w.moment[0] += y * f_z - z * f_y
        w.moment[1] += z * f_x - x * f_z
        w.moment[2] += x * f_y - y * f_x
        wrench.dissipated_power += per_speed * speed * speed


@inlined
def press(elastic: float, sway: float, onset: float, wrench: Wrench, w: Work, joint: Joint) -> None:
    """Add an elastic load on the section, and `sway`, the derivative of a rim's energy by g."""
    load = elastic * max(1.0 + joint.chi * bounded_ratio(w.rate / onset), 0.0)
    turn = sway * w.across / w.r
    e_x = load * w.G_x - turn * w.n_y
    e_y = load * w.G_y + turn * w.n_x
    w.force[0] += e_x
    w.force[1] += e_y
    w.force[2] += e_x * w.psi[0] + e_y * w.psi[1] - load * w.drop
    w.K[0] += w.arm * e_x + load * w.P_x + sway * w.n_x
    w.K[1] += w.arm * e_y + load * w.P_y + sway * w.n_y
    wrench.normal_force += load
    wrench.dissipated_power += (load - elastic) * w.rate
    if joint.friction > 0.0:
        # At the wall of the hole, less the part of the velocity along the section's normal.
        x = -joint.R_hole * w.n_x - w.c[0]
        y = -joint.R_hole * w.n_y - w.c[1]
        v_x = w.V[0] + w.W[1] * w.arm - w.W[2] * y
        v_y = w.V[1] + w.W[2] * x - w.W[0] * w.arm
        v_z = w.V[2] + w.W[0] * y - w.W[1] * x
        normal = (v_x * w.n_x + v_y * w.n_y + v_z * w.g) / (1.0 + w.g * w.g)
        v_x -= normal * w.n_x
        v_y -= normal * w.n_y
        v_z -= normal * w.g
        slide(load, x, y, w.arm, v_x, v_y, v_z, wrench, w, joint)


@inlined
def onset_at(z: float, w: Work, joint: Joint) -> float:
    """Return the mean impact rate of both rims, each as far as it touches."""
    x = 0.5 + 0.5 * z / joint.half
    upper = x * max(w.penetration[0], 0.0)
    lower = (1.0 - x) * max(w.penetration[1], 0.0)
    part = upper / (upper + lower) if upper + lower > 0.0 else x
    return float(part * w.onset[0] + (1.0 - part) * w.onset[1])


@called
def press_piece(
    start: float, stop: float, energy: float, wrench: Wrench, w: Work, joint: Joint, law: Law
) -> None:
    """Add the wall from `start`, where a section has that energy, to `stop`, without a kink."""
    length = stop - start
    first = 8 if joint.crown > 0.0 else 0
    nodes = 10 if joint.crown > 0.0 else 8
    if abs(length) <= 0.0:
        nodes = 0
    for k in range(nodes):
        node = first + k
        z = start + length * PART[node]
        section(z, w, joint)
        if w.delta > 0.0:
            line = line_load(w.delta, joint, law)
            w.deepest = max(w.deepest, line)
            load = PART_WEIGHT[node] * abs(length) * line
            wrench.elastic_energy += load * w.slope * length * (1.0 - PART[node])
            press(load, 0.0, onset_at(z, w, joint), wrench, w, joint)
    wrench.elastic_energy += abs(length) * energy
    wrench.touched += abs(length)


@called
def press_rising(
    start: float, stop: float, energy: float, wrench: Wrench, w: Work, joint: Joint, law: Law
) -> None:
    """Add the wall along which the penetration rises; the law may end in between."""
    turn = start
    section(start, w, joint)
    within = w.delta < joint.last_penetration
    section(stop, w, joint)
    if within and w.delta > joint.last_penetration:
        turn = crossing(start, stop, joint.last_penetration, w, joint)
        press_piece(start, turn, energy, wrench, w, joint, law)
        energy = energy_at(joint.last_penetration, joint, law)
    press_piece(turn, stop, energy, wrench, w, joint, law)


@called
def press_straight(wrench: Wrench, w: Work, joint: Joint, law: Law) -> None:
    """Add the wall of a pin without crown: the penetration grows with |e| alone."""
    square = w.psi[0] * w.psi[0] + w.psi[1] * w.psi[1]
    x = -w.c[0] - w.c[2] * w.psi[0]
    y = -w.c[1] - w.c[2] * w.psi[1]
    along = x * w.psi[0] + y * w.psi[1]
    nearest = w.low
    if square > 0.0:
        nearest = min(max(-along / square, w.low), w.high)
    section(nearest, w, joint)
    if w.delta > 0.0:
        energy = energy_at(w.delta, joint, law)
        press_rising(nearest, w.high, energy, wrench, w, joint, law)
        press_rising(nearest, w.low, energy, wrench, w, joint, law)
    elif square > 0.0:
        across = x * w.psi[1] - y * w.psi[0]
        least = across * across / square
        r = free_distance(square, least, joint)
        root = math.sqrt(max(square * r * r - across * across, 0.0))
        # Both roots of a quadratic without cancellation.
        far = -(along + root) if along > 0.0 else root - along
        inside = (x * x + y * y - r * r) / far if abs(far) > 0.0 else 0.0
        upper = max(far / square, inside)
        lower = min(far / square, inside)
        if w.penetration[0] > 0.0:
            press_rising(max(upper, nearest), w.high, 0.0, wrench, w, joint, law)
        if w.penetration[1] > 0.0:
            press_rising(min(lower, nearest), w.low, 0.0, wrench, w, joint, law)


@called
def free_distance(square: float, least: float, joint: Joint) -> float:
    """Return |e| without penetration, from tan² of the tilt and the least |e|²."""
    # From below Newton's method comes near monotonically, as δ is concave in |e|.
    most = joint.R_pin * square / (1.0 + math.sqrt(1.0 + square))
    r = max(joint.clearance - most, math.sqrt(least))
    for _k in range(20):
        if r > 0.0:
            part = least / (r * r)
            g = square * max(1.0 - part, 0.0)
            q = math.sqrt(1.0 + g)
            delta = r + joint.R_pin * g / (1.0 + q) - joint.clearance
            r -= delta / (1.0 + joint.R_pin * square * part / (r * q))
            if abs(delta) < 1e-16 * joint.clearance:
                break
    return float(r)


@called
def crossing(below: float, above: float, level: float, w: Work, joint: Joint) -> float:
    """Return where the penetration passes a level, by the Illinois method."""
    section(below, w, joint)
    less = w.delta - level
    section(above, w, joint)
    more = w.delta - level
    z = above
    last = 0
    for _k in range(60):
        before = z
        z = above - more * (above - below) / (more - less)
        section(z, w, joint)
        if w.delta > level:
            above = z
            more = w.delta - level
            if last == 1:
                less *= 0.5
            last = 1
        else:
            below = z
            less = w.delta - level
            if last == 2:
                more *= 0.5
            last = 2
        if abs(z - before) < 1e-14 * joint.half or abs(w.delta - level) <= 0.0:
            break
    return z


@called
def press_until(
    stop: float, energy: float, wrench: Wrench, w: Work, joint: Joint, law: Law
) -> None:
    """Add the wall from the last end of a part to this one, in two halves graded to both."""
    middle = 0.5 * (w.start + stop)
    press_piece(w.start, middle, w.start_energy, wrench, w, joint, law)
    press_piece(stop, middle, energy, wrench, w, joint, law)
    w.start = stop
    w.start_energy = energy


@called
def press_crowned(wrench: Wrench, w: Work, joint: Joint, law: Law) -> None:
    """Add the wall of a crowned pin, in parts between first touches and ends of the law."""
    last = joint.last_penetration
    step = 0.5 * (w.high - w.low) / (HALF_SAMPLES - 1)
    # The samples that the deepest places replace; the ends stay.
    upper = int(min((w.deepest_at[0] - w.low) / step + 0.5, 2.0 * HALF_SAMPLES - 3.0))
    lower = int(max((w.deepest_at[1] - w.low) / step + 0.5, 1.0))
    z = w.low
    section(z, w, joint)
    delta = w.delta
    w.start = z
    w.start_energy = energy_at(delta, joint, law)
    for k in range(1, 2 * HALF_SAMPLES - 1):
        before = z
        shallow = delta
        z = min(w.low + k * step, w.high)
        if k == lower:
            z = w.deepest_at[1]
        if k == upper:
            z = w.deepest_at[0]
        section(z, w, joint)
        delta = w.delta
        if shallow <= 0.0 and delta > 0.0:
            start = crossing(before, z, 0.0, w, joint)
            w.start = start
            w.start_energy = 0.0
        if shallow <= last and delta > last:
            turn = crossing(before, z, last, w, joint)
            press_until(turn, energy_at(last, joint, law), wrench, w, joint, law)
        if shallow > last and delta <= last:
            turn = crossing(z, before, last, w, joint)
            press_until(turn, energy_at(last, joint, law), wrench, w, joint, law)
        if shallow > 0.0 and delta <= 0.0:
            stop = crossing(z, before, 0.0, w, joint)
            press_until(stop, 0.0, wrench, w, joint, law)
    if delta > 0.0:
        press_until(z, energy_at(delta, joint, law), wrench, w, joint, law)


@called
def press_rims(wrench: Wrench, w: Work, joint: Joint, law: Law) -> None:
    """Add the stiffness of both rims, and the force along the axis on an end inside the hole."""
    for side in range(2):
        sign = 1.0 if side == 0 else -1.0
        z = w.high if side == 0 else w.low
        section(z, w, joint)
        if w.delta > 0.0:
            outward = 0.0
            slope = sign * w.g
            if joint.edge > 0.0 and slope > 0.0:
                share = w.delta / joint.edge_width
                square = slope * slope + share * share
                full = slope * slope / square
                stiff = joint.edge * w.delta * math.sqrt(w.delta)
                load = stiff * full * (0.5 + 2.0 * full)
                sway = sign * 2.0 * stiff * w.delta * slope * (share / square) * (share / square)
                outward = load * w.slope + sway * w.across * w.across / w.r
                wrench.elastic_energy += stiff * w.delta * full
                w.rim_load += load
                press(load, sway, w.onset[side], wrench, w, joint)
            if abs(z) < joint.half:
                tip = w.tip_high if side == 0 else w.tip_low
                force = -(sign * energy_at(w.delta, joint, law) + outward)
                w.force[2] += force
                w.moment[0] += tip * w.a[1] * force
                w.moment[1] -= tip * w.a[0] * force


@called
def press_faces(wrench: Wrench, w: Work, joint: Joint) -> None:
    """Add the rings on the collars: f = κ·δ per radian on the arc that touches."""
    lean = math.sqrt(w.a[0] * w.a[0] + w.a[1] * w.a[1])
    # (to_x, to_y) points down the slope of the ring's plane.
    to_x = w.a[0] / lean if lean > 0.0 else -1.0
    to_y = w.a[1] / lean if lean > 0.0 else 0.0
    swing = joint.face_radius * lean
    for side in range(2):
        if w.penetration[2 + side] > 0.0:
            sign = 1.0 if side == 0 else -1.0
            mean = w.penetration[2 + side] - swing
            half_arc = math.pi
            if mean < swing:
                half_arc = math.acos(-mean / swing)
            for node in range(16):
                cosine = math.cos(half_arc * FACE_PART[node])
                delta = mean + swing * cosine
                out = joint.face_radius * math.sin(half_arc * FACE_PART[node])
                along = -sign * joint.face_radius * cosine
                x = sign * joint.face_gap * w.a[0] - along * to_x * w.a[2] + out * to_y
                y = sign * joint.face_gap * w.a[1] - along * to_y * w.a[2] - out * to_x
                z = sign * joint.face_gap * w.a[2] + along * lean
                v_x = w.V[0] + w.W[1] * z - w.W[2] * y
                v_y = w.V[1] + w.W[2] * x - w.W[0] * z
                rate = -sign * (w.V[2] + w.W[0] * y - w.W[1] * x)
                elastic = joint.face_stiffness * half_arc * FACE_WEIGHT[node] * delta
                ratio = bounded_ratio(rate / w.onset[2 + side])
                load = elastic * max(1.0 + joint.face_chi * ratio, 0.0)
                w.force[2] += sign * load
                w.moment[0] += sign * y * load
                w.moment[1] -= sign * x * load
                wrench.dissipated_power += (load - elastic) * rate
                wrench.elastic_energy += 0.5 * elastic * delta
                if joint.friction > 0.0:
                    slide(load, x, y, z, v_x, v_y, 0.0, wrench, w, joint)


@called
def finish(wrench: Wrench, w: Work, joint: Joint) -> None:
    """Write the wrench in the world's axes about the reference points, in the joint's units."""
    lever = w.K[0] * w.psi[0] + w.K[1] * w.psi[1]
    w.moment[0] += (w.a[1] * lever - w.a[2] * w.K[1]) / w.a[2]
    w.moment[1] += (w.a[2] * w.K[0] - w.a[0] * lever) / w.a[2]
    w.moment[2] += (w.a[0] * w.K[1] - w.a[1] * w.K[0]) / w.a[2]
    for k in range(3):
        wrench.force_pin[k] = w.force[0] * w.x[k] + w.force[1] * w.y[k] + w.force[2] * w.z[k]
        wrench.force_bearing[k] = -wrench.force_pin[k]
        wrench.moment_pin[k] = w.moment[0] * w.x[k] + w.moment[1] * w.y[k] + w.moment[2] * w.z[k]
        wrench.moment_bearing[k] = -wrench.moment_pin[k]
    for k in range(3):
        wrench.moment_pin[k] = (
            wrench.moment_pin[k] + cross(w.arm_p, 0, wrench.force_pin, k)
        ) / joint.in_mm
        wrench.moment_bearing[k] = (
            wrench.moment_bearing[k] - cross(w.lever, 0, wrench.force_pin, k)
        ) / joint.in_mm
    wrench.dissipated_power /= joint.in_mm
    wrench.elastic_energy /= joint.in_mm
    flag_depth(wrench, w, joint)
    if w.deepest > joint.yields or (w.rim_load > 0.0 and joint.yields < math.inf):
        wrench.flag += YIELDS
    little = wrench.touched < LEAST_SHARE * 2.0 * joint.half
    if little and wrench.touched > 0.0 and joint.edge <= 0.0:
        wrench.flag += RIM_MISSING
    if w.psi[0] * w.psi[0] + w.psi[1] * w.psi[1] > MOST_TILT * MOST_TILT:
        wrench.flag += OUTSIDE
    if w.rim_load > 0.0 and joint.unlike > 0.0:
        wrench.flag += UNLIKE
    wrench.touched /= joint.in_mm


@called
def flag_depth(wrench: Wrench, w: Work, joint: Joint) -> None:
    """Flag what the penetrations of rims and faces are too large or too unlike for."""
    deepest = max(w.penetration[0], w.penetration[1])
    shallow = min(w.penetration[0], w.penetration[1])
    if deepest > joint.last_penetration:
        wrench.flag += BEYOND_LAW
    even = shallow >= EVEN_SHARE * deepest and wrench.touched >= EVEN_SHARE * (w.high - w.low)
    if joint.housed > 0.0 and deepest > 0.0 and not even:
        wrench.flag += UNEVEN_HOUSING
    if joint.face_stiffness > 0.0:
        face = max(w.penetration[2], w.penetration[3])
        deepest = max(deepest, face)
    if deepest > DEEPEST_SHARE * joint.R_hole:
        wrench.flag += LEFT_HOLE


@called
def reset(wrench: Wrench, w: Work) -> None:
    """Set the sums to zero."""
    for k in range(3):
        w.force[k] = 0.0
        w.moment[k] = 0.0
        wrench.force_pin[k] = 0.0
        wrench.force_bearing[k] = 0.0
        wrench.moment_pin[k] = 0.0
        wrench.moment_bearing[k] = 0.0
    w.K[0] = 0.0
    w.K[1] = 0.0
    w.deepest = 0.0
    w.rim_load = 0.0
    wrench.normal_force = 0.0
    wrench.dissipated_power = 0.0
    wrench.elastic_energy = 0.0
    wrench.touched = 0.0
    wrench.flag = 0


@called
def invalidate(wrench: Wrench, w: Work) -> None:
    """Write NaN as the wrench of a motion that is not a number, and flag what is none."""
    motion = 0.0
    for k in range(3):
        motion += w.c[k] + w.axis[k] + w.V[k] + w.W[k]
    if not abs(motion) < math.inf:
        wrench.flag += NOT_A_NUMBER
        wrench.normal_force = math.nan
        for k in range(3):
            wrench.force_pin[k] = math.nan
            wrench.force_bearing[k] = math.nan
            wrench.moment_pin[k] = math.nan
            wrench.moment_bearing[k] = math.nan


@called
def begin(state: State, w: Work, joint: Joint) -> bool:
    """Write the impact rates of the contacts; return whether there is one."""
    touching = False
    for side in range(4):
        w.onset[side] = 0.0
        if w.penetration[side] > 0.0:
            touching = True
            w.onset[side] = state.impact_rate[side] * joint.in_mm
            if w.onset[side] <= 0.0:
                w.onset[side] = max(w.penetration_rate[side], joint.rate_floor)
    return touching


@called
def evaluate(
    state: State,
    bearing: Body,
    pin: Body,
    wrench: Wrench,
    w: Work,
    joint: Joint,
    law: Law,
) -> None:
    """Write the wrench at a motion of both bodies and impact rates of rims and faces."""
    reset(wrench, w)
    move(bearing, pin, w, joint)
    reach(w, joint)
    touching = begin(state, w, joint)
    if w.a[2] < LEAST_COSINE:
        wrench.flag = OUTSIDE
        wrench.normal_force = math.nan
        touching = False
    if touching:
        if w.penetration[0] > 0.0 or w.penetration[1] > 0.0:
            if joint.crown > 0.0:
                press_crowned(wrench, w, joint, law)
            else:
                press_straight(wrench, w, joint, law)
            press_rims(wrench, w, joint, law)
        if joint.face_stiffness > 0.0:
            press_faces(wrench, w, joint)
        finish(wrench, w, joint)
    shared = min(joint.half, joint.pin_high) - max(-joint.half, joint.pin_low)
    if w.high - w.low < LEAST_SHARED * shared:
        wrench.flag += SLID_OUT
    invalidate(wrench, w)
    for side in range(4):
        wrench.penetration[side] = w.penetration[side] / joint.in_mm
        wrench.penetration_rate[side] = w.penetration_rate[side] / joint.in_mm


@called
def accept(state: State, bearing: Body, pin: Body, w: Work, joint: Joint) -> None:
    """Update the impact rates after an accepted step."""
    move(bearing, pin, w, joint)
    reach(w, joint)
    for side in range(4):
        if w.penetration[side] <= 0.0:
            state.impact_rate[side] = 0.0
        elif state.impact_rate[side] <= 0.0:
            state.impact_rate[side] = max(w.penetration_rate[side], joint.rate_floor) / joint.in_mm


@called
def ahead(body: Body, time: float) -> None:
    """Move a body for a time at its velocities."""
    w, x, y, z = body[3], body[4], body[5], body[6]
    square = body[10] * body[10] + body[11] * body[11] + body[12] * body[12]
    # tan(x)/x of half the angle x turns the quaternion by all of it, but for its length.
    half = 0.5 * time * (1.0 + time * time * square / 12.0)
    for k in range(3):
        body[k] += time * body[k + 7]
    body[3] = w - half * (body[10] * x + body[11] * y + body[12] * z)
    body[4] = x + half * (body[10] * w + body[11] * z - body[12] * y)
    body[5] = y + half * (body[11] * w + body[12] * x - body[10] * z)
    body[6] = z + half * (body[12] * w + body[10] * y - body[11] * x)
