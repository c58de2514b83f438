"""Penetrations at the nodes of a grid, from a table of finite elements."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError

# The name of such a reference in grid specs.
FINITE_ELEMENT = "finite-element"
# The columns of a table by the axes of a grid.
_AXES = {"E": "E_GPa", "nu": "nu", "dR": "dR_mm", "load": "load_N_per_mm"}


@dataclass(frozen=True, eq=False)
class TabulatedReference:
    """A reference law given by a table, defined at its clearances and loads only."""

    dR: FloatArray
    load: FloatArray
    values: FloatArray

    def penetration(self, load: object, pair: CylinderPair) -> FloatArray:
        """Return the penetrations in mm; NaN between the nodes."""
        loads, dR, _ = np.broadcast_arrays(as_floats(load), as_floats(pair.dR), pair.E_star)
        column = np.searchsorted(self.load, loads).clip(max=self.load.size - 1)
        row = np.searchsorted(self.dR, dR).clip(max=self.dR.size - 1)
        at_node = (self.load[column] == loads) & (self.dR[row] == dR)
        return np.where(at_node, self.values[row, column], np.nan)


def with_table(data: dict[str, Any], source: Path) -> dict[str, Any]:
    """Return a grid spec with the contents of the table that it names."""
    from cylcontact.datasets.finite_element import read_table
    from cylcontact.datasets.finite_element.study import PIN_COLUMNS

    name = data.get("table")
    if not isinstance(name, str):
        rule = f'is required with reference = "{FINITE_ELEMENT}"'
        remedy = "name a table that cylcontact finite-element has written, from the spec's folder"
        raise InputError(str(source), "table", name, rule, remedy)
    if "axes" in data or "penetrations" in data:
        key = "axes" if "axes" in data else "penetrations"
        raise InputError(
            str(source), key, None, "cannot be combined with table", "keep one of the two"
        )
    rows = read_table(source.parent / name).rows
    rows = rows[rows["variant"] == "base"]
    of_pin = dict(zip(PIN_COLUMNS, ("E_GPa", "nu"), strict=True))
    if any((rows.get(pin, rows[own]) != rows[own]).any() for pin, own in of_pin.items()):
        rule = "is of a pin and a plate of different materials"
        remedy = "name one of a single material, as grids are"
        raise InputError(str(source), "table", name, rule, remedy)
    axes = {axis: {"values": sorted(set(rows[column]))} for axis, column in _AXES.items()}
    nodes = rows.pivot_table("penetration_mm", "dR_mm", "load_N_per_mm").to_numpy()
    return {**data, "axes": axes, "penetrations": nodes.tolist()}
