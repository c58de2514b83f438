"""The parameters of a law that is fitted: free between bounds, fixed, or tied to others.

A tie is an expression such as "a/10" in a campaign's [ties], of numbers, names of parameters,
parentheses and + - * / **. It is parsed, not executed, and anything else is refused.
"""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.laws.law import ContactLaw, LawModel, Parameter
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError

# The elite that a genetic search does not evaluate again, a part of every budget.
ELITE = 2


class Minimum(NamedTuple):
    """The best free parameters of a search, shape (k,), their objective, and the evaluations."""

    point: FloatArray
    value: float
    evaluations: int


def built(model: LawModel, values: Sequence[float] | FloatArray) -> ContactLaw | None:
    """Return the law of values of all parameters; None for those that define none."""
    try:
        return model.build(dict(zip(model.names, map(float, values), strict=True)))
    except InputError:
        return None


@dataclass(frozen=True, eq=False)
class ParameterSpace:
    """The parameters of a law, some of them free between bounds, the others fixed or tied."""

    model: LawModel
    # One for each of the model's names, in their order.
    parameters: tuple[Parameter, ...]
    objective: object

    @cached_property
    def free(self) -> tuple[Parameter, ...]:
        """The parameters that are searched."""
        return tuple(p for p in self.parameters if p.is_free)

    @cached_property
    def names(self) -> list[str]:
        """The names of the free parameters."""
        return [p.name for p in self.free]

    @cached_property
    def low(self) -> FloatArray:
        """Lower bounds of the free parameters, shape (k,)."""
        return np.array([p.low for p in self.free])

    @cached_property
    def high(self) -> FloatArray:
        """Upper bounds of the free parameters, shape (k,)."""
        return np.array([p.high for p in self.free])

    def coefficients(self, point: FloatArray) -> dict[str, float]:
        """Return all coefficients by name, including the fixed and the tied ones."""
        complete = self.complete(point[None, :])[0]
        return {p.name: float(v) for p, v in zip(self.parameters, complete, strict=True)}

    def point(self, coefficients: Mapping[str, float]) -> FloatArray:
        """Return the free parameters from coefficients by name, shape (k,)."""
        return np.array([coefficients[name] for name in self.names])

    def fixing(self, **fixed: float) -> Self:
        """Return the same with some parameters fixed at values."""
        parameters = tuple(replace(p, value=fixed.get(p.name, p.value)) for p in self.parameters)
        return replace(self, parameters=parameters)

    def complete(self, points: FloatArray) -> FloatArray:
        """Add the fixed and the tied parameters to P points, shape (P, k) to (P, all)."""
        columns: dict[str, ArrayLike] = {
            name: points[:, column] for column, name in enumerate(self.names)
        }
        columns |= {p.name: p.value for p in self.parameters if p.value is not None}
        columns |= {p.name: evaluate(p.tie, columns) for p in self.parameters if p.tie is not None}
        complete = np.empty((len(points), len(self.parameters)))
        for index, parameter in enumerate(self.parameters):
            complete[:, index] = columns[parameter.name]
        return complete

    def scatter(self, rng: np.random.Generator, number: int) -> FloatArray:
        """Return random points between the bounds, shape (number, k)."""
        return rng.uniform(self.low, self.high, (number, len(self.free)))

    # What a search needs; a problem on a grid and a fit to readings have their own.

    def values(self, points: FloatArray) -> FloatArray:
        """Return the objective of P points of the free parameters, shape (P, k) to (P,)."""
        raise NotImplementedError

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return residuals whose squares add up to the objective's, shape (P, k) to (P, q)."""
        raise NotImplementedError

    def value(self, point: FloatArray) -> float:
        """Return the objective of one point, shape (k,)."""
        return float(self.values(point[None, :])[0])

    def value_of(self, coefficients: Mapping[str, float]) -> float:
        """Return the objective of coefficients by name, which may be outside the bounds."""
        raise NotImplementedError

    def finite_residuals(self, points: FloatArray) -> FloatArray:
        """Return `residuals` with 1e3 where a law is undefined, for solvers that need numbers."""
        return np.nan_to_num(self.residuals(points), nan=1e3, posinf=1e3, neginf=-1e3)


_BINARY: dict[type[ast.operator], Callable[[FloatArray, FloatArray], FloatArray]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_UNARY: dict[type[ast.unaryop], Callable[[FloatArray], FloatArray]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
}
_ALLOWED = (ast.Constant, ast.Name, ast.Load, ast.UnaryOp, ast.BinOp, *_UNARY, *_BINARY)
# Python's parser recurses, so a longer expression could exhaust its stack.
_LONGEST = 200
_ARITHMETIC = "numbers, names of parameters, parentheses and + - * / **"


def evaluate(expression: str, values: Mapping[str, ArrayLike]) -> FloatArray:
    """Return the value of a valid expression; inf or NaN where the arithmetic has none.

    >>> float(evaluate("1 + Y_log_scale/10", {"Y_log_scale": 1.51}))
    1.151
    """
    with np.errstate(all="ignore"):
        return _value(_parsed(expression), values)


def names_in(expression: str) -> frozenset[str]:
    """Return the names of parameters in a valid expression."""
    return frozenset(
        node.id for node in ast.walk(_parsed(expression)) if isinstance(node, ast.Name)
    )


def require_valid(
    ties: Mapping[str, str], own_tables: Collection[str], names: Collection[str], source: str
) -> None:
    """Refuse ties that are not arithmetic on parameters which are neither tied nor unknown."""
    for name, expression in ties.items():
        key = f"ties.{name}"
        if name not in names:
            known = f"its parameters: {', '.join(names)}"
            raise InputError(source, key, expression, "is not a parameter of the law", known)
        if name in own_tables:
            rule = f"conflicts with [parameters.{name}]"
            remedy = "keep one: a tied parameter has no bounds of its own"
            raise InputError(source, key, expression, rule, remedy)
        if not _is_arithmetic(expression):
            remedy = 'e.g. b = "a/10"'
            raise InputError(source, key, expression, f"may hold only {_ARITHMETIC}", remedy)
        others = [other for other in names if other not in ties]
        for other in sorted(names_in(expression) - set(others)):
            rule = f"names {other}, which is {'tied itself' if other in ties else 'no parameter'}"
            raise InputError(source, key, expression, rule, f"use {', '.join(others)}")


def _is_arithmetic(expression: str) -> bool:
    """Return whether an expression can be parsed and holds nothing but arithmetic."""
    if len(expression) > _LONGEST:
        return False
    try:
        with warnings.catch_warnings(action="error"):  # the parser warns of "1or"
            nodes = list(ast.walk(_parsed(expression)))
    except (SyntaxError, ValueError):
        return False
    for node in nodes:
        if isinstance(node, ast.Constant):
            number = node.value
            if not isinstance(number, int | float) or isinstance(number, bool):
                return False
            if not math.isfinite(number):
                return False
    return all(isinstance(node, _ALLOWED) for node in nodes)


@lru_cache(maxsize=256)
def _parsed(expression: str) -> ast.expr:
    return ast.parse(expression.strip(), mode="eval").body


def _value(node: ast.expr, values: Mapping[str, ArrayLike]) -> FloatArray:
    match node:
        case ast.Constant(value=int() | float() as number):
            return as_floats(number)
        case ast.Name(id=name):
            return as_floats(values[name])
        case ast.UnaryOp(op=sign, operand=operand):
            return as_floats(_UNARY[type(sign)](_value(operand, values)))
        case ast.BinOp(left=left, op=sign, right=right):
            return as_floats(_BINARY[type(sign)](_value(left, values), _value(right, values)))
        case _:
            raise TypeError(f"{ast.dump(node)} is not arithmetic")
