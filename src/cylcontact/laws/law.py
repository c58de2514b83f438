"""A law that one formula states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields, is_dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.html_repr import completed_law_html
from cylcontact.laws.contact_law import ContactLaw, OverLength, require_hole
from cylcontact.laws.definition import LawModel, Parameter
from cylcontact.laws.formula import Formula
from cylcontact.pair import CONTACTS, Contact, CylinderPair

# Numbers at a time: what a formula makes of them stays in the cache of a core.
BLOCK = 16384
# Steps of Newton's method at most, and the one that is the last, because it leaves its square.
_STEPS, _LAST_STEP = 100, 1e-8


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

    def _repr_html_(self) -> str:
        return completed_law_html(self, self.defaults)

    def formula_for(self, contact: Contact) -> Formula:
        """Return the formula for a contact."""
        return self.formula

    def constants_for(self, contact: Contact) -> dict[str, float]:
        """Return the constants of the formula for a contact, by name."""
        own = fields(self)  # type: ignore[arg-type]  # every subclass is a dataclass
        if [field.name for field in own] != ["coefficients"]:
            return {field.name: float(getattr(self, field.name)) for field in own}
        given = getattr(self, "coefficients")
        return asdict(given if is_dataclass(given) else self.defaults[contact])

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
        asked = {name: asked[name] for name in formula.arguments}
        with np.errstate(all="ignore"):
            values = formula.of_pair(**asked, **self.constants_at(pair))
        return dict(zip(formula.numbers, values, strict=True))

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        return self._at_depth("load", penetration, pair)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm²."""
        return self._at_depth("stiffness", penetration, pair)

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the largest penetration in mm; inf where there is none."""
        return self._end(pair, self.numbers_at(pair))

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm; inf where there is none."""
        end = self.max_penetration(pair)
        at_end = self.load(np.where(np.isfinite(end), end, 0.0), pair)
        return as_floats(np.where(np.isfinite(end), at_end, end))

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm.

        By Newton's method on ln f over ln δ, in which every contact law is nearly straight.
        """
        numbers, f = self.numbers_at(pair), as_floats(load)
        end = self._end(pair, numbers)
        one = end.ndim == 0 and all(np.ndim(value) == 0 for value in numbers.values())
        scale = as_floats(pair.E_star * as_floats(pair.dR))
        if one and f.size > BLOCK:
            flat = f.ravel()
            parts = [
                self._inverse(flat[first : first + BLOCK], numbers, pair, end, scale)
                for first in range(0, flat.size, BLOCK)
            ]
            return np.concatenate(parts).reshape(f.shape)
        return self._inverse(f, numbers, pair, end, scale)

    def _inverse(
        self,
        f: FloatArray,
        numbers: Mapping[str, FloatArray],
        pair: CylinderPair,
        end: FloatArray,
        scale: FloatArray,
    ) -> FloatArray:
        """Return the penetration under loads of few numbers."""
        formula, positive = self.formula_for(pair.contact), f > 0
        target = np.where(positive, f, scale)
        with np.errstate(all="ignore"):
            x = np.log(self._first_guess(target / pair.E_star, as_floats(pair.dR)))
            goal = np.log(target)
            for _ in range(_STEPS):
                depth = np.exp(x)
                value = formula.load(depth, **numbers)
                step = (goal - np.log(value)) * value
                step = step / (formula.stiffness(depth, **numbers) * depth)
                x = x + step
                if not np.any(np.abs(step) > _LAST_STEP):
                    break
            delta = np.where(np.abs(step) <= _LAST_STEP, np.exp(x), np.nan)
            delta = np.where(delta <= end, delta, np.nan)
        delta = np.where(positive, delta, np.where(f == 0, 0.0 * delta, np.nan))
        return as_floats(delta)

    def _first_guess(self, load: FloatArray, dR: FloatArray) -> FloatArray:
        """Return about the penetration in mm under a load in units of E* (mm)."""
        return as_floats(load / np.pi * (1.4232 + np.log1p(1.0942 * dR / load)))

    def _at_depth(self, what: str, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return a function of the formula: 0 before first touch, NaN outside the domain."""
        function = getattr(self.formula_for(pair.contact), what)
        numbers, delta = self.numbers_at(pair), as_floats(penetration)
        end = self._end(pair, numbers)
        with np.errstate(all="ignore"):
            if delta.size <= BLOCK or any(np.ndim(value) for value in (end, *numbers.values())):
                return as_floats(_inside(function(delta, **numbers), delta, end))
            flat, results = delta.ravel(), np.empty(delta.size)
            for first in range(0, flat.size, BLOCK):
                block = flat[first : first + BLOCK]
                results[first : first + BLOCK] = _inside(function(block, **numbers), block, end)
        return results.reshape(delta.shape)

    def _end(self, pair: CylinderPair, numbers: Mapping[str, Any]) -> FloatArray:
        """Return the largest penetration in mm in the shape of the pair."""
        shape = np.broadcast_shapes(np.shape(pair.E_star), np.shape(pair.dR))
        return as_floats(np.broadcast_to(numbers.get("last", np.inf), shape))

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


def _inside(values: FloatArray, delta: FloatArray, end: FloatArray) -> FloatArray:
    """Return values, 0 where the penetration is negative and NaN beyond the end."""
    if delta.ndim == 1 and end.ndim == 0 and delta.size:  # the usual case: all inside
        if delta.min() > 0 and delta.max() <= end and values.shape == delta.shape:
            return values
    shape = np.broadcast_shapes(delta.shape, end.shape)
    values = np.asarray(values)
    if values.shape != shape or not values.flags.writeable:
        values = np.broadcast_to(values, shape).copy()
    np.copyto(values, np.nan, where=~(delta <= end))
    touching = delta > 0
    if not np.all(touching):
        first = (delta == 0) & (end > 0) & np.isnan(values)  # where a logarithm has no value
        np.copyto(values, 0.0, where=(delta < 0) | first)
    return values


def formula_of(law: ContactLaw, contact: Contact) -> Formula | None:
    """Return the formula that computes a law's load; None if it has none."""
    own = isinstance(law, Law) and type(law).load is Law.load
    return law.formula_for(contact) if own else None
