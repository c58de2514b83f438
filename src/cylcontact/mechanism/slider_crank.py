"""The slider-crank in minimal coordinates: the components of its one or two eccentricities.

This is a second derivation, independent of multipliers, and the faster one. The frame has its
origin at the crank's pivot and its first axis along the slide. A(t) is the crank pin, prescribed by
the driver. The rod, of length L, points in the direction u = (cos φ, sin φ), and its far end is
P = A + L·u. The centre of the joint on the slider is S = (s, h), with h the offset of the slide.
The coordinates are

    E = S − P,

that is, the eccentricity if the slider carries the bearing and its negative if the rod does. They
are of the size of the clearance, so that a relative tolerance applies to the clearance. They
determine the other coordinates as long as the rod is not perpendicular to the slide:

    sin φ = (h − A_y − E_y)/L,    s = A_x + L·cos φ + E_x.

With the force F on the slider along the slide, −f on the rod at P, a moment M on the rod, the
moment of inertia J_A of the rod about A and its centre of mass at a·u + b·u⊥ from A,

    J_A·φ̈ + m·(a·u⊥ − b·u)·Ä = L·u⊥·(−f) + M + gravity,    m_s·s̈ = F_x,

and E follows by differentiating its definition twice. The driver's power is the moment of the
crank's reaction about its pivot times ω.

With a second clearance, between crank and rod, the rod begins at B = A + D in place of A, and D,
the eccentricity of rod against crank, has two unknowns more. The rod is then free: with the force p
on it at B and I about its centre of mass G,

    m·G̈ = p − f + gravity,    I·φ̈ = (B − G)×p − (P − G)×f + M,

and B̈ and P̈ follow from G̈, φ̈ and φ̇. Nothing else changes.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from cylcontact.joint import contact
from cylcontact.joint.clearance import Point
from cylcontact.mechanism.linkage import assemble
from cylcontact.mechanism.model import GROUND, Joint, Mechanism
from cylcontact.support.arrays import FloatArray
from cylcontact.support.numba_cache import called, inlined

# A slider-crank as compiled functions take it, in SI. The reciprocals save divisions.
Crank = Any
CRANK = np.dtype(
    [
        (name, np.float64)
        for name in (
            *("crank", "rod", "offset", "omega", "angle", "side"),
            *("crank_a", "crank_b", "crank_mass", "rod_a", "rod_b", "rod_mass", "rod_inertia"),
            *("slider_mass", "gravity_x", "gravity_y"),
            *("per_rod", "per_rod_inertia", "per_slider_mass"),
        )
    ]
)

# What a second clearance between crank and rod adds: the sign of its eccentricity, where the joint
# of the slider is among the two, the slider among the bodies, and the free rod.
PIN = np.dtype(
    [
        ("side", np.float64),
        *((name, np.int64) for name in ("wrist", "slider")),
        *((name, np.float64) for name in ("per_rod_mass", "per_rod_inertia")),
    ]
)

# Cosine and sine of the crank's angle.
Turn = tuple[float, float]
# Of Taylor's series.
_COS = (-1 / 2, 1 / 24, -1 / 720, 1 / 40320)
_SIN = (-1 / 6, 1 / 120, -1 / 5040, 1 / 362880)


@called
def crank_turn(t: float, m: Crank) -> tuple[float, float]:
    """Return cosine and sine of the crank's angle."""
    theta = m.angle + m.omega * t
    return math.cos(theta), math.sin(theta)


@inlined
def turned(c: float, s: float, dt: float, m: Crank) -> tuple[float, float]:
    """Return the cosine and sine of `crank_turn` a time dt later."""
    angle = m.omega * dt
    if abs(angle) > 0.1:
        x, y = math.cos(angle), math.sin(angle)
    else:  # Taylor's series to the last digit, without divisions
        z = angle * angle
        x = 1.0 + z * (_COS[0] + z * (_COS[1] + z * (_COS[2] + z * _COS[3])))
        y = angle * (1.0 + z * (_SIN[0] + z * (_SIN[1] + z * (_SIN[2] + z * _SIN[3]))))
    return c * x - s * y, s * x + c * y


@inlined
def _rod_motion(c: float, s: float, up: float, rate: float, m: Crank) -> tuple[float, float, float]:
    """Return sin φ, cos φ and φ̇ of the rod if eccentricities lift the slider by `up`."""
    sine = (m.offset - m.crank * s - up) * m.per_rod
    cosine = math.sqrt(1.0 - sine * sine)
    spin = -(m.omega * m.crank * c + rate) * m.per_rod / cosine
    return sine, cosine, spin


@inlined
def _weight(c: float, s: float, m: Crank) -> float:
    """Return the moment of the gravity on the crank about its pivot."""
    c_x, c_y = m.crank_a * c - m.crank_b * s, m.crank_a * s + m.crank_b * c
    moment: float = m.crank_mass * (c_x * m.gravity_y - c_y * m.gravity_x)
    return moment


@inlined
def _of_joint(
    side: float, y: FloatArray, n: int, rate: int, near: float, far: float
) -> contact.Motion:
    """Return a joint's motion from y[n] and y[rate] on, and the spins of its two bodies."""
    spin_i, spin_j = (far, near) if side > 0 else (near, far)
    return side * y[n], side * y[n + 1], side * y[rate], side * y[rate + 1], spin_i, spin_j


@inlined
def joint_motion(
    turn: Turn, y: FloatArray, joint: contact.Joint, m: Crank, pin: Any
) -> contact.Motion:
    """Return the motion of a joint along the slide, of two with a `pin`."""
    if pin is not None:
        _, _, spin = _rod_motion(turn[0], turn[1], y[1] + y[3], y[5] + y[7], m)
        return _of_two(spin, y, joint, m, pin)
    _, _, spin = _rod_motion(turn[0], turn[1], y[1], y[3], m)
    return _of_joint(m.side, y, 0, 2, spin, 0.0)


@inlined
def _of_two(spin: float, y: FloatArray, joint: contact.Joint, m: Crank, pin: Any) -> contact.Motion:
    if pin.slider in (joint.i, joint.j):
        return _of_joint(m.side, y, 0, 4, spin, 0.0)
    return _of_joint(pin.side, y, 2, 6, m.omega, spin)


@inlined
def derivatives(
    turn: Turn, y: FloatArray, rates: FloatArray, row: int, joint: Any, law: FloatArray, m: Crank
) -> None:
    """Write the rates of coordinates and ledgers to a row of `rates`."""
    c, s = turn
    sine, cosine, spin = _rod_motion(c, s, y[1], y[3], m)
    omega, length = m.omega, m.rod
    A_x, A_y = m.crank * c, m.crank * s
    a_x, a_y = -omega * omega * A_x, -omega * omega * A_y

    # Force on the slider, f, and moment on the rod about its end P.
    f_x, f_y, moment = 0.0, 0.0, 0.0
    for n in range(5, 10):
        rates[row, n] = 0.0
    if joint.touching:
        side, motion = m.side, _of_joint(m.side, y, 0, 2, spin, 0.0)
        f_x, f_y, moment_i, moment_j, normal, lost, rubbed, delta, _ = contact.forces(
            motion, joint.impact_rate, joint, law
        )
        f_x, f_y = side * f_x, side * f_y
        moment = moment_j if side > 0 else moment_i
        rates[row, 6], rates[row, 7] = lost, rubbed
        rates[row, 8], rates[row, 9] = delta, normal

    # The rod about A, in the accelerating frame; gravity on the rod reduces Ä.
    a, b = m.rod_a, m.rod_b
    lean_x, lean_y = -a * sine - b * cosine, a * cosine - b * sine  # a·u⊥ − b·u
    inertial = lean_x * (a_x - m.gravity_x) + lean_y * (a_y - m.gravity_y)
    turning = length * (sine * f_x - cosine * f_y) + moment
    alpha = (turning - m.rod_mass * inertial) * m.per_rod_inertia
    square = spin * spin

    rates[row, 0], rates[row, 1] = y[2], y[3]
    slider = f_x * m.per_slider_mass + m.gravity_x
    rates[row, 2] = slider - a_x + length * (sine * alpha + cosine * square)
    rates[row, 3] = -a_y - length * (cosine * alpha - sine * square)

    # The crank's reaction and the gravity on it, about the pivot.
    offset_x, offset_y = a * cosine - b * sine, a * sine + b * cosine
    G_x = a_x + lean_x * alpha - offset_x * square - m.gravity_x
    G_y = a_y + lean_y * alpha - offset_y * square - m.gravity_y
    reaction_x, reaction_y = m.rod_mass * G_x + f_x, m.rod_mass * G_y + f_y
    weight = _weight(c, s, m)
    rates[row, 4] = omega * (A_x * reaction_y - A_y * reaction_x - weight)


@inlined
def derivatives_of_two(
    turn: Turn,
    y: FloatArray,
    rates: FloatArray,
    row: int,
    joints: Any,
    laws: FloatArray,
    m: Crank,
    pin: Any,
) -> None:
    """Write the rates with two eccentricities, of the slider and of the rod at the crank."""
    c, s = turn
    sine, cosine, spin = _rod_motion(c, s, y[1] + y[3], y[5] + y[7], m)
    omega, length = m.omega, m.rod

    # Forces on the slider, f, and on the rod at the crank, p; moments on rod and crank.
    f_x, f_y, p_x, p_y, moment, on_crank = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(2):
        joint, first = joints[k], 10 + 4 * k
        lost, rubbed, delta, normal = 0.0, 0.0, 0.0, 0.0
        if joint.touching:
            law = laws[joint.first : joint.first + joint.size]
            motion = _of_two(spin, y, joint, m, pin)
            x, z, moment_i, moment_j, normal, lost, rubbed, delta, _ = contact.forces(
                motion, joint.impact_rate, joint, law
            )
            if k == pin.wrist:
                f_x, f_y = m.side * x, m.side * z
                moment += moment_j if m.side > 0 else moment_i
            else:
                p_x, p_y = pin.side * x, pin.side * z
                on_rod, on_crank = (moment_i, moment_j) if pin.side > 0 else (moment_j, moment_i)
                moment += on_rod
        rates[row, first], rates[row, first + 1] = lost, rubbed
        rates[row, first + 2], rates[row, first + 3] = delta, normal

    # The rod about its centre of mass G, then its ends B and P; B at −(o_x, o_y) from G.
    a, b = m.rod_a, m.rod_b
    o_x, o_y = a * cosine - b * sine, a * sine + b * cosine
    far_x, far_y = length * cosine - o_x, length * sine - o_y
    turning = o_y * p_x - o_x * p_y + far_y * f_x - far_x * f_y + moment
    alpha, square = turning * pin.per_rod_inertia, spin * spin
    b_x = (p_x - f_x) * pin.per_rod_mass + m.gravity_x + alpha * o_y + square * o_x
    b_y = (p_y - f_y) * pin.per_rod_mass + m.gravity_y - alpha * o_x + square * o_y
    A_x, A_y = m.crank * c, m.crank * s

    for n in range(4):
        rates[row, n] = y[4 + n]
    slider = f_x * m.per_slider_mass + m.gravity_x
    rates[row, 4] = slider - b_x + length * (sine * alpha + cosine * square)
    rates[row, 5] = -b_y - length * (cosine * alpha - sine * square)
    rates[row, 6], rates[row, 7] = b_x + omega * omega * A_x, b_y + omega * omega * A_y

    weight = _weight(c, s, m)
    rates[row, 8] = omega * (A_x * p_y - A_y * p_x - on_crank - weight)
    rates[row, 9] = 0.0


@dataclass(frozen=True)
class SliderCrank:
    """A slider-crank with a clearance between rod and slider, seen along its slide.

    `bodies` are crank, rod and slider. The frame is at `pivot` and turned by `slide`. The turns,
    added to the angle of a body, give the direction of its line; centres are those of mass, along
    the lines or, of the slider, from the joint along the slide. `record` is of the type `CRANK`;
    `pin` is of the type `PIN`, None without a clearance between crank and rod.
    """

    bodies: tuple[int, int, int]
    pivot: Point
    slide: float
    crank_turn: float
    rod_turn: float
    slider_angle: float
    slider_centre: complex
    record: Any
    pin: Any

    @property
    def size(self) -> int:
        """The number of coordinates and rates."""
        return 4 if self.pin is None else 8

    def _displaced(self, values: FloatArray) -> tuple[FloatArray, ...]:
        """Return E, its rate, D and its rate along the slide, from coordinates and rates."""
        pairs = values[:, : self.size : 2] + 1j * values[:, 1 : self.size : 2]
        if self.pin is None:
            still = np.zeros_like(pairs[:, 0])
            return pairs[:, 0], pairs[:, 1], still, still
        return pairs[:, 0], pairs[:, 2], pairs[:, 1], pairs[:, 3]

    def eccentricity(self, values: FloatArray, number: int) -> tuple[FloatArray, FloatArray]:
        """Return e of a joint and its rate in global axes, shapes (n, 2)."""
        E, E_rate, D, D_rate = self._displaced(values)
        turn = np.exp(1j * self.slide)
        side = self.record["side"]
        if self.pin is not None and number != self.pin["wrist"]:
            side, E, E_rate = self.pin["side"], D, D_rate
        e, rate = turn * side * E, turn * side * E_rate
        return np.column_stack((e.real, e.imag)), np.column_stack((rate.real, rate.imag))

    def motion(self, t: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return coordinates and velocities of the bodies in global axes, shapes (n, 9)."""
        m = self.record
        E, E_rate, D, D_rate = self._displaced(values)
        theta = m["angle"] + m["omega"] * t
        crank = np.exp(1j * theta)
        A = m["crank"] * crank
        B, B_rate = A + D, 1j * m["omega"] * A + D_rate
        sine = (m["offset"] - B.imag - E.imag) / m["rod"]
        cosine = np.sqrt(1.0 - sine * sine)
        phi, rod = np.arcsin(sine), cosine + 1j * sine
        phi_rate = -(B_rate.imag + E_rate.imag) / (m["rod"] * cosine)
        joint = B + m["rod"] * rod + E
        joint_rate = B_rate + 1j * phi_rate * m["rod"] * rod + E_rate
        rod_centre = complex(m["rod_a"], m["rod_b"]) * rod
        crank_centre = complex(m["crank_a"], m["crank_b"]) * crank
        # Centre, velocity, angle and spin of each body.
        motions = (
            (crank_centre, 1j * m["omega"] * crank_centre, theta - self.crank_turn, m["omega"]),
            (B + rod_centre, B_rate + 1j * phi_rate * rod_centre, phi - self.rod_turn, phi_rate),
            (joint + self.slider_centre, joint_rate, self.slider_angle, 0.0),
        )
        turn, pivot = np.exp(1j * self.slide), complex(*self.pivot)
        q, v = np.empty((t.size, 9)), np.empty((t.size, 9))
        for body, (centre, velocity, angle, spin) in zip(self.bodies, motions, strict=True):
            place, speed, n = pivot + turn * centre, turn * velocity, 3 * body
            q[:, n], q[:, n + 1], q[:, n + 2] = place.real, place.imag, angle
            v[:, n], v[:, n + 1], v[:, n + 2] = speed.real, speed.imag, spin
        return q, v


@lru_cache(maxsize=64)
def recognise(mechanism: Mechanism) -> SliderCrank | None:
    """Return the dimensions of a mechanism if it is a slider-crank that this form is for."""
    drivers = [joint for joint in mechanism.joints if joint.kind == "driver"]
    slides = [joint for joint in mechanism.joints if joint.kind == "prismatic"]
    if not (
        (len(mechanism.bodies), len(mechanism.joints)) == (3, 5)
        and len(drivers) == len(slides) == 1
        and drivers[0].i == slides[0].i == GROUND
        and drivers[0].j != slides[0].j
        and not (mechanism.springs or mechanism.loads or drivers[0].ramp or drivers[0].torque)
    ):
        return None
    crank, slider = drivers[0].j, slides[0].j
    (rod,) = {0, 1, 2} - {crank, slider}
    bodies, joints = (crank, rod, slider), {}
    for pair in ((GROUND, crank), (crank, rod), (rod, slider)):
        for joint in mechanism.joints:
            if joint.kind == "revolute" and {joint.i, joint.j} == {*pair}:
                joints[pair] = joint
    if len(joints) != 3:
        return None
    main, pin, wrist = joints.values()
    if wrist.clearance is None or main.clearance is not None:
        return None
    about = mechanism, bodies, (main, pin, wrist, slides[0]), drivers[0]
    shape = _measure(*about)
    q, _ = assemble(mechanism)
    backwards = math.cos(q[3 * rod + 2] + shape.rod_turn) <= 0
    return _measure(*about, math.pi) if backwards else shape


def _measure(
    mechanism: Mechanism,
    bodies: tuple[int, int, int],
    joints: tuple[Joint, ...],
    driver: Joint,
    turn: float = 0.0,
) -> SliderCrank:
    """Return lengths and angles from the points of the joints, in a frame turned by `turn`."""
    crank, rod, slider = bodies
    main, pin, wrist, slide = joints
    pivot, centre = _at(main, GROUND), _at(main, crank)
    along = slide.direction + turn
    crank_line, rod_line = _at(pin, crank) - centre, _at(wrist, rod) - _at(pin, rod)
    crank_angle, rod_angle = cmath.phase(crank_line), cmath.phase(rod_line)
    rod_centre = _turned(-_at(pin, rod), -rod_angle)
    crank_centre = _turned(-centre, -crank_angle)
    on_slide = _turned(_at(slide, GROUND) - pivot, -along)
    on_slider = _turned(_at(wrist, slider) - _at(slide, slider), slide.angle - along)
    gravity = np.exp(-1j * along) * complex(*mechanism.gravity)
    masses = [mechanism.bodies[body] for body in bodies]
    a, b = rod_centre.real, rod_centre.imag
    m = np.zeros(1, CRANK)[0]
    m["crank"], m["rod"] = abs(crank_line), abs(rod_line)
    m["offset"] = on_slide.imag + on_slider.imag
    m["omega"], m["angle"] = driver.speed, driver.angle + crank_angle - along
    m["side"] = 1.0 if wrist.i == slider else -1.0
    m["crank_a"], m["crank_b"] = crank_centre.real, crank_centre.imag
    m["crank_mass"], m["rod_mass"], m["slider_mass"] = (body.mass for body in masses)
    m["rod_a"], m["rod_b"] = a, b
    m["rod_inertia"] = masses[1].inertia + masses[1].mass * (a * a + b * b)
    m["gravity_x"], m["gravity_y"] = gravity.real, gravity.imag
    m["per_rod"], m["per_slider_mass"] = 1 / m["rod"], 1 / m["slider_mass"]
    m["per_rod_inertia"] = 1 / m["rod_inertia"]
    second = None
    if pin.clearance is not None:
        second = np.zeros(1, PIN)[0]
        second["side"] = 1.0 if pin.i == rod else -1.0
        second["wrist"], second["slider"] = mechanism.clearances.index(wrist), slider
        second["per_rod_mass"] = 1 / masses[1].mass
        second["per_rod_inertia"] = 1 / masses[1].inertia
    centre_on_slider = _turned(-_at(wrist, slider), slide.angle - along)
    turns = along, crank_angle - along, rod_angle - along, slide.angle
    return SliderCrank(bodies, (pivot.real, pivot.imag), *turns, centre_on_slider, m, second)


def _at(joint: Joint, body: int) -> complex:
    return complex(*(joint.point_i if joint.i == body else joint.point_j))


def _turned(a: complex, angle: float) -> complex:
    return cmath.rect(1.0, angle) * a
