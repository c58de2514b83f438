"""A force element between two bodies, from which files are written.

A joint of any kind gives an `Element`: lists of names and words, and the compiled functions of the
package that evaluate it. `source` writes it in a language, `cylcontact.export.fmu` as an FMU.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from textwrap import wrap
from typing import Any, Literal, NamedTuple

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.export.language import (
    LANGUAGES,
    WIDTH,
    filled_template,
    require_callable,
)
from cylcontact.export.law import MEANINGS, paragraph
from cylcontact.export.program import Program
from cylcontact.laws.conformal.curve import FAR_STEP, make
from cylcontact.laws.conformal.law import Conformal
from cylcontact.laws.kernels import CURVE, EXPLICIT, LIU, LOGARITHMIC, POWER, TABLE, Kernel
from cylcontact.laws.lambert import A, B, C, D
from cylcontact.laws.law import ContactLaw
from cylcontact.support.arrays import require
from cylcontact.support.choices import JOINT_TARGETS
from cylcontact.support.plain_text import comment

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


class Motion(NamedTuple):
    """One of the numbers that say where a body is and how it moves.

    `ahead` is what becomes of it within a time `ahead`, in the names of the others.
    """

    name: str
    quantity: str
    meaning: str
    ahead: str = ""


class Result(NamedTuple):
    """A part of the wrench: a number, a vector of a size, or an integer if it has no quantity."""

    name: str
    size: int
    quantity: str
    meaning: str

    @property
    def parts(self) -> tuple[str, ...]:
        """The ends of the names of its numbers."""
        ends = "xyz" if self.size < 4 else "1234"
        return tuple(f"_{end}" for end in ends[: self.size]) or ("",)


# Of a curve in a file: its steps, and the error that it may have.
_FEW = 1 / 32, 12.0, 32.0, 1e-8
# The law of a table: ln of the penetration and of the load, and slopes.
_TABLE = """
def law(penetration: float) -> float:
    if penetration <= 0.0:
        return 0.0
    at = math.log(penetration)
    low = 0
    high = {last}
    for turn in range(64):
        middle = int(0.5 * (low + high))
        if high - low < 2:
            break
        if table_x[middle] <= at:
            low = middle
        else:
            high = middle
    width = table_x[high] - table_x[low]
    rise = (table_y[high] - table_y[low]) / width
    part = (at - table_x[low]) / width
    rest = 1.0 - part
    bend = rest * (table_s[low] - rise) - part * (table_s[high] - rise)
    if at <= table_x[low]:
        return math.exp(table_y[low] + table_s[low] * (at - table_x[low]))
    return math.exp(table_y[low] + width * part * (rise + rest * bend))
"""
# The law of a curve, L by the penetration, with even nodes in s = ln(1 + D/d).
_CURVE = """
def law(penetration: float) -> float:
    if penetration <= 0.0:
        return 0.0
    s = math.log(1.0 + curve_D / penetration)
    place = (s - curve_first) * curve_per
    if s > curve_near:
        place = curve_count + (s - curve_near) * curve_far
    low = int(place)
    if low > {last}:
        low = {last}
    part = place - low
    bend = curve_2[low] + part * curve_3[low]
    return curve_factor * penetration / (curve_0[low] + part * (curve_1[low] + part * bend))
"""
# The laws of formulas, with the names of their numbers.
_FORMULAS = {
    POWER: (("factor", "n"), "return law_factor * penetration ** law_n"),
    LIU: (
        ("E_star", "dR"),
        "share = penetration / (2.0 * (law_dR + penetration))\n"
        f"    return {math.pi / 2!r} * law_E_star * penetration * math.sqrt(share)",
    ),
    EXPLICIT: (
        ("E_star", "dR", "c", "A", "B"),
        """d = penetration / law_dR
    ratio = law_A / d
    first = math.log(law_B / d)
    second = law_c + math.log1p(ratio * first)
    third = law_c + math.log1p(ratio * second)"""
        f"\n    return {math.pi!r} * law_E_star * penetration / third",
    ),
    LOGARITHMIC: (
        ("f_max", "deepest"),
        f"""p = penetration / law_deepest
    inner = p if p < 1.0 else 0.5
    g = -math.log(inner)
    r = math.sqrt(g)
    u = 1.0 + r * ({A} + r * ({B} + {C} * r)) / (1.0 + {D} * r)
    start = u - 1.0
    t = (start - math.log(u) - g) / (start * start)
    w = start - t * start * u * (1.0 + t * (0.5 + t * (0.5 + start / 3.0)))
    w = w if p < 1.0 else 0.0
    return law_f_max * (p / (1.0 + w))""",
    ),
}


def law_function(
    law: ContactLaw, pair: CylinderPair, kernel: Kernel
) -> tuple[ast.FunctionDef, dict[str, Any]]:
    """Return a law at a pair as a function of the penetration in mm, and its constants."""
    if kernel.kind == CURVE:
        assert isinstance(law, Conformal)
        table = make(law.curve(pair).bodies, *_FEW).L
        nodes = table.nodes
        curve = {
            "D": nodes.scale * float(pair.dR), "first": nodes.first, "per": 1 / nodes.step,
            "near": nodes.near, "count": float(nodes.near_count), "far": 1 / FAR_STEP,
            "factor": math.pi * float(pair.E_star),
            **{str(k): row for k, row in enumerate(table.terms)},
        }  # fmt: skip
        (tree,) = ast.parse(_CURVE.format(last=table.terms.shape[1] - 1)).body
        assert isinstance(tree, ast.FunctionDef)
        return tree, {f"curve_{name}": value for name, value in curve.items()}
    if kernel.kind == TABLE:
        parts = kernel.parameters[1:].reshape(3, -1)
        (tree,) = ast.parse(_TABLE.format(last=parts.shape[1] - 1)).body
        assert isinstance(tree, ast.FunctionDef)
        return tree, dict(zip(("table_x", "table_y", "table_s"), parts, strict=True))
    names, body = _FORMULAS[kernel.kind]
    text = "def law(penetration: float) -> float:\n    if penetration <= 0.0:\n        return 0.0\n"
    (tree,) = ast.parse(f"{text}    {body}\n").body
    assert isinstance(tree, ast.FunctionDef)
    numbers = zip(names, map(float, kernel.parameters), strict=True)
    return tree, {f"law_{name}": value for name, value in numbers}


@dataclass(frozen=True)
class Element:
    """A force element between a bearing and a pin.

    `meanings` are the quantities and meanings of its results, which are fields of the program's
    `w`; those named penetration and penetration_rate have one number for each contact. `constants`
    are listed for readers: values, units and meanings. `checks` are impact rates, motions and
    wrenches, whose attributes are the results.
    """

    name: str
    title: str
    units: Literal["SI", "mm"]
    law_text: str
    motion: tuple[Motion, ...]
    meanings: Mapping[str, tuple[str, str]]
    constants: Mapping[str, tuple[float, str, str]]
    about: Sequence[str]
    assumptions: Sequence[str]
    checks: Sequence[tuple[Any, Sequence[float], Sequence[float], Any]]
    program: Program
    contacts: int = 1

    @property
    def results(self) -> list[Result]:
        """The parts of the wrench."""
        fields = self.program.work  # of a number the shape is ()
        return [Result(name, sum(fields[name].shape), *a) for name, a in self.meanings.items()]

    def comment(self, mark: str) -> str:
        """Return the comment at the top of a file, each line behind a `mark`."""
        u = "m" if self.units == "SI" else "mm"
        rows = {
            **self.constants,
            **{
                name: (x, *MEANINGS.get(name.removeprefix("law_"), ("", "of the law")))
                for name, x in self.program.numbers.items() if np.ndim(x) == 0
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


# --- in a language ---

# What a class cannot be called: its own members, and names of the standard headers.
_CPP = {"accept", "evaluate", "start", "state", "wrench", "main", "std", "gamma"}
_CPP |= {"j0", "j1", "jn", "y0", "y1", "yn"}


def source(element: Element, target: str, stem: str) -> dict[str, str]:
    """Return the texts of the files of an element in a language, by their names.

    Raises `InputError` if the language cannot have a file or a module of that name.
    """
    stem = stem or element.name
    require_callable(target, stem)
    taken = {"fortran": element.program.names, "cpp": _CPP}.get(target, ())
    name = element.name.lower() if target == "fortran" else element.name
    rule, remedy = f"is taken by something else in {target}", "give the joint another name"
    require(name not in taken, "export", "name", element.name, rule, remedy)
    parts = _parts(element, target, stem)
    if target in ("c", "cpp"):
        for key, shared in (("records", "types"), ("functions", "functions")):
            parts[key] = filled_template(f"joint.{shared}", parts).rstrip("\n")
    files = {f"{stem}{JOINT_TARGETS[target]}": filled_template(f"joint.{target}", parts)}
    if target == "c":
        files[f"{stem}.h"] = filled_template("joint.h", parts)
    return files


def _parts(element: Element, target: str, stem: str) -> dict[str, str]:
    """Return what the templates of a language ask for."""
    name, several, language = element.name, element.contacts > 1, LANGUAGES[target]()
    fields, values = list[str](), dict[str, None]()
    for each in element.results:
        kind = "array" if each.size else "number" if each.quantity else "integer"
        fields.append(language.kinds[kind].format(each.name, each.size))
        lines = (language.results[kind].format(each.name, k) for k in range(each.size or 1))
        values |= dict.fromkeys(lines)  # one line if it has no k, and gives the whole array
    program = element.program.parts(target)
    return {
        **program,
        "name": name,
        "stem": stem,
        "capitals": name.upper(),
        "imported": "import joint" if stem == "joint" else f"import {stem} as joint",
        "inline": "inline " if target == "cpp" else "",
        "several": "several" if several else "",
        "size": str(len(element.motion)),
        "contacts": str(element.contacts),
        "reference": "" if several else "&",
        "rates": "list(impact_rate)" if several else "[impact_rate]",
        "state": language.kinds["array" if several else "number"].format(
            "impact_rate", element.contacts
        ),
        "fields": "\n".join(fields),
        "results": "\n".join(values),
        "comment": element.comment(language.comment),
        "helpers": language.helpers_of(program["program"]),
        "nan_module": "use, intrinsic :: ieee_arithmetic" if "ieee_value" in str(program) else "",
    }
