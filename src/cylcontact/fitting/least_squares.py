"""Deterministic least squares from several starts, for fits to measurements."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares

from cylcontact.arrays import BoolArray, FloatArray, as_floats
from cylcontact.fitting.problem import Problem

__all__ = ["descend", "jacobian", "starting_points"]

# Points evaluated for each start chosen.
_POINTS_PER_START = 32
# Steps of central differences relative to a parameter, or to its interval if it is near 0.
_RELATIVE_STEP, _INTERVAL_STEP = 6e-6, 1e-9
_MAX_RESTARTS = 10
# A restart that gains less than this, relatively, ends the descent.
_MIN_GAIN = 1e-12
_PRECISION = 1e-15
# A parameter is searched by its logarithm if its bounds have more than this ratio.
_WIDE = 100.0


def starting_points(
    problem: Problem, nominal: FloatArray | None, number: int, seed: int
) -> FloatArray:
    """Return points to start from, shape (number or fewer, k).

    The first is the nominal one; the others are the best of many drawn between the bounds.

    Parameters
    ----------
    problem : Problem
        The problem.
    nominal : array of float, shape (k,), or None
        The nominal values of the free parameters, if all have one.
    number : int
        Number of points.
    seed : int
        Seed of the random numbers.
    """
    unit = np.random.default_rng(seed).uniform(size=(_POINTS_PER_START * number, len(problem.free)))
    points = _between(problem, np.vstack([np.full(len(problem.free), 0.5), unit]))
    if nominal is not None:
        points = np.vstack([np.clip(nominal, problem.low, problem.high), points])
    values = problem.values(points)
    first = [] if nominal is None or not np.isfinite(values[0]) else [0]
    order = [k for k in np.argsort(values, kind="stable") if np.isfinite(values[k])]
    chosen = [*first, *(k for k in order if k not in first)][:number]
    return np.asarray(points[chosen])


def descend(
    problem: Problem, start: FloatArray, most: int = _MAX_RESTARTS
) -> tuple[FloatArray, float, int]:
    """Minimise the sum of squares within the bounds.

    Parameters
    ----------
    problem : Problem
        The problem.
    start : array of float, shape (k,)
        A point where the law is defined.
    most : int
        Descents, each from the end of the one before, until one gains nothing.

    Returns
    -------
    point : array of float, shape (k,)
        The minimum; the start if nothing better was found.
    value : float
        The objective there.
    evaluations : int
        Candidates evaluated.
    """
    point, value, evaluations = start, problem.value(start), 1
    if point.size == 0 or not np.isfinite(value):
        return point, value, evaluations
    for _ in range(most):
        candidate, spent = _descend_once(problem, point)
        reached = problem.value(candidate)
        evaluations += spent + 1
        is_worthwhile = reached < value * (1 - _MIN_GAIN)
        if reached < value:
            point, value = candidate, reached
        if not is_worthwhile:
            break
    return point, value, evaluations


def jacobian(
    problem: Problem, point: FloatArray, evaluate: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """Return derivatives by the free parameters, from central differences, shape (N, k).

    At a bound, beyond which a law may be undefined, the differences are one-sided.

    Parameters
    ----------
    problem : Problem
        The bounds set the steps.
    point : array of float, shape (k,)
        The point.
    evaluate : callable
        From points of the free parameters, shape (P, k), to values, shape (P, N).
    """
    reach = np.maximum(
        np.abs(point), _INTERVAL_STEP / _RELATIVE_STEP * (problem.high - problem.low)
    )
    steps = _RELATIVE_STEP * reach
    high = np.minimum(point + steps, np.maximum(problem.high, point))
    low = np.maximum(point - steps, np.minimum(problem.low, point))
    moved = np.vstack([point + np.diag(high - point), point + np.diag(low - point)])
    ahead, behind = np.split(evaluate(moved), 2)
    with np.errstate(invalid="ignore"):
        slopes = (ahead - behind) / (high - low)[:, None]
    return as_floats(np.nan_to_num(slopes, nan=0.0, posinf=0.0, neginf=0.0).T)


def _descend_once(problem: Problem, start: FloatArray) -> tuple[FloatArray, int]:
    """Run scipy's trust-region method once."""
    span = problem.high - problem.low
    margin = 1e-12 * span
    spent = 0

    def residuals(point: FloatArray) -> FloatArray:
        nonlocal spent
        spent += 1
        return as_floats(problem.finite_residuals(point[None, :])[0])

    def slopes(point: FloatArray) -> FloatArray:
        nonlocal spent
        spent += 2 * point.size
        return jacobian(problem, point, problem.residuals)

    solution = least_squares(
        residuals,
        np.clip(start, problem.low + margin, problem.high - margin),
        jac=slopes,
        bounds=(problem.low, problem.high),
        x_scale=np.maximum(np.abs(start), 1e-3 * span),
        xtol=_PRECISION,
        ftol=_PRECISION,
        gtol=_PRECISION,
        max_nfev=200,
    )
    return np.asarray(solution.x), spent


def _between(problem: Problem, unit: FloatArray) -> FloatArray:
    """Scale points from [0, 1] to the bounds, logarithmically where these are wide apart."""
    low, high = problem.low, problem.high
    wide: BoolArray = (low > 0) & (high > _WIDE * np.where(low > 0, low, 1.0))
    safe_low, safe_high = np.where(wide, low, 1.0), np.where(wide, high, 1.0)
    logarithmic = safe_low * (safe_high / safe_low) ** unit
    return as_floats(np.where(wide, logarithmic, low + unit * (high - low)))
