"""Simulate a mechanism, revolution by revolution.

At the end of every revolution of the driver the integrator starts anew. That makes a revolution
depend on nothing but the state at its start, and a run that is taken up later equal to one that
was never interrupted, to the bit.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from cylcontact.choices import BEYOND, METHODS, Beyond, Method
from cylcontact.errors import InputError
from cylcontact.mechanism.loop import Run, advance, one_row
from cylcontact.mechanism.model import Mechanism
from cylcontact.mechanism.slider_crank import recognise
from cylcontact.mechanism.step_history import Settings, StepHistory, concatenate
from cylcontact.mechanism.system import build
from cylcontact.mechanism.trajectory import Trajectory
from cylcontact.progress import Progress, silent

__all__ = ["Interrupted", "settings_for", "simulate"]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; `trajectory` holds the complete revolutions, None if there are none."""

    def __init__(self, trajectory: Trajectory | None) -> None:
        super().__init__()
        self.trajectory = trajectory


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
        What to simulate; see `read_mechanism`.
    method : {"minimal", "multiplier"}, optional
        Which equations of motion: minimal coordinates, for a slider-crank with its clearance
        between rod and slider, or multipliers, for any mechanism. By default the first where it
        fits.
    revolutions : int, optional
        Revolutions of the driver in all; by default the spec's.
    tolerance : float, optional
        By default the spec's.
    beyond : {"stop", "tangent"}
        What to do where the contact law ends: stop with an error, or go on along the tangent at
        nine tenths of the law's largest penetration. The trajectory says which.
    progress : callable, optional
        Called with a stage, the revolutions done and their number.
    resume : Trajectory, optional
        What has been simulated before: its mechanism and its settings count, and only
        `revolutions` and `progress` of the arguments here. The result is the same, to the bit, as
        that of a run never interrupted.
    allowed_penetration : float, optional
        For comparison, the paper's step control: the penetration in m with which a contact may
        begin, to which the step is halved, in place of locating the onset.

    Returns
    -------
    Trajectory
        Of whole revolutions.

    Raises
    ------
    InputError
        If the mechanism cannot be assembled, the law is undefined for the joint or is left
        (`LawDomainError`, with time, penetration and limit), or the steps collapse.
    Interrupted
        After Ctrl-C, with the revolutions that are complete.

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
    wanted = mechanism.integration.revolutions if revolutions is None else revolutions
    if wanted < 1:
        raise InputError("simulate", "revolutions", wanted, "must be at least 1", "give e.g. 10")
    system = build(mechanism, settings.method, settings.beyond, settings.allowed_penetration)
    run = Run.start(
        system, settings.tolerance, settings.max_step, None if resume is None else resume.end
    )
    parts = [one_row(run.state, 0)] if resume is None else [resume.rows]
    done = 0 if resume is None else resume.revolutions
    try:
        for index in range(done, wanted):
            progress("revolutions", index, wanted)
            parts.append(_revolution(run, index, mechanism.period))
    except KeyboardInterrupt:
        rows = concatenate(parts)
        complete = (
            Trajectory(mechanism, settings, rows, system.block.copy()) if rows.counts.size else None
        )
        raise Interrupted(complete) from None
    progress("revolutions", wanted, wanted)
    return Trajectory(mechanism, settings, concatenate(parts), system.block.copy())


def _revolution(run: Run, index: int, period: float) -> StepHistory:
    """Integrate one revolution of the driver."""
    start, begun = run.state.time, time.perf_counter()
    rows, evaluations = advance(run, (index + 1) * period, index)
    seconds = time.perf_counter() - begun
    # An event's second row, in the mode that begins there, is no step.
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
    """Return "minimal" where it fits, else "multiplier".

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
