"""Compiled functions of the package in C, C++ and Python, read from their own source.

The functions keep to assignments, choices, loops, calls, numbers, arrays of numbers, and one record
`w` that they change. The numbers of the record `joint` become constants; the law, a call.
"""

from __future__ import annotations

import ast
import inspect
import math
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from textwrap import indent
from typing import Any

import numpy as np

_C_NAMES = {"max": "fmax", "min": "fmin", "abs": "fabs", "int": "(int)"}
_SYMBOLS: Mapping[type[ast.AST], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "/", ast.Mod: "%",
    ast.Gt: ">", ast.GtE: ">=", ast.Lt: "<", ast.LtE: "<=", ast.Eq: "==", ast.NotEq: "!=",
    ast.And: "&&", ast.Or: "||", ast.Not: "!", ast.USub: "-",
}  # fmt: skip
_C_NUMBERS = {"inf": "(double)INFINITY", "nan": "(double)NAN", "pi": repr(math.pi)}


@dataclass(frozen=True)
class Program:
    """Functions in the order in which they call each other, and the numbers that they use.

    Parameters
    ----------
    functions : sequence of callable
        Compiled by numba.
    joint : record
        Its fields become constants.
    work : dtype
        That of the record `w`.
    """

    functions: Sequence[Callable[..., Any]]
    joint: Any
    work: np.dtype[Any]

    def parts(self, target: str, law: str, static: str) -> dict[str, str]:
        """Return what a language's template of an element has of functions, and their calls."""
        if target == "python":
            made, given = "w = Work()", "(impact_rate, bearing, pin, w)"
            return {
                "program": self.python(),
                "evaluate": f"{made}\nwrench_of{given}",
                "accept": f"{made}\nimpact_rate = list(impact_rate)\nnext_rates{given}",
                "next": "return tuple(impact_rate)",
            }
        given = "(state->impact_rate, bearing, pin, &w);"
        return {
            "program": self.c(law, static),
            "evaluate": f"work w;\nwrench_of{given}",
            "accept": f"work w;\nnext_rates{given}",
            "next": "",
        }

    @cached_property
    def _trees(self) -> list[ast.FunctionDef]:
        trees = []
        for function in self.functions:
            plain = getattr(function, "py_func", function)
            tree = ast.parse(textwrap.dedent(inspect.getsource(plain))).body[0]
            assert isinstance(tree, ast.FunctionDef)
            tree = ast.fix_missing_locations(_Names(vars(inspect.getmodule(plain))).visit(tree))
            tree.decorator_list, tree.returns = [], tree.returns
            trees.append(tree)
        return trees

    @cached_property
    def _constants(self) -> dict[str, Any]:
        """Numbers and arrays by name, those that the functions use."""
        own = {f"joint_{name}": self.joint[name] for name in self.joint.dtype.names}
        arrays = {
            name: value
            for function in self.functions
            for name, value in vars(
                inspect.getmodule(getattr(function, "py_func", function))
            ).items()
            if isinstance(value, np.ndarray)
        }
        used = {n.id for tree in self._trees for n in ast.walk(tree) if isinstance(n, ast.Name)}
        return {name: value for name, value in {**own, **arrays}.items() if name in used}

    def c(self, law: str, static: str) -> str:
        """Return types, constants and functions in C."""
        fields = []
        for name in self.work.names or ():
            size = self.work[name].shape
            fields.append(f"    double {name}{f'[{size[0]}]' if size else ''};")
        lines = ["typedef struct {", *fields, "} work;", ""]
        for name, value in self._constants.items():
            if np.ndim(value):
                numbers = ",\n    ".join(map(_c_number, value))
                lines.append(f"static const double {name}[{len(value)}] = {{\n    {numbers}}};")
            else:
                lines.append(f"static const double {name} = {_c_number(value)};")
        for tree in self._trees:
            lines += ["", _Function(tree, self._changes, law).text(static)]
        return "\n".join(lines)

    @cached_property
    def _changes(self) -> dict[str, set[int]]:
        """The places of the arrays that each function changes among its arguments."""
        changes: dict[str, set[int]] = {}
        for tree in self._trees:
            names = [a.arg for a in tree.args.args]
            stored = {
                n.value.id for n in ast.walk(tree)
                if isinstance(n, ast.Subscript) and isinstance(n.ctx, ast.Store)
                and isinstance(n.value, ast.Name)
            }  # fmt: skip
            changes[tree.name] = {names.index(name) for name in stored if name in names}
        return changes

    def python(self) -> str:
        """Return the class of `w`, constants and functions in Python."""
        lines = ["class Work:", "    def __init__(self):"]
        for name in self.work.names or ():
            size = self.work[name].shape
            lines.append(f"        self.{name} = {f'[0.0] * {size[0]}' if size else '0.0'}")
        lines += ["", ""]
        for name, value in self._constants.items():
            if np.ndim(value):
                numbers = ",\n    ".join(map(repr, value.tolist()))
                lines.append(f"{name} = (\n    {numbers},\n)")
            else:
                lines.append(f"{name} = {_python_number(float(value))}")
        for tree in self._trees:
            plain = ast.parse(ast.unparse(tree)).body[0]
            assert isinstance(plain, ast.FunctionDef)
            plain.returns = None
            for argument in plain.args.args:
                argument.annotation = None
            lines += ["", "", ast.unparse(plain).replace("law_of(", "_law(")]
        return "\n".join(lines)


class _Names(ast.NodeTransformer):
    """Constants and the law by name, without the records of joint and law as arguments."""

    def __init__(self, module: Mapping[str, Any]) -> None:
        self.module = module

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        node.args.args = [a for a in node.args.args if a.arg not in ("joint", "law")]
        self.own = {a.arg for a in node.args.args}
        self.own |= {
            n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
        }
        node.body = [self.visit(each) for each in node.body[1:]]  # the first is the docstring
        node.name = _name(node.name)
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        if isinstance(node.value, ast.Name) and node.value.id == "joint":
            return ast.Name(f"joint_{node.attr}", node.ctx)
        return node

    def visit_Name(self, node: ast.Name) -> ast.expr:
        number = None if node.id in self.own else self.module.get(node.id)
        return ast.Constant(number) if isinstance(number, int | float) else node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        if isinstance(node.func, ast.Name):
            if node.func.id == "kernel_load":
                return ast.Call(ast.Name("law_of"), [self.visit(node.args[2])], [])
            if node.func.id == "float":
                inside: ast.expr = self.visit(node.args[0])
                return inside
            node.func.id = _name(node.func.id)
        args = [a for a in node.args if not (isinstance(a, ast.Name) and a.id in ("joint", "law"))]
        node.args = [self.visit(a) for a in args]
        return node


def _name(function: str) -> str:
    """Return the name of a function in a file that has an `evaluate` and an `accept` of its own."""
    return {"evaluate": "wrench_of", "accept": "next_rates"}.get(function, function)


class _Function:
    """A function in C."""

    def __init__(self, tree: ast.FunctionDef, changes: Mapping[str, set[int]], law: str) -> None:
        self.tree, self.changes, self.law = tree, changes[tree.name], law
        self.whole: set[str] = set()

    def text(self, static: str) -> str:
        """Return the function."""
        tree, arguments = self.tree, []
        for k, argument in enumerate(tree.args.args):
            kind = ast.unparse(argument.annotation) if argument.annotation else ""
            form = {"float": "double {}", "int": "int {}", "Record": "work *{}"}.get(kind)
            if form is None:
                form = "double *{}" if k in self.changes else "const double *{}"
            if kind == "int":
                self.whole.add(argument.arg)
            arguments.append(form.format(argument.arg))
        values: dict[str, list[ast.expr]] = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign | ast.AugAssign):
                target = node.targets[0] if isinstance(node, ast.Assign) else node.target
                if isinstance(target, ast.Name):
                    values.setdefault(target.id, []).append(node.value)
            elif isinstance(node, ast.For) and isinstance(node.target, ast.Name):
                values.setdefault(node.target.id, [])
        for (
            name,
            given_values,
        ) in values.items():  # in the order of first use, so that one may rest on those before
            if all(map(self._is_whole, given_values)):
                self.whole.add(name)
        given = {a.arg for a in tree.args.args}
        locals_ = {
            kind: [n for n in values if n not in given and (n in self.whole) == (kind == "int")]
            for kind in ("double", "int")
        }
        declared = [f"{kind} {', '.join(names)};" for kind, names in locals_.items() if names]
        returned = (
            "double" if tree.returns is not None and ast.unparse(tree.returns) != "None" else "void"
        )
        body = indent("\n".join([*declared, *self._lines(tree.body)]), "    ")
        return f"{static} {returned} {tree.name}({', '.join(arguments)})\n{{\n{body}\n}}"

    def _is_whole(self, node: ast.expr) -> bool:
        match node:
            case ast.Constant(value=value):
                return isinstance(value, int)
            case ast.Name(id=name) | ast.Call(func=ast.Name(id=name)):
                return name in self.whole or name == "int"
            case ast.BinOp(left=left, op=op, right=right):
                whole = self._is_whole(left) and self._is_whole(right)
                return whole and not isinstance(op, ast.Div)
            case ast.IfExp(body=yes, orelse=no):
                return self._is_whole(yes) and self._is_whole(no)
        return isinstance(node, ast.Compare | ast.BoolOp)

    def _lines(self, body: Sequence[ast.stmt]) -> Iterator[str]:
        for node in body:
            match node:
                case ast.Assign(targets=[target], value=value):
                    yield f"{self._text(target)} = {self._text(value)};"
                case ast.AugAssign(target=target, op=op, value=value):
                    yield f"{self._text(target)} {_SYMBOLS[type(op)]}= {self._text(value)};"
                case ast.Expr(value=value):
                    yield f"{self._text(value)};"
                case ast.Return(value=value):
                    yield f"return {self._text(value)};" if value else "return;"
                case ast.Break():
                    yield "break;"
                case ast.If(test=test, body=inside, orelse=other):
                    yield f"if ({self._text(test)}) {{"
                    yield from self._block(inside)
                    if other:
                        yield "} else {"
                        yield from self._block(other)
                    yield "}"
                case ast.For(target=ast.Name(id=k), iter=ast.Call(args=[count]), body=inside):
                    yield f"for ({k} = 0; {k} < {self._text(count)}; {k}++) {{"
                    yield from self._block(inside)
                    yield "}"
                case _:
                    raise NotImplementedError(ast.unparse(node))

    def _block(self, body: Sequence[ast.stmt]) -> Iterator[str]:
        yield from (indent(line, "    ") for line in self._lines(body))

    def _text(self, node: ast.expr) -> str:
        """Return an expression."""
        match node:
            case ast.Constant(value=value):
                return _c_number(value) if isinstance(value, float) else str(int(value))  # type: ignore[arg-type]
            case ast.Name(id=name):
                return name
            case ast.Attribute(value=ast.Name(id="math"), attr=name):
                return _C_NUMBERS.get(name, name)
            case ast.Attribute(value=value, attr=name):
                return f"{self._text(value)}->{name}"
            case ast.Subscript(value=value, slice=at):
                return f"{self._text(value)}[{self._text(at)}]"
        return self._operation(node)

    def _operation(self, node: ast.expr) -> str:
        """Return a call or an operation."""
        match node:
            case ast.Call(func=function, args=args):
                name, given = self._text(function), ", ".join(map(self._text, args))
                return f"{_C_NAMES.get(name, name)}({given})".replace("law_of(", f"{self.law}(")
            case ast.BinOp(left=left, op=op, right=right):
                text = f"{self._text(left)} {_SYMBOLS[type(op)]} {self._text(right)}"
            case ast.UnaryOp(op=unary, operand=operand):
                text = f"{_SYMBOLS[type(unary)]}{self._text(operand)}"
            case ast.BoolOp(op=either, values=values):
                text = f" {_SYMBOLS[type(either)]} ".join(map(self._text, values))
            case ast.Compare(left=left, ops=[comparison], comparators=[right]):
                text = f"{self._text(left)} {_SYMBOLS[type(comparison)]} {self._text(right)}"
            case ast.IfExp(test=test, body=yes, orelse=no):
                text = f"{self._text(test)} ? {self._text(yes)} : {self._text(no)}"
            case _:
                raise NotImplementedError(ast.unparse(node))
        return f"({text})"


def _c_number(value: float) -> str:
    if math.isinf(value):
        return "(double)INFINITY" if value > 0 else "-(double)INFINITY"
    return repr(float(value))


def _python_number(value: float) -> str:
    return f"{'-' if value < 0 else ''}math.inf" if math.isinf(value) else repr(value)
