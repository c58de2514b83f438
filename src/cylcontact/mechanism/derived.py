"""Quantities derived from the states of a run, row by row: forces, energies, drift."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.laws.kernels import kernel_energy
from cylcontact.mechanism import constraints, contact
from cylcontact.mechanism.assembly import joint_table
from cylcontact.mechanism.model import Mechanism
from cylcontact.numba_cache import compiled

__all__ = [
    "PARTS",
    "changes",
    "drift",
    "elastic_energy",
    "force_within",
    "joint_forces",
    "kinetic_and_potential",
]

# Parts of a step in which the force is looked at.
PARTS = 4


@compiled
def joint_forces(
    e: NDArray[np.float64],
    e_rate: NDArray[np.float64],
    spins: NDArray[np.float64],
    in_contact: NDArray[np.bool_],
    impact_rate: NDArray[np.float64],
    floor: float,
    p: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return force on the bearing (x, y), f_n, f_t in N and v_t in m/s, shape (n, 5)."""
    out = np.zeros((e.shape[0], 5))
    law = contact.law_of(p)
    for k in range(e.shape[0]):
        e_x, e_y, u_x, u_y = e[k, 0], e[k, 1], e_rate[k, 0], e_rate[k, 1]
        spin_i, spin_j = spins[k, 0], spins[k, 1]
        out[k, 4] = contact.relative_motion(e_x, e_y, u_x, u_y, spin_i, spin_j, p)[4]
        if in_contact[k]:
            rate = max(impact_rate[k], floor)
            f_x, f_y, _, _, normal, _, _, _ = contact.forces(
                e_x, e_y, u_x, u_y, spin_i, spin_j, rate, p, law
            )
            out[k, 0], out[k, 1], out[k, 2] = f_x, f_y, normal
            out[k, 3] = contact.friction_force(normal, out[k, 4], p)
    return out


@compiled
def force_within(
    time: NDArray[np.float64],
    e: NDArray[np.float64],
    e_rate: NDArray[np.float64],
    in_contact: NDArray[np.bool_],
    impact_rate: NDArray[np.float64],
    floor: float,
    p: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return f_n in N in the middle of `PARTS` equal parts of every step, shape (n − 1, PARTS).

    Steps are long against the peaks of the force. The eccentricity is interpolated by Hermite's
    cubic; out of contact the force is 0.
    """
    out = np.zeros((time.size - 1, PARTS))
    law = contact.law_of(p)
    for k in range(time.size - 1):
        h = time[k + 1] - time[k]
        if not in_contact[k + 1] or h <= 0.0:
            continue
        rate = max(impact_rate[k + 1], floor)
        for part in range(PARTS):
            x = (part + 0.5) / PARTS
            e_x, u_x = _hermite(x, h, e[k, 0], e[k + 1, 0], e_rate[k, 0], e_rate[k + 1, 0])
            e_y, u_y = _hermite(x, h, e[k, 1], e[k + 1, 1], e_rate[k, 1], e_rate[k + 1, 1])
            out[k, part] = contact.forces(e_x, e_y, u_x, u_y, 0.0, 0.0, rate, p, law)[4]
    return out


@compiled
def _hermite(
    x: float, h: float, start: float, end: float, start_rate: float, end_rate: float
) -> tuple[float, float]:
    """Return a value and its rate at a fraction x of a step, from those at its ends."""
    a, b, c = h * start_rate, end - start, h * end_rate
    cubic, square = a + c - 2.0 * b, 3.0 * b - 2.0 * a - c
    value = start + x * (a + x * (square + x * cubic))
    return value, (a + x * (2.0 * square + x * 3.0 * cubic)) / h


@compiled
def elastic_energy(penetration: NDArray[np.float64], p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ∫ F_el dδ in J up to each penetration in m."""
    out = np.zeros(penetration.size)
    turn = p[contact.LAST_PENETRATION] * 1e-3  # the law continues as a straight line from there
    law, kind = contact.law_of(p), int(p[contact.KERNEL])
    for k in range(penetration.size):
        delta = penetration[k]
        # N/mm·mm times the length in mm is N mm.
        out[k] = kernel_energy(kind, law, 1e3 * min(delta, turn)) * p[contact.LENGTH] * 1e-3
        if delta > turn:
            ends = contact.elastic_force(turn, p) + contact.elastic_force(delta, p)
            out[k] += 0.5 * (delta - turn) * ends
    return out


def kinetic_and_potential(
    mechanism: Mechanism, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return kinetic and potential energy in J; q and v have shape (n, 3·bodies)."""
    mass = np.array([[b.mass, b.mass, b.inertia] for b in mechanism.bodies]).ravel()
    weight = np.array([(b.mass * g) for b in mechanism.bodies for g in (*mechanism.gravity, 0.0)])
    return 0.5 * (v**2) @ mass, -q @ weight


@compiled
def _drift(
    time: NDArray[np.float64],
    q: NDArray[np.float64],
    v: NDArray[np.float64],
    table: NDArray[np.float64],
    rows: int,
) -> NDArray[np.float64]:
    out = np.zeros((time.size, 2))
    value, rate, gamma = np.zeros(rows), np.zeros(rows), np.zeros(rows)
    jacobian, turns = np.zeros((rows, q.shape[1])), np.empty((q.shape[1] // 3, 2))
    for k in range(time.size):
        constraints.turn(q[k], turns)
        constraints.evaluate(time[k], q[k], v[k], turns, table, value, rate, jacobian, gamma)
        out[k, 0], out[k, 1] = np.abs(value).max(), np.abs(rate).max()
    return out


def drift(mechanism: Mechanism, time: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
    """Return the largest |Φ| and |dΦ/dt| of each row, in m or rad and per s, shape (n, 2)."""
    table = joint_table(mechanism.constraints)
    rows = sum(constraints.CONSTRAINTS[kind] for kind in table[:, 0])
    largest: FloatArray = _drift(time, q, v, table, rows)
    return largest


def changes(in_contact: BoolArray) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return the rows at which contacts begin and those at which they end.

    Examples
    --------
    >>> changes(np.array([False, False, True, True, False, True]))
    (array([2, 5]), array([3]))
    """
    step = np.diff(in_contact.astype(np.int8))
    return np.flatnonzero(step == 1) + 1, np.flatnonzero(step == -1)
