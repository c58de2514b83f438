"""What a contact law is, and how one formula gives all of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import MISSING, field
from numbers import Real
from typing import Any, ClassVar, NamedTuple, Protocol, TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CONTACTS, Contact, CylinderPair
from cylcontact.laws.formula import Formula
from cylcontact.support.arrays import FloatArray, as_floats, require, require_one_shape
from cylcontact.support.html_repr import law_html

Coefficients = Mapping[str, float]

# Numbers at a time: what a formula makes of them stays in the cache of a core.
BLOCK = 32768
# Of Newton's method for a penetration: steps at most, the last one, and how far from the guess it
# is sought.
_STEPS, _LAST_STEP, _REACH = 200, 1e-8, 1e120
_ROUNDING, _LEAST = 1e-13, 1e-300


class ContactLaw(Protocol):
    """Load per unit length against penetration for a pair of parallel cylinders.

    Loads are in N/mm, penetrations in mm, stiffness in N/mm². All arguments broadcast, also
    against array-valued pairs. At a negative penetration the bodies do not touch: load and
    stiffness are 0. Elements outside a law's domain are NaN, as is the penetration under a negative
    load.
    """

    @property
    def name(self) -> str:
        """The law's name in specs and reports."""

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm."""

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm; inf where there is none."""

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the largest penetration in mm; inf where there is none."""


# Gauss nodes and weights on [0, 1] for the energy of a load: in s, with the node at s², in which a
# load that grows with a power of at least 1 is smooth enough.
_s, _w = np.polynomial.legendre.leggauss(24)
ENERGY_NODES, ENERGY_WEIGHTS = (_s + 1) ** 2 / 4, _w * (_s + 1) / 2


def require_hole(law: str, pair: CylinderPair) -> None:
    """Raise `InputError` for external contact."""
    rule = "must be internal: the law is for a pin in a hole"
    remedy = "use laws.Johnson() for external contact"
    require(pair.contact == "internal", law, "pair.contact", pair.contact, rule, remedy)


def numbers_for(pair: CylinderPair, **given: ArrayLike) -> FloatArray:
    """Return loads or penetrations as numbers; raise `InputError` unless they go with a pair."""
    ((key, values),) = given.items()
    numbers = as_floats(values)
    if numbers.ndim and (np.ndim(pair.dR) or np.ndim(pair.E_star)):
        require_one_shape("laws", **{key: numbers, "dR": pair.dR, "E_star": pair.E_star})
    return numbers


def depth_of(penetration: ArrayLike) -> FloatArray:
    """Return the penetration, 0 where it is negative and the bodies do not touch."""
    return as_floats(np.maximum(as_floats(penetration), 0.0))


def difference_percent(
    law: ContactLaw, reference: ContactLaw, load: ArrayLike, pair: CylinderPair
) -> FloatArray:
    """Return 100·(δ_law − δ_reference)/δ_reference in percent at equal load (Eq 9).

    Parameters
    ----------
    law, reference : ContactLaw
        The law and the one it is compared with.
    load : array_like
        Load per unit length in N/mm.
    pair : CylinderPair
        The pair, possibly array-valued.

    Returns
    -------
    array of float
        Percent, of the broadcast shape; NaN at zero load and where either law is undefined.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material, laws
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> print(difference_percent(laws.Enhanced(), laws.Johnson(), [10.0, 100.0], pair).round(2))
    [ 8.51 -2.88]
    """
    delta = law.penetration(load, pair)
    delta_reference = reference.penetration(load, pair)
    with np.errstate(divide="ignore", invalid="ignore"):
        return as_floats(100 * (delta - delta_reference) / delta_reference)


# --- the law of a formula -----------------------------------------------------------------------


def constant(low: float, high: float, meaning: str, default: Any = MISSING, unit: str = "") -> Any:
    """Return the field of a constant: the bounds between which a fit seeks it, unit and meaning."""
    about = {"low": low, "high": high, "meaning": meaning, "unit": unit}
    return field(default=default, metadata=about)


class Constants:
    """The constants of a law; a subclass is a frozen dataclass whose fields are `constant`s."""

    law: ClassVar[str]

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            finite = isinstance(value, Real) and math.isfinite(value)
            rule = "a coefficient must be a finite number"
            remedy = "give the value that a fit or the paper gives"
            require(finite, self.law, name, value, rule, remedy)


class AtPair(NamedTuple):
    """A law at a pair: functions of a positive penetration, its end, and whether it is one pair."""

    load: Callable[[FloatArray], FloatArray]
    stiffness: Callable[[FloatArray], FloatArray]
    end: FloatArray
    is_single: bool


class Law:
    """A law that one formula states; see `cylcontact.laws.formula`.

    A subclass is a frozen dataclass whose fields are its constants, or one field `coefficients`.
    """

    name: ClassVar[str]
    formula: ClassVar[Formula]
    contacts: ClassVar[tuple[Contact, ...]] = CONTACTS  # that it is for
    any_plane: ClassVar[bool] = True  # whether it also holds in plane stress, with the E* of that
    defaults: ClassVar[Mapping[Contact, Any]] = {}  # coefficients, `Constants`, by contact
    origin: ClassVar[str] = "published"  # of its default coefficients, in ASCII

    def __post_init__(self) -> None:
        given: Any = getattr(self, "coefficients", None)
        if isinstance(given, Mapping):
            object.__setattr__(self, "coefficients", self._coefficients_from(given))

    def _repr_html_(self) -> str:
        return law_html(self, self.defaults)

    @classmethod
    def _coefficients_from(cls, values: Coefficients) -> Any:
        """Return coefficients from their values by name."""
        (kind,) = {type(default) for default in cls.defaults.values()}
        return kind(**values)

    def coefficients_for(self, contact: Contact) -> Any:
        """Return the coefficients, by default those for a contact."""
        given: Any = getattr(self, "coefficients", None)
        return self.defaults[contact] if given is None else given

    def formula_for(self, contact: Contact) -> Formula:
        """Return the formula for a contact."""
        return self.formula

    def constants_for(self, contact: Contact) -> dict[str, float]:
        """Return the constants of the formula for a contact, by name."""
        given = self.coefficients_for(contact) if self.defaults else self
        return {name: float(getattr(given, name)) for name in self.formula_for(contact).constants}

    def formula_at(self, pair: CylinderPair) -> Formula:
        """Return the formula for a pair."""
        return self.formula_for(pair.contact)

    @property
    def title(self) -> str:
        """What errors call the law."""
        return type(self).__name__

    @property
    def note(self) -> str:
        """What a user of these constants should know, in ASCII; "" for most."""
        return ""

    @property
    def needs(self) -> tuple[str, ...]:
        """What the law needs of a pair besides E* and ΔR."""
        return tuple(name for name in self.formula.of_pair if name not in ("E_star", "dR"))

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for a pair that the law is not for."""
        if len(self.contacts) == 1:
            require_hole(self.title, pair)
        if not self.any_plane:
            pair.require_plane_strain(self.title)

    def numbers_at(self, pair: CylinderPair) -> tuple[Any, ...]:
        """Return the numbers of the formula at a pair."""
        self.require_pair(pair)
        formula, law = self.formula_at(pair), f"the {self.name} law"
        if {"R_i", "R_j"} & {*formula.of_pair}:
            pair.radii(law)
        if "length" in formula.of_pair:
            pair.contact_length(law)
        asked = {name: as_floats(getattr(pair, name)) for name in formula.of_pair}
        rule = "is a plane, and the law needs a finite ΔR"
        remedy = "use laws.Johnson(datum=depth in mm) for a cylinder on a plane"
        finite = np.isfinite(asked.get("dR", 0.0))
        require(finite, self.title, "pair.R_j", pair.R_j, rule, remedy)
        with np.errstate(all="ignore"):
            return formula.numbers_of(**asked, **self.constants_for(pair.contact))

    def at_pair(self, pair: CylinderPair) -> AtPair:
        """Return the load and the stiffness at a pair, as functions of the penetration."""
        numbers, formula = self.numbers_at(pair), self.formula_at(pair)
        shape = np.broadcast_shapes(np.shape(pair.E_star), np.shape(pair.dR))
        return AtPair(
            lambda penetration: formula.load(penetration, *numbers),
            lambda penetration: formula.slope(penetration, *numbers),
            as_floats(np.broadcast_to(formula.last(*numbers), shape)),
            is_single=not (shape or any(np.ndim(number) for number in numbers)),
        )

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        at, depth = self.at_pair(pair), numbers_for(pair, penetration=penetration)
        return _in_blocks(lambda delta: _inside(at.load(delta), delta, at.end), depth, at)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm."""
        at, depth = self.at_pair(pair), numbers_for(pair, penetration=penetration)
        return _in_blocks(lambda d: _inside(at.stiffness(d), d, at.end), depth, at)

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the largest penetration in mm; inf where there is none."""
        return self.at_pair(pair).end

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm; inf where there is none."""
        end = self.max_penetration(pair)
        at_end = self.load(np.where(np.isfinite(end), end, 0.0), pair)
        return as_floats(np.where(np.isfinite(end), at_end, end))

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm.

        By Newton's method on ln f over ln δ, in which every contact law is nearly straight, with
        the middle of a bracket in place of a step that leaves it.
        """
        at, dR = self.at_pair(pair), as_floats(pair.dR)
        unit = as_floats(pair.E_star * dR)
        f = numbers_for(pair, load=load)
        return _in_blocks(lambda f: _inverse(at, f, unit, dR), f, at)


def _in_blocks(
    function: Callable[[FloatArray], FloatArray], given: FloatArray, at: AtPair
) -> FloatArray:
    """Return a function of numbers, of many at one pair block by block."""
    with np.errstate(all="ignore"):
        if given.size <= BLOCK or not at.is_single:
            return as_floats(function(given))
        flat, results = given.ravel(), np.empty(given.size)
        for first in range(0, flat.size, BLOCK):
            results[first : first + BLOCK] = function(flat[first : first + BLOCK])
    return results.reshape(given.shape)


def _inside(values: FloatArray, delta: FloatArray, end: FloatArray) -> FloatArray:
    """Return values, 0 where the penetration is negative and NaN beyond the end."""
    alike = delta.ndim == 1 and delta.size > 0 and end.ndim == 0 and values.shape == delta.shape
    if alike and delta.min() > 0 and delta.max() <= end:  # the usual case
        return values
    shape = np.broadcast_shapes(delta.shape, end.shape)
    values = np.asarray(values)
    if values.shape != shape or not values.flags.writeable:
        values = np.broadcast_to(values, shape).copy()
    np.copyto(values, np.nan, where=~(delta <= end))
    first = (delta == 0) & (end > 0) & np.isnan(values)  # where a logarithm has no value
    np.copyto(values, 0.0, where=(delta < 0) | first)
    return values


def _inverse(at: AtPair, f: FloatArray, unit: FloatArray, dR: FloatArray) -> FloatArray:
    """Return the penetration under loads f, from a guess that is right for conformal contact."""
    positive = f > 0
    phi = np.where(positive, f, unit) / unit
    goal = phi * unit
    depth = dR * phi / np.pi * (1.4232 + np.log1p(1.0942 / phi))
    low, high = np.maximum(depth / _REACH, _LEAST), depth * _REACH
    for _ in range(_STEPS):
        value = at.load(depth)
        miss = np.log(goal / value)
        step = miss * value / (at.stiffness(depth) * depth)
        low, high = np.where(miss > 0, depth, low), np.where(miss > 0, high, depth)
        new = depth * np.exp(step)
        depth = np.where((new >= low) & (new <= high), new, np.sqrt(low * high))
        if not np.any(np.abs(step) > _LAST_STEP):  # the last, because it leaves its square
            break
    depth = np.where(np.abs(step) <= _LAST_STEP, depth, np.nan)
    depth = np.where(depth <= at.end * (1 + _ROUNDING), np.minimum(depth, at.end), np.nan)
    depth = np.where(np.isinf(f) & np.isinf(at.end), np.inf, depth)
    return np.where(positive, depth, np.where((f == 0) & (at.end > 0), 0.0, np.nan))


def has_formula(law: ContactLaw) -> TypeGuard[Law]:
    """Return whether the load of a law is that of its formula."""
    return isinstance(law, Law) and type(law).load is Law.load
