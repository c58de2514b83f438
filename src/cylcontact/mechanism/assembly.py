"""Assembly: positions and velocities that satisfy every joint, with the clearance closed.

This is the start of a simulation: the journal is centred in its bearing and at rest relative to it,
as if the joint were ideal. Newton's method on the constraints finds the positions, first at the
driver angle of the spec's guess. The driver then moves in small steps to its initial angle, so that
the mechanism stays in the configuration of the guess. The velocities follow from one linear system.
"""

from __future__ import annotations

import math

import numpy as np

from cylcontact.arrays import FloatArray, as_floats, require
from cylcontact.errors import InputError
from cylcontact.mechanism import constraints
from cylcontact.mechanism.model import Joint, Mechanism

__all__ = ["assemble", "evaluate", "joint_table"]

_ITERATIONS = 50
# In m and rad: a few units in the last place for a mechanism of a metre.
_CLOSED = 1e-15
# The largest gap that is accepted when rounding stops Newton's method, in m and rad.
_ASSEMBLED = 1e-13

# Rotation of the driver between two solutions, in rad.
_DRIVER_STEP = 0.1
# The longest way of the driver to its initial angle; each turn takes a few milliseconds.
_TURNS = 100

_KINDS = {
    "revolute": constraints.REVOLUTE,
    "prismatic": constraints.PRISMATIC,
    "driver": constraints.DRIVER,
}


def joint_table(joints: tuple[Joint, ...]) -> FloatArray:
    """Return joints as the table that `constraints.evaluate` takes, shape (joints, 11)."""
    rows = []
    for joint in joints:
        last = {
            "revolute": (0.0, 0.0),
            "prismatic": (joint.direction, joint.angle),
            "driver": (joint.angle, joint.speed),
        }[joint.kind]
        axis = math.cos(last[0]), math.sin(last[0])
        rows.append(
            (_KINDS[joint.kind], joint.i, joint.j, *joint.point_i, *joint.point_j, *last, *axis)
        )
    return np.array(rows, dtype=np.float64)


def evaluate(
    table: FloatArray, t: float, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return Φ, dΦ/dt, Φ_q and γ of the joints in a table."""
    rows = sum(constraints.CONSTRAINTS[kind] for kind in table[:, 0])
    value, rate, gamma = np.zeros(rows), np.zeros(rows), np.zeros(rows)
    jacobian, turns = np.zeros((rows, q.size)), np.empty((q.size // 3, 2))
    constraints.turn(q, turns)
    constraints.evaluate(t, q, v, turns, table, value, rate, jacobian, gamma)
    return value, rate, jacobian, gamma


def assemble(mechanism: Mechanism, t: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Return coordinates and velocities at time t with every joint closed.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism; its clearance joint is treated as ideal.
    t : float
        Time in s.

    Returns
    -------
    q, v : array of float, shape (3·bodies,)
        x, y, θ of each body and their rates, in m, rad and s.

    Raises
    ------
    InputError
        If the joints cannot be closed, or they under- or overconstrain the bodies.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> q, v = assemble(read_mechanism("datasets/slider_crank.toml"))
    >>> print(q.round(6)[-3:], v.round(3)[1])
    [0.17 0.   0.  ] -13.09
    """
    table = joint_table(mechanism.joints)
    q = np.concatenate([np.array(body.guess) for body in mechanism.bodies])
    _require_square(mechanism, table, q.size)
    driver = next(row for row in table if row[0] == constraints.DRIVER)
    guessed = q[3 * int(driver[2]) + 2] - (q[3 * int(driver[1]) + 2] if driver[1] >= 0 else 0.0)
    initial, speed = driver[7] + driver[8] * t, driver[8]
    driver[8] = 0.0
    name = next(joint.name for joint in mechanism.joints if joint.kind == "driver")
    require(
        abs(initial - guessed) < _TURNS * math.tau,
        mechanism.source, f"joints.{name}.angle", math.degrees(initial),
        f"is more than {_TURNS} turns from the guessed angles of its bodies",
        "leave whole turns out",
    )  # fmt: skip
    steps = max(2, math.ceil(abs(initial - guessed) / _DRIVER_STEP) + 1)
    for angle in np.linspace(guessed, initial, steps):
        driver[7] = angle
        q = _close(mechanism, table, q)
    driver[8] = speed
    driver[7] = initial - speed * t
    _, rate, jacobian, _ = evaluate(table, t, q, np.zeros_like(q))
    return q, -_solve(mechanism, jacobian, rate)


def _close(mechanism: Mechanism, table: FloatArray, q: FloatArray) -> FloatArray:
    """Return the coordinates that close all joints, by Newton's method with the driver at rest."""
    still = np.zeros_like(q)
    gap = np.inf
    for _ in range(_ITERATIONS):
        value, _, jacobian, _ = evaluate(table, 0.0, q, still)
        gap = float(np.abs(value).max())
        if gap <= _CLOSED:
            break
        q = q - _solve(mechanism, jacobian, value)
    if not gap <= _ASSEMBLED:
        raise InputError(
            mechanism.source,
            "bodies",
            None,
            f"cannot be assembled: the joints stay {gap:.3g} m or rad apart",
            "check the lengths (a rod must reach from the crank to the slide) and the guesses",
        )
    return q


def _require_square(mechanism: Mechanism, table: FloatArray, coordinates: int) -> None:
    """Raise `InputError` unless there are as many constraints as coordinates."""
    rows = sum(constraints.CONSTRAINTS[kind] for kind in table[:, 0])
    if rows != coordinates:
        raise InputError(
            mechanism.source,
            "joints",
            len(mechanism.joints),
            f"make {rows} constraints for {coordinates} coordinates",
            "a mechanism of one driver needs as many of one as of the other",
        )


def _solve(mechanism: Mechanism, jacobian: FloatArray, right: FloatArray) -> FloatArray:
    """Solve for a step or for velocities; raise `InputError` if the system is singular."""
    try:
        return as_floats(np.linalg.solve(jacobian, right))
    except np.linalg.LinAlgError as error:
        raise InputError(
            mechanism.source,
            "joints",
            None,
            "leave a body free, or hold one twice, where the mechanism starts",
            "check the joints, or start the driver at another angle",
        ) from error
