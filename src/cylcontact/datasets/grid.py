"""Grids of E, ν, ΔR and load on which a reference law is sampled."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, model_validator

from cylcontact.arrays import FloatArray
from cylcontact.datasets.tabulated import FINITE_ELEMENT, TabulatedReference, with_table
from cylcontact.errors import InputError
from cylcontact.laws import REFERENCES, ContactLaw, reference_law
from cylcontact.materials import Material
from cylcontact.pair import Contact, CylinderPair
from cylcontact.spec import Spec, broken, parse_spec, read_toml

__all__ = ["AxesSpec", "AxisSpec", "Grid", "GridSpec", "grid_from", "read_grid", "read_grid_data"]

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
            _check_values(self.values, [k for k, v in ranged.items() if v is not None])
            return self
        missing = [key for key, value in ranged.items() if value is None]
        if missing:
            raise broken(
                missing[0],
                None,
                "is required",
                "an axis takes min, max, points and spacing, or values = [...]",
            )
        self._check_range()
        return self

    def _check_range(self) -> None:
        low, high, points = self.min or 0.0, self.max or 0.0, self.points or 0
        if low >= high:
            raise broken("min", low, f"must be below max = {high}", "exchange or correct them")
        if points < 2:
            raise broken("points", points, "must be at least 2", "for one value use values = [...]")
        if points > _MAX_POINTS:
            raise broken("points", points, f"must be at most {_MAX_POINTS}", "thin the axis")
        if self.spacing == "log" and low <= 0:
            raise broken(
                "min", low, "log spacing needs a positive min", 'raise it, or use "linear"'
            )

    def numbers(self) -> FloatArray:
        """Return the axis's values, shape (points,)."""
        if self.values is not None:
            return np.array(self.values, dtype=np.float64)
        spaced = np.geomspace if self.spacing == "log" else np.linspace
        return np.asarray(spaced(self.min or 0.0, self.max or 0.0, self.points or 0))


def _check_values(values: tuple[float, ...], others: list[str]) -> None:
    """Raise an error for an empty or unordered list, or one combined with a range."""
    if others:
        raise broken(
            others[0], None, "cannot be combined with values", "keep either the range or the values"
        )
    if not values or any(b <= a for a, b in pairwise(values)):
        raise broken(
            "values", list(values), "must be a list of increasing numbers", "sort it, drop repeats"
        )


class AxesSpec(Spec):
    """The four axes."""

    E: AxisSpec = Field(description="a table [axes.E] for Young's modulus in GPa")
    nu: AxisSpec = Field(description="a table [axes.nu] for Poisson's ratio")
    dR: AxisSpec = Field(description="a table [axes.dR] for ΔR in mm")
    load: AxisSpec = Field(description="a table [axes.load] for the load in N/mm")

    @model_validator(mode="after")
    def _check(self) -> AxesSpec:
        for name in _POSITIVE_AXES:
            numbers = getattr(self, name).numbers()
            for end in (float(numbers[0]), float(numbers[-1])):
                if not _SMALLEST <= end <= _LARGEST:
                    rule = f"must lie between {_SMALLEST:g} and {_LARGEST:g}"
                    if end <= 0:
                        rule = "every value must be positive"
                    raise broken(name, end, rule, f"give it in {_UNITS[name]}")
        ratio = self.nu.numbers()
        if ratio[0] < 0 or ratio[-1] > 0.5:
            raise broken(
                "nu",
                [float(ratio[0]), float(ratio[-1])],
                "Poisson's ratio must lie in [0, 0.5]",
                "narrow the axis",
            )
        return self


class GridSpec(Spec):
    """A grid spec file."""

    contact: Contact = Field(description='"internal" or "external"')
    reference: str = Field(
        description=f"the law to sample, one of {', '.join(REFERENCES)}, or {FINITE_ELEMENT}"
    )
    axes: AxesSpec = Field(description="the tables [axes.E], [axes.nu], [axes.dR], [axes.load]")

    table: str | None = Field(
        None, description=f"the table of finite elements, with reference {FINITE_ELEMENT}"
    )
    penetrations: list[list[float]] | None = Field(
        None, description="the table's penetrations in mm, a list for each ΔR"
    )

    @model_validator(mode="after")
    def _check(self) -> GridSpec:
        if self.reference == FINITE_ELEMENT:
            _check_penetrations(self.contact, self.axes, self.penetrations)
            return self
        if self.table is not None or self.penetrations is not None:
            key = "table" if self.table is not None else "penetrations"
            rule = f"is used only with reference {FINITE_ELEMENT}"
            raise broken(key, None, rule, "drop it")
        if self.reference not in REFERENCES:
            raise broken(
                "reference",
                self.reference,
                "is not a law that a grid can sample",
                f"choose among {', '.join(REFERENCES)}, {FINITE_ELEMENT}",
            )
        try:
            pair = CylinderPair.from_dR(self.contact, 1.0, Material("any", E=1.0, nu=0.0))
            reference_law(self.reference).max_load(pair)
        except InputError as error:
            raise broken("reference", self.reference, error.rule, error.remedy) from None
        return self


def _check_penetrations(
    contact: Contact, axes: AxesSpec, penetrations: list[list[float]] | None
) -> None:
    """Raise an error unless there is a positive penetration at each node of an internal grid."""
    if contact != "internal":
        rule = f"must be internal with reference {FINITE_ELEMENT}"
        raise broken("contact", contact, rule, "finite elements here are of a pin in a hole")
    sizes = [getattr(axes, name).numbers().size for name in ("E", "nu", "dR", "load")]
    lengths = [len(row) for row in penetrations or ()]
    if sizes[:2] != [1, 1] or lengths != [sizes[3]] * sizes[2]:
        raise broken(
            "penetrations",
            None,
            "must hold one E, one nu, and a list for each dR with a number for each load",
            "name the table instead: table = ...",
        )
    if min(min(row) for row in penetrations or ()) <= 0:
        raise broken("penetrations", None, "must be positive", "give them in mm")


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
        Its name in errors.
    penetrations : array of float, shape (ΔR, load), optional
        In mm, if the reference is a table of finite elements.

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
    penetrations: FloatArray | None = None

    @property
    def law(self) -> ContactLaw | TabulatedReference:
        """The reference law, or the table in its place."""
        if self.penetrations is not None:
            return TabulatedReference(self.dR, self.load, self.penetrations)
        return reference_law(self.reference)

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Points along E, ν, ΔR and load."""
        return (self.E.size, self.nu.size, self.dR.size, self.load.size)

    @property
    def size(self) -> int:
        """Number of combinations."""
        nE, nnu, ndR, nload = self.shape
        return nE * nnu * ndR * nload

    @property
    def rows(self) -> int:
        """Number of combinations of E and ν."""
        return self.E.size * self.nu.size


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
    return grid_from(read_grid_data(path), str(path))


def read_grid_data(path: Path | str) -> dict[str, Any]:
    """Return the contents of a grid spec, with a named table replaced by its contents.

    Raises
    ------
    InputError
        If the file is not TOML, or the table is missing or was edited by hand.
    """
    data = read_toml(path)
    return with_table(data, Path(path)) if data.get("reference") == FINITE_ELEMENT else data


def grid_from(data: dict[str, Any], source: str) -> Grid:
    """Return the grid described by the contents of a spec."""
    spec = parse_spec(GridSpec, data, source)
    axes = spec.axes
    return Grid(
        contact=spec.contact,
        reference=spec.reference,
        E=axes.E.numbers(),
        nu=axes.nu.numbers(),
        dR=axes.dR.numbers(),
        load=axes.load.numbers(),
        source=source,
        penetrations=None if spec.penetrations is None else np.array(spec.penetrations),
    )
