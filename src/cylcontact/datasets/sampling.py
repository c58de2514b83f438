"""Sample a reference law over a grid, block by block.

A grid is sampled one ΔR after the other, each in blocks of bounded size, so that memory does not
grow with the grid. The blocks and the order of their summation depend on the grid alone, so the
result is the same for any number of workers.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from typing import Any, cast

import numpy as np

from cylcontact.datasets.grid import Grid
from cylcontact.datasets.moments import Moments, concatenate, merge, row_moments
from cylcontact.files.writing import replacing, require_parquet, require_suffix
from cylcontact.laws import LogarithmicLaw
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call, run_calls

# Samples per block: its dozen temporaries, 0.5 MiB each, stay in the cache of a core.
BLOCK = 1 << 16
# Least number of samples per call of a worker, if a clearance has that many.
PIECE = 1 << 21
# Clearances whose moments are formed together.
_AT_ONCE = 256
# Writes columns to a table.
_Write = Callable[[Sequence[FloatArray]], None]


@dataclass(frozen=True)
class Counts:
    """Number of samples of a grid, and number masked by the domain of the reference law."""

    samples: int
    masked: int


@dataclass(frozen=True)
class Block:
    """Samples at one ΔR as flat arrays, without those outside the domain of the reference."""

    # In mm.
    dR: float
    # E in GPa and ν; then loads in N/mm, penetrations in mm and E* in MPa.
    row_values: tuple[FloatArray, FloatArray]
    load: FloatArray
    penetration: FloatArray
    E_star: FloatArray
    # Samples left out.
    masked: int

    @property
    def s(self) -> FloatArray:
        """Logarithm of the load over the modulus in mm, ln(f/E*)."""
        return np.asarray(np.log(self.load / self.E_star))

    @property
    def j(self) -> FloatArray:
        """Logarithm of the penetration in mm, ln δ."""
        return np.asarray(np.log(self.penetration))


def blocks(grid: Grid, dR: float) -> Iterator[Block]:
    """Sample the grid's reference law at one ΔR, block by block.

    Parameters
    ----------
    grid : Grid
        The grid.
    dR : float
        One of its clearances, in mm.

    Yields
    ------
    Block
        At most `BLOCK` samples, with E varying slowest and load fastest.
    """
    return _blocks_of_rows(grid, dR, np.arange(grid.rows))


def _blocks_of_rows(grid: Grid, dR: float, rows: IndexArray) -> Iterator[Block]:
    """Yield samples at one ΔR for some rows of the grid, its combinations of E and ν."""
    law = grid.law
    loads_per_block = min(grid.load.size, BLOCK)
    rows_per_block = max(1, BLOCK // loads_per_block)
    for row in range(0, rows.size, rows_per_block):
        here = rows[row : row + rows_per_block, None]
        pair = grid.pairs(dR, here)
        for first in range(0, grid.load.size, loads_per_block):
            load = grid.load[first : first + loads_per_block]
            penetration = law.penetration(load, pair)
            inside = np.isfinite(penetration)
            columns = *grid.row_values(here), load, penetration, pair.E_star
            one, other, f, depth, E_star = (
                np.broadcast_to(column, inside.shape)[inside] for column in columns
            )
            yield Block(dR, (one, other), f, depth, E_star, inside.size - f.size)


def reduce_grid(
    grid: Grid, jobs: Workers = 1, progress: Callable[[int], None] | None = None
) -> tuple[Moments, Counts]:
    """Reduce a grid of any size to moments, with one block per worker in memory.

    Parameters
    ----------
    grid : Grid
        The grid.
    jobs : int or Cluster
        Number of threads, or a Dask cluster; the result does not depend on it.
    progress : callable, optional
        Called with the number of clearances done after each.

    Returns
    -------
    moments : Moments
        At the clearances of the grid, except those that are completely masked.
    counts : Counts
        Samples used and masked.

    Raises
    ------
    InputError
        If the reference law's domain masks every sample.

    Examples
    --------
    >>> from cylcontact.datasets.grid import Grid
    >>> grid = Grid("internal", "johnson", np.array([69.0]), np.array([0.33]),
    ...             np.array([0.0075]), np.array([10.0, 100.0, 490.0, 500.0]))
    >>> moments, counts = reduce_grid(grid)
    >>> counts
    Counts(samples=3, masked=1)
    """
    inside = _clearances_inside(grid)
    masked = np.flatnonzero(~inside)
    height = max(1, PIECE // grid.load.size)
    starts = range(0, grid.rows, height)
    work = [
        call(_reduce_rows, grid, float(dR), first, min(first + height, grid.rows))
        for dR in grid.dR[masked]
        for first in starts
    ]
    parts: list[Moments] = []
    done = 0
    with closing(run_calls(work, jobs, threads=True)) as reduced:
        merged = (merge(islice(reduced, len(starts))) for _ in masked)
        for part in chain(_reduce_whole(grid, grid.dR[inside]), merged):
            parts.append(part)
            for _ in part.dR:
                done += 1
                if progress is not None:
                    progress(done)
    moments = concatenate(parts)
    order = np.argsort(moments.dR)
    moments = moments.at(order[moments.count[order] > 0])
    if not moments.total:
        rule = f"all {grid.size} samples lie outside the domain of {grid.reference}"
        raise InputError(grid.source, "axes", None, rule, "lower the loads, or raise E or dR")
    return moments, Counts(int(moments.total), grid.size - int(moments.total))


def _clearances_inside(grid: Grid) -> BoolArray:
    """Return the clearances at which every sample lies in the domain of a logarithmic law."""
    law = grid.law
    if not isinstance(law, LogarithmicLaw):
        return np.zeros(grid.dR.shape, dtype=bool)
    # The domain ends at a largest load, which is the least for the softest pair.
    softest = int(grid.pairs(grid.dR[0], np.arange(grid.rows)).E_star.argmin())
    pairs = grid.pairs(grid.dR, np.array(softest))
    return np.asarray(np.isfinite(law.penetration(grid.load.max(), pairs)))


def _reduce_whole(grid: Grid, dR: FloatArray) -> Iterator[Moments]:
    """Yield the moments at clearances that are whole, some at a time."""
    if not dR.size:
        return
    law, rows = cast(LogarithmicLaw, grid.law), np.arange(grid.rows)
    pair, some = grid.pairs(dR[0], rows), grid.pairs(dR, rows[0])
    shift = np.log(law.reach(some) / law.reach(pair))
    for first in range(0, dR.size, _AT_ONCE):
        here = slice(first, first + _AT_ONCE)
        yield row_moments(law, pair, grid.load, dR[here], shift[here])


def _reduce_rows(grid: Grid, dR: float, first: int, last: int) -> Moments:
    """Return the moments of some rows, combinations of E and ν, at one ΔR."""
    law, rows, parts = grid.law, np.arange(first, last), []
    if isinstance(law, LogarithmicLaw):
        pair = grid.pairs(dR, rows)
        whole = np.isfinite(law.penetration(grid.load.max(), pair))
        if whole.any():
            parts.append(row_moments(law, grid.pairs(dR, rows[whole]), grid.load))
        rows = rows[~whole]
    parts += [Moments.of_samples(dR, b.s, b.j) for b in _blocks_of_rows(grid, dR, rows)]
    return merge(parts)


def write_samples(
    grid: Grid, path: Path | str, progress: Callable[[int], None] | None = None
) -> Counts:
    """Sample a grid into a table, in bounded memory.

    Parameters
    ----------
    grid : Grid
        The grid.
    path : path
        A .parquet or .csv file, created when it is complete. Its columns are those of the grid.
    progress : callable, optional
        Called with the number of clearances done after each.

    Returns
    -------
    Counts
        Samples written and masked.

    Raises
    ------
    InputError
        If the suffix is neither, the file cannot be written, every sample is masked, or Parquet's
        library is not installed.
    """
    samples = masked = 0
    opened = _parquet if require_suffix(path, ".parquet", ".csv") == ".parquet" else _csv
    with replacing(path) as temporary, opened(temporary, grid.columns) as write:
        for done, dR in enumerate(grid.dR, start=1):
            for block in blocks(grid, float(dR)):
                clearance = np.full(block.load.size, block.dR)
                write([*block.row_values, clearance, block.load, block.penetration])
                samples += block.load.size
                masked += block.masked
            if progress is not None:
                progress(done)
        if not samples:
            reduce_grid(grid)  # raises the error that names the reason
    return Counts(samples, masked)


@contextmanager
def _csv(file: Path, names: Sequence[str]) -> Iterator[_Write]:
    """Open a CSV file for columns, each number in its shortest digits."""
    with file.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(names)
        yield lambda columns: rows.writerows(zip(*(c.tolist() for c in columns), strict=True))


@contextmanager
def _parquet(file: Path, names: Sequence[str]) -> Iterator[_Write]:
    """Open a Parquet file for columns, whose memory it shares."""
    pa = require_parquet(file)
    schema = pa.schema([(name, pa.float64()) for name in names])

    def batch(columns: Sequence[FloatArray]) -> Any:
        # `pa.array` would import pandas, which is slow and loses a Ctrl-C.
        buffers = [(column.size, [None, pa.py_buffer(column)]) for column in columns]
        arrays = [pa.Array.from_buffers(pa.float64(), *buffer) for buffer in buffers]
        return pa.record_batch(arrays, schema=schema)

    with pa.parquet.ParquetWriter(file, schema, compression="zstd") as writer:
        yield lambda columns: writer.write_batch(batch(columns))
