"""The lengths and angles of a slider-crank in its frame, for the minimal coordinates."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.mechanism.assembly import assemble
from cylcontact.mechanism.model import GROUND, Body, Joint, Mechanism, Point

__all__ = ["SliderCrank", "masses", "motion", "recognise"]


@dataclass(frozen=True)
class SliderCrank:
    """A slider-crank with a clearance between rod and slider, seen along its slide.

    The frame has its origin at the crank's pivot and its first axis along the slide. Lengths are in
    m, angles in rad. `crank_turn` and `rod_turn`, added to the angle of a body, give the direction
    of its line. `offset` is the distance of the slide from the pivot. `side` is 1 if the slider
    carries the bearing and −1 if the rod does.
    """

    crank: int
    rod: int
    slider: int
    pivot: Point
    slide: float
    crank_length: float
    rod_length: float
    offset: float
    rod_centre: Point
    crank_centre: Point
    crank_turn: float
    rod_turn: float
    slider_angle: float
    slider_centre: Point
    omega: float
    angle: float
    side: float


def recognise(mechanism: Mechanism) -> SliderCrank:
    """Return the dimensions of a mechanism that is a slider-crank.

    Raises
    ------
    InputError
        If it is another mechanism, or its clearance is not between rod and slider.
    """
    driver = mechanism.driver
    slides = [joint for joint in mechanism.joints if joint.kind == "prismatic"]
    crank, slider = driver.j, slides[0].j if slides else GROUND
    others = {0, 1, 2} - {crank, slider}
    rod = min(others)
    pivots = [
        _revolute(mechanism, {*pair}) for pair in ((GROUND, crank), (crank, rod), (rod, slider))
    ]
    main, pin, wrist = pivots
    if (
        len(mechanism.bodies) != 3
        or len(mechanism.joints) != 5
        or len(others) != 1
        or not (driver.i == GROUND and len(slides) == 1 and slides[0].i == GROUND)
        or main is None
        or pin is None
        or wrist is None
        or wrist.name != mechanism.clearance.joint
    ):
        raise InputError(
            mechanism.source,
            "method",
            "minimal",
            "is for a slider-crank whose clearance is between rod and slider",
            'use "multiplier", which takes any mechanism',
        )
    bodies, joints = (crank, rod, slider), (main, pin, wrist, slides[0])
    shape = _measure(mechanism, bodies, joints)
    q, _ = assemble(mechanism)
    if math.cos(q[3 * rod + 2] + shape.rod_turn) > 0:
        return shape
    # The rod points backwards along the slide: reverse the frame.
    return _measure(mechanism, bodies, joints, math.pi)


def _measure(
    mechanism: Mechanism,
    bodies: tuple[int, int, int],
    joints: tuple[Joint, Joint, Joint, Joint],
    turn: float = 0.0,
) -> SliderCrank:
    """Return the lengths and angles from the points of the joints, in a frame turned by `turn`."""
    crank, rod, slider = bodies
    main, pin, wrist, slide = joints
    pivot, centre = _at(main, GROUND), _at(main, crank)
    along = slide.direction + turn
    crank_length, crank_line = _line(centre, _at(pin, crank))
    rod_length, rod_line = _line(_at(pin, rod), _at(wrist, rod))
    slider_point = _minus(_at(wrist, slider), _at(slide, slider))
    on_slide = _turned(_minus(_at(slide, GROUND), pivot), -along)
    slider_offset = _turned(slider_point, slide.angle - along)
    return SliderCrank(
        crank=crank,
        rod=rod,
        slider=slider,
        pivot=pivot,
        slide=along,
        crank_length=crank_length,
        rod_length=rod_length,
        offset=on_slide[1] + slider_offset[1],
        rod_centre=_turned(_minus((0.0, 0.0), _at(pin, rod)), -rod_line),
        crank_centre=_turned(_minus((0.0, 0.0), centre), -crank_line),
        crank_turn=crank_line - along,
        rod_turn=rod_line - along,
        slider_angle=slide.angle,
        slider_centre=_turned(_minus((0.0, 0.0), _at(wrist, slider)), slide.angle - along),
        omega=mechanism.driver.speed,
        angle=mechanism.driver.angle + crank_line - along,
        side=1.0 if mechanism.clearance.i == slider else -1.0,
    )


def motion(
    shape: SliderCrank, t: FloatArray, E: FloatArray, E_rate: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return coordinates and velocities of the three bodies from the minimal coordinates.

    Parameters
    ----------
    shape : SliderCrank
        The dimensions.
    t : array of float, shape (n,)
        In s.
    E, E_rate : array of float, shape (n, 2)
        In m and m/s, in the frame of the slide.

    Returns
    -------
    q, v : array of float, shape (n, 9)
        In global axes.
    """
    theta = shape.angle + shape.omega * t
    A = shape.crank_length * np.exp(1j * theta)
    A_rate = 1j * shape.omega * A
    sine = (shape.offset - A.imag - E[:, 1]) / shape.rod_length
    phi = np.arcsin(sine)
    phi_rate = -(A_rate.imag + E_rate[:, 1]) / (shape.rod_length * np.cos(phi))
    rod = np.exp(1j * phi)
    joint = A + shape.rod_length * rod + (E[:, 0] + 1j * E[:, 1])
    joint_rate = (
        A_rate + 1j * phi_rate * shape.rod_length * rod + (E_rate[:, 0] + 1j * E_rate[:, 1])
    )
    rod_centre = complex(*shape.rod_centre) * rod
    crank_centre = complex(*shape.crank_centre) * np.exp(1j * theta)
    bodies = {
        shape.crank: (crank_centre, 1j * shape.omega * crank_centre, theta - shape.crank_turn,
                      np.full_like(t, shape.omega)),
        shape.rod: (A + rod_centre, A_rate + 1j * phi_rate * rod_centre, phi - shape.rod_turn,
                    phi_rate),
        shape.slider: (joint + complex(*shape.slider_centre), joint_rate,
                       np.full_like(t, shape.slider_angle), np.zeros_like(t)),
    }  # fmt: skip
    turn, pivot = np.exp(1j * shape.slide), complex(*shape.pivot)
    q, v = np.empty((t.size, 9)), np.empty((t.size, 9))
    for body, (local_centre, local_velocity, angle, spin) in bodies.items():
        centre, velocity = pivot + turn * local_centre, turn * local_velocity
        q[:, 3 * body : 3 * body + 3] = np.column_stack((centre.real, centre.imag, angle))
        v[:, 3 * body : 3 * body + 3] = np.column_stack((velocity.real, velocity.imag, spin))
    return q, v


def masses(mechanism: Mechanism, shape: SliderCrank) -> tuple[Body, Body, Body]:
    """Return crank, rod and slider."""
    bodies = mechanism.bodies
    return bodies[shape.crank], bodies[shape.rod], bodies[shape.slider]


def _revolute(mechanism: Mechanism, bodies: set[int]) -> Joint | None:
    """Return the first revolute joint between two bodies, if any."""
    joints = (j for j in mechanism.joints if j.kind == "revolute" and {j.i, j.j} == bodies)
    return next(joints, None)


def _at(joint: Joint, body: int) -> Point:
    return joint.point_i if joint.i == body else joint.point_j


def _minus(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1]


def _turned(a: Point, angle: float) -> Point:
    c, s = math.cos(angle), math.sin(angle)
    return c * a[0] - s * a[1], s * a[0] + c * a[1]


def _line(start: Point, end: Point) -> tuple[float, float]:
    """Return the length and direction from one point of a body to another."""
    x, y = _minus(end, start)
    return math.hypot(x, y), math.atan2(y, x)
