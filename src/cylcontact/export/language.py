"""The notation of each language, for Python's syntax: expressions, statements and functions.

They are functions of the package that numba compiles (`cylcontact.export.program`).
"""

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

from cylcontact.support.arrays import require
from cylcontact.support.plain_text import RESERVED

WIDTH = 90
_TEMPLATES = Path(__file__).parent / "templates"
# Operator precedence, the same in all languages.
_CHOICE, _OR, _AND, _COMPARISON, _SUM, _PRODUCT, _POWER, _ATOM = range(8)
_Symbols = Mapping[type[ast.AST], str]
_Names = Mapping[str, str]


class Language:
    """Statements in C; other languages have what differs.

    `names` are added to those of the language. `changes` has the places of the arguments that a
    function changes, and `tuples` the length of what it returns, by the name of the function.
    """

    comment, continued, end = "//", "", ";"
    symbols: ClassVar[_Symbols] = {
        ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Mod: "%",
        ast.Gt: ">", ast.GtE: ">=", ast.Lt: "<", ast.LtE: "<=", ast.Eq: "==", ast.NotEq: "!=",
        ast.And: "&&", ast.Or: "||", ast.Not: "!",
    }  # fmt: skip
    names: ClassVar[_Names] = {
        "nan": "(double)NAN", "inf": "(double)INFINITY", "max": "fmax", "min": "fmin",
        "abs": "fabs", "int": "(int)", "float": "(double)",
    }  # fmt: skip
    truths = ("0", "1")
    infinity = "(double)INFINITY"  # as a constant
    power = "pow({x}, {y})"
    modulo = "({x} % {y})"
    choice = "{test} ? {yes} : {no}"
    is_choice_a_statement = False
    first, item, member = 0, "{}[{}]", "->"
    linkage = "static"  # of functions
    constant, array = "static const double {} = {};", "static const double {0}[{1}] = {{{2}}};"
    # Declarations of variables and of a record's fields, fields of the record `w`, and how results
    # of an element get its values.
    kinds: ClassVar[_Names] = {
        "number": "double {};", "integer": "int {};", "truth": "int {};", "array": "double {}[{}];",
    }  # fmt: skip
    work: ClassVar[_Names] = kinds
    results: ClassVar[_Names] = {
        "number": "wrench->{0} = w.{0};", "array": "wrench->{0}[{1}] = w.{0}[{1}];",
        "integer": "wrench->{0} = (int)w.{0};",
    }  # fmt: skip
    is_answer_returned = True  # or assigned, to `answer`
    if_, else_, end_if = "if ({}) {{", "}} else {{", "}}"
    for_ = "for ({k} = {start}; {k} {before} {stop}; {k} += {step}) {{"
    end_for, leave = "}}", "break"
    # Functions that the language lacks.
    helpers: ClassVar[_Names] = {}

    def __init__(
        self, names: _Names | None = None, changes: Mapping[str, Sequence[int]] | None = None,
        tuples: Mapping[str, int] | None = None,
    ) -> None:  # fmt: skip
        self.own = {**self.names, **(names or {})}
        self.changes, self.tuples = changes or {}, tuples or {}
        self.kind_of: dict[str, str] = {}

    def number(self, value: float) -> str:
        """Return a number."""
        sign, size = "-" if value < 0 else "", abs(float(value))
        return sign + (self.infinity if math.isinf(size) else self._digits(size))

    def _digits(self, value: float) -> str:
        return repr(value)

    def constants(self, numbers: Mapping[str, Any]) -> str:
        """Return constants, one a line."""
        return "\n".join(self.wrapped(line) for line in self._constants(numbers))

    def _constants(self, numbers: Mapping[str, Any]) -> Iterator[str]:
        for name, value in numbers.items():
            if np.ndim(value):
                yield from self._array(name, [self.number(x) for x in value])
            else:
                yield self.constant.format(name, self.number(value))

    def _array(self, name: str, numbers: Sequence[str]) -> Iterator[str]:
        yield self.array.format(name, len(numbers), ", ".join(numbers))

    def formula(self, text: str) -> str:
        """Return an expression of a law, given in Python's syntax."""
        return self.text(_Floats().visit(ast.parse(text, mode="eval")).body)

    def helpers_of(self, text: str) -> str:
        """Return the definitions of the functions that a text calls and the language lacks."""
        called = (code for name, code in self.helpers.items() if re.search(rf"\b{name}\(", text))
        return "\n".join(called)

    def wrapped(self, line: str) -> str:
        """Return a line, cut between words if it is long."""
        deeper = " " * (len(line) - len(line.lstrip()) + 4)
        parts = wrap(
            line, WIDTH, subsequent_indent=deeper, break_long_words=False, break_on_hyphens=False
        )
        return f"{self.continued}\n".join(parts)

    # --- a function ---

    def function(self, tree: ast.FunctionDef, constants: Mapping[str, Any]) -> str:
        """Return a function, which uses some of the constants."""
        self.name, given = tree.name, [(a.arg, a.annotation) for a in tree.args.args]
        self.arguments = {name: ast.unparse(kind) if kind else "" for name, kind in given}
        self.changed = [list(self.arguments)[k] for k in self.changes[tree.name]]
        self.returns = tree.returns is not None and ast.unparse(tree.returns) != "None"
        apart = _Apart(self.tuples)
        body = apart.visit(ast.parse(ast.unparse(tree)).body[0]).body
        self.last = body[-1]
        self.kind_of = {name: "integer" for name, kind in self.arguments.items() if kind == "int"}
        self._learn(body, self.arguments)
        arrays = (self.kinds["array"].format(*about) for about in apart.arrays.items())
        used = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        self.own_constants = {name: value for name, value in constants.items() if name in used}
        lines = self._framed([*self._declared(), *arrays], [*self._lines(body)])
        return "\n".join(map(self.wrapped, lines))

    def _framed(self, declared: Sequence[str], body: Sequence[str]) -> Iterator[str]:
        """Yield the lines of the function at hand, with declarations and statements."""
        forms = {"float": "double {}", "int": "int {}", "Record": "work *{}"}
        given = [
            forms.get(kind, "double *{}" if key in self.changed else "const double *{}").format(key)
            for key, kind in self.arguments.items()
        ]
        given += ["double *answer"] if self.name in self.tuples else []
        kind = "double" if self.returns and self.name not in self.tuples else "void"
        yield f"{self.linkage} {kind} {self.name}({', '.join(given)})"
        yield "{"
        yield from (f"    {line}" for line in (*declared, *body))
        yield "}"

    def _learn(self, body: Sequence[ast.stmt], arguments: Iterable[str] = ()) -> None:
        """Find the kinds of the names that statements assign."""
        values: dict[str, list[ast.expr]] = {}
        for node in (each for statement in body for each in ast.walk(statement)):
            match node:
                case (
                    ast.Assign(targets=[ast.Name(id=name)], value=value)
                    | ast.AugAssign(target=ast.Name(id=name), value=value)
                ):
                    values.setdefault(name, []).append(value)
                case ast.For(target=ast.Name(id=name)):
                    values.setdefault(name, []).append(ast.Constant(0))
        self.locals = [name for name in values if name not in arguments]
        for _ in range(2):  # as one may rest on another
            for name in self.locals:
                kinds = {self._kind(value) for value in values[name]}
                self.kind_of[name] = kinds.pop() if len(kinds) == 1 else "number"

    def _kind(self, node: ast.expr) -> str:
        """Return whether an expression is a truth, an integer, a number or a tuple."""
        match node:
            case ast.Constant(value=value):
                return {bool: "truth", int: "integer"}.get(type(value), "number")
            case ast.Call(func=ast.Name(id=name)):
                return "integer" if name == "int" else "tuple" if name in self.tuples else "number"
            case ast.Name(id=name):
                return self.kind_of.get(name, "number")
            case ast.BinOp(left=left, op=op, right=right) if not isinstance(op, ast.Div):
                whole = self._kind(left) == self._kind(right) == "integer"
                return "integer" if whole else "number"
            case ast.IfExp(body=yes, orelse=no) if self._kind(yes) == self._kind(no):
                return self._kind(yes)
        return "truth" if isinstance(node, ast.Compare | ast.BoolOp) else "number"

    def _declared(self) -> Iterator[str]:
        """Yield the declarations of the local variables."""
        for kind, form in self.kinds.items():
            names = [self.text(ast.Name(n)) for n in self.locals if self.kind_of[n] == kind]
            if names:
                yield form.format(", ".join(names))

    # --- statements ---

    def _lines(self, body: Sequence[ast.stmt]) -> Iterator[str]:
        for node in body:
            match node:
                case ast.Assign(targets=[target], value=value):
                    yield from self._assigned(target, value)
                case ast.AugAssign(target=target, op=op, value=value):
                    yield from self._assigned(target, ast.BinOp(target, op, value))
                case ast.Expr(value=ast.Call() as call):
                    yield f"{self._call(call)}{self.end}"
                case ast.Return():
                    yield from self._returned(node)
                case ast.Break():
                    yield f"{self.leave}{self.end}"
                case ast.If() | ast.For():
                    yield from self._nested(node)
                case _:
                    raise NotImplementedError(ast.unparse(node))

    def _nested(self, node: ast.If | ast.For) -> Iterator[str]:
        if isinstance(node, ast.For):
            assert isinstance(node.iter, ast.Call)
            yield self._loop(self.text(node.target), node.iter.args)
        else:
            yield self.if_.format(self.text(node.test))
        yield from (f"    {line}" for line in self._lines(node.body))
        if node.orelse:
            yield self.else_.format()
            yield from (f"    {line}" for line in self._lines(node.orelse))
        yield (self.end_for if isinstance(node, ast.For) else self.end_if).format()

    def _assigned(self, target: ast.expr, value: ast.expr) -> Iterator[str]:
        match value:
            case ast.IfExp(test=test, body=yes, orelse=no) if self.is_choice_a_statement:
                yield from self._lines(
                    [ast.If(test, [ast.Assign([target], yes)], [ast.Assign([target], no)])]
                )
            case ast.Call(func=ast.Name(id=name)) if self.changes.get(name) or name in self.tuples:
                yield f"{self._call(value, self.text(target))}{self.end}"
            case _:
                yield f"{self.text(target)} = {self.text(value)}{self.end}"

    def _returned(self, node: ast.Return) -> Iterator[str]:
        if node.value is not None and self.is_answer_returned:
            yield f"return {self.text(node.value)}{self.end}"
            return
        if node.value is not None:
            yield f"answer = {self.text(node.value)}{self.end}"
        if node is not self.last:
            yield f"return{self.end}"

    def _call(self, node: ast.Call, answer: str = "") -> str:
        """Return a call as a statement, with the variable for what it returns."""
        text = self.text(node)
        if answer and ast.unparse(node.func) not in self.tuples:
            return f"{answer} = {text}"
        return f"{text.removesuffix(')')}, {answer})" if answer else text

    def _loop(self, k: str, limits: Sequence[ast.expr]) -> str:
        """Return the head of a loop."""
        before = [ast.Constant(0)] if len(limits) == 1 else []
        start, stop, step = [*before, *limits, ast.Constant(1)][:3]
        down = ast.unparse(step).startswith("-")
        return self.for_.format(
            k=k, start=self.text(start), stop=self.text(stop), step=self.text(step),
            before=">" if down else "<", last=self._shifted(stop, 1 if down else -1),
        )  # fmt: skip

    # --- expressions ---

    def text(self, node: ast.expr) -> str:
        """Return an expression."""
        return self._bound(node)[0]

    def _bound(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of an expression, and its precedence."""
        match node:
            case ast.Constant(value=bool() as truth):
                text = self.truths[truth]
            case ast.Constant(value=int() | float() as value):
                text = str(value) if isinstance(value, int) else self.number(value)
            case ast.Name(id=name):
                text = self.own.get(name, name.lstrip("_"))
            case ast.Attribute(value=ast.Name(id="math"), attr=name):
                constants = {"pi": self.own.get("pi", self.number(math.pi)), "inf": self.infinity}
                text = constants.get(name) or self.own.get(name, name)
            case ast.Attribute(value=value, attr=name):
                text = f"{self.text(value)}{self.member}{name}"
            case ast.Subscript(value=value, slice=at):
                text = self.item.format(self.text(value), self._shifted(at, self.first))
            case ast.Call(func=function, args=args):
                text = f"{self.text(function)}({', '.join(map(self.text, args))})"
            case ast.IfExp(test=test, body=yes, orelse=no):
                a, b, c = (self._above(part, _CHOICE) for part in (test, yes, no))
                text = self.choice.format(test=a, yes=b, no=c)
                return text, _ATOM if self.choice.endswith(")") else _CHOICE
            case _:
                return self._operation(node)
        return text, _SUM if text.startswith("-") else _ATOM

    def _operation(self, node: ast.expr) -> tuple[str, int]:
        """Return the text of an operation, and its precedence."""
        match node:
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                # As a sum, because Fortran does not allow two operators in a row.
                return f"-{self._above(operand, _SUM)}", _SUM
            case ast.UnaryOp(op=ast.Not() as op, operand=operand):
                return f"{self.symbols[type(op)]}{self._above(operand, _POWER)}", _COMPARISON
            case ast.BinOp():
                return self._binary(node)
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                x, y = self._above(left, _COMPARISON), self._above(right, _COMPARISON)
                return self._compared(op, self._kind(left), x, y), _COMPARISON
            case ast.BoolOp(op=op, values=values):
                level, symbol = _AND if isinstance(op, ast.And) else _OR, self.symbols[type(op)]
                # & and | of arrays bind more tightly than comparisons.
                least = _COMPARISON if symbol in "&|" else _AND
                return f" {symbol} ".join(self._above(v, least) for v in values), level
        raise NotImplementedError(ast.unparse(node))

    def _binary(self, node: ast.BinOp) -> tuple[str, int]:
        left, op, right = node.left, node.op, node.right
        form = {ast.Pow: self.power, ast.Mod: self.modulo}.get(type(op), "")
        level = _SUM if isinstance(op, ast.Add | ast.Sub) else _POWER if form else _PRODUCT
        if form:
            return form.format(x=self._above(left, level), y=self._above(right, level)), level
        x, y = self._above(left, level - 1), self._above(right, level)
        if level == _PRODUCT and self.text(left).startswith("-"):
            x, level = self.text(left), _SUM
        return f"{x} {self.symbols[type(op)]} {y}", level

    def _compared(self, op: ast.cmpop, _kind: str, x: str, y: str) -> str:
        return f"{x} {self.symbols[type(op)]} {y}"

    def _above(self, node: ast.expr, level: int) -> str:
        """Return an expression, in parentheses unless it binds more tightly than `level`."""
        text, binding = self._bound(node)
        return text if binding > level else f"({text})"

    def _shifted(self, node: ast.expr, by: int) -> str:
        """Return an integer and a number more."""
        match node:
            case _ if by == 0:
                return self.text(node)
            case ast.Constant(value=int(value)):
                return str(value + by)
            case ast.BinOp(left=ast.Constant(value=int(value)), op=ast.Add(), right=right):
                return f"{value + by} + {self.text(right)}"
        return f"{self.text(node)} {'+' if by > 0 else '-'} {abs(by)}"


class Cpp(Language):
    """Statements in C++."""

    linkage = "inline"


class Fortran(Language):
    """Statements in Fortran; a function that changes arguments is a subroutine."""

    comment, continued, end = "!", " &", ""
    symbols: ClassVar[_Symbols] = {
        **Language.symbols, ast.And: ".and.", ast.Or: ".or.", ast.Not: ".not. ", ast.NotEq: "/=",
    }  # fmt: skip
    names: ClassVar[_Names] = {
        "nan": "ieee_value(1.0_wp, ieee_quiet_nan)", "copysign": "sign", "float": "dble",
        "inf": "ieee_value(1.0_wp, ieee_positive_inf)",
    }  # fmt: skip
    truths = (".false.", ".true.")
    infinity = "huge(1.0_wp)"  # as infinity is no constant there
    power, modulo, choice = "{x}**{y}", "mod({x}, {y})", "merge({yes}, {no}, {test})"
    is_choice_a_statement, is_answer_returned = True, False
    first, item, member = 1, "{}({})", "%"
    constant = "real(wp), parameter :: {} = {}"
    array = "real(wp), parameter :: {0}({1}) = [{2}]"
    kinds: ClassVar[_Names] = {
        "number": "real(wp) :: {}", "integer": "integer :: {}", "truth": "logical :: {}",
        "array": "real(wp) :: {}({})",
    }  # fmt: skip
    work: ClassVar[_Names] = kinds
    results: ClassVar[_Names] = {
        "number": "wrench%{0} = w%{0}", "array": "wrench%{0} = w%{0}",
        "integer": "wrench%{0} = nint(w%{0})",
    }  # fmt: skip
    if_, else_, end_if = "if ({}) then", "else", "end if"
    for_, end_for, leave = "do {k} = {start}, {last}, {step}", "end do", "exit"
    # The standard allows 255 lines for a statement, so a table is cut into arrays.
    most = 600
    helpers: ClassVar[_Names] = {
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
end function log1p"""
    }

    def _digits(self, value: float) -> str:
        return f"{value!r}_wp"

    def _array(self, name: str, numbers: Sequence[str]) -> Iterator[str]:
        if len(numbers) > self.most:
            places = range(0, len(numbers), self.most)
            for k in places:
                yield from super()._array(f"{name}_from_{k}", numbers[k : k + self.most])
            parts = ", ".join(f"{name}_from_{k}" for k in places)
            yield self.array.format(name, len(numbers), parts)
        else:
            yield from super()._array(name, numbers)

    def _framed(self, declared: Sequence[str], body: Sequence[str]) -> Iterator[str]:
        forms = {
            "float": "real(wp), value :: {}", "int": "integer, value :: {}",
            "Record": "type(work), intent({intent}) :: {}",
        }  # fmt: skip
        head, what, result, given = list(self.arguments), "function", " result(answer)", []
        for key, kind in self.arguments.items():
            form = forms.get(kind, "real(wp), intent({intent}) :: {}(*)")
            given.append(form.format(key, intent="inout" if key in self.changed else "in"))
        if not self.changed and self.name not in self.tuples:
            given.append("real(wp) :: answer")
        else:
            what, result = "subroutine", ""
            if self.returns:
                head.append("answer")
                size = f"({self.tuples[self.name]})" if self.name in self.tuples else ""
                given.append(f"real(wp), intent(out) :: answer{size}")
        yield f"pure {what} {self.name}({', '.join(head)}){result}"
        yield from (f"    {line}" for line in (*given, *declared, "", *body))
        yield f"end {what} {self.name}"

    def _call(self, node: ast.Call, answer: str = "") -> str:
        text = self.text(node)
        return f"call {text.removesuffix(')')}, {answer})" if answer else f"call {text}"

    def _compared(self, op: ast.cmpop, kind: str, x: str, y: str) -> str:
        match op:
            case ast.Eq() if kind == "truth":
                return f"{x} .eqv. {y}"
            case ast.Eq() | ast.NotEq() if kind == "number":  # compilers warn of == with them
                return f"abs({x} - ({y})) {'<=' if isinstance(op, ast.Eq) else '>'} 0.0_wp"
        return super()._compared(op, kind, x, y)


class Matlab(Language):
    """Statements in MATLAB, elementwise; a function returns the arguments that it changes."""

    comment, continued = "%", " ..."
    symbols: ClassVar[_Symbols] = {
        **Language.symbols, ast.Mult: ".*", ast.Div: "./", ast.And: "&", ast.Or: "|",
        ast.NotEq: "~=", ast.Not: "~",
    }  # fmt: skip
    names: ClassVar[_Names] = {
        "nan": "NaN", "inf": "Inf", "pi": "pi", "int": "fix", "float": "double",
    }  # fmt: skip
    truths = ("false", "true")
    infinity = "Inf"
    power, modulo, choice = "{x}.^{y}", "mod({x}, {y})", "choose({test}, {yes}, {no})"
    first, item, member = 1, "{}({})", "."
    constant = "{} = {};"
    work: ClassVar[_Names] = {"number": "w.{} = 0;", "array": "w.{} = zeros(1, {});"}
    results: ClassVar[_Names] = dict.fromkeys(("number", "array", "integer"), "wrench.{0} = w.{0};")
    is_answer_returned = False
    if_, else_, end_if = "if {}", "else", "end"
    for_, end_for = "for {k} = {start}:{step}:{last}", "end"
    helpers: ClassVar[_Names] = {
        "choose": """
function x = choose(condition, yes, no)
% Elementwise: yes where the condition holds, no elsewhere.
condition = condition & true(size(yes + no));
x = no + zeros(size(condition));
yes = yes + zeros(size(condition));
x(condition) = yes(condition);
end"""
    }

    def _digits(self, value: float) -> str:
        return repr(value).removesuffix(".0")

    def _array(self, name: str, numbers: Sequence[str]) -> Iterator[str]:
        yield f"persistent {name}"
        yield f"if isempty({name})"
        yield f"    {name} = [{', '.join(numbers)}];"
        yield "end"

    def function(self, tree: ast.FunctionDef, constants: Mapping[str, Any]) -> str:
        """Return a function of numbers, whose choices are statements."""
        self.is_choice_a_statement = True
        numbers = {ast.Mult: "*", ast.Div: "/", ast.And: "&&", ast.Or: "||"}
        self.symbols = {**self.symbols, **numbers}  # type: ignore[misc]
        return super().function(tree, constants)

    def _framed(self, _declared: Sequence[str], body: Sequence[str]) -> Iterator[str]:
        given = self._given(self.changed, "answer" if self.returns else "")
        yield f"function {given}{self.name}({', '.join(self.arguments)})"
        yield from (*self._constants(self.own_constants), *body, "end")

    def _given(self, changed: Sequence[str], answer: str) -> str:
        """Return the left side of a call."""
        outputs = [answer, *changed] if answer else changed
        return f"[{', '.join(outputs)}] = " if len(outputs) > 1 else f"{outputs[0]} = "

    def _call(self, node: ast.Call, answer: str = "") -> str:
        changed = [self.text(node.args[k]) for k in self.changes[ast.unparse(node.func)]]
        return f"{self._given(changed, answer)}{self.text(node)}"

    def _bound(self, node: ast.expr) -> tuple[str, int]:
        match node:
            case ast.Call(func=ast.Attribute(attr="copysign"), args=[size, sign]):
                # Of a sign of 0 it would be 0, but bounded ratios are not.
                return f"abs({self.text(size)}) .* sign({self.text(sign)})", _PRODUCT
        return super()._bound(node)


_FUNCTIONS = ("log", "log1p", "exp", "sqrt", "sin", "cos", "pi", "nan", "inf")


class Python(Language):
    """Statements in Python, which has a function as it is."""

    comment, continued, end = "#", " \\", ""
    symbols: ClassVar[_Symbols] = {**Language.symbols, ast.And: "and", ast.Or: "or"}
    names: ClassVar[_Names] = {name: f"math.{name}" for name in (*_FUNCTIONS, "atan", "hypot")}
    infinity = "math.inf"
    power, choice = "power({x}, {y})", "{yes} if {test} else {no}"
    constant, array = "{} = {}", "{0} = ({2})"
    kinds: ClassVar[_Names] = {"number": "{}: float", "array": "{}: tuple", "integer": "{}: int"}
    work: ClassVar[_Names] = {"number": "self.{} = 0.0", "array": "self.{} = [0.0] * {}"}
    results: ClassVar[_Names] = {
        "number": "{0}=w.{0},", "array": "{0}=tuple(w.{0}),", "integer": "{0}=int(w.{0}),",
    }  # fmt: skip
    for_, end_for = "for {k} in range({start}, {stop}, {step}):", ""
    helpers: ClassVar[_Names] = {
        "power": '''
def power(x, y):
    """Return x**y, as C has it."""
    try:
        return math.pow(x, y)
    except ValueError:
        return math.inf if x == 0 else math.nan
    except OverflowError:
        return math.inf

'''
    }

    def function(self, tree: ast.FunctionDef, _constants: Mapping[str, Any]) -> str:
        """Return a function."""
        plain = ast.parse(ast.unparse(tree)).body[0]
        assert isinstance(plain, ast.FunctionDef)
        plain.returns = None
        for argument in plain.args.args:
            argument.annotation = None
        return ast.unparse(plain)


class Jax(Python):
    """Statements in Python with arrays of JAX."""

    symbols: ClassVar[_Symbols] = {**Language.symbols, ast.And: "&", ast.Or: "|"}
    names: ClassVar[_Names] = {
        **{name: f"jnp.{name}" for name in _FUNCTIONS}, "atan": "jnp.arctan", "max": "jnp.maximum",
    }  # fmt: skip
    power, choice = "{x} ** {y}", "jnp.where({test}, {yes}, {no})"
    helpers: ClassVar[_Names] = {}


LANGUAGES: Mapping[str, type[Language]] = {
    "c": Language, "cpp": Cpp, "fortran": Fortran, "matlab": Matlab, "python": Python, "jax": Jax,
}  # fmt: skip


# --- syntax ---


class _Floats(ast.NodeTransformer):
    """The numbers of a law, which counts nothing but turns of a loop."""

    def __init__(self) -> None:
        self.counters: set[str] = set()

    def visit_For(self, node: ast.For) -> ast.For:
        assert isinstance(node.target, ast.Name)
        self.counters.add(node.target.id)
        node.body = [self.visit(each) for each in node.body]
        return node

    def visit_Constant(self, node: ast.Constant) -> ast.Constant:
        return ast.Constant(float(node.value))  # type: ignore[arg-type]

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return ast.Call(ast.Name("float"), [node], []) if node.id in self.counters else node


class _Apart(ast.NodeTransformer):
    """Tuples as arrays, and what is unpacked as items of them."""

    def __init__(self, tuples: Mapping[str, int]) -> None:
        self.tuples, self.arrays = tuples, dict[str, int]()

    def visit_Assign(self, node: ast.Assign) -> ast.stmt | list[ast.stmt]:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=ast.Name(id=called))):
                if called in self.tuples:
                    self.arrays[name] = self.tuples[called]
            case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Tuple(elts=values)):
                return [ast.Assign([n], v) for n, v in zip(names, values, strict=True)]
            case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Call() as value):
                whole = ast.Name(f"of_{ast.unparse(value.func)}")
                self.arrays[whole.id] = self.tuples[ast.unparse(value.func)]
                return [ast.Assign([whole], value), *self._unpacked(names, whole)]
            case ast.Assign(targets=[ast.Tuple(elts=names)], value=value):
                return self._unpacked(names, value)
        return node

    def _unpacked(self, names: Sequence[ast.expr], value: ast.expr) -> list[ast.stmt]:
        return [
            ast.Assign([name], ast.Subscript(value, ast.Constant(k)))
            for k, name in enumerate(names) if ast.unparse(name) != "_"
        ]  # fmt: skip

    def visit_Return(self, node: ast.Return) -> ast.stmt | list[ast.stmt]:
        if not isinstance(node.value, ast.Tuple):
            return node
        answer, values = ast.Name("answer"), enumerate(node.value.elts)
        items = [ast.Assign([ast.Subscript(answer, ast.Constant(k))], x) for k, x in values]
        return [*items, ast.Return()]


# --- templates ---


def filled_template(name: str, parts: Mapping[str, str]) -> str:
    """Return a file of the folder `templates` with its placeholders replaced.

    A placeholder alone on its line may stand for several lines, indented as it is, or for none.
    Lines between "$if name" and "$else" are there if the part is not empty, those between "$else"
    and "$end" if it is.
    """
    lines, used = [], True
    for line in (_TEMPLATES / name).read_text(encoding="ascii").splitlines(keepends=True):
        word, _, part = line.strip().partition(" ")
        if word in ("$if", "$else", "$end"):
            used = word == "$end" or (not used if word == "$else" else bool(parts[part]))
        elif used and (alone := re.fullmatch(r"( *)\$(\w+)\n", line)):
            text = parts[alone[2]]
            lines.append(indent(f"{text}\n", alone[1]) if text else "")
        elif used:
            lines.append(Template(line).substitute(parts))
    return "".join(lines)


def require_callable(target: str, stem: str) -> None:
    """Refuse the name of a file that its language calls or imports by that name, and cannot."""
    good = stem.isascii() and stem.isidentifier() and stem not in RESERVED
    rule, remedy = "cannot be called by its name", "name it with letters, digits and underscores"
    by_name = target in ("matlab", "python", "jax")
    require(good or not by_name, "export", "--out", stem, rule, remedy)
