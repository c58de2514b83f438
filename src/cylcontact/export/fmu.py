"""FMUs by FMI 2.0, of a law and of a joint, around their C: archive, library and description."""

from __future__ import annotations

import hashlib
import io
import shutil
import subprocess
import sys
import uuid
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

from cylcontact.errors import InputError
from cylcontact.export.exported_law import MEANINGS, RESULTS, ExportedLaw
from cylcontact.export.exported_law import source as law_text
from cylcontact.export.joint import source as joint_text
from cylcontact.mechanism.joint import ClearanceJoint
from cylcontact.plain_text import comment

# What pip cannot install, and the folder, suffix and flags of a shared library.
_COMPILERS = ("cc", "gcc")
_LIBRARIES = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("win", ".dll")}
_FLAGS = ("-shared", "-fPIC", "-O2", "-std=c99")
# The earliest time that a zip archive can hold, so that equal contents make equal files.
_EPOCH = (1980, 1, 1, 0, 0, 0)


class Variable(NamedTuple):
    """A variable of an FMU, real with a unit or an integer without one."""

    name: str
    unit: str
    causality: str
    description: str
    start: float = 0.0


@dataclass(frozen=True)
class Model:
    """What an FMU says of its model.

    `units` has the exponents of kg, m and s, and a factor, by the units of the variables, whose
    order is that of the value references.
    """

    name: str
    title: str
    text: str
    variables: tuple[Variable, ...]
    units: Mapping[str, Mapping[str, float]]
    indicators: int = 0

    def description(self, guid: str) -> str:
        """Return modelDescription.xml."""
        name = quoteattr(self.name)
        abilities = (
            f'modelIdentifier={name} canNotUseMemoryManagementFunctions="true" '
            'canGetAndSetFMUstate="true" canSerializeFMUstate="true"'
        )
        files = "".join(f'      <File name="{self.name}{end}"/>\n' for end in (".c", "_fmi2.c"))
        sources = f"    <SourceFiles>\n{files}    </SourceFiles>\n"
        outputs = [k for k, v in enumerate(self.variables, 1) if v.causality == "output"]
        unknowns = "".join(f'      <Unknown index="{index}"/>\n' for index in outputs)
        return f"""\
<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName={quoteattr(self.title)} guid="{guid}"
    description={quoteattr(self.text)} generationTool="cylcontact {version("cylcontact")}"
    variableNamingConvention="structured" numberOfEventIndicators="{self.indicators}">
  <ModelExchange {abilities}>
{sources}  </ModelExchange>
  <CoSimulation {abilities}
      canHandleVariableCommunicationStepSize="true">
{sources}  </CoSimulation>
  <UnitDefinitions>
{self._units()}  </UnitDefinitions>
  <LogCategories>
    <Category name="logStatusError"/>
  </LogCategories>
  <ModelVariables>
{self._variables()}  </ModelVariables>
  <ModelStructure>
    <Outputs>
{unknowns}    </Outputs>
    <InitialUnknowns>
{unknowns}    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""

    def _units(self) -> str:
        """Return the units in terms of those of the SI."""
        lines = []
        for unit, exponents in self.units.items():
            base = " ".join(f'{name}="{power}"' for name, power in exponents.items())
            lines.append(f'    <Unit name="{unit}"><BaseUnit {base}/></Unit>\n')
        return "".join(lines)

    def _variables(self) -> str:
        """Return the variables; the order is that of the indices in the model's structure."""
        lines, reals = [], 0
        for v in self.variables:
            kinds = {"parameter": "tunable", "local": "discrete"}
            kind = kinds.get(v.causality, "" if v.unit else "discrete")
            changes = f' variability="{kind}"' if kind else ""
            given = v.causality in ("input", "parameter")
            start = f' start="{v.start!r}"' if given else ""
            unit = f' unit="{v.unit}"' if v.unit != "-" else ""
            lines.append(
                f'    <ScalarVariable name="{v.name}" valueReference="{reals if v.unit else 0}" '
                f'causality="{v.causality}"{changes}\n'
                f"        description={quoteattr(v.description)}>"
                f"{f'<Real{unit}{start}/>' if v.unit else '<Integer/>'}</ScalarVariable>\n"
            )
            reals += bool(v.unit)
        return "".join(lines)


def fmu(model: Model, sources: Mapping[str, str], definitions: str, hooks: str) -> bytes:
    """Return an FMU, the same for the same sources, version and compiler.

    `definitions`, with $guid, and `hooks` come before the text of fmi2.c.
    """
    wrapper = hooks + (Path(__file__).parent / "fmi2.c").read_text(encoding="ascii")
    parts = (*sources.values(), definitions, wrapper, model.description(""))
    content = hashlib.sha256("\0".join(parts).encode()).digest()
    guid = f"{{{uuid.UUID(bytes=content[:16])}}}"
    texts = {**sources, f"{model.name}_fmi2.c": definitions.replace("$guid", guid) + wrapper}
    folder, suffix = _platform()
    return _archive({
        "modelDescription.xml": model.description(guid).encode(),
        **{f"sources/{file}": text.encode() for file, text in texts.items()},
        f"binaries/{folder}/{model.name}{suffix}": _library(texts, model.name + suffix),
    })  # fmt: skip


def _platform() -> tuple[str, str]:
    """Return FMI's name of this platform, and the suffix of its libraries."""
    system, suffix = _LIBRARIES.get(sys.platform, _LIBRARIES["linux"])
    return f"{system}{64 if sys.maxsize > 2**32 else 32}", suffix


def _library(sources: Mapping[str, str], file: str) -> bytes:
    """Return the compiled sources."""
    compiler = next(filter(None, map(shutil.which, _COMPILERS)), None)
    if compiler is None:
        raise InputError(
            "export", "--to", "fmu", "needs a C compiler, and there is neither cc nor gcc",
            "install one (Debian: apt install gcc libc6-dev; macOS: xcode-select --install)",
        )  # fmt: skip
    with TemporaryDirectory() as name:
        folder = Path(name)
        for path, text in sources.items():
            (folder / path).write_text(text, encoding="ascii")
        units = [path for path in sources if path.endswith(".c")]
        command = [compiler, *_FLAGS, "-o", file, *units, "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            raise InputError(
                "export", "--to", "fmu", f"{compiler} failed: {_first_line(done.stderr)}",
                "check that it compiles a C program",
            )  # fmt: skip
        return (folder / file).read_bytes()


def _first_line(text: str) -> str:
    """Return the first line of a compiler's errors."""
    return next(iter(text.splitlines()), "it said nothing")


def _archive(files: Mapping[str, bytes]) -> bytes:
    """Return a zip archive that depends on nothing but the files."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path, _EPOCH)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, content)
    return out.getvalue()


# --- of a law ---

# Where nothing else is given, a steel pin in a hole of 10 mm.
_LAW_START = {
    "penetration": 0.0, "E_star": 113736.26, "dR": 0.05, "R_i": 10.0, "R_j": 9.95, "length": 10.0,
}  # fmt: skip
_LAW_UNITS = {
    "mm": {"m": 1, "factor": 1e-3},
    "MPa": {"kg": 1, "m": -1, "s": -2, "factor": 1e6},
    "N/mm": {"kg": 1, "s": -2, "factor": 1e3},
    "N/mm2": {"kg": 1, "m": -1, "s": -2, "factor": 1e6},
}
_LAW_DEFINITIONS = """\
#define GUID "$guid"

"""
_LAW_HOOKS = """\
/* The law for fmi2.c: its arguments, then load and stiffness. */
#include <string.h>

void {name}({parameters}, double *load, double *stiffness);

enum {{ INPUTS = {count}, REALS = {count} + 2, INDICATORS = 0 }};

typedef struct {{
    double input[INPUTS], ahead;
}} Memory;

static void start(Memory *memory)
{{
    const double first[INPUTS] = {{{first}}};
    memcpy(memory->input, first, sizeof first);
    memory->ahead = 0.0;
}}

static int settle(Memory *memory, int at_event)
{{
    (void)memory, (void)at_event;
    return 0;
}}

static void reals_of(const Memory *memory, double all[REALS])
{{
    memcpy(all, memory->input, sizeof memory->input);
    {name}({given}, &all[INPUTS], &all[INPUTS + 1]);
}}

static int integer_of(const Memory *memory, unsigned int which, int *value)
{{
    (void)memory, (void)which, (void)value;
    return 0;
}}

static void indicators_of(const Memory *memory, double *indicators)
{{
    (void)memory, (void)indicators;
}}

"""


def source(law: ExportedLaw) -> bytes:
    """Return the FMU: the penetration is its input, the pair's arguments are its parameters.

    Raises `InputError` if there is no C compiler, or it fails.
    """
    start = {name: _LAW_START.get(name, 0.0) for name in law.arguments}
    kinds = ("input", *("parameter" for _ in law.arguments[1:]))
    rows = {**{name: MEANINGS[name] for name in law.arguments}, **RESULTS}
    variables = (
        Variable(name, unit.replace("^", ""), kind, meaning, start.get(name, 0.0))
        for (name, (unit, meaning)), kind in zip(
            rows.items(), (*kinds, "output", "output"), strict=True
        )
    )
    hooks = _LAW_HOOKS.format(
        name=law.name,
        parameters=", ".join(f"double {name}" for name in law.arguments),
        count=len(start),
        first=", ".join(map(repr, start.values())),
        given=", ".join(f"all[{k}]" for k in range(len(start))),
    )
    text = f"The contact law '{comment(law.law.name)}': load and stiffness per unit of length"
    model = Model(law.name, law.name, text, tuple(variables), _LAW_UNITS)
    return fmu(model, {f"{law.name}.c": law_text(law, "c")}, _LAW_DEFINITIONS, hooks)


# --- of a joint ---

_MOTION = (
    ("x", "length", "position of the reference point"),
    ("y", "length", "position of the reference point"),
    ("angle", "angle", "angle, anticlockwise"),
    ("v_x", "speed", "velocity of the reference point"),
    ("v_y", "speed", "velocity of the reference point"),
    ("spin", "spin", "rate of the angle"),
)
_WRENCH = (
    ("force_x", "force", "force of the contact"),
    ("force_y", "force", "force of the contact"),
    ("moment", "moment", "moment of the contact about the reference point"),
)
_BODIES = {"bearing": "of the body with the hole", "pin": "of the body with the pin"}
# Name, quantity (empty for the integer), causality and description, in the order of the value
# references; fmi2_joint.c has the same.
VARIABLES: tuple[tuple[str, str, str, str], ...] = (
    *(
        (f"{body}.{name}", quantity, "input", f"{text} {of}")
        for body, of in _BODIES.items()
        for name, quantity, text in _MOTION
    ),
    *(
        (f"{body}.{name}", quantity, "output", f"{text} {of.replace('of', 'on', 1)}")
        for body, of in _BODIES.items()
        for name, quantity, text in _WRENCH
    ),
    ("penetration", "length", "output", "negative where the bodies do not touch"),
    ("penetration_rate", "speed", "output", "rate of the penetration"),
    ("normal_force", "force", "output", "normal part of the force, not negative"),
    ("friction_force", "force", "output", "tangential part of the force on the bearing"),
    ("tangential_velocity", "speed", "output", "of the bearing against the pin"),
    ("dissipated_power", "power", "output", "by damping and friction, not negative"),
    ("impact_rate", "speed", "local", "penetration rate at first touch; 0: no contact"),
    ("flag", "", "output", "1 above first yield, plus 2 beyond the law's domain"),
)

# Name of each quantity's unit, in SI or with mm, and its exponents of kg, m and s.
_JOINT_UNITS: dict[str, tuple[str, str, dict[str, float]]] = {
    "length": ("m", "mm", {"m": 1}),
    "angle": ("rad", "rad", {"rad": 1}),
    "speed": ("m/s", "mm/s", {"m": 1, "s": -1}),
    "spin": ("rad/s", "rad/s", {"rad": 1, "s": -1}),
    "force": ("N", "N", {"kg": 1, "m": 1, "s": -2}),
    "moment": ("N.m", "N.mm", {"kg": 1, "m": 2, "s": -2}),
    "power": ("W", "N.mm/s", {"kg": 1, "m": 2, "s": -3}),
}

# At an event, bodies that approach each other within this distance in mm touch: whoever locates
# the root of the penetration leaves a small error on either side.
_TOUCH = 1e-6

_JOINT_DEFINITIONS = """\
#include "{name}.h"

#define JOINT(part) {name}_##part
#define GUID "$guid"
#define RATE_FLOOR {floor!r}
#define TOUCH {touch!r}

"""


def joint_source(joint: ClearanceJoint, stem: str) -> dict[str, bytes]:
    """Return the FMU by its file name, with sources and a library for this platform.

    Raises `InputError` if there is no C compiler, or it fails.
    """
    name = joint.identifier
    definitions = _JOINT_DEFINITIONS.format(
        name=name, floor=joint.rate_floor, touch=_TOUCH / joint.in_mm
    )
    hooks = (Path(__file__).parent / "fmi2_joint.c").read_text(encoding="ascii")
    return {
        f"{stem or name}.fmu": fmu(model_of(joint), joint_text(joint, "c", ""), definitions, hooks)
    }


def model_of(joint: ClearanceJoint) -> Model:
    """Return what the FMU of a joint says of it."""
    title, law = comment(joint.name), comment(joint.law.name)
    in_units = {"": ""}
    bases: dict[str, dict[str, float]] = {}
    for quantity, (in_SI, in_mm, exponents) in _JOINT_UNITS.items():
        unit = in_SI if joint.units == "SI" else in_mm
        in_units[quantity] = unit
        bases[unit] = exponents if unit == in_SI else {**exponents, "factor": 0.001}
    return Model(
        joint.identifier,
        title,
        f"The clearance joint '{title}': law {law}, clearance {float(joint.pair.dR):.6g} mm",
        tuple(Variable(n, in_units[q], causality, text) for n, q, causality, text in VARIABLES),
        bases,
        indicators=1,
    )
