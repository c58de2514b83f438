"""Local polish: from the basin that the genetic search found to its bottom."""

from __future__ import annotations

import numpy as np
from scipy.optimize import Bounds, NonlinearConstraint, least_squares, minimize

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.objectives import MaxDifference
from cylcontact.fitting.problem import Problem

# A restart that gains less than this, relatively, ends the polish.
WORTHWHILE = 1e-10
MAX_RESTARTS = 20


def polish(problem: Problem, start: FloatArray) -> tuple[FloatArray, float]:
    """Descend from a point to a local minimum.

    Parameters
    ----------
    problem : Problem
        What to minimise.
    start : array of float, shape (k,)
        Free parameters within their bounds.

    Returns
    -------
    point : array of float, shape (k,)
        The minimum; the start itself if nothing better was found.
    value : float
        Its objective.

    Notes
    -----
    Y is the larger of two branches, so the objective has kinks at which a least-squares
    iteration can stop early; it is restarted until that gains nothing.
    """
    descend = _descend_largest if isinstance(problem.objective, MaxDifference) else _descend_squares
    point, value = start, problem.value(start)
    if point.size == 0 or not np.isfinite(value):
        return point, value
    for _ in range(MAX_RESTARTS):
        candidate = descend(problem, point)
        reached = problem.value(candidate)
        if not reached < value * (1 - WORTHWHILE):
            break
        point, value = candidate, reached
    return point, value


def _descend_squares(problem: Problem, start: FloatArray) -> FloatArray:
    """Minimise a sum of squares within the bounds."""
    span = problem.high - problem.low
    margin = 1e-12 * span
    inside = np.clip(start, problem.low + margin, problem.high - margin)

    def residuals(point: FloatArray) -> FloatArray:
        return np.nan_to_num(problem.residuals(point), nan=1e3, posinf=1e3, neginf=-1e3)

    found = least_squares(
        residuals,
        inside,
        bounds=(problem.low, problem.high),
        x_scale=span,
        xtol=1e-14,
        ftol=1e-14,
        gtol=1e-14,
        max_nfev=2000,
    )
    return np.asarray(found.x)


def _descend_largest(problem: Problem, start: FloatArray) -> FloatArray:
    """Minimise a largest magnitude t, as a smooth problem with |residual| ≤ t as constraints."""
    span = problem.high - problem.low

    def residuals(unit: FloatArray) -> FloatArray:
        return np.nan_to_num(problem.residuals(problem.low + unit[:-1] * span), nan=1e3)

    def slack(unit: FloatArray) -> FloatArray:
        magnitudes = np.abs(residuals(unit))
        return as_floats(unit[-1] - magnitudes)

    first = np.append((start - problem.low) / span, problem.value(start) / 100)
    direction = np.append(np.zeros(start.size), 1.0)

    def largest(unit: FloatArray) -> float:
        return float(unit[-1])

    def gradient(_: FloatArray) -> FloatArray:
        return direction

    found = minimize(
        largest,
        first,
        jac=gradient,
        method="SLSQP",
        bounds=Bounds(np.zeros(first.size), np.append(np.ones(start.size), np.inf)),
        constraints=NonlinearConstraint(slack, 0, np.inf),
        options={"maxiter": 500, "ftol": 1e-12},
    )
    return np.asarray(problem.low + np.clip(found.x[:-1], 0, 1) * span)
