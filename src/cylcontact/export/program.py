"""Compiled functions of the package in other languages, read from their own source.

The functions keep to assignments, choices, loops, calls, numbers, arrays of numbers, tuples, and
one record `w` that they change. The numbers of the record `joint` become constants; the law, a
call.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from cylcontact.export.language import LANGUAGES


@dataclass(frozen=True)
class Program:
    """Functions in the order in which they call each other, and the numbers that they use.

    `functions` are compiled by numba, the fields of the record `joint` become constants, `work` is
    the type of the record `w`. `law` is the function of the law, and `numbers` has its constants.
    """

    functions: Sequence[Callable[..., Any]]
    joint: Any
    work: np.dtype[Any]
    law: ast.FunctionDef
    numbers: Mapping[str, Any]

    def parts(self, target: str) -> dict[str, str]:
        """Return fields of `w`, constants and functions, for a language's template."""
        language = LANGUAGES[target](changes=self._changes, tuples=self._tuples)
        sizes = {name: self.work[name].shape for name in self.work.names or ()}
        gap = "\n\n\n" if target == "python" else "\n\n"
        return {
            "work": "\n".join(
                language.work["array" if size else "number"].format(name, *size)
                for name, size in sizes.items()
            ),
            "constants": language.constants(self._constants),
            "program": gap.join(language.function(tree, self._constants) for tree in self._trees),
        }

    @property
    def names(self) -> set[str]:
        """The names that it takes in the file."""
        return {"work", *(tree.name for tree in self._trees)}

    @property
    def _uncompiled(self) -> list[Any]:
        return [getattr(function, "py_func", function) for function in self.functions]

    @cached_property
    def _trees(self) -> list[ast.FunctionDef]:
        trees = [self.law]
        for function in self._uncompiled:
            tree = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
            assert isinstance(tree, ast.FunctionDef)
            tree = ast.fix_missing_locations(_Plain(function.__globals__, self.joint).visit(tree))
            tree.decorator_list = []
            trees.append(tree)
        return trees

    @cached_property
    def _constants(self) -> dict[str, Any]:
        """Numbers and arrays by name, those that the functions use."""
        own = {f"joint_{name}": self.joint[name] for name in self.joint.dtype.names}
        arrays = {
            name: value
            for function in self._uncompiled for name, value in function.__globals__.items()
            if isinstance(value, np.ndarray)
        }  # fmt: skip
        used = {n.id for tree in self._trees for n in ast.walk(tree) if isinstance(n, ast.Name)}
        known = {**own, **arrays, **self.numbers}
        return {name: value for name, value in known.items() if name in used}

    @cached_property
    def _changes(self) -> dict[str, list[int]]:
        """The places of the arrays and of `w` among a function's arguments that it changes."""
        changes: dict[str, list[int]] = {}
        for tree in self._trees:
            names = [a.arg for a in tree.args.args]
            stored = {
                _root(node) for node in ast.walk(tree)
                if isinstance(node, ast.Attribute | ast.Subscript)
                and isinstance(node.ctx, ast.Store)
            }  # fmt: skip
            for node in ast.walk(tree):
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                    stored |= {_root(node.args[k]) for k in changes.get(node.func.id, ())}
            changes[tree.name] = [k for k, name in enumerate(names) if name in stored]
        return changes

    @cached_property
    def _tuples(self) -> dict[str, int]:
        """The length of what a function returns, of those that return several numbers."""
        return {
            tree.name: len(node.value.elts)
            for tree in self._trees for node in ast.walk(tree)
            if isinstance(node, ast.Return) and isinstance(node.value, ast.Tuple)
        }  # fmt: skip


class _Plain(ast.NodeTransformer):
    """Constants and the law by name, without the records of joint and law as arguments.

    Integers of the joint, which choose between branches, are put in.
    """

    def __init__(self, module: Mapping[str, Any], joint: Any) -> None:
        self.module, self.joint = module, joint

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        node.args.args = [a for a in node.args.args if a.arg not in ("joint", "law")]
        self.own = {a.arg for a in node.args.args}
        self.own |= {
            n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
        }
        node.body = node.body[1:]  # the first is the docstring
        node.name = _name(node.name)
        self.generic_visit(node)
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        if isinstance(node.value, ast.Name) and node.value.id == "joint":
            value = self.joint[node.attr]
            if isinstance(value, np.integer):
                return ast.Constant(int(value))
            return ast.Name(f"joint_{node.attr}", node.ctx)
        return node

    def visit_Name(self, node: ast.Name) -> ast.expr:
        number = None if node.id in self.own else self.module.get(node.id)
        return ast.Constant(number) if isinstance(number, int | float) else node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        if isinstance(node.func, ast.Name):
            if node.func.id == "inlined_load":
                return ast.Call(ast.Name("law"), [self.visit(node.args[2])], [])
            if node.func.id == "float":
                inside: ast.expr = self.visit(node.args[0])
                return inside
            node.func.id = _name(node.func.id)
        args = [a for a in node.args if not (isinstance(a, ast.Name) and a.id in ("joint", "law"))]
        node.args = [self.visit(a) for a in args]
        return node

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        self.generic_visit(node)
        match node:
            case ast.Compare(ast.Constant(value=x), [ast.Eq()], [ast.Constant(value=y)]):
                return ast.Constant(x == y)
        return node

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        self.generic_visit(node)
        neutral = isinstance(node.op, ast.And)
        known = [v.value for v in node.values if isinstance(v, ast.Constant)]
        if (not neutral) in known:
            return ast.Constant(not neutral)
        node.values = [v for v in node.values if not isinstance(v, ast.Constant)]
        return node if len(node.values) > 1 else node.values[0]

    def visit_If(self, node: ast.If) -> ast.stmt | list[ast.stmt]:
        self.generic_visit(node)
        if isinstance(node.test, ast.Constant):
            return node.body if node.test.value else node.orelse
        return node


def _name(function: str) -> str:
    """Return the name of a function in a file that has an `evaluate` and an `accept` of its own."""
    return {"evaluate": "wrench_of", "accept": "next_rates"}.get(function, function)


def _root(node: ast.expr) -> str:
    """Return the name of the array or record of which a node is a part."""
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""
