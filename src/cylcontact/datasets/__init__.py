"""Grids, sampling of a reference law, moments, and tables of measurements."""

from importlib import import_module
from types import ModuleType

from cylcontact.datasets.grid import Grid, read_grid
from cylcontact.datasets.moments import Moments, concatenate, merge
from cylcontact.datasets.sampling import Counts, blocks, reduce_grid, sample, write_samples

__all__ = [
    "Counts",
    "Grid",
    "Moments",
    "blocks",
    "concatenate",
    "finite_element",
    "merge",
    "read_grid",
    "reduce_grid",
    "sample",
    "write_samples",
]


def __getattr__(name: str) -> ModuleType:
    if name == "finite_element":  # it imports scikit-fem
        return import_module("cylcontact.datasets.finite_element")
    raise AttributeError(f"module 'cylcontact.datasets' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
