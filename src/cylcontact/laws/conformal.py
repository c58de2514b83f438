"""Conformal contact: Persson's law for a pin in a hole, with its contact angle and pressure.

The dimensionless solution and its derivation are in `cylcontact.laws.persson`. This module applies
it to pairs, with loads in N/mm and lengths in mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import BoolArray, FloatArray, as_floats, inside_or_nan, require
from cylcontact.html_repr import law_html
from cylcontact.laws import persson
from cylcontact.laws.adapters import scaled_model
from cylcontact.laws.contact_law import Unlimited, depth_of, require_hole
from cylcontact.laws.definition import LawModel
from cylcontact.pair import Contact, CylinderPair

__all__ = [
    "Persson",
    "contact_angle",
    "in_units_of",
    "load_at_angle",
    "peak_pressure",
    "pressure",
]


@dataclass(frozen=True)
class Persson(Unlimited):
    """The reference law for a pin in a hole, exact for large contact arcs as well.

    δ = f·Z(u)/(π·E*) with u = tan²(ε/2) from f/(E*·ΔR) = 2π·u(1 + u)/(2 − 2u² − ln(1 + u)) and

        Z = ln(4(1 + u)/u) − 2/(1 + u) + 1/(2(1 + u)²) + ln(1 + u)/(2u(1 + u)).

    δ/ΔR depends on f/(E*·ΔR) alone. The law has no largest load: it tends to Johnson's law at small
    loads and to the straight line f = π·E*·δ/1.43048 at large ones.

    Raises
    ------
    InputError
        When the law is evaluated, if the contact is external or the materials differ.

    Notes
    -----
    Persson (1964) gives the load and the pressure for two bodies of the same E and ν, without
    friction, in an infinite plate; Z is derived in `cylcontact.laws.persson`. A 2-D body has no
    absolute approach: δ is known up to C·f/(π·E*), and C is **chosen** so that δ tends to
    Johnson's law as the load tends to zero. Differences between this law and Johnson's are thus
    due to conformity alone.

    A fixed number of Newton steps inverts load and penetration to a few units in the last place,
    for every positive number.

    Examples
    --------
    Johnson's penetration is 10 % too low at f/(E*·ΔR) = 0.37:

    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.from_dR("internal", dR=0.01, material=steel)
    >>> f = 0.37 * pair.E_star * pair.dR
    >>> ratio = laws.Johnson().penetration(f, pair) / Persson().penetration(f, pair)
    >>> print(f"{f:.1f} N/mm: {100 * (ratio - 1):.2f} %")
    420.8 N/mm: -10.00 %
    """

    name: ClassVar[str] = "persson"
    contacts: ClassVar[tuple[Contact, ...]] = ("internal",)
    _repr_html_ = law_html

    @classmethod
    def models(cls) -> tuple[LawModel, ...]:
        """Return how the law is fitted: by factors of modulus and clearance."""
        return (scaled_model(cls()),)

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        f = as_floats(load)
        arc, touching = _arc_under(f, pair)
        return inside_or_nan(f / (np.pi * pair.E_star) * persson.approach(arc), touching)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        delta = depth_of(penetration)
        arc, _ = _arc_at(delta, pair)
        return as_floats(np.pi * pair.E_star * (delta / persson.approach(arc)))

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm; 0 at first touch."""
        delta = depth_of(penetration)
        arc, known = _arc_at(delta, pair)
        stiffness = np.pi * pair.E_star / persson.compliance(arc)
        return inside_or_nan(np.where(delta == 0, 0.0, stiffness), known)

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for external contact or bodies of different materials."""
        _require_persson(pair)


def contact_angle(load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the semi-angle ε of the contact arc in radians, from 0 to 1.4805 (84.83°).

    Parameters
    ----------
    load : array_like
        Load per unit length in N/mm.
    pair : CylinderPair
        A pin in a hole, both of the same material.

    Returns
    -------
    array of float
        NaN where the load is negative.

    Raises
    ------
    InputError
        If the contact is external or the materials differ.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.from_dR("internal", dR=0.01, material=steel)
    >>> print(np.degrees(contact_angle([1.0, 100.0, 1e4, 1e9], pair)).round(3))
    [ 1.916 18.619 76.728 84.828]
    """
    arc, touching = _arc_under(as_floats(load), pair)
    return inside_or_nan(persson.contact_angle(arc), touching)


def load_at_angle(angle: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the load in N/mm at which the contact extends from −`angle` to `angle`.

    The inverse of `contact_angle`. Near the limit angle the sensitivity of the load grows like
    1/(limit − angle), and an angle in double precision determines fewer digits of the load.

    Parameters
    ----------
    angle : array_like
        Contact semi-angle ε in radians.
    pair : CylinderPair
        A pin in a hole, both of the same material.

    Returns
    -------
    array of float
        NaN where the angle is negative or at least 1.4805 (84.83°), which no load reaches.

    Raises
    ------
    InputError
        If the contact is external or the materials differ.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.from_dR("internal", dR=0.01, material=steel)
    >>> print(load_at_angle(np.radians([30.0, 60.0, 85.0]), pair).round(2))
    [ 286.36 2131.48     nan]
    """
    _require_persson(pair)
    epsilon = as_floats(angle)
    inside = np.asarray((epsilon >= 0) & (epsilon < persson.LIMIT_ANGLE))
    phi = persson.load_number(persson.arc_of_angle(np.where(inside, epsilon, 0.0)))
    return inside_or_nan(pair.E_star * as_floats(pair.dR) * phi, inside)


def pressure(angle: ArrayLike, load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the contact pressure in MPa at `angle` from the line of the load.

    p = f/R·[2s/(πB(1 + y²)) + ln((B + s)/(B − s))/(2π·u(1 + u))] with y = tan(θ/2),
    B = √(1 + u), s = √(u − y²) and u = tan²(ε/2) (Persson 1964); 0 outside the contact.

    Parameters
    ----------
    angle : array_like
        θ in radians, broadcast against the load.
    load : array_like
        Load per unit length in N/mm.
    pair : CylinderPair
        A pin in a hole, both of the same material, with known radii.

    Returns
    -------
    array of float
        NaN where the load is negative.

    Raises
    ------
    InputError
        If the contact is external, the materials differ or the radii are not known.

    Notes
    -----
    The theory makes no difference between R_i and R_j. R here is √(R_i·R_j), so that small loads
    give exactly Hertz's peak pressure √(f·E*·ΔR/(π·R_i·R_j)) (Eq 7).

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=steel)
    >>> print(pressure(np.radians([-20.0, 0.0, 20.0, 80.0]), 1000.0, pair).round(2))
    [75.32 83.25 75.32  0.  ]
    """
    f = as_floats(load)
    arc, touching = _arc_under(f, pair)
    # NaN for an infinite angle, or an infinite load outside the contact.
    with np.errstate(invalid="ignore"):
        y = np.tan(as_floats(angle) / 2)
        p = f / _radius(pair) * persson.pressure_number(y, arc)
    return inside_or_nan(p, touching)


def peak_pressure(load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the largest contact pressure in MPa, which is on the line of the load.

    With b = tan(ε/2) it is f/(πR)·[2b/√(1 + b²) + arsinh(b)/(b²(1 + b²))]; see `pressure`.

    Parameters
    ----------
    load : array_like
        Load per unit length in N/mm.
    pair : CylinderPair
        A pin in a hole, both of the same material, with known radii.

    Returns
    -------
    array of float
        NaN where the load is negative.

    Raises
    ------
    InputError
        If the contact is external, the materials differ or the radii are not known.

    Examples
    --------
    Hertz's formula is right for small loads and too low for conformal contact:

    >>> from cylcontact import CylinderPair, Material
    >>> from cylcontact.limits import hertz_stress
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=steel)
    >>> loads = [1.0, 1000.0]
    >>> print(peak_pressure(loads, pair).round(2), hertz_stress(loads, pair).round(2))
    [ 1.9  83.25] [ 1.9 60.2]
    """
    return pressure(0.0, load, pair)


def in_units_of(unit: FloatArray, values: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Return where loads or penetrations are not negative, and their values in units of `unit`.

    Negative values and NaN are replaced by 0, which avoids warnings in later computations.

    Examples
    --------
    >>> touching, numbers = in_units_of(np.array(2.0), np.array([-1.0, 3.0]))
    >>> print(touching, numbers)
    [False  True] [0.  1.5]
    """
    touching = np.asarray(values >= 0)
    with np.errstate(over="ignore"):
        return touching, as_floats(np.where(touching, values, 0.0) / unit)


def _arc_under(load: FloatArray, pair: CylinderPair) -> tuple[persson.Arc, BoolArray]:
    """Return the arc under `load` in N/mm, and where the load is not negative."""
    _require_persson(pair)
    touching, phi = in_units_of(pair.E_star * as_floats(pair.dR), load)
    return persson.arc_of_load(phi), touching


def _arc_at(penetration: FloatArray, pair: CylinderPair) -> tuple[persson.Arc, BoolArray]:
    """Return the arc at `penetration` in mm, and where it is not negative."""
    _require_persson(pair)
    touching, d = in_units_of(as_floats(pair.dR), penetration)
    return persson.arc_of_penetration(d), touching


def _radius(pair: CylinderPair) -> FloatArray:
    """Return R = √(R_i·R_j) in mm."""
    R_i, R_j = pair.radii("the contact pressure")
    return as_floats(np.sqrt(R_i * R_j))


def _require_persson(pair: CylinderPair) -> None:
    """Raise `InputError` for pairs for which Persson's solution does not hold."""
    require_hole("Persson's law", pair)
    require(
        pair.of_one_material,
        "Persson's law",
        "pair.material_j",
        pair.material_j.name,
        "must have the same E and ν as material_i, or the solution does not hold",
        "give a pair of one material, or use laws.Conformal()",
    )
