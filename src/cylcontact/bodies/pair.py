"""Two parallel cylinders in contact: geometry, materials and derived quantities."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from typing import Literal

import numpy as np

from cylcontact.bodies.iso286 import IsoFit
from cylcontact.bodies.material import Material, material_in_MPa
from cylcontact.support import choices
from cylcontact.support.arrays import (
    BoolArray,
    FloatArray,
    OfArrays,
    as_floats,
    as_numbers,
    require,
    require_one_shape,
    require_positive,
)
from cylcontact.support.errors import InputError, short
from cylcontact.support.html_repr import table_html

Contact = choices.Contact
CONTACTS = choices.CONTACTS
Plane = Literal["strain", "stress"]
PLANES: tuple[Plane, ...] = ("strain", "stress")
Length = float | FloatArray

_SOURCE = "CylinderPair"
_MATERIAL = "e.g. Material.named('bronze'), or Material(name, E, nu)"
# ΔR may differ from that of the radii by rounding, as a part of the larger one.
_AGREEMENT = 1e-6
# α and β may leave the possible ones by that much.
_ROUNDING = 1e-12
# What lengths can hardly be meant, outside all that is built: metres or µm for mm, a diameter for a
# radius, a wrong millimetre.
_LENGTHS = 0.1, 5000.0  # mm
_CLEARANCES = 1e-5, 0.08  # over the radius of the hole
_SLENDERNESS = 0.02, 100.0  # length over radius


@dataclass(frozen=True, eq=False)
class CylinderPair(OfArrays):
    """Two parallel cylinders: a pin in a hole (internal), two rollers or a roller on a plane.

    Build one with `internal`, `external` or `from_dR`; the constructor takes all numbers as given
    and derives none.

    Parameters
    ----------
    contact : {"internal", "external"}
        For internal contact, *i* is the hole and *j* the pin.
    dR : float or array_like
        ΔR in mm: R_i − R_j for internal contact (the radial clearance), R_i + R_j for
        external contact, inf for a plane.
    material_i, material_j : Material
        The materials of the two bodies: of hole and pin, or of the rollers.
    R_i, R_j : float or array_like, optional
        The radii in mm, if known; R_j is inf for a plane.
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
    All arrays broadcast against each other and against the loads and penetrations of laws.

    Examples
    --------
    >>> steel, aluminium = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel, length=10.0)
    >>> print(f"{pair.E_star:.2f} MPa, {pair.dR:.1f} mm, {pair.R:.0f} mm")
    113736.26 MPa, 0.5 mm, 190 mm
    >>> pair = CylinderPair.from_dR("internal", 0.5, pin=aluminium, hole=steel, plane="stress")
    >>> print(f"{pair.E_star:.2f} MPa, alpha = {pair.alpha:.4f}, beta = {pair.beta:.4f}")
    52310.47 MPa, alpha = 0.4946, beta = 0.1619
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
        rule = "must be 'strain' or 'stress'"
        remedy = "plane strain is for long cylinders, plane stress for thin sheets"
        require(self.plane in PLANES, _SOURCE, "plane", self.plane, rule, remedy)
        moduli: dict[str, Length] = {}
        for key in ("material_i", "material_j"):
            body = getattr(self, key)
            require(isinstance(body, Material), _SOURCE, key, body, "must be a Material", _MATERIAL)
            moduli |= {f"E of {key}": body.E, f"nu of {key}": body.nu}
        optional = {"R_i": self.R_i, "R_j": self.R_j, "length": self.length}
        given = {key: value for key, value in optional.items() if value is not None}
        is_external, known = self.contact == "external", given.keys() & {"R_i", "R_j"}
        flat = ("dR", "R_j") if is_external and len(known) == 2 else ()
        lengths = _lengths(*flat, dR=self.dR, **given)
        require_one_shape(_SOURCE, **lengths, **moduli)
        self._own_arrays()
        if len(known) == 2:
            self._require_agreement(lengths["R_i"], lengths["R_j"])
        elif known and (is_external or "R_i" in known):
            (key,) = known
            _other_radius(_SOURCE, self.contact, self.dR, key, lengths[key])

    def _require_agreement(self, R_i: FloatArray, R_j: FloatArray) -> None:
        """Raise `InputError` if ΔR differs from that of the radii by a millionth of them."""
        own = R_i - R_j if self.contact == "internal" else R_i + R_j
        with np.errstate(invalid="ignore"):  # inf − inf of a plane
            agrees = np.abs(self.dR - own) <= _AGREEMENT * np.maximum(R_i, R_j)
        if not np.all(self.dR == own if self.is_flat else agrees):
            rule = f"contradicts R_i = {short(R_i)} and R_j = {short(R_j)}, which give {short(own)}"
            remedy = "correct one of them, or leave out the radii"
            raise InputError(_SOURCE, "dR", self.dR, rule, remedy)

    def __repr__(self) -> str:
        names = [field.name for field in fields(self)]
        values = [f"{name}={getattr(self, name)!r}" for name in names]
        return f"{_SOURCE}({', '.join(values[: -1 if self.plane == 'strain' else None])})"

    def _repr_html_(self) -> str:
        first, second = roles(self.contact)
        rows = {
            "ΔR (mm)": self.dR,
            f"R_i, {first} (mm)": self.R_i,
            f"material, {first}": self.material_i.name,
            f"R_j, {second} (mm)": self.R_j,
            f"material, {second}": self.material_j.name,
            "length (mm)": self.length,
            "E* (MPa)": self.E_star,
        } | ({} if self.plane == "strain" else {"plane": self.plane})
        return table_html(f"{_SOURCE}, {self.contact} contact", rows)

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
        """Return a pin of radius `R_j` in a hole of radius `R_i`.

        Parameters
        ----------
        R_i, R_j : float or array_like
            Radii of the hole and of the pin in mm, R_i > R_j.
        material, material_j : Material, optional
            The materials of the hole and of the pin; one serves both.
        pin, hole : Material, optional
            The two materials, instead of `material` and `material_j`.
        length, plane
            Axial length in mm and state of stress, as for the class.

        Raises
        ------
        InputError
            If the pin does not fit in the hole, or a material is missing or given twice.

        Examples
        --------
        >>> bronze, steel = Material("bronze", 110e3, 0.34), Material("steel", 207e3, 0.3)
        >>> pair = CylinderPair.internal(10.0, 9.95, pin=bronze, hole=steel)
        >>> pair.material_j.name
        'bronze'
        """
        source = "CylinderPair.internal"
        outer, inner = _lengths(R_i=R_i, R_j=R_j).values()
        rule = f"the pin must be smaller than the hole (R_i = {short(R_i)})"
        remedy = "give R_i, the radius of the hole, the larger value; both are radii, not diameters"
        require(outer > inner, source, "R_j", R_j, rule, remedy)
        bodies = _bodies(source, material, material_j, pin, hole)
        return cls("internal", outer - inner, *bodies, R_i, R_j, length, plane)

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
        """Return two rollers of radii `R_i` and `R_j`, or a roller on a plane.

        Parameters
        ----------
        R_i, R_j : float or array_like
            Radii in mm. R_j = inf is a plane: ΔR is inf as well, and the effective radius is R_i.
        material, material_j : Material
            The materials of bodies *i* and *j*; one serves both.
        length, plane
            Axial length in mm and state of stress, as for the class.

        Raises
        ------
        InputError
            If a radius is not positive, or only some of the R_j are inf.

        Examples
        --------
        >>> from cylcontact import limits
        >>> roller = CylinderPair.external(R_i=10.0, R_j=np.inf, material=Material("", 207e3, 0.3))
        >>> print(f"{roller.R:.0f} mm, {limits.hertz_stress(100.0, roller):.1f} MPa")
        10 mm, 601.7 MPa
        """
        outer, inner = _lengths("R_j", R_i=R_i, R_j=R_j).values()
        _require_materials("CylinderPair.external", material=material, material_j=material_j)
        bodies = material, material_j or material
        return cls("external", outer + inner, *bodies, R_i, R_j, length, plane)

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
        """Return a pair from its ΔR, for laws that depend only on ΔR.

        Parameters
        ----------
        contact : {"internal", "external"}
            Pin in hole, or two rollers.
        dR : float or array_like
            ΔR in mm.
        R_i : float or array_like, optional
            The radius of the hole or first roller in mm; the other radius then follows from ΔR.
        material, material_j, pin, hole, length, plane
            As for `internal` and `external`; a roller is neither pin nor hole.

        Raises
        ------
        InputError
            If `R_i` and ΔR leave no room for the pin or second roller, or the materials are not
            given just once.
        """
        source = "CylinderPair.from_dR"
        _require_contact(contact)
        R_j = None if R_i is None else _other_radius(source, contact, dR, "R_i", R_i)
        has_no_names = contact == "internal" or (pin is None and hole is None)
        rule, remedy = "has no pin and no hole", "give material and material_j"
        require(has_no_names, source, "contact", contact, rule, remedy)
        bodies = _bodies(source, material, material_j, pin, hole)
        return cls(contact, dR, *bodies, R_i, R_j, length, plane)

    @classmethod
    def from_iso(
        cls,
        code: str,
        material: Material | None = None,
        length: float | None = None,
        *,
        pin: Material | None = None,
        hole: Material | None = None,
        plane: Plane = "strain",
        share: Length = (0.0, 0.5, 1.0),  # type: ignore[assignment]
    ) -> CylinderPair:
        """Return a pin in a hole of an ISO 286 fit: the tightest, the middle and the loosest.

        Parameters
        ----------
        code : str
            The fit, as "20H7/g6"; `cylcontact.bodies.iso286.IsoFit` says what is known.
        share : float or array_like
            Which pairs of the band: 0 is the tightest, 1 the loosest. Where hole and pin may be of
            one size (H/h), the tightest has ΔR = 1 nm, because laws are undefined at ΔR = 0.
        material, pin, hole, length, plane
            As for `internal`.

        Raises
        ------
        InputError
            If the code is not known, or a pin within its limits may be larger than the hole.

        Examples
        --------
        >>> bronze, steel = Material("bronze", 110e3, 0.34), Material("steel", 207e3, 0.3)
        >>> pair = CylinderPair.from_iso("20H7/g6", pin=steel, hole=bronze, length=15.0)
        >>> pair.dR.round(5)
        array([0.0035, 0.012 , 0.0205])
        """
        source = "CylinderPair.from_iso"
        fit = IsoFit.read(code, source, "code")
        fit.require_clearance(source, "code")
        R_i, R_j = fit.radii(as_floats(share))
        bodies = _bodies(source, material, None, pin, hole)
        return cls("internal", R_i - R_j, *bodies, R_i, R_j, length, plane)

    @classmethod
    def from_dundurs(cls, alpha: Length, beta: Length) -> CylinderPair:
        """Return a pin in a hole of given α and β, with E* = 1 MPa and ΔR = 1 mm.

        Loads of this pair in N/mm equal φ = f/(E*·ΔR), and penetrations in mm equal d = δ/ΔR. The
        pair is in plane strain, and one of its materials is incompressible.

        Parameters
        ----------
        alpha, beta : float or array_like
            Dundurs' parameters, α inside ]−1, 1[ and β from (α − 1)/4 to (α + 1)/4. Other values
            need a negative Poisson's ratio, or one above 0.5.

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
        source = "CylinderPair.from_dundurs"
        remedy = "choose |alpha| < 1 and beta from (alpha - 1)/4 to (alpha + 1)/4"
        require(np.abs(a) < 1, source, "alpha", alpha, "must lie inside ]-1, 1[", remedy)
        rule = f"no materials have it at alpha = {a}"
        require(are_possible(a, b), source, "beta", beta, rule, remedy)

        def body(name: str, share: FloatArray, own_beta: FloatArray) -> Material:
            # Its part of β is w·g with g = (1 − 2ν)/(2 − 2ν), which rounding may carry above 1/2.
            g = np.minimum(np.maximum(own_beta, 0) / share, 0.5)
            nu = (1 - 2 * g) / (2 - 2 * g)
            return material_in_MPa(name, as_floats((1 - nu**2) / share), as_floats(nu))

        return cls("internal", 1.0, body("hole", (1 - a) / 2, -b), body("pin", (1 + a) / 2, b))

    @property
    def moduli(self) -> tuple[FloatArray, FloatArray]:
        """The moduli of bodies i and j in MPa: E/(1 − ν²) in plane strain, E in plane stress."""
        one, other = self.material_i, self.material_j
        if self.plane == "stress":
            return as_floats(one.E), as_floats(other.E)
        return one.plane_strain_modulus, other.plane_strain_modulus

    @cached_property
    def E_star(self) -> FloatArray:
        """Composite modulus in MPa: 1/E* = (1 − ν_i²)/E_i + (1 − ν_j²)/E_j, or without ν²."""
        modulus_i, modulus_j = self.moduli
        return _fixed(1 / (1 / modulus_i + 1 / modulus_j))

    @cached_property
    def shares(self) -> tuple[FloatArray, FloatArray]:
        """The shares w_i and w_j of the bodies in the compliance: w_k = E*/modulus_k, sum 1."""
        modulus_i, modulus_j = self.moduli
        total = modulus_i + modulus_j
        return _fixed(modulus_j / total), _fixed(modulus_i / total)

    @property
    def kolosov(self) -> tuple[FloatArray, FloatArray]:
        """Kolosov's κ of bodies i and j: 3 − 4ν in plane strain, (3 − ν)/(1 + ν) in plane stress.

        κ + 1 times 1/(8μ), μ the shear modulus, is the compliance 1/modulus.
        """
        nu_i, nu_j = as_floats(self.material_i.nu), as_floats(self.material_j.nu)
        if self.plane == "stress":
            return (3 - nu_i) / (1 + nu_i), (3 - nu_j) / (1 + nu_j)
        return 3 - 4 * nu_i, 3 - 4 * nu_j

    @property
    def alpha(self) -> FloatArray:
        """Dundurs' α = w_j − w_i, from −1 to 1, positive when body j (the pin) is the softer."""
        w_i, w_j = self.shares
        return w_j - w_i

    @cached_property
    def beta(self) -> FloatArray:
        """Dundurs' β = w_j·g_j − w_i·g_i with g = (κ − 1)/(κ + 1), from −w_i/2 to w_j/2."""
        (w_i, w_j), (kappa_i, kappa_j) = self.shares, self.kolosov
        own_i, own_j = w_i * (kappa_i - 1) / (kappa_i + 1), w_j * (kappa_j - 1) / (kappa_j + 1)
        return _fixed(own_j - own_i)

    @cached_property
    def of_one_material(self) -> bool:
        """Whether both bodies have the same E and ν, in every element."""
        one, other = self.material_i, self.material_j
        return bool(np.all((one.E == other.E) & (one.nu == other.nu)))

    @cached_property
    def is_flat(self) -> bool:
        """Whether body j has a flat surface: R_j and ΔR are inf."""
        return self.R_j is not None and bool(np.all(np.isinf(self.R_j)))

    @property
    def R(self) -> FloatArray:
        """Effective radius R_i·R_j/ΔR in mm, R_i for a plane; `InputError` without radii."""
        R_i, R_j = self.radii("the effective radius")
        return R_i + np.zeros_like(R_j) if self.is_flat else R_i * R_j / as_floats(self.dR)

    def radii(self, purpose: str) -> tuple[FloatArray, FloatArray]:
        """Return R_i and R_j in mm; raise `InputError` naming `purpose` if they are not known."""
        if self.R_i is None or self.R_j is None:
            rule = f"{purpose} needs both radii, and this pair has ΔR only"
            remedy = "build it with CylinderPair.internal or .external, or pass R_i to from_dR"
            raise InputError(_SOURCE, "R_i, R_j", None, rule, remedy)
        return as_floats(self.R_i), as_floats(self.R_j)

    def contact_length(self, purpose: str) -> float:
        """Return the axial length in mm; raise `InputError` naming `purpose` if it is not known."""
        if self.length is None:
            rule = f"{purpose} needs the axial length and this pair has none"
            remedy = "pass length= in mm when the pair is built"
            raise InputError(_SOURCE, "length", None, rule, remedy)
        return self.length

    def require_plane_strain(self, source: str) -> None:
        """Raise `InputError` in plane stress, for laws that are stated for plane strain only."""
        rule = "must be 'strain': the source states it for plane strain only"
        remedy = "use laws.Conformal() or laws.Johnson() for plane stress"
        require(self.plane == "strain", source, "pair.plane", self.plane, rule, remedy)


def _fixed(values: FloatArray) -> FloatArray:
    """Return what is computed once, so that no caller can change it."""
    values.setflags(write=False)
    return values


def roles(contact: Contact) -> tuple[str, str]:
    """Return what bodies i and j are: the hole and the pin, or rollers."""
    return ("hole", "pin") if contact == "internal" else ("roller i", "roller j")


def are_possible(alpha: FloatArray, beta: FloatArray) -> BoolArray:
    """Return where two materials can have α and β, with Poisson's ratios from 0 to 0.5."""
    return (alpha - 1 <= 4 * beta + _ROUNDING) & (4 * beta <= alpha + 1 + _ROUNDING)


def unusual_lengths(pair: CylinderPair) -> tuple[str, ...]:
    """Return a sentence with a likely cause for each implausible length of a pair.

    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> print(*unusual_lengths(CylinderPair.internal(20.0, 9.95, steel, 20.0)))
    the radial clearance over the hole's radius is 0.5025: is a radius a diameter, or wrong?
    """
    first, second = roles(pair.contact)
    unit, R_i, length = "lengths are in mm, not in metres or µm", pair.R_i, pair.length
    checks: list[tuple[str, Length | None, tuple[float, float], str]] = [
        (f"the radius of the {first} in mm", R_i, _LENGTHS, unit),
        (f"the radius of the {second} in mm", None if pair.is_flat else pair.R_j, _LENGTHS, unit),
        ("the axial length in mm", length, _LENGTHS, unit),
    ]
    if R_i is not None and pair.contact == "internal":
        share = as_floats(pair.dR) / R_i
        name, cause = "the radial clearance over the hole's radius", "is a radius a diameter, or "
        cause += "wrong?" if np.max(share) > _CLEARANCES[0] else "the clearance in metres?"
        checks.append((name, share, _CLEARANCES, cause))
    if R_i is not None and length is not None:
        name, cause = f"the axial length over the radius of the {first}", "is one of them in "
        checks.append((name, length / as_floats(R_i), _SLENDERNESS, cause + "another unit?"))
    sentences = []
    for name, values, (low, high), cause in checks:
        numbers = np.atleast_1d(low if values is None else as_floats(values))
        outside = numbers[(numbers < low) | (numbers > high)]
        sentences += [f"{name} is {number:.4g}: {cause}" for number in outside[:1]]
    return tuple(sentences)


def _bodies(
    source: str,
    material: Material | None,
    material_j: Material | None,
    pin: Material | None,
    hole: Material | None,
) -> tuple[Material, Material]:
    """Return the materials of bodies i and j, given by body or by what the body is."""
    _require_materials(source, material=material, material_j=material_j, pin=pin, hole=hole)
    if pin is None and hole is None:
        if material is not None:
            return material, material_j or material
        key, rule, remedy = "material", "is missing", "give material, or pin and hole"
    elif material is not None or material_j is not None:
        key = "material_j" if material is None else "material"
        rule, remedy = "is given beside pin or hole", "leave out one or the other"
    elif pin is not None and hole is not None:
        return hole, pin
    else:
        key, other = ("pin", "hole") if pin is None else ("hole", "pin")
        rule, remedy = f"is missing beside {other}", "give both, or material for both bodies"
    raise InputError(source, key, None, rule, remedy)


def _require_materials(source: str, **given: object) -> None:
    """Raise `InputError` for what is given as a material and is none."""
    for key, body in given.items():
        good = body is None or isinstance(body, Material)
        require(good, source, key, body, "must be a Material", _MATERIAL)


def _require_contact(contact: object) -> None:
    """Raise `InputError` for a contact that is neither internal nor external."""
    rule = "must be 'internal' or 'external'"
    remedy = "internal is a pin in a hole, external two rollers"
    require(contact in CONTACTS, _SOURCE, "contact", contact, rule, remedy)


def _other_radius(
    source: str, contact: Contact, dR: Length, key: str, radius: Length
) -> FloatArray:
    """Return what ΔR leaves of R_j, or of R_i for a roller; refuse what is not positive."""
    own, distance = _lengths(**{key: radius, "dR": dR}).values()
    other = own - distance if contact == "internal" else distance - own
    if not np.all(other > 0):
        body = "the pin" if contact == "internal" else roles(contact)[key == "R_i"]
        rule = f"leaves {body} a radius that is not positive ({key} = {short(radius)})"
        remedy = f"internal contact needs dR < R_i, external contact dR > {key}"
        raise InputError(source, "dR", dR, rule, remedy)
    return other


def _lengths(*flat: str, **given: Length) -> dict[str, FloatArray]:
    """Return lengths by name, positive and of shapes that go together; refuse others."""
    lengths = {}
    for key, value in given.items():
        remedy = "give it in mm, or inf alone for a plane" if key in flat else "give it in mm"
        is_plane = key in flat and np.all(as_numbers(value, _SOURCE, key) == np.inf)
        numbers = as_floats(value) if is_plane else require_positive(value, _SOURCE, key, remedy)
        lengths[key] = numbers
    require_one_shape(_SOURCE, **lengths)
    return lengths
