"""Polish: descend to the minimum of the basin that a search ended in, and try other basins.

A sum of squares is minimised by least squares, a largest residual by linear programmes.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import cycle

import numpy as np
from scipy.optimize import least_squares, linprog

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.objectives import Largest
from cylcontact.fitting.problem import Problem

__all__ = [
    "central_differences",
    "minimise_largest",
    "polish",
    "polish_across_basins",
    "polish_across_kinks",
]

# A restart that gains less than this, relatively, ends the polish.
_MIN_GAIN = 1e-10
_MAX_RESTARTS = 20
# Short hops to points beside a minimum.
_SHORT_HOPS = 12
# The hops to other basins end when so many in a row gained nothing, or less than this, relatively.
_PATIENCE, _MIN_HOP_GAIN = 72, 1e-4
# Standard deviations relative to the bounds: of a hop across a kink, and, as powers of ten, of
# each coefficient in a hop to another basin.
_SHORT_HOP, _LONG_HOP_DECADES = 0.005, (-3.0, -0.3)
# A hop is followed by a rough descent, and by a finer one if that ends this near the best.
_ROUGH, _FINER, _NEAR = 1e-4, 1e-7, 1.1
# Step of the central differences, relative to the interval between the bounds.
_DIFFERENCE = 1e-6
# First and last radius of the trust region, relative to the same interval.
_FIRST_RADIUS, _LAST_RADIUS = 0.05, 1e-9
_MAX_PROGRAMMES = 200

# From points, shape (P, k), to finite residuals, shape (P, q).
_Residuals = Callable[[FloatArray], FloatArray]


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
    point, value = start, problem.value(start)
    if point.size == 0 or not np.isfinite(value):
        return point, value
    for _ in range(_MAX_RESTARTS):
        candidate, reached = _descended(problem, point, precision)
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
    rng = np.random.default_rng(0)  # the same hops for every run: only the search is random
    for _ in range(_SHORT_HOPS):
        candidate, reached = polish(problem, _beside(problem, point, rng))
        if reached < value * (1 - _MIN_GAIN):
            point, value = candidate, reached
    return point, value


def polish_across_basins(
    problem: Problem, start: FloatArray, seed: int
) -> tuple[FloatArray, float]:
    """Descend to a local minimum, hop on from it and descend again, and return the lowest.

    Parameters
    ----------
    problem : Problem
        What to minimise.
    start : array of float, shape (k,)
        Free parameters within their bounds.
    seed : int
        Of the hops.

    Returns
    -------
    point : array of float, shape (k,)
        The lowest minimum found.
    value : float
        Its objective.

    Notes
    -----
    Y is the larger of two branches. Each way of dividing the clearances of the grid between them
    has a minimum of its own, and one branch may serve a single clearance or none. Hops in turn
    start anywhere, move each coefficient by a step of its own size, and move all a little, to
    where the branches meet between other clearances. This is basin hopping (Wales and Doye 1997)
    that only ever goes down.
    """
    value = problem.value(start)
    if start.size == 0 or not np.isfinite(value):
        return start, value
    point, value = _descended(problem, start, _FINER)
    rng = np.random.default_rng(seed)
    hops = 0  # in a row that gained nothing
    for hop in cycle((_anywhere, _far, _beside)):
        if hops == _PATIENCE:
            break
        hops += 1
        candidate, reached = _descended(problem, hop(problem, point, rng), _ROUGH)
        if reached < _NEAR * value:
            candidate, reached = _descended(problem, candidate, _FINER)
        if reached < value:
            hops = 0 if reached < value * (1 - _MIN_HOP_GAIN) else hops
            point, value = candidate, reached
    return polish(problem, point)


def _anywhere(problem: Problem, _: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return a point anywhere between the bounds."""
    return rng.uniform(problem.low, problem.high)


def _far(problem: Problem, point: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return a point that differs in each coefficient on a scale of its own."""
    return _moved(problem, point, rng, 10 ** rng.uniform(*_LONG_HOP_DECADES, point.size))


def _beside(problem: Problem, point: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return a point far enough away to cross a kink, near enough to stay in the basin."""
    return _moved(problem, point, rng, np.full(point.size, _SHORT_HOP))


def _moved(
    problem: Problem, point: FloatArray, rng: np.random.Generator, scale: FloatArray
) -> FloatArray:
    """Return a point moved by normal steps of these scales, within the bounds."""
    step = rng.normal(size=point.size) * scale * (problem.high - problem.low)
    return as_floats(np.clip(point + step, problem.low, problem.high))


def _descended(problem: Problem, start: FloatArray, precision: float) -> tuple[FloatArray, float]:
    """Descend once; return the lower of both ends, and its objective."""
    value = problem.value(start)
    if not np.isfinite(value):
        return start, value
    candidate = _descend(problem, start, precision)
    reached = problem.value(candidate)
    return (candidate, reached) if reached < value else (start, value)


def _descend(problem: Problem, start: FloatArray, precision: float) -> FloatArray:
    """Minimise the objective by the method for its kind."""
    descend = _descend_largest if isinstance(problem.objective, Largest) else _descend_squares
    return descend(problem, start, precision)


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


def minimise_largest(
    residuals: _Residuals,
    low: FloatArray,
    high: FloatArray,
    start: FloatArray,
    precision: float = 1e-14,
) -> FloatArray:
    """Minimise the largest magnitude of the residuals by successive linear programmes.

    Each programme minimises the largest magnitude of the linearised residuals within a trust
    region (Osborne and Watson 1969).

    Parameters
    ----------
    residuals : callable
        From points, shape (P, k), to residuals, shape (P, q).
    low, high : array of float, shape (k,)
        The bounds of the parameters.
    start : array of float, shape (k,)
        A point within the bounds.
    precision : float
        Relative gain of the largest residual below which the descent ends.

    Returns
    -------
    array of float, shape (k,)
        A local minimum; the start if nothing better was found.

    Examples
    --------
    The best straight line through a parabola from 0 to 1 has an error of 1/8:

    >>> x = np.linspace(0, 1, 101)
    >>> low, high = np.array([-5.0, -5.0]), np.array([5.0, 5.0])
    >>> line = minimise_largest(
    ...     lambda points: points[:, :1] + points[:, 1:] * x - x**2, low, high, np.zeros(2)
    ... )
    >>> print(line.round(6))
    [-0.125  1.   ]
    """
    span = high - low
    point, radius = start, _FIRST_RADIUS
    reached = residuals(point[None, :])[0]
    for _ in range(_MAX_PROGRAMMES):
        slopes = central_differences(residuals, low, high, point) * span
        unit = (point - low) / span
        step, predicted = _linear_programme(reached, slopes, unit, radius)
        largest = np.abs(reached).max()
        if not predicted < largest * (1 - precision) or radius < _LAST_RADIUS:
            break
        candidate = low + np.clip(unit + step, 0, 1) * span
        trial = residuals(candidate[None, :])[0]
        share = (largest - np.abs(trial).max()) / (largest - predicted)
        if share > 0:
            point, reached = candidate, trial
        radius *= 2.0 if share > 0.75 else 0.25 if share < 0.25 else 1.0
    return point


def central_differences(
    residuals: _Residuals, low: FloatArray, high: FloatArray, point: FloatArray
) -> FloatArray:
    """Return the derivatives of the residuals at one point, shape (q, k).

    `residuals` is called once.
    """
    steps = np.diag(_DIFFERENCE * (high - low))
    ahead, behind = np.split(residuals(np.vstack([point + steps, point - steps])), 2)
    return as_floats(((ahead - behind) / (2 * steps.diagonal())[:, None]).T)


def _linear_programme(
    residuals: FloatArray, slopes: FloatArray, unit: FloatArray, radius: float
) -> tuple[FloatArray, float]:
    """Minimise max|residuals + slopes·step| over |step| ≤ radius, 0 ≤ unit + step ≤ 1.

    Return the step and the largest magnitude predicted for it.
    """
    minus_t = -np.ones((residuals.size, 1))
    bounds = np.column_stack([np.maximum(-radius, -unit), np.minimum(radius, 1 - unit)])
    solution = linprog(
        np.append(np.zeros(unit.size), 1.0),
        A_ub=np.block([[slopes, minus_t], [-slopes, minus_t]]),
        b_ub=np.concatenate([-residuals, residuals]),
        bounds=[*bounds, (0.0, None)],
    )
    if solution.x is None:  # numerically infeasible
        return np.zeros(unit.size), float(np.abs(residuals).max())
    return as_floats(solution.x[:-1]), float(solution.x[-1])
