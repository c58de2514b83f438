"""From a grid to moments, against the same samples taken plainly and one pass of logarithms."""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial

import numpy as np

from benchmarks.harness import Row, Side, compare, require_agreement
from cylcontact.datasets import Grid, Moments, concatenate, merge, reduce_grid
from cylcontact.datasets.sampling import BLOCK, blocks

# A larger grid is not sampled the plain way, which is slow and goes on as it began.
MOST_PLAIN = 20_000_000


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the cost of a sample, on one thread and on all."""
    shapes = [(5, 3, 4, 50)] if short else [(100, 20, 50, 100), (200, 50, 20, 500)]
    for shape in shapes:
        grid = grid_of(*shape)
        cores = os.cpu_count() or 1
        sides = [
            Side("cylcontact: reduce_grid, 1 thread", partial(_numbers, reduce_grid, grid, 1)),
            Side(
                f"cylcontact: reduce_grid, {cores} threads",
                partial(_numbers, reduce_grid, grid, cores),
            ),
        ]
        if grid.size <= MOST_PLAIN:
            name = "law, two logarithms and six sums, in blocks"
            sides.append(Side(name, partial(_numbers, _plainly, grid)))
        limit = Side("numpy.log of as many values", partial(_logarithms, grid.size))
        require_agreement(sides, 1e-9)
        case, rounds = f"{grid.size:,} samples", 1 if short else 5
        yield compare("sampling", case, [*sides, limit], rounds, "ns per sample", 1e9 / grid.size)


def grid_of(E: int, nu: int, dR: int, load: int) -> Grid:
    """Return a grid like the paper's for internal contact, of any shape."""
    return Grid(
        "internal",
        "johnson",
        np.geomspace(20.7, 1000.0, E),
        np.linspace(0.1, 0.5, nu),
        np.geomspace(0.05, 9.9, dR),
        np.geomspace(10.0, 1000.0, load),
    )


def _numbers(reduce, grid: Grid, *arguments) -> np.ndarray:
    moments, _ = reduce(grid, *arguments)
    return np.concatenate([moments.mean_s, moments.mean_j, moments.ss, moments.sj, moments.jj])


def _plainly(grid: Grid) -> tuple[Moments, None]:
    parts = [
        merge(Moments.of_samples(dR, block.s, block.j) for block in blocks(grid, dR))
        for dR in map(float, grid.dR)
    ]
    return concatenate(parts), None


def _logarithms(size: int) -> None:
    # In pieces that stay in the cache: the arithmetic is the limit, not the memory.
    values = np.linspace(1.0, 2.0, min(size, BLOCK))
    out = np.empty_like(values)
    for _ in range(max(1, size // values.size)):
        np.log(values, out=out)
