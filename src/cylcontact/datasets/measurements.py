"""Measurements: loads and penetrations of known pairs, checked row by row."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.datasets.measured_columns import MeasuredData
from cylcontact.errors import InputError
from cylcontact.materials import Material
from cylcontact.pair import Contact, CylinderPair
from cylcontact.units import spellings

__all__ = ["Indices", "Measurements", "measurements_of"]

_POSITIVE = (
    *("load", "penetration", "E_i", "E_j", "dR", "R_i", "R_j", "length"),
    *("load_std", "penetration_std", "weight"),
)
_KNOWN = (*_POSITIVE, "nu_i", "nu_j")
_GROUPINGS = ("rows", "material", "dR", "pair", "group")
Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Measurements:
    """N measured points, each a load and a penetration of a known pair.

    Attributes
    ----------
    data : MeasuredData
        The columns they were made from.
    rows : array of int, shape (N,)
        Indices of the rows in `data`, possibly repeated.
    columns : dict of str to array of float, shape (N,)
        Columns in mm, N and MPa.
    """

    data: MeasuredData
    rows: Indices
    columns: dict[str, FloatArray]

    def __len__(self) -> int:
        return self.rows.size

    @property
    def contact(self) -> Contact:
        """Pin in hole, or two rollers."""
        return self.data.contact

    @property
    def load(self) -> FloatArray:
        """Loads in N/mm."""
        return self.columns["load"]

    @property
    def penetration(self) -> FloatArray:
        """Penetrations in mm."""
        return self.columns["penetration"]

    @property
    def weight(self) -> FloatArray:
        """Weights of the squared residuals, with mean 1."""
        weight = self.columns.get("weight", np.ones(len(self)))
        return np.asarray(weight / weight.mean())

    @cached_property
    def pair(self) -> CylinderPair:
        """The pair of each row."""
        return _pair_of(self.contact, self.columns)

    def take(self, rows: Indices) -> Measurements:
        """Return the measurements with these indices, possibly repeated."""
        columns = {name: column[rows] for name, column in self.columns.items()}
        return Measurements(self.data, self.rows[rows], columns)

    def with_values(self, **columns: FloatArray) -> Measurements:
        """Return the same rows with other loads, penetrations or deviations."""
        return replace(self, columns=self.columns | columns)

    def line(self, row: int) -> int:
        """Return the position of a row in the table."""
        return self.data.lines[int(self.rows[row])]

    def groups(self, over: str) -> tuple[list[str], Indices]:
        """Return the names of the groups, and the group of each row.

        Parameters
        ----------
        over : {"rows", "material", "dR", "pair", "group"}
            The criterion of the grouping.

        Raises
        ------
        InputError
            If the grouping is unknown, or the table has no column `group`.
        """
        if over not in _GROUPINGS:
            raise InputError(
                "grouping", "over", over, "is unknown", f"choose {', '.join(_GROUPINGS)}"
            )
        if over == "group" and "group" not in self.data.labels:
            raise InputError(
                self.data.source,
                "group",
                None,
                "is not a column of the table",
                "add a column group, or choose rows, material, dR or pair",
            )
        names = [self._group_name(over, k) for k in range(len(self))]
        known = list(dict.fromkeys(names))
        index = {name: number for number, name in enumerate(known)}
        return known, np.array([index[name] for name in names], dtype=np.intp)

    def duplicates(self) -> list[list[int]]:
        """Return the positions of identical rows, one list for each group of them."""
        positions: dict[tuple[float, ...], list[int]] = {}
        stacked = np.column_stack(list(self.columns.values()))
        for k, row in enumerate(map(tuple, stacked.tolist())):
            positions.setdefault(row, []).append(self.line(k))
        return [lines for lines in positions.values() if len(lines) > 1]

    def _group_name(self, over: str, k: int) -> str:
        """Return the name of the group that row k belongs to."""
        if over == "rows":
            return f"{self.data.row_word} {self.line(k)}"
        if over == "dR":
            return f"ΔR = {self.columns['dR'][k]:.6g} mm"
        if over == "pair":
            return f"{self._group_name('material', k)}, {self._group_name('dR', k)}"
        words = [words for name, words in self.data.labels.items() if name.startswith(over)]
        if words:
            row = int(self.rows[k])
            return " on ".join(column[row % len(column)] for column in words)
        E_i, E_j = self.columns["E_i"][k], self.columns["E_j"][k]
        return f"E = {E_i:.6g} MPa" if E_i == E_j else f"E = {E_i:.6g} and {E_j:.6g} MPa"


def measurements_of(data: MeasuredData, source: str) -> Measurements:
    """Check columns row by row and return the measurements.

    Parameters
    ----------
    data : MeasuredData
        From `read_measured`, or from a result.
    source : str
        Its name in errors.

    Returns
    -------
    Measurements

    Raises
    ------
    InputError
        If a column is missing or has another number of rows, or a row has an impossible value;
        the message names the row.

    Examples
    --------
    >>> data = MeasuredData(
    ...     source="made up", sha256="", contact="internal", lines=[2, 3], labels={}, notes=[],
    ...     numbers={"load": [10.0, 100.0], "penetration": [2e-4, 1.6e-3], "dR": [0.05],
    ...              "E_i": [207e3], "E_j": [207e3], "nu_i": [0.3], "nu_j": [0.3]})
    >>> measured = measurements_of(data, "example")
    >>> len(measured), measured.pair.E_star.shape
    (2, (2,))
    """
    size = len(data.lines)
    _require_shapes(data, size, source)
    columns = {
        name: np.broadcast_to(np.array(values, dtype=np.float64), size).copy()
        for name, values in data.numbers.items()
    }
    for name in ("load", "penetration", "E_i", "E_j", "nu_i", "nu_j"):
        if name not in columns:
            raise InputError(source, name, None, "is required", f"add {spellings(name)}")
    for name in _POSITIVE:
        if name in columns:
            rule = "must be positive and finite"
            _require(data, source, name, columns[name], columns[name] > 0, rule)
    for name in ("nu_i", "nu_j"):
        inside = (columns[name] >= 0) & (columns[name] <= 0.5)
        _require(data, source, name, columns[name], inside, "must lie in [0, 0.5]")
    _complete_geometry(data, columns, source)
    return Measurements(data, np.arange(size), columns)


def _pair_of(contact: Contact, columns: dict[str, FloatArray]) -> CylinderPair:
    """Return the array-valued pair of columns."""
    # Laws broadcast a length like all other arguments, although its type is a single number.
    length = cast("float | None", columns.get("length"))
    material_i = Material("i", columns["E_i"], columns["nu_i"])
    material_j = Material("j", columns["E_j"], columns["nu_j"])
    R_i, R_j = columns.get("R_i"), columns.get("R_j")
    return CylinderPair(contact, columns["dR"], material_i, material_j, R_i, R_j, length)


def _require_shapes(data: MeasuredData, size: int, source: str) -> None:
    """Raise `InputError` for columns of a damaged result: unknown ones or another length."""
    for name, values in data.numbers.items():
        if name not in _KNOWN or len(values) not in (1, size):
            rule = f"is not a known column of 1 or {size} rows"
            raise InputError(source, f"numbers.{name}", None, rule, "redo the fit")
    for name, words in data.labels.items():
        if len(words) not in (1, size):
            rule = f"is not a column of 1 or {size} rows"
            raise InputError(source, f"labels.{name}", None, rule, "redo the fit")
    if not size:
        raise InputError(source, "lines", [], "must hold at least one row", "redo the fit")


def _require(
    data: MeasuredData,
    source: str,
    name: str,
    values: FloatArray,
    holds: BoolArray,
    rule: str,
    remedy: str = "correct the row, or remove it; mind the unit in the column's name",
) -> None:
    """Raise `InputError` for the first row where a rule does not hold."""
    wrong = np.flatnonzero(~(holds & np.isfinite(values)))
    if wrong.size:
        line = data.lines[int(wrong[0])]
        more = f" ({wrong.size - 1} more like it)" if wrong.size > 1 else ""
        where = f"{source}, {data.row_word} {line}"
        raise InputError(where, name, float(values[wrong[0]]), rule, remedy + more)


def _complete_geometry(data: MeasuredData, columns: dict[str, FloatArray], source: str) -> None:
    """Add those of ΔR, R_i and R_j that follow from the others."""
    given = [name for name in ("dR", "R_i", "R_j") if name in columns]
    if given not in (["dR"], ["dR", "R_i"], ["dR", "R_j"], ["R_i", "R_j"]):
        raise InputError(
            source,
            "dR, R_i, R_j",
            given,
            "must be ΔR, ΔR and one radius, or both radii",
            f"give {spellings('dR')}, or R_i and R_j in the same units",
        )
    sign = 1.0 if data.contact == "internal" else -1.0
    if given == ["dR", "R_i"]:
        columns["R_j"] = sign * (columns["R_i"] - columns["dR"])
    elif given == ["dR", "R_j"]:
        columns["R_i"] = columns["dR"] + sign * columns["R_j"]
    elif given == ["R_i", "R_j"]:
        columns["dR"] = columns["R_i"] - sign * columns["R_j"]
    for name in {"dR", "R_i", "R_j"} & {*columns}:
        rule = f"comes out not positive for {data.contact} contact (given {', '.join(given)})"
        _require(data, source, name, columns[name], columns[name] > 0, rule)
