"""Ties: parameters computed from others by arithmetic, e.g. b = "a/10" in a campaign's [ties].

An expression holds numbers, names of parameters, parentheses and + - * / **. It is parsed, not
executed, and anything else than arithmetic is refused.
"""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable, Collection, Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError

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
    """Refuse ties that cannot be computed from parameters of the law that are not tied themselves.

    `own_tables` are the parameters that have a table of their own in the campaign.
    """
    for name, expression in ties.items():
        key = f"ties.{name}"
        if name not in names:
            known = f"its parameters: {', '.join(names)}"
            raise InputError(source, key, expression, "is not a parameter of the law", known)
        if name in own_tables:
            raise InputError(
                source,
                key,
                expression,
                f"conflicts with [parameters.{name}]",
                "keep one: a tied parameter has no bounds of its own",
            )
        if not _is_arithmetic(expression):
            remedy = 'e.g. b = "a/10"'
            raise InputError(source, key, expression, f"may hold only {_ARITHMETIC}", remedy)
        others = [other for other in names if other not in ties]
        for other in sorted(names_in(expression) - set(others)):
            raise InputError(
                source,
                key,
                expression,
                f"names {other}, which is " + ("tied itself" if other in ties else "no parameter"),
                f"use {', '.join(others)}",
            )


def _is_arithmetic(expression: str) -> bool:
    """Return whether an expression can be parsed and holds nothing but arithmetic."""
    if len(expression) > _LONGEST:
        return False
    try:
        with warnings.catch_warnings(action="error"):  # the parser warns of "1or"
            tree = _parsed(expression)
    except (SyntaxError, ValueError):
        return False
    return _is_allowed(tree)


def _is_allowed(node: ast.expr) -> bool:
    """Return whether a node and all below it are arithmetic."""
    match node:
        case ast.Constant(value=bool()):
            return False
        case ast.Constant(value=int() | float() as number):
            return math.isfinite(number)
        case ast.Name():
            return True
        case ast.UnaryOp(op=sign, operand=operand):
            return type(sign) in _UNARY and _is_allowed(operand)
        case ast.BinOp(left=left, op=sign, right=right):
            return type(sign) in _BINARY and _is_allowed(left) and _is_allowed(right)
        case _:
            return False


@lru_cache(maxsize=256)
def _parsed(expression: str) -> ast.expr:
    """Return the tree of an expression."""
    return ast.parse(expression.strip(), mode="eval").body


def _value(node: ast.expr, values: Mapping[str, ArrayLike]) -> FloatArray:
    """Return the value of a tree of arithmetic."""
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
