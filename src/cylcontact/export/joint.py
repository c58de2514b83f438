"""A clearance joint in the neutral notation, from which every language is rendered.

The steps are those of `cylcontact.mechanism.joint`, in the units of the joint, so that no
language has formulas of its own. Only the law is in mm: the step `depth` is the one conversion.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import version
from textwrap import wrap

import numpy as np

from cylcontact.arrays import FloatArray, require
from cylcontact.export import JOINT_TARGETS
from cylcontact.export.dialects import JOINT_DIALECTS
from cylcontact.export.exported_law import (
    MEANINGS,
    declared,
    flat,
    paragraph,
    renamed,
    safe_names,
)
from cylcontact.export.render import WIDTH, Dialect, filled, filled_template
from cylcontact.impact import RATIO_BEND
from cylcontact.laws.formula import Step, names_in, needed, steps_of
from cylcontact.laws.kernels import TABLE
from cylcontact.laws.law import Law
from cylcontact.materials import Material
from cylcontact.mechanism.joint import TANGENT_FROM, ClearanceJoint, JointState
from cylcontact.plain_text import RESERVED, comment

# The motion of a body as it is passed; in the steps bearing_x and so on.
_MOTION = ("x", "y", "angle", "vx", "vy", "spin")

_MOTION_STEPS = """
cos_b = cos(bearing_angle)
sin_b = sin(bearing_angle)
cos_p = cos(pin_angle)
sin_p = sin(pin_angle)
arm_bx = cos_b*point_bearing_x - sin_b*point_bearing_y
arm_by = sin_b*point_bearing_x + cos_b*point_bearing_y
arm_px = cos_p*point_pin_x - sin_p*point_pin_y
arm_py = sin_p*point_pin_x + cos_p*point_pin_y
e_x = bearing_x + arm_bx - (pin_x + arm_px)
e_y = bearing_y + arm_by - (pin_y + arm_py)
u_x = bearing_vx - bearing_spin*arm_by - (pin_vx - pin_spin*arm_py)
u_y = bearing_vy + bearing_spin*arm_bx - (pin_vy + pin_spin*arm_px)
distance = sqrt(e_x*e_x + e_y*e_y)
n_x = e_x/distance if distance > 0 else 1
n_y = e_y/distance if distance > 0 else 0
delta = distance - clearance
rate = u_x*n_x + u_y*n_y
first_rate = impact_rate if impact_rate > 0 else max(rate, rate_floor)
next_rate = 0 if delta <= 0 else first_rate
radius = r_pin - delta
v_t = u_x*n_y - u_y*n_x + bearing_spin*r_bearing - pin_spin*radius
depth = in_mm*delta
"""
_LOAD_STEPS = "load = law(depth)\n"
_TANGENT_STEPS = """
tangent = last_load + last_slope*(depth - last_depth)
load = tangent if depth > last_depth else law(depth)
"""
_FORCE_STEPS = """
elastic = load*length
ratio = rate/first_rate
size = ratio if ratio > 0 else -ratio
beyond = max(size/bend - 1, 0)
bent = bend*(1 + beyond/hypot(1, beyond))
bound = bent if ratio > 0 else -bent
bounded = ratio if size <= bend else bound
normal = max(elastic*(1 + chi*bounded), 0)
speed = v_t if v_t > 0 else -v_t
ramp = (speed - v_0)/(v_1 - v_0)
part = ramp if ramp < 1 else 1
c_d = max(part, 0)
along = 1 if v_t > 0 else -1
tangential = -(friction*c_d*normal*along)
force_x = tangential*n_y - normal*n_x
force_y = -(normal*n_y) - tangential*n_x
moment_b = r_bearing*tangential + arm_bx*force_y - arm_by*force_x
moment_p = -(radius*tangential) - arm_px*force_y + arm_py*force_x
power = (normal - elastic)*rate - tangential*v_t
"""

# What the steps give to `evaluate`: the wrench's numbers in their order in `JointWrench`.
RESULTS = (
    "force_x", "force_y", "moment_b", "moment_p", "delta", "rate", "normal", "tangential", "v_t",
    "power", "flag",
)  # fmt: skip

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


@dataclass(frozen=True)
class Element:
    """A joint as steps and constants in neutral notation, which every language renders."""

    joint: ClearanceJoint

    @cached_property
    def evaluate(self) -> tuple[Step, ...]:
        """The steps from the motion and the state to `RESULTS`."""
        return needed(steps_of(self._text), *RESULTS)

    @cached_property
    def accept(self) -> tuple[Step, ...]:
        """The steps to `next_rate`."""
        return needed(steps_of(self._text), "next_rate")

    @cached_property
    def law(self) -> tuple[Step, ...]:
        """The steps from a penetration > 0 in mm, or the nodes around it, to f in N/mm."""
        return self._law[0]

    @property
    def law_constants(self) -> dict[str, float]:
        """The numbers that the steps of the law use."""
        return _used(self.law, {"pi": math.pi, **self._law[1]})

    @cached_property
    def _law(self) -> tuple[tuple[Step, ...], dict[str, float]]:
        """The steps of the law and the numbers of its formula at the pair."""
        law, pair = self.joint.law, self.joint.pair
        formula = law.formula_at(pair) if isinstance(law, Law) else None
        if self.table is not None or formula is None or not isinstance(law, Law):
            return steps_of(_TABLE_STEPS), {}
        numbers, steps = law.numbers_at(pair), needed(formula.scalar_steps, "f")
        names = safe_names(steps, numbers)
        own = {names[name]: float(value) for name, value in numbers.items()}
        return tuple(renamed(step, names) for step in steps), own

    @property
    def table(self) -> tuple[FloatArray, FloatArray, FloatArray] | None:
        """ln of the penetration, ln of the load and slopes; None if the law has a formula."""
        if self.joint.kernel.kind != TABLE:
            return None
        x, y, slopes = self.joint.kernel.parameters[1:].reshape(3, -1)
        return x, y, slopes

    def constants(self, steps: Iterable[Step]) -> dict[str, float]:
        """Return the numbers that some steps use."""
        return _used(steps, {name: value for name, (value, _, _) in self._constants.items()})

    @property
    def _text(self) -> str:
        """All steps."""
        load = _TANGENT_STEPS if self._ends else _LOAD_STEPS
        return _MOTION_STEPS + load + _FORCE_STEPS + self._flag_steps

    @property
    def _ends(self) -> bool:
        """Whether the law ends somewhere."""
        return bool(np.isfinite(self.joint.block["last_penetration"]))

    @property
    def _yields(self) -> bool:
        """Whether both yield stresses are known."""
        return bool(np.isfinite(self.joint.first_yield))

    @property
    def _flag_steps(self) -> str:
        beyond, above = "2 if depth > last_depth else 0", "1 if elastic > first_yield else 0"
        if self._ends and self._yields:
            return f"past = {beyond}\nyields = {above}\nflag = past + yields\n"
        return f"flag = {beyond if self._ends else above if self._yields else 0}\n"

    @cached_property
    def _constants(self) -> dict[str, tuple[float, str, str]]:
        """Value, unit and meaning of the constants of the steps."""
        joint, p = self.joint, self.joint.block
        u, mm = ("m" if joint.units == "SI" else "mm"), joint.in_mm
        R_i, R_j = (float(R) / mm for R in joint.pair.radii("the joint"))
        constants = {
            "clearance": (float(np.asarray(joint.pair.dR)) / mm, u, "radial clearance"),
            "r_bearing": (R_i, u, "radius of the hole"),
            "r_pin": (R_j, u, "radius of the pin"),
            "point_bearing_x": (joint.point_bearing[0] / mm, u, "centre of the hole, in the"),
            "point_bearing_y": (joint.point_bearing[1] / mm, u, "  axes of its body"),
            "point_pin_x": (joint.point_pin[0] / mm, u, "centre of the pin, in the"),
            "point_pin_y": (joint.point_pin[1] / mm, u, "  axes of its body"),
            "length": (float(p["length"]), "mm", "axial length; the law is per mm"),
            "in_mm": (mm, f"mm/{u}", "the law takes the penetration in mm"),
            "rate_floor": (joint.rate_floor, f"{u}/s", "slowest impact rate that counts"),
            "chi": (joint.chi, "-", "hysteresis factor"),
            "bend": (RATIO_BEND, "-", "ratio of rates from which the damping bends"),
            "friction": (joint.friction, "-", "friction coefficient"),
            "v_0": (joint.v0 / mm, f"{u}/s", "no friction up to this speed"),
            "v_1": (joint.v1 / mm, f"{u}/s", "all of the friction from this speed"),
        }
        if self._ends:
            constants |= {
                "last_depth": (float(p["last_penetration"]), "mm", "end of the law;"),
                "last_load": (float(p["last_load"]), "N/mm", "  beyond it the tangent:"),
                "last_slope": (float(p["last_slope"]), "N/mm^2", "  its load and slope"),
            }
        if self._yields:
            constants["first_yield"] = (joint.first_yield, "N", "elastic force at first yield")
        return constants

    def comment(self, usage: str, mark: str) -> str:
        """Return the comment at the top of a file, `usage` in it, each line behind a `mark`."""
        return "\n".join(f"{mark} {line}".rstrip() for line in self._description(usage))

    def _description(self, usage: str) -> list[str]:
        """Return the lines of `comment`."""
        joint, pair = self.joint, self.joint.pair
        u = "m" if joint.units == "SI" else "mm"
        bodies = {"hole": (pair.material_i, pair.R_i), "pin": (pair.material_j, pair.R_j)}
        units = (
            f"lengths in {u}, times in s, angles in rad, forces in N, moments in N {u}, powers in "
            f"N {u}/s; whatever the file of the joint had them in"
        )
        return [
            joint.identifier,
            "",
            f"A pin in its bearing with clearance as a force element, '{comment(joint.name)}'.",
            f"Written by cylcontact {version('cylcontact')}.",
            "",
            *paragraph("Units", units),
            *paragraph("Law", _law_text(joint)),
            *(_body_text(name, *body) for name, body in bodies.items()),
            "",
            "Use:",
            *(f"  {line}".rstrip() for line in usage.splitlines()),
            *_ARGUMENT_LINES,
            "",
            "Results:",
            *_RESULT_LINES,
            "",
            "Assumptions:",
            *self._assumptions(),
            "",
            "Constants:",
            *(
                f"  {name:<16} {value!r:<24} {unit:<7} {meaning}"
                for name, (value, unit, meaning) in self._constants.items()
            ),
            *(
                f"  {name:<16} {value!r:<24} {unit:<7} {meaning}"
                for name, value in self.law_constants.items()
                if name != "pi"
                for unit, meaning in [MEANINGS.get(name, ("", "of the law"))]
            ),
            "",
            "Check values, from the library:",
            *self._check_values(),
        ]

    def _assumptions(self) -> list[str]:
        """Return the assumptions, wrapped."""
        ends, yields = self._ends, self._yields
        texts = [
            "two rigid bodies in the plane; the contact is a line load over the length, at one "
            "point on the surface of the hole",
            "load = law(penetration)*length*(1 + chi*s), never negative, with s the ratio of the "
            "penetration rate to the impact rate",
            "s itself up to bend, bounded by 2*bend beyond (bend*(1 + v/sqrt(1 + v^2)) with v = "
            "abs(s)/bend - 1), so that damping is at most 2*bend*chi times the elastic load in "
            "sustained contact",
            "an impact slower than rate_floor counts as one at rate_floor",
            "friction = friction*normal force, linearly from none at v_0 to all at v_1",
        ]
        if ends:
            texts.append(
                f"beyond last_depth, {TANGENT_FROM:.0%} of the largest penetration of the law or "
                "its table, the load goes on along the tangent, and flag has the bit 2"
            )
        texts.append(
            "the material is elastic; above first_yield, von Mises, flag has the bit 1"
            if yields
            else "the material is elastic, and as the yield stresses are not both known, flag "
            "never has the bit 1"
        )
        return [
            line for text in texts for line in wrap(f"  - {text}", WIDTH, subsequent_indent=4 * " ")
        ]

    def _check_values(self) -> Iterator[str]:
        """Yield states and their wrenches: free, first touch, pressed and sliding, leaving."""
        joint, mm = self.joint, self.joint.in_mm
        clearance = self._constants["clearance"][0]
        speed = 50.0 / mm
        start = [x / mm for x in joint.point_bearing]
        for kept, part, rate, spin in (
            (0.0, 0.5, 1.0, 0.0), (0.0, 1.001, 1.0, 2.0), (1.0, 1.004, 0.25, -30.0),
            (1.0, 1.002, -0.75, 30.0),
        ):  # fmt: skip
            away, fast = part * clearance, rate * speed
            bearing = [0.0, 0.0, 0.0, 0.0, 0.0, spin]
            pin = [start[0] + 0.6 * away, start[1] + 0.8 * away, 0.0, 0.6 * fast, 0.8 * fast, 0.0]
            wrench = joint.evaluate(JointState(kept * speed), bearing, pin)
            numbers = (
                *wrench.force_bearing, wrench.moment_bearing, wrench.moment_pin, *wrench[4:],
            )  # fmt: skip
            yield f"  impact_rate {kept * speed!r}"
            yield from _rows("bearing", map(repr, bearing))
            yield from _rows("pin", map(repr, pin))
            yield from _rows(
                "gives", (f"{n} {x.item()!r}" for n, x in zip(_WRENCH_NAMES, numbers, strict=True))
            )


_WRENCH_NAMES = (
    "force_bearing_x", "force_bearing_y", "moment_bearing", "moment_pin", "penetration",
    "penetration_rate", "normal_force", "friction_force", "tangential_velocity",
    "dissipated_power", "flag",
)  # fmt: skip
_ARGUMENT_LINES = (
    "",
    "  bearing and pin are x, y, angle, v_x, v_y and spin of the reference points of the two",
    "  bodies. evaluate changes nothing: call it as often as the solver likes. Call accept once",
    "  after each accepted step, or at the onset of a contact, located as the root of the",
    "  penetration, and whenever the contact ends: it alone changes the state, the penetration",
    "  rate at first touch (impact_rate, 0 without contact). Each joint has a state of its own.",
)
_RESULT_LINES = (
    "  force_bearing, moment_bearing   on the body with the hole, at its reference point",
    "  force_pin, moment_pin           on the body with the pin, at its reference point",
    "  penetration, penetration_rate   of the surfaces; negative where they do not touch",
    "  normal_force, friction_force    of the force on the hole, along -n and t = (n_y, -n_x), n",
    "                                  from the centre of the pin to that of the hole",
    "  tangential_velocity             of the hole against the pin at the contact, along t",
    "  dissipated_power                by damping and friction, never negative",
    "  flag                            0, or 1 above first yield, plus 2 beyond the law",
)


# How a file is used, for its comment.
_USES = {
    "c": """\
#include "$stem.h" and link with -lm:

  ${name}_state state;
  ${name}_wrench wrench;
  ${name}_start(&state);
  ${name}_evaluate(&state, bearing, pin, &wrench);   (state is not changed)
  ${name}_accept(&state, bearing, pin);""",
    "cpp": """\
#include "$stem.hpp":

  $name joint;                                         (without contact)
  $name::wrench wrench = joint.evaluate(bearing, pin); (changes nothing)
  joint.accept(bearing, pin);""",
    "fortran": """\
use $name

type(${name}_state) :: state
type(${name}_wrench) :: wrench
call ${name}_start(state)
call ${name}_evaluate(state, bearing, pin, wrench)   (state is not changed)
call ${name}_accept(state, bearing, pin)""",
    "matlab": """\
joint = $stem();                                     (this file is $stem.m)

impact_rate = joint.start();                         (the state: 0, not in contact)
wrench = joint.evaluate(impact_rate, bearing, pin);
impact_rate = joint.accept(impact_rate, bearing, pin);""",
    "python": """\
$imported

impact_rate = joint.start()      (the state: 0, not in contact)
wrench = joint.evaluate(impact_rate, bearing, pin)
impact_rate = joint.accept(impact_rate, bearing, pin)""",
}
# Of each language: a number of a body, the index of its first one, and what ends a line of a table.
_ARRAYS = {
    "c": ("{body}[{k}]", 0, ",\n        "),
    "cpp": ("{body}[{k}]", 0, ",\n        "),
    "fortran": ("{body}({k})", 1, ", &\n    "),
    "matlab": ("{body}({k})", 1, ", ...\n        "),
    "python": ("{body}[{k}]", 0, ",\n    "),
}
# The standard allows 255 lines for a statement of Fortran, so a table is cut into arrays.
_NODES = 800


def source(joint: ClearanceJoint, target: str, stem: str) -> dict[str, str]:
    """Return the texts of the files of a joint in a language, by their names."""
    element, name, stem = Element(joint), joint.identifier, stem or joint.identifier
    if target in ("matlab", "python"):
        require(
            stem.isascii() and stem.isidentifier() and stem not in RESERVED, "export", "--out",
            stem, "cannot be called by its name",
            "name the file with letters, digits and underscores",
        )  # fmt: skip
    form, first, line_end = _ARRAYS[target]
    names = {
        f"{body}_{part}": form.format(body=body, k=k)
        for body in ("bearing", "pin")
        for k, part in enumerate(_MOTION, first)
    }
    own = {"c": f"{name}_law", "cpp": f"{name}_law", "matlab": "law_load", "python": "_law"}
    names["law"] = own.get(target, "law")
    if target == "fortran":
        names["impact_rate"] = "state%impact_rate"
    dialect = JOINT_DIALECTS[target]
    dialect = replace(dialect, names={**dialect.names, **names})
    parts = {
        "name": name,
        "stem": stem,
        "capitals": name.upper(),
        "imported": "import joint" if stem == "joint" else f"import {stem} as joint",
        "static": "inline" if target == "cpp" else "static",
        "inline": "inline " if target == "cpp" else "",
        **_bodies(element, dialect),
        "evaluate_variables": declared(element.evaluate),
        "accept_variables": declared(element.accept),
        "law_variables": declared(step for step in element.law if step.name != "f"),
        "table": "",
    }
    parts["helpers"] = dialect.helpers_of(parts["law"])
    has_nan = "ieee_value" in parts["law"]
    parts["nan_module"] = "use, intrinsic :: ieee_arithmetic" if has_nan else ""
    if element.table is not None:
        nodes = element.table[0].size
        parts |= {"nodes": str(nodes), "last": str(nodes - 1 + first), "table": "a table"}
        for key, numbers in zip("xys", element.table, strict=True):
            parts[key] = _lines_of(numbers, dialect, line_end)
        if target == "fortran":
            parts["table"] = _fortran_arrays(element.table, dialect, line_end)
    parts["comment"] = element.comment(filled(_USES[target], parts), dialect.comment)
    if target in ("c", "cpp"):
        for shared in ("types", "functions"):
            parts[shared] = filled_template(f"joint.{shared}", parts).rstrip("\n")
    suffix = JOINT_TARGETS[target]
    files = {f"{stem}{suffix}": filled_template(f"joint.{target}", parts)}
    if target == "c":
        files[f"{stem}.h"] = filled_template("joint.h", parts)
    return files


def _bodies(element: Element, dialect: Dialect) -> dict[str, str]:
    """Return the bodies of law, `evaluate` and `accept`, each with its constants, in a language."""
    parts = {
        "law": dialect.statements(element.law),
        "law_constants": dialect.constants(
            {n: x for n, x in element.law_constants.items() if n not in dialect.names}
        ),
    }
    for function, steps in (("evaluate", element.evaluate), ("accept", element.accept)):
        parts[function] = dialect.statements(steps)
        parts[f"{function}_constants"] = dialect.constants(element.constants(steps))
    return parts


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


def _rows(title: str, texts: Iterable[str]) -> Iterator[str]:
    """Yield texts after a title, three a line."""
    listed = list(texts)
    for first in range(0, len(listed), 3):
        yield f"    {'' if first else title:<8} " + ", ".join(listed[first : first + 3])


def _used(steps: Iterable[Step], numbers: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers whose names some steps use."""
    names = set().union(*(names_in(step.value) for step in flat(steps)))
    return {name: value for name, value in numbers.items() if name in names}


def _law_text(joint: ClearanceJoint) -> str:
    """Return the law and the origin of its coefficients in words."""
    is_table = joint.kernel.kind == TABLE
    form = "a table, cubic in ln f over ln d" if is_table else "its formula at this pair"
    origin = f"; {comment(joint.origin)}" if joint.origin else ""
    return f"'{comment(joint.law.name)}', {form}{origin}"


def _body_text(name: str, material: Material, radius: object) -> str:
    """Return radius and material of a body on one line."""
    stress = "unknown" if material.yield_stress is None else f"{material.yield_stress!r} MPa"
    return (
        f"{name}: R = {radius!r} mm, {comment(material.name)}, E = {float(material.E)!r} MPa, "
        f"nu = {float(material.nu)!r}, yield stress {stress}"
    )
