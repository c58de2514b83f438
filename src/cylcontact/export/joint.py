"""A clearance joint as a force element in C, Fortran and MATLAB, in the plane and in space.

Both are `evaluate` and `accept` of `cylcontact.joint`, translated with what they call.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import version
from textwrap import wrap
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.export import conformal
from cylcontact.export.languages import WIDTH, C, Fortran, Matlab, filled, require_callable
from cylcontact.export.plain import Program, fields_of
from cylcontact.impact import RATIO_BEND
from cylcontact.joint import (
    ClearanceJoint,
    JointState,
    SpatialJoint,
    SpatialState,
    contact,
    derivatives,
    spatial_forces,
)
from cylcontact.joint.contact import DEEPEST_SHARE
from cylcontact.laws import Conformal
from cylcontact.laws.kernels import TABLE
from cylcontact.laws.lambert import OF_NUMBERS
from cylcontact.laws.tabulated import load_of_table, stiffness_of_table
from cylcontact.support.arrays import FloatArray, require
from cylcontact.support.plain_text import comment

LANGUAGES: dict[str, type[C]] = {"c": C, "fortran": Fortran, "matlab": Matlab}
# What a body is, by how many numbers.
MOTIONS = {
    6: ("x", "y", "angle", "v_x", "v_y", "spin"),
    13: (
        "x", "y", "z", "q_w", "q_x", "q_y", "q_z",
        "v_x", "v_y", "v_z", "spin_x", "spin_y", "spin_z",
    ),
}  # fmt: skip
# The meanings of a joint's constants.
_ABOUT = {
    "clearance": "m, radial", "R_bearing": "m, radius of the hole", "R_pin": "m, radius of the pin",
    "length": "mm, of the contact", "metres": "m, the unit of length of the arguments",
    "rate_floor": "m/s, slowest impact rate that counts", "chi": "hysteresis factor",
    "friction": "coefficient", "v0": "m/s, no friction below: above 0 none at rest",
    "v1": "m/s, all of it above",
    "last_penetration": "mm, end of the law", "last_load": "N/mm, there",
    "last_slope": "N/mm^2, there", "first_yield": "N, elastic force at first yield",
    "x_i": "m, centre of the hole in the axes of its body", "y_i": "m",
    "x_j": "m, centre of the pin in the axes of its body", "y_j": "m",
}  # fmt: skip
_ABOUT_SPATIAL = {
    "clearance": "mm, radial", "R_hole": "mm", "R_pin": "mm", "half": "mm, half of the length",
    "in_mm": "mm, the unit of length of the arguments", "rate_floor": "mm/s",
    "chi": "hysteresis factor", "friction": "coefficient",
    "v0": "mm/s, no friction below: above 0 none at rest",
    "v1": "mm/s, all of it above", "last_penetration": "mm, end of the law",
    "yields": "N/mm, line load at first yield",
}  # fmt: skip
# The meanings of the numbers of a wrench; {u} is the unit of length.
MEANINGS = {
    "force_bearing": "N, on the body with the hole",
    "moment_bearing": "N {u}, about its reference point",
    "force_pin": "N, on the body with the pin",
    "moment_pin": "N {u}, about its reference point",
    "penetration": "{u}, negative where the bodies do not touch",
    "penetration_rate": "{u}/s",
    "normal_force": "N, not negative",
    "friction_force": "N, on the hole along t",
    "tangential_velocity": "{u}/s, of the hole against the pin along t",
    "dissipated_power": "N {u}/s, by damping and friction, not negative",
    "elastic_energy": "N {u}, stored in the contacts",
    "touched": "{u}, length of the wall that touches",
    "flag": "sum of 1 above first yield, 2 beyond the law, 32 pin has left its hole, 128 no number",
}
_SPATIAL_FLAG = (
    "sum of 1 above first yield, 2 beyond the law, 4 no rims, 8 tilt above 0.1, 16 unlike "
    "materials at a rim, 32 pin has left its hole, 64 pin has slid out, 128 no number, 256 "
    "housing bends unevenly"
)
_FRAMES = {
    contact: (
        "The mechanics is in SI, the law in mm and N/mm. Body i has the hole, body j the pin; n "
        "points from the pin's centre to the hole's, and t = (n_y, -n_x)."
    ),
    spatial_forces: (
        "Inside, lengths are in mm and forces in N. The frame is that of the hole, z along its "
        "axis; b is the body with the hole and p the body with the pin."
    ),
}


@dataclass(frozen=True)
class Element:
    """A joint with the module of its compiled functions."""

    joint: ClearanceJoint | SpatialJoint

    @property
    def planar(self) -> ClearanceJoint:
        """The joint in the plane."""
        return self.joint if isinstance(self.joint, ClearanceJoint) else self.joint.planar

    @property
    def module(self) -> ModuleType:
        """The module of the functions."""
        return contact if self.joint is self.planar else spatial_forces

    @property
    def contacts(self) -> int:
        """The number of impact rates in the state: one for each place of contact."""
        return int(np.prod(self.module.STATE["impact_rate"].shape, dtype=int))

    @property
    def size(self) -> int:
        """The number of coordinates and velocities of a body, as `MOTIONS` lists them."""
        return 6 if self.module is contact else 13

    @property
    def unit(self) -> str:
        """The unit of length of arguments and results."""
        return "m" if self.planar.units == "SI" else "mm"

    @property
    def record(self) -> Any:
        """The joint's numbers."""
        return self.planar.block if self.joint is self.planar else self.joint.record

    @property
    def about(self) -> Mapping[str, str]:
        """What the joint's numbers are."""
        return _ABOUT if self.module is contact else _ABOUT_SPATIAL

    def meaning(self, name: str) -> str:
        """Return what a number of the wrench is, with its unit."""
        if name == "flag" and self.module is spatial_forces:
            return _SPATIAL_FLAG
        return MEANINGS[name].format(u=self.unit)

    @cached_property
    def law(self) -> Law:
        """The law at the pair."""
        return law_of(self.planar)

    @property
    def records(self) -> dict[str, Any]:
        """The records of joint and law, by the arguments that have them."""
        return {"joint": self.record, "law": self.law.record}

    def program(self, *functions: str) -> Program:
        """Return functions of the module, with the law that they call."""
        program = Program({name: record.dtype for name, record in self.records.items()})
        program.instead.update(OF_NUMBERS)
        text = _LOAD.format(call=self.law.call)
        program.instead[contact.load_at] = program.read_text(text, self.law.names)
        text = _PULL.format(call=self.law.call, stiffness=self.law.stiffness)
        if self.module is contact:
            names, kind = {**self.law.names, "Pull": derivatives.Pull}, derivatives.Pull
            pull = program.read_text(text, names, {"return": kind})
            program.instead[derivatives.pull_at] = pull
        for name in functions:
            module = derivatives if name in _OF_PLANAR else self.module
            program.read(getattr(module, name))
        return program

    def language(self, target: str, program: Program) -> C:
        """Return a program in a language."""
        name, module = self.planar.identifier, self.module
        public = {module.STATE: f"{name}_state", module.WRENCH: f"{name}_wrench"}
        if derivatives.JACOBIAN in program.types:
            public[derivatives.JACOBIAN] = f"{name}_jacobian"
        records = {self.record.dtype: "Joint", self.law.record.dtype: "Law"}
        if module is spatial_forces:
            records[module.WORK] = "Work"
        return LANGUAGES[target](program, records | public, [*public])

    def source(self, target: str, stem: str = "") -> dict[str, str]:
        """Return the texts of the files by their names."""
        name = self.planar.identifier
        stem = stem or name
        require_callable(target, stem)
        more = _OF_PLANAR if self.module is contact else ()
        program = self.program("evaluate", "accept", *more)
        functions = {f.name.lower() for f in program.functions.values()} | {"start"}
        called = {"fortran": ("name", name), "matlab": ("--out", stem)}.get(target, ("", ""))
        taken = functions | ({"law", "joint"} if target == "fortran" else set())
        rule, remedy = f"is taken by something else in {target}", "choose another name"
        require(called[1].lower() not in taken, "export", *called, rule, remedy)
        language = self.language(target, program)
        suffixes = (".c", ".h") if target == "c" else (language.suffix,)
        parts = {**self.parts(language), "stem": stem}
        return {f"{stem}{suffix}": language.file(parts, f"joint{suffix}") for suffix in suffixes}

    def parts(self, language: C) -> dict[str, str]:
        """Return what the templates of a language ask for."""
        name, module, mark = self.planar.identifier, self.module, language.comment
        rate = language.declared("impact_rate", fields_of(module.STATE)["impact_rate"])
        wrench = [
            f"{language.declared(n, kind)}{language.end} {mark} {self.meaning(n)}"
            for n, kind in fields_of(module.WRENCH).items()
        ]
        if isinstance(language, Matlab):
            wrench = [language.zeros(module.WRENCH)]
        abouts = {"joint": self.about, "law": {}}
        return {
            **language.parts(), **self.scratch(language), **self.planar_parts(language),
            "name": name, "capitals": name.upper(),
            "contacts": str(self.contacts), "size": str(self.size), "wrench": "\n".join(wrench),
            "state": rate + language.end,
            "about": f"\n{mark} ".join(wrap(_FRAMES[module], WIDTH - 3)),
            "comment": "\n".join(f"{mark} {x}".rstrip() for x in self._comment()),
            **{
                of: language.constant(f"this_{of}", record.dtype, record, abouts[of])
                for of, record in self.records.items()
            },
        }  # fmt: skip

    def planar_parts(self, language: C) -> dict[str, str]:
        """Return the parts that a joint in the plane alone has: derivatives and energy."""
        suffix = language.suffix
        files = {"planar": f"planar{suffix}"}
        files |= {
            ".c": {"planar_heads": "planar.h"},
            ".f90": {"planar_types": "planar_types.f90"},
            ".m": {"planar_blocks": "planar_blocks.m"},
        }[suffix]
        if self.module is not contact:
            return dict.fromkeys(files, "")
        parts = {"name": self.planar.identifier}
        if isinstance(language, Matlab):
            parts["jacobian"] = language.zeros(derivatives.JACOBIAN)
        return {key: filled(parts, file) for key, file in files.items()}

    def scratch(self, language: C) -> dict[str, str]:
        """Return the declaration of the work record of a joint in space, and how it is passed."""
        if self.module is contact:
            return {"work": "", "w": ""}
        if isinstance(language, Matlab):
            zeros = language.zeros(self.module.WORK)
            return {"work": f"function w = no_work()\nw = {zeros};\nend", "w": "no_work(), "}
        declared = language.declared("w", self.module.WORK) + language.end
        return {"work": declared, "w": "w, " if isinstance(language, Fortran) else "&w, "}

    def _comment(self) -> list[str]:
        """Return the lines at the top of a file."""
        joint, pair, u = self.planar, self.planar.pair, self.unit
        origin = f"; {comment(joint.origin)}" if joint.origin else ""
        texts = [
            f"{joint.identifier}: a pin in its bearing with clearance, '{comment(joint.name)}'.",
            f"Written by cylcontact {version('cylcontact')}.",
            "",
            f"Units: lengths in {u}, times in s, angles in rad, forces in N, moments in N {u}, "
            f"powers in N {u}/s.",
            f"Law: '{comment(joint.law.name)}', {self.law.form}{origin}.",
        ]
        radii = map(float, pair.radii("the joint"))
        for name, body, R in zip(
            ("Hole", "Pin"), (pair.material_i, pair.material_j), radii, strict=True
        ):
            stress = "unknown" if body.yield_stress is None else f"{body.yield_stress!r} MPa"
            # A body that is given by numbers has only the name of its part.
            of = "" if body.name in ("bearing", "pin") else f"{comment(body.name)}, "
            texts.append(
                f"{name}: R = {R!r} mm, {of}E = {float(body.E)!r} MPa, "
                f"nu = {float(body.nu)!r}, yield stress {stress}."
            )
        texts += [
            f"Arguments: bearing and pin are {', '.join(MOTIONS[self.size])} of the reference "
            "points of the two bodies. evaluate changes nothing: call it as often as the solver "
            "likes. Call accept once after each accepted step, or at the onset of a contact, "
            "located as the root of the penetration, and whenever the contact ends: it alone "
            "changes the state, the penetration rate at first touch (impact_rate, 0 without "
            "contact). Each joint needs a state of its own.",
            "Assumptions: rigid bodies but for the contact; the load is that of the law times "
            "1 + chi*s, never negative, s the ratio of penetration rate and impact rate, bounded "
            f"smoothly above {RATIO_BEND:g}; an impact slower than 1 mm/s counts as one of 1 mm/s; "
            "beyond the end of the law the load follows its tangent; a v0 above 0 means no static "
            "friction; beyond a penetration of "
            f"{DEEPEST_SHARE:g} times the hole's radius the load means nothing (flag 32).",
            *self._check(),
        ]  # fmt: skip
        return [
            line for text in texts for line in wrap(text, WIDTH - 3, subsequent_indent="  ") or [""]
        ]

    def _check(self) -> list[str]:
        """Return a motion and its wrench, to check a build against."""
        joint, mm = self.planar, self.planar.in_mm
        away, speed = 1.004 * joint.radial / mm, 50.0 / mm
        if isinstance(self.joint, SpatialJoint):
            lean = 0.3 * joint.radial / self.joint.spec.length
            bearing = [0.0] * 3 + [1.0] + [0.0] * 9
            pin = [away, 0.0, 0.0, 1.0, 0.0, lean, 0.0, 0.25 * speed, 0.0, 0.0, 0.0, 0.5, 0.0]
            rates: Any = np.array([0.0, speed, 0.0, 0.0])
            wrench: Any = self.joint.evaluate(SpatialState(rates), bearing, pin)
        else:
            x, y = (point / mm for point in joint.point_bearing)
            bearing = [0.0, 0.0, 0.0, 0.0, 0.0, -30.0]
            pin = [x + 0.6 * away, y + 0.8 * away, 0.0, 0.15 * speed, 0.2 * speed, 0.0]
            rates = speed
            wrench = joint.evaluate(JointState(rates), bearing, pin)
        given = {"impact_rate": rates, "bearing": bearing, "pin": pin}
        names = ("force_pin", "moment_pin", "moment_bearing", "penetration")
        return ["Check: with", *_rows(given), "evaluate gives",
                *_rows({name: getattr(wrench, name) for name in names})]  # fmt: skip


def _rows(numbers: Mapping[str, Any]) -> list[str]:
    """Return numbers by their names, a line each."""
    return [
        f"  {name} {', '.join(map(repr, np.ravel(each).tolist()))}"
        for name, each in numbers.items()
    ]


# --- the law in a file ---


class Law(NamedTuple):
    """A law at a pair in a file, as text of plain Python.

    `call` is the load at `depth` in mm, from the numbers of the record `law`, and `stiffness` its
    slope; `names` are what the text calls. `tune` sets the numbers for a clearance `dR` in mm,
    empty if that has no formula, and `end` is the largest penetration.
    """

    call: str
    stiffness: str
    names: dict[str, Any]
    record: Any
    form: str
    tune: tuple[str, ...] = ()
    end: str = "inf"


def _record(numbers: Mapping[str, Any]) -> Any:
    """Return numbers as a record."""
    kinds = {name: np.int64 if isinstance(x, int) else np.float64 for name, x in numbers.items()}
    return np.array([tuple(numbers.values())], [*kinds.items()])[0]


_LOAD = """
def load_at(depth, joint, law):
    '''Return the load in N/mm at a penetration in mm, NaN at NaN.'''
    if depth <= 0.0:
        return 0.0
    if not depth > 0.0:
        return depth
    return {call}
"""


_PULL = """
def pull_at(depth, joint, law):
    '''Return load and stiffness at a penetration in mm that is positive, NaN at NaN.'''
    if not depth > 0.0:
        return Pull(depth, depth)
    return Pull({call}, {stiffness})
"""
# Of a joint in the plane alone.
_OF_PLANAR = ("evaluate_jacobian", "differentiate", "elastic_energy")


def with_clearance(joint: ClearanceJoint, dR: float | FloatArray) -> ClearanceJoint:
    """Return a joint with another clearance in mm, or several, by the pin's radius."""
    pair = joint.pair
    other = CylinderPair.from_dR(
        "internal", dR, length=pair.length, R_i=pair.R_i, pin=pair.material_j,
        hole=pair.material_i, plane=pair.plane,
    )  # fmt: skip
    return replace(joint, pair=other)


def law_of(joint: ClearanceJoint) -> Law:
    """Return the law of a joint at its pair."""
    law: Any = joint.law
    pair, form = joint.pair, "its formula at this pair"
    if isinstance(law, Conformal):
        formula, constants = conformal.table_of(law, pair, conformal.FINE)
        form = f"a curve, within {conformal.FINE[-1]:g} of its load"
    elif joint.kernel.kind == TABLE:
        x, y, slopes = np.reshape(joint.kernel.parameters[1:], (3, -1))
        arrays = {"table_x": x, "table_y": y, "table_slopes": slopes}
        rest = f"(depth, {', '.join(arrays)}, law.nodes)"
        names = {**arrays, "load_of_table": load_of_table, "stiffness_of_table": stiffness_of_table}
        record, form = _record({"nodes": x.size}), "a table of ln f by ln d"
        return Law(f"load_of_table{rest}", f"stiffness_of_table{rest}", names, record, form)
    else:
        formula, constants = law.formula_at(pair), law.constants_for("internal")
    given = {name: getattr(pair, name) for name in formula.of_pair} | {**constants}
    asked = {n: v if np.ndim(v) or isinstance(v, int) else float(v) for n, v in given.items()}
    values = dict(zip(formula.taken, formula.numbers_of(**asked), strict=True))
    arrays = {f"table_{name}": value for name, value in values.items() if np.ndim(value)}
    named = [f"table_{n}" if np.ndim(value) else f"law.{n}" for n, value in values.items()]
    numbers = {
        name: value if isinstance(value, int) else float(value)
        for name, value in values.items() if not np.ndim(value)
    }  # fmt: skip
    tuned = {"dR": "dR", "R_j": f"{asked.get('R_i')!r} - dR"}
    if formula.numbers is None:
        tune = [f"law.{name} = {text}" for name, text in tuned.items() if name in numbers]
    else:
        at = ", ".join(tuned.get(name, repr(asked[name])) for name in formula.asked)
        tune = [f"at = numbers({at})", *(f"law.{name} = at.{name}" for name in values)]
    end = "inf"
    if formula.end is not None and math.isfinite(joint.kernel.max_penetration):
        end = f"end({', '.join(f'law.{name}' for name in formula.taken_by_end)})"
    elif math.isfinite(constants.get("largest", math.inf)):
        end = "law.largest * dR"
    asked_of = ("load", "stiffness", "numbers", "end")
    functions = {n: f for n in asked_of if (f := getattr(formula, n)) is not None}
    names = functions | arrays | {"inf": math.inf}
    rest = f"(depth, {', '.join(named)})"
    texts = f"load{rest}", f"stiffness{rest}"
    return Law(*texts, names, _record(numbers), form, tuple(tune), end)
