"""Deterministic least squares from several starts: what fits to measurements are made with."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares

from cylcontact.arrays import BoolArray, FloatArray, as_floats
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.run import RunRecord

# Points tried for each start that is taken.
TRIED_PER_START = 32
# Steps of central differences relative to a parameter, or to its interval where it is near 0.
RELATIVE_STEP, INTERVAL_STEP = 6e-6, 1e-9
MAX_RESTARTS = 10
WORTHWHILE = 1e-12
PRECISION = 1e-15
# A parameter whose bounds are this far apart is searched by its logarithm.
DECADES = 100.0
UNDEFINED = 1e3


def starting_points(
    problem: Problem, nominal: FloatArray | None, number: int, seed: int
) -> FloatArray:
    """Return points to start from, shape (number or fewer, k).

    The nominal one first, then the best of many drawn between the bounds.

    Parameters
    ----------
    problem : Problem
        What is minimised.
    nominal : array of float, shape (k,), or None
        A point known to make sense.
    number : int
        How many to return.
    seed : int
        Of the draw.
    """
    unit = np.random.default_rng(seed).uniform(size=(TRIED_PER_START * number, len(problem.free)))
    points = _between(problem, np.vstack([np.full(len(problem.free), 0.5), unit]))
    if nominal is not None:
        points = np.vstack([np.clip(nominal, problem.low, problem.high), points])
    values = problem.values(points)
    first = [] if nominal is None or not np.isfinite(values[0]) else [0]
    order = [k for k in np.argsort(values, kind="stable") if np.isfinite(values[k])]
    chosen = [*first, *(k for k in order if k not in first)][:number]
    return np.asarray(points[chosen])


def run_from(problem: Problem, start: FloatArray, index: int, seed: int) -> RunRecord:
    """Descend from one start, and record it as a run."""
    began = time.perf_counter()
    before = problem.value(start)
    point, value, evaluations = descend(problem, start)
    return RunRecord(
        index=index,
        seed=seed,
        population=1,
        crossover=None,
        objective_before_polish=before,
        objective=value,
        coefficients=problem.coefficients(point),
        evaluations=evaluations,
        seconds=round(time.perf_counter() - began, 3),
    )


def descend(problem: Problem, start: FloatArray) -> tuple[FloatArray, float, int]:
    """Minimise the sum of squares within the bounds.

    Parameters
    ----------
    problem : Problem
        What is minimised.
    start : array of float, shape (k,)
        Where the law is defined.

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
    for _ in range(MAX_RESTARTS):
        candidate, spent = _descend_once(problem, point)
        reached = problem.value(candidate)
        evaluations += spent + 1
        gained = reached < value * (1 - WORTHWHILE)
        if reached < value:
            point, value = candidate, reached
        if not gained:
            break
    return point, value, evaluations


def jacobian(
    problem: Problem, point: FloatArray, evaluate: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """Return the derivatives of what is evaluated by the free parameters, shape (N, k).

    Parameters
    ----------
    problem : Problem
        Its bounds give the size of the steps.
    point : array of float, shape (k,)
        Where.
    evaluate : callable
        From points of the free parameters, shape (P, k), to values, shape (P, N).
    """
    reach = np.maximum(np.abs(point), INTERVAL_STEP / RELATIVE_STEP * (problem.high - problem.low))
    steps = np.diag(RELATIVE_STEP * reach)
    ahead, behind = np.split(evaluate(np.vstack([point + steps, point - steps])), 2)
    with np.errstate(invalid="ignore"):
        slopes = (ahead - behind) / (2 * steps.diagonal())[:, None]
    return as_floats(np.nan_to_num(slopes, nan=0.0, posinf=0.0, neginf=0.0).T)


def _descend_once(problem: Problem, start: FloatArray) -> tuple[FloatArray, int]:
    """Run scipy's trust-region method once."""
    span = problem.high - problem.low
    margin = 1e-12 * span
    spent = 0

    def residuals(point: FloatArray) -> FloatArray:
        nonlocal spent
        spent += 1
        found = problem.residuals(point[None, :])[0]
        return as_floats(np.nan_to_num(found, nan=UNDEFINED, posinf=UNDEFINED, neginf=-UNDEFINED))

    def slopes(point: FloatArray) -> FloatArray:
        nonlocal spent
        spent += 2 * point.size
        return jacobian(problem, point, problem.residuals)

    found = least_squares(
        residuals,
        np.clip(start, problem.low + margin, problem.high - margin),
        jac=slopes,
        bounds=(problem.low, problem.high),
        x_scale=np.maximum(np.abs(start), 1e-3 * span),
        xtol=PRECISION,
        ftol=PRECISION,
        gtol=PRECISION,
        max_nfev=200,
    )
    return np.asarray(found.x), spent


def _between(problem: Problem, unit: FloatArray) -> FloatArray:
    """Return points between the bounds from shares of 0 to 1, on a log scale where it is wide."""
    low, high = problem.low, problem.high
    wide: BoolArray = (low > 0) & (high > DECADES * np.where(low > 0, low, 1.0))
    safe_low, safe_high = np.where(wide, low, 1.0), np.where(wide, high, 1.0)
    logarithmic = safe_low * (safe_high / safe_low) ** unit
    return as_floats(np.where(wide, logarithmic, low + unit * (high - low)))
