"""The search: PyGAD finds the optimum, and a descent from there adds the last digits.

A descent is an interior Levenberg-Marquardt iteration on a batch of points at once, with the
scaling of Coleman and Li (1996) at the bounds and the damping of Nielsen (1999). A largest residual
is minimised by linear programmes within a trust region instead (Osborne and Watson 1969).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from cylcontact.fitting.space import Space
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray, as_floats

# The bounds of the factor of a difference, and the share of genes that an offspring takes from it
# instead of from a parent: of one half of the offspring, and of the other.
_FACTOR, _SHARES = (0.5, 1.0), (0.9, 1.0)
# The fitness of an undefined law; PyGAD refuses NaN.
_WORST_FITNESS = -1e300

# Relative gain at the end of a fine descent and of an exact one, and the most steps.
_FINE, EXACT, _STEPS = 1e-6, 1e-14, 400
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


def genetic_search(space: Space, population: int, generations: int, seed: int) -> Minimum:
    """Return the best of a genetic search by PyGAD.

    Genes are the free parameters scaled to [0, 1] between their bounds. The better half of each
    generation stays, and has as many offspring: each is one parent plus the scaled difference of
    two others, a + F·(b − c) (Storn and Price 1997). The differences shrink with the population, so
    that one setting serves both exploring and refining, and mutation is not needed.

    Parameters
    ----------
    space : Space
        What is minimised.
    population, generations : int
        The size of the population, at least 4, and how many follow the first one.
    seed : int
        Of PyGAD's random numbers.

    References
    ----------
    Storn, R., Price, K. (1997). Differential evolution. J. Glob. Optim. 11, 341-359.
    """
    import pygad  # slow to import

    def fitness_of(genes: FloatArray) -> FloatArray:
        values = space.values(space.low + genes * space.span)
        return np.where(np.isfinite(values), -values, _WORST_FITNESS)

    class Engine(pygad.GA):  # type: ignore[misc]
        """PyGAD with the fitness of a generation in one call, in place of one for each solution."""

        evaluations = 0
        last_generation_parents_indices: IndexArray | None = None

        def cal_pop_fitness(self) -> FloatArray:
            """Return the fitness of all; the parents come first, and theirs is known."""
            parents = self.last_generation_parents_indices
            known = np.empty(0) if parents is None else self.previous_generation_fitness[parents]
            offspring = self.population[len(known) :]
            self.evaluations += len(offspring)
            return np.concatenate([known, fitness_of(offspring)])

        def best_solution(self, pop_fitness: FloatArray) -> tuple[FloatArray, float, int]:
            """Return the best genes, their fitness and their place."""
            best = int(np.argmax(pop_fitness))
            return self.population[best].copy(), float(pop_fitness[best]), best

    engine = Engine(
        num_generations=generations,
        sol_per_pop=population,
        num_parents_mating=population // 2,
        num_genes=len(space.free),
        gene_space={"low": 0.0, "high": 1.0},
        fitness_func=lambda _, genes, __: fitness_of(genes[None])[0],  # PyGAD asks for one
        parent_selection_type=_better_half,
        keep_elitism=0,
        keep_parents=-1,  # all
        crossover_type=_recombine,
        mutation_type=None,
        random_seed=seed,
        suppress_warnings=True,
    )
    engine.run()
    genes, best, _ = engine.best_solution(engine.last_generation_fitness)
    return Minimum(space.low + genes * space.span, -best, engine.evaluations)


def _better_half(fitness: FloatArray, number: int, engine: Any) -> tuple[FloatArray, IndexArray]:
    """Return the fittest of a generation and their places."""
    best = np.argsort(-fitness, kind="stable")[:number]
    return engine.population[best], best


def _recombine(parents: FloatArray, size: tuple[int, int], engine: Any) -> FloatArray:
    """Return offspring a + F·(b − c) of random parents, some of whose genes stay a parent's.

    A gene beyond a bound is drawn between that bound and the parent's.
    """
    rng, (number, k) = engine.numpy_random_generator, size
    one, a, b, c = parents[rng.randint(len(parents), size=(4, number))]
    moved = a + rng.uniform(*_FACTOR, size=(number, 1)) * (b - c)
    share = rng.choice(_SHARES, size=(number, 1))
    takes = rng.uniform(size=size) < share
    takes[np.arange(number), rng.randint(k, size=number)] = True
    offspring, drawn = np.where(takes, moved, one), rng.uniform(size=size)
    low, high = drawn * one, 1 - drawn * (1 - one)
    return as_floats(np.where(offspring < 0, low, np.where(offspring > 1, high, offspring)))


# --- descents -----------------------------------------------------------------------------------


def polish(space: Space, start: FloatArray, precision: float = EXACT) -> tuple[FloatArray, float]:
    """Return the local minimum below a point, by descents until one gains nothing, and its value.

    The coefficients are known to about the square root of the relative `precision`.
    """
    point, value = start, space.value(start)
    if not np.isfinite(value):
        return point, value
    for _ in range(_MOST_RESTARTS):
        (end,), (reached,) = descend(space, point[None, :], precision)
        gained = reached < value * (1 - _MIN_GAIN)
        if reached < value:
            point, value = end, float(reached)
        if not gained:
            break
    return point, value


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
    if space.is_largest or space.is_ill_conditioned:
        one = _descend_largest if space.is_largest else _least_squares
        ends = starts.copy()
        for end, own in zip(ends, held, strict=True):
            names = (name for name, is_held in zip(space.names, own, strict=True) if is_held)
            rest = space.fixing(**dict(zip(names, end[own].tolist(), strict=True)))
            end[~own] = one(rest, end[~own], precision)
    else:
        ends = _descend_squares(space, starts, precision, held)
    after = space.values(ends)
    lower = after < before
    return np.where(lower[:, None], ends, starts), np.where(lower, after, before)


def _descend_squares(
    space: Space, starts: FloatArray, precision: float, held: BoolArray
) -> FloatArray:
    """Minimise sums of squares within the bounds.

    In coordinates t from 0 to 1, with residuals r, slopes J, A = JᵀJ, g = Jᵀr and v the distance to
    the bound that −g points to, a step solves

        (A + diag(|g|/v) + λ·diag(c/v))·step = −g

    with c the curvatures that the space scales its damping by.

    What is held has no slopes, and so no step.
    """
    k = space.low.size
    ends = (starts - space.low) / space.span
    ends = np.where(held, ends, np.clip(ends, _MARGIN, 1 - _MARGIN))
    here, t, free = np.arange(len(ends)), ends, 1.0 - held

    def expanded(t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return r², A and g."""
        cost, A, g = _normal_equations(space, space.low + t * space.span)
        return cost, A * free[:, :, None] * free[:, None, :], g * free

    cost, A, g = expanded(t)
    damping, growth = np.full(here.size, _FIRST_DAMPING), np.full(here.size, 2.0)
    small = np.zeros(here.size)
    for _ in range(_STEPS):
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
    return np.where(held, starts, space.low + ends * space.span)


def _least_squares(space: Space, start: FloatArray, precision: float) -> FloatArray:
    """Return the end of a trust-region descent from one point (Branch, Coleman and Li 1999).

    It reflects at the bounds, so that it can leave one.
    """
    from scipy.optimize import least_squares  # slow to import

    def at(t: FloatArray) -> FloatArray:
        return as_floats(space.low + t * space.span)[None, :]

    def residuals(t: FloatArray) -> FloatArray:
        return as_floats(space.finite_residuals(at(t))[0])

    def slopes(t: FloatArray) -> FloatArray:
        return as_floats(space.slopes(at(t))[0].T * space.span)

    first = np.clip((start - space.low) / space.span, _INSIDE, 1 - _INSIDE)
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
    space: Space, points: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the sum of squares, JᵀJ and Jᵀr at P points, in coordinates from 0 to 1."""
    parts, some = [], max(1, _AT_ONCE // (space.low.size * space.size))
    for first in range(0, len(points), some):
        residuals, slopes = space.linearised(points[first : first + some])
        with np.errstate(all="ignore"):
            g = space.span * (slopes @ residuals[..., None])[..., 0]
            A = space.span[:, None] * (slopes @ slopes.mT) * space.span
            parts.append(((residuals**2).sum(axis=1), A, g))
    cost, A, g = (np.concatenate(each) for each in zip(*parts, strict=True))
    return np.where(np.isfinite(cost + A.sum(axis=(1, 2))), cost, np.inf), A, g


# --- the largest residual -----------------------------------------------------------------------


def _descend_largest(space: Space, start: FloatArray, precision: float) -> FloatArray:
    """Minimise the largest magnitude of the residuals by successive linear programmes.

    Each minimises the largest magnitude of the linearised residuals within a trust region.
    """
    point, radius = start, _FIRST_RADIUS
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
    return point


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
