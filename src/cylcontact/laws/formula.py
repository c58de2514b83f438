"""The formula of a law: plain functions of numbers, whose arguments say what they take.

    def numbers(E_star, dR, K_star, n):         # once for a pair
        return Numbers(K_star * E_star / dR, n)

    def load(penetration, factor, n):           # of the penetration and these numbers
        return factor * penetration**n

NumPy runs them on arrays, numba compiles them, and `export` reads them. They keep to assignments,
`choose`, loops over a `range`, NumPy's elementary functions and calls of each other. Arguments
named as in `OF_PAIR` come from the pair; the others are constants of the law.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError

# What a formula may ask of a pair, in the order in which exported functions take it.
OF_PAIR = ("E_star", "dR", "R_i", "R_j", "length", "alpha", "beta")
# The relative step of a difference, which gives a stiffness to 1e-10.
STEP = 6e-6
_FORM = "write it as def load(penetration, E_star, dR, K=1.0, n=1.1): ..."


def choose(test: Any, yes: Any, no: Any) -> Any:
    """Return one of two numbers, for arrays element by element."""
    return np.where(test, yes, no)


def by_differences(load: Callable[..., Any], penetration: Any, *numbers: Any) -> Any:
    """Return the stiffness of a load by central differences."""
    more, less = penetration * (1 + STEP), penetration * (1 - STEP)
    return (load(more, *numbers) - load(less, *numbers)) / (more - less)


@dataclass(frozen=True, repr=False)
class Formula:
    """The functions that state a law."""

    load: Callable[..., Any]  # of the penetration and the numbers of a pair
    # The same for the stiffness; by differences without it.
    stiffness: Callable[..., Any] | None = None
    # From a pair and the constants to the numbers; without it the load takes pair and constants.
    numbers: Callable[..., Any] | None = None
    # ∫ f dδ of what the load takes, by quadrature without it.
    energy: Callable[..., Any] | None = None
    # The largest penetration in mm, from some of the numbers by name: NaN where the law is
    # undefined; inf without it.
    end: Callable[..., Any] | None = None
    # For exported files, in ASCII: the law on one line, and what its users should know.
    equation: str = ""
    remark: str = ""

    @cached_property
    def asked(self) -> dict[str, float | None]:
        """What the formula takes besides the penetration, with the defaults of constants."""
        try:
            taken = list(inspect.signature(self.numbers or self.load).parameters.values())
        except (TypeError, ValueError):
            raise self._refusal("has no signature to read") from None
        plain = all(p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY) for p in taken)
        if not plain or len(taken) < (self.numbers is None):
            given = ", ".join(map(str, taken))
            raise self._refusal(f"must take a penetration and named numbers, and takes ({given})")
        asked = {}
        for each in taken if self.numbers else taken[1:]:
            default = None if each.default is each.empty else each.default
            if each.name == "pair":
                raise self._refusal("takes a pair, and has to take what it needs of it by name")
            if not isinstance(default, int | float | None):
                raise self._refusal(f"has a default for {each.name} that is not a number")
            if each.name in OF_PAIR and default is not None:
                raise self._refusal(f"has a default for {each.name}, which comes from the pair")
            asked[each.name] = default
        return asked

    @cached_property
    def of_pair(self) -> tuple[str, ...]:
        """What the formula asks of a pair."""
        return tuple(name for name in OF_PAIR if name in self.asked)

    @cached_property
    def constants(self) -> dict[str, float | None]:
        """The constants of the law, with their defaults."""
        return {name: value for name, value in self.asked.items() if name not in OF_PAIR}

    @cached_property
    def taken(self) -> tuple[str, ...]:
        """The names of the numbers of a pair, in the order in which the load takes them."""
        return tuple(inspect.signature(self.load).parameters)[1:]

    @cached_property
    def taken_by_end(self) -> tuple[str, ...]:
        """The names of those that `end` takes."""
        return tuple(inspect.signature(self.end).parameters) if self.end else ()

    def last(self, *numbers: Any) -> Any:
        """Return the largest penetration."""
        if self.end is None:
            return np.inf
        by_name = dict(zip(self.taken, numbers, strict=True))
        return self.end(*(by_name[name] for name in self.taken_by_end))

    def numbers_of(self, **asked: Any) -> tuple[Any, ...]:
        """Return the numbers of a pair."""
        if self.numbers is not None:
            return tuple(self.numbers(**asked))
        return tuple(asked[name] for name in self.asked)

    def slope(self, penetration: FloatArray, *numbers: Any) -> Any:
        """Return the stiffness."""
        if self.stiffness is not None:
            return self.stiffness(penetration, *numbers)
        return by_differences(self.load, penetration, *numbers)

    def _refusal(self, rule: str) -> InputError:
        """Return the error of a function that is no formula."""
        function: Any = self.numbers or self.load
        code, name = getattr(function, "__code__", None), getattr(function, "__name__", "load")
        source = f"{code.co_filename}: {name}" if code else name
        return InputError(source, "", None, rule, _FORM)
