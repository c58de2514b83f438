"""A clearance joint as an FMU by FMI 2.0: its C, the standard's functions around it, a library.

Each instance has its own clearance, friction and restitution, and its own numbers of joint and law,
which `tune` sets.
"""

from __future__ import annotations

import hashlib
import io
import math
import shutil
import subprocess
import sys
import uuid
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, NamedTuple
from xml.sax.saxutils import quoteattr

import numpy as np

from cylcontact.export.joint import MOTIONS, Element, with_clearance
from cylcontact.export.languages import C, filled
from cylcontact.export.plain import Vector, fields_of
from cylcontact.impact import IMPACT_RATE_FLOOR, hysteresis_factor
from cylcontact.joint import ClearanceJoint, contact
from cylcontact.joint.clearance import MOST_FRICTION, TANGENT_FROM
from cylcontact.laws.tabulated import load_of_table
from cylcontact.limits import yield_load
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import comment

# What pip cannot install, and the folder, suffix and flags of a shared library.
_COMPILERS = ("cc", "gcc")
_LIBRARIES = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("win", ".dll")}
_FLAGS = ("-shared", "-fPIC", "-O2", "-std=c99")
# The earliest time that a zip archive can hold, so that equal contents make equal files.
_EPOCH = (1980, 1, 1, 0, 0, 0)
# At an event, bodies that approach each other within this distance in mm touch: whoever locates
# the root of the penetration leaves a small error on either side.
_TOUCH = 1e-6
# The step in s that importers propose.
_STEP = 1e-6
# Parameters: clearances from a fifth to five times that of the file at these nodes, restitutions
# from this on in even steps.
_CLEARANCES = np.geomspace(0.2, 5.0, 33)
_LEAST_RESTITUTION, _RESTITUTIONS = 0.05, 96
# Units by the beginnings of names, with the unit of length for u, and their exponents of kg, m, s.
_UNITS = {
    "spin": "rad/s", "v_": "u/s", "angle": "rad", "q_": "", "penetration_rate": "u/s",
    "tangential_velocity": "u/s", "impact_rate": "u/s", "force": "N", "normal_force": "N",
    "friction_force": "N", "moment": "N.u", "dissipated_power": "N.u/s", "elastic_energy": "N.u",
    "friction": "", "restitution": "",
}  # fmt: skip
_EXPONENTS = {
    "u": 'm="1"', "u/s": 'm="1" s="-1"', "rad": 'rad="1"', "rad/s": 'rad="1" s="-1"',
    "N": 'kg="1" m="1" s="-2"', "N.u": 'kg="1" m="2" s="-2"', "N.u/s": 'kg="1" m="2" s="-3"',
}  # fmt: skip
_MOTION = {
    "x": "position", "y": "position", "z": "position", "angle": "angle, anticlockwise",
    "q_w": "quaternion from the body's axes to the world's, of any length but 0",
    "v": "velocity", "spin": "angular velocity",
}  # fmt: skip

Nodes = Annotated[FloatArray, 0]
# The end of a law at another clearance.
_END = """
deepest = {part!r} * {end}
joint.last_penetration = deepest
joint.last_load = load_at(deepest, joint, law)
more = load_at(deepest * 1.000006, joint, law)
joint.last_slope = (more - load_at(deepest * 0.999994, joint, law)) / (deepest * 1.2e-5)
"""


def cubic_at(place: float, values: Nodes, last: int) -> float:
    """Return the cubic through the four values around a place that is counted in intervals."""
    k = int(min(max(place - 1.0, 0.0), last - 3.0))
    x = place - k
    first = values[k] * (x - 1.0) * (x - 2.0) * (3.0 - x) / 6.0
    second = values[k + 1] * x * (x - 2.0) * (x - 3.0) / 2.0
    third = values[k + 2] * x * (x - 1.0) * (3.0 - x) / 2.0
    return float(first + second + third + values[k + 3] * x * (x - 1.0) * (x - 2.0) / 6.0)


class Variable(NamedTuple):
    """A real variable: its name, unit, causality and description, and its start and bounds."""

    name: str
    unit: str
    causality: str
    about: str
    start: float | None = None
    bounds: tuple[float, float] | None = None

    def line(self, reference: int) -> str:
        """Return its line in modelDescription.xml."""
        kind = {"local": ' variability="discrete"', "parameter": ' variability="tunable"'}
        more = f' unit="{self.unit}"' if self.unit else ""
        if self.bounds is not None:
            more += "".join(
                f' {end}="{x!r}"' for end, x in zip(("min", "max"), self.bounds, strict=True)
            )  # fmt: skip
        more += "" if self.start is None else f' start="{self.start!r}"'
        return (
            f'<ScalarVariable name="{self.name}" valueReference="{reference}" '
            f'causality="{self.causality}"{kind.get(self.causality, "")}\n'
            f"    description={quoteattr(self.about)}><Real{more}/></ScalarVariable>"
        )


@dataclass(frozen=True)
class JointFmu:
    """The FMU of a joint."""

    element: Element

    @property
    def joint(self) -> ClearanceJoint:
        """The joint in the plane."""
        return self.element.planar

    @cached_property
    def language(self) -> C:
        """The joint's functions in C."""
        more = ["differentiate"] if self.element.contacts == 1 else []
        program = self.element.program("evaluate", "accept", "ahead", *more)
        program.functions["tune"] = program.read_text(self._tune(), self._names(), {"return": None})
        return self.element.language("c", program)

    def _names(self) -> dict[str, Any]:
        """Return what the names of `tune` mean."""
        names = {**self.element.law.names, "load_of_table": load_of_table, "cubic_at": cubic_at}
        names |= {"load_at": contact.load_at, "sqrt": math.sqrt}
        nodes = np.linspace(_LEAST_RESTITUTION, 1.0, _RESTITUTIONS + 1)
        chi = hysteresis_factor(self.joint.data["dissipation"]["factor"])
        names["table_chi"] = nodes * chi(nodes)
        if self.joint.can_yield and self.element.law.tune:
            x = np.log(self.clearances * self.joint.in_mm)
            pairs = with_clearance(self.joint, np.exp(x)).pair
            y = np.log(yield_load(pairs, housing=self.joint.housing) * pairs.contact_length("it"))
            names |= {
                "yield_dR": x,
                "yield_load": y,
                "yield_slopes": np.gradient(y, x, edge_order=2),
            }
        return names

    @property
    def clearances(self) -> FloatArray:
        """The clearances of the nodes, which a pin can have."""
        most = 0.5 * float(self.joint.pair.radii("the joint")[0])
        mm = np.minimum(_CLEARANCES * self.joint.radial, most)
        return np.unique(mm) / self.joint.in_mm

    def _tune(self) -> str:
        """Return the text of `tune`, which sets what depends on the parameters."""
        step = (1.0 - _LEAST_RESTITUTION) / _RESTITUTIONS
        place = f"(restitution - {_LEAST_RESTITUTION!r}) / {step!r}"
        lines = [
            f"def tune({', '.join(v.name for v in self.parameters)}, joint, law):",
            "'Set what depends on the parameters; a clearance is in the unit of the joint.'",
            "joint.friction = friction",
            f"joint.chi = cubic_at({place}, table_chi, {_RESTITUTIONS}) / restitution",
            *(self._tune_clearance() if self.element.law.tune else []),
        ]
        return "\n    ".join(lines)

    def _tune_clearance(self) -> Iterator[str]:
        """Yield the lines that follow the clearance."""
        joint, law, spatial = self.joint, self.element.law, self.element.contacts > 1
        yield f"dR = clearance * {joint.in_mm!r}"
        yield from law.tune
        yield f"joint.clearance = dR * {1.0 if spatial else 1e-3!r}"
        yield f"joint.R_pin = joint.{'R_hole' if spatial else 'R_bearing'} - joint.clearance"
        if spatial and (edge := float(self.element.record["edge"])) > 0.0:
            R_pin, clearance = (float(self.element.record[n]) for n in ("R_pin", "clearance"))
            edge *= math.sqrt(clearance / R_pin)
            yield f"joint.edge = {edge!r} * sqrt(joint.R_pin / joint.clearance)"
        if law.end != "inf":
            yield from _END.format(part=TANGENT_FROM, end=law.end).strip().splitlines()
        if joint.can_yield:
            size = self.clearances.size
            load = f"load_of_table(dR, yield_dR, yield_load, yield_slopes, {size})"
            per = f" / {joint.pair.contact_length('the joint')!r}" if spatial else ""
            yield f"joint.{'yields' if spatial else 'first_yield'} = {load}{per}"

    # --- the files ---

    @cached_property
    def variables(self) -> list[Variable]:
        """The real variables in the order of their references: parameters are the last ones."""
        element, u = self.element, self.element.unit
        names = MOTIONS[element.size]
        rows: list[tuple[str, str, str, str, float | None]] = [
            (f"{body}.{n}", n, "input", f"{_about_motion(n)} of the {what}", float(n == "q_w"))
            for body, what in (("bearing", "body with the hole"), ("pin", "body with the pin"))
            for n in names
        ]
        for key, kind in fields_of(element.module.WRENCH).items():
            what, _, body = key.rpartition("_")
            name = f"{body}.{what}" if body in ("bearing", "pin") else key
            size = kind.size if isinstance(kind, Vector) else 0
            ends = [f"_{'xyz'[k] if size < 4 else k + 1}" for k in range(size)] or [""]
            about = element.meaning(key).partition(", ")[2] or element.meaning(key)
            about = "rate of the penetration" if key == "penetration_rate" else about
            rows += [(name + end, key, "output", about, None) for end in ends if key != "flag"]
        ends = [f"_{k + 1}" for k in range(element.contacts)] if element.contacts > 1 else [""]
        about = "penetration rate at first touch; 0: no contact"
        rows += [(f"impact_rate{end}", "impact_rate", "local", about, None) for end in ends]
        variables = [
            Variable(name, _unit_of(key, u), causality, about, start)
            for name, key, causality, about, start in rows
        ]
        return [*variables, *self.parameters]

    @cached_property
    def parameters(self) -> list[Variable]:
        """The parameters, in the order of the arguments of `tune`."""
        joint = self.joint
        restitution = float(joint.data["dissipation"]["restitution"])
        least = min(_LEAST_RESTITUTION, restitution)
        parameters = [
            Variable("friction", "", "parameter", "friction coefficient", joint.friction,
                     (0.0, MOST_FRICTION)),
            Variable("restitution", "", "parameter", "coefficient of restitution", restitution,
                     (least, 1.0)),
        ]  # fmt: skip
        if self.element.law.tune:
            ends = self.clearances[0].item(), self.clearances[-1].item()
            about = "radial clearance: the pin's radius and the law follow it"
            start = joint.radial / joint.in_mm
            clearance = Variable("clearance", self.element.unit, "parameter", about, start, ends)
            parameters.insert(0, clearance)
        return parameters

    def files(self, stem: str = "") -> dict[str, bytes]:
        """Return the FMU by its file name, with sources and a library for this platform.

        It is the same for the same joint, version and compiler. Raises `InputError` if there is no
        C compiler, or it fails.
        """
        name, c, parts = self.joint.identifier, self.language, {**self._parts(), "guid": ""}
        texts = [c.file(parts, each) for each in ("fmi2.c", "modelDescription.xml")]
        hashed = hashlib.sha256("\0".join(texts).encode()).digest()
        parts["guid"] = f"{{{uuid.UUID(bytes=hashed[:16])}}}"
        source, model = (c.file(parts, each) for each in ("fmi2.c", "modelDescription.xml"))
        system, suffix = _LIBRARIES.get(sys.platform, _LIBRARIES["linux"])
        library = f"binaries/{system}{64 if sys.maxsize > 2**32 else 32}/{name}{suffix}"
        archive = _archive({
            "modelDescription.xml": model.encode(), f"sources/{name}.c": source.encode(),
            library: _library(f"{name}.c", source, name + suffix),
        })  # fmt: skip
        return {f"{stem or name}.fmu": archive}

    def _parts(self) -> dict[str, str]:
        """Return what the templates ask for."""
        joint, element, c = self.joint, self.element, self.language
        name, u = joint.identifier, element.unit
        factor = "" if u == "m" else ' factor="0.001"'
        units = [
            f'<Unit name="{unit.replace("u", u)}"><BaseUnit {base}{factor if "u" in unit else ""}/>'
            "</Unit>"
            for unit, base in _EXPONENTS.items()
        ]
        wrench = fields_of(element.module.WRENCH)
        sizes = [kind.size if isinstance(kind, Vector) else 1 for kind in wrench.values()]
        at = [*wrench].index("penetration")
        flag = quoteattr(element.meaning("flag"))
        lines = [variable.line(k) for k, variable in enumerate(self.variables)]
        lines.append(
            '<ScalarVariable name="flag" valueReference="0" causality="output" '
            f'variability="discrete"\n    description={flag}><Integer/></ScalarVariable>'
        )
        outputs = [k for k, line in enumerate(lines, 1) if 'causality="output"' in line]
        first = [v.start for v in self.variables if v.causality == "input"]
        bounds = {v.name: v.bounds for v in self.parameters if v.bounds}
        given = [f"memory->parameter[{k}]" for k in range(len(self.parameters))]
        given = c.program.functions["tune"].used([*given, "&memory->joint", "&memory->law"])
        return {
            "name": name, "title": quoteattr(comment(joint.name)), "version": version("cylcontact"),
            "text": quoteattr(f"Clearance joint, law '{comment(joint.law.name)}'"),
            "size": str(element.size), "contacts": str(element.contacts),
            "outputs": str(sum(sizes) - 1), "depths": str(sum(sizes[:at])),
            "first": ", ".join(map(repr, first)),
            "touch": repr(_TOUCH / joint.in_mm), "floor": repr(IMPACT_RATE_FLOOR / joint.in_mm),
            "units": "\n".join(units), "variables": "\n".join(lines), "step": repr(_STEP),
            "unknowns": "\n".join(f'<Unknown index="{k}"/>' for k in outputs),
            "parameters": str(len(self.parameters)),
            "starts": ", ".join(repr(v.start) for v in self.parameters),
            "low": ", ".join(repr(low) for low, _ in bounds.values()),
            "high": ", ".join(repr(high) for _, high in bounds.values()),
            "bounds": "\n".join(
                f'"{name} must be from {low!r} to {high!r}",'
                for name, (low, high) in bounds.items()
            ),
            "given": ", ".join(given),
            **c.parts(), **element.scratch(c),
            "provides": "true" if element.contacts == 1 else "false",
            "derivative": filled(
                {"name": name}, "derivative.c" if element.contacts == 1 else "no_derivative.c"
            ),
            "records": "\n\n".join(_whole_record(c, kind) for kind in c.public),
            **{
                f"first_{of}": c.constant(f"first_{of}", record.dtype, record, about)
                for (of, record), about in zip(
                    element.records.items(), (element.about, {}), strict=True
                )
            },
        }  # fmt: skip


def _whole_record(language: C, kind: Any) -> str:
    """Return a record with all of its fields, which the standard's functions take as an array."""
    lines = "\n".join(f"    {language.declared(*each)};" for each in fields_of(kind).items())
    return f"typedef struct {{\n{lines}\n}} {language.type_name(kind)};"


def _about_motion(name: str) -> str:
    """Return what a number of a motion is."""
    return _MOTION.get(name) or _MOTION.get(name.partition("_")[0]) or "quaternion"


def _unit_of(key: str, u: str) -> str:
    """Return the unit of a variable."""
    unit = next((unit for start, unit in _UNITS.items() if key.startswith(start)), "u")
    return unit.replace("u", u) if unit != "" else ""


def _library(name: str, source: str, file: str) -> bytes:
    """Return the compiled source."""
    compiler = next(filter(None, map(shutil.which, _COMPILERS)), None)
    if compiler is None:
        raise InputError(
            "export", "--to", "fmu", "needs a C compiler, and there is neither cc nor gcc",
            "install one (Debian: apt install gcc libc6-dev; macOS: xcode-select --install)",
        )  # fmt: skip
    with TemporaryDirectory() as place:
        folder = Path(place)
        (folder / name).write_text(source, encoding="ascii")
        command = [compiler, *_FLAGS, "-o", file, name, "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            first = next(iter(done.stderr.splitlines()), "it said nothing")
            rule, remedy = f"{compiler} failed: {first}", "check that it compiles a C program"
            raise InputError("export", "--to", "fmu", rule, remedy)
        return (folder / file).read_bytes()


def _archive(files: Mapping[str, bytes]) -> bytes:
    """Return a zip archive that depends on nothing but the files."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path, _EPOCH)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, content)
    return out.getvalue()
