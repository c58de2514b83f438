"""Sample a reference law over a grid, block by block.

A grid is sampled one ΔR after the other, each in blocks of bounded size, so that memory does not
grow with the grid. The blocks and the order of their sums depend on the grid alone, so the result
is the same for any number of workers.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.datasets.grid import Grid
from cylcontact.datasets.moments import Moments, concatenate, logarithmic_moments, merge
from cylcontact.files.writing import replacing, require_parquet, require_suffix
from cylcontact.laws import LogarithmicLaw
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call, run_calls
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

# Samples per block: its dozen temporaries, 0.5 MiB each, stay in the cache of a core.
BLOCK = 1 << 16
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

    dR: float  # in mm
    # E in GPa and ν; then loads in N/mm, penetrations in mm and E* in MPa.
    row_values: tuple[FloatArray, FloatArray]
    load: FloatArray
    penetration: FloatArray
    E_star: FloatArray

    @property
    def s(self) -> FloatArray:
        """Logarithm of the load over the modulus in mm, ln(f/E*)."""
        return np.asarray(np.log(self.load / self.E_star))

    @property
    def j(self) -> FloatArray:
        """Logarithm of the penetration in mm, ln δ."""
        return np.asarray(np.log(self.penetration))


def blocks(grid: Grid, dR: float, rows: IndexArray | None = None) -> Iterator[Block]:
    """Sample the grid's reference law at one ΔR.

    Parameters
    ----------
    grid : Grid
        The grid.
    dR : float
        One of its clearances, in mm.
    rows : array of int, optional
        Some of its combinations of E and ν; all by default.

    Yields
    ------
    Block
        At most `BLOCK` samples, with E varying slowest and load fastest.
    """
    law, every = grid.law, np.arange(grid.rows) if rows is None else rows
    wide = min(grid.load.size, BLOCK)
    high = max(1, BLOCK // wide)
    for row in range(0, every.size, high):
        here = every[row : row + high, None]
        pair = grid.pairs(dR, here)
        for first in range(0, grid.load.size, wide):
            load = grid.load[first : first + wide]
            penetration = law.penetration(load, pair)
            inside = np.isfinite(penetration)
            columns = *grid.row_values(here), load, penetration, pair.E_star
            one, other, f, depth, E_star = (
                np.broadcast_to(column, inside.shape)[inside] for column in columns
            )
            yield Block(dR, (one, other), f, depth, E_star)


def require_samples(grid: Grid, number: float) -> None:
    """Raise `InputError` if no sample of a grid lies in the domain of its reference law."""
    if not number:
        rule = f"all {grid.size} samples lie outside the domain of {grid.reference}"
        raise InputError(grid.source, "axes", None, rule, "lower the loads, or raise E or dR")


# --- to moments ---------------------------------------------------------------------------------


def reduce_grid(
    grid: Grid, jobs: Workers = 1, progress: Progress = silent
) -> tuple[Moments, Counts]:
    """Reduce a grid of any size to moments, with one block per worker in memory.

    Parameters
    ----------
    grid : Grid
        The grid.
    jobs : int or Cluster
        Number of threads, or a Dask cluster; the result does not depend on it.
    progress : callable, optional
        Called with "sampling", the number of clearances done, and that of all.

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
    whole = _whole_clearances(grid)
    inside, rows = grid.dR[whole], np.arange(grid.rows)
    starts = range(0, inside.size, _AT_ONCE)
    parts = [_without_samples(grid, rows, inside[first : first + _AT_ONCE]) for first in starts]
    work = [call(_at_clearance, grid, float(dR)) for dR in grid.dR[~whole]]
    progress("sampling", inside.size, grid.dR.size)
    with closing(run_calls(work, jobs, threads=True)) as reduced:
        for done, part in enumerate(reduced, start=inside.size + 1):
            parts.append(part)
            progress("sampling", done, grid.dR.size)
    moments = concatenate(parts)
    order = np.argsort(moments.dR)
    moments = moments.at(order[moments.count[order] > 0])
    require_samples(grid, moments.total)
    return moments, Counts(int(moments.total), grid.size - int(moments.total))


def _whole_clearances(grid: Grid) -> BoolArray:
    """Return the clearances at which every sample lies in the domain of a logarithmic law."""
    law = grid.law
    if not isinstance(law, LogarithmicLaw):
        return np.zeros(grid.dR.shape, dtype=bool)
    # The domain ends at a largest load, which is the least for the softest pair.
    softest = int(grid.pairs(grid.dR[0], np.arange(grid.rows)).E_star.argmin())
    pairs = grid.pairs(grid.dR, np.array(softest))
    return np.asarray(np.isfinite(law.penetration(grid.load.max(), pairs)))


def _without_samples(grid: Grid, rows: IndexArray, dR: FloatArray) -> Moments:
    """Return the moments of rows that lie in the domain of a logarithmic law, at m clearances."""
    law = grid.law
    assert isinstance(law, LogarithmicLaw)
    clearances = grid.pairs(dR, rows[0])
    return logarithmic_moments(law, grid.pairs(dR[0], rows), grid.load, clearances)


def _at_clearance(grid: Grid, dR: float) -> Moments:
    """Return the moments at one ΔR."""
    law, rows, parts = grid.law, np.arange(grid.rows), []
    if isinstance(law, LogarithmicLaw):
        whole = np.isfinite(law.penetration(grid.load.max(), grid.pairs(dR, rows)))
        if whole.any():
            parts.append(_without_samples(grid, rows[whole], np.array([dR])))
        rows = rows[~whole]
    parts += [Moments.of_samples(dR, block.s, block.j) for block in blocks(grid, dR, rows)]
    return merge(parts)


# --- to tables ----------------------------------------------------------------------------------


def sample(grid: Grid, path: Path | str | None = None, progress: Progress = silent) -> Any:
    """Sample the reference law of a grid into a DataFrame, or in bounded memory into a file.

    Parameters
    ----------
    grid : Grid
        Where the law is sampled.
    path : path, optional
        A .parquet or .csv file, which is created when it is complete.
    progress : callable, optional
        Called with "sampling", the number of clearances done, and that of all.

    Returns
    -------
    DataFrame or Counts
        The samples in the domain of the reference, with the columns E_GPa, nu, dR_mm,
        load_N_per_mm and penetration_mm. With a path, the numbers of samples that were
        written and masked.

    Raises
    ------
    InputError
        If every sample is masked, the file cannot be written, or Parquet's library is missing.

    Examples
    --------
    >>> from cylcontact.datasets import Grid
    >>> grid = Grid("internal", "johnson", np.array([207.0]), np.array([0.3]),
    ...             np.array([0.05]), np.array([10.0, 100.0]))
    >>> sample(grid).round(7)
       E_GPa   nu  dR_mm  load_N_per_mm  penetration_mm
    0  207.0  0.3   0.05           10.0        0.000220
    1  207.0  0.3   0.05          100.0        0.001559
    """
    if path is None:
        return frame_of(grid, progress)
    return write_samples(grid, path, progress)


def frame_of(grid: Grid, progress: Progress = silent) -> pd.DataFrame:
    """Return the samples of a grid as a table, with the columns of the grid."""
    import pandas as pd  # slow to import, and a file needs none

    parts = [np.stack(columns) for columns in _columns(grid, progress)]
    return pd.DataFrame(np.concatenate(parts, axis=1).T, columns=list(grid.columns))


def write_samples(grid: Grid, path: Path | str, progress: Progress = silent) -> Counts:
    """Sample a grid into a .parquet or .csv file, in bounded memory."""
    samples, opened = 0, _parquet
    if require_suffix(path, ".parquet", ".csv") == ".csv":
        opened = _csv
    with replacing(path) as temporary, opened(temporary, grid.columns) as write:
        for columns in _columns(grid, progress):
            write(columns)
            samples += columns[0].size
    return Counts(samples, grid.size - samples)


def _columns(grid: Grid, progress: Progress) -> Iterator[list[FloatArray]]:
    """Yield the columns of the table of a grid, block by block."""
    samples = 0
    for done, dR in enumerate(grid.dR, start=1):
        for block in blocks(grid, float(dR)):
            samples += block.load.size
            clearance = np.full(block.load.size, dR)
            yield [*block.row_values, clearance, block.load, block.penetration]
        progress("sampling", done, grid.dR.size)
    require_samples(grid, samples)


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
