"""Minimax fits: the parameters whose largest residual is smallest."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import linprog

from cylcontact.arrays import FloatArray, as_floats

# Step of the central differences, relative to the interval between the bounds.
DIFFERENCE = 1e-6
# Trust region of the descent, relative to the same interval, and its longest run.
FIRST_RADIUS, LAST_RADIUS = 0.05, 1e-9
MAX_PROGRAMMES = 200

# From points, shape (P, k), to their residuals, shape (P, q), all of them finite.
Residuals = Callable[[FloatArray], FloatArray]


def minimise_largest(
    residuals: Residuals,
    low: FloatArray,
    high: FloatArray,
    start: FloatArray,
    precision: float = 1e-14,
) -> FloatArray:
    """Minimise the largest magnitude of the residuals by successive linear programmes.

    Each minimises the largest magnitude of the linearised residuals within a step that is
    widened where the linearisation predicts well and narrowed where it does not (Osborne and
    Watson 1969, with a trust region).

    Parameters
    ----------
    residuals : callable
        From points, shape (P, k), to residuals, shape (P, q).
    low, high : array of float, shape (k,)
        The bounds of the parameters.
    start : array of float, shape (k,)
        Within them.
    precision : float
        Relative gain of the largest residual below which the descent ends.

    Returns
    -------
    array of float, shape (k,)
        A local minimum; the start if nothing better was found.

    Examples
    --------
    The straight line nearest to a parabola from 0 to 1 misses it by 1/8:

    >>> x = np.linspace(0, 1, 101)
    >>> low, high = np.array([-5.0, -5.0]), np.array([5.0, 5.0])
    >>> line = minimise_largest(
    ...     lambda points: points[:, :1] + points[:, 1:] * x - x**2, low, high, np.zeros(2)
    ... )
    >>> print(line.round(6))
    [-0.125  1.   ]
    """
    span = high - low
    point, radius = start, FIRST_RADIUS
    reached = residuals(point[None, :])[0]
    for _ in range(MAX_PROGRAMMES):
        slopes = central_differences(residuals, low, high, point) * span
        unit = (point - low) / span
        step, promised = _linear_programme(reached, slopes, unit, radius)
        largest = np.abs(reached).max()
        if not promised < largest * (1 - precision) or radius < LAST_RADIUS:
            break
        candidate = low + np.clip(unit + step, 0, 1) * span
        tried = residuals(candidate[None, :])[0]
        share = (largest - np.abs(tried).max()) / (largest - promised)
        if share > 0:
            point, reached = candidate, tried
        radius *= 2.0 if share > 0.75 else 0.25 if share < 0.25 else 1.0
    return point


def central_differences(
    residuals: Residuals, low: FloatArray, high: FloatArray, point: FloatArray
) -> FloatArray:
    """Return the derivatives of the residuals at one point, shape (q, k).

    All of them come from one call of `residuals`.
    """
    steps = np.diag(DIFFERENCE * (high - low))
    ahead, behind = np.split(residuals(np.vstack([point + steps, point - steps])), 2)
    return as_floats(((ahead - behind) / (2 * steps.diagonal())[:, None]).T)


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
