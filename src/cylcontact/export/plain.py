"""Reads plain functions of the package from their source, to be written in other languages.

A plain function keeps to these rules; anything else is refused with its expression and line.

- Statements: assignments (also `a, b = x, y`, one after the other), `if`, `while`, `for` over a
  `range` with a literal step, `break`, `return`, and calls of functions that change a record.
- `x if test else y` as the right side of an assignment or as what is returned becomes an `if`;
  inside an expression it is `choose(test, x, y)`, which may compute both.
- Numbers, vectors, `NamedTuple`s and records (`np.dtype`) are the only values. What has no
  annotation is a float. A function returns one number or one `NamedTuple`, or changes records.
- A call's result is not unpacked: assign a `NamedTuple` and use its fields. If the call changes a
  record, its result is not assigned to a field of that record.
- Functions: other plain functions, and those in `KNOWN`, called without keywords.
- Comparisons are not chained. `//` and `%` are for whole numbers that are not negative.
- `max(x, 0.0)` and `np.maximum(x, 0.0)` keep a NaN only if it is the first argument, as Python's
  `max` does: put the number that may be NaN first.
- Names differ by more than case, because Fortran ignores case. A variable that a loop carries from
  turn to turn gets a value before the loop.
- A constant of a module has the same value wherever its name is used.

The reader leaves few forms: one target in an assignment, no `+=`, no choices but `choose`, no
arguments that a function does not use. Every expression has its type in `kind`.
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
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any, NamedTuple, NoReturn

import numpy as np

from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import RESERVED

Node = Any  # of a syntax tree, with `kind`, and `called` of a call


class Vector(NamedTuple):
    """The type of an array of numbers; its size is 0 where it does not matter."""

    size: int


@dataclass(eq=False)
class Function:
    """A plain function; a type is float, int, bool, a `Vector`, a `NamedTuple` or a `np.dtype`.

    `takes` are the arguments in the source, `arguments` those that it uses.
    """

    name: str
    takes: dict[str, Any]
    returns: Any
    about: str
    arguments: dict[str, Any] = field(default_factory=dict)
    body: list[Node] = field(default_factory=list)
    locals: dict[str, Any] = field(default_factory=dict)
    changes: set[str] = field(default_factory=set)  # the records that it changes

    def used(self, values: Iterable[Any]) -> list[Any]:
        """Return the values of those arguments that the function uses, of all that it takes."""
        pairs = zip(self.takes, values, strict=True)
        return [value for name, value in pairs if name in self.arguments]


# Functions that every language has or that `languages` adds, by one name.
KNOWN: dict[Any, str] = {
    getattr(module, name): name
    for module in (math, np)
    for name in ("log", "log1p", "exp", "sqrt", "sin", "cos", "tan", "hypot", "copysign")
}
KNOWN |= {math.acos: "acos", np.arccos: "acos", math.asin: "asin", np.arcsin: "asin"}
KNOWN |= {math.atan: "atan", np.arctan: "atan", np.where: "choose"}
KNOWN |= {np.maximum: "larger", max: "larger", np.minimum: "smaller", min: "smaller"}
KNOWN |= {abs: "abs", np.abs: "abs", math.fabs: "abs", int: "int"}
_LOGIC = {ast.BitAnd: ast.And, ast.BitOr: ast.Or}


@dataclass
class Program:
    """Functions in the order in which they call each other, with their types and numbers.

    `records` are types of arguments by name, in place of their annotations; `instead` replaces
    functions by others; `used` are the fields of records that are read or written.
    """

    records: Mapping[str, Any] = field(default_factory=dict)
    instead: dict[Any, Any] = field(default_factory=dict)
    functions: dict[Any, Function] = field(default_factory=dict)
    types: list[Any] = field(default_factory=list)
    numbers: dict[str, Any] = field(default_factory=dict)
    used: set[tuple[Any, str]] = field(default_factory=set)

    def read(self, function: Any) -> Function:
        """Return a function of the package, after those that it calls."""
        function = getattr(function, "py_func", function)
        if function not in self.functions:
            other = self.instead.get(function, function)
            if isinstance(other, Function):
                self.functions[function] = other
            elif other is not function:
                self.functions[function] = self.read(other)
            else:
                lines, first = inspect.getsourcelines(function)
                hints = typing.get_type_hints(function, include_extras=True)
                code = function.__code__
                cells = zip(code.co_freevars, function.__closure__ or (), strict=True)
                names = {**vars(builtins), **function.__globals__}
                names |= {name: cell.cell_contents for name, cell in cells}
                read = self.read_text("".join(lines), names, hints, code.co_filename, first)
                self.functions[function] = read
        return self.functions[function]

    def read_text(
        self, text: str, names: Mapping[str, Any], hints: Mapping[str, Any] | None = None,
        file: str = "", first: int = 1,
    ) -> Function:  # fmt: skip
        """Return a function from its text, which begins at line `first` of a file."""
        text = textwrap.dedent(text)
        tree = next(n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.FunctionDef))
        about = (ast.get_docstring(tree) or "").partition("\n\n")[0].replace("\n", " ")
        del tree.body[: bool(about)]
        hints = {**(hints or {}), **self.records}
        takes = {a.arg: kind_of(hints.get(a.arg, float)) for a in tree.args.args}
        f = Function(tree.name, takes, kind_of(hints.get("return", float)), about)
        _add_remarks(tree, text)
        reader = _Reader(self, f, names, file.replace("\\", "/").rpartition("/")[2], first - 1)
        a = tree.args
        if a.vararg or a.kwarg or a.kwonlyargs or a.posonlyargs:
            reader.refuse(tree, "takes other than plain arguments", "name each")
        reader.read(tree)
        lowered = [name.lower() for name in (tree.name, *{**takes, **f.locals})]
        for name in (tree.name, *{**takes, **f.locals}):
            if not name.isascii() or name in RESERVED:
                reader.refuse(tree, "is not a name in other languages", "rename it", name)
            same = [each for each in {**takes, **f.locals} if each.lower() == name.lower()]
            if len(same) > 1:
                rule = "differ by case alone, which Fortran ignores"
                reader.refuse(tree, rule, "rename one", ", ".join(same))
        if lowered.count(tree.name.lower()) > 1:
            reader.refuse(tree, "has a variable of its own name", "rename it", tree.name)
        if any(f.name.lower() == each.name.lower() for each in self.functions.values()):
            reader.refuse(tree, "has the name of another function", "rename one", f.name)
        self.see(*f.arguments.values(), f.returns)
        return f

    def expression(
        self, text: str, local: Mapping[str, Any], names: Mapping[str, Any] | None = None
    ) -> Node:
        """Return an expression with local variables and the functions that `names` has, read."""
        f = Function("it", dict(local), float, "")
        reader = _Reader(self, f, {**(names or {}), "inf": math.inf}, "", 0)
        return reader.visit(ast.parse(text, mode="eval").body)

    def see(self, *kinds: Any) -> None:
        """Add types to those of the file, after the types of their fields."""
        for kind in kinds:
            if kind not in self.types and (fields := fields_of(kind)):
                self.see(*fields.values())
                self.types.append(kind)

    def fields(self, kind: Any) -> dict[str, Any]:
        """Return the fields of a record that functions read or write."""
        return {name: part for name, part in fields_of(kind).items() if (kind, name) in self.used}


def kind_of(hint: Any) -> Any:
    """Return the type that an annotation means."""
    if hasattr(hint, "__metadata__"):
        (what,) = hint.__metadata__
        return Vector(what) if isinstance(what, int) else what
    return None if hint is type(None) else hint


def fields_of(kind: Any) -> dict[str, Any]:
    """Return the types of the fields of a `NamedTuple` or a record; none of a number."""
    if isinstance(kind, np.dtype):
        parts = {name: kind[name] for name in kind.names or ()}
        return {
            name: Vector(part.shape[0]) if part.shape else int if part.kind == "i" else float
            for name, part in parts.items()
        }
    return (
        typing.get_type_hints(kind) if isinstance(kind, type) and hasattr(kind, "_fields") else {}
    )


def _add_remarks(tree: ast.FunctionDef, text: str) -> None:
    """Give each statement the comments before it and on its line."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    left = [
        (t.start[0], t.string.lstrip("# ")) for t in tokens
        if t.type == tokenize.COMMENT and not t.string.startswith(("# fmt:", "# noqa"))
    ]  # fmt: skip
    statements: list[Any] = [n for n in ast.walk(tree) if isinstance(n, ast.stmt) and n is not tree]
    for node in sorted(statements, key=lambda n: n.lineno):
        last = node.lineno if hasattr(node, "body") else node.end_lineno
        node.remarks = [words for line, words in left if line <= last]
        left = [each for each in left if each[0] > last]


@dataclass
class _Reader(ast.NodeVisitor):
    """Reads the statements of a function; `visit` returns an expression with its type."""

    program: Program
    f: Function
    names: Mapping[str, Any]
    file: str
    before: int  # lines of the file before the function

    def refuse(self, node: ast.AST, rule: str, remedy: str, text: str = "") -> NoReturn:
        """Raise `InputError` with an expression and its line."""
        line = f"line {node.lineno + self.before}" if self.file and hasattr(node, "lineno") else ""
        words = (text or ast.unparse(node)).partition("\n")[0]
        source = ", ".join(filter(None, (self.f.name, self.file, line)))
        rule = f"cannot be written in another language: it {rule}"
        raise InputError(f"{source}: `{words}`", "", None, rule, remedy)

    def read(self, tree: ast.FunctionDef) -> None:
        """Read the body; a variable that is first a whole number and then a float is a float."""
        floats = dict[str, Any]()
        while True:
            self.f.locals, self.f.changes = {**floats}, set()
            try:
                self.f.body = self.block(tree.body)
            except _FloatFoundError as found:
                floats[found.name] = float
            else:
                break
        used = {name for node in self.f.body for name in names_in(node)}
        self.f.arguments = {name: kind for name, kind in self.f.takes.items() if name in used}

    def generic_visit(self, node: ast.AST) -> NoReturn:
        """Refuse what the rules do not have."""
        self.refuse(node, "is not in the rules of plain functions", "write it otherwise")

    # --- statements: each becomes a list of simpler ones ---

    def block(self, body: list[Any]) -> list[Node]:
        """Return statements that are read."""
        done: list[Node] = []
        for node in body:
            parts = self.visit(node)
            if parts:
                parts[0].remarks = getattr(node, "remarks", [])
            done += parts
        return done

    def visit_Assign(self, node: Node) -> list[Node]:
        """Return an assignment for each target; a choice becomes an `if`."""
        match node:
            case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Tuple(elts=values)):
                written = set[str]()
                done = list[Node]()
                for name, value in zip(names, values, strict=True):
                    if written & set(names_in(value)):
                        remedy = "write one assignment after the other"
                        self.refuse(node, "uses a variable that it changes", remedy)
                    written |= set(names_in(name))
                    done += self.visit_Assign(ast.copy_location(ast.Assign([name], value), node))
                return done
            case ast.Assign(targets=[target], value=ast.IfExp(test, yes, no)):
                one, other = (
                    list[ast.stmt]([ast.copy_location(ast.Assign([target], x), node)])
                    for x in (yes, no)
                )
                return self.visit_If(ast.copy_location(ast.If(test, one, other), node))
            case ast.Assign(targets=[ast.Tuple()]):
                remedy = "assign a NamedTuple, and use its fields"
                self.refuse(node, "unpacks the result of a call", remedy)
            case ast.Assign(targets=[_, _, *_]):
                self.refuse(node, "has two targets", "write two assignments")
        return [self._assignment(node, node.targets[0], self.visit(node.value))]

    def _assignment(self, node: Node, target: Node, value: Node) -> Node:
        """Return an assignment to a variable, a field or an element."""
        if isinstance(target, ast.Name):
            name = target.id
            kind = self.f.locals.setdefault(name, self.f.takes.get(name, value.kind))
            if (kind, value.kind) == (int, float):
                raise _FloatFoundError(name)
            if kind is not value.kind and (kind, value.kind) != (float, int):
                self.refuse(node, f"changes the type of {name}", "use two names")
            return ast.Assign([_typed(ast.Name(name), kind)], _as(kind, value))
        target = self.visit(target)
        self._change(target)
        if _root(target) in _changed(value):
            rule, remedy = "assigns to a record that the call changes", "use a variable"
            self.refuse(node, rule, remedy)
        return ast.Assign([target], _as(target.kind, value))

    def visit_AugAssign(self, node: Node) -> list[Node]:
        """Return `x = x + y` for `x += y`."""
        sum_of = ast.copy_location(ast.BinOp(node.target, node.op, node.value), node)
        return self.visit_Assign(ast.copy_location(ast.Assign([node.target], sum_of), node))

    def visit_Return(self, node: Node) -> list[Node]:
        """Return a value; a choice becomes an `if`."""
        if isinstance(choice := node.value, ast.IfExp):
            yes, no = (
                list[ast.stmt]([ast.copy_location(ast.Return(x), node)])
                for x in (choice.body, choice.orelse)
            )
            return self.visit_If(ast.copy_location(ast.If(choice.test, yes, no), node))
        return [ast.Return(node.value and _as(self.f.returns, self.visit(node.value)))]

    def visit_Expr(self, node: ast.Expr) -> list[Node]:
        """Return a call of a function that changes records."""
        if not isinstance(node.value, ast.Call):
            self.refuse(node, "does nothing", "remove it")
        return [ast.Expr(self.visit(node.value))]

    def visit_If(self, node: ast.If) -> list[Node]:
        """Return an `if` with the blocks read."""
        return [ast.If(self.visit(node.test), self.block(node.body), self.block(node.orelse))]

    def visit_While(self, node: ast.While) -> list[Node]:
        """Return a `while`."""
        if node.orelse:
            self.refuse(node, "is a loop with an else", "use a variable")
        return [ast.While(self.visit(node.test), self.block(node.body), [])]

    def visit_For(self, node: Node) -> list[Node]:
        """Return a loop with its limits: first value, end, and step as a number."""
        match node:
            case ast.For(ast.Name(id=name), ast.Call(ast.Name("range"), args), body, []):
                name = name.lstrip("_")
            case _:
                self.refuse(node, "is a loop over something else", "loop over a range")
        self.f.locals[name] = int
        first, end, *step = [ast.Constant(0)] * (len(args) == 1) + args
        try:
            by = ast.literal_eval(step[0]) if step else 1
        except ValueError:
            self.refuse(node, "has a step that is not a literal", "write a number")
        limits = self.visit(first), self.visit(end), by
        loop: Node = ast.For(ast.Name(name), ast.Constant(0), self.block(body), [])
        loop.limits = limits
        return [loop]

    def visit_Break(self, node: ast.Break) -> list[Node]:
        """Return a `break`."""
        return [node]

    def visit_Pass(self, _: ast.Pass) -> list[Node]:
        """Return nothing."""
        return []

    def _change(self, node: Node) -> None:
        """Note that the argument at the root of an expression is changed."""
        if (name := _root(node)) in self.f.takes:
            self.f.changes.add(name)

    # --- expressions ---

    def visit_Constant(self, node: Node) -> Node:
        """Return a number."""
        if not isinstance(node.value, bool | int | float):
            self.refuse(node, "is not a number", "use numbers")
        return _typed(node, type(node.value))

    def visit_Name(self, node: Node) -> Node:
        """Return a variable, or a number of the module."""
        known = {**self.f.takes, **self.f.locals}
        if node.id in known:
            return _typed(node, known[node.id])
        if node.id not in self.names:
            self.refuse(node, "is not defined", "define it in the module")
        return self._number(node, node.id, self.names[node.id])

    def visit_Attribute(self, node: Node) -> Node:
        """Return a field of a record, or a number of another module."""
        match node.value:
            case ast.Name(id=of) if of not in self.f.takes and of not in self.f.locals:
                return self._number(node, node.attr, getattr(self.names.get(of), node.attr, None))
        value = self.visit(node.value)
        kinds = fields_of(value.kind)
        if node.attr not in kinds:
            self.refuse(node, "is not a number of the record", "add it there")
        self.program.used.add((value.kind, node.attr))
        return _typed(ast.Attribute(value, node.attr), kinds[node.attr])

    def _number(self, node: ast.expr, name: str, value: Any) -> Node:
        """Return a number or vector of a module by its name, short ones as they are."""
        if not isinstance(value, int | float | np.number | np.ndarray) or np.ndim(value) > 1:
            self.refuse(node, "is neither a number nor a vector", "use numbers")
        kind = Vector(0) if np.ndim(value) else int if isinstance(value, int) else float
        name = name.lstrip("_")
        if kind is float and not math.isfinite(value):
            return _typed(ast.Name("nan" if math.isnan(value) else "inf"), float)
        if len(name) < 3 and name != "pi":  # short names would collide
            constant: Any = value
            return _typed(ast.Constant(constant), kind)
        if not np.array_equal(self.program.numbers.setdefault(name, value), value):
            self.refuse(node, "is a constant with two values", "rename one")
        return _typed(ast.Name(name), kind)

    def visit_IfExp(self, node: ast.IfExp) -> Node:
        """Return a choice inside an expression."""
        args = [self.visit(each) for each in (node.test, node.body, node.orelse)]
        kind = int if args[1].kind is args[2].kind is int else float
        return self._call(node, args, None, "choose", kind, {0: bool, 1: kind, 2: kind})

    def visit_Subscript(self, node: ast.Subscript) -> Node:
        """Return a number of a vector."""
        return _typed(ast.Subscript(self.visit(node.value), self.visit(node.slice)), float)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Node:
        """Return a sign or `not`."""
        x: Node = self.visit(node.operand)
        if isinstance(x, ast.Constant) and isinstance(node.op, ast.USub):
            number: Any = x.value
            return _typed(ast.Constant(-number), x.kind)
        return _typed(ast.UnaryOp(node.op, x), x.kind)

    def visit_BinOp(self, node: Node) -> Node:
        """Return an operation of two numbers; & and | are `and` and `or`."""
        if type(node.op) in _LOGIC:
            return self.visit(ast.BoolOp(_LOGIC[type(node.op)](), [node.left, node.right]))
        x, y = self.visit(node.left), self.visit(node.right)
        whole = x.kind is y.kind is int and not isinstance(node.op, ast.Div | ast.Pow)
        if isinstance(node.op, ast.Mod | ast.FloorDiv) and not whole:
            self.refuse(node, "divides other than whole numbers", "use `/`")
        kind = int if whole else float
        return _typed(ast.BinOp(_as(kind, x), node.op, _as(kind, y)), kind)

    def visit_BoolOp(self, node: ast.BoolOp) -> Node:
        """Return conditions that are joined."""
        return _typed(ast.BoolOp(node.op, [self.visit(each) for each in node.values]), bool)

    def visit_Compare(self, node: ast.Compare) -> Node:
        """Return a comparison of two numbers or conditions."""
        if len(node.ops) > 1:
            self.refuse(node, "chains comparisons", "join two with `and`")
        x, y = self.visit(node.left), self.visit(node.comparators[0])
        kind = float if float in (x.kind, y.kind) else x.kind
        return _typed(ast.Compare(_as(kind, x), node.ops, [_as(kind, y)]), bool)

    def visit_Call(self, node: Node) -> Node:
        """Return a call of a plain function, of a known one, or of a `NamedTuple`."""
        match node.func:
            case ast.Attribute(ast.Name(id=of), attr):
                function = getattr(self.names.get(of), attr, None)
            case _:
                function = self.names.get(getattr(node.func, "id", ""))
        if node.keywords or any(isinstance(each, ast.Starred) for each in node.args):
            self.refuse(node, "has keywords or stars", "give plain arguments")
        args = [self.visit(each) for each in node.args]
        if function is float:
            return args[0]
        if hasattr(function, "_fields"):
            self.program.see(function)
            kind: Any = function
            return self._call(node, args, kind, kind.__name__, kind, fields_of(kind))
        plain = getattr(function, "py_func", function)
        name = "choose" if getattr(plain, "__name__", "") == "choose" else KNOWN.get(function)
        if name is None and isinstance(plain, FunctionType | Function):
            f = plain if isinstance(plain, Function) else self.program.read(plain)
            return self._call(node, args, f, f.name, f.returns, f.takes)
        if name is None:
            known = ", ".join(sorted({*KNOWN.values()} - {"larger", "smaller"} | {"max", "min"}))
            rule = "calls a function that other languages may not have"
            self.refuse(node, rule, f"use {known} and plain functions")
        whole = name == "int" or (name == "abs" and args[0].kind is int)
        kinds = dict.fromkeys(range(len(args)), float)
        if name in ("abs", "int"):
            kinds[0] = args[0].kind
        elif name == "choose":
            kinds[0] = bool
        return self._call(node, args, None, name, int if whole else float, kinds)

    def _call(
        self, node: Node, args: list[Node], called: Any, name: str, kind: Any,
        takes: Mapping[Any, Any],
    ) -> Node:  # fmt: skip
        """Return a call with its values as the types that it takes."""
        if len(args) != len(takes):
            self.refuse(node, "lacks arguments", f"give all of {', '.join(map(str, takes))}")
        args = [_as(k, x) for k, x in zip(takes.values(), args, strict=True)]
        if isinstance(called, Function):
            args = called.used(args)
            for argument, value in zip(called.arguments, args, strict=True):
                if argument in called.changes:
                    self._change(value)
        call = _typed(ast.Call(ast.Name(name), args, []), kind)
        call.called = called
        return call


class _FloatFoundError(Exception):
    """A variable that was read as a whole number is a float."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


def _root(node: Node) -> str:
    """Return the variable of a field or an element."""
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return str(node.id)


def _changed(node: Node) -> set[str]:
    """Return the variables that a call changes."""
    f = getattr(node, "called", None)
    if not isinstance(f, Function):
        return set()
    pairs = zip(f.arguments, node.args, strict=True)
    return {_root(value) for name, value in pairs if name in f.changes}


def _typed(node: Node, kind: Any) -> Node:
    node.kind = kind
    return node


def _as(kind: Any, node: Node) -> Node:
    """Return a whole number as a float where a float is wanted."""
    if kind is float and isinstance(node, ast.Constant) and type(node.value) is int:
        return _typed(ast.Constant(float(node.value)), float)
    return node


def names_in(node: Any) -> Iterator[str]:
    """Yield the names in a tree, in the limits of loops too."""
    for each in ast.walk(node):
        if isinstance(each, ast.Name):
            yield each.id
        for limit in getattr(each, "limits", ())[:2]:
            yield from names_in(limit)
