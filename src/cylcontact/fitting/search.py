"""The search: PyGAD for the region of the optimum, descents from many points for its minimum.

A descent is an interior Levenberg-Marquardt iteration on a batch of points at once, with the
scaling of Coleman and Li (1996) at the bounds and the damping of Nielsen (1999). A largest residual
is minimised by linear programmes within a trust region instead (Osborne and Watson 1969).

A law with a maximum, such as Y with its two branches, has a minimum for each way of dividing the
clearances between them, and a branch that serves none stays out of use. So the maximum is first
smoothed, which gives both branches a gradient, and sharpened in steps.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from cylcontact.fitting.space import Space
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats

CROSSOVERS = ("single_point", "two_points", "uniform", "scattered", "blend")
# The best of a generation that are kept, the share of genes that mutate, and the powers of ten
# between which the size of their steps is drawn.
_ELITE, _MUTATED, _STEP_DECADES = 2, 0.2, (-3.0, -0.5)
# The fitness of an undefined law; PyGAD refuses NaN.
_WORST_FITNESS = -1e300

# Relative gain at the end of a rough descent, as with a smoothed maximum, of a fine and an exact
# one; and the most steps of a rough one and of the others.
_ROUGH, _FINE, EXACT = 1e-2, 1e-6, 1e-14
_ROUGH_STEPS, _STEPS = 10, 400
# Points beside the best from which it is tried to go lower: how many at once, their standard
# deviation relative to the bounds, drawn between two, and after how many rounds in turn without a
# relative gain they end.
_BESIDE, _HOPS, _ROUNDS, _MIN_ROUND_GAIN = 16, (5e-4, 0.05), 2, 1e-8
# A restart that gains less than this, relatively, is the last.
_MIN_GAIN, _MOST_RESTARTS = 1e-10, 20
# A descent ends after so many small gains, or at this damping.
_SMALL_GAINS, _MOST_DAMPING = 3, 1e10
# The first damping, the share of the way to a bound, and the nearest to it of a start.
_FIRST_DAMPING, _WAY, _MARGIN = 1e-3, 0.995, 1e-12
# The nearest to a bound of a start of SciPy's, and the relative move at which its descents end.
_INSIDE, _LEAST_MOVE = 1e-9, 1e-13
# Numbers in slopes that are formed together: they stay in the cache of a core.
_AT_ONCE = 1 << 16
# First and last radius of the trust region relative to the bounds, and the most programmes.
_FIRST_RADIUS, _LAST_RADIUS, _MOST_PROGRAMMES = 0.05, 1e-9, 200


class Minimum(NamedTuple):
    """The best free parameters of a search, shape (k,), their objective, and the evaluations."""

    point: FloatArray
    value: float
    evaluations: int


def genetic_search(
    space: Space, population: int, generations: int, crossover: str, seed: int
) -> Minimum:
    """Return the best of a genetic search by PyGAD.

    Genes are the free parameters scaled to [0, 1] between their bounds. A population is evaluated
    in one call. Crossover is one of PyGAD's or blend, BLX-½ (Eshelman and Schaffer 1993); mutation
    moves genes by Gaussian steps whose size is itself drawn, from 0.1 % to 30 % of the range, so
    that one setting serves both exploring and refining.
    """
    import pygad  # slow to import

    evaluations = 0

    def fitness(_: pygad.GA, genes: FloatArray, __: Any) -> FloatArray:
        nonlocal evaluations
        evaluations += len(genes)
        values = space.values(space.low + genes * space.span)
        return np.where(np.isfinite(values), -values, _WORST_FITNESS)

    engine = pygad.GA(
        num_generations=generations,
        num_parents_mating=max(2, population // 2),
        sol_per_pop=population,
        num_genes=len(space.free),
        gene_space={"low": 0.0, "high": 1.0},
        fitness_func=fitness,
        fitness_batch_size=population,
        crossover_type=_blend if crossover == "blend" else crossover,
        mutation_type=_mutate,
        keep_elitism=min(_ELITE, population - 1),
        random_seed=seed,
        suppress_warnings=True,
    )
    engine.run()
    genes, best, _ = engine.best_solution(engine.last_generation_fitness)
    return Minimum(space.low + genes * space.span, float(-best), evaluations)


def _blend(parents: FloatArray, size: tuple[int, int], engine: Any) -> FloatArray:
    """Return offspring drawn gene by gene from the parents' interval, widened by half."""
    rng = engine.numpy_random_generator
    one, two = parents[rng.randint(len(parents), size=(2, size[0]))]
    weight = rng.uniform(-0.5, 1.5, size=size)
    return as_floats(np.clip(weight * one + (1 - weight) * two, 0, 1))


def _mutate(offspring: FloatArray, engine: Any) -> FloatArray:
    """Return offspring with some genes moved by Gaussian steps of random size."""
    rng = engine.numpy_random_generator
    hit = rng.uniform(size=offspring.shape) < _MUTATED
    step = rng.normal(size=offspring.shape) * 10 ** rng.uniform(*_STEP_DECADES, offspring.shape)
    return as_floats(np.clip(np.where(hit, offspring + step, offspring), 0, 1))


# --- descents -----------------------------------------------------------------------------------


def minimise(space: Space, start: FloatArray, seed: int = 0) -> tuple[FloatArray, float]:
    """Return the lowest minimum below a point and others, and its value.

    The others are random points, and then points beside the lowest end.
    """
    rng = np.random.default_rng(seed)
    starts = np.vstack([start, space.scatter(rng, space.random_starts)])
    ends, values = descend(space, np.vstack([start, sharpen(space, starts)]), _FINE)
    point, value = ends[values.argmin()], float(values.min())
    if not np.isfinite(value) or not point.size:
        return start, value
    # Where random starts take too long, these do as well.
    without_gain = 0 if space.random_starts else _ROUNDS
    while without_gain < _ROUNDS:
        ends, values = descend(space, beside(space, np.tile(point, (_BESIDE, 1)), rng), _FINE)
        lower = values.min() < value * (1 - _MIN_ROUND_GAIN)
        without_gain = 0 if lower else without_gain + 1
        if values.min() < value:
            point, value = ends[values.argmin()], float(values.min())
    return polish(space, point)


def beside(space: Space, points: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return a point beside each of P points, at distances of all sizes from 0.05 % to 5 %."""
    low, high = np.log10(_HOPS)
    size = 10 ** rng.uniform(low, high, size=(len(points), 1)) * space.span
    return as_floats(np.clip(points + rng.normal(size=points.shape) * size, space.low, space.high))


def polish(space: Space, start: FloatArray, precision: float = EXACT) -> tuple[FloatArray, float]:
    """Return the local minimum below a point, by descents until one gains nothing, and its value.

    The coefficients are known to about the square root of the relative `precision`.
    """
    point, value = start, space.value(start)
    for _ in range(_MOST_RESTARTS):
        (end,), (reached,) = descend(space, point[None, :], precision)
        gained = reached < value * (1 - _MIN_GAIN)
        if reached < value:
            point, value = end, float(reached)
        if not gained:
            break
    return point, value


def sharpen(space: Space, points: FloatArray, held: BoolArray | None = None) -> FloatArray:
    """Return the ends of rough descents with maxima smoothed less and less, if the law has any."""
    for smooth in space.smoothing:
        points = _descend_squares(space, points, _ROUGH, held, smooth, _ROUGH_STEPS)
    return points


def descend(
    space: Space, starts: FloatArray, precision: float = _FINE, held: BoolArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return the ends of descents from P points, shape (P, k), and their objectives.

    A descent ends when it gains less than `precision`, relatively, and no higher than it began.
    What is `held`, of the same shape, stays as it is.
    """
    held = np.zeros(starts.shape, dtype=bool) if held is None else held
    before = space.values(starts)
    if held.all() or not np.isfinite(before).any():
        return starts, before
    if space.is_largest:
        both = zip(starts, held, strict=True)
        ends = np.array([_descend_largest(space, start, own, precision) for start, own in both])
    elif space.is_ill_conditioned:
        both = zip(starts, held, strict=True)
        ends = np.array([_least_squares(space, start, own, precision) for start, own in both])
    else:
        ends = _descend_squares(space, starts, precision, held)
    after = space.values(ends)
    lower = after < before
    return np.where(lower[:, None], ends, starts), np.where(lower, after, before)


def _descend_squares(
    space: Space,
    starts: FloatArray,
    precision: float,
    held: BoolArray | None,
    smooth: float = 0.0,
    most_steps: int = _STEPS,
) -> FloatArray:
    """Minimise sums of squares within the bounds.

    In coordinates t from 0 to 1, with residuals r, slopes J, A = JᵀJ, g = Jᵀr and v the distance to
    the bound that −g points to, a step solves

        (A + diag(|g|/v) + λ·diag(c/v))·step = −g

    with c the curvatures that the space scales its damping by.

    What is held has no slopes, and so no step.
    """
    k = space.low.size
    fixed = np.zeros(starts.shape, dtype=bool) if held is None else held
    ends = (starts - space.low) / space.span
    ends = np.where(fixed, ends, np.clip(ends, _MARGIN, 1 - _MARGIN))
    here, t, free = np.arange(len(ends)), ends, 1.0 - fixed

    def expanded(t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return r², A and g."""
        cost, A, g = _normal_equations(space, space.low + t * space.span, smooth)
        return cost, A * free[:, :, None] * free[:, None, :], g * free

    cost, A, g = expanded(t)
    damping, growth = np.full(here.size, _FIRST_DAMPING), np.full(here.size, 2.0)
    small = np.zeros(here.size)
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
        scale = damping[:, None] * space.curvatures(A) + np.finfo(float).tiny
        matrix = root[:, :, None] * A * root[:, None, :]
        matrix += np.eye(k) * (np.abs(g) + scale)[:, None, :]
        step = root * np.linalg.solve(matrix, -(root * g)[..., None])[..., 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            way = np.where(step > 0, (1 - t) / step, np.where(step < 0, -t / step, np.inf))
        step *= np.minimum(1, _WAY * way.min(axis=1))[:, None]
        cost_there, A_there, g_there = expanded(t + step)
        predicted = -(2 * g * step).sum(axis=1) - (step * (A @ step[..., None])[..., 0]).sum(axis=1)
        gain = cost - cost_there
        better = gain > 0
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            cubed = (2 * gain / predicted - 1) ** 3
        damping *= np.where(better, np.maximum(1 / 3, 1 - np.fmax(cubed, -1)), growth)
        growth = np.where(better, 2.0, 2 * growth)
        small = np.where(better, np.where(gain < precision * cost, small + 1, 0), small)
        t, cost = np.where(better[:, None], t + step, t), np.where(better, cost_there, cost)
        A = np.where(better[:, None, None], A_there, A)
        g = np.where(better[:, None], g_there, g)
    ends[here] = t
    return np.where(fixed, starts, space.low + ends * space.span)


def _least_squares(
    space: Space, start: FloatArray, held: BoolArray, precision: float
) -> FloatArray:
    """Return the end of a trust-region descent from one point (Branch, Coleman and Li 1999).

    It reflects at the bounds, so that it can leave one.
    """
    from scipy.optimize import least_squares  # slow to import

    end, free = start.copy(), ~held
    low, span = space.low[free], space.span[free]

    def at(t: FloatArray) -> FloatArray:
        end[free] = low + t * span
        return end[None, :]

    def residuals(t: FloatArray) -> FloatArray:
        return as_floats(space.finite_residuals(at(t))[0])

    def slopes(t: FloatArray) -> FloatArray:
        return as_floats(space.slopes(at(t))[0][free].T * span)

    first = np.clip((start[free] - low) / span, _INSIDE, 1 - _INSIDE)
    with np.errstate(all="ignore"):  # of a parameter that has no effect
        try:
            found = least_squares(
                residuals,
                first,
                slopes,
                bounds=(0.0, 1.0),
                x_scale="jac",
                ftol=precision,
                xtol=_LEAST_MOVE,
                gtol=None,
                max_nfev=_STEPS,
            )
        except (ValueError, np.linalg.LinAlgError):
            return start
    return as_floats(at(np.nan_to_num(found.x, nan=0.5))[0])


def _normal_equations(
    space: Space, points: FloatArray, smooth: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the sum of squares, JᵀJ and Jᵀr at P points, in coordinates from 0 to 1."""
    parts, some = [], max(1, _AT_ONCE // (space.low.size * space.size))
    for first in range(0, len(points), some):
        residuals, slopes = space.linearised(points[first : first + some], smooth)
        with np.errstate(all="ignore"):
            g = space.span * (slopes @ residuals[..., None])[..., 0]
            A = space.span[:, None] * (slopes @ slopes.mT) * space.span
            parts.append(((residuals**2).sum(axis=1), A, g))
    cost, A, g = (np.concatenate(each) for each in zip(*parts, strict=True))
    return np.where(np.isfinite(cost + A.sum(axis=(1, 2))), cost, np.inf), A, g


# --- the largest residual -----------------------------------------------------------------------


def _descend_largest(
    space: Space, start: FloatArray, held: BoolArray, precision: float
) -> FloatArray:
    """Minimise the largest magnitude of the residuals by successive linear programmes.

    Each minimises the largest magnitude of the linearised residuals within a trust region.
    """
    names = (name for name, is_held in zip(space.names, held, strict=True) if is_held)
    space = space.fixing(**dict(zip(names, start[held].tolist(), strict=True)))
    point, radius = start[~held], _FIRST_RADIUS
    residuals = space.finite_residuals(point[None, :])[0]
    for _ in range(_MOST_PROGRAMMES):
        slopes = space.linearised(point[None, :])[1][0].T * space.span
        unit = (point - space.low) / space.span
        ends = zip(np.maximum(-radius, -unit), np.minimum(radius, 1 - unit), strict=True)
        step, predicted = _least_largest(residuals, slopes, [*ends])
        largest = np.abs(residuals).max()
        if not predicted < largest * (1 - precision) or radius < _LAST_RADIUS:
            break
        trial = space.low + np.clip(unit + step, 0, 1) * space.span
        there = space.finite_residuals(trial[None, :])[0]
        share = (largest - np.abs(there).max()) / (largest - predicted)
        if share > 0:
            point, residuals = trial, there
        radius *= 2.0 if share > 0.75 else 0.25 if share < 0.25 else 1.0
    end = start.copy()
    end[~held] = point
    return end


def _least_largest(
    residuals: FloatArray, slopes: FloatArray, bounds: list[tuple[float, float]]
) -> tuple[FloatArray, float]:
    """Minimise max|residuals + slopes·step| within bounds; return the step and that largest."""
    from scipy.optimize import linprog  # slow to import

    minus_t = -np.ones((residuals.size, 1))
    solution = linprog(
        np.append(np.zeros(len(bounds)), 1.0),
        A_ub=np.block([[slopes, minus_t], [-slopes, minus_t]]),
        b_ub=np.concatenate([-residuals, residuals]),
        bounds=[*bounds, (0.0, None)],
    )
    if solution.x is None:  # numerically infeasible
        return np.zeros(len(bounds)), float(np.abs(residuals).max())
    return as_floats(solution.x[:-1]), float(solution.x[-1])
