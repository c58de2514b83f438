"""The steps of a run as the integrator gives them."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.choices import Beyond, Method

__all__ = ["Settings", "State", "StepHistory", "concatenate"]


@dataclass(frozen=True)
class Settings:
    """How a run is integrated; the tolerance is dimensionless, the step in s."""

    method: Method
    tolerance: float
    max_step: float
    beyond: Beyond
    allowed_penetration: float | None = None


@dataclass(frozen=True)
class State:
    """All that the rest of a run depends on: time in s, states, mode, δ̇⁽⁻⁾ in m/s."""

    time: float
    values: FloatArray
    in_contact: bool
    impact_rate: float


@dataclass(frozen=True)
class StepHistory:
    """The accepted steps, n of them, and counts by revolution.

    Attributes
    ----------
    time : array of float, shape (n,)
        In s.
    values : array of float, shape (n, states)
        The states of the model, SI.
    in_contact : array of bool, shape (n,)
    impact_rate : array of float, shape (n,)
        δ̇⁽⁻⁾ of the contact under way in m/s, 0 out of contact.
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


def concatenate(parts: list[StepHistory]) -> StepHistory:
    """Join rows in their order."""
    columns = [np.concatenate([getattr(one, f.name) for one in parts]) for f in fields(StepHistory)]
    return StepHistory(*columns)
