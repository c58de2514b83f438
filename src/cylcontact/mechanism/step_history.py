"""The steps of a run as returned by the integrator."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.choices import Beyond, Method

__all__ = ["LEDGERS", "Settings", "State", "StepHistory", "concatenate"]

# The last states of every model: energies in J, and the integrals over the time in contact of the
# penetration in m s and of the normal force in N s.
LEDGERS = {
    "drive_work": -5,
    "normal_dissipation": -4,
    "friction_dissipation": -3,
    "penetration_integral": -2,
    "impulse": -1,
}


@dataclass(frozen=True)
class Settings:
    """Settings of a run: method, tolerance (dimensionless), longest step in s, and so on."""

    method: Method
    tolerance: float
    max_step: float
    beyond: Beyond
    allowed_penetration: float | None = None


@dataclass(frozen=True)
class State:
    """Everything that the rest of a run depends on: time in s, states, mode, δ̇⁽⁻⁾ in m/s."""

    time: float
    values: FloatArray
    in_contact: bool
    impact_rate: float


@dataclass(frozen=True)
class StepHistory:
    """The n accepted steps, and counts by revolution.

    Attributes
    ----------
    time : array of float, shape (n,)
        In s.
    values : array of float, shape (n, states)
        The states of the model in SI units; the last ones are the `LEDGERS`.
    in_contact : array of bool, shape (n,)
    impact_rate : array of float, shape (n,)
        δ̇⁽⁻⁾ of the current contact in m/s; 0 out of contact.
    revolution : array of int, shape (n,)
        From 0.
    counts : array of float, shape (revolutions, 3)
        Accepted steps, evaluations of the right-hand side, seconds.
    """

    time: FloatArray
    values: FloatArray
    in_contact: BoolArray
    impact_rate: FloatArray
    revolution: NDArray[np.int32]
    counts: FloatArray

    def taken(self, rows: slice, index: int) -> StepHistory:
        """Return some rows, with the counts of the revolution `index`."""
        parts = {field.name: getattr(self, field.name)[rows] for field in fields(self)}
        return StepHistory(**parts | {"counts": self.counts[index : index + 1]})


def concatenate(parts: list[StepHistory]) -> StepHistory:
    """Return the rows of all parts, in order."""
    names = [field.name for field in fields(StepHistory)]
    return StepHistory(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))
