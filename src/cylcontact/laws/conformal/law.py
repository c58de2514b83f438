"""The law of a pin in a hole that `cylcontact.laws.conformal` derives, and Persson's."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws.conformal.arcs import Bodies
from cylcontact.laws.conformal.curve import LEAST, MOST, Curve, make
from cylcontact.laws.conformal.housings import Housing, Kernel, is_number
from cylcontact.laws.law import BLOCK, numbers_for, require_hole
from cylcontact.support.arrays import (
    FloatArray,
    IndexArray,
    as_floats,
    blocks,
    distinct_columns,
    fewest_kinds,
    inside_or_nan,
    on_all_cores,
    on_one_thread,
    require,
)
from cylcontact.support.html_repr import law_html

if TYPE_CHECKING:
    from cylcontact.laws.conformal.many import Many

    _Curves = Curve | Bodies | Many
    _Asked = tuple["_Quantity", FloatArray]  # and the unit of the result

# By which numbers of pairs with one curve may differ.
_ROUNDING = 1e-14
# Rows of several materials at a time; numbers for which a housing gets no curve.
_ROWS, _FEW = 16384, 200
# Rows of one pair of materials from which a curve of their own is faster than a search for each.
_SHARED = 40_000

Datum = Literal["johnson"] | float | Housing


class ContactState(NamedTuple):
    """What `Conformal.state` returns; the fields have the names of the methods."""

    penetration: FloatArray  # mm
    stiffness: FloatArray  # N/mm²
    energy: FloatArray  # N
    peak_pressure: FloatArray  # MPa
    contact_angle: FloatArray  # degrees


@dataclass(frozen=True)
class Conformal:
    """A pin in a hole of any two materials: the reference law, exact for large arcs as well.

    δ = f·L/(π·E*) and f = π·E*·ΔR/K, with the semi-angle ε of the contact as parameter. For two
    bodies of β = 0, with S = sin²(ε/2), w_i and w_j the shares of hole and pin in the compliance
    and H = 2S − (1 − S)²·ln(1 − S)/S,

        K = (1 − S)²/S − w_i·H,    L = −ln S + S²/2 + w_i·H + C.

    For β ≠ 0 a series of Glauert's adds to K, L and H what depends on ε and β. δ/ΔR depends
    on f/(E*·ΔR), α, β and C alone. The law has no largest load.

    Parameters
    ----------
    datum : "johnson", float or Housing
        Where the penetration is counted from. A plane body has no absolute approach, and δ is
        known up to C·f/(π·E*). "johnson" is C = 2·ln 2 − 2 + w_j, with which δ tends to Johnson's
        law at small loads; a number is C itself; a `Housing` is clamped on its rim, and its
        compliance is part of the law.

    Raises
    ------
    InputError
        If the datum is unknown; when the law is evaluated, if the contact is external, or the
        datum makes the penetration decrease with the load.

    Notes
    -----
    The pressure is that of Persson (1964) for β = 0. Ciavarella and Decuzzi (Int. J. Solids
    Struct. 38 (2001) 4507–4523) treat unlike bodies. `cylcontact.laws.conformal` derives the law.
    Plane strain, or plane stress if the pair says so. ΔR is small beside the radii, and there is no
    friction.

    Every pair has a curve, a table that is made once from a series (`laws.conformal.curve`).
    Relative to the series load, penetration and energy are right to 1e-10 and the stiffness to
    1e-9 for φ from 1e-12 to 1e6, in thin eyes to ten times as much. Arrays of materials are
    searched joint by joint in compiled code (`laws.conformal.many`), 1 µs each on one core and
    right to 1e-10, so that a joint in an array and alone agree to 1e-9. The series has errors below
    1e-11, and 1e-9 in the largest pressure, over every possible (α, β); for |β| < 1e-5 and arcs
    beyond 172.7°, which only a pin 1e5 times softer than the plate reaches, below 1e-7. In a
    housing of at least 1.3 times the hole's radius they are below 1e-9, and below 1e-4 in the
    largest pressure, which leaves the line of the load in thin eyes. Where the pin would leave a
    thin eye between two places of contact, and where the arc would be longer than 165° on each
    side, the answer is NaN.

    Examples
    --------
    A steel pin in an aluminium plate, and in a lug of twice the hole's radius that is clamped on
    its rim, the pin under a body force:

    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel, aluminium = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=aluminium, material_j=steel)
    >>> law, joint = Conformal(), Conformal(datum=Housing(R_o=20.0))
    >>> f = pair.E_star * pair.dR
    >>> print(f"{law.penetration(f, pair) / pair.dR:.6f}, {law.contact_angle(f, pair):.5f} degrees")
    0.655212, 50.50110 degrees
    >>> print(f"{joint.penetration(f, pair) / pair.dR:.6f}")
    0.577766
    """

    datum: Datum = "johnson"
    name: ClassVar[str] = "conformal"
    contacts: ClassVar[tuple[Contact, ...]] = ("internal",)

    def _repr_html_(self) -> str:
        return law_html(self)

    def __post_init__(self) -> None:
        known = self.datum == "johnson" if isinstance(self.datum, str) else is_number(self.datum)
        known = known or isinstance(self.datum, Housing)
        rule = "must be 'johnson', a finite number C or a Housing"
        remedy = "e.g. datum=laws.Housing(R_o=20.0)"
        require(known, type(self).__name__, "datum", self.datum, rule, remedy)

    def constant(self, pair: CylinderPair) -> FloatArray:
        """Return C, which is π·E*·δ/f's additive constant, for a pair."""
        if isinstance(self.datum, Housing):
            return self.datum.constant(pair)
        johnson = isinstance(self.datum, str)
        return as_floats(2 * np.log(2) - 2 + pair.shares[1] if johnson else self.datum)

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        return self._under_load(load, pair, (_PENETRATION, as_floats(pair.dR)))[0]

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        return self._at_penetration(penetration, pair, (_LOAD, _load_unit(pair)))

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm; 0 at first touch."""
        return self._at_penetration(penetration, pair, (_STIFFNESS, pair.E_star))

    def energy(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the stored elastic energy per unit length in N, ∫f dδ up to `penetration` in mm.

        It is half the work of the pressure, f·(δ − ΔR·∫(1 − cos θ)·p dθ)/2 with p in f/R.
        """
        return self._at_penetration(penetration, pair, (_ENERGY, _energy_unit(pair)))

    def contact_angle(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the semi-angle ε of the contact arc in degrees under `load` in N/mm.

        It stays below a limit angle at any load: 72.35° for a rigid pin, 84.83° for equal bodies,
        180° for a rigid plate and β = 0.
        """
        return self._under_load(load, pair, (_ANGLE, _IN_DEGREES))[0]

    def peak_pressure(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the largest pressure in MPa under `load` in N/mm.

        It lies on the load line, except in thin eyes, which press on the pin from both sides. The
        radii must be known. The theory does not distinguish them; here R = √(R_i·R_j), so that
        small loads give exactly Hertz's pressure.
        """
        return self._under_load(load, pair, (_PEAK, _pressure_unit(pair)))[0]

    def state(self, load: ArrayLike, pair: CylinderPair) -> ContactState:
        """Return all results under a load at once, in the time of one of them.

        Parameters
        ----------
        load : array_like
            In N/mm.
        pair : CylinderPair
            With known radii, which the pressure needs; all its numbers may be arrays.

        Returns
        -------
        ContactState
            With `penetration` in mm, `stiffness` in N/mm², `energy` in N, `peak_pressure` in MPa
            and `contact_angle` in degrees, as the methods of these names have them; NaN for a
            negative load.

        Raises
        ------
        InputError
            As for the class, or if the radii are not known.

        Examples
        --------
        Three bushes of other materials on one pin:

        >>> from cylcontact import CylinderPair, Material, laws
        >>> steel = Material("steel", 207e3, 0.3)
        >>> bushes = Material("bronze, aluminium, iron", [110e3, 70e3, 120e3], [0.34, 0.33, 0.26])
        >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.98, pin=steel, hole=bushes)
        >>> state = Conformal().state(500.0, pair)
        >>> print((1e3 * state.penetration).round(3), state.peak_pressure.round(1))
        [5.736 7.085 5.544] [57.9 51.2 57.8]
        """
        asked = (
            (_PENETRATION, as_floats(pair.dR)),
            (_STIFFNESS_UNDER, pair.E_star),
            (_ENERGY_UNDER, _energy_unit(pair)),
            (_PEAK, _pressure_unit(pair)),
            (_ANGLE, _IN_DEGREES),
        )
        return ContactState(*self._under_load(load, pair, *asked))

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm; inf except in some thin housings."""
        return self._end(_Quantity(lambda curve, _: curve.end[0]), pair, _load_unit(pair))

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm at `max_load`; inf except in some thin housings."""
        return self._end(_Quantity(lambda curve, _: curve.end[1]), pair, as_floats(pair.dR))

    def curve(self, pair: CylinderPair) -> Curve:
        """Return the curve of one pair, whose E* and ΔR may be arrays."""
        self.require_pair(pair)
        kernels, parts = self._parts(pair)
        rule, remedy = "has bodies of several α, β or housings", "take one of them"
        is_one = len(kernels) == 1 and _are_one(parts)
        require(is_one, type(self).__name__, "pair", None, rule, remedy)
        return _curve_of(parts, kernels)

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for external contact."""
        require_hole(type(self).__name__, pair)

    def _end(self, quantity: _Quantity, pair: CylinderPair, unit: FloatArray) -> FloatArray:
        """Return where the law ends, in a unit."""
        zero = np.zeros(np.broadcast_shapes(np.shape(pair.E_star), np.shape(pair.dR)))
        if isinstance(self.datum, Housing):
            return self._answers(as_floats(zero + LEAST), pair, as_floats(1.0), (quantity, unit))[0]
        self.require_pair(pair)
        return as_floats(zero + np.inf)

    def _parts(self, pair: CylinderPair) -> tuple[Sequence[Kernel | None], list[FloatArray]]:
        """Return the kernels of housings, and w_i, β, C and the number of the kernel of a pair."""
        which: IndexArray = np.array(0)
        kernels: Sequence[Kernel | None] = [None]
        if isinstance(self.datum, Housing):
            which, kernels = self.datum.kernels(pair)
        parts = pair.shares[0], pair.beta.round(15), self.constant(pair), which
        return kernels, [as_floats(part) for part in parts]

    def _under_load(self, load: ArrayLike, pair: CylinderPair, *asked: _Asked) -> list[FloatArray]:
        """Return quantities, each in its unit, under loads in N/mm."""
        return self._answers(numbers_for(pair, load=load), pair, _load_unit(pair), *asked)

    def _at_penetration(
        self, penetration: ArrayLike, pair: CylinderPair, asked: _Asked
    ) -> FloatArray:
        """Return a quantity in its unit at penetrations in mm."""
        delta = numbers_for(pair, penetration=penetration)
        return self._answers(delta, pair, as_floats(pair.dR), asked)[0]

    def _answers(
        self, numbers: FloatArray, pair: CylinderPair, unit: FloatArray, *asked: _Asked
    ) -> list[FloatArray]:
        """Return quantities, each in its unit, for numbers that are divided by `unit`.

        One pair has one curve, as has each housing. Rows of other materials are searched, but if
        few pairs of materials have many rows each, these have a curve as well.
        """
        self.require_pair(pair)
        kernels, parts = self._parts(pair)
        columns = [numbers, unit, *(of for _, of in asked), *parts]
        shape = np.broadcast_shapes(*(column.shape for column in columns))
        columns = [c if c.ndim == 0 else np.broadcast_to(c, shape).ravel() for c in columns]
        results = [np.empty(math.prod(shape)) for _ in asked]
        size = results[0].size

        def fill(curve: _Curves, here: slice | IndexArray) -> None:
            x, unit, *of_results = (
                c if c.ndim == 0 else c[here] for c in columns[: 2 + len(asked)]
            )
            with np.errstate(all="ignore"):
                ratio = as_floats(x / unit)
                for (quantity, _), result, of in zip(asked, results, of_results, strict=True):
                    result[here] = quantity.at(curve, ratio) * of

        if _are_one(parts):
            curve = _curve_of(parts, kernels)
            for here in blocks(size, BLOCK):
                fill(curve, here)
        else:
            rows = [np.broadcast_to(column, (size,)) for column in columns[2 + len(asked) :]]
            if isinstance(self.datum, Housing) or fewest_kinds(rows) * _SHARED <= size:
                _fill_by_curves(fill, rows, kernels)
            else:
                _fill_by_search(fill, rows[:3], increasing=isinstance(self.datum, str))
        return [as_floats(result.reshape(shape)) for result in results]


class _Quantity(NamedTuple):
    """A quantity of a curve, over the load or over the penetration."""

    value: Callable[[_Curves, FloatArray], FloatArray | float]
    by_load: bool = False
    grows: bool = True  # without bound

    def at(self, curve: _Curves, x: FloatArray) -> FloatArray:
        """Return it for any numbers: for negative ones 0, or NaN by the load."""
        end = curve.end[0 if self.by_load else 1]
        most = min(end, MOST)
        if x.min() >= LEAST and x.max() <= most:  # the usual case
            return as_floats(self.value(curve, x))
        inside = as_floats(np.where(x > LEAST, np.minimum(x, most), LEAST))
        value = np.where(x > 0, self.value(curve, inside), 0.0)
        if self.grows:
            value = np.where(x == np.inf, np.inf, value)
        outside = ~(x <= end) | (x < 0) if self.by_load else ~(x <= end)
        return inside_or_nan(value, ~outside)


_LOAD = _Quantity(lambda curve, d: curve.load(d))
_STIFFNESS = _Quantity(lambda curve, d: curve.stiffness(d), grows=False)
_ENERGY = _Quantity(lambda curve, d: curve.energy(d))
_PENETRATION = _Quantity(lambda curve, phi: curve.penetration(phi), by_load=True)
_ANGLE = _Quantity(lambda curve, phi: curve.angle(phi), by_load=True, grows=False)
_PEAK = _Quantity(lambda curve, phi: phi * curve.peak(phi), by_load=True)
_STIFFNESS_UNDER = _Quantity(
    lambda curve, phi: curve.stiffness(curve.penetration(phi)), by_load=True, grows=False
)
_ENERGY_UNDER = _Quantity(lambda curve, phi: curve.energy(curve.penetration(phi)), by_load=True)
_IN_DEGREES = np.degrees(as_floats(1.0))


def _energy_unit(pair: CylinderPair) -> FloatArray:
    """Return E*·ΔR² in N."""
    return as_floats(_load_unit(pair) * as_floats(pair.dR))


def _pressure_unit(pair: CylinderPair) -> FloatArray:
    """Return E*·ΔR/√(R_i·R_j) in MPa."""
    R_i, R_j = pair.radii("the contact pressure")
    return as_floats(_load_unit(pair) / np.sqrt(R_i * R_j))


def _load_unit(pair: CylinderPair) -> FloatArray:
    """Return E*·ΔR in N/mm."""
    return as_floats(pair.E_star * as_floats(pair.dR))


def _are_one(parts: list[FloatArray]) -> bool:
    """Return whether the rows of a pair have one curve."""
    return not any(part.ndim and np.ptp(part) > _ROUNDING for part in parts)


@lru_cache(maxsize=256)
def _bodies(w_i: float, beta: float, C: float, kernel: Kernel | None) -> Bodies:
    """Return the bodies of a pair, whose last arc is sought once."""
    return Bodies(as_floats(w_i), beta, as_floats(C), kernel)


@lru_cache(maxsize=128)
def _curve(bodies: Bodies) -> Curve:
    """Return the curve of bodies, which is made once."""
    return make(bodies)


def _curve_of(parts: list[FloatArray], kernels: Sequence[Kernel | None]) -> Curve:
    """Return the curve of parts that are one."""
    w_i, beta, C = (float(part.flat[0]) for part in parts[:3])
    return _curve(_bodies(w_i, beta, C, kernels[0]))


def _fill_by_curves(
    fill: Callable[[_Curves, IndexArray], None],
    rows: Sequence[FloatArray],
    kernels: Sequence[Kernel | None],
) -> None:
    """Fill in the results of rows that have a curve each, several curves at a time."""
    keys, places = distinct_columns(rows)

    def fill_one(k: int) -> None:
        *key, kernel = keys[:, k].tolist()
        bodies, here = _bodies(*key, kernels[int(kernel)]), places[k]
        bodies.require_increasing()
        fill(_curve(bodies) if here.size > _FEW else bodies, here)

    with on_one_thread():
        on_all_cores(fill_one, range(len(places)))


def _fill_by_search(
    fill: Callable[[_Curves, slice], None], rows: Sequence[FloatArray], *, increasing: bool
) -> None:
    """Fill in the results of rows by a search for each; check the datum unless `increasing`."""
    from cylcontact.laws.conformal.many import Many, table_of_arcs  # which imports numba

    table_of_arcs()  # made once, before threads would make it twice

    def fill_block(here: slice) -> None:
        many = Many(*(np.ascontiguousarray(row[here]) for row in rows))
        if not increasing:
            many.require_increasing()
        fill(many, here)

    on_all_cores(fill_block, blocks(rows[0].size, _ROWS))


@dataclass(frozen=True)
class Persson(Conformal):
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
    friction, in an infinite plate; Z follows by reciprocity. It is `Conformal` for bodies of one
    material, with Johnson's datum: differences between this law and Johnson's are due to conformity
    alone.

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

    datum: Datum = field(default="johnson", init=False, repr=False)
    name: ClassVar[str] = "persson"

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for external contact or bodies of different materials."""
        law = "Persson's law"
        require_hole(law, pair)
        rule = "must have the same E and ν as material_i, or the solution does not hold"
        remedy = "give a pair of one material, or use laws.Conformal()"
        other = pair.material_j.title
        require(pair.of_one_material, law, "pair.material_j", other, rule, remedy)


def pressure(angle: ArrayLike, load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the pressure in MPa at `angle` in radians from the line of the load in N/mm.

    Persson's for a pair of one material, 0 outside the contact. R is √(R_i·R_j), so that small
    loads give exactly Hertz's peak pressure √(f·E*·ΔR/(π·R_i·R_j)) (Eq 7).

    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=steel)
    >>> print(pressure(np.radians([-20.0, 0.0, 20.0, 80.0]), 1000.0, pair).round(2))
    [75.32 83.25 75.32  0.  ]
    """
    f = as_floats(load)
    R_i, R_j = pair.radii("the contact pressure")
    b2 = np.tan(np.radians(Persson().contact_angle(f, pair)) / 2) ** 2
    # NaN for an infinite angle, or an infinite load outside the contact.
    with np.errstate(invalid="ignore"):
        p = f / np.sqrt(R_i * R_j) * persson_pressure(np.tan(as_floats(angle) / 2), b2)
    return as_floats(p)


def persson_pressure(y: FloatArray, b2: FloatArray) -> FloatArray:
    """Return R·p/f at y = tan(θ/2) on the arc of b² = tan²(ε/2) for β = 0; zero outside it."""
    b, B = np.sqrt(b2), np.sqrt(1 + b2)
    s = np.sqrt(np.maximum((b - y) * (b + y), 0.0))
    even = 2 * s / (np.pi * B * (1 + y**2))
    return as_floats(even + np.arctanh(s / B) / (np.pi * b2 * (1 + b2)))
