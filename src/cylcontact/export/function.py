"""A compiled function of the package as a function in C, Fortran or MATLAB."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator, Mapping, Sequence
from textwrap import indent, wrap
from typing import Any, ClassVar

import numpy as np

from cylcontact.export.dialects import JOINT_DIALECTS
from cylcontact.export.render import Dialect

_SYMBOLS: Mapping[type[ast.AST], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Mod: "%",
    ast.Gt: ">", ast.GtE: ">=", ast.Lt: "<", ast.LtE: "<=", ast.Eq: "==", ast.NotEq: "!=",
    ast.And: "&&", ast.Or: "||", ast.Not: "!", ast.USub: "-",
}  # fmt: skip


class Function:
    """A function in a language; subclasses have what differs."""

    symbols: ClassVar[Mapping[type[ast.AST], str]] = _SYMBOLS
    names: ClassVar[Mapping[str, str]] = {}
    numbers: ClassVar[Mapping[str, str]]
    dialect: ClassVar[Dialect]
    truths = ("false", "true")
    first, member, end = 0, "->", ""
    item = "{}[{}]"
    if_, else_, end_if = "if ({}) {{", "}} else {{", "}}"
    for_, end_for = "for ({k} = 0; {k} < {count}; {k}++) {{", "}}"
    leave = "break"  # a loop

    def __init__(
        self, tree: ast.FunctionDef, changes: Mapping[str, Sequence[int]], law: str,
        constants: Mapping[str, Any],
    ) -> None:  # fmt: skip
        self.tree, self.changes, self.law, self.constants = tree, changes, law, constants
        self.arguments = {
            a.arg: ast.unparse(a.annotation) if a.annotation else "" for a in tree.args.args
        }
        self.changed = {list(self.arguments)[k] for k in changes[tree.name]}
        self.returns = tree.returns is not None and ast.unparse(tree.returns) != "None"
        self.kinds = {n: "integer" for n, kind in self.arguments.items() if kind == "int"}
        values: dict[str, list[ast.expr]] = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign | ast.AugAssign):
                target = node.targets[0] if isinstance(node, ast.Assign) else node.target
                if isinstance(target, ast.Name):
                    values.setdefault(target.id, []).append(node.value)
            elif isinstance(node, ast.For) and isinstance(node.target, ast.Name):
                values.setdefault(node.target.id, []).append(ast.Constant(0))
        self.locals = [name for name in values if name not in self.arguments]
        for _ in range(2):  # as one may rest on another
            for name in self.locals:
                kinds = {self._kind(value) for value in values[name]}
                self.kinds[name] = kinds.pop() if len(kinds) == 1 else "number"

    @classmethod
    def number(cls, value: float) -> str:
        """Return a number."""
        if math.isinf(value):
            return f"{'-' if value < 0 else ''}{cls.numbers['inf']}"
        return cls.dialect.number(float(value))

    def text(self) -> str:
        """Return the function."""
        raise NotImplementedError

    def _declared(self, form: str, *kinds: str) -> list[str]:
        """Return the declaration of the local variables of some kinds."""
        names = [self._text(ast.Name(n)) for n in self.locals if self.kinds[n] in kinds]
        return [form.format(", ".join(names))] if names else []

    def _kind(self, node: ast.expr) -> str:
        """Return whether an expression is a truth, an integer or a number."""
        match node:
            case ast.Constant(value=bool()) | ast.Compare() | ast.BoolOp():
                return "truth"
            case ast.Constant(value=int()) | ast.Call(func=ast.Name(id="int")):
                return "integer"
            case ast.Name(id=name):
                return self.kinds.get(name, "number")
            case ast.BinOp(left=left, op=op, right=right) if not isinstance(op, ast.Div):
                whole = self._kind(left) == self._kind(right) == "integer"
                return "integer" if whole else "number"
            case ast.IfExp(body=yes, orelse=no) if self._kind(yes) == self._kind(no):
                return self._kind(yes)
        return "number"

    def _lines(self, body: Sequence[ast.stmt]) -> Iterator[str]:
        for node in body:
            match node:
                case ast.Assign(targets=[target], value=value):
                    yield from self._assigned(target, value)
                case ast.AugAssign(target=target, op=op, value=value):
                    yield from self._added(target, op, value)
                case ast.Expr(value=ast.Call() as call):
                    yield f"{self._call(call)}{self.end}"
                case ast.Return():
                    yield from self._returned(node)
                case ast.Break():
                    yield f"{self.leave}{self.end}"
                case ast.If(test=test, body=inside, orelse=other):
                    yield self.if_.format(self._text(test))
                    yield from self._block(inside)
                    if other:
                        yield self.else_.format()
                        yield from self._block(other)
                    yield self.end_if.format()
                case ast.For(target=ast.Name() as k, iter=ast.Call(args=[count]), body=inside):
                    yield self.for_.format(
                        k=self._text(k), count=self._text(count), last=self._shifted(count, -1)
                    )
                    yield from self._block(inside)
                    yield self.end_for.format()
                case _:
                    raise NotImplementedError(ast.unparse(node))

    def _assigned(self, target: ast.expr, value: ast.expr) -> Iterator[str]:
        yield f"{self._text(target)} = {self._text(value)}{self.end}"

    def _added(self, target: ast.expr, op: ast.operator, value: ast.expr) -> Iterator[str]:
        sum_ = f"{self._text(target)} {self.symbols[type(op)]} {self._text(value)}"
        yield f"{self._text(target)} = {sum_}{self.end}"

    def _returned(self, node: ast.Return) -> Iterator[str]:
        if node.value:
            yield f"answer = {self._text(node.value)}{self.end}"
        if node is not self.tree.body[-1]:
            yield f"return{self.end}"

    def _call(self, node: ast.Call) -> str:
        """Return a call as a statement."""
        return self._text(node)

    def _block(self, body: Sequence[ast.stmt]) -> Iterator[str]:
        yield from (indent(line, "    ") for line in self._lines(body))

    def _shifted(self, node: ast.expr, by: int) -> str:
        """Return an integer and a number more."""
        match node:
            case _ if by == 0:
                return self._text(node)
            case ast.Constant(value=int(value)):
                return str(value + by)
            case ast.BinOp(left=ast.Constant(value=int(value)), op=ast.Add(), right=right):
                return f"{value + by} + {self._text(right)}"
        return f"{self._text(node)} {'+' if by > 0 else '-'} {abs(by)}"

    def _literal(self, value: object) -> str:
        if isinstance(value, bool):
            return self.truths[value]
        return self.number(value) if isinstance(value, float) else str(value)

    def _text(self, node: ast.expr) -> str:
        """Return an expression."""
        match node:
            case ast.Constant():
                return self._literal(node.value)
            case ast.Name(id=name):
                return name.lstrip("_")
            case ast.Attribute(value=ast.Name(id="math"), attr=name):
                return self.numbers.get(name, name)
            case ast.Attribute(value=value, attr=name):
                return f"{self._text(value)}{self.member}{name}"
            case ast.Subscript(value=value, slice=at):
                return self.item.format(self._text(value), self._shifted(at, self.first))
        return self._operation(node)

    def _operation(self, node: ast.expr) -> str:
        """Return a call or an operation."""
        match node:
            case ast.Call(func=function, args=args):
                name = self._text(function)
                name = self.law if name == "law_of" else self.names.get(name, name)
                return f"{name}({', '.join(map(self._text, args))})"
            case ast.BinOp(left=left, op=op, right=right):
                text = f"{self._text(left)} {self.symbols[type(op)]} {self._text(right)}"
            case ast.UnaryOp(op=unary, operand=operand):
                text = f"{self.symbols[type(unary)]}{self._text(operand)}"
            case ast.BoolOp(op=either, values=values):
                text = f" {self.symbols[type(either)]} ".join(map(self._text, values))
            case ast.Compare(left=left, ops=[comparison], comparators=[right]):
                text = f"{self._text(left)} {self.symbols[type(comparison)]} {self._text(right)}"
            case _:
                raise NotImplementedError(ast.unparse(node))
        return f"({text})"


class CFunction(Function):
    """A function in C."""

    names: ClassVar[Mapping[str, str]] = {
        "max": "fmax", "min": "fmin", "abs": "fabs", "int": "(int)",
    }  # fmt: skip
    numbers: ClassVar[Mapping[str, str]] = {
        "inf": "(double)INFINITY", "nan": "(double)NAN", "pi": repr(math.pi),
    }  # fmt: skip
    dialect = JOINT_DIALECTS["c"]
    truths = ("0", "1")
    end = ";"

    def text(self) -> str:
        """Return the function."""
        forms = {"float": "double {}", "int": "int {}", "Record": "work *{}"}
        arguments = []
        for name, kind in self.arguments.items():
            array = "double *{}" if name in self.changed else "const double *{}"
            arguments.append(forms.get(kind, array).format(name))
        declared = [
            *self._declared("double {};", "number"), *self._declared("int {};", "integer", "truth")
        ]  # fmt: skip
        body = indent("\n".join([*declared, *self._lines(self.tree.body)]), "    ")
        returned = "double" if self.returns else "void"
        return f"{returned} {self.tree.name}({', '.join(arguments)})\n{{\n{body}\n}}"

    def _added(self, target: ast.expr, op: ast.operator, value: ast.expr) -> Iterator[str]:
        yield f"{self._text(target)} {self.symbols[type(op)]}= {self._text(value)};"

    def _returned(self, node: ast.Return) -> Iterator[str]:
        yield f"return {self._text(node.value)};" if node.value else "return;"

    def _operation(self, node: ast.expr) -> str:
        match node:
            case ast.IfExp(test=test, body=yes, orelse=no):
                return f"({self._text(test)} ? {self._text(yes)} : {self._text(no)})"
        return super()._operation(node)


class _OneBasedFunction(Function):
    """A function in a language without choices as values, with arrays from 1."""

    first, item = 1, "{}({})"

    def _assigned(self, target: ast.expr, value: ast.expr) -> Iterator[str]:
        match value:
            case ast.IfExp(test=test, body=yes, orelse=no):
                yield from self._lines(
                    [ast.If(test, [ast.Assign([target], yes)], [ast.Assign([target], no)])]
                )
            case ast.Call(func=ast.Name(id=name)) if self.changes.get(name):
                yield f"{self._call(value, self._text(target))}{self.end}"
            case _:
                yield from super()._assigned(target, value)

    def _call(self, node: ast.Call, answer: str = "") -> str:
        raise NotImplementedError


class FortranFunction(_OneBasedFunction):
    """A function in Fortran; a subroutine, if it changes arguments."""

    symbols: ClassVar[Mapping[type[ast.AST], str]] = {
        **_SYMBOLS, ast.NotEq: "/=", ast.And: ".and.", ast.Or: ".or.", ast.Not: ".not. ",
    }  # fmt: skip
    names: ClassVar[Mapping[str, str]] = {"copysign": "sign"}
    # Infinity is no constant there, and as good as the largest number.
    numbers: ClassVar[Mapping[str, str]] = {
        "inf": "huge(1.0_wp)", "nan": "ieee_value(1.0_wp, ieee_quiet_nan)",
        "pi": f"{math.pi!r}_wp",
    }  # fmt: skip
    dialect = JOINT_DIALECTS["fortran"]
    truths = (".false.", ".true.")
    member, leave = "%", "exit"
    if_, else_, end_if = "if ({}) then", "else", "end if"
    for_, end_for = "do {k} = 0, {last}", "end do"

    def text(self) -> str:
        """Return the function."""
        forms = {
            "float": "real(wp), value :: {}", "int": "integer, value :: {}",
            "Record": "type(work), intent({intent}) :: {}",
        }  # fmt: skip
        names, declared = list(self.arguments), []
        for name, kind in self.arguments.items():
            form = forms.get(kind, "real(wp), intent({intent}) :: {}(*)")
            declared.append(form.format(name, intent="inout" if name in self.changed else "in"))
        head, what = f"{self.tree.name}({', '.join(names)})", "function"
        if self.changed:
            what = "subroutine"
            if self.returns:
                head = f"{self.tree.name}({', '.join([*names, 'answer'])})"
                declared.append("real(wp), intent(out) :: answer")
        else:
            head += " result(answer)"
            declared.append("real(wp) :: answer")
        declared += self._declared("real(wp) :: {}", "number")
        declared += self._declared("integer :: {}", "integer")
        declared += self._declared("logical :: {}", "truth")
        body = indent("\n".join([*declared, "", *self._lines(self.tree.body)]), "    ")
        text = f"pure {what} {head}\n{body}\nend {what} {self.tree.name}"
        return "\n".join(map(self._broken, text.splitlines()))

    def _broken(self, line: str) -> str:
        """Return a line on several, as a language with 132 columns has them."""
        tab = " " * (len(line) - len(line.lstrip()) + 4)
        lines = wrap(
            line, 100, subsequent_indent=tab, break_long_words=False, break_on_hyphens=False
        )
        return " &\n".join(lines)

    def _call(self, node: ast.Call, answer: str = "") -> str:
        text = self._text(node)
        return f"call {text.removesuffix(')')}, {answer})" if answer else f"call {text}"

    def _operation(self, node: ast.expr) -> str:
        match node:
            case ast.BinOp(left=left, op=ast.Mod(), right=right):
                return f"mod({self._text(left)}, {self._text(right)})"
            case ast.Compare(left=left, ops=[ast.Eq()], comparators=[right]):
                if self._kind(left) == "truth":
                    return f"({self._text(left)} .eqv. {self._text(right)})"
                if self._kind(left) == "number":  # compilers warn of == with them
                    return f"(abs({self._text(left)} - {self._text(right)}) <= 0.0_wp)"
            case ast.Compare(left=left, ops=[ast.NotEq()], comparators=[right]):
                return f"(abs({self._text(left)} - {self._text(right)}) > 0.0_wp)"
        return super()._operation(node)


class MatlabFunction(_OneBasedFunction):
    """A function in MATLAB; it returns the arguments that it changes, behind its answer."""

    symbols: ClassVar[Mapping[type[ast.AST], str]] = {**_SYMBOLS, ast.NotEq: "~=", ast.Not: "~"}
    names: ClassVar[Mapping[str, str]] = {"int": "fix"}
    numbers: ClassVar[Mapping[str, str]] = {"inf": "Inf", "nan": "NaN", "pi": "pi"}
    dialect = JOINT_DIALECTS["matlab"]
    member, end = ".", ";"
    if_, else_, end_if = "if {}", "else", "end"
    for_, end_for = "for {k} = 0:{last}", "end"

    def text(self) -> str:
        """Return the function."""
        names = [name for name in self.arguments if name in self.changed]
        head = f"{self.tree.name}({', '.join(self.arguments)})"
        used = {node.id for node in ast.walk(self.tree) if isinstance(node, ast.Name)}
        constants = []
        for name, value in self.constants.items():
            if name in used:
                numbers = ", ".join(map(self.number, np.atleast_1d(value)))
                constants.append(f"{name} = {f'[{numbers}]' if np.ndim(value) else numbers};")
        left = self._given(names, "answer" if self.returns else "")
        lines = [*constants, *self._lines(self.tree.body)]
        return "\n".join([f"function {left}{head}", *lines, "end"])

    def _given(self, names: Sequence[str], answer: str) -> str:
        """Return the left side of a call."""
        outputs = [answer, *names] if answer else names
        return f"[{', '.join(outputs)}] = " if len(outputs) > 1 else f"{outputs[0]} = "

    def _call(self, node: ast.Call, answer: str = "") -> str:
        assert isinstance(node.func, ast.Name)
        changed = [self._text(node.args[k]) for k in self.changes[node.func.id]]
        return f"{self._given(changed, answer)}{self._text(node)}"

    def _operation(self, node: ast.expr) -> str:
        match node:
            case ast.Call(func=ast.Attribute(attr="copysign"), args=[size, sign]):
                # Of a sign of 0 it would be 0, but bounded ratios are not.
                return f"(abs({self._text(size)}) * sign({self._text(sign)}))"
            case ast.BinOp(left=left, op=ast.Mod(), right=right):
                return f"mod({self._text(left)}, {self._text(right)})"
        return super()._operation(node)
