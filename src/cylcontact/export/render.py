"""Steps in the notation of a language, in the frame of its file."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from string import Template
from textwrap import indent, wrap

import numpy as np

from cylcontact.laws.formula import Formula, Step, names_in, needed
from cylcontact.laws.lambert import branch_distance_steps

WIDTH = 90
_TEMPLATES = Path(__file__).parent / "templates"
# Operator precedence, the same in all languages.
_CHOICE, _OR, _AND, _COMPARISON, _SUM, _PRODUCT, _POWER, _ATOM = range(8)
_SYMBOLS: Mapping[type[ast.AST], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Gt: ">", ast.GtE: ">=",
    ast.Lt: "<", ast.LtE: "<=", ast.And: "and", ast.Or: "or",
}  # fmt: skip


@dataclass(frozen=True)
class Dialect:
    """The notation of a language, mostly as format strings."""

    comment: str
    number: Callable[[float], str]
    power: str  # of x to the power of y
    assignment: str
    choice: str  # the expression yes or no by a test
    # From first to last, below or above stop, by step, with a body; before is < or >.
    loop: str
    branch: str = ""  # a choice as a statement, where only one side may be evaluated
    constant: str = ""  # as assignment; variable and again are the first and the next values
    variable: str = ""
    again: str = ""
    counter: str = "{name}"  # what a loop counts, in an expression
    continued: str = ""  # the end of a line that goes on
    names: Mapping[str, str] = field(default_factory=dict)
    symbols: Mapping[type[ast.AST], str] = field(default_factory=dict)  # by Python's node type
    helpers: Mapping[str, str] = field(default_factory=dict)  # functions that it lacks, by name
    lambert: str = ""  # the frame of the function of Lambert's w, with $steps and $w

    def statements(self, steps: Sequence[Step], others: Sequence[Step] = ()) -> str:
        """Return steps in this language, one a line; `others` follow somewhere later."""
        variables = _variables((*steps, *others)) if self.variable else set()
        lines, declared = [], set[str]()
        for step in steps:
            inside = {name for name, _, assigned in _places(step.body) if assigned}
            for name in sorted(inside & variables - declared):
                lines.append(self.variable.format(name=name, value=self.number(0.0)))
            lines.append(self._statement(step, variables, declared))
            declared |= inside | {step.name}
        return "\n".join(self.wrapped(line) for text in lines for line in text.splitlines())

    def constants(self, numbers: Mapping[str, float]) -> str:
        """Return constants in this language, one a line."""
        form = self.constant or self.assignment
        return "\n".join(
            form.format(name=self.names.get(name, name), value=self.number(value))
            for name, value in numbers.items()
        )

    def helpers_of(self, text: str) -> str:
        """Return the definitions of the functions that a rendered text calls."""
        parts = []
        if re.search(r"\bbranch_distance\(", text):
            own = replace(self, names={**self.names, "penetration": "p"})
            *steps, last = lambert_steps()
            own_parts = {
                "steps": own.statements(steps),
                "names": ", ".join(step.name for step in steps),
                "w": own.render(last.value),
            }
            parts.append(filled(self.lambert, own_parts))
            text += parts[0]
        parts += (code for name, code in self.helpers.items() if re.search(rf"\b{name}\(", text))
        return "\n".join(parts)

    def render(self, node: ast.expr) -> str:
        """Return an expression in this language."""
        return self._text(node)[0]

    def _statement(self, step: Step, variables: set[str], declared: set[str]) -> str:
        """Return a step in this language."""
        name = self.names.get(step.name, step.name)
        if step.body:
            return self._loop(step, variables)
        form = self.assignment
        if step.name in variables:
            form = self.again if step.name in declared else self.variable
        if isinstance(step.value, ast.IfExp) and self.branch:
            parts = (step.value.test, step.value.body, step.value.orelse)
            test, yes, no = map(self.render, parts)
            return self.branch.format(name=name, test=test, yes=yes, no=no)
        return form.format(name=name, value=self.render(step.value))

    def _loop(self, step: Step, variables: set[str]) -> str:
        """Return a loop in this language."""
        limits = range(*(ast.literal_eval(ast.unparse(each)) for each in step.value.args))  # type: ignore[attr-defined]
        inner = replace(self, names={**self.names, step.name: self.counter.format(name=step.name)})
        body = (inner._statement(each, variables, variables) for each in step.body)
        return self.loop.format(
            name=step.name, first=limits.start, stop=limits.stop, step=limits.step,
            last=limits.stop - (1 if limits.step > 0 else -1),
            before="<" if limits.step > 0 else ">", body=indent("\n".join(body), "    "),
        )  # fmt: skip

    def wrapped(self, line: str) -> str:
        """Return a line, cut between words if it is long."""
        deeper = " " * (len(line) - len(line.lstrip()) + 4)
        parts = wrap(
            line, WIDTH, subsequent_indent=deeper, break_long_words=False, break_on_hyphens=False
        )
        return f"{self.continued}\n".join(parts)

    def _text(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of a node, and its precedence."""
        match node:
            case ast.Constant(value=int() | float() as value) if value < 0:
                return f"-{self.number(-float(value))}", _SUM
            case ast.Constant(value=int() | float() as value):
                return self.number(float(value)), _ATOM
            case ast.Name(id=name):
                return self.names.get(name, name), _ATOM
            case ast.Call(func=ast.Name(id=name), args=args):
                inside = ", ".join(map(self.render, args))
                return f"{self.names.get(name, name)}({inside})", _ATOM
            case ast.IfExp(test=test, body=yes, orelse=no):
                a, b, c = (self._above(part, _CHOICE) for part in (test, yes, no))
                text = self.choice.format(test=a, yes=b, no=c)
                return text, _ATOM if self.choice.endswith(")") else _CHOICE
        return self._operation(node)

    def _operation(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of an operation, and its precedence."""
        match node:
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                # As a sum, because Fortran does not allow two operators in a row.
                return f"-{self._above(operand, _SUM)}", _SUM
            case ast.BinOp(op=ast.Pow(), left=left, right=right):
                x, y = self._above(left, _POWER), self._above(right, _POWER)
                return self.power.format(x=x, y=y), _POWER
            case ast.BinOp(op=op, left=left, right=right):
                level = _SUM if isinstance(op, ast.Add | ast.Sub) else _PRODUCT
                x, y = self._above(left, level - 1), self._above(right, level)
                if level == _PRODUCT and self.render(left).startswith("-"):
                    x, level = self.render(left), _SUM
                return f"{x} {self._symbol(op)} {y}", level
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                x, y = self._above(left, _COMPARISON), self._above(right, _COMPARISON)
                return f"{x} {self._symbol(op)} {y}", _COMPARISON
            case ast.BoolOp(op=op, values=values):
                level, symbol = _AND if isinstance(op, ast.And) else _OR, self._symbol(op)
                # & and | of arrays bind more tightly than comparisons.
                least = _COMPARISON if symbol in "&|" else level
                return f" {symbol} ".join(self._above(v, least) for v in values), level
        raise NotImplementedError(ast.unparse(node))

    def _above(self, node: ast.expr, level: int) -> str:
        """Return a node's text, in parentheses unless it binds more tightly than `level`."""
        text, binding = self._text(node)
        return text if binding > level else f"({text})"

    def _symbol(self, operator: ast.AST) -> str:
        return self.symbols.get(type(operator)) or _SYMBOLS[type(operator)]


def _variables(steps: Iterable[Step]) -> set[str]:
    """Return the names that change, or that are used outside the loop which assigns them."""
    places = list(_places(steps))
    homes: dict[str, list[tuple[int, ...]]] = {}
    for name, path, assigned in places:
        if assigned:
            homes.setdefault(name, []).append(path)
    changing = {name for name, paths in homes.items() if len(paths) > 1}
    return changing | {
        name for name, path, _ in places
        if name in homes and path[: len(homes[name][0])] != homes[name][0]
    }  # fmt: skip


def _places(
    steps: Iterable[Step], path: tuple[int, ...] = ()
) -> Iterator[tuple[str, tuple[int, ...], bool]]:
    """Yield each name, the loops that it is in, and whether it is assigned there."""
    for number, step in enumerate(steps):
        if step.body:
            yield from _places(step.body, (*path, number))
        else:
            yield from ((name, path, False) for name in names_in(step.value))
            yield step.name, path, True


def _w(penetration, _pair):  # type: ignore[no-untyped-def]  # read as a law's formula is
    """Return Lambert's w as a formula of one argument, for its steps."""
    w = branch_distance_steps(penetration)  # type: ignore[no-untyped-call]
    return np.where(penetration > 0, w, np.inf)


@cache
def lambert_steps() -> tuple[Step, ...]:
    """Return the steps from p, here called penetration, to w, here called f."""
    return needed(Formula(_w).steps, "f")


def filled(frame: str, parts: Mapping[str, str]) -> str:
    """Return a frame with its placeholders replaced.

    A placeholder alone on its line may stand for several lines, indented as it is, or for none.
    Lines between "$if name" and "$end" are there only if the part is not empty.
    """
    lines, used = [], True
    for line in frame.splitlines(keepends=True):
        word, _, name = line.strip().partition(" ")
        if word in ("$if", "$end"):
            used = word == "$end" or bool(parts[name])
        elif used:
            lines.append(_filled_line(line, parts))
    return "".join(lines)


def filled_template(name: str, parts: Mapping[str, str]) -> str:
    """Return a file of the folder `templates`, filled."""
    return filled((_TEMPLATES / name).read_text(encoding="ascii"), parts)


def _filled_line(line: str, parts: Mapping[str, str]) -> str:
    """Return a line of a frame with its placeholders replaced."""
    alone = re.fullmatch(r"( *)\$(\w+)\n", line)
    if alone is None:
        return Template(line).substitute(parts)
    text = parts[alone[2]]
    return indent(f"{text}\n", alone[1]) if text else ""
