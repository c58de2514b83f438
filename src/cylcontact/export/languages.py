"""Writes plain functions in C, Fortran and MATLAB; `plain` reads them and has their rules.

A language is a class of words and shapes. The walk through a function is the same for all, and
records are arguments in every language: the functions of a joint are the same in a file with one
joint and in an FMU.
"""

# ruff: noqa: ARG002 - a method takes what one of the languages needs

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from string import Template
from textwrap import TextWrapper, indent
from typing import Any, ClassVar

import numpy as np

from cylcontact.export.plain import Function, Node, Program, Vector, fields_of
from cylcontact.support.arrays import require

WIDTH = 96
_TEMPLATES = Path(__file__).parent / "templates"
# How tightly operators bind, the same in all three.
_OR, _AND, _NOT, _COMPARISON, _SUM, _PRODUCT, _POWER, _ATOM = range(8)
_LEVELS: dict[type, int] = {
    ast.Add: _SUM, ast.Sub: _SUM, ast.Mult: _PRODUCT,
    ast.Div: _PRODUCT, ast.Mod: _PRODUCT, ast.FloorDiv: _PRODUCT, ast.Pow: _POWER,
}  # fmt: skip


# Infinity and NaN in Fortran, by their bits.
_SPECIAL = {
    "inf": "real(wp), parameter :: inf = transfer(9218868437227405312_bits, 1.0_wp)",
    "nan": "real(wp), parameter :: nan = transfer(9221120237041090560_bits, 1.0_wp)",
}


def template_text(name: str) -> str:
    """Return a file of the folder `templates`."""
    return (_TEMPLATES / name).read_text(encoding="ascii")


def filled(parts: Mapping[str, str], template: str) -> str:
    """Return a template with its placeholders replaced.

    A placeholder alone on its line may stand for several lines, indented as it is, or for none.
    """
    lines = list[str]()
    for line in template_text(template).splitlines():
        if alone := re.fullmatch(r"( *)\$(\w+)", line):
            lines += indent(parts[alone[2]], alone[1]).splitlines()
        else:
            lines.append(Template(line).substitute(parts))
    return "\n".join(lines)


class C:
    """C99; other languages override what differs."""

    suffix, comment, end, continued, first = ".c", "//", ";", "", 0
    symbols: ClassVar[Mapping[Any, str]] = {
        ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "/", ast.Mod: "%",
        ast.Gt: ">", ast.GtE: ">=", ast.Lt: "<", ast.LtE: "<=", ast.Eq: "==", ast.NotEq: "!=",
        ast.And: "&&", ast.Or: "||", ast.Not: "!",
    }  # fmt: skip
    # Calls that other languages write otherwise: what they are with their arguments filled in.
    calls: ClassVar[Mapping[str, str]] = {
        "abs": "fabs({})", "int": "(int)({})", "choose": "({} ? {} : {})", "pow": "pow({}, {})",
    }  # fmt: skip
    names: ClassVar[Mapping[str, str]] = {
        "nan": "(double)NAN", "inf": "(double)INFINITY", "True": "true", "False": "false",
    }  # fmt: skip
    kinds: ClassVar[Mapping[Any, str]] = {float: "double", int: "int", bool: "bool", None: "void"}
    item, vector = "{}[{}]", "{{{}}}"
    if_, else_if, else_, end_if = "if ({}) {{", "}} else if ({}) {{", "}} else {{", "}}"
    while_, end_loop, leave = "while ({}) {{", "}", "break"
    helpers: ClassVar[Mapping[str, str]] = {
        "larger": "static double larger(double a, double b) { return b > a ? b : a; }",
        "smaller": "static double smaller(double a, double b) { return b < a ? b : a; }",
    }

    def __init__(
        self, program: Program, names: Mapping[Any, str] | None = None, public: Sequence[Any] = ()
    ) -> None:
        """Take names of records, and which of them are declared elsewhere."""
        self.program, self.record_names, self.public = program, names or {}, public
        self.local: dict[str, Any] = {}  # the variables of the function that is written

    # --- a file ---

    def parts(self) -> dict[str, str]:
        """Return what templates ask for: types, numbers, helpers and functions."""
        functions = {f.name: f for f in self.program.functions.values()}.values()
        text = "\n\n".join(self.function(f) for f in functions)
        types = [self.record(kind) for kind in self.program.types if kind not in self.public]
        numbers = [self.number_of(*each) for each in self.program.numbers.items()]
        helpers = list[str]()
        for name, helper in self.helpers.items():  # a helper may call one that follows
            if re.search(rf"\b{name}\(", "\n".join([text, *helpers])):
                helpers.append(helper)
        each = {"types": types, "numbers": numbers, "helpers": helpers, "program": [text]}
        gaps = {"numbers": "\n"}
        return {name: gaps.get(name, "\n\n").join(filter(None, x)) for name, x in each.items()}

    def type_name(self, kind: Any) -> str:
        """Return the name of a type."""
        return self.kinds.get(kind) or self.record_names.get(kind) or kind.__name__

    def declared(self, name: str, kind: Any) -> str:
        """Return the declaration of a variable or a field."""
        size = f"[{kind.size}]" if isinstance(kind, Vector) else ""
        return f"{self.type_name(float if size else kind)} {name}{size}"

    def fields(self, kind: Any) -> dict[str, Any]:
        """Return the fields of a record: all that users see, else those that are used."""
        return fields_of(kind) if hasattr(kind, "_fields") else self.program.fields(kind)

    def record(self, kind: Any) -> str:
        """Return a type."""
        lines = (f"    {self.declared(*each)}{self.end}" for each in self.fields(kind).items())
        return "\n".join(["typedef struct {", *lines, f"}} {self.type_name(kind)};"])

    def value(self, value: Any) -> str:
        """Return a number or a vector."""
        if np.ndim(value):
            return self.vector.format(", ".join(map(self.value, value)))
        if isinstance(value, bool | int | np.integer):
            return self.names.get(str(value), str(value))
        text = self.names["inf"] if math.isinf(value) else self.digits(abs(float(value)))
        return self.names["nan"] if math.isnan(value) else f"-{text}" if value < 0 else text

    def digits(self, value: float) -> str:
        """Return a number that is not negative."""
        return repr(value)

    def number_of(self, name: str, value: Any) -> str:
        """Return a number of a module, or an array of numbers."""
        size = f"[{len(value)}]" if np.ndim(value) else ""
        kind = self.kinds.get(type(value), self.kinds[float])
        return f"static const {kind} {name}{size} = {self.value(value)};"

    def local_constant(self, name: str, value: Any) -> str:
        """Return a constant of a function."""
        return self.number_of(name, value).removeprefix("static ")

    def constant(self, name: str, kind: Any, values: Any, about: Mapping[str, str]) -> str:
        """Return a record with the values of the fields that are used, and what they are."""
        lines = [
            f"    .{key} = {self.value(values[key])},{self.remark(about.get(key))}"
            for key in self.fields(kind)
        ]
        return "\n".join([f"static const {self.type_name(kind)} {name} = {{", *lines, "};"])

    def remark(self, words: str | None) -> str:
        """Return a comment at the end of a line."""
        return f" {self.comment} {plain_ascii(words)}" if words else ""

    # --- a function ---

    def function(self, f: Function) -> str:
        """Return a function with its comment."""
        self.local = {**f.arguments, **f.locals}
        about = [f"{self.comment} {plain_ascii(f.about)}"] if f.about else []
        return "\n".join([*about, *self.framed(f)])

    def own(self, f: Function) -> dict[str, Any]:
        """Return the variables that are declared in a function."""
        return {name: kind for name, kind in f.locals.items() if name not in f.arguments}

    def framed(self, f: Function) -> Iterator[str]:
        """Yield the lines of a function."""
        given = ", ".join(self.argument(f, *each) for each in f.arguments.items())
        yield f"static {self.type_name(f.returns)} {f.name}({given})"
        yield "{"
        yield from (f"    {self.declared(*each)};" for each in self.own(f).items())
        yield from (f"    {line}" for line in self.lines(f.body))
        yield "}"

    def argument(self, f: Function, name: str, kind: Any) -> str:
        """Return the declaration of an argument."""
        constant = "" if name in f.changes else "const "
        if isinstance(kind, Vector):
            return f"{constant}double {name}[{kind.size or ''}]"
        pointer = isinstance(kind, np.dtype)
        return f"{constant if pointer else ''}{self.type_name(kind)} {'*' * pointer}{name}"

    def lines(self, body: Sequence[Node]) -> Iterator[str]:
        """Yield statements with their comments."""
        for node in body:
            yield from (f"{self.comment} {plain_ascii(x)}" for x in getattr(node, "remarks", ()))
            yield from self.statement(node)

    def statement(self, node: Node) -> Iterator[str]:
        """Yield the lines of a statement."""
        match node:
            case ast.Assign(targets=[target], value=value):
                yield self.assigned(self.text(target), value) + self.end
            case ast.Expr(value=call):
                yield self.call(call) + self.end
            case ast.Return(value=value):
                yield from self.returned(value)
            case ast.Break():
                yield self.leave + self.end
            case ast.If():
                yield from self.branches(node, self.if_)
            case ast.For():
                yield from self.repeated(self.loop(node), node)
            case ast.While():
                yield from self.repeated(self.while_.format(self.text(node.test)), node)

    def repeated(self, head: str, node: Node) -> Iterator[str]:
        """Yield a loop."""
        yield head
        yield from (f"    {line}" for line in self.lines(node.body))
        yield self.end_loop

    def branches(self, node: Node, head: str) -> Iterator[str]:
        """Yield an `if` with what else there is."""
        yield head.format(self.text(node.test))
        yield from (f"    {line}" for line in self.lines(node.body))
        if len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If):
            yield from self.branches(node.orelse[0], self.else_if)
            return
        if node.orelse:
            yield self.else_.format()
            yield from (f"    {line}" for line in self.lines(node.orelse))
        yield self.end_if.format()

    def assigned(self, target: str, value: Node) -> str:
        """Return an assignment."""
        return f"{target} = {self.text(value)}"

    def returned(self, value: Node | None) -> Iterator[str]:
        """Yield a return."""
        yield f"return {self.text(value)};" if value else "return;"

    def loop(self, node: Node) -> str:
        """Return the head of a loop."""
        k, (start, stop, by) = node.target.id, node.limits
        test = f"{k} {'<' if by > 0 else '>'} {self.text(stop)}"
        return f"for ({k} = {self.text(start)}; {test}; {k} += {by}) {{"

    def call(self, node: Node) -> str:
        """Return a call that is a statement."""
        return self.text(node)

    # --- expressions ---

    def text(self, node: Node) -> str:
        """Return an expression."""
        return self.bound(node)[0]

    def above(self, node: Node, level: int) -> str:
        """Return an expression, in parentheses unless it binds more tightly than a level."""
        text, binding = self.bound(node)
        return text if binding > level else f"({text})"

    def bound(self, node: Node) -> tuple[str, int]:  # noqa: C901, PLR0911
        """Return the text of an expression, and how tightly it binds."""
        match node:
            case ast.Constant(value=value):
                text = self.value(value)
                return text, _SUM if text.startswith("-") else _ATOM
            case ast.Name(id=name):
                return (name if name in self.local else self.names.get(name, name)), _ATOM
            case ast.Attribute(value=value, attr=name):
                return f"{self.text(value)}{self.member(value)}{name}", _ATOM
            case ast.Subscript(value=value, slice=at):
                return self.item.format(self.text(value), self.shifted(at, self.first)), _ATOM
            case ast.Call():
                return self.called(node), _ATOM
            case ast.UnaryOp(op=ast.USub(), operand=x):
                return f"-{self.above(x, _SUM)}", _SUM
            case ast.UnaryOp(operand=x):
                return f"{self.symbols[ast.Not]}{self.above(x, _POWER)}", _NOT
            case ast.Compare(left=x, ops=[op], comparators=[y]):
                return self.compared(x, op, y), _COMPARISON
            case ast.BoolOp(op=op, values=values):
                # `and` inside `or` is in parentheses, which C compilers ask for.
                return f" {self.symbols[type(op)]} ".join(self.above(v, _AND) for v in values), _OR
            case ast.BinOp(op=ast.Pow(), left=x, right=y) if "pow" in self.calls:
                return self.calls["pow"].format(self.text(x), self.text(y)), _ATOM
            case ast.BinOp(op=op, left=x, right=y):
                return self.operation(x, op, y)
        raise TypeError(ast.unparse(node))  # `plain` refuses it before

    def operation(self, x: Node, op: Node, y: Node) -> tuple[str, int]:
        """Return an operation of two numbers."""
        level = _LEVELS[type(op)]
        left = self.above(x, level if level == _POWER else level - 1)
        return f"{left} {self.symbols[type(op)]} {self.above(y, level)}", level

    def compared(self, x: Node, op: Node, y: Node) -> str:
        """Return a comparison."""
        symbol = self.symbols.get((type(op), x.kind)) or self.symbols[type(op)]
        return f"{self.above(x, _COMPARISON)} {symbol} {self.above(y, _COMPARISON)}"

    def member(self, value: Node) -> str:
        """Return what is between a record and its field."""
        return "->" if isinstance(value.kind, np.dtype) else "."

    def called(self, node: Node) -> str:
        """Return a call, or a `NamedTuple` of its values."""
        name, values = node.func.id, [self.text(each) for each in node.args]
        if node.called is None:
            form = "abs({})" if name == "abs" and node.kind is int else self.calls.get(name)
            return form.format(*values) if form else f"{name}({', '.join(values)})"
        if isinstance(node.called, Function):
            return f"{name}({', '.join(values)})"
        return self.made(node.called, dict(zip(fields_of(node.called), values, strict=True)))

    def made(self, kind: Any, values: Mapping[str, str]) -> str:
        """Return a `NamedTuple` of values."""
        return f"({self.type_name(kind)}){{{', '.join(values.values())}}}"

    def shifted(self, node: Node, by: int) -> str:
        """Return a whole number and some more."""
        if isinstance(node, ast.Constant) and isinstance(node.value, int):
            return str(node.value + by)
        return f"{self.text(node)} {'+' if by > 0 else '-'} {abs(by)}" if by else self.text(node)

    def file(self, parts: Mapping[str, str], template: str) -> str:
        """Return a template with its placeholders replaced, in lines that are not too long."""
        lines = filled(parts, template).splitlines()
        text = "\n".join(self.wrapped(line) for line in lines) + "\n"
        return re.sub(r"\n{3,}", "\n\n", text)

    def wrapped(self, line: str) -> str:
        """Return a line, cut between words if it is long; one with a comment behind it stays."""
        if f" {self.comment} " in line.lstrip().removeprefix(f"{self.comment} "):
            return line
        inside = " " * (len(line) - len(line.lstrip()))
        is_comment = line.startswith(f"{inside}{self.comment}")
        deeper, gap = f"{inside}    ", f"{self.continued}\n"
        if is_comment:
            deeper, gap = f"{inside}{self.comment} ", "\n"
        words = TextWrapper(
            WIDTH, subsequent_indent=deeper, break_long_words=False, break_on_hyphens=False
        )
        return gap.join(words.wrap(line))


class Fortran(C):
    """Fortran 2008: what returns nothing is a subroutine."""

    suffix, comment, end, continued, first = ".f90", "!", "", " &", 1
    symbols: ClassVar[Mapping[Any, str]] = {
        **C.symbols, ast.And: ".and.", ast.Or: ".or.", ast.Not: ".not. ", ast.NotEq: "/=",
        ast.Pow: "**", (ast.Eq, bool): ".eqv.",
    }  # fmt: skip
    calls: ClassVar[Mapping[str, str]] = {
        "choose": "merge({1}, {2}, {0})", "copysign": "sign({}, {})"
    }  # fmt: skip
    # nan and inf are parameters in the template.
    names: ClassVar[Mapping[str, str]] = {
        "True": ".true.", "False": ".false.", "nan": "nan", "inf": "inf"
    }  # fmt: skip
    kinds: ClassVar[Mapping[Any, str]] = {float: "real(wp)", int: "integer", bool: "logical"}
    item, vector = "{}({})", "[{}]"
    if_, else_if, else_, end_if = "if ({}) then", "else if ({}) then", "else", "end if"
    while_, end_loop, leave = "do while ({})", "end do", "exit"
    prefix = ""  # or elemental
    helpers: ClassVar[Mapping[str, str]] = {
        name: f"""
elemental function {name}(a, b) result(x)
    real(wp), intent(in) :: a, b
    real(wp) :: x

    x = merge(b, a, b {sign} a)
end function {name}""".lstrip()
        for name, sign in (("larger", ">"), ("smaller", "<"))
    } | {
        # atanh is accurate for small x, however sums are reordered.
        "log1p": """
elemental function log1p(x) result(y)
    real(wp), intent(in) :: x
    real(wp) :: y

    if (abs(x) < 0.5_wp) then
        y = 2.0_wp * atanh(x / (2.0_wp + x))
    else
        y = log(1.0_wp + x)
    end if
end function log1p""".lstrip()
    }

    def file(self, parts: Mapping[str, str], template: str) -> str:
        """Return a file, with the numbers that are no literals if it has them."""
        lines = "\n".join([*parts.values(), template_text(template)]).splitlines()
        code = "\n".join(line.partition("!")[0] for line in lines)
        used = [text for name, text in _SPECIAL.items() if re.search(rf"\b{name}\b", code)]
        bits = ["integer, parameter :: bits = selected_int_kind(18)"] * bool(used)
        return super().file({**parts, "special": "\n".join([*bits, *used])}, template)

    def type_name(self, kind: Any) -> str:
        """Return the name of a type; case does not tell it from that of a variable."""
        name = super().type_name(kind)
        return name if kind in self.kinds or kind in self.public else f"{name.lower()}_type"

    def declared(self, name: str, kind: Any, more: str = "") -> str:
        """Return a declaration."""
        size = f"({kind.size or '*'})" if isinstance(kind, Vector) else ""
        word = self.type_name(float if size else kind)
        return f"{word if size or kind in self.kinds else f'type({word})'}{more} :: {name}{size}"

    def record(self, kind: Any) -> str:
        """Return a type."""
        lines = (f"    {self.declared(*each)}" for each in self.fields(kind).items())
        name = self.type_name(kind)
        return "\n".join([f"type :: {name}", *lines, f"end type {name}"])

    def digits(self, value: float) -> str:
        """Return a number that is not negative."""
        return f"{value!r}_wp"

    def number_of(self, name: str, value: Any) -> str:
        """Return a parameter; the standard allows 255 lines for a statement."""
        if np.size(value) > 600:
            parts = {f"{name}_{k}": value[k : k + 600] for k in range(0, len(value), 600)}
            lines = [self.number_of(*each) for each in parts.items()]
            whole = f"real(wp), parameter :: {name}({len(value)}) = [{', '.join(parts)}]"
            return "\n".join([*lines, whole])
        kind = Vector(len(value)) if np.ndim(value) else int if isinstance(value, int) else float
        return f"{self.declared(name, kind, ', parameter')} = {self.value(value)}"

    def constant(self, name: str, kind: Any, values: Any, about: Mapping[str, str]) -> str:
        """Return a parameter, a field to a line."""
        keys = [*self.fields(kind)]
        lines = [
            f"    {key} = {self.value(values[key])}{',' if key != keys[-1] else ''} &"
            f"{self.remark(about.get(key))}"
            for key in keys
        ]
        head = f"type({self.type_name(kind)}), parameter :: {name} = {self.type_name(kind)}( &"
        return "\n".join([head, *lines, "    )"])

    def framed(self, f: Function) -> Iterator[str]:
        """Yield the lines of a function or a subroutine."""
        what, result = ("function", " result(answer)") if f.returns else ("subroutine", "")
        yield f"{self.prefix}{what} {f.name}({', '.join(f.arguments)}){result}"
        for name, kind in f.arguments.items():
            intent = ", intent(inout)" if name in f.changes else ", intent(in)"
            yield f"    {self.declared(name, kind, ', value' if name in f.locals else intent)}"
        answer = {"answer": f.returns} if f.returns else {}
        yield from (f"    {self.declared(*each)}" for each in (answer | self.own(f)).items())
        yield ""
        yield from (f"    {line}" for line in self.lines(f.body))
        yield f"end {what} {f.name}"

    def returned(self, value: Node | None) -> Iterator[str]:
        """Yield the answer, and a return except at the end of a function."""
        if value is not None:
            yield self.assigned("answer", value) + self.end
        yield f"return{self.end}"

    def loop(self, node: Node) -> str:
        """Return the head of a loop, whose end is included."""
        start, stop, by = node.limits
        end = self.shifted(stop, -1 if by > 0 else 1)
        return f"do {node.target.id} = {self.text(start)}, {end}, {by}"

    def call(self, node: Node) -> str:
        """Return a call that is a statement."""
        return f"call {self.text(node)}"

    def operation(self, x: Node, op: Node, y: Node) -> tuple[str, int]:
        """Return an operation of two numbers."""
        if isinstance(op, ast.Mod):
            return f"mod({self.text(x)}, {self.text(y)})", _ATOM
        return super().operation(x, op, y)

    def member(self, value: Node) -> str:
        """Return what is between a record and its field."""
        return "%"

    def made(self, kind: Any, values: Mapping[str, str]) -> str:
        """Return a `NamedTuple` of values."""
        return f"{self.type_name(kind)}({', '.join(values.values())})"


class Matlab(Fortran):
    """MATLAB and Octave: a function returns the records that it changes."""

    suffix, comment, end, continued = ".m", "%", ";", " ..."
    symbols: ClassVar[Mapping[Any, str]] = {
        **C.symbols, ast.NotEq: "~=", ast.Not: "~", ast.Pow: "^"
    }  # fmt: skip
    calls: ClassVar[Mapping[str, str]] = {"int": "fix({})"}
    names: ClassVar[Mapping[str, str]] = {
        "nan": "NaN", "inf": "Inf", "True": "true", "False": "false"
    }  # fmt: skip
    if_, else_if, else_, end_if = "if {}", "elseif {}", "else", "end"
    while_, end_loop, leave = "while {}", "end", "break"
    helpers: ClassVar[Mapping[str, str]] = {
        name: f"function x = {name}(a, b)\nx = choose(b {sign} a, b, a);\nend"
        for name, sign in (("larger", ">"), ("smaller", "<"))
    } | {
        "copysign": """
function x = copysign(size, sign_of)
x = abs(size) .* (1 - 2 * (sign_of < 0));
end""".lstrip(),
        "choose": """
function x = choose(condition, yes, no)
% Elementwise: yes where the condition holds, no elsewhere.
condition = condition & true(size(yes + no));
x = no + zeros(size(condition));
yes = yes + zeros(size(condition));
x(condition) = yes(condition);
end""".lstrip(),
    }

    def record(self, kind: Any) -> str:
        """Return nothing: a record is made where it is needed."""
        return ""

    def digits(self, value: float) -> str:
        """Return a number that is not negative."""
        return repr(value).removesuffix(".0")

    def number_of(self, name: str, value: Any) -> str:
        """Return a function that gives a constant to the whole file."""
        if not np.ndim(value):
            return "" if name == "pi" else f"function x = {name}()\nx = {self.value(value)};\nend\n"
        table = f"persistent table\nif isempty(table)\n    table = {self.value(value)};\nend"
        element = "x = table;\nif nargin > 0\n    x = table(k);\nend"
        return f"function x = {name}(k)\n{table}\n{element}\nend\n"

    def local_constant(self, name: str, value: Any) -> str:
        """Return a constant of a function."""
        return f"{name} = {self.value(value)};"

    def constant(self, name: str, kind: Any, values: Any, about: Mapping[str, str]) -> str:
        """Return assignments to the fields of a record."""
        return "\n".join(
            f"{name}.{key} = {self.value(values[key])};{self.remark(about.get(key))}"
            for key in self.fields(kind)
        )

    def zeros(self, kind: Any) -> str:
        """Return a record of zeros."""
        parts = self.fields(kind).items()
        zeros = {n: f"zeros(1, {k.size})" if isinstance(k, Vector) else "0" for n, k in parts}
        return self.made(kind, zeros)

    def framed(self, f: Function) -> Iterator[str]:
        """Yield the lines of a function."""
        yield f"function {self.outputs(f)} = {f.name}({', '.join(f.arguments)})"
        yield from self.lines(f.body)
        yield "end"

    def outputs(self, f: Function, answer: str = "answer", given: Sequence[Any] = ()) -> str:
        """Return what a function gives back, by the names of its arguments or of those given."""
        names = dict(zip(f.arguments, given or f.arguments, strict=True))
        changed = [names[name] for name in f.arguments if name in f.changes]
        left = [answer, *changed] if f.returns else changed
        return left[0] if len(left) == 1 else f"[{', '.join(left)}]"

    def assigned(self, target: str, value: Node) -> str:
        """Return an assignment, with the records that a call changes."""
        f = getattr(value, "called", None)
        if isinstance(f, Function) and f.changes:
            target = self.outputs(f, target, [self.text(each) for each in value.args])
        return super().assigned(target, value)

    def call(self, node: Node) -> str:
        """Return a call that is a statement."""
        return self.assigned("", node)

    def loop(self, node: Node) -> str:
        """Return the head of a loop."""
        start, stop, by = node.limits
        end = self.shifted(stop, -1 if by > 0 else 1)
        return f"for {node.target.id} = {self.text(start)}:{by}:{end}"

    def operation(self, x: Node, op: Node, y: Node) -> tuple[str, int]:
        """Return an operation of two numbers."""
        if isinstance(op, ast.FloorDiv):
            return f"floor({self.above(x, _PRODUCT - 1)} / {self.above(y, _PRODUCT)})", _ATOM
        return super().operation(x, op, y)

    def member(self, value: Node) -> str:
        """Return what is between a record and its field."""
        return "."

    def made(self, kind: Any, values: Mapping[str, str]) -> str:
        """Return a `NamedTuple` of values."""
        pairs = (f"'{name}', {value}" for name, value in values.items())
        return f"struct({', '.join(pairs)})"


class MatlabArrays(Matlab):
    """MATLAB, elementwise."""

    symbols: ClassVar[Mapping[Any, str]] = {
        **Matlab.symbols, ast.Mult: ".*", ast.Div: "./", ast.And: "&", ast.Or: "|", ast.Pow: ".^",
    }  # fmt: skip

    def bound(self, node: Node) -> tuple[str, int]:
        """Return an expression; & and | of arrays bind more tightly than comparisons."""
        if isinstance(node, ast.BoolOp):
            symbol = self.symbols[type(node.op)]
            text = f" {symbol} ".join(self.above(v, _COMPARISON) for v in node.values)
            return f"({text})", _ATOM
        return super().bound(node)


LANGUAGES: dict[str, type[C]] = {"c": C, "fortran": Fortran, "matlab": Matlab}
_LETTERS = {
    "δ": "delta", "ε": "eps", "φ": "phi", "π": "pi", "ω": "omega", "ψ": "psi", "χ": "chi",
    "Δ": "d", "α": "alpha", "β": "beta", "Λ": "Lambda", "κ": "kappa", "ν": "nu", "λ": "lambda",
    "θ": "theta", "σ": "sigma", "μ": "mu", "E*": "E_star", "·": "*", "×": "x", "−": "-", "–": "-",
    "∫": "integral of ", "∂": "d", "√": "sqrt", "≥": ">=", "≤": "<=", "½": "1/2", "⅖": "2/5",
    "⁻¹": "^-1", "²": "^2", "³": "^3", "ⁿ": "^n", "ˣ": "^x", "ₑ": "e", "ₙ": "_n", "₋₁": "_-1",
    "°": " deg",
}  # fmt: skip


def plain_ascii(text: str) -> str:
    """Return a text in ASCII."""
    for letter, name in _LETTERS.items():
        text = text.replace(letter, name)
    return text.encode("ascii", "ignore").decode()


# Words of MATLAB that cannot name a function.
_MATLAB = """
break case catch classdef continue else elseif end for function global if otherwise parfor
persistent return spmd switch try while
"""


def require_callable(target: str, stem: str) -> None:
    """Refuse the name of a file that MATLAB calls by that name, and cannot."""
    good = stem.isascii() and stem.isidentifier() and stem[0] != "_" and stem not in _MATLAB.split()
    rule, remedy = "cannot be called by its name", "name it with letters, digits and underscores"
    require(good or target != "matlab", "export", "--out", stem, rule, remedy)
