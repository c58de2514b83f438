"""The reference law for a pin in a hole of any two materials, and the datum of its penetration.

The dimensionless solution is in `cylcontact.laws.unlike`. This module applies it to pairs, with
loads in N/mm and lengths in mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import BoolArray, FloatArray, as_floats, inside_or_nan, require
from cylcontact.html_repr import law_html
from cylcontact.laws import unlike
from cylcontact.laws.conformal import in_units_of
from cylcontact.laws.contact_law import Unlimited, depth_of, require_hole
from cylcontact.laws.definition import LawModel
from cylcontact.laws.unlike import Bodies
from cylcontact.pair import Contact, CylinderPair

__all__ = ["ClampedPlate", "Conformal", "Datum", "PinDatum"]

PinDatum = Literal["body-force", "diametral"]


def _is_number(value: object) -> bool:
    """Return whether a value is one finite number."""
    return isinstance(value, (int, float, np.number)) and bool(np.isfinite(value))


@dataclass(frozen=True)
class ClampedPlate:
    """A datum: the pin's centre against a plate that is clamped at the radius R_o around the hole.

    Parameters
    ----------
    R_o : float
        The radius in mm at which the plate is held, larger than the hole.
    pin : {"body-force", "diametral"}
        How the pin is loaded: by a force spread evenly over its section, or by a line load
        opposite the contact.

    Raises
    ------
    InputError
        If the radius is not one positive and finite number, or the loading of the pin is unknown.

    Notes
    -----
    With ρ = R_o/R_i, Kolosov's κ and w the shares in the compliance, the pin adds −w_j/(κ_j + 1)
    (body force) or w_j·(2·ln 2 − 1) (diametral) to C. The plate adds, by the part of its
    displacement that goes like cos θ, 4w_i·U/(κ_i + 1)² − w_i/(κ_i + 1) with

        U = (κ_i + 1)/4 + κ_i·ln ρ + A·(κ_i − 1 + 2ρ²),
        A = −(1 + (κ_i − 1)/(2ρ²))/(2(κ_i·ρ² + 1/ρ²)).

    Other harmonics of the plate's displacement are left out. They matter for narrow rings: in
    steel their share of C is −0.79, −0.41, −0.17 and −0.05 at ρ = 2, 3, 5 and 10. In a plate that
    is nearly incompressible they matter until (1 − 2ν)·ρ² is large.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=steel)
    >>> print(f"C = {ClampedPlate(R_o=200.0).constant(pair):.6f}")
    C = 1.055013
    """

    R_o: float
    pin: PinDatum = "body-force"

    def __post_init__(self) -> None:
        require(
            _is_number(self.R_o) and self.R_o > 0,
            "ClampedPlate",
            "R_o",
            self.R_o,
            "must be a number, positive and finite",
            "give the radius in mm at which the plate is held",
        )
        require(
            self.pin in ("body-force", "diametral"),
            "ClampedPlate",
            "pin",
            self.pin,
            "must be 'body-force' or 'diametral'",
            "say how the pin is loaded",
        )

    def constant(self, pair: CylinderPair) -> FloatArray:
        """Return C for a pair of known radii.

        Raises
        ------
        InputError
            If the radii are not known, or the plate is held inside the hole.
        """
        R_i, _ = pair.radii(f"the datum {self!r}")
        require(
            self.R_o > R_i,
            "ClampedPlate",
            "R_o",
            self.R_o,
            f"must be larger than the hole (R_i = {np.max(R_i):g} mm)",
            "the plate is held outside the hole",
        )
        return as_floats(self._of_pin(pair) + _of_plate(self.R_o / R_i, pair))

    def _of_pin(self, pair: CylinderPair) -> FloatArray:
        """Return the pin's part of C."""
        (_, w_j), (_, kappa_j) = pair.shares, pair.kolosov
        part = -1 / (kappa_j + 1) if self.pin == "body-force" else 2 * np.log(2) - 1
        return as_floats(w_j * part)


def _of_plate(rho: FloatArray, pair: CylinderPair) -> FloatArray:
    """Return the plate's part of C."""
    (w_i, _), (kappa, _) = pair.shares, pair.kolosov
    square = rho**2
    A = -(1 + (kappa - 1) / (2 * square)) / (2 * (kappa * square + 1 / square))
    U = (kappa + 1) / 4 + kappa * np.log(rho) + A * (kappa - 1 + 2 * square)
    return as_floats(4 * w_i * U / (kappa + 1) ** 2 - w_i / (kappa + 1))


Datum = Literal["johnson"] | float | ClampedPlate


@dataclass(frozen=True)
class Conformal(Unlimited):
    """A pin in a hole of any two materials: the reference law, exact for large arcs as well.

    δ = f·L/(π·E*) and f = π·E*·ΔR/K, with the semi-angle ε of the contact as parameter. For two
    bodies of β = 0, with S = sin²(ε/2), w_i and w_j the shares of hole and pin in the compliance
    and H = 2S − (1 − S)²·ln(1 − S)/S,

        K = (1 − S)²/S − w_i·H,    L = −ln S + S²/2 + w_i·H + C.

    For β ≠ 0 a series of Glauert's adds to K, L and H what depends on ε and β. δ/ΔR depends
    on f/(E*·ΔR), α, β and C alone. The law has no largest load.

    Parameters
    ----------
    datum : "johnson", float or ClampedPlate
        Where the penetration is counted from. A plane body has no absolute approach, and δ is
        known up to C·f/(π·E*). "johnson" is C = 2·ln 2 − 2 + w_j, with which δ tends to Johnson's
        law at small loads; a number is C itself; `ClampedPlate` is a joint that is held somewhere.

    Raises
    ------
    InputError
        If the datum is unknown; when the law is evaluated, if the contact is external, or the
        datum makes the penetration decrease with the load.

    Notes
    -----
    The pressure is that of Persson (1964) for β = 0. Ciavarella and Decuzzi (Int. J. Solids
    Struct. 38 (2001) 4507–4523) treat unlike bodies. The equation is Prandtl's of the lifting
    line, which Glauert's series solves; the derivation is in `cylcontact.laws.unlike`. Plane
    strain, or plane stress if the pair says so. ΔR is small beside the radii, and there is no
    friction.

    Relative errors are those of rounding for β = 0. For other pairs they are below 1e-11 in load,
    penetration, stiffness and angle, and below 1e-9 in the largest pressure, against four times
    the terms over every possible (α, β); for |β| < 1e-5 and arcs beyond 172.7°, which only a pin
    1e5 times softer than the plate reaches, below 1e-7. Each β costs 0.02 s once. No ratio of the
    moduli is too large: the law tends to that of one rigid body.

    Examples
    --------
    A steel pin in an aluminium plate has 5 % less penetration than equal bodies of the same E*:

    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel, aluminium = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=aluminium, material_j=steel)
    >>> f = pair.E_star * pair.dR
    >>> law = Conformal()
    >>> print(f"{law.penetration(f, pair) / pair.dR:.6f}, {law.contact_angle(f, pair):.5f} degrees")
    0.655212, 50.50110 degrees

    With the plate clamped at twenty times the hole's radius and the pin under a body force:

    >>> joint = Conformal(datum=ClampedPlate(R_o=200.0))
    >>> print(f"{joint.penetration(f, pair) / pair.dR:.6f}")
    1.324271
    """

    datum: Datum = "johnson"
    name: ClassVar[str] = "conformal"
    contacts: ClassVar[tuple[Contact, ...]] = ("internal",)
    _repr_html_ = law_html

    @classmethod
    def models(cls) -> tuple[LawModel, ...]:
        """Return none: a fit on equal bodies would try the same curve as Persson's twice."""
        return ()

    def __post_init__(self) -> None:
        named = isinstance(self.datum, str) and self.datum == "johnson"
        require(
            named or isinstance(self.datum, ClampedPlate) or _is_number(self.datum),
            type(self).__name__,
            "datum",
            self.datum,
            "must be 'johnson', a finite number C or a ClampedPlate",
            "e.g. datum=laws.ClampedPlate(R_o=200.0)",
        )

    def constant(self, pair: CylinderPair) -> FloatArray:
        """Return C, which is π·E*·δ/f's additive constant, for a pair."""
        if isinstance(self.datum, ClampedPlate):
            return self.datum.constant(pair)
        if isinstance(self.datum, str):
            return as_floats(2 * np.log(2) - 2 + pair.shares[1])
        return as_floats(self.datum)

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        f = as_floats(load)
        touching, phi = in_units_of(self.load_unit(pair), f)

        def approach(phi: FloatArray, bodies: Bodies) -> FloatArray:
            return unlike.approach(self._arc_of_load(phi, bodies), bodies)

        L = _for_each_beta(approach, phi, pair, self.constant(pair))
        return inside_or_nan(f / (np.pi * pair.E_star) * L, touching)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        delta = depth_of(penetration)
        known, L = self._at(unlike.approach, delta, pair)
        return inside_or_nan(np.pi * pair.E_star * (delta / L), known)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm; 0 at first touch."""
        delta = depth_of(penetration)
        known, compliance = self._at(unlike.compliance, delta, pair)
        stiffness = np.pi * pair.E_star / compliance
        return inside_or_nan(np.where(delta == 0, 0.0, stiffness), known)

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for external contact."""
        require_hole(type(self).__name__, pair)

    def require_datum(self, pair: CylinderPair) -> None:
        """Raise `InputError` if the datum makes the penetration of a pair decrease."""
        if self.datum != "johnson":
            C = self.constant(pair)
            _for_each_beta(lambda _, bodies: self._last_arc(bodies).x, C, pair, C)

    def load_unit(self, pair: CylinderPair) -> FloatArray:
        """Return E*·ΔR in N/mm; raise `InputError` for external contact."""
        self.require_pair(pair)
        return as_floats(pair.E_star * as_floats(pair.dR))

    def contact_angle(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the semi-angle ε of the contact arc in degrees under `load` in N/mm.

        It stays below a limit angle at any load: 72.35° for a rigid pin, 84.83° for equal bodies,
        180° for a rigid plate and β = 0.
        """
        touching, phi = in_units_of(self.load_unit(pair), as_floats(load))

        def angle(phi: FloatArray, bodies: Bodies) -> FloatArray:
            return unlike.contact_angle(_arc_under(phi, bodies))

        degrees = np.degrees(_for_each_beta(angle, phi, pair, as_floats(0.0)))
        return inside_or_nan(np.where(phi == 0, 0.0, degrees), touching)

    def peak_pressure(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the largest pressure in MPa, on the line of `load` in N/mm.

        The radii must be known. The theory makes no difference between them; R here is √(R_i·R_j),
        so that small loads give exactly Hertz's pressure.
        """
        f = as_floats(load)
        touching, phi = in_units_of(self.load_unit(pair), f)
        R_i, R_j = pair.radii("the contact pressure")

        def peak(phi: FloatArray, bodies: Bodies) -> FloatArray:
            return unlike.peak_number(_arc_under(phi, bodies), bodies)

        numbers = _for_each_beta(peak, phi, pair, as_floats(0.0))
        return inside_or_nan(f / np.sqrt(R_i * R_j) * numbers, touching)

    def _at(
        self,
        answer: Callable[[unlike.Arc, Bodies], FloatArray],
        penetration: FloatArray,
        pair: CylinderPair,
    ) -> tuple[BoolArray, FloatArray]:
        """Return where the penetration is not negative, and a number of the arc there."""
        unit = self.load_unit(pair) / pair.E_star  # ΔR in the shape of the pair
        touching, d = in_units_of(unit, penetration)

        def at_depth(d: FloatArray, bodies: Bodies) -> FloatArray:
            last = self._last_arc(bodies)
            return answer(unlike.arc_of_penetration(d, bodies, last), bodies)

        return touching, _for_each_beta(at_depth, d, pair, self.constant(pair))

    def _arc_of_load(self, phi: FloatArray, bodies: Bodies) -> unlike.Arc:
        """Return the arc under a load, if the datum suits the pair."""
        return unlike.arc_of_load(phi, bodies, self._last_arc(bodies))

    def _last_arc(self, bodies: Bodies) -> unlike.Arc:
        """Return the largest arc; raise `InputError` if δ decreases with the load near it."""
        last = unlike.largest_arc(bodies)
        least = unlike.approach(last, bodies)
        require(
            least > 0,
            type(self).__name__,
            "datum",
            self.datum,
            "makes the penetration decrease at large loads",
            f"this pair needs C > {np.max(bodies.C - least):.6g}",
        )
        return last


def _arc_under(phi: FloatArray, bodies: Bodies) -> unlike.Arc:
    """Return the arc under a load, which no datum changes."""
    return unlike.arc_of_load(phi, bodies, unlike.largest_arc(bodies))


def _for_each_beta(
    answer: Callable[[FloatArray, Bodies], FloatArray],
    numbers: FloatArray,
    pair: CylinderPair,
    C: FloatArray,
) -> FloatArray:
    """Return `answer` of numbers that broadcast against a pair, solved for one β at a time."""
    (w_i, w_j), beta = pair.shares, pair.beta
    beta = np.round(beta, 15)  # what differs by rounding is solved once
    distinct = np.unique(beta)
    if distinct.size == 1:
        return answer(numbers, Bodies(w_i, w_j, float(distinct[0]), C))
    numbers, w_i, w_j, beta, C = np.broadcast_arrays(numbers, w_i, w_j, beta, C)
    results = np.empty(numbers.shape)
    for value in distinct:
        here = beta == value
        bodies = Bodies(w_i[here], w_j[here], float(value), C[here])
        results[here] = answer(numbers[here], bodies)
    return results
