"""From a grid to coefficients within 0.1 % of the best objective, against other optimisers.

The global searches are compared on the same objective, from moments. Then ours samples the grid
into moments and searches, and the others evaluate the law at every sample, as one would write it
first. Each stops within 0.1 % of the best, or when its evaluations or its time are used up.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace

import cma
import lmfit
import numpy as np
import pygad
from scipy.optimize import differential_evolution, least_squares

from benchmarks.harness import Row, compare, require_agreement, rows
from cylcontact.datasets import Grid, reduce_grid
from cylcontact.datasets.sampling import BLOCK, blocks
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.reference import OnMoments
from cylcontact.fitting.runs import searches
from cylcontact.fitting.search import genetic_search
from cylcontact.fitting.specs import GeneticSpec

CLOSE, SECONDS, EVALUATIONS = 1.001, 200, 200_000
BOUNDS = {
    "a": (0.1, 1.5),
    "b": (0.0, 0.5),
    "Y_log_scale": (1.0, 3.0),
    "Y_log_exponent": (-0.6, 0.0),
    "Y_slope": (-0.1, 0.1),
    "Y_offset": (0.8, 1.6),
    "n_exponent": (-0.1, 0.1),
}


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the time of a sample, of a generation, and of calibrations by number of samples."""
    yield _sampling((5, 3, 4, 50) if short else (100, 20, 50, 100), 1 if short else 5)
    space, size = space_of(9, 5, 61, 15), (60, 5) if short else (120, 50)
    offspring = space.scatter(np.random.default_rng(0), size[0] // 2)
    sides = {
        "genetic search": lambda: genetic_search(space, *size, 1),
        "its objective": lambda: [space.values(offspring) for _ in range(size[1])],
    }
    yield compare(f"a generation of {size[0]}", sides, 1 if short else 5, scale=1e3 / size[1])
    yield from global_searches(space, 1 if short else 10)
    if short:
        yield calibrations((3, 2, 9, 4), {"scipy least_squares": by_least_squares}, 1)
        return
    yield calibrations((5, 3, 61, 5), PEERS, 3, seconds=20)
    yield calibrations((25, 9, 61, 73), PEERS, 1)
    yield calibrations((200, 50, 100, 100), {}, 3)


def grid_of(E: int, nu: int, dR: int, load: int) -> Grid:
    """Return a grid like the paper's for internal contact, of any shape."""
    E_, nu_ = np.geomspace(20.7, 1000.0, E), np.linspace(0.1, 0.5, nu)
    dR_, loads = np.geomspace(0.05, 9.9, dR), np.geomspace(10.0, 1000.0, load)
    return Grid("internal", "johnson", E_, nu_, dR_, loads)


def space_of(*shape: int) -> OnMoments:
    """Return the calibration of the enhanced law on such a grid."""
    model = MODELS["enhanced", "internal"]
    parameters = tuple(
        replace(p, low=BOUNDS[p.name][0], high=BOUNDS[p.name][1]) if p.is_free else p
        for p in model.parameters
    )
    return OnMoments(model, parameters, reduce_grid(grid_of(*shape))[0])


def _sampling(shape: tuple[int, ...], rounds: int) -> list[Row]:
    grid = grid_of(*shape)
    # In a piece that stays in the cache: arithmetic is the limit, not memory.
    values = np.linspace(1.0, 2.0, min(grid.size, BLOCK))
    out, times = np.empty_like(values), -(-grid.size // values.size)
    sides = {
        "reduce_grid, all cores": lambda: reduce_grid(grid, os.cpu_count() or 1),
        "numpy.log": lambda: [np.log(values, out=out) for _ in range(times)],
    }
    case = f"a sample of {grid.size:,}, to moments"
    return compare(case, sides, rounds, "ns", 1e9 / grid.size)


class OutOfTimeError(Exception):
    """A search has arrived, or its time or its evaluations are used up."""


# --- global searches on the same objective ------------------------------------------------------


class Counted:
    """The objective of a space, and the best and the evaluations of a search until it arrives."""

    def __init__(self, space: OnMoments, target: float) -> None:
        self.space, self.target = space, target
        self.free, self.low, self.span = space.free, space.low, space.span
        self.best, self.evaluations = np.inf, 0

    def values(self, points: np.ndarray) -> np.ndarray:
        """Return the objective of points; raise once one is within 0.1 % of the best."""
        values = self.space.values(points)
        self.evaluations += len(points)
        self.best = min(self.best, float(values.min()))
        if self.best <= self.target or self.evaluations >= EVALUATIONS:
            raise OutOfTimeError
        return values

    def at(self, genes: np.ndarray) -> np.ndarray:
        """Return the objective of points of the unit cube, 1e3 where it has none."""
        return np.minimum(self.values(self.low + np.asarray(genes) * self.span), 1e3)


def with_our_recombination(counted: Counted, seed: int) -> None:
    """PyGAD with differences of parents, as a campaign runs it."""
    genetic_search(counted, GeneticSpec().population, GeneticSpec().generations, seed)


def with_its_own_operators(counted: Counted, seed: int) -> None:
    """PyGAD's uniform crossover and random mutation, in populations of the same size."""
    _pygad(lambda _, genes, __: -counted.at(genes), len(counted.free), 120, seed, batch=120)


def with_scipy(counted: Counted, seed: int) -> None:
    """The differential evolution of scipy, a generation at a time."""
    differential_evolution(
        lambda genes: counted.at(genes.T),
        [(0, 1)] * len(counted.free),
        rng=seed,
        maxiter=10**6,
        tol=0,
        polish=False,
        vectorized=True,
        updating="deferred",
    )


def with_cma(counted: Counted, seed: int) -> None:
    """CMA-ES, a generation at a time, restarted where it stops."""
    rng = np.random.default_rng(seed)
    while True:
        seed += 1
        options = {"bounds": [0, 1], "seed": seed, "verbose": -9}
        start = rng.uniform(0.02, 0.98, len(counted.free))
        evolution = cma.CMAEvolutionStrategy(start, 0.3, options)
        while not evolution.stop():
            points = evolution.ask()
            evolution.tell(points, counted.at(points))


GLOBAL: dict[str, Callable[[Counted, int], None]] = {
    "PyGAD, differences of parents": with_our_recombination,
    "PyGAD, its own operators": with_its_own_operators,
    "scipy differential_evolution": with_scipy,
    "CMA-ES": with_cma,
}


def global_searches(space: OnMoments, rounds: int) -> Iterator[list[Row]]:
    """Yield evaluations and time to 0.1 % of the best, of searches from the same seeds."""
    target = CLOSE * min(run(*rest).objective for run, rest, _ in _searches(space, 4, 20150101))
    evaluations: dict[str, list[float]] = {name: [] for name in GLOBAL}
    seconds: dict[str, list[float]] = {name: [] for name in GLOBAL}
    notes = {}
    for name, search in GLOBAL.items():
        arrived = 0
        for seed in range(rounds):
            counted, started = Counted(space, target), time.perf_counter()
            logging.disable(logging.CRITICAL)  # PyGAD logs the exception that ends it
            with suppress(OutOfTimeError), np.errstate(all="ignore"):
                search(counted, seed)
            logging.disable(logging.NOTSET)
            seconds[name].append(time.perf_counter() - started)
            evaluations[name].append(counted.evaluations)
            arrived += counted.best <= target
        if arrived < rounds:
            notes[name] = f"{arrived} of {rounds} arrived in {EVALUATIONS:,}"
    case = "a search to 0.1 %, seven coefficients"
    yield rows(f"{case}, evaluations", evaluations, "evaluations", notes=notes)
    yield rows(case, seconds, "ms", 1e3, notes=notes)


# --- calibrations, from the samples -------------------------------------------------------------


class Samples:
    """The deviations of a law from every sample of a grid, and the best that a search has met."""

    def __init__(self, shape: tuple[int, ...], target: float, seconds: float) -> None:
        grid, space = grid_of(*shape), space_of(*shape)
        parts = [
            (block, block.load.size) for dR in map(float, grid.dR) for block in blocks(grid, dR)
        ]
        self.dR = np.concatenate([np.full(size, block.dR) for block, size in parts])
        self.E_star, self.load, self.penetration = (
            np.concatenate([getattr(block, name) for block, _ in parts])
            for name in ("E_star", "load", "penetration")
        )
        self.low, self.high, self.span = space.low, space.high, space.high - space.low
        self.target, self.seconds = target, seconds
        self.restart()

    def restart(self) -> Samples:
        """Forget the best."""
        self.best, self.started = np.inf, time.perf_counter()
        return self

    def residuals(self, candidate: np.ndarray) -> np.ndarray:
        """Return ln(δ_law/δ_reference) of every sample."""
        if self.best <= self.target or time.perf_counter() - self.started > self.seconds:
            raise OutOfTimeError
        a, b, log_scale, log_exponent, slope, offset, n_exponent = candidate
        K = (a * self.dR + b) * self.E_star / self.dR
        logarithmic = log_scale * np.log(1000 * self.dR) ** log_exponent
        Y = np.where(self.dR < 0.34954, logarithmic, slope * self.dR + offset)
        deviations = np.log((self.load / K) ** (self.dR**-n_exponent / Y) / self.penetration)
        self.best = min(self.best, float(np.sqrt(np.mean(deviations**2))))
        return deviations

    def value(self, unit: np.ndarray) -> float:
        """Return the root mean square at a point of the unit cube."""
        return float(np.sqrt(np.mean(self.residuals(self.low + unit * self.span) ** 2)))

    def start(self, rng: np.random.Generator) -> np.ndarray:
        """Return a random point of the unit cube."""
        return rng.uniform(0.02, 0.98, self.low.size)


def by_least_squares(samples: Samples, seed: int) -> None:
    """The descent of scipy, from random starts."""
    rng, bounds = np.random.default_rng(seed), (samples.low, samples.high)
    while True:
        start = samples.low + samples.start(rng) * samples.span
        least_squares(samples.residuals, start, bounds=bounds, x_scale=samples.span)


def by_lmfit(samples: Samples, seed: int) -> None:
    """The default of lmfit, Levenberg-Marquardt with bounds, from random starts."""
    rng = np.random.default_rng(seed)
    while True:
        parameters = lmfit.Parameters()
        start = samples.low + samples.start(rng) * samples.span
        for name, value, low, high in zip(BOUNDS, start, samples.low, samples.high, strict=True):
            parameters.add(name, value=value, min=low, max=high)
        lmfit.minimize(lambda p: samples.residuals([p[name].value for name in BOUNDS]), parameters)


def by_cma(samples: Samples, seed: int) -> None:
    """CMA-ES, from random starts."""
    rng = np.random.default_rng(seed)
    while True:
        seed += 1
        options = {"bounds": [0, 1], "seed": seed, "verbose": -9}
        cma.fmin2(samples.value, samples.start(rng), 0.3, options)


def by_pygad(samples: Samples, seed: int) -> None:
    """PyGAD as its manual shows it."""
    _pygad(lambda _, genes, __: -samples.value(genes), samples.low.size, 60, seed)


def _pygad(fitness, genes: int, population: int, seed: int, batch: int | None = None) -> None:
    """PyGAD with its uniform crossover and random mutation, again and again."""
    silent = logging.Logger("pygad")
    silent.addHandler(logging.NullHandler())
    while True:
        seed += 1
        pygad.GA(
            num_generations=300,
            num_parents_mating=population // 2,
            sol_per_pop=population,
            num_genes=genes,
            gene_space={"low": 0.0, "high": 1.0},
            fitness_func=fitness,
            fitness_batch_size=batch,
            crossover_type="uniform",
            mutation_probability=0.2,
            keep_elitism=2,
            suppress_warnings=True,
            random_seed=seed,
            logger=silent,
        ).run()


PEERS: dict[str, Callable[[Samples, int], None]] = {
    "scipy least_squares": by_least_squares,
    "lmfit": by_lmfit,
    "CMA-ES": by_cma,
    "PyGAD": by_pygad,
}


def calibrations(shape: tuple[int, ...], peers, rounds: int, seconds: float = SECONDS) -> list[Row]:
    """Time ours and others on one grid."""
    space = space_of(*shape)
    target = CLOSE * min(run(*rest).objective for run, rest, _ in _searches(space, 16, 20150101))
    times = {"cylcontact": [_ours(shape, target, seed) for seed in range(rounds)]}
    notes = {}
    if peers:
        samples = Samples(shape, target, seconds)
        candidates = np.random.default_rng(0).uniform(size=(5, space.low.size))
        sides = {
            "moments": lambda: space.values(space.low + candidates * samples.span),
            "samples": lambda: [samples.restart().value(each) for each in candidates],
        }
        require_agreement(sides, 1e-9)
    for name, search in peers.items():
        times[name], arrived = [], 0
        for seed in range(rounds):
            reached, spent = reach(search, samples, seed)
            times[name].append(spent)
            arrived += reached <= target
        if arrived < rounds:
            notes[name] = f"{arrived} of {rounds} arrived in {seconds:g} s"
    return rows(f"a calibration on {np.prod(shape):,} samples", times, notes=notes)


def reach(search, samples: Samples, seed: int) -> tuple[float, float]:
    """Return the best objective that a search reaches, and its seconds."""
    samples.restart()
    with suppress(OutOfTimeError), np.errstate(all="ignore"):
        search(samples, seed)
    return samples.best, time.perf_counter() - samples.started


def _searches(space: OnMoments, runs: int, seed: int):
    return searches(space, GeneticSpec(runs=runs), seed)


def _ours(shape: tuple[int, ...], target: float, seed: int) -> float:
    started = time.perf_counter()
    for run, arguments, _ in _searches(space_of(*shape), 200, seed):
        if run(*arguments).objective <= target:
            return time.perf_counter() - started
    raise AssertionError(f"seed {seed}: no run came within {CLOSE} of the best")
