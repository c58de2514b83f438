"""The time loop: integration between events in one of two modes, free and contact.

Onset and release are roots of δ, located by CVODE. The penetration rate δ̇⁽⁻⁾ of an onset is the
rate at the root. After each event the integrator restarts with a short step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.laws.kernels import TABLE
from cylcontact.mechanism import contact, events
from cylcontact.mechanism.cvode import Integrator
from cylcontact.mechanism.step_history import State, StepHistory, concatenate
from cylcontact.mechanism.system import System

__all__ = ["FIRST_STEP", "LawDomainError", "Run", "advance", "one_row"]

# Assumed: the first step after an event in s, a thousandth of the duration of an impact.
FIRST_STEP = 1e-9
# Relative tolerance where only the absolute one shall apply: absolute positions and angles.
_NOT_RELATIVE = 1e-15
# An interval with more stretches than this makes no progress.
_MAX_STRETCHES = 100_000


class LawDomainError(InputError):
    """The penetration has reached the end of the contact law's domain during a run."""


@dataclass
class Run:
    """A run in progress: a system, its integrator and its present state."""

    system: System
    integrator: Integrator
    state: State
    tolerance: float

    @classmethod
    def start(
        cls, system: System, tolerance: float, max_step: float, state: State | None = None
    ) -> Run:
        """Return a run at the system's start, or at another state."""
        relative = tolerance if system.relative else _NOT_RELATIVE
        absolute = tolerance * system.scale
        integrator = Integrator(
            system.model, system.block, relative, absolute, max_step, FIRST_STEP
        )
        return cls(system, integrator, state or State(0.0, system.start, False, 0.0), tolerance)

    @property
    def penetration(self) -> float:
        """δ at the present state in m."""
        return _gap(self)[0]


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
    InputError
        If the steps collapse.
    """
    parts, evaluations = [], 0
    for _ in range(_MAX_STRETCHES):
        _set_mode(run)
        run.integrator.restart(run.state.time, run.state.values)
        stretch = run.integrator.advance(end)
        evaluations += run.integrator.evaluations
        parts.append(_label_rows(run.state, stretch.times, stretch.states, label))
        run.state = replace(run.state, time=stretch.times[-1], values=stretch.states[-1])
        if stretch.flag < 0 or not np.isfinite(run.state.values).all():
            raise _collapsed(run, stretch.flag)
        if stretch.event is None:
            return concatenate(parts), evaluations
        if stretch.event == events.LIMIT:
            raise _law_left(run)
        _switch(run)
        if run.state.time >= end:
            return concatenate(parts), evaluations
        parts.append(one_row(run.state, label))
    raise _collapsed(run, 0)


def one_row(state: State, label: int) -> StepHistory:
    """Return a state as a single row."""
    return _label_rows(state, np.array([state.time]), state.values[None, :], label)


def _label_rows(state: State, times: FloatArray, values: FloatArray, label: int) -> StepHistory:
    """Return steps as rows in the mode of `state`."""
    return StepHistory(
        time=times,
        values=values,
        in_contact=np.full(times.size, state.in_contact),
        impact_rate=np.full(times.size, state.impact_rate),
        revolution=np.full(times.size, label, dtype=np.int32),
        counts=np.empty((0, 3)),
    )


def _set_mode(run: Run) -> None:
    """Set the mode in the parameter block of the compiled model."""
    p = run.system.block
    p[contact.MODE] = contact.CONTACT if run.state.in_contact else contact.FREE
    p[contact.IMPACT_RATE] = max(run.state.impact_rate, p[contact.RATE_FLOOR])


def _switch(run: Run) -> None:
    """Change to the other mode, with δ̇⁽⁻⁾ at the root."""
    if run.state.in_contact:
        run.state = replace(run.state, in_contact=False, impact_rate=0.0)
    else:
        run.state = replace(run.state, in_contact=True, impact_rate=_gap(run)[1])


def _gap(run: Run) -> tuple[float, float]:
    """Return δ in m and δ̇ in m/s."""
    e_x, e_y, u_x, u_y = run.system.model.eccentricity(
        run.state.time, run.state.values, run.system.block
    )
    distance = math.hypot(e_x, e_y)
    rate = (e_x * u_x + e_y * u_y) / distance if distance > 0 else 0.0
    return distance - float(run.system.block[contact.CLEARANCE]), rate


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


def _collapsed(run: Run, flag: int) -> InputError:
    return InputError(
        run.system.source,
        "integration.tolerance",
        run.tolerance,
        f"the steps collapse at t = {run.state.time:.6g} s, where the penetration is "
        f"{run.penetration * 1e6:.4g} µm (CVODE's flag is {flag})",
        "loosen the tolerance, or look for a dead centre of the mechanism there",
    )
