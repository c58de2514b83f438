"""The enhanced law calibrated with other people's optimisers, on rows of samples.

Each goes on until the target is reached or its budget is spent.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import cma
import lmfit
import numpy as np
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.core.problem import Problem as PymooProblem
from pymoo.optimize import minimize as pymoo_minimize
from scipy.optimize import differential_evolution, least_squares

from benchmarks.search import pygad_of
from cylcontact.datasets import Grid
from cylcontact.datasets.sampling import blocks
from cylcontact.fitting.reference import OnMoments

# What the campaign gives to one of its runs.
POPULATION, GENERATIONS = 60, 300
BUDGET = POPULATION * GENERATIONS


class TargetReachedError(Exception):
    """The search may end."""


@dataclass
class RowProblem:
    """The calibration as one would write it first: every sample, for every candidate."""

    low: np.ndarray
    high: np.ndarray
    E_star: np.ndarray
    dR: np.ndarray
    load: np.ndarray
    penetration: np.ndarray
    evaluations: int = 0
    best: float = np.inf
    target: float = field(default=0.0)

    def residuals(self, candidate: np.ndarray) -> np.ndarray:
        """Return ln(δ_law/δ_reference) of every sample."""
        a, b, log_scale, log_exponent, slope, offset, n_exponent = candidate
        K = (a * self.dR + b) * self.E_star / self.dR
        Y = np.maximum(log_scale * np.log(1000 * self.dR) ** log_exponent, slope * self.dR + offset)
        n = Y * self.dR**n_exponent
        residuals = np.log((self.load / K) ** (1 / n) / self.penetration)
        self.evaluations += 1
        self.best = min(self.best, float(np.sqrt(np.mean(residuals**2))))
        return residuals

    def value(self, candidate: np.ndarray) -> float:
        """Return their root mean square; end the search at the target or the budget."""
        value = float(np.sqrt(np.mean(self.residuals(candidate) ** 2)))
        self.stop_if_done()
        return value

    def stop_if_done(self) -> None:
        """Raise `TargetReachedError` at the target or the end of the budget."""
        if self.best <= self.target or self.evaluations >= BUDGET:
            raise TargetReachedError

    def start(self, rng: np.random.Generator) -> np.ndarray:
        """Return a random point between the bounds."""
        return self.low + rng.uniform(0.02, 0.98, self.low.size) * (self.high - self.low)


def rows_of(grid: Grid, space: OnMoments, target: float) -> RowProblem:
    """Return a problem with its samples kept one by one."""
    sampled = [block for dR in map(float, grid.dR) for block in blocks(grid, dR)]
    columns = [
        np.concatenate([getattr(block, name) for block in sampled])
        for name in ("E_star", "load", "penetration")
    ]
    dR = np.concatenate([np.full(block.load.size, block.dR) for block in sampled])
    return RowProblem(space.low, space.high, columns[0], dR, columns[1], columns[2], target=target)


def by_pygad(rows: RowProblem, seed: int) -> None:
    """PyGAD as its manual shows it."""
    options = {"mutation_probability": 0.2, "random_seed": seed, "logger": _silent_logger()}
    pygad_of(rows, POPULATION, GENERATIONS, rows.value, **options).run()


def by_differential_evolution(rows: RowProblem, seed: int) -> None:
    """The differential evolution of scipy, a population per call."""
    differential_evolution(
        lambda population: np.array([rows.value(candidate) for candidate in population.T]),
        list(zip(rows.low, rows.high, strict=True)),
        vectorized=True,
        updating="deferred",
        rng=seed,
        maxiter=BUDGET,
        tol=0,
    )


def by_least_squares(rows: RowProblem, seed: int) -> None:
    """The least-squares descent of scipy, from random starts."""
    rng = np.random.default_rng(seed)
    while True:
        least_squares(
            rows.residuals,
            rows.start(rng),
            bounds=(rows.low, rows.high),
            x_scale=rows.high - rows.low,
        )
        rows.stop_if_done()


def by_lmfit(rows: RowProblem, seed: int) -> None:
    """The default of lmfit, Levenberg-Marquardt with bounds, from random starts."""
    rng = np.random.default_rng(seed)
    names = [f"p{k}" for k in range(rows.low.size)]
    while True:
        parameters = lmfit.Parameters()
        for name, start, low, high in zip(names, rows.start(rng), rows.low, rows.high, strict=True):
            parameters.add(name, value=start, min=low, max=high)
        lmfit.minimize(lambda p: rows.residuals([p[name].value for name in names]), parameters)
        rows.stop_if_done()


def by_cma(rows: RowProblem, seed: int) -> None:
    """CMA-ES, restarted with a larger population."""
    rng, span = np.random.default_rng(seed), rows.high - rows.low
    for restart in range(20):
        start = (rows.start(rng) - rows.low) / span
        options = {"bounds": [0, 1], "seed": seed + 1 + restart, "verbose": -9}
        cma.fmin2(lambda genes: rows.value(rows.low + genes * span), start, 0.3, options)


def by_pymoo(rows: RowProblem, seed: int) -> None:
    """The differential evolution of pymoo."""

    class Rows(PymooProblem):
        def _evaluate(self, x, out, *_, **__):
            out["F"] = np.array([[rows.value(candidate)] for candidate in x])

    problem = Rows(n_var=rows.low.size, n_obj=1, xl=rows.low, xu=rows.high)
    pymoo_minimize(problem, DE(pop_size=POPULATION), ("n_gen", GENERATIONS), seed=seed)


PEERS: dict[str, Callable[[RowProblem, int], None]] = {
    "scipy least_squares, random starts": by_least_squares,
    "lmfit, random starts": by_lmfit,
    "scipy differential_evolution": by_differential_evolution,
    "pymoo differential evolution": by_pymoo,
    "CMA-ES (cma)": by_cma,
    "PyGAD, one individual after the other": by_pygad,
}


def reach(peer: str, rows: RowProblem, seed: int) -> tuple[float, int]:
    """Run a peer; return the objective it reached and how often it evaluated the samples."""
    rows.evaluations, rows.best = 0, np.inf
    with suppress(TargetReachedError), np.errstate(all="ignore"):
        PEERS[peer](rows, seed)
    return rows.best, rows.evaluations


def _silent_logger():
    """Return a logger that keeps quiet when the target ends a search."""
    import logging

    logger = logging.Logger("pygad")
    logger.addHandler(logging.NullHandler())
    return logger
