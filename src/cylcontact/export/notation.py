"""Writes plain functions in C, Fortran and MATLAB; `plain` reads them and has their rules."""

# ruff: noqa: ARG002 - a method takes what one of the languages needs

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from string import Template
from textwrap import indent, wrap
from typing import Any, ClassVar

import numpy as np

from cylcontact.export.plain import Constant, Function, Program, Vector, fields_of
from cylcontact.support.arrays import require

Node = Any  # of a syntax tree, with what `plain` adds to it
WIDTH = 96
_TEMPLATES = Path(__file__).parent / "templates"
# How tightly operators bind, the same in all three.
_CHOICE, _OR, _AND, _COMPARISON, _SUM, _PRODUCT, _POWER, _ATOM = range(8)
_LEVELS = {ast.Add: _SUM, ast.Sub: _SUM, ast.Mult: _PRODUCT, ast.Div: _PRODUCT, ast.Mod: _PRODUCT}
_LEVELS |= {ast.FloorDiv: _PRODUCT}
_LETTERS = {
    "δ": "delta", "ε": "eps", "φ": "phi", "π": "pi", "ω": "omega", "ψ": "psi", "χ": "chi",
    "Δ": "d", "α": "alpha", "β": "beta", "Λ": "Lambda", "κ": "kappa", "ν": "nu", "λ": "lambda",
    "θ": "theta", "σ": "sigma", "μ": "mu", "E*": "E_star", "·": "*", "×": "x", "−": "-", "–": "-",
    "∫": "integral of ", "∂": "d", "√": "sqrt", "≥": ">=", "≤": "<=", "½": "1/2", "⅖": "2/5",
    "⁻¹": "^-1", "²": "^2", "³": "^3", "ⁿ": "^n", "ˣ": "^x", "ₑ": "e", "ₙ": "_n", "₋₁": "_-1",
    "°": " deg",
}  # fmt: skip


class C:
    """C99; other languages override what differs."""

    suffix, comment, end, continued = ".c", "//", ";", ""
    symbols: ClassVar[Mapping[Any, str]] = {
        ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Mod: "%", ast.FloorDiv: "/",
        ast.Gt: ">", ast.GtE: ">=", ast.Lt: "<", ast.LtE: "<=", ast.Eq: "==", ast.NotEq: "!=",
        ast.And: "&&", ast.Or: "||", ast.Not: "!",
    }  # fmt: skip
    names: ClassVar[Mapping[str, str]] = {
        "nan": "(double)NAN", "inf": "(double)INFINITY", "abs": "fabs", "int": "(int)",
    }  # fmt: skip
    kinds: ClassVar[Mapping[Any, str]] = {float: "double", int: "int", bool: "bool"}
    truths = ("false", "true")
    first, item, power, infinity = 0, "{}[{}]", "pow({}, {})", "(double)INFINITY"
    choice, has_choice = "{test} ? {yes} : {no}", True
    if_, else_if, else_, end_if = "if ({}) {{", "}} else if ({}) {{", "}} else {{", "}}"
    while_, end_loop, leave = "while ({}) {{", "}", "break"
    array = "static const double {0}[{1}] = {{{2}}};"
    passes_constants = False
    helpers: ClassVar[Mapping[str, str]] = {
        "larger": "static double larger(double a, double b) { return b > a ? b : a; }",
        "smaller": "static double smaller(double a, double b) { return b < a ? b : a; }",
    }

    def __init__(
        self, program: Program, public: Mapping[Any, str] | None = None, scratch: str = ""
    ) -> None:
        """Take names of public functions and records; `scratch` is a local of public functions."""
        self.program, self.public, self.scratch = program, public or {}, scratch
        # The variables that are declared at a statement; other languages declare them at the top.
        self.starts: dict[int, list[str]] = {}

    # --- a file ---

    def parts(self) -> dict[str, str]:
        """Return what templates ask for: types, constants, helpers and functions."""
        p = self.program
        functions = {f.name: f for f in p.functions.values()}.values()
        program = "\n\n".join(map(self.function, functions))
        types = [self.record(each, fields_of(each)) for each in p.types if self._is_needed(each)]
        numbers = [self.number_of(*each) for each in p.numbers.items()]
        constants = [*filter(None, numbers), *self.constants()]
        helpers = [
            text for name, text in self.helpers.items() if re.search(rf"\b{name}\(", program)
        ]
        parts = {"types": types, "constants": constants, "helpers": helpers, "program": [program]}
        gap = {"types": "\n\n", "helpers": "\n" if self.suffix == ".c" else "\n\n"}
        return {name: gap.get(name, "\n").join(texts) for name, texts in parts.items()}

    def _is_needed(self, kind: Any) -> bool:
        given = {c.kind for fields in self.program.constants.values() for c in fields.values()}
        values = [f for f in self.program.functions.values() if kind in f.arguments.values()]
        names = [a for f in values for a, k in f.arguments.items() if k == kind]
        only_constant = names and all(a in self.program.constants for a in names)
        return kind not in self.public and (kind in given or not only_constant)

    def constants(self) -> Iterator[str]:
        """Yield the constants of joint and law that functions use."""
        for of, fields in self.program.constants.items():
            used = {name: c for name, c in fields.items() if (of, name) in self.program.used}
            if used:
                yield self.constant(of, used)

    def constant(self, of: str, fields: Mapping[str, Constant]) -> str:
        """Return a constant with its fields."""
        heads = [f"{self.declared(name, c.kind)};" for name, c in fields.items()]
        lines = [f"    .{name} = {self.value(c.kind, c.value)}," for name, c in fields.items()]
        remarked = self._remarked(lines, fields.values())
        kinds = "\n".join(self.wrapped(f"    {line}") for line in _merged(heads))
        return "\n".join(["static const struct {", kinds, f"}} {of} = {{", *remarked, "};"])

    def _remarked(self, lines: Sequence[str], constants: Iterable[Constant]) -> list[str]:
        """Return lines of constants, each with its remark."""
        return [
            self.wrapped(line) + (f" {self.comment} {plain_ascii(c.about)}" if c.about else "")
            for line, c in zip(lines, constants, strict=True)
        ]

    def value(self, kind: Any, value: Any) -> str:
        """Return a value of a type."""
        if isinstance(kind, Vector):
            return f"{{{', '.join(map(self.number, value))}}}"
        return str(int(value)) if kind is int else self.number(value)

    def number_of(self, name: str, value: Any) -> str:
        """Return a number of a module, or an array of numbers."""
        if np.ndim(value):
            text = self.array.format(name, len(value), ", ".join(map(self.number, value)))
            return self.wrapped(text)
        kind = int if isinstance(value, int) else float
        return f"static const {self.kinds[kind]} {name} = {self.value(kind, value)};"

    def record(self, kind: Any, fields: Mapping[str, Any]) -> str:
        """Return a type."""
        lines = _merged([f"{self.declared(*each)};" for each in fields.items()])
        inside = "\n".join(self.wrapped(f"    {line}") for line in lines)
        return f"typedef struct {{\n{inside}\n}} {self.type_name(kind)};"

    def type_name(self, kind: Any) -> str:
        """Return the name of a type."""
        if kind in self.kinds:
            return self.kinds[kind]
        return str(self.public.get(kind) or getattr(kind, "__name__", "Work"))

    def declared(self, name: str, kind: Any) -> str:
        """Return the declaration of a variable or field, with spaces where no line is broken."""
        if isinstance(kind, Vector):
            return f"double {name}[{kind.size}]".replace(" ", "\xa0")
        return f"{self.type_name(kind)}\xa0{name}"

    # --- a function ---

    def function(self, f: Function) -> str:
        """Return a function."""
        self.f, self.local = f, {**f.arguments, **f.locals}
        about = [f"{self.comment} {x}" for x in wrap(plain_ascii(f.about), WIDTH - 4)]
        return "\n".join([*about, *self._framed(f)])

    def _framed(self, f: Function) -> Iterator[str]:
        name = self.public.get(f.name)
        yield self.head(f)
        yield "{"
        self.starts = {}
        loops: list[Node] = [n for n in _walk(f.body) if isinstance(n, ast.For)]
        turns = {loop.target.id for loop in loops}
        self._place(f.body, [name for name in f.locals if name not in {*f.arguments, *turns}])
        if self.scratch in f.arguments and name:
            work = self.type_name(f.arguments[self.scratch])
            yield f"    {work} scratch;"
            yield f"    {work} *const {self.scratch} = &scratch;"
        yield from (self.wrapped(f"    {line}") if line else "" for line in self.lines(f.body))
        yield "}"

    def head(self, f: Function) -> str:
        """Return the head of a function, as in its declaration."""
        self.f = f
        given = ", ".join(self._argument(name, kind) for name, kind in self._arguments(f))
        name, scope = (self.public[f.name], "") if f.name in self.public else (f.name, "static ")
        kind = "void" if f.returns is None else self.type_name(f.returns)
        return self.wrapped(f"{scope}{kind} {name}({given})")

    def _arguments(self, f: Function) -> list[tuple[str, Any]]:
        """Return the arguments that are passed."""
        dropped = {*self.program.constants} if not self.passes_constants else set()
        dropped |= f.unused | ({self.scratch} if f.name in self.public else set())
        return [(name, kind) for name, kind in f.arguments.items() if name not in dropped]

    def _argument(self, name: str, kind: Any) -> str:
        constant = "" if name in self.f.changes else "const\xa0"
        if isinstance(kind, Vector):
            size = f"[{kind.size}]" if kind.size else "[]"
            return f"{constant}double\xa0{name}{size}"
        if isinstance(kind, np.dtype):
            return f"{constant}{self.type_name(kind)}\xa0*{name}"
        return self.declared(name, kind)

    def _place(self, block: Sequence[Node], names: Sequence[str]) -> None:
        """Find the statements at which variables are declared, as late as may be."""
        for name in names:
            where = [each for each in block if name in _names(each)]
            inner = [part for part in _blocks(where[0]) if any(name in _names(x) for x in part)]
            heads = {n for each in _heads(where[0]) for n in _names(each)}
            if len(where) == 1 and len(inner) == 1 and name not in heads:
                self._place(inner[0], [name])
            else:
                self.starts.setdefault(id(where[0]), []).append(name)

    def lines(self, body: Sequence[Node]) -> Iterator[str]:
        """Yield statements with their comments."""
        for node in body:
            if getattr(node, "gap", False) and node is not body[0]:
                yield ""
            for words in getattr(node, "remarks", ()):
                yield f"{self.comment} {plain_ascii(words)}"
            yield from self._statement(node)

    def _statement(self, tree: Node) -> Iterator[str]:
        node = tree
        match tree:
            case ast.Assign(targets=[target], value=value):
                yield from self._assigned(node, target, value)
            case ast.AugAssign(target=target, op=op, value=value):
                yield self._added(target, op, value)
            case ast.Expr(value=ast.Call() as call):
                yield self._call(call) + self.end
            case ast.Return(value=value):
                yield from self._returned(node, value)
            case ast.Break():
                yield self.leave + self.end
            case ast.If():
                yield from self._declarations(node)
                yield from self._if(node, self.if_)
            case ast.For(body=body) | ast.While(body=body):
                yield from self._declarations(node)
                is_for = isinstance(node, ast.For)
                yield self._loop(node) if is_for else self.while_.format(self.text(node.test))
                yield from (f"    {line}" for line in self.lines(body))
                yield self.end_loop

    def _declarations(self, node: Node) -> Iterator[str]:
        names = self._starts(node)
        yield from _merged([f"{self.declared(n, self.f.locals[n])};" for n in names])

    def _assigned(self, node: Node, target: Node, value: Node) -> Iterator[str]:
        text = self.text(target)
        if text in self.starts.get(id(node), ()):
            is_once = _stores(self.f.body, text) == 1
            text = ("const " if is_once else "") + self.declared(text, self.f.locals[text])
        yield f"{text} = {self.text(value)}{self.end}"

    def _added(self, target: Node, op: Node, value: Node) -> str:
        return f"{self.text(target)} {self.symbols[type(op)]}= {self.text(value)}{self.end}"

    def _returned(self, node: Node, value: Node) -> Iterator[str]:
        yield f"return {self.text(value)}{self.end}" if value else f"return{self.end}"

    def _if(self, node: Node, head: str) -> Iterator[str]:
        yield head.format(self.text(node.test))
        yield from (f"    {line}" for line in self.lines(node.body))
        match node.orelse:
            case [ast.If() as other] if not (getattr(other, "remarks", ()) or self._starts(other)):
                yield from self._if(other, self.else_if)
                return
            case [_, *_]:
                yield self.else_.format()
                yield from (f"    {line}" for line in self.lines(node.orelse))
        yield self.end_if.format()

    def _starts(self, node: Node) -> Sequence[str]:
        return self.starts.get(id(node), ())

    def _loop(self, node: Node) -> str:
        k, (start, stop), step = node.target.id, map(self.text, node.limits[:2]), _step(node)
        turn = f"{k}++" if step == 1 else f"{k} {'-' if step < 0 else '+'}= {abs(step)}"
        return f"for (int {k} = {start}; {k} {'<' if step > 0 else '>'} {stop}; {turn}) {{"

    def _call(self, node: Node) -> str:
        return self.text(node)

    # --- expressions ---

    def text(self, node: Node) -> str:
        """Return an expression."""
        return self._bound(node)[0]

    def number(self, value: float) -> str:
        """Return a number."""
        if math.isnan(value):
            return self.names["nan"]
        text = self.infinity if math.isinf(value) else self._digits(abs(float(value)))
        return f"-{text}" if value < 0 else text

    def _digits(self, value: float) -> str:
        return repr(value)

    def _bound(self, node: Node) -> tuple[str, int]:  # noqa: C901, PLR0911, PLR0912
        """Return the text of an expression, and how tightly it binds."""
        match node:
            case ast.Constant(value=bool() as truth):
                text = self.truths[truth]
            case ast.Constant(value=int(value)):
                text = str(value)
            case ast.Constant(value=float(value)):
                text = self.number(value)
            case ast.Name(id=name):
                text = self.names.get(name, name) if name in ("nan", "inf") else name
            case ast.Attribute(value=value, attr=name):
                text = f"{self.text(value)}{self._member(value)}{name}"
            case ast.Subscript(value=value, slice=at):
                text = self.item.format(self.text(value), self._shifted(at, self.first))
            case ast.Call():
                text = self._called(node)
            case ast.IfExp(test=test, body=yes, orelse=no):
                a, b, c = (self._above(part, _CHOICE) for part in (test, yes, no))
                text = self.choice.format(test=a, yes=b, no=c)
                return text, _ATOM if self.choice.endswith(")") else _CHOICE
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"-{self._above(operand, _SUM)}", _SUM
            case ast.UnaryOp(op=ast.Not() as op, operand=operand):
                return f"{self.symbols[type(op)]}{self._above(operand, _POWER)}", _COMPARISON
            case ast.Compare(left=x, ops=[op], comparators=[y]):
                a, b = self._above(x, _COMPARISON), self._above(y, _COMPARISON)
                return f"{a} {self._compared(op, x)} {b}", _COMPARISON
            case ast.BoolOp(op=op, values=values):
                symbol = self.symbols[type(op)]
                # & and | of arrays bind more tightly than comparisons.
                least = _COMPARISON if symbol in "&|" else _AND
                text = f" {symbol} ".join(self._above(v, least) for v in values)
                return text, _AND if isinstance(op, ast.And) else _OR
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                if self.power.startswith("pow"):
                    return self.power.format(self.text(left), self.text(right)), _ATOM
                base, exponent = self._above(left, _POWER), self._above(right, _POWER)
                return self.power.format(base, exponent), _POWER
            case ast.BinOp(left=left, op=op, right=right):
                return self._binary(left, op, right)
            case _:
                raise TypeError(ast.unparse(node))  # `plain` refuses it before
        return text, _SUM if text.startswith("-") else _ATOM

    def _binary(self, left: Node, op: Node, right: Node) -> tuple[str, int]:
        level = _LEVELS[type(op)]
        x, y = self._above(left, level - 1), self._above(right, level)
        if level == _PRODUCT and self.text(left).startswith("-"):
            x = self.text(left)
        # Lines break at sums rather than at products.
        gap = "\xa0" if level == _PRODUCT else " "
        text = f"{x}{gap}{self.symbols[type(op)]}{gap}{y}"
        return text, _SUM if x.startswith("-") else level

    def _compared(self, op: Node, _left: Node) -> str:
        return self.symbols[type(op)]

    def _above(self, node: Node, level: int) -> str:
        text, binding = self._bound(node)
        return text if binding > level else f"({text})"

    def _member(self, value: Node) -> str:
        of = value.id if isinstance(value, ast.Name) else ""
        is_constant = of in self.program.constants
        return "->" if not is_constant and isinstance(self.local.get(of), np.dtype) else "."

    def _called(self, node: Node) -> str:
        called = getattr(node, "called", None)
        if called and not isinstance(called, Function):
            return self._made(called, [self.text(each) for each in node.args])
        name = node.func.id if called else self.names.get(node.func.id, node.func.id)
        if name == "fabs" and self.program.type_of(node, self.local) is int:
            name = "abs"
        return f"{name}({', '.join(self._given(node))})"

    def _given(self, node: Node) -> list[str]:
        called = getattr(node, "called", None)
        constants = () if self.passes_constants else self.program.constants
        names = called.arguments if isinstance(called, Function) else [""] * len(node.args)
        unused = called.unused if isinstance(called, Function) else ()
        return [
            self.text(each) for name, each in zip(names, node.args, strict=True)
            if name not in unused and not (isinstance(each, ast.Name) and each.id in constants)
        ]  # fmt: skip

    def _made(self, kind: Any, values: Sequence[str]) -> str:
        return f"({self.type_name(kind)}){{{', '.join(values)}}}"

    def _shifted(self, node: Node, by: int) -> str:
        """Return an integer and a number more."""
        match node:
            case _ if by == 0:
                return self.text(node)
            case ast.Constant(value=int(value)):
                return str(value + by)
            case ast.BinOp(left=ast.Constant(value=int(value)), op=ast.Add(), right=right):
                return f"{value + by} + {self.text(right)}"
        return f"{self.text(node)} {'+' if by > 0 else '-'} {abs(by)}"

    def wrapped(self, line: str) -> str:
        """Return a line, cut between words if it is long."""
        deeper = " " * (len(line) - len(line.lstrip()) + 4)
        if line.lstrip().startswith(self.comment):
            deeper = deeper[:-4] + f"{self.comment} "
        parts = wrap(
            line, WIDTH, subsequent_indent=deeper, break_long_words=False, break_on_hyphens=False
        )
        is_comment = line.lstrip().startswith(self.comment)
        return ("\n" if is_comment else f"{self.continued}\n").join(parts).replace("\xa0", " ")


class Fortran(C):
    """Fortran 2008: what returns nothing is a subroutine."""

    suffix, comment, end, continued = ".f90", "!", "", " &"
    symbols: ClassVar[Mapping[Any, str]] = {
        **C.symbols, ast.And: ".and.", ast.Or: ".or.", ast.Not: ".not. ", ast.NotEq: "/=",
    }  # fmt: skip
    names: ClassVar[Mapping[str, str]] = {
        "nan": "ieee_value(1.0_wp, ieee_quiet_nan)", "copysign": "sign",
        "inf": "huge(1.0_wp)",  # as in constants, which cannot be infinite there
    }  # fmt: skip
    kinds: ClassVar[Mapping[Any, str]] = {float: "real(wp)", int: "integer", bool: "logical"}
    truths = (".false.", ".true.")
    first, item, power, infinity = 1, "{}({})", "{}**{}", "huge(1.0_wp)"
    choice, has_choice = "merge({yes}, {no}, {test})", False
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

    def _digits(self, value: float) -> str:
        return f"{value!r}_wp"

    def type_name(self, kind: Any) -> str:
        """Return the name of a type; case does not tell it from that of a variable."""
        if kind in self.kinds:
            return self.kinds[kind]
        return self.public.get(kind) or f"{super().type_name(kind).lower()}_type"

    def declared(self, name: str, kind: Any, more: str = "") -> str:
        """Return a declaration."""
        size, of = "", self.kinds[float]
        if isinstance(kind, Vector):
            size = f"({kind.size or '*'})"
        else:
            of = self.type_name(kind) if kind in self.kinds else f"type({self.type_name(kind)})"
        return f"{of}{more} :: {name}{size}".replace(" ", "\xa0")

    def constant(self, of: str, fields: Mapping[str, Constant]) -> str:
        """Return a constant: a type whose fields have values."""
        lines = [
            f"    {self.declared(name, c.kind)} = {self.value(c.kind, c.value)}"
            for name, c in fields.items()
        ]
        end = [f"end type {of}_type", f"type({of}_type), parameter :: {of} = {of}_type()"]
        return "\n".join([f"type :: {of}_type", *self._remarked(lines, fields.values()), *end])

    def value(self, kind: Any, value: Any) -> str:
        """Return a value of a type."""
        text = super().value(kind, value)
        return f"[{text[1:-1]}]" if isinstance(kind, Vector) else text

    def number_of(self, name: str, value: Any) -> str:
        """Return a parameter."""
        if np.ndim(value):
            # The standard allows 255 lines for a statement.
            parts = [value[k : k + 600] for k in range(0, len(value), 600)]
            names = [name] if len(parts) == 1 else [f"{name}_{k}" for k in range(len(parts))]
            form = "real(wp), parameter :: {}({}) = [{}]"
            lines = [
                form.format(n, len(part), ", ".join(map(self.number, part)))
                for n, part in zip(names, parts, strict=True)
            ]
            if len(parts) > 1:
                lines.append(form.format(name, len(value), ", ".join(names)))
            return "\n".join(map(self.wrapped, lines))
        kind = int if isinstance(value, int) else float
        return f"{self.kinds[kind]}, parameter :: {name} = {self.value(kind, value)}"

    def record(self, kind: Any, fields: Mapping[str, Any]) -> str:
        """Return a type."""
        name = self.type_name(kind)
        lines = _merged([self.declared(*each) for each in fields.items()], " ::\xa0")
        inside = "\n".join(self.wrapped(f"    {line}") for line in lines)
        return f"type :: {name}\n{inside}\nend type {name}"

    def _framed(self, f: Function) -> Iterator[str]:
        name = self.public.get(f.name, f.name)
        what = "subroutine" if f.returns is None else "function"
        given = ", ".join(name for name, _ in self._arguments(f))
        result = "" if f.returns is None else " result(answer)"
        yield self.wrapped(f"{self.prefix}{what} {name}({given}){result}")
        heads = []
        for key, kind in self._arguments(f):
            more = ", intent(inout)" if key in f.changes else ", intent(in)"
            heads.append(self.declared(key, kind, ", value" if key in f.locals else more))
        if f.returns is not None:
            heads.append(self.declared("answer", f.returns))
        inner = {k: v for k, v in f.locals.items() if k not in f.arguments}
        if self.scratch in f.arguments and f.name in self.public:
            inner[self.scratch] = f.arguments[self.scratch]
        heads += sorted(self.declared(*each) for each in inner.items())
        yield from (self.wrapped(f"    {line}") for line in _merged(heads, " ::\xa0"))
        yield ""
        self.last = f.body[-1]
        yield from (self.wrapped(f"    {line}") if line else "" for line in self.lines(f.body))
        yield f"end {what} {name}"

    def _assigned(self, node: Node, target: Node, value: Node) -> Iterator[str]:
        if isinstance(value, ast.IfExp) and not self.has_choice:
            yes, no = (ast.Assign([target], part) for part in (value.body, value.orelse))
            yield from self._if(ast.If(value.test, [yes], [no]), self.if_)
        else:
            yield f"{self.text(target)} = {self.text(value)}{self.end}"

    def _added(self, target: Node, op: Node, value: Node) -> str:
        return f"{self.text(target)} = {self.text(ast.BinOp(target, op, value))}{self.end}"

    def _returned(self, node: Node, value: Node) -> Iterator[str]:
        if value is not None:
            yield from self._assigned(node, ast.Name("answer"), value)
        if node is not self.last:
            yield f"return{self.end}"

    def _loop(self, node: Node) -> str:
        (start, stop), step = node.limits[:2], _step(node)
        end = self._shifted(stop, -1 if step > 0 else 1)
        return f"do {node.target.id} = {self.text(start)}, {end}" + (
            f", {step}" if step != 1 else ""
        )

    def _call(self, node: Node) -> str:
        return f"call {self.text(node)}"

    def _compared(self, op: Node, left: Node) -> str:
        of_truths = isinstance(op, ast.Eq) and self.program.type_of(left, self.local) is bool
        return ".eqv." if of_truths else self.symbols[type(op)]

    def _binary(self, left: Node, op: Node, right: Node) -> tuple[str, int]:
        if isinstance(op, ast.Mod):
            return f"mod({self.text(left)}, {self.text(right)})", _ATOM
        return super()._binary(left, op, right)

    def _member(self, value: Node) -> str:
        return "%"

    def _made(self, kind: Any, values: Sequence[str]) -> str:
        return f"{self.type_name(kind)}({', '.join(values)})"


class Matlab(Fortran):
    """MATLAB and Octave: a function returns the records that it changes; constants are passed."""

    suffix, comment, end, continued = ".m", "%", ";", " ..."
    symbols: ClassVar[Mapping[Any, str]] = {**C.symbols, ast.NotEq: "~=", ast.Not: "~"}
    names: ClassVar[Mapping[str, str]] = {"nan": "NaN", "inf": "Inf", "int": "fix"}
    truths = ("false", "true")
    power, infinity, choice = "{}^{}", "Inf", "choose({test}, {yes}, {no})"
    if_, else_if, else_, end_if = "if {}", "elseif {}", "else", "end"
    while_, end_loop, leave = "while {}", "end", "break"
    passes_constants = True
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

    def parts(self) -> dict[str, str]:
        """Return the parts; helpers call each other."""
        parts = super().parts()
        if "choose(" in parts["helpers"] and "choose(c" not in parts["helpers"]:
            parts["helpers"] += f"\n\n{self.helpers['choose']}"
        return parts

    def _digits(self, value: float) -> str:
        return repr(value).removesuffix(".0")

    def constant(self, of: str, fields: Mapping[str, Constant]) -> str:
        """Return assignments to the fields of a constant."""
        lines = [f"{of}.{name} = {self.value(c.kind, c.value)};" for name, c in fields.items()]
        return "\n".join(self._remarked(lines, fields.values()))

    def parts_of_zero(self, kind: Any) -> str:
        """Return a record of zeros."""
        zero = {float: "0", int: "0"}
        fields = fields_of(kind).items()
        return self._made(kind, [zero.get(k) or f"zeros(1, {k.size})" for _, k in fields])

    def number_of(self, name: str, value: Any) -> str:
        """Return a function that gives a constant to the whole file."""
        if np.ndim(value):
            numbers = self.wrapped(f"    table = [{', '.join(map(self.number, value))}];")
            body = f"persistent table\nif isempty(table)\n{numbers}\nend\nx = table;"
            return f"function x = {name}(k)\n{body}\nif nargin > 0\n    x = table(k);\nend\nend"
        is_built_in = name == "pi"
        return "" if is_built_in else f"function x = {name}()\nx = {self.number(value)};\nend"

    def record(self, kind: Any, fields: Mapping[str, Any]) -> str:
        """Return nothing: a record is made where it is needed."""
        return ""

    def _framed(self, f: Function) -> Iterator[str]:
        names = [name for name, _ in self._arguments(f)]
        outputs = ["answer"] * (f.returns is not None)
        outputs += [name for name in f.changes if name in names]
        left = outputs[0] if len(outputs) == 1 else f"[{', '.join(outputs)}]"
        yield self.wrapped(f"function {left} = {f.name}({', '.join(names)})")
        if self.scratch in f.arguments and f.name in self.public:
            yield self.wrapped(f"{self.scratch} = {self.parts_of_zero(f.arguments[self.scratch])};")
        self.last = f.body[-1]
        yield from (self.wrapped(line) if line else "" for line in self.lines(f.body))
        yield "end"

    def _assigned(self, node: Node, target: Node, value: Node) -> Iterator[str]:
        called = getattr(value, "called", None)
        if isinstance(called, Function) and called.changes:
            yield self._call(value, self.text(target)) + self.end
        else:
            yield from super()._assigned(node, target, value)

    def _call(self, node: Node, answer: str = "") -> str:
        """Return a call whose changed arguments are assigned."""
        given = dict(zip(node.called.arguments, node.args, strict=True))
        outputs = [answer] * bool(answer) + [self.text(given[n]) for n in node.called.changes]
        left = outputs[0] if len(outputs) == 1 else f"[{', '.join(outputs)}]"
        return f"{left} = {self.text(node)}"

    def _compared(self, op: Node, _left: Node) -> str:
        return self.symbols[type(op)]

    def _loop(self, node: Node) -> str:
        (start, stop), step = node.limits[:2], _step(node)
        end = self._shifted(stop, -1 if step > 0 else 1)
        by = "" if step == 1 else f"{step}:"
        return f"for {node.target.id} = {self.text(start)}:{by}{end}"

    def _binary(self, left: Node, op: Node, right: Node) -> tuple[str, int]:
        if isinstance(op, ast.FloorDiv):
            x, y = self._above(left, _PRODUCT - 1), self._above(right, _PRODUCT)
            return f"floor({x} / {y})", _ATOM
        return super()._binary(left, op, right)

    def _member(self, value: Node) -> str:
        return "."

    def _made(self, kind: Any, values: Sequence[str]) -> str:
        pairs = (f"'{name}', {value}" for name, value in zip(fields_of(kind), values, strict=True))
        return f"struct({', '.join(pairs)})"


class MatlabArrays(Matlab):
    """MATLAB, elementwise; choices are of arrays."""

    symbols: ClassVar[Mapping[Any, str]] = {
        **Matlab.symbols, ast.Mult: ".*", ast.Div: "./", ast.And: "&", ast.Or: "|",
    }  # fmt: skip
    power, has_choice = "{}.^{}", True


# --- syntax ---


def _step(node: Node) -> int:
    return ast.literal_eval(node.limits[2]) if len(node.limits) > 2 else 1


def _names(node: Node) -> set[str]:
    more = getattr(node, "limits", ()) if isinstance(node, ast.For) else ()
    inner = {n for block in _blocks(node) for each in block for n in _names(each)}
    names = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
    return names | inner | {n for each in more for n in _names(each)}


def _blocks(node: Node) -> list[list[Node]]:
    return [
        part for key in ("body", "orelse") if isinstance(part := getattr(node, key, None), list)
    ]


def _heads(node: Node) -> list[Node]:
    heads = [node.test] if isinstance(node, ast.If | ast.While) else []
    return [*heads, *(getattr(node, "limits", ()) if isinstance(node, ast.For) else ())]


def _walk(body: Sequence[Node]) -> Iterator[Node]:
    for each in body:
        yield from ast.walk(each)


def _stores(body: Sequence[Node], name: str) -> int:
    nodes = [n for n in _walk(body) if isinstance(n, ast.Name)]
    return sum(n.id == name and isinstance(getattr(n, "ctx", None), ast.Store) for n in nodes)


def _merged(lines: Sequence[str], after: str = "\xa0") -> list[str]:
    """Return declarations, of one type on one line."""
    merged: list[str] = []
    for line in lines:
        kind, _, name = line.replace(" ", "\xa0").rpartition(after.replace(" ", "\xa0"))
        head = f"{kind}{after.replace(' ', chr(160))}"
        if merged and merged[-1].startswith(head) and "*" not in line:
            merged[-1] = f"{merged[-1].removesuffix(';')}, {name}"
        else:
            merged.append(line)
    return merged


def plain_ascii(text: str) -> str:
    """Return a text in ASCII."""
    for letter, name in _LETTERS.items():
        text = text.replace(letter, name)
    return text.encode("ascii", "ignore").decode()


# --- files ---

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


def filled_template(name: str, parts: Mapping[str, str]) -> str:
    """Return a file of the folder `templates` with its placeholders replaced.

    A placeholder alone on its line may stand for several lines, indented as it is, or for none.
    """
    lines = []
    for line in (_TEMPLATES / name).read_text(encoding="ascii").splitlines(keepends=True):
        if alone := re.fullmatch(r"( *)\$(\w+)\n", line):
            text = parts[alone[2]]
            lines.append(indent(f"{text}\n", alone[1]) if text else "")
        else:
            lines.append(Template(line).substitute(parts))
    return re.sub(r"\n{3,}", "\n\n", "".join(lines))
