"""Grids of E, ν, ΔR and load on which a reference law is sampled."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from cylcontact.bodies.material import LARGEST_MODULUS, material_in_MPa
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.files.spec import Spec, broken, parse_spec, read_toml
from cylcontact.laws import REFERENCES, ContactLaw, reference_law
from cylcontact.support.arrays import FloatArray, IndexArray
from cylcontact.support.errors import InputError

_POSITIVE_AXES = ("E", "dR", "load")
_UNITS = {"E": "GPa", "nu": "dimensionless", "dR": "mm", "load": "N/mm"}
# No real contact is outside these limits, and no law overflows inside.
_SMALLEST, _LARGEST = 1e-12, 1e12
# An axis is held in memory, unlike the grid.
_MAX_POINTS = 10_000_000


class AxisSpec(Spec):
    """One axis: either min, max, points and spacing, or a list of values."""

    min: float | None = Field(None, description="the axis's first value, a number")
    max: float | None = Field(None, description="the axis's last value, a number")
    points: int | None = Field(None, description="the number of points, an integer of at least 2")
    spacing: Literal["log", "linear"] | None = Field(None, description='"log" or "linear"')
    values: tuple[float, ...] | None = Field(
        None, description="a list of increasing numbers", strict=False
    )

    @model_validator(mode="after")
    def _check(self) -> AxisSpec:
        ranged = {k: getattr(self, k) for k in ("min", "max", "points", "spacing")}
        if self.values is not None:
            others = [key for key, value in ranged.items() if value is not None]
            if others:
                remedy = "keep either the range or the values"
                raise broken(others[0], None, "cannot be combined with values", remedy)
            if not self.values or any(b <= a for a, b in pairwise(self.values)):
                rule, remedy = "must be a list of increasing numbers", "sort it, drop repeats"
                raise broken("values", list(self.values), rule, remedy)
            return self
        for key, value in ranged.items():
            if value is None:
                remedy = "an axis takes min, max, points and spacing, or values = [...]"
                raise broken(key, None, "is required", remedy)
        low, high, points = self.min or 0.0, self.max or 0.0, self.points or 0
        if low >= high:
            raise broken("min", low, f"must be below max = {high}", "exchange or correct them")
        if points < 2:
            raise broken("points", points, "must be at least 2", "for one value use values = [...]")
        if points > _MAX_POINTS:
            raise broken("points", points, f"must be at most {_MAX_POINTS}", "thin the axis")
        if self.spacing == "log" and low <= 0:
            rule, remedy = "log spacing needs a positive min", 'raise it, or use "linear"'
            raise broken("min", low, rule, remedy)
        return self

    def numbers(self) -> FloatArray:
        """Return the axis's values, shape (points,)."""
        if self.values is not None:
            return np.array(self.values, dtype=np.float64)
        spaced = np.geomspace if self.spacing == "log" else np.linspace
        return np.asarray(spaced(self.min or 0.0, self.max or 0.0, self.points or 0))


class AxesSpec(Spec):
    """The four axes of a grid."""

    E: AxisSpec = Field(description="a table [axes.E] for Young's modulus in GPa")
    nu: AxisSpec = Field(description="a table [axes.nu] for Poisson's ratio")
    dR: AxisSpec = Field(description="a table [axes.dR] for ΔR in mm")
    load: AxisSpec = Field(description="a table [axes.load] for the load in N/mm")

    @model_validator(mode="after")
    def _check(self) -> AxesSpec:
        for name in _POSITIVE_AXES:
            _check_positive(name, getattr(self, name), f"give it in {_UNITS[name]}")
        stiffest = float(self.E.numbers()[-1])
        if stiffest > LARGEST_MODULUS * 1e-3:
            rule = f"must be at most {LARGEST_MODULUS * 1e-3:g} GPa, and diamond has 1200"
            raise broken("E", stiffest, rule, "give it in GPa, e.g. 207 for steel")
        ratio = self.nu.numbers()
        if ratio[0] < 0 or ratio[-1] > 0.5:
            rule = "Poisson's ratio must lie in [0, 0.5]"
            raise broken("nu", [float(ratio[0]), float(ratio[-1])], rule, "narrow the axis")
        return self


def _check_positive(name: str, axis: AxisSpec, remedy: str) -> None:
    """Raise an error for an axis with values that are not positive, or beyond every contact's."""
    numbers = axis.numbers()
    for end in (float(numbers[0]), float(numbers[-1])):
        if not _SMALLEST <= end <= _LARGEST:
            rule = f"must lie between {_SMALLEST:g} and {_LARGEST:g}"
            if end <= 0:
                rule = "every value must be positive"
            raise broken(name, end, rule, remedy)


class GridSpec(Spec):
    """A grid spec file."""

    contact: Contact = Field(description='"internal" or "external"')
    reference: str = Field(description=f"the law to sample, one of {', '.join(REFERENCES)}")
    axes: AxesSpec = Field(description="the tables [axes.E], [axes.nu], [axes.dR], [axes.load]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.reference not in REFERENCES:
            rule = "is not a law that a grid can sample"
            raise broken("reference", self.reference, rule, f"choose among {', '.join(REFERENCES)}")
        pair = CylinderPair.from_dR(self.contact, 1.0, material_in_MPa("any", 1.0, 0.0))
        try:
            reference_law(self.reference).max_load(pair)
        except InputError as error:
            raise broken("reference", self.reference, error.rule, error.remedy) from None
        return self


@dataclass(frozen=True, eq=False)
class Grid:
    """The Cartesian product of values of E, ν, ΔR and load, and the law to sample there.

    Attributes
    ----------
    contact : {"internal", "external"}
        Pin in hole, or two rollers.
    reference : str
        Name of the law sampled.
    E, nu, dR, load : array of float
        The axes, in GPa, -, mm and N/mm.
    source : str
        The name of the grid in error messages.

    Examples
    --------
    >>> grid = Grid("internal", "johnson", np.array([207.0]), np.array([0.3]),
    ...             np.array([0.05, 0.5]), np.array([10.0, 100.0, 1000.0]))
    >>> grid.shape, grid.size
    ((1, 1, 2, 3), 6)
    """

    contact: Contact
    reference: str
    E: FloatArray
    nu: FloatArray
    dR: FloatArray
    load: FloatArray
    source: str = "grid"
    columns: ClassVar[tuple[str, ...]] = ("E_GPa", "nu", "dR_mm", "load_N_per_mm", "penetration_mm")

    @property
    def law(self) -> ContactLaw:
        """The reference law."""
        return reference_law(self.reference)

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Points along E, ν, ΔR and load."""
        return (self.E.size, self.nu.size, self.dR.size, self.load.size)

    @property
    def rows(self) -> int:
        """Number of combinations of E and ν."""
        return self.E.size * self.nu.size

    @property
    def size(self) -> int:
        """Number of combinations."""
        return self.rows * self.dR.size * self.load.size

    def row_values(self, rows: IndexArray) -> tuple[FloatArray, FloatArray]:
        """Return E in GPa and ν of rows, with E varying slowest."""
        return self.E[rows // self.nu.size], self.nu[rows % self.nu.size]

    def pairs(self, dR: float | FloatArray, rows: IndexArray) -> CylinderPair:
        """Return the pairs of rows at ΔR in mm, in the shape of both."""
        E, nu = self.row_values(rows)
        return CylinderPair.from_dR(self.contact, dR, material_in_MPa("grid", E * 1e3, nu))


def read_grid(path: Path | str) -> Grid:
    """Read a grid spec.

    Parameters
    ----------
    path : path
        A TOML file with contact, reference and the tables axes.E (GPa), axes.nu, axes.dR
        (mm) and axes.load (N/mm).

    Returns
    -------
    Grid

    Raises
    ------
    InputError
        If the file is not a grid spec; the message has key, value, rule and remedy.
    """
    return grid_from(read_toml(path), str(path))


def grid_from(data: dict[str, Any], source: str) -> Grid:
    """Return the grid described by the contents of a spec."""
    spec = parse_spec(GridSpec, data, source)
    E, nu, dR, load = (getattr(spec.axes, name).numbers() for name in ("E", "nu", "dR", "load"))
    return Grid(spec.contact, spec.reference, E, nu, dR, load, source)
