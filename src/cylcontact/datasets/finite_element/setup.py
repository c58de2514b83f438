"""The set-up of finite-element cases: geometry, material, boundary conditions and mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cylcontact.arrays import FloatArray, require
from cylcontact.datasets.finite_element.mesh import Grading, Mesh, make_mesh
from cylcontact.errors import InputError
from cylcontact.laws import Conformal, Sector
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair, Plane

__all__ = ["FEWEST_CELLS", "BodyName", "Clamp", "LoadOn", "Plane", "Setup", "require_room"]

BodyName = Literal["plate", "pin"]
LoadOn = Literal["pin", "disc", "centre"]
Clamp = Literal["upper half", "whole"]

# With fewer cells over the half-width of the contact the pressure is meaningless.
FEWEST_CELLS = 4
# For a given `size`: number of cells of that size, growth beyond, and largest cell in radii.
_EVEN_CELLS, _GROWTH, _LARGEST = 24, 1.1, 0.1
# Rounding costs 1e-5 of the penetration at 1 − 2ν = 2e-11 and is inversely proportional to 1 − 2ν.
_LARGEST_NU = 0.499999


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
        Young's modulus as in `Material`, in MPa or with its unit, and Poisson's ratio of the plate,
        and of the pin unless it has its own.
    plane : {"strain", "stress"}
        Plane state.
    load_on : {"pin", "disc", "centre"}
        Distribution of the load: over the pin, over a disc at its centre, or at the centre node.
    disc_ratio : float
        Radius of that disc over the radius of the pin.
    clamp : {"upper half", "whole"} or Sector
        The part of the plate's outer boundary that is fixed; the pin is pushed towards the upper
        half. A sector, as a `Housing` has it, ends at the node next to its angle; the cells are
        graded to its end, unless that is in front of where contact may extend.
    cells : int
        Number of cells over the half-width of the contact at the smallest load.
    size : float, optional
        Length of the smallest cells in mm; replaces `cells`.
    contact_size : float, optional
        Largest length of cells in the contact in mm, used with `size`.
    pin_E, pin_nu : float, optional
        Young's modulus as E and Poisson's ratio of the pin; each by default the plate's.

    Raises
    ------
    InputError
        If a modulus is refused by `Material`, or a body in plane strain is incompressible: ν must
        not exceed 0.499999.

    Examples
    --------
    >>> setup = Setup(hole_radius=2.245, outer_ratio=3.4, E=207e3, nu=0.3)
    >>> print(f"{setup.half_width(1.0, 20.0):.4f} mm")
    0.0250 mm

    An aluminium pin in the same hole:

    >>> setup = Setup(2.245, 3.4, E=207e3, nu=0.3, pin_E=70e3, pin_nu=0.33)
    >>> print(f"{setup.half_width(1.0, 20.0):.4f} mm")
    0.0349 mm
    """

    hole_radius: float
    outer_ratio: float
    E: float | str
    nu: float
    plane: Plane = "strain"
    load_on: LoadOn = "pin"
    disc_ratio: float = 0.25
    clamp: Clamp | Sector = "upper half"
    cells: int = 16
    size: float | None = None
    contact_size: float | None = None
    pin_E: float | str | None = None
    pin_nu: float | None = None

    def __post_init__(self) -> None:
        for body in ("plate", "pin"):
            self.material(body)
        for key, nu in (("nu", self.nu), ("pin_nu", self.pin_nu)):
            require(
                self.plane == "stress" or nu is None or nu <= _LARGEST_NU,
                "finite elements",
                key,
                nu,
                f"must not exceed {_LARGEST_NU:g} in plane strain: the stiffness of an "
                "incompressible body is infinite",
                "use 0.4999, or laws.Conformal(), which takes 0.5",
            )

    @property
    def outer_radius(self) -> float:
        """The plate's outer radius in mm."""
        return self.outer_ratio * self.hole_radius

    def material(self, of: BodyName) -> Material:
        """Return the material of a body."""
        E = self.E if of == "plate" or self.pin_E is None else self.pin_E
        nu = self.nu if of == "plate" or self.pin_nu is None else self.pin_nu
        return Material(of, E, nu)

    @property
    def pin_is_other(self) -> bool:
        """Whether the pin has its own E or ν."""
        return (self.pin_E, self.pin_nu) != (None, None)

    def equivalent(self, of: BodyName) -> tuple[float, float]:
        """Return E (MPa) and ν of a body for which plane strain is equivalent to the state `plane`.

        Plane stress is equivalent to plane strain with E' = E(1 + 2ν)/(1 + ν)² and ν' = ν/(1 + ν).
        """
        material = self.material(of)
        E, nu = float(material.E), float(material.nu)
        if self.plane == "strain":
            return E, nu
        return E * (1 + 2 * nu) / (1 + nu) ** 2, nu / (1 + nu)

    def pair(self, dR: float) -> CylinderPair:
        """Return the pair of cylinders."""
        plate, pin = self.material("plate"), self.material("pin")
        return CylinderPair.from_dR(
            "internal", dR, R_i=self.hole_radius, pin=pin, hole=plate, plane=self.plane
        )

    @property
    def clamp_end(self) -> float | None:
        """Where a clamped sector ends, in radians from the top."""
        if not isinstance(self.clamp, Sector):
            return None
        half = np.radians(self.clamp.angle) / 2
        return float(half if self.clamp.side == "near" else np.pi - half)

    def half_width(self, dR: float, load: float) -> float:
        """Return the half-width of the contact in mm by the reference law, to grade the mesh."""
        pair = self.pair(dR)
        radius = np.sqrt(self.hole_radius * (self.hole_radius - dR))
        return float(np.radians(Conformal().contact_angle(load, pair)) * radius)

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
        return make_mesh(self.hole_radius, dR, self.outer_radius, grading, self.clamp_end)


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
