"""What both engines give for a case, in the columns of the tables."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Case"]


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
        Of the pin's centre, in mm.
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
