"""Ties: expressions such as "a/10" that set a parameter from others.

They hold numbers, names of parameters, parentheses, + - * / ** and log(), the natural logarithm.
An expression is parsed, not executed, and anything else is refused.
"""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable, Collection, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError

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
_ALLOWED = (ast.Constant, ast.Call, ast.Name, ast.Load, ast.UnaryOp, ast.BinOp, *_UNARY, *_BINARY)
# Python's parser recurses, so a longer expression could exhaust its stack.
_LONGEST = 200


def evaluate(expression: str, values: Mapping[str, ArrayLike]) -> FloatArray:
    """Return the value of a valid expression; inf or NaN where the arithmetic has none.

    >>> float(evaluate("1 + Y_log_scale/10", {"Y_log_scale": 1.51}))
    1.151
    """
    with np.errstate(all="ignore"):
        return _value(_parsed(expression), values)


def require_valid(ties: Mapping[str, str], names: Collection[str], source: str) -> None:
    """Refuse ties that are not arithmetic on parameters which are neither tied nor unknown."""
    others = [name for name in names if name not in ties]
    for name, expression in ties.items():
        key = f"ties.{name}"
        if name not in names:
            known = f"its parameters: {', '.join(names)}"
            raise InputError(source, key, expression, "is not a parameter of the law", known)
        if not _is_arithmetic(expression):
            rule = "may hold only numbers, names of parameters, parentheses, log() and + - * / **"
            raise InputError(source, key, expression, rule, 'e.g. b = "a/10"')
        nodes = list(ast.walk(_parsed(expression)))
        called = [node.func for node in nodes if isinstance(node, ast.Call)]
        used = {node.id for node in nodes if isinstance(node, ast.Name) and node not in called}
        for other in sorted(used - set(others)):
            rule = f"names {other}, which is {'tied itself' if other in ties else 'no parameter'}"
            raise InputError(source, key, expression, rule, f"use {', '.join(others)}")


def _is_arithmetic(expression: str) -> bool:
    """Return whether an expression can be parsed and holds only arithmetic."""
    if len(expression) > _LONGEST:
        return False
    try:
        with warnings.catch_warnings(action="error"):  # the parser warns of "1or"
            nodes = list(ast.walk(_parsed(expression)))
    except (SyntaxError, ValueError):
        return False
    numbers: list[Any] = [node.value for node in nodes if isinstance(node, ast.Constant)]
    return (
        all(isinstance(node, _ALLOWED) for node in nodes)
        and all(type(number) in (int, float) and math.isfinite(number) for number in numbers)
        and all(_is_log(node) for node in nodes if isinstance(node, ast.Call))
    )


def _is_log(node: ast.Call) -> bool:
    """Return whether a call is log of one argument."""
    is_named = isinstance(node.func, ast.Name) and node.func.id == "log"
    return is_named and len(node.args) == 1 and not node.keywords


@lru_cache(maxsize=256)
def _parsed(expression: str) -> ast.expr:
    return ast.parse(expression.strip(), mode="eval").body


def _value(node: ast.expr, values: Mapping[str, ArrayLike]) -> FloatArray:
    match node:
        case ast.Constant(value=int() | float() as number):
            return as_floats(number)
        case ast.Name(id=name):
            return as_floats(values[name])
        case ast.Call(args=[argument]):
            return as_floats(np.log(_value(argument, values)))
        case ast.UnaryOp(op=sign, operand=operand):
            return as_floats(_UNARY[type(sign)](_value(operand, values)))
        case ast.BinOp(left=left, op=sign, right=right):
            return as_floats(_BINARY[type(sign)](_value(left, values), _value(right, values)))
        case _:
            raise TypeError(f"{ast.dump(node)} is not arithmetic")
