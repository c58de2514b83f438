"""Simulate a mechanism, revolution by revolution.

The integrator restarts at the end of every revolution of the driver. A revolution then depends only
on the state at its start, and a resumed run equals an uninterrupted one to the bit.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from cylcontact.arrays import require
from cylcontact.choices import BEYOND, METHODS, Beyond, Method
from cylcontact.errors import InputError
from cylcontact.mechanism.loop import Run, RunError, advance, one_row
from cylcontact.mechanism.model import Mechanism
from cylcontact.mechanism.slider_crank import recognise
from cylcontact.mechanism.statistics import Statistics
from cylcontact.mechanism.step_history import Settings, State, StepHistory, concatenate
from cylcontact.mechanism.system import build
from cylcontact.mechanism.trajectory import Trajectory
from cylcontact.progress import Progress, silent

__all__ = ["Interrupted", "begin", "one_revolution", "settings_for", "simulate"]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run, with what the complete revolutions give; None before the first one.

    `simulate` leaves a `trajectory`, `long_run` leaves `statistics`.
    """

    def __init__(
        self, trajectory: Trajectory | None = None, statistics: Statistics | None = None
    ) -> None:
        super().__init__()
        self.trajectory = trajectory
        self.statistics = statistics


def simulate(
    mechanism: Mechanism,
    method: Method | None = None,
    revolutions: int | None = None,
    tolerance: float | None = None,
    beyond: Beyond = "stop",
    progress: Progress = silent,
    resume: Trajectory | None = None,
    allowed_penetration: float | None = None,
) -> Trajectory:
    """Simulate a mechanism with a clearance joint.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism; see `read_mechanism`.
    method : {"minimal", "multiplier"}, optional
        The equations of motion: minimal coordinates, for a slider-crank with its clearance
        between rod and slider, or multipliers, for any mechanism. By default minimal coordinates
        if they apply.
    revolutions : int, optional
        Total number of revolutions of the driver; by default that of the spec.
    tolerance : float, optional
        By default that of the spec.
    beyond : {"stop", "tangent"}
        What to do at the end of the contact law: stop with an error, or continue along the
        tangent at nine tenths of the law's largest penetration. The trajectory records which.
    progress : callable, optional
        Called with a stage, the number of revolutions done and their total.
    resume : Trajectory, optional
        An earlier trajectory to continue. Its mechanism and settings are used, and of the other
        arguments only `revolutions` and `progress`. The result equals that of an uninterrupted
        run to the bit.
    allowed_penetration : float, optional
        The paper's step control, for comparison: instead of locating the onset of a contact, the
        step is halved until the penetration at the onset is at most this, in m.

    Returns
    -------
    Trajectory
        Whole revolutions.

    Raises
    ------
    InputError
        If the mechanism cannot be assembled, the law is undefined for the joint, the penetration
        leaves the domain of the law (`LawDomainError`, with time, penetration and limit), the
        steps collapse, or after the first revolution if the steps of all need too much memory.
        The first two are a `RunError`, with the complete revolutions.
    Interrupted
        After Ctrl-C, with the complete revolutions.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> mechanism = read_mechanism("datasets/slider_crank.toml", clearance=0.02)
    >>> run = simulate(mechanism, revolutions=1)
    >>> print(f"{run.penetration.max() * 1e6:.1f} µm")
    10.3 µm
    """
    if resume is None:
        settings = settings_for(mechanism, method, tolerance, beyond, allowed_penetration)
    else:
        mechanism, settings = resume.mechanism, resume.settings
    total = mechanism.integration.revolutions if revolutions is None else revolutions
    run = begin(mechanism, settings, total, None if resume is None else resume.end)
    parts = [one_row(run.state, 0)] if resume is None else [resume.rows]
    done = 0 if resume is None else resume.revolutions
    try:
        for index in range(done, total):
            progress("revolutions", index, total)
            parts.append(one_revolution(run, index, mechanism.period))
    except (KeyboardInterrupt, RunError) as error:
        rows = concatenate(parts)
        block = run.system.block.copy()
        complete = Trajectory(mechanism, settings, rows, block) if rows.counts.size else None
        if isinstance(error, RunError):
            error.trajectory = complete
            raise
        raise Interrupted(complete) from None
    progress("revolutions", total, total)
    return Trajectory(mechanism, settings, concatenate(parts), run.system.block.copy())


def begin(
    mechanism: Mechanism, settings: Settings, revolutions: int, state: State | None = None
) -> Run:
    """Return a run at its start, or at the state where an earlier one ended."""
    require(
        revolutions >= 1, "simulate", "revolutions", revolutions, "must be at least 1",
        "give e.g. 10",
    )  # fmt: skip
    system = build(mechanism, settings.method, settings.beyond, settings.allowed_penetration)
    return Run.start(system, settings.tolerance, settings.max_step, state)


def one_revolution(run: Run, index: int, period: float) -> StepHistory:
    """Integrate one revolution of the driver."""
    start, begun = run.state.time, time.perf_counter()
    rows, evaluations = advance(run, (index + 1) * period, index)
    seconds = time.perf_counter() - begun
    # The second row of an event, in the mode that begins there, is not a step.
    steps = np.count_nonzero(np.diff(rows.time, prepend=start) > 0)
    return replace(rows, counts=np.array([[steps, evaluations, seconds]]))


def settings_for(
    mechanism: Mechanism,
    method: Method | None = None,
    tolerance: float | None = None,
    beyond: Beyond = "stop",
    allowed_penetration: float | None = None,
) -> Settings:
    """Return the settings of a run, checked and with defaults filled in; see `simulate`."""
    method = _default_method(mechanism) if method is None else method
    for key, value, known in (("method", method, METHODS), ("beyond", beyond, BEYOND)):
        if value not in known:
            raise InputError("simulate", key, value, "is not known", f"choose {', '.join(known)}")
    tolerance = mechanism.integration.tolerance if tolerance is None else tolerance
    if not 1e-14 <= tolerance <= 1e-3:
        raise InputError(
            "simulate", "tolerance", tolerance, "must lie in [1e-14, 1e-3]", "give e.g. 1e-8"
        )
    if allowed_penetration is not None and not 0 < allowed_penetration < np.inf:
        raise InputError(
            "simulate", "allowed_penetration", allowed_penetration, "must be positive",
            "give it in m, or leave it out",
        )  # fmt: skip
    max_step = mechanism.integration.max_step
    return Settings(method, tolerance, max_step, beyond, allowed_penetration)


def _default_method(mechanism: Mechanism) -> Method:
    """Return "minimal" if it applies, else "multiplier".

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> [_default_method(read_mechanism(f"datasets/{name}.toml"))
    ...  for name in ("slider_crank", "four_bar")]
    ['minimal', 'multiplier']
    """
    try:
        recognise(mechanism)
    except InputError as error:
        if error.key == "method":
            return "multiplier"
        raise
    return "minimal"
