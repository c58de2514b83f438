"""A force element between two bodies: its steps and lists of names, from which files are written.

The steps are in neutral notation and in the units of the element, so that no language has formulas
of its own. The law alone is in mm. A joint of any kind gives an `Element`; `source` writes it in a
language, and `cylcontact.export.fmu` as an FMU.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import version
from textwrap import wrap
from typing import Any, Literal, NamedTuple

import numpy as np

from cylcontact.arrays import FloatArray, require
from cylcontact.choices import JOINT_TARGETS
from cylcontact.export.dialects import JOINT_DIALECTS
from cylcontact.export.exported_law import (
    MEANINGS,
    declared,
    expression,
    paragraph,
    renamed,
    safe_names,
)
from cylcontact.export.program import Program
from cylcontact.export.render import WIDTH, Dialect, filled_template
from cylcontact.laws.formula import Step, flat, names_in, needed, steps_of
from cylcontact.laws.kernels import TABLE, Kernel
from cylcontact.laws.law import ContactLaw, Law
from cylcontact.pair import CylinderPair
from cylcontact.plain_text import RESERVED, comment

BODIES = {"bearing": "of the body with the hole", "pin": "of the body with the pin"}


class Unit(NamedTuple):
    """The names of a quantity's unit with m and with mm, and its exponents of kg, m and s."""

    with_m: str
    with_mm: str
    exponents: Mapping[str, float]


UNITS: Mapping[str, Unit] = {
    "length": Unit("m", "mm", {"m": 1}),
    "angle": Unit("rad", "rad", {"rad": 1}),
    "speed": Unit("m/s", "mm/s", {"m": 1, "s": -1}),
    "spin": Unit("rad/s", "rad/s", {"rad": 1, "s": -1}),
    "force": Unit("N", "N", {"kg": 1, "m": 1, "s": -2}),
    "moment": Unit("N.m", "N.mm", {"kg": 1, "m": 2, "s": -2}),
    "power": Unit("W", "N.mm/s", {"kg": 1, "m": 2, "s": -3}),
    "energy": Unit("J", "N.mm", {"kg": 1, "m": 2, "s": -2}),
    "number": Unit("-", "-", {}),
}


class Constant(NamedTuple):
    """A number of an element."""

    value: float
    unit: str
    meaning: str


class Motion(NamedTuple):
    """One of the numbers that say where a body is and how it moves.

    `ahead` is what becomes of it within a time `ahead`, in the names of the others.
    """

    name: str
    quantity: str
    meaning: str
    ahead: str = ""


class Result(NamedTuple):
    """A part of the wrench: a number, a vector, or an integer if it has no quantity."""

    name: str
    values: tuple[str, ...]
    quantity: str
    meaning: str

    @property
    def parts(self) -> tuple[str, ...]:
        """The ends of the names of its numbers."""
        ends = "xyz" if len(self.values) <= 3 else "1234"
        return tuple(f"_{ends[k]}" for k in range(len(self.values))) if self.is_vector else ("",)

    @property
    def is_vector(self) -> bool:
        """Whether it has several numbers."""
        return len(self.values) > 1


class LawSteps(NamedTuple):
    """A law at its pair: from a penetration > 0 in mm, or nodes of a table around it, to f."""

    steps: tuple[Step, ...]
    constants: Mapping[str, float]
    table: tuple[FloatArray, FloatArray, FloatArray] | None = None


# Between two nodes of the table, from what each language looks up.
_TABLE_STEPS = """
width = x_1 - x_0
rise = (y_1 - y_0)/width
part = (at - x_0)/width
rest = 1 - part
left = s_0 - rise
right = s_1 - rise
inside = y_0 + width*part*(rise + rest*(rest*left - part*right))
exponent = y_0 + s_0*(at - x_0) if at <= x_0 else inside
f = exp(exponent)
"""


def law_steps(law: ContactLaw, pair: CylinderPair, kernel: Kernel) -> LawSteps:
    """Return a law at a pair by its formula, or else as the table of its kernel."""
    if kernel.kind == TABLE:
        x, y, slopes = kernel.parameters[1:].reshape(3, -1)
        return LawSteps(steps_of(_TABLE_STEPS), {}, (x, y, slopes))
    assert isinstance(law, Law)
    formula = law.formula_at(pair)
    assert formula is not None
    numbers, steps = law.numbers_at(pair), needed(formula.scalar_steps, "f")
    names = safe_names(steps, numbers)
    own = {"pi": math.pi, **{names[name]: float(value) for name, value in numbers.items()}}
    steps = tuple(renamed(step, names) for step in steps)
    return LawSteps(steps, _used(steps, own))


@dataclass(frozen=True)
class Element:
    """A force element between a bearing and a pin.

    The steps go from the motion (bearing_x and so on) and the impact rate to the numbers of the
    results, and to next_rate. They call `law`. With several contacts a `program` takes their place.
    `checks` are impact rates, motions and wrenches, whose attributes are the results; those named
    penetration and penetration_rate have one number for each contact.
    """

    name: str
    title: str
    units: Literal["SI", "mm"]
    law: LawSteps
    law_text: str
    motion: tuple[Motion, ...]
    results: tuple[Result, ...]
    steps: tuple[Step, ...]
    constants: Mapping[str, Constant]
    about: Sequence[str]
    assumptions: Sequence[str]
    checks: Sequence[tuple[Any, Sequence[float], Sequence[float], Any]]
    contacts: int = 1
    program: Program | None = None

    @cached_property
    def evaluate(self) -> tuple[Step, ...]:
        """The steps to the results."""
        values = (expression(value) for result in self.results for value in result.values)
        return needed(self.steps, *set().union(*map(names_in, values)))

    @cached_property
    def accept(self) -> tuple[Step, ...]:
        """The steps to the next impact rate."""
        return needed(self.steps, "next_rate")

    def numbers(self, steps: Iterable[Step]) -> dict[str, float]:
        """Return the constants that some steps use."""
        return _used(steps, {name: each.value for name, each in self.constants.items()})

    def comment(self, mark: str) -> str:
        """Return the comment at the top of a file, each line behind a `mark`."""
        u = "m" if self.units == "SI" else "mm"
        rows = {
            **self.constants,
            **{
                name: Constant(value, *MEANINGS.get(name, ("", "of the law")))
                for name, value in self.law.constants.items() if name != "pi"
            },
        }  # fmt: skip
        motion = ", ".join(each.name for each in self.motion)
        lines = [
            self.name,
            "",
            f"A pin in its bearing with clearance as a force element, '{comment(self.title)}'.",
            f"Written by cylcontact {version('cylcontact')}.",
            "",
            *paragraph("Units", (
                f"lengths in {u}, times in s, angles in rad, forces in N, moments in N {u}, powers "
                f"in N {u}/s; whatever the file of the joint had them in"
            )),
            *paragraph("Law", self.law_text),
            *self.about,
            "",
            *paragraph("Arguments", (
                f"bearing and pin are {motion} of the reference points of the two bodies. evaluate "
                "changes nothing: call it as often as the solver likes. Call accept once after "
                "each accepted step, or at the onset of a contact, located as the root of the "
                "penetration, and whenever the contact ends: it alone changes the state, the "
                "penetration rate at first touch (impact_rate, 0 without contact). Each joint has "
                "a state of its own"
            )),
            "",
            "Results:",
            *(f"  {each.name:<20} {each.meaning}" for each in self.results),
            "",
            "Assumptions:",
            *(line for text in self.assumptions
              for line in wrap(f"  - {text}", WIDTH, subsequent_indent=4 * " ")),
            "",
            "Constants:",
            *(f"  {name:<16} {value!r:<24} {unit:<7} {meaning}"
              for name, (value, unit, meaning) in rows.items()),
            "",
            "Check values, from the library:",
            *self._check_values(),
        ]  # fmt: skip
        return "\n".join(f"{mark} {line}".rstrip() for line in lines)

    def _check_values(self) -> Iterator[str]:
        """Yield states and their wrenches, three numbers a line."""
        for rates, bearing, pin, wrench in self.checks:
            numbers = [
                f"{each.name}{part} {number.item()!r}"
                for each in self.results
                for part, number in zip(
                    each.parts, np.ravel(getattr(wrench, each.name)), strict=True
                )
            ]
            rows = {"bearing": map(repr, bearing), "pin": map(repr, pin), "gives": numbers}
            yield f"  impact_rate {rates!r}"
            for title, texts in rows.items():
                listed = list(texts)
                for first in range(0, len(listed), 3):
                    row = ", ".join(listed[first : first + 3])
                    yield f"    {'' if first else title:<8} {row}"


def _used(steps: Iterable[Step], numbers: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers whose names some steps use."""
    names = set().union(*(names_in(step.value) for step in flat(steps)))
    return {name: value for name, value in numbers.items() if name in names}


# --- in a language ---


class _Notation(NamedTuple):
    """How a language writes arrays and records."""

    item: str  # of an array
    first: int  # the number of the first
    line_end: str  # within a list
    law: str  # the name of its function
    declared: tuple[str, str, str]  # a number, an array and an integer of a record
    result: str  # how a result is returned
    rates: str  # the impact rates, and how they are returned
    next_rates: str
    whole: str = "{value}"  # a number as an integer
    vector: str = ""  # where there is none, each item is assigned
    program: str = "w."  # before the name of a result of a program

    def returned(self, form: str, name: str, values: Sequence[str]) -> Iterator[str]:
        """Yield the statements, of a form, that return one or several values."""
        if len(values) == 1 or self.vector:
            text = values[0] if len(values) == 1 else self.vector.format(", ".join(values))
            yield form.format(name=name, value=text)
            return
        for k, value in enumerate(values, self.first):
            yield form.format(name=self.item.format(name=name, k=k), value=value)


_C = _Notation(
    item="{name}[{k}]", first=0, line_end=",\n        ", law="{name}_law",
    declared=("double {name};", "double {name}[{count}];", "int {name};"),
    result="wrench->{name} = {value};", rates="state->impact_rate",
    next_rates="state->{name} = {value};", whole="(int){value}",
)  # fmt: skip
_NOTATIONS = {
    "c": _C,
    "cpp": _C,
    "fortran": _Notation(
        item="{name}({k})", first=1, line_end=", &\n    ", law="law",
        declared=("real(wp) :: {name}", "real(wp) :: {name}({count})", "integer :: {name}"),
        result="wrench%{name} = {value}", rates="state%impact_rate",
        next_rates="state%{name} = {value}", whole="nint({value})", vector="[{}]",
        program="w%",
    ),
    "matlab": _Notation(
        item="{name}({k})", first=1, line_end=", ...\n        ", law="law_load",
        declared=("", "", ""), result="wrench.{name} = {value};", rates="impact_rate",
        next_rates="{name} = {value};", vector="[{}]",
    ),
    "python": _Notation(
        item="{name}[{k}]", first=0, line_end=",\n    ", law="_law",
        declared=("{name}: float", "{name}: tuple", "{name}: int"), result="{name}={value},",
        rates="impact_rate", next_rates="return {value}", whole="int({value})", vector="({})",
    ),
}  # fmt: skip
# The standard allows 255 lines for a statement of Fortran, so a table is cut into arrays.
_NODES = 800


def source(element: Element, target: str, stem: str) -> dict[str, str]:
    """Return the texts of the files of an element in a language, by their names.

    Raises `InputError` if the language cannot have a file or a module of that name.
    """
    stem = stem or element.name
    if target in ("matlab", "python"):
        require(
            stem.isascii() and stem.isidentifier() and stem not in RESERVED, "export", "--out",
            stem, "cannot be called by its name",
            "name the file with letters, digits and underscores",
        )  # fmt: skip
    if target == "fortran":
        taken = {"law", *(element.program.names if element.program else ())}
        require(
            element.name.lower() not in taken, "export", "name", element.name,
            "is that of a function in the module", "give the joint another name",
        )  # fmt: skip
    parts = _parts(element, target, stem)
    if target in ("c", "cpp"):
        for shared in ("types", "functions"):
            parts[shared] = filled_template(f"joint.{shared}", parts).rstrip("\n")
    files = {f"{stem}{JOINT_TARGETS[target]}": filled_template(f"joint.{target}", parts)}
    if target == "c":
        files[f"{stem}.h"] = filled_template("joint.h", parts)
    return files


def _names(element: Element, form: _Notation) -> dict[str, str]:
    """Return what a language calls the law, the motion, the impact rate, and `w` of a program."""
    names = {"law": form.law.format(name=element.name), "impact_rate": form.rates}
    for body in BODIES:
        for k, each in enumerate(element.motion, form.first):
            names[f"{body}_{each.name}"] = form.item.format(name=body, k=k)
    if element.program is not None:
        for result in element.results:
            for k, value in enumerate(result.values):
                field = f"{form.program}{result.name}"
                at = k + form.first
                names[value] = form.item.format(name=field, k=at) if result.is_vector else field
    return names


def _parts(element: Element, target: str, stem: str) -> dict[str, str]:
    """Return what the templates of a language ask for."""
    name, form, dialect = element.name, _NOTATIONS[target], JOINT_DIALECTS[target]
    names = _names(element, form)
    dialect = replace(dialect, names={**dialect.names, **names})
    count = {"count": element.contacts}
    parts = {
        "name": name,
        "stem": stem,
        "capitals": name.upper(),
        "imported": "import joint" if stem == "joint" else f"import {stem} as joint",
        "static": "inline" if target == "cpp" else "static",
        "inline": "inline " if target == "cpp" else "",
        "one": "one contact" if element.contacts == 1 else "",
        "several": "several" if element.contacts > 1 else "",
        "size": str(len(element.motion)),
        "rates": form.declared[element.contacts > 1].format(name="impact_rate", **count),
        "fields": "\n".join(_fields(element, form)),
        "results": "\n".join(_results(element, form, dialect)),
        "comment": element.comment(dialect.comment),
        "evaluate_variables": declared(element.evaluate),
        "accept_variables": declared(element.accept),
        "law_variables": declared(step for step in element.law.steps if step.name != "f"),
        "law": dialect.statements(element.law.steps),
        "law_constants": dialect.constants(
            {n: x for n, x in element.law.constants.items() if n not in dialect.names}
        ),
        "table": "",
        "types": "",
        "program": "",
    }
    zeros = [dialect.number(0.0)] * element.contacts
    for function, values in (("start", zeros), ("next", ["next_rate"])):
        parts[function] = "\n".join(form.returned(form.next_rates, "impact_rate", values))
    for function, steps in (("evaluate", element.evaluate), ("accept", element.accept)):
        parts[function] = dialect.statements(steps)
        parts[f"{function}_constants"] = dialect.constants(element.numbers(steps))
    if element.program is not None:
        parts |= element.program.parts(target, names["law"], parts["static"])
    parts["helpers"] = dialect.helpers_of(parts["law"])
    has_nan = "ieee_value" in parts["law"] + parts["program"]
    parts["nan_module"] = "use, intrinsic :: ieee_arithmetic" if has_nan else ""
    if element.law.table is not None:
        nodes = element.law.table[0].size
        parts |= {"nodes": str(nodes), "last": str(nodes - 1 + form.first), "table": "a table"}
        for key, numbers in zip("xys", element.law.table, strict=True):
            parts[key] = _lines_of(numbers, dialect, form.line_end)
        if target == "fortran":
            parts["table"] = _fortran_arrays(element.law.table, dialect, form.line_end)
    return parts


def _fields(element: Element, form: _Notation) -> Iterator[str]:
    """Yield the declarations of the results."""
    number, array, integer = form.declared
    for each in element.results:
        kind = array if each.is_vector else number if each.quantity else integer
        yield kind.format(name=each.name, count=len(each.values))


def _results(element: Element, form: _Notation, dialect: Dialect) -> Iterator[str]:
    """Yield the statements that return the results."""
    for each in element.results:
        values = [dialect.render(expression(value)) for value in each.values]
        if not each.quantity:
            values = [form.whole.format(value=value) for value in values]
        yield from form.returned(form.result, each.name, values)


def _lines_of(numbers: FloatArray, dialect: Dialect, line_end: str) -> str:
    """Return literals of numbers, four a line."""
    literals = [dialect.number(float(value)) for value in numbers]
    return line_end.join(", ".join(literals[k : k + 4]) for k in range(0, len(literals), 4))


def _fortran_arrays(table: tuple[FloatArray, ...], dialect: Dialect, line_end: str) -> str:
    """Return the declarations for a table: ln of the penetration, ln of the load, slopes."""
    texts = ["real(wp) :: at, x_0, y_0, s_0, x_1, y_1, s_1", "integer :: low, high, middle"]
    for name, numbers in zip("xys", table, strict=True):
        parts = []
        for k in range(0, numbers.size, _NODES):
            some = numbers[k : k + _NODES]
            inside = _lines_of(some, dialect, line_end)
            parts.append(f"{name}_from_{k}")
            texts.append(f"real(wp), parameter :: {parts[-1]}({some.size}) = [ &\n    {inside}]")
        texts.append(f"real(wp), parameter :: {name}({numbers.size}) = [{', '.join(parts)}]")
    return "\n".join(texts)
