"""Two parallel cylinders in contact: geometry, materials and derived quantities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cylcontact.arrays import FloatArray, as_floats, require, same_fields
from cylcontact.errors import InputError, short
from cylcontact.html_repr import table_html
from cylcontact.materials import Material

__all__ = ["CONTACTS", "Contact", "CylinderPair", "Length"]

Contact = Literal["internal", "external"]
CONTACTS: tuple[Contact, ...] = ("internal", "external")

Length = float | FloatArray


@dataclass(frozen=True, eq=False)
class CylinderPair:
    """Two parallel cylinders: a pin in a hole (internal) or two rollers (external).

    Build one with `internal`, `external` or `from_dR`; the constructor takes all numbers as they
    are and derives none.

    Parameters
    ----------
    contact : {"internal", "external"}
        For internal contact, body *i* has the hole.
    dR : float or array_like
        ΔR in mm: R_i − R_j for internal contact (the radial clearance), R_i + R_j for
        external contact.
    material_i, material_j : Material
        The materials of the two bodies.
    R_i, R_j : float or array_like, optional
        The radii in mm, if known.
    length : float, optional
        Axial length of the contact in mm.

    Raises
    ------
    InputError
        If the contact is unknown, or a length is not positive and finite.

    Notes
    -----
    All arrays broadcast against each other and against the loads and penetrations passed to
    laws.

    Examples
    --------
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel, length=10.0)
    >>> print(f"{pair.E_star:.2f} MPa, {pair.dR:.1f} mm, {pair.R:.0f} mm")
    113736.26 MPa, 0.5 mm, 190 mm
    """

    contact: Contact
    dR: Length
    material_i: Material
    material_j: Material
    R_i: Length | None = None
    R_j: Length | None = None
    length: float | None = None

    def __post_init__(self) -> None:
        _require_contact(self.contact)
        for key in ("dR", "R_i", "R_j", "length"):
            _require_positive(key, getattr(self, key))

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other)

    __hash__ = None  # type: ignore[assignment]

    def _repr_html_(self) -> str:
        bodies = {"i": (self.R_i, self.material_i), "j": (self.R_j, self.material_j)}
        rows: dict[str, object] = {"ΔR (mm)": self.dR}
        for body, (radius, material) in bodies.items():
            rows |= {f"R_{body} (mm)": radius, f"material {body}": material.name}
        rows |= {"length (mm)": self.length, "E* (MPa)": self.E_star}
        return table_html(f"CylinderPair, {self.contact} contact", rows)

    @classmethod
    def internal(
        cls,
        R_i: Length,
        R_j: Length,
        material: Material,
        length: float | None = None,
        material_j: Material | None = None,
    ) -> CylinderPair:
        """Return a pin of radius `R_j` in a hole of radius `R_i` (mm).

        Parameters
        ----------
        R_i, R_j : float or array_like
            Radii of the hole and of the pin in mm, R_i > R_j.
        material : Material
            The material of the hole, and of the pin unless `material_j` is given.
        length : float, optional
            Axial length in mm.
        material_j : Material, optional
            The material of the pin.

        Returns
        -------
        CylinderPair

        Raises
        ------
        InputError
            If the pin does not fit in the hole.
        """
        outer, inner = as_floats(R_i), as_floats(R_j)
        _require_positive("R_i", R_i)
        _require_positive("R_j", R_j)
        require(
            outer > inner,
            "CylinderPair.internal",
            "R_j",
            R_j,
            f"the pin must be smaller than the hole (R_i = {short(R_i)})",
            "give R_i, the radius of the hole, the larger value",
        )
        return cls("internal", outer - inner, material, material_j or material, R_i, R_j, length)

    @classmethod
    def external(
        cls,
        R_i: Length,
        R_j: Length,
        material: Material,
        length: float | None = None,
        material_j: Material | None = None,
    ) -> CylinderPair:
        """Return two rollers of radii `R_i` and `R_j` (mm).

        Parameters
        ----------
        R_i, R_j : float or array_like
            Radii in mm.
        material : Material
            The material of roller *i*, and of roller *j* unless `material_j` is given.
        length : float, optional
            Axial length in mm.
        material_j : Material, optional
            The material of roller *j*.

        Returns
        -------
        CylinderPair
        """
        _require_positive("R_i", R_i)
        _require_positive("R_j", R_j)
        dR = as_floats(R_i) + as_floats(R_j)
        return cls("external", dR, material, material_j or material, R_i, R_j, length)

    @classmethod
    def from_dR(
        cls,
        contact: Contact,
        dR: Length,
        material: Material,
        length: float | None = None,
        R_i: Length | None = None,
        material_j: Material | None = None,
    ) -> CylinderPair:
        """Return a pair given by its ΔR, for laws that depend on ΔR alone.

        Parameters
        ----------
        contact : {"internal", "external"}
            Pin in hole, or two rollers.
        dR : float or array_like
            ΔR in mm.
        material : Material
            The material of both bodies, or of body *i* when `material_j` is given.
        length : float, optional
            Axial length in mm.
        R_i : float or array_like, optional
            The radius of body *i* in mm; the radius of body *j* then follows from ΔR.
        material_j : Material, optional
            The material of body *j*.

        Returns
        -------
        CylinderPair

        Raises
        ------
        InputError
            If `R_i` and ΔR leave no room for body *j*.
        """
        R_j = None
        _require_contact(contact)
        _require_positive("dR", dR)
        _require_positive("R_i", R_i)
        if R_i is not None:
            difference = as_floats(R_i) - as_floats(dR)
            R_j = difference if contact == "internal" else -difference
            require(
                R_j > 0,
                "CylinderPair.from_dR",
                "dR",
                dR,
                f"leaves body j a radius that is not positive (R_i = {short(R_i)})",
                "internal contact needs dR < R_i, external contact dR > R_i",
            )
        return cls(contact, dR, material, material_j or material, R_i, R_j, length)

    @property
    def E_star(self) -> FloatArray:
        """Composite modulus in MPa: 1/E* = (1 − ν_i²)/E_i + (1 − ν_j²)/E_j."""
        compliance_i = 1 / self.material_i.plane_strain_modulus
        compliance_j = 1 / self.material_j.plane_strain_modulus
        return as_floats(1 / (compliance_i + compliance_j))

    @property
    def R(self) -> FloatArray:
        """Effective radius R_i·R_j/ΔR in mm.

        Raises
        ------
        InputError
            If the radii are not known.
        """
        R_i, R_j = self.radii("the effective radius")
        return as_floats(R_i * R_j / as_floats(self.dR))

    def radii(self, purpose: str) -> tuple[FloatArray, FloatArray]:
        """Return R_i and R_j in mm; raise `InputError` naming `purpose` if they are not known."""
        if self.R_i is None or self.R_j is None:
            raise InputError(
                "CylinderPair",
                "R_i, R_j",
                None,
                f"{purpose} needs both radii and this pair knows only ΔR",
                "build it with CylinderPair.internal or .external, or pass R_i to from_dR",
            )
        return as_floats(self.R_i), as_floats(self.R_j)

    def contact_length(self, purpose: str) -> float:
        """Return the axial length in mm; raise `InputError` naming `purpose` if it is not known."""
        if self.length is None:
            raise InputError(
                "CylinderPair",
                "length",
                None,
                f"{purpose} needs the axial length and this pair has none",
                "pass length= in mm when the pair is built",
            )
        return self.length


def _require_contact(contact: object) -> None:
    """Raise `InputError` for a contact that is neither internal nor external."""
    require(
        contact in CONTACTS,
        "CylinderPair",
        "contact",
        contact,
        "must be 'internal' or 'external'",
        "internal is a pin in a hole, external two rollers",
    )


def _require_positive(key: str, value: object) -> None:
    """Raise `InputError` for a length that is not positive and finite; None is allowed."""
    if value is None:
        return
    numbers = as_floats(value)
    require(
        (numbers > 0) & np.isfinite(numbers),
        "CylinderPair",
        key,
        value,
        "must be positive and finite",
        "give it in mm",
    )
