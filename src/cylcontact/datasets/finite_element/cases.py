"""Solved cases, as both engines return them."""

from __future__ import annotations

from dataclasses import dataclass

from cylcontact.datasets.finite_element.setup import Setup

__all__ = ["Case", "Row"]


@dataclass(frozen=True)
class Case:
    """One solved case.

    Attributes
    ----------
    dR : float
        Clearance in mm.
    load : float
        In N/mm.
    penetration : float
        Penetration of the pin's centre in mm.
    half_width : float
        Half-width of the contact along the hole's surface, in mm; NaN from CalculiX.
    peak_pressure : float
        In MPa.
    cells : int
        Quads in the mesh.
    """

    dR: float
    load: float
    penetration: float
    half_width: float
    peak_pressure: float
    cells: int


@dataclass(frozen=True)
class Row:
    """A solved case and the set-up it belongs to: a row of a study's table.

    Attributes
    ----------
    variant : str
        The set-up's name in its study.
    setup : Setup
        The set-up.
    case : Case
        The solution.
    """

    variant: str
    setup: Setup
    case: Case

    @property
    def place(self) -> tuple[str, float, float]:
        """Variant, clearance in mm and load in N/mm, which identify the row in its study."""
        return self.variant, self.case.dR, self.case.load
