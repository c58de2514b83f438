"""Compiled functions of the package in other languages, read from their own source.

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
from typing import Any, TypeGuard

import numpy as np

from cylcontact.export.function import CFunction, FortranFunction, MatlabFunction

# What stands before the names of the functions where they are called, and what behind.
_CALLS = {
    "c": ("work w;\n", "work w;\n", "(state->impact_rate, bearing, pin, &w);"),
    "fortran": ("call ", "call ", "(state%impact_rate, bearing, pin, w)"),
    "matlab": ("w = ", "impact_rate = ", "(impact_rate, bearing, pin, work());"),
    "python": (
        "w = Work()\n", "w = Work()\nimpact_rate = list(impact_rate)\n",
        "(impact_rate, bearing, pin, w)",
    ),
}  # fmt: skip


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
        evaluate, accept, given = _CALLS["c" if target == "cpp" else target]
        parts = {
            "types": "",
            "evaluate": f"{evaluate}wrench_of{given}",
            "accept": f"{accept}next_rates{given}",
            "next": "",
        }
        if target == "python":
            return {**parts, "program": self.python(), "next": "return tuple(impact_rate)"}
        kind = {"fortran": FortranFunction, "matlab": MatlabFunction}.get(target, CFunction)
        texts = [kind(tree, self._changes, law, self._constants).text() for tree in self._trees]
        if target == "fortran":
            parts |= {"types": self._fortran_types()}
            parts |= dict.fromkeys(("evaluate_variables", "accept_variables"), "type(work) :: w")
        elif target == "matlab":
            texts.insert(0, self._matlab_work())
        else:
            texts = [self._c_types(), *(f"{static} {text}" for text in texts)]
        return {**parts, "program": "\n\n".join(texts)}

    @property
    def names(self) -> set[str]:
        """The names that it takes in the file."""
        return {"work", *(tree.name for tree in self._trees)}

    @cached_property
    def _trees(self) -> list[ast.FunctionDef]:
        trees = []
        for function in self.functions:
            plain = getattr(function, "py_func", function)
            tree = ast.parse(textwrap.dedent(inspect.getsource(plain))).body[0]
            assert isinstance(tree, ast.FunctionDef)
            tree = ast.fix_missing_locations(_Names(vars(inspect.getmodule(plain))).visit(tree))
            tree.decorator_list = []
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

    @cached_property
    def _changes(self) -> dict[str, list[int]]:
        """The places of the arrays and of `w` among a function's arguments that it changes."""
        changes: dict[str, list[int]] = {}
        for tree in self._trees:
            names = [a.arg for a in tree.args.args]
            stored = {_root(node) for node in ast.walk(tree) if _is_stored_part(node)}
            for node in ast.walk(tree):
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                    stored |= {_root(node.args[k]) for k in changes.get(node.func.id, ())}
            changes[tree.name] = [k for k, name in enumerate(names) if name in stored]
        return changes

    def _fields(self) -> Iterator[tuple[str, int]]:
        """Yield the names of the numbers of `w` and how many there are of each, 0 for no array."""
        for name in self.work.names or ():
            yield name, (*self.work[name].shape, 0)[0]

    def _declared(
        self, array: str, single: str, number: Callable[[float], str], end: str = ",\n    "
    ) -> Iterator[str]:
        """Yield the declarations of the constants, by the forms of arrays and single numbers."""
        for name, value in self._constants.items():
            form, numbers = array if np.ndim(value) else single, np.atleast_1d(value).tolist()
            text = end.join(map(number, numbers))
            yield form.format(name=name, count=len(numbers), numbers=text)

    def _c_types(self) -> str:
        """Return the type of `w` and the constants in C."""
        fields = [f"    double {n}{f'[{size}]' if size else ''};" for n, size in self._fields()]
        lines = ["typedef struct {", *fields, "} work;", ""]
        forms = (
            "static const double {name}[{count}] = {{\n    {numbers}}};",
            "static const double {name} = {numbers};",
        )
        return "\n".join([*lines, *self._declared(*forms, CFunction.number)])

    def _fortran_types(self) -> str:
        """Return the type of `w` and the constants in Fortran."""
        fields = [f"    real(wp) :: {n}{f'({size})' if size else ''}" for n, size in self._fields()]
        lines = ["type :: work", *fields, "end type work", ""]
        forms = (
            "real(wp), parameter :: {name}({count}) = [ &\n    {numbers}]",
            "real(wp), parameter :: {name} = {numbers}",
        )
        return "\n".join([*lines, *self._declared(*forms, FortranFunction.number, ", &\n    ")])

    def _matlab_work(self) -> str:
        """Return a function that gives `w` in MATLAB."""
        fields = [f"w.{n} = {f'zeros(1, {size})' if size else '0'};" for n, size in self._fields()]
        return "\n".join(["function w = work()", *fields, "end"])

    def python(self) -> str:
        """Return the class of `w`, constants and functions in Python."""
        fields = [
            f"self.{n} = {f'[0.0] * {size}' if size else '0.0'}" for n, size in self._fields()
        ]
        lines = [
            "class Work:",
            "    def __init__(self):",
            *(f"        {f}" for f in fields),
            "",
            "",
        ]
        forms = "{name} = (\n    {numbers},\n)", "{name} = {numbers}"
        lines += self._declared(*forms, _python_number)
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


def _root(node: ast.expr) -> str:
    """Return the name of the array or record of which a node is a part."""
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def _is_stored_part(node: ast.AST) -> TypeGuard[ast.Attribute | ast.Subscript]:
    """Whether a number of an array or record is assigned."""
    return isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store)


def _python_number(value: float) -> str:
    return f"{'-' if value < 0 else ''}math.inf" if math.isinf(value) else repr(value)
