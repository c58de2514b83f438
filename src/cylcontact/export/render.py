"""Expressions of the neutral notation in the syntax of a language."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from cylcontact.export.formula import expression

__all__ = ["Dialect"]

# Operator precedence, the same in all targets.
_OR, _AND, _COMPARISON, _SUM, _PRODUCT, _POWER, _ATOM = range(7)


@dataclass(frozen=True)
class Dialect:
    """The syntax of a language, where it differs.

    Attributes
    ----------
    number : callable
        Returns the literal of a number in double precision.
    power : str
        Format string of x to the power of y.
    names : mapping
        Names and functions with another spelling, such as pi and nan.
    symbols : mapping
        Operators with another spelling, by Python's node type.
    """

    number: Callable[[float], str]
    power: str
    names: Mapping[str, str]
    symbols: Mapping[type[ast.AST], str] = field(default_factory=dict)

    def render(self, node: ast.expr) -> str:
        """Return an expression in this language."""
        return _Renderer(self).text(node)[0]

    def conditions(self, texts: tuple[str, ...]) -> list[str]:
        """Return conditions in this language, to be joined by its `and`."""
        return [self.render(expression(text)) for text in texts]


_PLAIN: Mapping[type[ast.AST], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Lt: "<",
    ast.LtE: "<=",
}


class _Renderer:
    """Renders a node to its text and its precedence."""

    def __init__(self, dialect: Dialect) -> None:
        self.dialect = dialect

    def text(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of any node of the notation."""
        match node:
            case ast.Constant(value=int() | float() as value):
                return self.dialect.number(float(value)), _ATOM
            case ast.Name(id=name):
                return self.dialect.names.get(name, name), _ATOM
            case ast.Call(func=ast.Name(id=name), args=args):
                inside = ", ".join(self.text(arg)[0] for arg in args)
                return f"{self.dialect.names.get(name, name)}({inside})", _ATOM
        return self.operation(node)

    def operation(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of a node that is an operation."""
        match node:
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                # In parentheses, because Fortran does not allow two operators in a row.
                return f"(-{self.above(operand, _PRODUCT)})", _ATOM
            case ast.BinOp(op=ast.Pow(), left=left, right=right):
                return self.power(left, right)
            case ast.BinOp(op=op, left=left, right=right):
                level = _SUM if isinstance(op, ast.Add | ast.Sub) else _PRODUCT
                text = f"{self.above(left, level - 1)} {self.symbol(op)} {self.above(right, level)}"
                return text, level
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                return f"{self.text(left)[0]} {self.symbol(op)} {self.text(right)[0]}", _COMPARISON
            case ast.BoolOp(op=op, values=values):
                level = _AND if isinstance(op, ast.And) else _OR
                return f" {self.symbol(op)} ".join(self.above(v, level) for v in values), level
        raise NotImplementedError(ast.unparse(node))

    def above(self, node: ast.expr, level: int) -> str:
        """Return a node's text, in parentheses unless it binds more tightly than `level`."""
        text, binding = self.text(node)
        return text if binding > level else f"({text})"

    def power(self, left: ast.expr, right: ast.expr) -> tuple[str, int]:
        """Return x to the power of y, with operands in parentheses unless they are atoms."""
        x, y = self.above(left, _POWER), self.above(right, _POWER)
        return self.dialect.power.format(x=x, y=y), _POWER

    def symbol(self, operator: ast.AST) -> str:
        """Return an operator in this language."""
        kind = type(operator)
        return self.dialect.symbols.get(kind) or _PLAIN[kind]
