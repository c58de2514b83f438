"""The FMU target: FMI 2.0, model exchange and co-simulation, around the C target."""

from __future__ import annotations

import hashlib
import io
import shutil
import subprocess
import sys
import uuid
import zipfile
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

from cylcontact.errors import InputError
from cylcontact.export.joints import c
from cylcontact.files import scratch_folder
from cylcontact.mechanism.clearance_joint import ClearanceJoint
from cylcontact.plain_text import comment

__all__ = ["VARIABLES", "Variable", "source"]


class Variable(NamedTuple):
    """A variable of the FMU; its quantity is a key of the units, or "flag" for an integer."""

    name: str
    quantity: str
    causality: str
    description: str


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
# In the order of the value references; fmi2.c has the same.
VARIABLES = (
    *(
        Variable(f"{body}.{name}", quantity, "input", f"{text} {of}")
        for body, of in _BODIES.items()
        for name, quantity, text in _MOTION
    ),
    *(
        Variable(f"{body}.{name}", quantity, "output", f"{text} {of.replace('of', 'on', 1)}")
        for body, of in _BODIES.items()
        for name, quantity, text in _WRENCH
    ),
    Variable("penetration", "length", "output", "negative where the bodies do not touch"),
    Variable("penetration_rate", "speed", "output", "rate of the penetration"),
    Variable("normal_force", "force", "output", "normal part of the force, not negative"),
    Variable("friction_force", "force", "output", "tangential part of the force on the bearing"),
    Variable("tangential_velocity", "speed", "output", "of the bearing against the pin"),
    Variable("dissipated_power", "power", "output", "by damping and friction, not negative"),
    Variable("impact_rate", "speed", "local", "penetration rate at first touch; 0: no contact"),
    Variable("flag", "flag", "output", "1 above first yield, plus 2 beyond the law's domain"),
)

# Name of each quantity's unit, in SI or with mm, and its exponents of kg, m and s.
_UNITS: dict[str, tuple[str, str, dict[str, int]]] = {
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

_DEFINITIONS = """\
#include "{name}.h"

#define JOINT(part) {name}_##part
#define GUID "{guid}"
#define RATE_FLOOR {floor!r}
#define TOUCH {touch!r}

"""

# What pip cannot install, and the folder, suffix and flags of a shared library.
_COMPILERS = ("cc", "gcc")
_LIBRARIES = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("win", ".dll")}
_FLAGS = ("-shared", "-fPIC", "-O2", "-std=c99")
# The earliest time that a zip archive can hold, so that equal contents make equal files.
_EPOCH = (1980, 1, 1, 0, 0, 0)


def source(joint: ClearanceJoint, stem: str = "") -> dict[str, bytes]:
    """Return the FMU by its file name, with sources and a library for this platform.

    Parameters
    ----------
    joint : ClearanceJoint
        The joint.
    stem : str, optional
        The name of the file without suffix; by default that of the joint.

    Returns
    -------
    dict
        The bytes of one file, the same for the same joint, version and compiler.

    Raises
    ------
    InputError
        If there is no C compiler, or it fails.

    Examples
    --------
    >>> from cylcontact.mechanism import read_joint
    >>> list(source(read_joint("datasets/joint.toml")))  # doctest: +SKIP
    ['wrist_pin.fmu']
    """
    name = joint.identifier
    element = c.source(joint)
    wrapper = (Path(__file__).parent / "fmi2.c").read_text(encoding="ascii")
    parts = (*element.values(), wrapper, _description(joint, ""))
    content = hashlib.sha256("\0".join(parts).encode()).digest()
    guid = f"{{{uuid.UUID(bytes=content[:16])}}}"
    definitions = _DEFINITIONS.format(
        name=name, guid=guid, floor=joint.rate_floor, touch=_TOUCH / joint.in_mm
    )
    sources = {**element, f"{name}_fmi2.c": definitions + wrapper}
    folder, suffix = _platform()
    files = {
        "modelDescription.xml": _description(joint, guid).encode(),
        **{f"sources/{file}": text.encode() for file, text in sources.items()},
        f"binaries/{folder}/{name}{suffix}": _library(sources, name + suffix),
    }
    return {f"{stem or name}.fmu": _archive(files)}


def _platform() -> tuple[str, str]:
    """Return FMI's name of this platform, and the suffix of its libraries."""
    system, suffix = _LIBRARIES.get(sys.platform, _LIBRARIES["linux"])
    return f"{system}{64 if sys.maxsize > 2**32 else 32}", suffix


def _library(sources: dict[str, str], file: str) -> bytes:
    """Return the compiled sources."""
    compiler = next(filter(None, map(shutil.which, _COMPILERS)), None)
    if compiler is None:
        raise InputError(
            "export", "--to", "fmu", "needs a C compiler, and there is neither cc nor gcc",
            "install one (Debian: apt install gcc libc6-dev; macOS: xcode-select --install)",
        )  # fmt: skip
    with scratch_folder() as folder:
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


def _archive(files: dict[str, bytes]) -> bytes:
    """Return a zip archive that depends on nothing but the files."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path, _EPOCH)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, content)
    return out.getvalue()


def _description(joint: ClearanceJoint, guid: str) -> str:
    """Return modelDescription.xml."""
    name = quoteattr(joint.identifier)
    abilities = (
        f'modelIdentifier={name} canNotUseMemoryManagementFunctions="true" '
        'canGetAndSetFMUstate="true" canSerializeFMUstate="true"'
    )
    files = "".join(
        f'      <File name="{joint.identifier}{suffix}"/>\n' for suffix in (".c", "_fmi2.c")
    )
    sources = f"    <SourceFiles>\n{files}    </SourceFiles>\n"
    outputs = [k + 1 for k, v in enumerate(VARIABLES) if v.causality == "output"]
    unknowns = "".join(f'      <Unknown index="{index}"/>\n' for index in outputs)
    title = comment(joint.name)
    law, clearance = comment(joint.law.name), float(joint.pair.dR)
    text = f"The clearance joint '{title}': law {law}, clearance {clearance:.6g} mm"
    return f"""\
<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName={quoteattr(title)} guid="{guid}"
    description={quoteattr(text)} generationTool="cylcontact {version("cylcontact")}"
    variableNamingConvention="structured" numberOfEventIndicators="1">
  <ModelExchange {abilities}>
{sources}  </ModelExchange>
  <CoSimulation {abilities}
      canHandleVariableCommunicationStepSize="true">
{sources}  </CoSimulation>
  <UnitDefinitions>
{_unit_definitions(joint)}  </UnitDefinitions>
  <LogCategories>
    <Category name="logStatusError"/>
  </LogCategories>
  <ModelVariables>
{_model_variables(joint)}  </ModelVariables>
  <ModelStructure>
    <Outputs>
{unknowns}    </Outputs>
    <InitialUnknowns>
{unknowns}    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


def _unit(joint: ClearanceJoint, quantity: str) -> str:
    """Return the unit of a quantity."""
    in_SI, in_mm, _ = _UNITS[quantity]
    return in_SI if joint.units == "SI" else in_mm


def _unit_definitions(joint: ClearanceJoint) -> str:
    """Return the units in terms of those of the SI."""
    lines = {}
    for quantity, (in_SI, _, exponents) in _UNITS.items():
        unit = _unit(joint, quantity)
        factor = "" if unit == in_SI else ' factor="0.001"'
        base = " ".join(f'{name}="{power}"' for name, power in exponents.items())
        lines[unit] = f'    <Unit name="{unit}"><BaseUnit {base}{factor}/></Unit>\n'
    return "".join(lines.values())


def _model_variables(joint: ClearanceJoint) -> str:
    """Return the variables; the order is that of the indices in the model's structure."""
    reals = 0
    lines = []
    for v in VARIABLES:
        integer = v.quantity == "flag"
        discrete = ' variability="discrete"' if integer or v.causality == "local" else ""
        start = ' start="0.0"' if v.causality == "input" else ""
        kind = "<Integer/>" if integer else f'<Real unit="{_unit(joint, v.quantity)}"{start}/>'
        lines.append(
            f'    <ScalarVariable name="{v.name}" valueReference="{0 if integer else reals}" '
            f'causality="{v.causality}"{discrete}\n        description={quoteattr(v.description)}>'
            f"{kind}</ScalarVariable>\n"
        )
        reals += not integer
    return "".join(lines)
