"""Polish: descend to the minimum of the basin that a search ended in, and look for a lower one.

One descent serves all: an interior Levenberg-Marquardt iteration on a batch of candidates at once,
with the scaling of Coleman and Li (1996) at the bounds and the damping of Nielsen (1999). A largest
residual is minimised by linear programmes instead.

A law with a maximum, such as Y with its two branches, has a minimum for each way of dividing the
clearances between them, and a branch that serves none stays out of use. So the maximum is first
smoothed, which gives both branches a gradient, and sharpened in steps.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cylcontact.fitting.objectives import (
    Largest,
    PowerForm,
    RmsLogPenetration,
    RootMeanSquare,
    least_largest,
)
from cylcontact.fitting.problem import ParameterSpace
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats

# A restart that gains less than this, relatively, ends the polish.
_MIN_GAIN = 1e-10
_MAX_RESTARTS = 20
# Starts beside that of a search, and the numbers in their slopes, which limit the starts.
_STARTS, _SLOPES = 31, 1 << 22
# Numbers in the slopes that are formed together: they stay in the cache of a core.
_AT_ONCE = 1 << 16
# The maximum in a law is smoothed over this much, in units of Y, and then less and less.
_LADDER = (0.3, 0.15, 0.07, 0.035, 0.018, 0.009, 0.004)
# Relative gain at the end of a rough descent, as on the ladder, and of a finer one.
_ROUGH, _FINER = 1e-2, 1e-6
_ROUGH_STEPS, _STEPS = 10, 400
# Short hops to points beside the best: how many at once, their standard deviation relative to the
# bounds, and the relative gain below which they end.
_SHORT_HOPS, _SHORT_HOP, _MIN_HOP_GAIN = 16, 0.005, 1e-4
# A descent ends after so many small gains, or at this damping.
_SMALL_GAINS, _MOST_DAMPING = 3, 1e10
# The first damping, the share of the way to a bound, and the nearest to it of a start.
_FIRST_DAMPING, _WAY, _MARGIN = 1e-3, 0.995, 1e-12
# The objectives with a formula for the slopes of power laws.
_SLOPED = (RmsLogPenetration, RootMeanSquare)
# Step of the central differences, relative to the interval between the bounds.
_DIFFERENCE = 1e-6
# First and last radius of the trust region, relative to the same interval.
_FIRST_RADIUS, _LAST_RADIUS = 0.05, 1e-9
_MAX_PROGRAMMES = 200

# From points, shape (P, k), to finite residuals, shape (P, q).
_Residuals = Callable[[FloatArray], FloatArray]


def polish(
    problem: ParameterSpace, start: FloatArray, precision: float = 1e-14
) -> tuple[FloatArray, float]:
    """Return the local minimum below a point, by descents until one gains nothing, and its value.

    The coefficients are known to about the square root of the relative `precision`.
    """
    point, value = start, problem.value(start)
    for _ in range(_MAX_RESTARTS):
        (candidate,), (reached,) = descend(problem, point[None, :], precision)
        gained = reached < value * (1 - _MIN_GAIN)
        if reached < value:
            point, value = candidate, float(reached)
        if not gained:
            break
    return point, value


def minimise(problem: ParameterSpace, start: FloatArray, seed: int = 0) -> tuple[FloatArray, float]:
    """Return the lowest minimum below a point, random points and points beside it, and its value.

    Where a descent needs every sample, or a law has no formula for its slopes, there are fewer
    random points or none.
    """
    rng = np.random.default_rng(seed)
    starts = np.vstack([start, problem.scatter(rng, affordable_starts(problem))])
    starts = np.vstack([start, climb_down(problem, starts)])
    ends, values = descend(problem, starts, _FINER)
    point, value = ends[values.argmin()], values.min()
    if not np.isfinite(value) or not point.size:
        return start, float(value)
    while True:
        step = rng.normal(size=(_SHORT_HOPS, point.size)) * _SHORT_HOP
        beside = np.clip(point + step * (problem.high - problem.low), problem.low, problem.high)
        ends, values = descend(problem, beside, _FINER)
        enough = not values.min() < value * (1 - _MIN_HOP_GAIN)
        if values.min() < value:
            point, value = ends[values.argmin()], values.min()
        if enough:
            return polish(problem, point)


def affordable_starts(problem: ParameterSpace) -> int:
    """Return how many random starts a polish can afford."""
    objective = problem.objective
    if problem.model.power_form is None or not isinstance(objective, _SLOPED):
        return 0
    return min(_STARTS, _SLOPES // (len(problem.free) * objective.size))


def climb_down(
    problem: ParameterSpace, points: FloatArray, held: BoolArray | None = None
) -> FloatArray:
    """Return the ends of P points on the ladder of smoothed maxima, if the law has one."""
    is_sloped = problem.model.smooth_form and isinstance(problem.objective, _SLOPED)
    for smooth in _LADDER if is_sloped else ():
        points = _descend_squares(problem, points, _ROUGH, held, smooth, _ROUGH_STEPS)
    return points


def descend(
    problem: ParameterSpace, starts: FloatArray, precision: float, held: BoolArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return the ends of descents from P points, shape (P, k), and their objectives.

    A descent ends when it gains less than `precision`, relatively, and no higher than it began.
    What is `held`, of the same shape, stays as it is.
    """
    held = np.zeros(starts.shape, dtype=bool) if held is None else held
    before = problem.values(starts)
    if held.all() or not np.isfinite(before).any():
        return starts, before
    if isinstance(problem.objective, Largest):
        each = zip(starts, held, strict=True)
        ends = np.array([_descend_largest(problem, *both, precision) for both in each])
    else:
        ends = _descend_squares(problem, starts, precision, held)
    after = problem.values(ends)
    lower = after < before
    return np.where(lower[:, None], ends, starts), np.where(lower, after, before)


def _descend_squares(
    problem: ParameterSpace,
    starts: FloatArray,
    precision: float,
    held: BoolArray | None,
    smooth: float = 0.0,
    most_steps: int = _STEPS,
) -> FloatArray:
    """Minimise sums of squares within the bounds.

    In coordinates t from 0 to 1, with residuals r, slopes J, A = JᵀJ, g = Jᵀr and v the distance to
    the bound that −g points to, a step solves

        (A + diag(|g|/v) + λ·(tr A/k)·diag(1/v))·step = −g.

    What is held has no slopes, and so no step.
    """
    low, span = problem.low, problem.high - problem.low
    fixed = np.zeros(starts.shape, dtype=bool) if held is None else held
    ends = (starts - low) / span
    ends = np.where(fixed, ends, np.clip(ends, _MARGIN, 1 - _MARGIN))
    here, t, free = np.arange(len(ends)), ends, 1.0 - fixed

    def expanded(t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return r², A and g."""
        cost, A, g = _normal_equations(problem, low + t * span, smooth)
        return cost, A * free[:, :, None] * free[:, None, :], g * free

    cost, A, g = expanded(t)
    damping, growth = np.full(here.size, _FIRST_DAMPING), np.full(here.size, 2.0)
    small = np.zeros(here.size)
    eye = np.eye(low.size)
    for _ in range(most_steps):
        on = (small < _SMALL_GAINS) & (damping < _MOST_DAMPING) & np.isfinite(cost)
        if not on.all():
            ends[here[~on]] = t[~on]
            here, t, cost, A, g, free = here[on], t[on], cost[on], A[on], g[on], free[on]
            damping, growth, small = damping[on], growth[on], small[on]
            if not here.size:
                break
        # In the unknowns step/√v the matrix is well conditioned up to the bounds.
        root = np.sqrt(np.where(g < 0, 1 - t, np.where(g > 0, t, 1.0)))
        scale = damping * np.trace(A, axis1=1, axis2=2) / low.size + np.finfo(float).tiny
        matrix = root[:, :, None] * A * root[:, None, :]
        matrix += eye * (np.abs(g) + scale[:, None])[:, None, :]
        step = root * np.linalg.solve(matrix, -(root * g)[..., None])[..., 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(step > 0, (1 - t) / step, np.where(step < 0, -t / step, np.inf))
        step *= np.minimum(1, _WAY * room.min(axis=1))[:, None]
        candidate = t + step
        reached, A_there, g_there = expanded(candidate)
        predicted = -(2 * g * step).sum(axis=1) - (step * (A @ step[..., None])[..., 0]).sum(axis=1)
        gain = cost - reached
        better = gain > 0
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            cubed = (2 * gain / predicted - 1) ** 3
        damping *= np.where(better, np.maximum(1 / 3, 1 - np.fmax(cubed, -1)), growth)
        growth = np.where(better, 2.0, 2 * growth)
        small = np.where(better, np.where(gain < precision * cost, small + 1, 0), small)
        t, cost = np.where(better[:, None], candidate, t), np.where(better, reached, cost)
        A = np.where(better[:, None, None], A_there, A)
        g = np.where(better[:, None], g_there, g)
    ends[here] = t
    return np.where(fixed, starts, low + ends * span)


def _normal_equations(
    problem: ParameterSpace, points: FloatArray, smooth: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the sum of squares, JᵀJ and Jᵀr at P points, in coordinates from 0 to 1."""
    objective = problem.objective
    size = len(problem.free) * objective.size if isinstance(objective, _SLOPED) else 1
    at_once = max(1, _AT_ONCE // size)
    if len(points) > at_once:
        parts = [
            _normal_equations(problem, points[first : first + at_once], smooth)
            for first in range(0, len(points), at_once)
        ]
        cost, A, g = (np.concatenate(each) for each in zip(*parts, strict=True))
        return cost, A, g
    residuals, slopes = _linearised(problem, points, smooth)
    span = problem.high - problem.low
    with np.errstate(all="ignore"):
        g = span * (slopes @ residuals[..., None])[..., 0]
        A = span[:, None] * (slopes @ slopes.transpose(0, 2, 1)) * span
        cost = (residuals**2).sum(axis=1)
    return np.where(np.isfinite(cost + A.sum(axis=(1, 2))), cost, np.inf), A, g


def _linearised(
    problem: ParameterSpace, points: FloatArray, smooth: float
) -> tuple[FloatArray, FloatArray]:
    """Return the residuals of P points and their derivatives, shapes (P, q) and (P, k, q)."""
    form_of_law, objective = problem.model.smooth_form, problem.objective
    if form_of_law is None or not isinstance(objective, _SLOPED):
        residuals, low, high = problem.finite_residuals, problem.low, problem.high
        return residuals(points), central_differences(residuals, low, high, points)
    with np.errstate(all="ignore"):
        log_K, n, *by_all = form_of_law(problem.complete(points), objective.dR, smooth)
        form = PowerForm(np.log(objective.dR) - log_K, np.where(n > 0, n, np.nan))
        slopes = objective.slopes(form, *(_by_free(problem, points, each) for each in by_all))
        return objective.residuals(form), slopes


def _by_free(problem: ParameterSpace, points: FloatArray, slopes: FloatArray) -> FloatArray:
    """Return derivatives by the free parameters from those by all, shape (P, all, m)."""
    if any(p.tie for p in problem.parameters):
        ties = central_differences(problem.complete, problem.low, problem.high, points)
        return as_floats(ties @ slopes)
    if len(problem.free) == len(problem.parameters):
        return slopes
    return slopes[:, [p.is_free for p in problem.parameters]]


def central_differences(
    residuals: _Residuals, low: FloatArray, high: FloatArray, points: FloatArray
) -> FloatArray:
    """Return the derivatives of the residuals at P points, shape (P, k, q).

    `residuals` is called once. At a bound the differences are one-sided.
    """
    steps = np.diag(_DIFFERENCE * (high - low))
    ahead = np.minimum(points[:, None] + steps, high)
    behind = np.maximum(points[:, None] - steps, low)
    moved = np.concatenate([ahead, behind]).reshape(-1, low.size)
    there = residuals(moved).reshape(2, *ahead.shape[:2], -1)
    width = np.diagonal(ahead - behind, axis1=1, axis2=2)
    return as_floats((there[0] - there[1]) / width[..., None])


def _descend_largest(
    problem: ParameterSpace, start: FloatArray, held: BoolArray, precision: float
) -> FloatArray:
    free = ~held

    def residuals(points: FloatArray) -> FloatArray:
        whole = np.tile(start, (len(points), 1))
        whole[:, free] = points
        return problem.finite_residuals(whole)

    end = start.copy()
    end[free] = minimise_largest(
        residuals, problem.low[free], problem.high[free], start[free], precision
    )
    return end


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
        slopes = central_differences(residuals, low, high, point[None, :])[0].T * span
        unit = (point - low) / span
        ends = np.maximum(-radius, -unit), np.minimum(radius, 1 - unit)
        step, predicted = least_largest(reached, slopes, list(zip(*ends, strict=True)))
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
