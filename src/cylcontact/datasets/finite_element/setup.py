"""The set-up of finite-element cases: geometry, material, boundary conditions and mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.datasets.finite_element.mesh import Grading, Mesh, make_mesh
from cylcontact.errors import InputError
from cylcontact.laws.conformal import contact_angle
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair

__all__ = ["FEWEST_CELLS", "Clamp", "LoadOn", "Plane", "Setup", "require_room"]

Plane = Literal["strain", "stress"]
LoadOn = Literal["pin", "disc", "centre"]
Clamp = Literal["upper half", "whole"]

# With fewer cells over the half-width of the contact the pressure is meaningless.
FEWEST_CELLS = 4
# For a given `size`: number of cells of that size, growth beyond, and largest cell in radii.
_EVEN_CELLS, _GROWTH, _LARGEST = 24, 1.1, 0.1


@dataclass(frozen=True)
class Setup:
    """Everything about a case except the clearance and the load.

    Parameters
    ----------
    hole_radius : float
        R_i in mm; the pin's radius is R_i − ΔR.
    outer_ratio : float
        The outer radius of the plate over R_i. It sets the additive constant of the penetration,
        because a 2-D body has no absolute approach.
    E, nu : float
        Young's modulus in MPa and Poisson's ratio of both bodies.
    plane : {"strain", "stress"}
        Plane state.
    load_on : {"pin", "disc", "centre"}
        Distribution of the load: over the pin, over a disc at its centre, or at the centre node.
    disc_ratio : float
        Radius of that disc over the radius of the pin.
    clamp : {"upper half", "whole"}
        The part of the plate's outer boundary that is fixed; the pin is pushed towards the upper
        half.
    cells : int
        Number of cells over the half-width of the contact at the smallest load.
    size : float, optional
        Length of the smallest cells in mm; replaces `cells`.
    contact_size : float, optional
        Largest length of cells in the contact in mm, used with `size`.

    Examples
    --------
    >>> setup = Setup(hole_radius=2.245, outer_ratio=3.4, E=207e3, nu=0.3)
    >>> print(f"{setup.half_width(1.0, 20.0):.4f} mm")
    0.0250 mm
    """

    hole_radius: float
    outer_ratio: float
    E: float
    nu: float
    plane: Plane = "strain"
    load_on: LoadOn = "pin"
    disc_ratio: float = 0.25
    clamp: Clamp = "upper half"
    cells: int = 16
    size: float | None = None
    contact_size: float | None = None

    @property
    def outer_radius(self) -> float:
        """The plate's outer radius in mm."""
        return self.outer_ratio * self.hole_radius

    @property
    def equivalent(self) -> tuple[float, float]:
        """E (MPa) and ν for which plane strain is equivalent to the state `plane`.

        Plane stress is equivalent to plane strain with E' = E(1 + 2ν)/(1 + ν)² and ν' = ν/(1 + ν).
        """
        if self.plane == "strain":
            return self.E, self.nu
        return self.E * (1 + 2 * self.nu) / (1 + self.nu) ** 2, self.nu / (1 + self.nu)

    def pair(self, dR: float) -> CylinderPair:
        """Return the pair of cylinders, in plane strain like the laws."""
        material = Material("finite elements", self.E, self.nu)
        return CylinderPair.from_dR("internal", dR, material, R_i=self.hole_radius)

    def half_width(self, dR: float, load: float) -> float:
        """Return the half-width of the contact in mm by Persson's law, to grade the mesh."""
        E, nu = self.equivalent
        pair = CylinderPair.from_dR("internal", dR, Material("equivalent", E, nu))
        radius = np.sqrt(self.hole_radius * (self.hole_radius - dR))
        return float(contact_angle(load, pair) * radius)

    def mesh(self, dR: float, loads: FloatArray) -> Mesh:
        """Return the mesh of one clearance for all its loads.

        Raises
        ------
        InputError
            If the clearance leaves no pin, or the cells are too large for the narrowest contact.
        """
        require_room(self, dR)
        narrow, wide = (self.half_width(dR, float(f)) for f in (loads.min(), loads.max()))
        if self.size is None:
            share = 1.44 / self.cells
            grading = Grading(narrow / self.cells, 1.1 * narrow, 1 + share, share)
        else:
            _require_fine(self.size, narrow, dR, float(loads.min()))
            even = min(1.1 * narrow, _EVEN_CELLS * self.size)
            fine = np.inf if self.contact_size is None else self.contact_size
            grading = Grading(self.size, even, _GROWTH, _LARGEST, fine, 1.1 * wide)
        return make_mesh(self.hole_radius, dR, self.outer_radius, grading)


def require_room(setup: Setup, dR: float) -> None:
    """Raise `InputError` for a clearance that is not positive or leaves no pin."""
    if not 0 < dR < setup.hole_radius:
        raise InputError(
            "finite elements",
            "dR",
            dR,
            f"must lie between 0 and the radius of the hole, {setup.hole_radius:g} mm",
            "give the radial clearance in mm",
        )


def _require_fine(size: float, half_width: float, dR: float, load: float) -> None:
    """Raise `InputError` for cells that are too long for the narrowest contact."""
    needed = half_width / FEWEST_CELLS
    if size > needed:
        raise InputError(
            "finite elements",
            "size",
            size,
            f"is too coarse: at ΔR = {dR:g} mm and {load:g} N/mm the contact's half-width is "
            f"{half_width:.3g} mm, and {FEWEST_CELLS} cells must fit into it",
            f"use {needed:.2g} mm or less, or give cells instead",
        )
