"""The slider-crank in minimal coordinates: two unknowns, the components of the eccentricity.

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
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cylcontact.mechanism import contact
from cylcontact.mechanism.step_history import LEDGERS
from cylcontact.numba_cache import compiled, inlined

__all__ = [
    "ANGLE",
    "CRANK",
    "CRANK_A",
    "CRANK_B",
    "CRANK_MASS",
    "GRAVITY_X",
    "GRAVITY_Y",
    "MODEL_SIZE",
    "OFFSET",
    "OMEGA",
    "PER_ROD",
    "PER_ROD_INERTIA",
    "PER_SLIDER_MASS",
    "ROD",
    "ROD_A",
    "ROD_B",
    "ROD_INERTIA",
    "ROD_MASS",
    "SIDE",
    "SLIDER_MASS",
    "STATES",
    "derivatives",
    "ideal_reaction",
    "joint_motion",
]

# Positions in the model's part of the parameter block.
CRANK, ROD, OFFSET, ROD_A, ROD_B, ROD_INERTIA = 0, 1, 2, 3, 4, 5
ROD_MASS, SLIDER_MASS, OMEGA, ANGLE, SIDE, GRAVITY_X, GRAVITY_Y = 6, 7, 8, 9, 10, 11, 12
CRANK_A, CRANK_B, CRANK_MASS = 13, 14, 15
PER_ROD, PER_ROD_INERTIA, PER_SLIDER_MASS = 16, 17, 18  # reciprocals: divisions are slow
MODEL_SIZE = 19

STATES = 4 + len(LEDGERS)  # E_x, E_y, their rates and the ledgers


@inlined
def _rod_motion(
    c: float, s: float, y: NDArray[np.float64], m: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Return sin φ, cos φ and φ̇ of the rod; c and s are those of the crank's angle."""
    sine = (m[OFFSET] - m[CRANK] * s - y[1]) * m[PER_ROD]
    cosine = math.sqrt(1.0 - sine * sine)
    spin = -(m[OMEGA] * m[CRANK] * c + y[3]) * m[PER_ROD] / cosine
    return sine, cosine, spin


@inlined
def joint_motion(
    c: float, s: float, y: NDArray[np.float64], m: NDArray[np.float64]
) -> tuple[float, float, float, float, float, float]:
    """Return e = r_i − r_j in m, its rate in m/s, and the spins of bearing and journal in rad/s.

    In the frame of the slide; c and s are the cosine and sine of the crank's angle.
    """
    side = m[SIDE]
    _, _, spin = _rod_motion(c, s, y, m)
    spin_i, spin_j = (0.0, spin) if side > 0 else (spin, 0.0)
    return side * y[0], side * y[1], side * y[2], side * y[3], spin_i, spin_j


@compiled
def ideal_reaction(
    c: float, s: float, y: NDArray[np.float64], m: NDArray[np.float64]
) -> tuple[float, float]:
    """Return the force in N on the slider that keeps E constant, the reaction of an ideal joint."""
    sine, cosine, spin = _rod_motion(c, s, y, m)
    omega, length, square = m[OMEGA], m[ROD], spin * spin
    a_x, a_y = -omega * omega * m[CRANK] * c, -omega * omega * m[CRANK] * s
    alpha = (length * sine * square - a_y) / (length * cosine)
    f_x = m[SLIDER_MASS] * (a_x - length * (sine * alpha + cosine * square) - m[GRAVITY_X])
    lean_x, lean_y = -m[ROD_A] * sine - m[ROD_B] * cosine, m[ROD_A] * cosine - m[ROD_B] * sine
    inertial = lean_x * (a_x - m[GRAVITY_X]) + lean_y * (a_y - m[GRAVITY_Y])
    turning = m[ROD_INERTIA] * alpha + m[ROD_MASS] * inertial
    return f_x, (sine * f_x - turning / length) / cosine


@inlined
def derivatives(
    c: float,
    s: float,
    y: NDArray[np.float64],
    rates: NDArray[np.float64],
    row: int,
    p: NDArray[np.float64],
    law: NDArray[np.float64],
    m: NDArray[np.float64],
) -> None:
    """Write the rates of coordinates and ledgers to a row of `rates`.

    c and s are the cosine and sine of the crank's angle; p, law and m are the parameter block and
    its parts of the law and of the model.
    """
    sine, cosine, spin = _rod_motion(c, s, y, m)
    omega, length = m[OMEGA], m[ROD]
    A_x, A_y = m[CRANK] * c, m[CRANK] * s
    a_x, a_y = -omega * omega * A_x, -omega * omega * A_y

    # Force on the slider, f, and moment on the rod about its end P.
    f_x, f_y, moment = 0.0, 0.0, 0.0
    rates[row, 5], rates[row, 6], rates[row, 7], rates[row, 8] = 0.0, 0.0, 0.0, 0.0
    if p[contact.MODE] == contact.CONTACT:
        side = m[SIDE]
        spin_i, spin_j = (0.0, spin) if side > 0 else (spin, 0.0)
        f_x, f_y, moment_i, moment_j, normal, normal_power, friction_power, delta = contact.forces(
            side * y[0],
            side * y[1],
            side * y[2],
            side * y[3],
            spin_i,
            spin_j,
            p[contact.IMPACT_RATE],
            p,
            law,
        )
        f_x, f_y = side * f_x, side * f_y
        moment = moment_j if side > 0 else moment_i
        rates[row, 5], rates[row, 6] = normal_power, friction_power
        rates[row, 7], rates[row, 8] = delta, normal
    elif p[contact.CLEARANCE] == math.inf:
        f_x, f_y = ideal_reaction(c, s, y, m)

    # The rod about A, in the accelerating frame; gravity on the rod reduces Ä.
    a, b = m[ROD_A], m[ROD_B]
    lean_x, lean_y = -a * sine - b * cosine, a * cosine - b * sine  # a·u⊥ − b·u
    inertial = lean_x * (a_x - m[GRAVITY_X]) + lean_y * (a_y - m[GRAVITY_Y])
    turning = length * (sine * f_x - cosine * f_y) + moment
    alpha = (turning - m[ROD_MASS] * inertial) * m[PER_ROD_INERTIA]
    square = spin * spin

    rates[row, 0], rates[row, 1] = y[2], y[3]
    slider = f_x * m[PER_SLIDER_MASS] + m[GRAVITY_X]
    rates[row, 2] = slider - a_x + length * (sine * alpha + cosine * square)
    rates[row, 3] = -a_y - length * (cosine * alpha - sine * square)

    # The crank's reaction and the gravity on it, about the pivot.
    offset_x, offset_y = a * cosine - b * sine, a * sine + b * cosine
    G_x = a_x + lean_x * alpha - offset_x * square - m[GRAVITY_X]
    G_y = a_y + lean_y * alpha - offset_y * square - m[GRAVITY_Y]
    reaction_x, reaction_y = m[ROD_MASS] * G_x + f_x, m[ROD_MASS] * G_y + f_y
    c_x, c_y = m[CRANK_A] * c - m[CRANK_B] * s, m[CRANK_A] * s + m[CRANK_B] * c
    weight = m[CRANK_MASS] * (c_x * m[GRAVITY_Y] - c_y * m[GRAVITY_X])
    rates[row, 4] = omega * (A_x * reaction_y - A_y * reaction_x - weight)
