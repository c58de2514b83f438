"""Reads plain functions of the package from their source, to be written in other languages.

A plain function keeps to these rules; anything else is refused with its expression and line.

- Statements: assignments (also `a, b = x, y`, one after the other), `if`, `while`, `for` over a
  `range` with a literal step, `break`, `return`, and calls of functions that change a record.
- A call's result is not unpacked: assign a `NamedTuple` and use its fields.
- Numbers, vectors, `NamedTuple`s and records (`np.dtype`) are the only values. What has no
  annotation is a float. A function returns one number or one `NamedTuple`, or changes records.
- Functions: other plain functions, and those in `KNOWN`, called without keywords.
- Comparisons are not chained. `//` and `%` are for whole numbers that are not negative.
- `max(x, 0.0)` and `np.maximum(x, 0.0)` keep a NaN only if it is the first argument, as Python's
  `max` does: put the number that may be NaN first.
- Names differ by more than case, because Fortran ignores case. A variable that a loop carries from
  turn to turn gets a value before the loop.
- A constant of a module has the same value wherever its name is used.
- `joint` and `law` are not passed on: they are constants of the file that is written.
"""

from __future__ import annotations

import ast
import builtins
import inspect
import io
import math
import textwrap
import tokenize
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from types import FunctionType
from typing import Any, NamedTuple, NoReturn

import numpy as np

from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import RESERVED

Node = Any  # of a syntax tree, with what `_Reader` adds to it


@dataclass(frozen=True)
class Vector:
    """The type of an array of numbers; its size is 0 where it does not matter."""

    size: int


class Constant(NamedTuple):
    """A constant of a file: its type, its value, and a remark for the reader."""

    kind: Any
    value: Any
    about: str = ""


@dataclass
class Function:
    """A plain function; a type is float, int, bool, a `Vector`, a `NamedTuple` or a `np.dtype`."""

    name: str
    arguments: dict[str, Any]
    returns: Any = float
    body: list[Any] = field(default_factory=list)
    about: str = ""
    locals: dict[str, Any] = field(default_factory=dict)
    changes: list[str] = field(default_factory=list)  # the records that it changes
    unused: set[str] = field(default_factory=set)  # records of the program that it does not use


# Functions that every language has or that `notation` adds, by their names in C.
KNOWN: dict[Any, str] = {
    getattr(module, name): name
    for module in (math, np)
    for name in ("log", "log1p", "exp", "sqrt", "sin", "cos", "tan", "hypot")
}
KNOWN |= {math.copysign: "copysign", np.copysign: "copysign"}
KNOWN |= {math.acos: "acos", np.arccos: "acos", math.asin: "asin", np.arcsin: "asin"}
KNOWN |= {math.atan: "atan", np.arctan: "atan"}
KNOWN |= {np.maximum: "larger", max: "larger", np.minimum: "smaller", min: "smaller"}
KNOWN |= {abs: "abs", np.abs: "abs", math.fabs: "abs", int: "int"}
_CHOICES = (np.where,)  # and any function named `choose`

_STATEMENTS = (
    ast.Assign, ast.AugAssign, ast.Expr, ast.Return, ast.Break, ast.If, ast.For, ast.While,
)  # fmt: skip
_EXPRESSIONS = (
    ast.Constant, ast.Name, ast.Attribute, ast.Subscript, ast.Call, ast.IfExp, ast.Compare,
    ast.BoolOp, ast.BinOp, ast.UnaryOp,
)  # fmt: skip
_OPERATORS = (
    ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Mod, ast.FloorDiv, ast.Pow, ast.BitAnd, ast.BitOr,
    ast.Gt, ast.GtE, ast.Lt, ast.LtE, ast.Eq, ast.NotEq, ast.And, ast.Or, ast.Not, ast.USub,
)  # fmt: skip
_SYNTAX = (*_STATEMENTS, *_EXPRESSIONS, *_OPERATORS, ast.Load, ast.Store)


@dataclass
class Program:
    """Functions in the order in which they call each other, with their types and constants.

    `constants` are the fields of `joint` and `law`, `records` the types of those of the two that
    are passed all the same; `instead` replaces functions by others.
    """

    constants: Mapping[str, Mapping[str, Constant]]
    instead: dict[Any, Any] = field(default_factory=dict)
    functions: dict[Any, Function] = field(default_factory=dict)
    types: list[Any] = field(default_factory=list)
    numbers: dict[str, Any] = field(default_factory=dict)
    used: set[tuple[str, str]] = field(default_factory=set)
    records: Mapping[str, Any] = field(default_factory=dict)

    def read(self, function: Any) -> Function:
        """Return a function of the package, after those that it calls."""
        function = getattr(function, "py_func", function)
        if function not in self.functions:
            other = self.instead.get(function)
            if isinstance(other, Function):
                self.functions[function] = other
            elif other is not None:
                self.functions[function] = self.read(other)
            else:
                hints = typing.get_type_hints(function, include_extras=True)
                lines, first = inspect.getsourcelines(function)
                text = textwrap.dedent("".join(lines))
                names = _names_in(function)
                read = self.read_text(text, names, hints, function.__code__.co_filename, first)
                if any(read.name.lower() == each.name.lower() for each in self.functions.values()):
                    rule, remedy = "has the name of another function", "rename one of them"
                    _Place(read.name, function.__module__).refuse(ast.Name(read.name), rule, remedy)
                self.functions[function] = read
        return self.functions[function]

    def read_text(
        self, text: str, names: Mapping[str, Any], hints: Mapping[str, Any] | None = None,
        file: str = "", first: int = 1,
    ) -> Function:  # fmt: skip
        """Return a function from its text, which begins at line `first` of a file."""
        tree = next(n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.FunctionDef))
        ast.increment_lineno(tree, first - 1)
        where = _Place(tree.name, file.replace("\\", "/").rpartition("/")[2])
        a = tree.args
        if a.vararg or a.kwarg or a.kwonlyargs or a.posonlyargs:
            where.refuse(tree, "takes other than plain arguments", "name each", f"def {tree.name}")
        hints = {**(hints or {}), **self.records}
        kinds = {arg.arg: kind_of(hints.get(arg.arg, float)) for arg in a.args}
        about = (ast.get_docstring(tree) or "").partition("\n\n")[0].replace("\n", " ")
        if about:
            del tree.body[0]
        read = Function(tree.name, kinds, kind_of(hints.get("return", float)), about=about)
        _add_remarks(tree, text, first)
        _Reader(self, read, names, where).read_body(tree.body)
        used = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
        read.unused = {name for name in kinds if name in self.records and name not in used}
        known = sorted({**read.arguments, **read.locals}, key=str.lower)
        for one, other in pairwise(known):
            if one.lower() == other.lower():
                rule = "differ by case alone, which Fortran ignores"
                where.refuse(tree, rule, "rename one", f"{one}, {other}")
        for name in (tree.name, *known):
            if not name.isascii() or name in RESERVED:
                where.refuse(tree, "is not a name in other languages", "rename it", name)
        if tree.name.lower() in map(str.lower, known):
            where.refuse(tree, "has a variable of its own name", "rename it", tree.name)
        self.see(*kinds.values(), read.returns)
        return read

    def see(self, *kinds: Any) -> None:
        """Add types to those of the file, after the types of their fields."""
        for kind in kinds:
            if kind not in self.types and (fields := fields_of(kind)):
                self.see(*fields.values())
                self.types.append(kind)

    def type_of(self, node: Node, local: Mapping[str, Any]) -> Any:  # noqa: PLR0911
        """Return the type of an expression."""
        match node:
            case ast.Constant(value=value):
                return type(value)
            case ast.Name(id=name):
                return local.get(name, type(self.numbers.get(name, 0.0)))
            case ast.Attribute(value=ast.Name(id=of), attr=name) if of in self.constants:
                return self.constants[of][name].kind
            case ast.Attribute(value=value, attr=name):
                return fields_of(self.type_of(value, local))[name]
            case ast.Call():
                return self._type_of_call(node, local)
            case ast.BinOp(left=x, op=op, right=y) if not isinstance(op, ast.Div):
                both = self.type_of(x, local), self.type_of(y, local)
                return int if both == (int, int) else float
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return self.type_of(operand, local)
            case ast.IfExp(body=yes, orelse=no):
                both = self.type_of(yes, local), self.type_of(no, local)
                return both[0] if both[0] == both[1] else float
            case ast.Compare() | ast.BoolOp() | ast.UnaryOp():
                return bool
        return float

    def _type_of_call(self, node: Node, local: Mapping[str, Any]) -> Any:
        called = getattr(node, "called", None)
        if isinstance(called, Function):
            return called.returns
        if called is not None or node.func.id == "int":
            return called or int
        is_whole = node.func.id == "abs" and self.type_of(node.args[0], local) is int
        return int if is_whole else float


def kind_of(hint: Any) -> Any:
    """Return the type that an annotation means."""
    if hasattr(hint, "__metadata__"):
        (what,) = hint.__metadata__
        return Vector(what) if isinstance(what, int) else what
    return None if hint is type(None) else hint


def fields_of(kind: Any) -> dict[str, Any]:
    """Return the types of the fields of a `NamedTuple` or a record; none of a number."""
    if isinstance(kind, np.dtype):
        shapes = {name: kind[name] for name in kind.names or ()}
        return {
            name: Vector(part.shape[0]) if part.shape else int if part.kind == "i" else float
            for name, part in shapes.items()
        }
    return typing.get_type_hints(kind) if hasattr(kind, "_fields") else {}


def _names_in(function: FunctionType) -> dict[str, Any]:
    """Return what the names in a function mean outside it."""
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    inner = {name: cell.cell_contents for name, cell in cells}
    return {**vars(builtins), **function.__globals__, **inner}


def _add_remarks(tree: ast.FunctionDef, text: str, first: int) -> None:
    """Give each statement the comments before it and on its line."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    left = [
        (t.start[0] + first - 1, t.string.lstrip("# ")) for t in tokens
        if t.type == tokenize.COMMENT and not t.string.startswith(("# fmt:", "# noqa"))
    ]  # fmt: skip
    lines = text.splitlines()
    statements: list[Any] = [n for n in ast.walk(tree) if isinstance(n, ast.stmt) and n is not tree]
    for node in sorted(statements, key=lambda n: n.lineno):
        has_body = isinstance(node, ast.If | ast.For | ast.While)
        last = node.lineno if has_body else node.end_lineno
        node.remarks = [words for line, words in left if line <= last]
        before = node.lineno - sum(line < node.lineno for line, _ in left if line <= last)
        node.gap = not lines[before - first - 1].strip()
        left = [each for each in left if each[0] > last]


class _Place(NamedTuple):
    """The function and the file that are read, for errors."""

    function: str
    file: str

    def refuse(self, node: ast.AST, rule: str, remedy: str, text: str = "") -> NoReturn:
        """Raise `InputError` with an expression and its line."""
        line = getattr(node, "lineno", None)
        source = ", ".join(filter(None, (self.file, f"line {line}" if line else "")))
        words = (text or ast.unparse(node)).partition("\n")[0]
        where = f"{source}: `{words}`" if source else f"`{words}`"
        rule = f"cannot be written in another language: it {rule}"
        raise InputError(f"{self.function}, {where}", "", None, rule, remedy)


class _Reader(ast.NodeTransformer):
    """Resolves the names in a function's body."""

    def __init__(
        self, program: Program, function: Function, names: Mapping[str, Any], where: _Place
    ) -> None:
        self.program, self.function, self.names, self.where = program, function, names, where

    def read_body(self, body: list[ast.stmt]) -> None:
        """Read statements and the types of variables."""
        stored = [n for each in body for n in ast.walk(each) if isinstance(n, ast.Name)]
        variables = {n.id for n in stored if isinstance(n.ctx, ast.Store)}
        self.variables = {*self.function.arguments, *variables}
        self.function.body = self._block(body)
        for each in self.function.body:
            self._learn(each)
        typed = _Types(self.program, self.function, self.where)
        self.function.body = [typed.visit(each) for each in self.function.body]

    def visit(self, node: ast.AST) -> Any:
        """Read one node; refuse what the rules do not have."""
        if not isinstance(node, _SYNTAX):
            self.where.refuse(node, "is not in the rules of plain functions", "write it otherwise")
        return super().visit(node)

    def _block(self, body: list[ast.stmt]) -> list[Any]:
        done = [self.visit(each) for each in body if not isinstance(each, ast.Pass)]
        return [one for each in done for one in (each if isinstance(each, list) else [each])]

    def _learn(self, tree: ast.stmt) -> None:
        """Learn the types of variables, and which arguments are changed."""
        f, known = self.function, {**self.function.arguments, **self.function.locals}
        for node in _in_order(tree):
            match node:
                case ast.Assign(targets=[ast.Name(id=name)], value=value):
                    kind = self.program.type_of(value, known)
                    before = f.locals.get(name, kind)
                    f.locals[name] = known[name] = kind if kind == before else float
                case ast.AugAssign(target=ast.Name(id=name)) if name not in f.locals:
                    f.locals[name] = known[name]
                case ast.For(target=ast.Name(id=name)):
                    f.locals[name] = known[name] = int
                case ast.Attribute(ctx=ast.Store()) | ast.Subscript(ctx=ast.Store()):
                    self._note_change(node)
                case ast.Call() if isinstance(called := getattr(node, "called", None), Function):
                    if len(called.arguments) != len(node.args):
                        names = ", ".join(called.arguments)
                        self.where.refuse(node, "lacks arguments", f"give all of {names}")
                    for name, value in zip(called.arguments, node.args, strict=True):
                        if name in called.changes:
                            self._note_change(value)

    def _note_change(self, node: Node) -> None:
        while isinstance(node, ast.Attribute | ast.Subscript):
            node = node.value
        if node.id in self.function.arguments and node.id not in self.function.changes:
            self.function.changes.append(node.id)

    def visit_Assign(self, node: Node) -> Any:
        remarks, gap = node.remarks, node.gap
        match node:
            case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Tuple(elts=values)):
                parts: list[Node] = []
                written: set[str] = set()
                for name, value in zip(names, values, strict=True):
                    if written & {n.id for n in ast.walk(value) if isinstance(n, ast.Name)}:
                        remedy = "write one assignment after the other"
                        self.where.refuse(node, "uses a variable that it changes", remedy)
                    written |= {n.id for n in ast.walk(name) if isinstance(n, ast.Name)}
                    parts.append(ast.copy_location(ast.Assign([name], value), node))
                    parts[-1].remarks, parts[-1].gap = [], False
                parts[0].remarks, parts[0].gap = remarks, gap
                return [self.visit(part) for part in parts]
            case ast.Assign(targets=[ast.Tuple()]):
                remedy = "assign a NamedTuple, and use its fields"
                self.where.refuse(node, "unpacks the result of a call", remedy)
            case ast.Assign(targets=[_, _, *_]):
                self.where.refuse(node, "has two targets", "write two assignments")
        return self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> Any:
        if not isinstance(node.value, ast.Call):
            self.where.refuse(node, "does nothing", "remove it")
        return self.generic_visit(node)

    def visit_If(self, node: Node) -> Any:
        node.test = self.visit(node.test)
        node.body, node.orelse = self._block(node.body), self._block(node.orelse)
        return node

    def visit_While(self, node: Node) -> Any:
        if node.orelse:
            self.where.refuse(node, "is a loop with an else", "use a variable")
        return self.visit_If(node)

    def visit_For(self, node: Node) -> Any:
        call, is_named = node.iter, isinstance(node.target, ast.Name)
        is_range = isinstance(call, ast.Call) and ast.unparse(call.func) == "range"
        if not (is_named and is_range) or node.orelse:
            self.where.refuse(node, "is a loop over something else", "loop over a range")
        args = call.args
        if len(args) == 3:
            try:
                ast.literal_eval(args[2])
            except ValueError:
                self.where.refuse(node, "has a step that is not a literal", "write a number")
        node.target.id = node.target.id.lstrip("_")
        node.limits = [self.visit(each) for each in [ast.Constant(0)] * (len(args) == 1) + args]
        node.iter = ast.Constant(0)
        node.body = self._block(node.body)
        return node

    def visit_Compare(self, node: ast.Compare) -> Any:
        if len(node.ops) > 1:
            self.where.refuse(node, "chains comparisons", "join two with `and`")
        return self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> Any:
        if not isinstance(node.value, bool | int | float):
            self.where.refuse(node, "is not a number", "use numbers")
        return node

    def visit_Name(self, node: ast.Name) -> Any:
        if node.id in self.variables or node.id in self.program.constants:
            return node
        if node.id not in self.names:
            self.where.refuse(node, "is not defined", "define it in the module")
        return self._number(node, node.id, self.names[node.id])

    def visit_Attribute(self, node: ast.Attribute) -> Any:
        match node.value:
            case ast.Name(id=of) if of in self.program.constants:
                if node.attr not in self.program.constants[of]:
                    self.where.refuse(node, f"is not a number of the {of}", "add it there")
                self.program.used.add((of, node.attr))
                return node
            case ast.Name(id=of) if of not in self.variables:
                return self._number(node, node.attr, getattr(self.names.get(of), node.attr, None))
        return self.generic_visit(node)

    def _number(self, node: ast.expr, name: str, value: Any) -> ast.expr:
        is_number = isinstance(value, int | float | np.number | np.ndarray) and np.ndim(value) <= 1
        if not is_number:
            self.where.refuse(node, "is neither a number nor a vector", "use numbers")
        if np.ndim(value) == 0 and not math.isfinite(value):
            return ast.Name("nan" if math.isnan(value) else "inf")
        name = name.lstrip("_")
        if len(name) < 3 and name != "pi":  # short names would collide
            return ast.Constant(value)
        if not np.array_equal(self.program.numbers.setdefault(name, value), value):
            self.where.refuse(node, "is a constant with two values", "rename one")
        return ast.Name(name)

    def visit_BinOp(self, node: ast.BinOp) -> Any:
        self.generic_visit(node)
        logical = {ast.BitAnd: ast.And, ast.BitOr: ast.Or}.get(type(node.op))
        if logical is None:
            return node
        return ast.copy_location(ast.BoolOp(logical(), [node.left, node.right]), node)

    def visit_Call(self, node: ast.Call) -> Any:
        function: Any = None
        match node.func:
            case ast.Attribute(value=ast.Name(id=of), attr=attr):
                function = getattr(self.names.get(of), attr, None)
            case ast.Name(id=name):
                function = self.names.get(name)
        if node.keywords or any(isinstance(each, ast.Starred) for each in node.args):
            self.where.refuse(node, "has keywords or stars", "give plain arguments")
        args = [self.visit(each) for each in node.args]
        if function is float:
            return args[0]
        if function in _CHOICES or getattr(function, "__name__", "") == "choose":
            return ast.copy_location(ast.IfExp(*args), node)
        called: Any = None
        if function in KNOWN:
            name = KNOWN[function]
        elif hasattr(function, "_fields"):
            self.program.see(function)
            called, name = function, function.__name__
        elif isinstance(getattr(function, "py_func", function), FunctionType):
            called = self.program.read(function)
            name = called.name
        else:
            known = ", ".join(sorted({*KNOWN.values()} - {"larger", "smaller"} | {"max", "min"}))
            rule = "calls a function that other languages may not have"
            self.where.refuse(node, rule, f"use {known} and plain functions")
        call: Any = ast.copy_location(ast.Call(ast.Name(name), args, []), node)
        call.called = called
        return call


class _Types(ast.NodeTransformer):
    """Writes whole numbers as floats where Python takes them as such; refuses wrong types."""

    def __init__(self, program: Program, function: Function, where: _Place) -> None:
        self.program, self.function, self.where = program, function, where
        self.local = {**function.arguments, **function.locals}

    def type_of(self, node: ast.expr) -> Any:
        """Return the type of an expression."""
        return self.program.type_of(node, self.local)

    def visit(self, node: Node) -> Any:
        """Return a node with floats as floats."""
        node = self.generic_visit(node)
        match node:
            case ast.For():
                node.limits = [self.visit(each) for each in node.limits]  # type: ignore[attr-defined]
            case ast.BinOp(op=ast.Mod() | ast.FloorDiv()) if self.type_of(node) is not int:
                self.where.refuse(node, "divides other than whole numbers", "use `/`")
            case ast.BinOp(op=op) if (
                isinstance(op, ast.Div | ast.Pow) or self.type_of(node) is float
            ):
                node.left, node.right = _float(node.left), _float(node.right)
            case ast.Compare(left=x, comparators=[y]) if float in map(self.type_of, (x, y)):
                node.left, node.comparators = _float(x), [_float(y)]
            case ast.IfExp() if self.type_of(node) is float:
                node.body, node.orelse = _float(node.body), _float(node.orelse)
            case ast.Assign(targets=[target]) if self.type_of(target) is float:
                node.value = _float(node.value)
            case ast.AugAssign(target=target) if self.type_of(target) is float:
                node.value = _float(node.value)
            case ast.Return() if node.value and self.function.returns is float:
                node.value = _float(node.value)
            case ast.Call():
                self._type_arguments(node)
        return node

    def _type_arguments(self, node: Node) -> None:
        called = getattr(node, "called", None)
        kinds = called.arguments if isinstance(called, Function) else fields_of(called)
        whole = called is None and self.type_of(node) is int
        wanted = list(kinds.values()) or [int if whole else float] * len(node.args)
        pairs = zip(node.args, wanted, strict=True)
        node.args = [_float(each) if kind is float else each for each, kind in pairs]


def _float(node: Node) -> Any:
    match node:
        case ast.Constant(value=value) if type(value) is int:
            return ast.Constant(float(value))
        case ast.UnaryOp(op=ast.USub()):
            node.operand = _float(node.operand)
        case ast.IfExp():
            node.body, node.orelse = _float(node.body), _float(node.orelse)
    return node


def _in_order(node: ast.AST) -> Iterator[Any]:
    yield node
    for each in ast.iter_child_nodes(node):
        yield from _in_order(each)
