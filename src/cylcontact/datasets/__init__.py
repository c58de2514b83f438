"""Grids, sampling of a reference law, moments, and tables of measurements."""

from cylcontact.datasets.grid import Grid, read_grid
from cylcontact.datasets.moments import Moments, concatenate, merge
from cylcontact.datasets.sampling import Counts, blocks, reduce_grid, write_samples

__all__ = [
    "Counts",
    "Grid",
    "Moments",
    "blocks",
    "concatenate",
    "merge",
    "read_grid",
    "reduce_grid",
    "write_samples",
]


def __dir__() -> list[str]:
    return __all__
