"""A law that one formula states."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, fields, replace
from functools import partial
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, require
from cylcontact.html_repr import completed_law_html
from cylcontact.laws.contact_law import ContactLaw, OverLength, require_hole
from cylcontact.laws.definition import LawModel, Parameter
from cylcontact.laws.formula import Formula
from cylcontact.pair import CONTACTS, Contact, CylinderPair

# Numbers at a time: what a formula makes of them stays in the cache of a core.
BLOCK = 16384
# Of Newton's method for a penetration: steps at most, the last one, and how far from the guess it
# is sought.
_STEPS, _LAST_STEP, _REACH = 200, 1e-8, 1e120
_ROUNDING, _LEAST = 1e-13, 1e-300


class AtPair(NamedTuple):
    """A law at a pair: functions of a positive penetration, its end, and whether it is one pair."""

    load: Callable[[FloatArray], FloatArray]
    stiffness: Callable[[FloatArray], FloatArray]
    end: FloatArray
    is_single: bool


class Law(OverLength):
    """A law that one formula states; see `cylcontact.laws.formula`.

    A subclass is a frozen dataclass whose fields are its constants, or one field `coefficients`.

    Attributes
    ----------
    name : str
        Its name in campaigns and commands.
    formula : Formula
        The load, and where the law ends.
    contacts : tuple of {"internal", "external"}
        The contacts that it is for.
    needs : tuple of str
        What it needs to know of a pair besides ΔR: R_i, R_j, length.
    any_plane : bool
        Whether it also holds in plane stress, with the E* of that.
    parameters : tuple of Parameter
        Its constants as they are fitted.
    defaults : mapping
        The coefficients by contact of a law that is made from `coefficients`.
    published, on_grid, dimensionless : bool
        As `LawModel` has them.
    """

    name: ClassVar[str]
    formula: ClassVar[Formula]
    contacts: ClassVar[tuple[Contact, ...]] = CONTACTS
    needs: ClassVar[tuple[str, ...]] = ()
    any_plane: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = ()
    defaults: ClassVar[Mapping[Contact, Any]] = {}
    published: ClassVar[bool] = True
    on_grid: ClassVar[bool] = False
    dimensionless: ClassVar[bool] = False
    # Where published coefficients are from, in ASCII, for exported files.
    _source: ClassVar[str] = ""

    def __post_init__(self) -> None:
        given: Any = getattr(self, "coefficients", None)
        if isinstance(given, Mapping):
            object.__setattr__(self, "coefficients", self._coefficients_from(given))

    def _repr_html_(self) -> str:
        return completed_law_html(self, self.defaults)

    def formula_for(self, contact: Contact) -> Formula:
        """Return the formula for a contact."""
        return self.formula

    def formula_at(self, pair: CylinderPair) -> Formula | None:
        """Return the formula at a pair; None where the law is a table."""
        return self.formula_for(pair.contact)

    def constants_for(self, contact: Contact) -> dict[str, float]:
        """Return the constants of the formula for a contact, by name."""
        own = fields(self)  # type: ignore[arg-type]  # every subclass is a dataclass
        if [field.name for field in own] != ["coefficients"]:
            return {field.name: float(getattr(self, field.name)) for field in own}
        return asdict(self._coefficients_for(contact))

    @classmethod
    def _coefficients_from(cls, values: Mapping[str, float]) -> Any:
        """Return coefficients from their values by name."""
        (kind,) = {type(default) for default in cls.defaults.values()}
        return kind(**values)

    def _coefficients_for(self, contact: Contact) -> Any:
        """Return the coefficients, by default those for a contact."""
        given: Any = getattr(self, "coefficients", None)
        return self.defaults[contact] if given is None else given

    def constants_at(self, pair: CylinderPair) -> Mapping[str, Any]:
        """Return the constants of the formula at a pair."""
        return self.constants_for(pair.contact)

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for a pair that the law is not for."""
        if len(self.contacts) == 1:
            require_hole(type(self).__name__, pair)
        if not self.any_plane:
            pair.require_plane_strain(type(self).__name__)

    def numbers_at(self, pair: CylinderPair) -> dict[str, FloatArray]:
        """Return the numbers of the formula at a pair, by name."""
        self.require_pair(pair)
        formula = self.formula_for(pair.contact)
        asked: dict[str, Any] = {}
        for name in formula.arguments:
            if name in ("R_i", "R_j"):
                asked["R_i"], asked["R_j"] = pair.radii(f"the {self.name} law")
            elif name == "length":
                asked["length"] = pair.contact_length(f"the {self.name} law")
            else:
                asked[name] = as_floats(getattr(pair, name))
        rule = "is a plane, and the law needs a finite ΔR"
        remedy = "use laws.Johnson(datum=depth in mm) for a cylinder on a plane"
        finite = np.isfinite(asked.get("dR", 0.0))
        require(finite, type(self).__name__, "pair.R_j", pair.R_j, rule, remedy)
        asked = {name: asked[name] for name in formula.arguments}
        with np.errstate(all="ignore"):
            values = formula.of_pair(**asked, **self.constants_at(pair))
        return dict(zip(formula.numbers, values, strict=True))

    def at_pair(self, pair: CylinderPair) -> AtPair:
        """Return the load and the stiffness at a pair, as functions of the penetration."""
        numbers = self.numbers_at(pair)
        formula = self.formula_for(pair.contact)
        shape = np.broadcast_shapes(np.shape(pair.E_star), np.shape(pair.dR))
        end = as_floats(np.broadcast_to(numbers.get("last", np.inf), shape))
        return AtPair(
            partial(formula.load, **numbers),
            partial(formula.stiffness, **numbers),
            end,
            not (shape or any(np.ndim(value) for value in numbers.values())),
        )

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        at = self.at_pair(pair)
        return _in_blocks(lambda delta: _inside(at.load(delta), delta, at.end), penetration, at)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm."""
        at = self.at_pair(pair)
        return _in_blocks(
            lambda delta: _inside(at.stiffness(delta), delta, at.end), penetration, at
        )

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
        return _in_blocks(lambda f: _inverse(at, f, unit, dR), load, at)

    @classmethod
    def fitted(cls, values: Mapping[str, float]) -> ContactLaw:
        """Return the law with these values of its parameters."""
        given: Any = cls
        law: ContactLaw = given(coefficients=values) if cls.defaults else given(**values)
        return law

    @classmethod
    def models(cls) -> tuple[LawModel, ...]:
        """Return how the law is fitted, for each of its contacts."""
        return tuple(cls.model(contact) for contact in cls.contacts if cls.parameters)

    @classmethod
    def model(cls, contact: Contact, **forms: Any) -> LawModel:
        """Return how the law is fitted for a contact, with its default coefficients as nominal."""
        nominal = asdict(cls.defaults[contact]) if cls.defaults else {}
        parameters = tuple(
            replace(p, nominal=nominal[p.name]) if p.nominal is None and p.name in nominal else p
            for p in cls.parameters
        )
        return LawModel(
            cls.name,
            contact,
            parameters,
            cls.fitted,
            on_grid=cls.on_grid,
            dimensionless=cls.dimensionless,
            nominal_is_published=cls.published,
            **forms,
        )


def _in_blocks(
    function: Callable[[FloatArray], FloatArray], values: ArrayLike, at: AtPair
) -> FloatArray:
    """Return a function of values, of many at one pair block by block."""
    given = as_floats(values)
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


def has_formula(law: ContactLaw) -> bool:
    """Return whether the load of a law is that of its formula."""
    return isinstance(law, Law) and type(law).load is Law.load


def formula_of(law: ContactLaw, contact: Contact) -> Formula | None:
    """Return the formula that computes a law's load; None if it has none."""
    return law.formula_for(contact) if isinstance(law, Law) and has_formula(law) else None
