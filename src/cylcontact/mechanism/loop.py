"""The time loop from Python: a state, tolerances and buffers for the compiled integrator."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.errors import InputError
from cylcontact.laws.kernels import TABLE
from cylcontact.mechanism import contact, dop853, integrate
from cylcontact.mechanism.step_history import LEDGERS, State, StepHistory, concatenate
from cylcontact.mechanism.system import System

if TYPE_CHECKING:
    from cylcontact.mechanism.trajectory import Trajectory

__all__ = ["LawDomainError", "Run", "RunError", "advance", "one_row"]

# Relative tolerance where only the absolute one shall apply: absolute positions and angles.
_NOT_RELATIVE = 1e-15
# Steps between two checks for Ctrl-C.
_BUFFER = 4096
# Most steps of one revolution, and how many more for each second of it. Joints of restitution .5 to
# .9 take 500 to 15,000, at tolerances down to 1e-14; the most seen are 290,000, without any loss at
# 1e-12. In contact a step takes about 8 µs however slow the driver is.
_MOST_STEPS, _MORE_PER_SECOND = 3_000_000, 1_000_000


class RunError(InputError):
    """A run cannot go on.

    `simulate` leaves what its complete revolutions give in `trajectory`; None before the first one.
    """

    trajectory: Trajectory | None = None


class LawDomainError(RunError):
    """The penetration has reached the end of the contact law's domain during a run."""


@dataclass
class Run:
    """A run in progress: a system, its tolerance, its longest step in s and its present state."""

    system: System
    tolerance: float
    max_step: float
    state: State

    @classmethod
    def start(
        cls, system: System, tolerance: float, max_step: float, state: State | None = None
    ) -> Run:
        """Return a run at the system's start, or at another state."""
        return cls(system, tolerance, max_step, state or State(0.0, system.start, False, 0.0))

    @property
    def penetration(self) -> float:
        """δ at the present state in m."""
        system, values = self.system, self.state.values[: -len(LEDGERS)]
        p = system.block
        blocks = p, contact.law_of(p), p[int(p[contact.MODEL_START]) :]
        space = dop853.workspace(system.model, values.size, blocks[2])
        turn = dop853.crank(system.model, self.state.time, blocks[2])
        e_x, e_y, *_ = dop853.motion(system.model, *turn, values, blocks[2], space[2])
        return math.hypot(e_x, e_y) - float(p[contact.CLEARANCE])


def advance(run: Run, end: float, label: int = 0) -> tuple[StepHistory, int]:
    """Integrate to the time `end` through all events.

    Parameters
    ----------
    run : Run
        The run; its state is advanced.
    end : float
        In s.
    label : int
        The revolution of the rows.

    Returns
    -------
    rows : StepHistory
        The accepted steps.
    evaluations : int
        Number of evaluations of the right-hand side.

    Raises
    ------
    LawDomainError
        If the penetration reaches the end of the law's domain.
    RunError
        If the steps collapse, or there is no end to them.
    """
    system, state = run.system, run.state
    split = state.values.size - len(LEDGERS)
    y, ledgers = state.values[:split].copy(), state.values[split:].copy()
    now = np.zeros(integrate.NOW)
    now[[integrate.TIME, integrate.CONTACT, integrate.IMPACT_RATE]] = (
        state.time, state.in_contact, state.impact_rate,
    )  # fmt: skip
    tolerances = (
        run.tolerance if system.relative else _NOT_RELATIVE,
        run.tolerance * system.scale,
        run.max_step,
    )
    most = _MOST_STEPS + _MORE_PER_SECOND * (end - state.time)
    parts: list[StepHistory] = []
    status = integrate.FULL
    while status == integrate.FULL and len(parts) * _BUFFER < most:
        times, impact_rates = np.empty(_BUFFER), np.empty(_BUFFER)
        values, in_contact = np.empty((_BUFFER, state.values.size)), np.empty(_BUFFER, np.bool_)
        buffers = times, values, in_contact, impact_rates
        n, status = integrate.integrate(
            system.model, now, y, ledgers, end, system.block, tolerances, buffers
        )
        parts.append(_label_rows(times[:n], values[:n], in_contact[:n], impact_rates[:n], label))
    run.state = State(
        float(now[integrate.TIME]),
        np.concatenate((y, ledgers)),
        bool(now[integrate.CONTACT]),
        float(now[integrate.IMPACT_RATE]),
    )
    if status == integrate.LAW_LEFT:
        raise _law_left(run)
    if status == integrate.FULL:
        raise _without_end(run, label, len(parts) * _BUFFER)
    if status == integrate.COLLAPSED or not np.isfinite(run.state.values).all():
        raise _collapsed(run)
    return concatenate(parts), int(now[integrate.EVALUATIONS])


def one_row(state: State, label: int) -> StepHistory:
    """Return a state as a single row."""
    return _label_rows(
        np.array([state.time]),
        state.values[None, :],
        np.array([state.in_contact]),
        np.array([state.impact_rate]),
        label,
    )


def _label_rows(
    times: FloatArray,
    values: FloatArray,
    in_contact: BoolArray,
    impact_rate: FloatArray,
    label: int,
) -> StepHistory:
    """Return steps as rows of a revolution."""
    return StepHistory(
        time=times,
        values=values,
        in_contact=in_contact,
        impact_rate=impact_rate,
        revolution=np.full(times.size, label, dtype=np.int32),
        counts=np.empty((0, 3)),
    )


def _law_left(run: Run) -> LawDomainError:
    limit = run.system.block[contact.STOP_PENETRATION]
    # A tabulated law may be defined beyond its table.
    of_table = ", the end of its table" if run.system.block[contact.KERNEL] == TABLE else ""
    return LawDomainError(
        run.system.source,
        "clearance.law",
        run.system.law,
        f"leaves its domain at t = {run.state.time:.6g} s, where the penetration reaches "
        f"{run.penetration * 1e6:.4g} µm and the limit is {limit * 1e6:.4g} µm{of_table}",
        'choose another law, or let it go on along its tangent, beyond = "tangent"',
    )


def _collapsed(run: Run) -> RunError:
    return RunError(
        run.system.source,
        "integration.tolerance",
        run.tolerance,
        f"the steps collapse at t = {run.state.time:.6g} s, where the penetration is "
        f"{run.penetration * 1e6:.4g} µm",
        "loosen the tolerance, or look for a dead centre of the mechanism there",
    )


def _without_end(run: Run, revolution: int, steps: int) -> RunError:
    return RunError(
        run.system.source,
        "integration.tolerance",
        run.tolerance,
        f"revolution {revolution} has not ended after {steps:,} steps, at t = "
        f"{run.state.time:.6g} s, where the penetration is {run.penetration * 1e6:.4g} µm",
        "check masses, inertias and units, change the tolerance, or lower a restitution of 1",
    )
