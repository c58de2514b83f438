"""Local polish: descend to the minimum of the basin that a search ended in."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.minimax import central_differences, minimise_largest
from cylcontact.fitting.objectives import Largest
from cylcontact.fitting.problem import Problem

__all__ = ["polish", "polish_across_kinks"]

# A restart that gains less than this, relatively, ends the polish.
_MIN_GAIN = 1e-10
_MAX_RESTARTS = 20
# Number of restarts from beside the minimum, and their distance relative to the bounds: far
# enough to cross a kink, near enough to stay in the basin.
_HOPS, _HOP = 12, 0.005


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
    iteration can stop early. It is restarted until that gains nothing.
    """
    descend = _descend_largest if isinstance(problem.objective, Largest) else _descend_squares
    point, value = start, problem.value(start)
    if point.size == 0 or not np.isfinite(value):
        return point, value
    for _ in range(_MAX_RESTARTS):
        candidate = descend(problem, point, precision)
        reached = problem.value(candidate)
        if not reached < value * (1 - _MIN_GAIN):
            break
        point, value = candidate, reached
    return point, value


def polish_across_kinks(problem: Problem, start: FloatArray) -> tuple[FloatArray, float]:
    """Descend to a local minimum, then from points beside it, and return the lowest.

    Y's two branches meet between two clearances of the grid, and each such pair has a minimum of
    its own, a few hundredths of a percent apart. A descent ends in the nearest; short hops reach
    the lowest.

    Parameters
    ----------
    problem : Problem
        What to minimise.
    start : array of float, shape (k,)
        Free parameters within their bounds.

    Returns
    -------
    point : array of float, shape (k,)
        The lowest minimum found.
    value : float
        Its objective.
    """
    point, value = polish(problem, start)
    if point.size == 0 or not np.isfinite(value):
        return point, value
    span = problem.high - problem.low
    # The same hops for every run: only the search is random.
    for hop in np.random.default_rng(0).normal(scale=_HOP, size=(_HOPS, point.size)):
        beside = np.clip(point + hop * span, problem.low, problem.high)
        candidate, reached = polish(problem, beside)
        if reached < value * (1 - _MIN_GAIN):
            point, value = candidate, reached
    return point, value


def _descend_squares(problem: Problem, start: FloatArray, precision: float) -> FloatArray:
    """Minimise a sum of squares within the bounds."""
    span = problem.high - problem.low
    margin = 1e-12 * span

    def residuals(point: FloatArray) -> FloatArray:
        return as_floats(problem.finite_residuals(point[None, :])[0])

    def jacobian(point: FloatArray) -> FloatArray:
        return central_differences(problem.finite_residuals, problem.low, problem.high, point)

    solution = least_squares(
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
    return np.asarray(solution.x)


def _descend_largest(problem: Problem, start: FloatArray, precision: float) -> FloatArray:
    """Minimise the largest magnitude of the residuals within the bounds."""
    return minimise_largest(problem.finite_residuals, problem.low, problem.high, start, precision)
