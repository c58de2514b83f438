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
# Step of the central differences, relative to the interval between the bounds.
DIFFERENCE = 1e-6


def polish(
    problem: Problem, start: FloatArray, precision: float = 1e-14
) -> tuple[FloatArray, float]:
    """Descend from a point to a local minimum.

    Parameters
    ----------
    problem : Problem
        What to minimise.
    start : array of float, shape (k,)
        Free parameters within their bounds.
    precision : float
        Relative change of the objective below which a descent ends; the coefficients are then
        known to about its square root.

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
        candidate = descend(problem, point, precision)
        reached = problem.value(candidate)
        if not reached < value * (1 - WORTHWHILE):
            break
        point, value = candidate, reached
    return point, value


def _descend_squares(problem: Problem, start: FloatArray, precision: float) -> FloatArray:
    """Minimise a sum of squares within the bounds."""
    span = problem.high - problem.low
    margin = 1e-12 * span

    def residuals(point: FloatArray) -> FloatArray:
        return as_floats(_residuals(problem, point[None, :])[0])

    def jacobian(point: FloatArray) -> FloatArray:
        return _jacobian(problem, point)

    found = least_squares(
        residuals,
        np.clip(start, problem.low + margin, problem.high - margin),
        jac=jacobian,
        bounds=(problem.low, problem.high),
        x_scale=span,
        xtol=precision,
        ftol=precision,
        gtol=precision,
        max_nfev=2000,
    )
    return np.asarray(found.x)


def _descend_largest(problem: Problem, start: FloatArray, precision: float) -> FloatArray:
    """Minimise a largest magnitude t, as a smooth problem with |residual| ≤ t as constraints.

    It works in u, the free parameters scaled to [0, 1] between their bounds, and t.
    """
    span = problem.high - problem.low

    def point(unit: FloatArray) -> FloatArray:
        return as_floats(problem.low + unit[:-1] * span)

    def slack(unit: FloatArray) -> FloatArray:
        return as_floats(unit[-1] - np.abs(_residuals(problem, point(unit)[None, :])[0]))

    def slack_gradient(unit: FloatArray) -> FloatArray:
        signs = np.sign(_residuals(problem, point(unit)[None, :])[0])
        jacobian = -signs[:, None] * _jacobian(problem, point(unit)) * span
        return np.column_stack([jacobian, np.ones(len(jacobian))])

    first = np.append((start - problem.low) / span, problem.value(start) / 100)
    direction = np.append(np.zeros(start.size), 1.0)

    def largest(unit: FloatArray) -> float:
        return float(unit[-1])

    def largest_gradient(_: FloatArray) -> FloatArray:
        return direction

    found = minimize(
        largest,
        first,
        jac=largest_gradient,
        method="SLSQP",
        bounds=Bounds(np.zeros(first.size), np.append(np.ones(start.size), np.inf)),
        constraints=NonlinearConstraint(slack, 0, np.inf, jac=slack_gradient),
        options={"maxiter": 500, "ftol": max(precision, 1e-12)},
    )
    return as_floats(problem.low + np.clip(found.x[:-1], 0, 1) * span)


def _residuals(problem: Problem, points: FloatArray) -> FloatArray:
    """Return the residuals of points, shape (P, k) to (P, q), undefined ones made very bad."""
    return np.nan_to_num(problem.residuals(points), nan=1e3, posinf=1e3, neginf=-1e3)


def _jacobian(problem: Problem, point: FloatArray) -> FloatArray:
    """Return the derivatives of the residuals at one point, shape (q, k).

    Central differences, all of them in one call of the problem.
    """
    steps = np.diag(DIFFERENCE * (problem.high - problem.low))
    ahead, behind = np.split(_residuals(problem, np.vstack([point + steps, point - steps])), 2)
    return as_floats(((ahead - behind) / (2 * steps.diagonal())[:, None]).T)
