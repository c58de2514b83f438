"""The formula of a law: one Python function, from which all that runs or is exported is made.

The function takes the penetration in mm, the pair, and the law's constants, and returns the load
in N/mm, for penetrations inside the law's domain:

    def load(penetration, pair, c, A, B):
        first = log(B * pair.dR / penetration)
        ...
        return pi * pair.E_star * penetration / third

It may assign names, loop over a `range` of numbers, choose with `where`, call the functions of
`FUNCTIONS` by whatever name they have, and call functions written in the same way. `Formula` reads
its source. The stiffness follows by the rule of the chain, unless the function returns load and
stiffness. What does not depend on the penetration is computed once for a pair. A second function,
from pair and constants to numbers, may come before; then the first takes these in place of the
constants.
"""

from __future__ import annotations

import ast
import inspect
import math
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from cylcontact.laws.lambert import (
    branch_distance,
    branch_distance_steps,
    branch_distance_steps_from_0,
)
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import RESERVED

# What a formula may call, by the names that these have in exported code.
FUNCTIONS: dict[str, tuple[Callable[..., Any], ...]] = {
    "log": (np.log, math.log),
    "log1p": (np.log1p, math.log1p),
    "exp": (np.exp, math.exp),
    "sqrt": (np.sqrt, math.sqrt),
    "sin": (np.sin, math.sin),
    "cos": (np.cos, math.cos),
    "atan": (np.arctan, math.atan),
    "max": (np.maximum,),
    "where": (np.where,),
    "branch_distance": (branch_distance,),
}
# Derivatives of y, a function of a and b, with da and db those of a and b.
_SLOPES = {
    "Add": "da + db",
    "Sub": "da - db",
    "Mult": "b * da + a * db",
    "Div": "(da - y * db) / b",
    "Pow": "b * a ** (b - 1) * da",
    "Pow of a variable": "a ** b * (b / a * da + log(a) * db)",
    "USub": "-da",
    "IfExp": "da if test else db",
    "max": "da if a >= b else db",
    "log": "da / a",
    "log of Div": "da / a - db / b",
    "log1p": "da / (1 + a)",
    "exp": "y * da",
    "sqrt": "da / (2 * y)",
    "sin": "cos(a) * da",
    "cos": "-(sin(a) * da)",
    "atan": "da / (1 + a * a)",
    "branch_distance": "-(1 + y) / (a * y) * da",
}
# What a formula may ask of a pair, in the order in which exported functions take it.
OF_PAIR = ("E_star", "dR", "R_i", "R_j", "length", "alpha", "beta")
_DEPTH, _RESULTS = "penetration", ("f", "k", "last", "energy")
_OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow)
_COMPARISONS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


@dataclass(frozen=True)
class Step:
    """One assignment; a loop over a range of numbers if it has a body."""

    name: str
    value: ast.expr
    body: tuple[Step, ...] = ()

    @property
    def text(self) -> str:
        """The assignment in Python's syntax."""
        return f"{self.name} = {ast.unparse(self.value)}"


def names_in(node: ast.AST) -> set[str]:
    """Return the names that an expression uses, of functions too."""
    return {each.id for each in ast.walk(node) if isinstance(each, ast.Name)}


def renamed(step: Step, names: Mapping[str, str]) -> Step:
    """Return a step with other names for what it assigns and uses."""

    class Renamer(ast.NodeTransformer):
        def visit_Name(self, node: ast.Name) -> ast.Name:
            return ast.Name(names.get(node.id, node.id))

    value = Renamer().visit(ast.parse(ast.unparse(step.value), mode="eval")).body
    body = tuple(renamed(each, names) for each in step.body)
    return Step(names.get(step.name, step.name), value, body)


def steps_of(text: str) -> tuple[Step, ...]:
    """Return the steps of assignments in Python's syntax, one a line."""
    assigned = [node for node in ast.parse(text).body if isinstance(node, ast.Assign)]
    return tuple(Step(ast.unparse(node.targets[0]), node.value) for node in assigned)


def needed(steps: Sequence[Step], *results: str) -> tuple[Step, ...]:
    """Return the steps that some results need."""
    wanted, chosen = set(results), []
    for step in reversed(steps):
        if step.body:
            inside = needed(step.body, *wanted)
            if inside:  # what one turn needs, the turn before has to give
                while True:
                    used = wanted.union(*(names_in(each.value) for each in flat(inside)))
                    if used == wanted:
                        break
                    wanted, inside = used, needed(step.body, *used)
                chosen.append(Step(step.name, step.value, inside))
        elif step.name in wanted:
            chosen.append(step)
            wanted |= names_in(step.value)
    return tuple(reversed(chosen))


def assigned_in(steps: Iterable[Step]) -> Iterator[str]:
    """Yield the names that steps assign, in order, each once."""
    seen: set[str] = set()
    for step in steps:
        for name in assigned_in(step.body) if step.body else (step.name,):
            if name not in seen:
                seen.add(name)
                yield name


@dataclass(frozen=True)
class Formula:
    """A function that states the load of a law, read when it is first used."""

    # From penetration, pair and constants to the load, or to load and stiffness.
    function: Callable[..., Any]
    # From pair and constants to the numbers that `function` takes in place of the constants.
    at_pair_function: Callable[..., Any] | None = None
    # From the pair and what `function` takes to the largest penetration in mm: inf where there is
    # none, NaN for pairs for which the law is undefined.
    end: Callable[..., Any] | None = None
    # From what `function` takes to ∫ f dδ; by quadrature without it.
    energy: Callable[..., Any] | None = None
    # For exported files, in ASCII: the law on one line, and what its users should know.
    equation: str = ""
    remark: str = ""
    # From penetration and numbers by name to the load in NumPy, where that is faster by hand.
    in_arrays: Callable[..., Any] | None = None

    @cached_property
    def constants(self) -> dict[str, float | None]:
        """The constants of the law, with their defaults."""
        if self.at_pair_function is None:
            return _constants(self.function, 2)
        return _constants(self.at_pair_function, 1)

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The assignments up to f and k, the load and the stiffness, `last` and `energy`."""
        reader, taken = self._reader, tuple(_constants(self.function, 2))
        if self.at_pair_function is not None:
            reader.read(self.at_pair_function, *taken)
        if reader.read(self.function, "f", "k") == 1:
            reader.steps += _with_slopes(tuple(reader.steps), reader.fresh)
        for result in ("last", "energy"):
            function = self.end if result == "last" else self.energy
            if function is not None:
                reader.read(function, result)
        return tuple(reader.steps)

    @cached_property
    def _reader(self) -> _Reader:
        own = {*self.constants, *_constants(self.function, 2), *OF_PAIR, _DEPTH, *_RESULTS}
        return _Reader({name.lower() for name in (*own, *FUNCTIONS, *RESERVED)})

    @cached_property
    def arguments(self) -> tuple[str, ...]:
        """The properties of a pair that the formula uses, those of `OF_PAIR`."""
        used = set().union(*(names_in(step.value) for step in flat(self.steps)))
        return tuple(name for name in OF_PAIR if name in used)

    @cached_property
    def at_depth(self) -> tuple[Step, ...]:
        """The steps that depend on the penetration."""
        return depending(self.steps)

    @cached_property
    def at_pair(self) -> tuple[Step, ...]:
        """The steps that do not depend on the penetration."""
        return tuple(s for s in self.steps if s not in self.at_depth)

    @cached_property
    def written_out(self) -> tuple[Step, ...]:
        """The steps with Lambert's function written out, also for its argument 0."""
        return self._reader.expanded(self.steps, branch_distance_steps_from_0)

    @cached_property
    def scalar_steps(self) -> tuple[Step, ...]:
        """The steps `at_depth` with Lambert's function written out."""
        return self._reader.expanded(self.at_depth, branch_distance_steps)

    def numbers_of(self, *results: str) -> tuple[str, ...]:
        """Return the names of a pair's numbers that some results need besides the penetration."""
        steps = needed(self.at_depth, *results)
        used = {*results}.union(*(names_in(step.value) for step in flat(steps)))
        own = {*assigned_in(steps), _DEPTH, *FUNCTIONS, "range", "inf", "nan", "pi"}
        taken = _constants(self.function, 2)
        known = dict.fromkeys((*OF_PAIR, *taken, *self.constants, *assigned_in(self.at_pair)))
        return tuple(name for name in known if name in used - own)

    @cached_property
    def numbers(self) -> tuple[str, ...]:
        """The names of all that load, stiffness, end and energy need of a pair."""
        results = ("f", "k", *(("energy",) if self.energy else ()))
        last = ("last",) if self.end else ()
        return tuple(dict.fromkeys((*self.numbers_of(*results), *last)))

    @cached_property
    def of_pair(self) -> Callable[..., tuple[Any, ...]]:
        """The NumPy function from arguments and constants by name to `numbers`."""
        steps = needed(self.at_pair, *self.numbers)
        return _compiled((*self.arguments, *self.constants), steps, self.numbers)

    @cached_property
    def load(self) -> Callable[..., Any]:
        """The NumPy function from penetration and numbers by name to the load."""
        return self.in_arrays or self._compiled("f")

    @cached_property
    def stiffness(self) -> Callable[..., Any]:
        """The NumPy function from penetration and numbers by name to the stiffness."""
        return self._compiled("k")

    def _compiled(self, result: str) -> Callable[..., Any]:
        steps = needed(self.at_depth, result)
        others = (name for name in self.numbers if name not in {*assigned_in(steps)})
        return _compiled((_DEPTH, *others, "**_"), steps, result)


def flat(steps: Iterable[Step]) -> Iterator[Step]:
    """Yield all steps, those of loops too."""
    for step in steps:
        yield step
        yield from flat(step.body)


def depending(steps: Sequence[Step]) -> tuple[Step, ...]:
    """Return the steps that depend on the penetration."""
    depends = _dependent(steps)
    return tuple(step for step in steps if depends & {*assigned_in([step])})


def _dependent(steps: Sequence[Step]) -> set[str]:
    """Return the names whose value depends on the penetration."""
    depends = {_DEPTH}
    while True:
        more = depends | {s.name for s in flat(steps) if names_in(s.value) & depends and not s.body}
        for s in steps:  # a loop runs as a whole
            if s.body and more & {*assigned_in([s])}:
                more |= {*assigned_in([s])}
        if more == depends:
            return depends
        depends = more


# --- running with NumPy -------------------------------------------------------------------------


class _ForArrays(ast.NodeTransformer):
    """Choices and conditions as NumPy writes them for arrays."""

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        self.generic_visit(node)
        return ast.Call(ast.Name("where"), [node.test, node.body, node.orelse], [])

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        self.generic_visit(node)
        operator = ast.BitAnd() if isinstance(node.op, ast.And) else ast.BitOr()
        result = node.values[0]
        for value in node.values[1:]:
            result = ast.BinOp(result, operator, value)
        return result


def lines_of(steps: Iterable[Step], text: Callable[[ast.expr], str] = ast.unparse) -> list[str]:
    """Return steps as lines of Python."""
    lines = []
    for step in steps:
        if step.body:
            lines.append(f"for {step.name} in {text(step.value)}:")
            lines += (f"    {line}" for line in lines_of(step.body, text))
        else:
            lines.append(f"{step.name} = {text(step.value)}")
    return lines


def _compiled(
    arguments: Sequence[str], steps: Iterable[Step], results: str | Sequence[str]
) -> Callable[..., Any]:
    """Return a NumPy function with these arguments, from steps to results."""

    def text(node: ast.expr) -> str:
        copy = ast.parse(ast.unparse(node), mode="eval")
        return ast.unparse(ast.fix_missing_locations(_ForArrays().visit(copy)))

    given = results if isinstance(results, str) else f"({', '.join(results)},)"
    body = [*lines_of(steps, text), f"return {given}"]
    source = "\n    ".join([f"def function({', '.join(arguments)}):", *body])
    names = {name: functions[0] for name, functions in FUNCTIONS.items()}
    scope: dict[str, Any] = {**names, "pi": math.pi, "inf": math.inf, "nan": math.nan}
    exec(source, scope)
    function: Callable[..., Any] = scope["function"]
    return function


# --- reading a function -------------------------------------------------------------------------


def _constants(function: Callable[..., Any], first: int) -> dict[str, float | None]:
    """Return the arguments after penetration and pair, the `first`, with their defaults."""
    writing = "write it as def load(penetration, pair, K, n): ..."
    try:
        arguments = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):
        raise _refusal(function, "has no signature to read", writing) from None
    plain = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    rule, constants = "", {}
    if len(arguments) < first or any(each.kind not in plain for each in arguments):
        given = ", ".join(map(str, arguments))
        rule = f"must take a penetration, a pair and named constants, and takes ({given})"
    for argument in arguments[first:]:
        is_left_out = argument.default is inspect.Parameter.empty
        constants[argument.name] = value = None if is_left_out else argument.default
        if not isinstance(value, int | float | None):
            rule = rule or f"has a default for {argument.name} that is not a number"
        if argument.name in _RESULTS:
            rule = rule or f"has a constant {argument.name}, which names a result of a formula"
    if rule:
        raise _refusal(function, rule, writing)
    return constants


def _refusal(function: Any, rule: str, remedy: str, node: ast.AST | None = None) -> InputError:
    """Return the error of a function that is no formula, with the line of what is wrong in it."""
    code = getattr(function, "__code__", None)
    source, key = getattr(function, "__name__", str(function)), ""
    if code is not None:
        source = f"{code.co_filename}: {source}"
        line = code.co_firstlineno + getattr(node, "lineno", 1) - 1
        key = f"line {line}" if node is not None else ""
    value = ast.unparse(node) if node is not None else None
    return InputError(source, key, value, rule, remedy)


@dataclass
class _Reader:
    """Reads functions into steps that assign each name once, except in loops.

    Functions that a function calls become steps too, with names of their own.
    """

    taken: set[str]
    steps: list[Step] = field(default_factory=list)

    def read(self, function: Callable[..., Any], *results: str) -> int:
        """Append the steps of a function; return how many of the results it gives."""
        names = list(inspect.signature(function).parameters)
        given: dict[str, Any] = {name: ast.Name(name) for name in names}
        if results[0] in ("f", "energy"):
            given[names.pop(0)] = ast.Name(_DEPTH)
        given[names[0]] = OF_PAIR
        values = _Frame(self, function, given, self.steps).run()
        for k, name in enumerate(results[: len(values)]):
            value = values[k]
            old = value.id if isinstance(value, ast.Name) else ""
            if old.startswith(f"{name}_"):  # only this result had its name
                self.steps = [renamed(step, {old: name}) for step in self.steps]
                values = [_filled(ast.unparse(v), **{old: ast.Name(name)}) for v in values]
            elif old != name:
                self.steps.append(Step(name, value))
        return len(values)

    def fresh(self, name: str) -> str:
        """Return a name that differs from all others in more than case, which Fortran ignores."""
        number, trial = 1, name
        while trial.lower() in self.taken:
            number += 1
            trial = f"{name}_{number}"
        self.taken.add(trial.lower())
        return trial

    def expanded(self, steps: Iterable[Step], lambert: Callable[..., Any]) -> tuple[Step, ...]:
        """Return steps with those of Lambert's function in place of its calls."""
        every: list[Step] = []
        for step in steps:
            match step.value:
                case ast.Call(func=ast.Name(id="branch_distance"), args=[p]):
                    frame = _Frame(self, lambert, {"p": p}, every)
                    every.append(Step(step.name, frame.run()[0]))
                case _:
                    every.append(step)
        return tuple(every)


@dataclass
class _Frame:
    """One call of a function: the new names of its own names, and where its steps go.

    `given` holds an expression for each name, for a pair what may be asked of it; `changing` the
    names that a loop changes, and "" inside a loop.
    """

    reader: _Reader
    function: Callable[..., Any]
    given: dict[str, Any]
    steps: list[Step]
    changing: set[str] = field(default_factory=set)
    callers: tuple[Callable[..., Any], ...] = ()

    def run(self) -> list[ast.expr]:
        """Append the steps; return the values that the function returns."""
        try:
            tree = ast.parse(textwrap.dedent(inspect.getsource(self.function))).body[0]
        except (OSError, TypeError, SyntaxError, IndexError):
            tree = None
        if not isinstance(tree, ast.FunctionDef):
            raise self.refusal("has no source that can be read", "define it by def in a file")
        variables = inspect.getclosurevars(self.function)
        self.outer = {**variables.builtins, **variables.globals, **variables.nonlocals}
        *body, last = tree.body
        for statement in body:
            self.statement(statement)
        if not isinstance(last, ast.Return) or last.value is None:
            raise self.refusal("does not end by returning its load", "end it with return", last)
        return self.values(last.value)

    def refusal(self, rule: str, remedy: str, node: ast.AST | None = None) -> InputError:
        return _refusal(self.function, rule, remedy, node)

    def statement(self, node: ast.stmt) -> None:
        """Append the steps of a statement."""
        match node:
            case ast.Expr(value=ast.Constant()):  # a docstring
                return
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                self.assign(name, self.value(value, alone=True))
            case ast.Assign(targets=[ast.Tuple(elts=names)], value=value):
                parts = self.values(value)
                swaps = isinstance(value, ast.Tuple) and {*map(ast.unparse, names)} & self.changing
                if swaps or len(parts) != len(names):
                    rule = "does not give each name one value that no other name has had"
                    raise self.refusal(rule, "assign one name at a time", node)
                for each, part in zip(names, parts, strict=True):
                    self.assign(ast.unparse(each), part)
            case ast.AugAssign(target=ast.Name(id=name) as target, op=op, value=value):
                self.assign(name, self.value(ast.BinOp(target, op, value)))
            case ast.For(target=ast.Name(id=name), iter=iterable, body=body, orelse=[]):
                self.loop(name, iterable, body)
            case _:
                raise self.refusal(
                    "is no assignment and no loop over a range of numbers",
                    "write it as assignments, and choices with numpy.where", node,
                )  # fmt: skip

    def assign(self, name: str, value: ast.expr) -> None:
        """Give a name a value: a new name, unless a loop changes it."""
        if name in self.changing:
            self.steps.append(Step(self.given[name].id, value))
        elif isinstance(value, ast.Name | ast.Constant | ast.BoolOp | ast.Compare):
            self.given[name] = value
        else:
            self.given[name] = self.placed(name, value)

    def placed(self, name: str, value: ast.expr) -> ast.Name:
        """Return the name of a value: that of an earlier step that has it, or a new one."""
        text = ast.unparse(value)
        if not self.changing:
            for step in self.steps:
                if not step.body and ast.unparse(step.value) == text:
                    return ast.Name(step.name)
        step = Step(self.reader.fresh(name), value)
        self.steps.append(step)
        return ast.Name(step.name)

    def loop(self, name: str, iterable: ast.expr, body: list[ast.stmt]) -> None:
        """Append a loop, whose names go on from one turn to the next."""
        match iterable:
            case ast.Call(func=ast.Name(id="range"), args=numbers, keywords=[]):
                limits = [self.value(number) for number in numbers]
            case _:
                limits = [iterable]
        try:
            whole = all(isinstance(ast.literal_eval(ast.unparse(each)), int) for each in limits)
        except ValueError:
            whole = False
        if not whole:
            raise self.refusal("is not a range of whole numbers", "use range(4)", iterable)
        stores = dict.fromkeys(
            n.id for s in body for n in ast.walk(s)
            if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
        )  # fmt: skip
        going_on = [each for each in stores if each in self.given and each not in self.changing]
        for each in going_on:
            self.steps.append(Step(self.reader.fresh(each), self.given[each]))
            self.given[each] = ast.Name(self.steps[-1].name)
        self.given[name] = ast.Name(self.reader.fresh(name))
        outside, before = self.steps, self.changing
        self.steps, self.changing = [], {"", *before, *going_on}
        for statement in body:
            self.statement(statement)
        call = ast.Call(ast.Name("range"), limits, [])
        outside.append(Step(self.given[name].id, call, tuple(self.steps)))
        self.steps, self.changing = outside, before

    def values(self, node: ast.expr) -> list[ast.expr]:
        """Return the values of what is unpacked."""
        if isinstance(node, ast.Tuple):
            return [self.value(part, alone=True) for part in node.elts]
        if isinstance(node, ast.Call) and self.is_helper(node):
            return self.called(node)
        return [self.value(node, alone=True)]

    def is_helper(self, node: ast.Call) -> bool:
        """Return whether a function is called that is no part of the vocabulary."""
        return inspect.isfunction(self.object_of(node.func)) and not self.function_of(node.func)

    def value(self, node: ast.expr, alone: bool = False) -> ast.expr:
        """Return an expression in the new names; `alone` if it is all that a name is given."""
        match node:
            case ast.Constant(value=bool()):
                pass
            case ast.Constant(value=int() | float()):
                return node
            case ast.Name(id=name) if isinstance(self.given.get(name), ast.expr):
                new: ast.expr = self.given[name]
                return new
            case ast.Attribute(value=ast.Name(id=name), attr=asked) if (
                self.given.get(name) is OF_PAIR
            ):
                if asked == "R":
                    return ast.parse("R_i * R_j / dR", mode="eval").body
                if asked in OF_PAIR:
                    return ast.Name(asked)
                rule = "is not known to an exported formula"
                raise self.refusal(rule, f"use {', '.join(OF_PAIR)}", node)
            case ast.Name() | ast.Attribute():
                return self.number(node)
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as op, operand=operand):
                inner = self.value(operand)
                return inner if isinstance(op, ast.UAdd) else ast.UnaryOp(op, inner)
            case ast.BinOp(left=left, op=ast.BitAnd() | ast.BitOr() as op, right=right):
                both: ast.boolop = ast.And() if isinstance(op, ast.BitAnd) else ast.Or()
                return ast.BoolOp(both, [self.value(left), self.value(right)])
            case ast.BinOp(left=left, op=op, right=right) if isinstance(op, _OPERATORS):
                return ast.BinOp(self.value(left), op, self.value(right))
            case ast.BoolOp(op=either, values=parts):
                return ast.BoolOp(either, [self.value(part) for part in parts])
            case ast.Compare(left=left, ops=ops, comparators=others) if all(
                isinstance(op, _COMPARISONS) for op in ops
            ):
                sides = [self.value(side) for side in (left, *others)]
                pairs: list[ast.expr] = [
                    ast.Compare(sides[k], [op], [sides[k + 1]]) for k, op in enumerate(ops)
                ]
                return pairs[0] if len(pairs) == 1 else ast.BoolOp(ast.And(), pairs)
            case ast.Call(keywords=[]) if self.is_helper(node):
                return self.called(node)[0]
            case ast.Call(func=function, args=arguments, keywords=[]):
                values = [self.value(argument) for argument in arguments]
                called = self.function_of(function)
                if called is None:
                    rule, remedy = "is not known in other languages", f"use {', '.join(FUNCTIONS)}"
                    raise self.refusal(rule, remedy, node)
                is_choice = called == "where"
                made = ast.IfExp(*values) if is_choice else ast.Call(ast.Name(called), values, [])
                if alone or called not in ("where", "branch_distance"):
                    return made
                return self.placed("chosen" if is_choice else "w", made)
        raise self.refusal(
            "cannot be written in another language",
            f"use + - * / **, comparisons, {', '.join(FUNCTIONS)} and functions of these", node,
        )  # fmt: skip

    def object_of(self, node: ast.expr) -> Any:
        """Return what a name of the module stands for; None if it has no value."""
        if isinstance(node, ast.Attribute):
            return getattr(self.object_of(node.value), node.attr, None)
        return self.outer.get(node.id) if isinstance(node, ast.Name) else None

    def number(self, node: ast.expr) -> ast.expr:
        """Return a number of the module."""
        number = self.object_of(node)
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise self.refusal("is not a number", "give it as a constant or an argument", node)
        for name, known in (("pi", math.pi), ("inf", math.inf), ("nan", math.nan)):
            if number == known or (math.isnan(number) and math.isnan(known)):
                return ast.Name(name)
        return ast.Constant(number)

    def function_of(self, node: ast.expr) -> str | None:
        """Return the name of a function of the vocabulary; None for another."""
        called = self.object_of(node)
        for name, functions in FUNCTIONS.items():
            if any(called is function for function in functions):
                return name
        return None

    def called(self, node: ast.Call) -> list[ast.expr]:
        """Return the values of another function, whose steps are appended."""
        function = self.object_of(node.func)
        given: dict[str, Any] = {}
        for name, argument in zip(inspect.signature(function).parameters, node.args, strict=False):
            if isinstance(argument, ast.Name) and self.given.get(argument.id) is OF_PAIR:
                given[name] = OF_PAIR
                continue
            value = self.value(argument)
            simple = isinstance(value, ast.Name | ast.Constant)
            given[name] = value if simple else self.placed(name, value)
        if function in self.callers:
            raise self.refusal("calls itself", "write it without", node)
        changing = {""} if self.changing else set()  # as in a loop
        callers = (*self.callers, function)
        return _Frame(self.reader, function, given, self.steps, changing, callers).run()


# --- the rule of the chain ----------------------------------------------------------------------


def _with_slopes(steps: Sequence[Step], fresh: Callable[[str], str]) -> Iterator[Step]:
    """Yield the steps of the derivatives by the penetration, up to k, that of f."""
    slopes: dict[str, ast.expr] = {_DEPTH: ast.Constant(1)}
    for step in needed(steps, "f"):
        if step.body:
            if _dependent([step]) & {*assigned_in([step])} or names_in(step.value) & slopes.keys():
                raise InputError(
                    "a law's formula", step.name, None,
                    "changes in a loop with the penetration",
                    "return load, stiffness from the function",
                )  # fmt: skip
            continue
        slope = _slope(step.value, slopes, step.name)
        if step.name == "f":
            yield Step("k", slope)
        elif isinstance(slope, ast.Name) or _is_number(slope, 1):
            slopes[step.name] = slope
        elif not _is_number(slope, 0):
            name = fresh(f"{step.name}_slope")
            slopes[step.name] = ast.Name(name)
            yield Step(name, slope)


def _slope(node: ast.expr, slopes: Mapping[str, ast.expr], name: str = "") -> ast.expr:
    """Return the derivative of an expression, the value of `name`, in a placed step."""
    zero = ast.Constant(0)
    test: ast.expr = zero
    match node:
        case ast.Name(id=used):
            return slopes.get(used, zero)
        case ast.UnaryOp(operand=a):
            kind, parts = "USub", [a]
        case ast.IfExp(test=test, body=a, orelse=b):
            kind, parts = "IfExp", [a, b]
        case ast.BinOp(left=a, op=op, right=b):
            kind, parts = type(op).__name__, [a, b]
        case ast.Call(func=ast.Name(id="log"), args=[ast.BinOp(left=a, op=ast.Div(), right=b)]):
            kind, parts = "log of Div", [a, b]
        case ast.Call(func=ast.Name(id=kind), args=parts):
            pass
        case _:
            return zero
    da, db, *_ = *(_slope(part, slopes) for part in parts), zero
    if _is_number(da, 0) and _is_number(db, 0):
        return zero
    if kind == "Pow" and not _is_number(db, 0):
        kind = "Pow of a variable"
    y = ast.Name(name) if name else node
    return _filled(_SLOPES[kind], a=parts[0], b=parts[-1], da=da, db=db, y=y, test=test)


def _is_number(node: ast.expr, number: int) -> bool:
    return isinstance(node, ast.Constant) and node.value == number


def _filled(text: str, **parts: ast.expr) -> ast.expr:
    """Return an expression with parts in place of names, without sums and products of 0 and 1."""

    class Filler(ast.NodeTransformer):
        def visit_Name(self, node: ast.Name) -> ast.expr:
            return parts.get(node.id, node)

        def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
            left: ast.expr = self.visit(node.left)
            right: ast.expr = self.visit(node.right)
            match node.op:
                case ast.Add() | ast.Sub() if _is_number(right, 0):
                    return left
                case ast.Add() if _is_number(left, 0):
                    return right
                case ast.Sub() if _is_number(left, 0):
                    return ast.UnaryOp(ast.USub(), right)
                case ast.Mult() if _is_number(left, 0) or _is_number(right, 0):
                    return ast.Constant(0)
                case ast.Mult() if _is_number(right, 1):
                    return left
            return ast.BinOp(left, node.op, right)

    filled: ast.expr = Filler().visit(ast.parse(text, mode="eval").body)
    return filled
