"""Penetrations known at the nodes of a grid only, as finite elements give them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.pair import CylinderPair

__all__ = ["FINITE_ELEMENT", "TabulatedReference", "with_table"]

# The reference that stands for such a table in grid specs.
FINITE_ELEMENT = "finite-element"
# How the axes of a grid are called in a table.
_AXES = {"E": "E_GPa", "nu": "nu", "dR": "dR_mm", "load": "load_N_per_mm"}


@dataclass(frozen=True, eq=False)
class TabulatedReference:
    """A reference law that is a table: it answers at its own clearances and loads alone.

    Attributes
    ----------
    dR : array of float, shape (m,)
        Clearances in mm.
    load : array of float, shape (k,)
        Loads in N/mm, increasing.
    values : array of float, shape (m, k)
        Penetrations in mm.

    Examples
    --------
    >>> from cylcontact.materials import Material
    >>> two = TabulatedReference(np.array([0.1]), np.array([20.0, 40.0]), np.array([[4e-4, 8e-4]]))
    >>> pair = CylinderPair.from_dR("internal", 0.1, Material("steel", 207e3, 0.3))
    >>> two.penetration([40.0, 50.0], pair)
    array([0.0008,    nan])
    """

    dR: FloatArray
    load: FloatArray
    values: FloatArray

    def penetration(self, load: object, pair: CylinderPair) -> FloatArray:
        """Return the penetrations in mm; NaN between the nodes."""
        loads, dR, _ = np.broadcast_arrays(as_floats(load), as_floats(pair.dR), pair.E_star)
        column = np.searchsorted(self.load, loads).clip(max=self.load.size - 1)
        row = np.searchsorted(self.dR, dR).clip(max=self.dR.size - 1)
        there = (self.load[column] == loads) & (self.dR[row] == dR)
        return np.where(there, self.values[row, column], np.nan)


def with_table(data: dict[str, Any], source: Path) -> dict[str, Any]:
    """Return a grid spec with the numbers of the table that it names.

    Parameters
    ----------
    data : dict
        The contents of the spec: reference = "finite-element" and table, a path beside it.
    source : path
        The spec's file.

    Returns
    -------
    dict
        The same with the axes and the penetrations of the table, so that it needs no file.

    Raises
    ------
    InputError
        If it names no table, has axes of its own, or the table was edited by hand.
    """
    from cylcontact.datasets.finite_element import read_table

    name = data.get("table")
    if not isinstance(name, str):
        raise InputError(
            str(source),
            "table",
            name,
            f'is required with reference = "{FINITE_ELEMENT}"',
            "name a table that cylcontact finite-element has written, from the spec's folder",
        )
    if "axes" in data or "penetrations" in data:
        key = "axes" if "axes" in data else "penetrations"
        raise InputError(
            str(source), key, None, "cannot be combined with table", "keep one of the two"
        )
    rows = read_table(source.parent / name).rows
    rows = rows[rows["variant"] == "base"]
    axes = {axis: {"values": sorted(set(rows[column]))} for axis, column in _AXES.items()}
    nodes = rows.pivot_table("penetration_mm", "dR_mm", "load_N_per_mm").to_numpy()
    return {**data, "axes": axes, "penetrations": nodes.tolist()}
