"""Local polish: from the basin that the genetic search found to its bottom."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares, linprog

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.objectives import Largest
from cylcontact.fitting.problem import Problem

# A restart that gains less than this, relatively, ends the polish.
WORTHWHILE = 1e-10
MAX_RESTARTS = 20
# Step of the central differences, relative to the interval between the bounds.
DIFFERENCE = 1e-6
# Trust region of the minimax descent, relative to the same interval, and its longest run.
FIRST_RADIUS, LAST_RADIUS = 0.05, 1e-9
MAX_PROGRAMMES = 200


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
    descend = _descend_largest if isinstance(problem.objective, Largest) else _descend_squares
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
    """Minimise the largest magnitude of the residuals by successive linear programmes.

    Each minimises the largest magnitude of the linearised residuals within a step that is
    widened where the linearisation predicts well and narrowed where it does not (Osborne and
    Watson 1969, with a trust region).
    """
    span = problem.high - problem.low
    point, radius = start, FIRST_RADIUS
    residuals = _residuals(problem, point[None, :])[0]
    for _ in range(MAX_PROGRAMMES):
        slopes = _jacobian(problem, point) * span
        unit = (point - problem.low) / span
        step, promised = _linear_programme(residuals, slopes, unit, radius)
        largest = np.abs(residuals).max()
        if not promised < largest * (1 - precision) or radius < LAST_RADIUS:
            break
        candidate = problem.low + np.clip(unit + step, 0, 1) * span
        reached = _residuals(problem, candidate[None, :])[0]
        share = (largest - np.abs(reached).max()) / (largest - promised)
        if share > 0:
            point, residuals = candidate, reached
        radius *= 2.0 if share > 0.75 else 0.25 if share < 0.25 else 1.0
    return point


def _linear_programme(
    residuals: FloatArray, slopes: FloatArray, unit: FloatArray, radius: float
) -> tuple[FloatArray, float]:
    """Minimise max|residuals + slopes·step| over |step| ≤ radius, 0 ≤ unit + step ≤ 1.

    Returns the step and the largest magnitude that it promises.
    """
    minus_t = -np.ones((residuals.size, 1))
    bounds = np.column_stack([np.maximum(-radius, -unit), np.minimum(radius, 1 - unit)])
    found = linprog(
        np.append(np.zeros(unit.size), 1.0),
        A_ub=np.block([[slopes, minus_t], [-slopes, minus_t]]),
        b_ub=np.concatenate([-residuals, residuals]),
        bounds=[*bounds, (0.0, None)],
    )
    if found.x is None:  # numerically infeasible: no step is better than none
        return np.zeros(unit.size), float(np.abs(residuals).max())
    return as_floats(found.x[:-1]), float(found.x[-1])


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
