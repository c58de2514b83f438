"""Formulas in the notation of a language, in the frame of its file."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from string import Template
from textwrap import indent

from cylcontact.export.comments import comment_lines
from cylcontact.laws.formula import Formula, Step, expression

__all__ = ["Dialect", "filled"]

# Operator precedence, the same in all targets.
_OR, _AND, _COMPARISON, _SUM, _PRODUCT, _POWER, _ATOM = range(7)

_SYMBOLS: Mapping[type[ast.AST], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.And: "and",
    ast.Or: "or",
}


@dataclass(frozen=True)
class Dialect:
    """The notation of a language.

    Attributes
    ----------
    comment : str
        The mark of a comment.
    number : callable
        Returns the literal of a number in double precision.
    power : str
        Format string of `x` to the power of `y`.
    assignment : str
        Format string of a statement that gives `name` a `value`.
    choice : str
        Format string of a statement that gives `name` the value `yes` or `no` by a `test`. Only
        one side may be evaluated.
    joint : str
        The text between the conditions of the domain.
    constant : str
        Format string of a constant, if it differs from an assignment.
    names : mapping
        Names and functions with another spelling, such as pi and nan.
    symbols : mapping
        Operators with another spelling, by Python's node type.
    helpers : mapping
        Definitions of functions that the language lacks, by name.
    """

    comment: str
    number: Callable[[float], str]
    power: str
    assignment: str
    choice: str
    joint: str
    constant: str = ""
    names: Mapping[str, str] = field(default_factory=dict)
    symbols: Mapping[type[ast.AST], str] = field(default_factory=dict)
    helpers: Mapping[str, str] = field(default_factory=dict)

    def source(self, formula: Formula, frame: str, **own: str) -> str:
        """Return a formula as the text of a file.

        Parameters
        ----------
        formula : Formula
            The formula.
        frame : str
            The text with $comment, $name, $arguments, $domain, $constants, $steps and, if the
            language has any, $helpers. A placeholder alone on its line may stand for several
            lines, indented as it is, or for none.
        **own : str
            Further parts of the frame.
        """
        steps = self.statements(formula.steps)
        parts = {
            "comment": comment_lines(formula, self.comment),
            "name": formula.name,
            "arguments": ", ".join(formula.arguments),
            "domain": self.joint.join(
                self.render(expression(text)) for text in formula.requirements
            ),
            "constants": self.constants(formula.constants),
            "steps": steps,
            "helpers": self.helpers_of(steps),
        }
        return filled(frame, parts | own)

    def statements(self, steps: Iterable[Step]) -> str:
        """Return steps in this language, one a line."""
        return "\n".join(map(self._statement, steps))

    def constants(self, numbers: Mapping[str, float]) -> str:
        """Return constants in this language, one a line."""
        form = self.constant or self.assignment
        return "\n".join(form.format(name=name, value=value) for name, value in numbers.items())

    def helpers_of(self, steps: str) -> str:
        """Return the definitions of the functions that rendered steps call."""
        return "".join(text for name, text in self.helpers.items() if f"{name}(" in steps)

    def render(self, node: ast.expr) -> str:
        """Return an expression in this language."""
        return self._text(node)[0]

    def _statement(self, step: Step) -> str:
        """Return a step in this language."""
        name = self.names.get(step.name, step.name)
        if not isinstance(step.value, ast.IfExp):
            return self.assignment.format(name=name, value=self.render(step.value))
        test, yes, no = map(self.render, (step.value.test, step.value.body, step.value.orelse))
        return self.choice.format(name=name, test=test, yes=yes, no=no)

    def _text(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of any node of the notation, and its precedence."""
        match node:
            case ast.Constant(value=int() | float() as value):
                return self.number(float(value)), _ATOM
            case ast.Name(id=name):
                return self.names.get(name, name), _ATOM
            case ast.Call(func=ast.Name(id=name), args=args):
                inside = ", ".join(map(self.render, args))
                return f"{self.names.get(name, name)}({inside})", _ATOM
        return self._operation(node)

    def _operation(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of an operation, and its precedence."""
        match node:
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                # In parentheses, because Fortran does not allow two operators in a row.
                return f"(-{self._above(operand, _PRODUCT)})", _ATOM
            case ast.BinOp(op=ast.Pow(), left=left, right=right):
                x, y = self._above(left, _POWER), self._above(right, _POWER)
                return self.power.format(x=x, y=y), _POWER
            case ast.BinOp(op=op, left=left, right=right):
                level = _SUM if isinstance(op, ast.Add | ast.Sub) else _PRODUCT
                x, y = self._above(left, level - 1), self._above(right, level)
                return f"{x} {self._symbol(op)} {y}", level
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                x, y = self.render(left), self.render(right)
                return f"{x} {self._symbol(op)} {y}", _COMPARISON
            case ast.BoolOp(op=op, values=values):
                level = _AND if isinstance(op, ast.And) else _OR
                return f" {self._symbol(op)} ".join(self._above(v, level) for v in values), level
        raise NotImplementedError(ast.unparse(node))

    def _above(self, node: ast.expr, level: int) -> str:
        """Return a node's text, in parentheses unless it binds more tightly than `level`."""
        text, binding = self._text(node)
        return text if binding > level else f"({text})"

    def _symbol(self, operator: ast.AST) -> str:
        """Return an operator in this language."""
        kind = type(operator)
        return self.symbols.get(kind) or _SYMBOLS[kind]


def filled(frame: str, parts: Mapping[str, str]) -> str:
    """Return a frame with its placeholders replaced.

    A placeholder alone on its line may stand for several lines, indented as it is, or for none.
    """
    return "".join(_filled_line(line, parts) for line in frame.splitlines(keepends=True))


def _filled_line(line: str, parts: Mapping[str, str]) -> str:
    """Return a line of a frame with its placeholders replaced."""
    alone = re.fullmatch(r"( *)\$(\w+)\n", line)
    if alone is None:
        return Template(line).substitute(parts)
    text = parts[alone[2]]
    return indent(f"{text}\n", alone[1]) if text else ""
