"""Two parallel cylinders in contact: geometry, materials and derived quantities."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np

from cylcontact.arrays import (
    BoolArray,
    FloatArray,
    as_floats,
    as_numbers,
    own_arrays,
    require,
    require_one_shape,
    same_fields,
)
from cylcontact.errors import InputError, short
from cylcontact.html_repr import table_html
from cylcontact.materials import Material, material_in_MPa

__all__ = [
    "CONTACTS",
    "PLANES",
    "Contact",
    "CylinderPair",
    "Length",
    "Plane",
    "are_possible",
    "roles",
    "unusual_lengths",
]

Contact = Literal["internal", "external"]
CONTACTS: tuple[Contact, ...] = ("internal", "external")
Plane = Literal["strain", "stress"]
PLANES: tuple[Plane, ...] = ("strain", "stress")

Length = float | FloatArray

# ΔR may differ from that of the radii by rounding, as a part of the larger one.
_AGREEMENT = 1e-6
# What lengths can hardly be meant, outside all that is built: metres or µm for mm, a diameter for a
# radius, a wrong millimetre.
_LENGTHS = 0.1, 5000.0  # mm
_CLEARANCES = 1e-5, 0.08  # over the radius of the hole
_SLENDERNESS = 0.02, 100.0  # length over radius
# And α and β may leave the possible ones by that much.
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class CylinderPair:
    """Two parallel cylinders: a pin in a hole (internal) or two rollers (external).

    Build one with `internal`, `external` or `from_dR`; the constructor takes all numbers as they
    are and derives none.

    Parameters
    ----------
    contact : {"internal", "external"}
        For internal contact, *i* is the hole and *j* the pin.
    dR : float or array_like
        ΔR in mm: R_i − R_j for internal contact (the radial clearance), R_i + R_j for
        external contact.
    material_i, material_j : Material
        The materials of the two bodies: of hole and pin, or of the rollers.
    R_i, R_j : float or array_like, optional
        The radii in mm, if known.
    length : float, optional
        Axial length of the contact in mm.
    plane : {"strain", "stress"}
        Plane strain for long cylinders, plane stress for thin discs and sheets.

    Raises
    ------
    InputError
        If the contact or the plane is unknown, a material is not a `Material`, a length is not
        positive and finite, or ΔR is not that of the radii.

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
    plane: Plane = "strain"

    def __post_init__(self) -> None:
        _require_contact(self.contact)
        require(
            self.plane in PLANES,
            "CylinderPair",
            "plane",
            self.plane,
            "must be 'strain' or 'stress'",
            "plane strain is for long cylinders, plane stress for thin sheets",
        )
        for key in ("material_i", "material_j"):
            require(
                isinstance(getattr(self, key), Material),
                "CylinderPair",
                key,
                getattr(self, key),
                "must be a Material",
                "e.g. Material.named('bronze'), or Material(name, E, nu)",
            )
        lengths = ("dR", "R_i", "R_j", "length")
        for key in lengths:
            if key == "dR" or getattr(self, key) is not None:
                _require_positive(key, getattr(self, key))
        own_arrays(self)
        given = {key: getattr(self, key) for key in lengths}
        bodies = {"material_i": self.material_i, "material_j": self.material_j}
        given |= {f"E of {key}": body.E for key, body in bodies.items()}
        given |= {f"nu of {key}": body.nu for key, body in bodies.items()}
        if any(isinstance(value, np.ndarray) for value in given.values()):
            known = {key: value for key, value in given.items() if value is not None}
            require_one_shape("CylinderPair", **known)
        if self.R_i is not None and self.R_j is not None:
            _require_agreement(self.contact, self.dR, self.R_i, self.R_j)
        elif self.R_i is not None:
            _other_radius("CylinderPair", self.contact, self.dR, R_i=self.R_i)
        elif self.R_j is not None and self.contact == "external":
            _other_radius("CylinderPair", self.contact, self.dR, R_j=self.R_j)

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        shown = ", ".join(
            f"{field.name}={getattr(self, field.name)!r}"
            for field in fields(self)
            if field.name != "plane" or self.plane != "strain"
        )
        return f"CylinderPair({shown})"

    def _repr_html_(self) -> str:
        first, second = roles(self.contact)
        rows: dict[str, object] = {
            "ΔR (mm)": self.dR,
            f"R_i, {first} (mm)": self.R_i,
            f"material, {first}": self.material_i.name,
            f"R_j, {second} (mm)": self.R_j,
            f"material, {second}": self.material_j.name,
        }
        rows |= {"length (mm)": self.length, "E* (MPa)": self.E_star}
        if self.plane != "strain":
            rows["plane"] = self.plane
        return table_html(f"CylinderPair, {self.contact} contact", rows)

    @classmethod
    def internal(
        cls,
        R_i: Length,
        R_j: Length,
        material: Material | None = None,
        length: float | None = None,
        material_j: Material | None = None,
        *,
        pin: Material | None = None,
        hole: Material | None = None,
        plane: Plane = "strain",
    ) -> CylinderPair:
        """Return a pin of radius `R_j` in a hole of radius `R_i` (mm).

        Parameters
        ----------
        R_i, R_j : float or array_like
            Radii of the hole and of the pin in mm, R_i > R_j.
        material : Material, optional
            The material of the hole, and of the pin unless `material_j` is given.
        length : float, optional
            Axial length in mm.
        material_j : Material, optional
            The material of the pin.
        pin, hole : Material, optional
            The two materials by name, in place of `material` and `material_j`.
        plane : {"strain", "stress"}
            Plane strain, or plane stress for thin sheets.

        Returns
        -------
        CylinderPair

        Raises
        ------
        InputError
            If the pin does not fit in the hole, or the materials are not given just once.

        Examples
        --------
        >>> bronze, steel = Material("bronze", 110e3, 0.34), Material("steel", 207e3, 0.3)
        >>> pair = CylinderPair.internal(10.0, 9.95, pin=bronze, hole=steel)
        >>> pair.material_j.name
        'bronze'
        """
        outer, inner = _lengths(R_i=R_i, R_j=R_j)
        require(
            outer > inner,
            "CylinderPair.internal",
            "R_j",
            R_j,
            f"the pin must be smaller than the hole (R_i = {short(R_i)})",
            "give R_i, the radius of the hole, the larger value; both are radii, not diameters",
        )
        first, second = _bodies("CylinderPair.internal", material, material_j, pin, hole)
        return cls("internal", outer - inner, first, second, R_i, R_j, length, plane)

    @classmethod
    def external(
        cls,
        R_i: Length,
        R_j: Length,
        material: Material,
        length: float | None = None,
        material_j: Material | None = None,
        *,
        plane: Plane = "strain",
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
        plane : {"strain", "stress"}
            Plane strain, or plane stress for thin sheets.

        Returns
        -------
        CylinderPair
        """
        outer, inner = _lengths(R_i=R_i, R_j=R_j)
        return cls(
            "external", outer + inner, material, material_j or material, R_i, R_j, length, plane
        )

    @classmethod
    def from_dR(
        cls,
        contact: Contact,
        dR: Length,
        material: Material | None = None,
        length: float | None = None,
        R_i: Length | None = None,
        material_j: Material | None = None,
        *,
        pin: Material | None = None,
        hole: Material | None = None,
        plane: Plane = "strain",
    ) -> CylinderPair:
        """Return a pair given by its ΔR, for laws that depend on ΔR alone.

        Parameters
        ----------
        contact : {"internal", "external"}
            Pin in hole, or two rollers.
        dR : float or array_like
            ΔR in mm.
        material : Material, optional
            The material of both bodies, or of the hole or first roller when `material_j` is given.
        length : float, optional
            Axial length in mm.
        R_i : float or array_like, optional
            The radius of the hole or first roller in mm; the other radius then follows from ΔR.
        material_j : Material, optional
            The material of the pin or second roller.
        pin, hole : Material, optional
            The two materials of internal contact, in place of `material` and `material_j`.
        plane : {"strain", "stress"}
            Plane strain, or plane stress for thin sheets.

        Returns
        -------
        CylinderPair

        Raises
        ------
        InputError
            If `R_i` and ΔR leave no room for the pin or second roller, or the materials are not
            given just once.
        """
        R_j = None
        _require_contact(contact)
        if R_i is None:
            _require_positive("dR", dR)
        else:
            R_j = _other_radius("CylinderPair.from_dR", contact, dR, R_i=R_i)
        require(
            contact == "internal" or (pin is None and hole is None), "CylinderPair.from_dR",
            "contact", contact, "has no pin and no hole", "give material and material_j",
        )  # fmt: skip
        first, second = _bodies("CylinderPair.from_dR", material, material_j, pin, hole)
        return cls(contact, dR, first, second, R_i, R_j, length, plane)

    @classmethod
    def from_dundurs(cls, alpha: Length, beta: Length) -> CylinderPair:
        """Return a pin in a hole of given α and β, with E* = 1 MPa and ΔR = 1 mm.

        Loads of this pair in N/mm are φ = f/(E*·ΔR), its penetrations in mm are d = δ/ΔR.

        Parameters
        ----------
        alpha, beta : float or array_like
            Dundurs' parameters, α inside ]−1, 1[ and β from (α − 1)/4 to (α + 1)/4. Other values
            need a negative Poisson's ratio, or one above 0.5.

        Returns
        -------
        CylinderPair
            In plane strain. Of the materials with these α and β it has those of which one is
            incompressible.

        Raises
        ------
        InputError
            If no two materials have this α and β.

        Examples
        --------
        >>> pair = CylinderPair.from_dundurs(0.4866, 0.1153)
        >>> print(f"{pair.E_star:.3f} MPa, alpha = {pair.alpha:.4f}, beta = {pair.beta:.4f}")
        1.000 MPa, alpha = 0.4866, beta = 0.1153
        """
        a, b = np.broadcast_arrays(as_floats(alpha), as_floats(beta))
        remedy = "choose |alpha| < 1 and beta from (alpha - 1)/4 to (alpha + 1)/4"
        source = "CylinderPair.from_dundurs"
        require(np.abs(a) < 1, source, "alpha", alpha, "must lie inside ]-1, 1[", remedy)
        require(
            are_possible(a, b), source, "beta", beta, f"no materials have it at alpha = {a}", remedy
        )
        w_i, w_j = (1 - a) / 2, (1 + a) / 2
        # Either body's part of β is w·g with g = (1 − 2ν)/(2 − 2ν).
        hole = _of_unit_share("hole", w_i, np.maximum(-b, 0) / w_i)
        pin = _of_unit_share("pin", w_j, np.maximum(b, 0) / w_j)
        return cls("internal", 1.0, hole, pin)

    @property
    def moduli(self) -> tuple[FloatArray, FloatArray]:
        """The moduli of bodies i and j in MPa: E/(1 − ν²) in plane strain, E in plane stress."""
        bodies = self.material_i, self.material_j
        if self.plane == "stress":
            modulus_i, modulus_j = (as_floats(body.E) for body in bodies)
        else:
            modulus_i, modulus_j = (body.plane_strain_modulus for body in bodies)
        return modulus_i, modulus_j

    @property
    def E_star(self) -> FloatArray:
        """Composite modulus in MPa: 1/E* = (1 − ν_i²)/E_i + (1 − ν_j²)/E_j, or without ν².

        Examples
        --------
        >>> steel = Material("steel", E=207e3, nu=0.3)
        >>> sheet = CylinderPair.from_dR("internal", 0.5, steel, plane="stress")
        >>> print(f"{sheet.E_star:.2f} MPa")
        103500.00 MPa
        """
        modulus_i, modulus_j = self.moduli
        return as_floats(1 / (1 / modulus_i + 1 / modulus_j))

    @property
    def shares(self) -> tuple[FloatArray, FloatArray]:
        """The shares w_i and w_j of the bodies in the compliance: w_k = E*/modulus_k, sum 1."""
        modulus_i, modulus_j = self.moduli
        total = modulus_i + modulus_j
        return as_floats(modulus_j / total), as_floats(modulus_i / total)

    @property
    def kolosov(self) -> tuple[FloatArray, FloatArray]:
        """Kolosov's κ of bodies i and j: 3 − 4ν in plane strain, (3 − ν)/(1 + ν) in plane stress.

        κ + 1 times 1/(8μ), μ the shear modulus, is the compliance 1/modulus.
        """
        nu_i, nu_j = as_floats(self.material_i.nu), as_floats(self.material_j.nu)
        if self.plane == "stress":
            return as_floats((3 - nu_i) / (1 + nu_i)), as_floats((3 - nu_j) / (1 + nu_j))
        return as_floats(3 - 4 * nu_i), as_floats(3 - 4 * nu_j)

    @property
    def alpha(self) -> FloatArray:
        """Dundurs' α = w_j − w_i, from −1 to 1, positive when body j (the pin) is the softer.

        Examples
        --------
        >>> steel, aluminium = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
        >>> pair = CylinderPair.from_dR("internal", 0.5, steel, material_j=aluminium)
        >>> print(f"alpha = {pair.alpha:.4f}, beta = {pair.beta:.4f}")
        alpha = 0.4866, beta = 0.1153
        """
        w_i, w_j = self.shares
        return as_floats(w_j - w_i)

    @property
    def beta(self) -> FloatArray:
        """Dundurs' β = w_j·g_j − w_i·g_i with g = (κ − 1)/(κ + 1), from −w_i/2 to w_j/2."""
        (w_i, w_j), (kappa_i, kappa_j) = self.shares, self.kolosov
        own_i, own_j = w_i * (kappa_i - 1) / (kappa_i + 1), w_j * (kappa_j - 1) / (kappa_j + 1)
        return as_floats(own_j - own_i)

    @property
    def of_one_material(self) -> bool:
        """Whether both bodies have the same E and ν, in every element."""
        hole, pin = self.material_i, self.material_j
        return bool(np.all((hole.E == pin.E) & (hole.nu == pin.nu)))

    def require_plane_strain(self, source: str) -> None:
        """Raise `InputError` in plane stress, for laws that are stated for plane strain only."""
        require(
            self.plane == "strain",
            source,
            "pair.plane",
            self.plane,
            "must be 'strain': the source states it for plane strain only",
            "use laws.Conformal() or laws.Johnson() for plane stress",
        )

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


def roles(contact: Contact) -> tuple[str, str]:
    """Return what bodies i and j are: the hole and the pin, or rollers."""
    return ("hole", "pin") if contact == "internal" else ("roller i", "roller j")


def unusual_lengths(pair: CylinderPair) -> tuple[str, ...]:
    """Return a sentence for each length of a pair that can hardly be meant, with a likely cause.

    Examples
    --------
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> print(*unusual_lengths(CylinderPair.internal(20.0, 9.95, steel, 20.0)))
    the radial clearance over the hole's radius is 0.5025: is a radius a diameter, or wrong?
    """
    first, second = roles(pair.contact)
    unit = "lengths are in mm, not in metres or µm"
    checks: list[tuple[str, Length | None, tuple[float, float], str]] = [
        (f"the radius of the {first} in mm", pair.R_i, _LENGTHS, unit),
        (f"the radius of the {second} in mm", pair.R_j, _LENGTHS, unit),
        ("the axial length in mm", pair.length, _LENGTHS, unit),
    ]
    if pair.R_i is not None and pair.contact == "internal":
        share = as_floats(pair.dR) / as_floats(pair.R_i)
        name, cause = "the radial clearance over the hole's radius", "is a radius a diameter, or "
        cause += "wrong?" if np.max(share) > _CLEARANCES[0] else "the clearance in metres?"
        checks.append((name, share, _CLEARANCES, cause))
    if pair.R_i is not None and pair.length is not None:
        ratio = as_floats(pair.length) / as_floats(pair.R_i)
        name = f"the axial length over the radius of the {first}"
        checks.append((name, ratio, _SLENDERNESS, "is one of them in another unit?"))
    found = []
    for name, values, (low, high), cause in checks:
        numbers = np.atleast_1d(low if values is None else as_floats(values))
        outside = numbers[(numbers < low) | (numbers > high)]
        if outside.size:
            found.append(f"{name} is {outside[0]:.4g}: {cause}")
    return tuple(found)


def _bodies(
    source: str,
    material: Material | None,
    material_j: Material | None,
    pin: Material | None,
    hole: Material | None,
) -> tuple[Material, Material]:
    """Return the materials of bodies i and j, given by body or by what the body is."""
    if pin is None and hole is None:
        if material is None:
            rule, remedy = "is missing", "give material, or pin and hole"
            raise InputError(source, "material", None, rule, remedy)
        return material, material_j or material
    for key, other in (("material", material), ("material_j", material_j)):
        if other is not None:
            rule, remedy = "is given beside pin or hole", "leave it out, or those"
            raise InputError(source, key, None, rule, remedy)
    if pin is None or hole is None:
        key, given = ("pin", "hole") if pin is None else ("hole", "pin")
        rule, remedy = f"is missing beside {given}", "give both, or material for both bodies"
        raise InputError(source, key, None, rule, remedy)
    return hole, pin


def are_possible(alpha: FloatArray, beta: FloatArray) -> BoolArray:
    """Return where two materials can have α and β, with Poisson's ratios from 0 to 0.5."""
    return (alpha - 1 <= 4 * beta + _ROUNDING) & (4 * beta <= alpha + 1 + _ROUNDING)


def _of_unit_share(name: str, share: FloatArray, g: FloatArray) -> Material:
    """Return the material of one body, from its share of the compliance at E* = 1 and its g."""
    g = np.minimum(g, 0.5)  # rounding may exceed it
    nu = (1 - 2 * g) / (2 - 2 * g)
    return material_in_MPa(name, as_floats((1 - nu**2) / share), as_floats(nu))


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


def _require_agreement(contact: Contact, dR: Length, R_i: Length, R_j: Length) -> None:
    """Raise `InputError` if ΔR differs from that of the radii by a millionth of them."""
    outer, inner = as_floats(R_i), as_floats(R_j)
    own = outer - inner if contact == "internal" else outer + inner
    require(
        np.abs(as_floats(dR) - own) <= _AGREEMENT * np.maximum(outer, inner),
        "CylinderPair",
        "dR",
        dR,
        f"contradicts R_i = {short(R_i)} and R_j = {short(R_j)}, which give {short(own)}",
        "change the radii with it, or leave them out",
    )


def _other_radius(source: str, contact: Contact, dR: Length, **given: Length) -> FloatArray:
    """Return what ΔR leaves of R_j if R_i is given, or of R_i for a roller; refuse what is not > 0.

    Raises
    ------
    InputError
        If it is not positive.
    """
    ((key, radius),) = given.items()
    own, distance = _lengths(**given, dR=dR)
    other = own - distance if contact == "internal" else distance - own
    body = "the pin" if contact == "internal" else roles(contact)[key == "R_i"]
    require(
        other > 0,
        source,
        "dR",
        dR,
        f"leaves {body} a radius that is not positive ({key} = {short(radius)})",
        f"internal contact needs dR < R_i, external contact dR > {key}",
    )
    return other


def _lengths(**given: Length) -> list[FloatArray]:
    """Return lengths that go together; raise `InputError` for others."""
    numbers = [_require_positive(key, value) for key, value in given.items()]
    require_one_shape("CylinderPair", **given)
    return numbers


def _require_positive(key: str, value: object) -> FloatArray:
    """Return a length; raise `InputError` for one that is not positive and finite."""
    numbers = as_numbers(value, "CylinderPair", key)
    require(
        (numbers > 0) & np.isfinite(numbers),
        "CylinderPair",
        key,
        value,
        "must be positive and finite",
        "give it in mm",
    )
    return numbers
