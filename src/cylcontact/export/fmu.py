"""An FMU by FMI 2.0 of an element, around their C: archive, library and description."""

from __future__ import annotations

import hashlib
import io
import shutil
import subprocess
import sys
import uuid
import zipfile
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

from cylcontact.export.element import BODIES, UNITS, Element
from cylcontact.export.element import source as element_text
from cylcontact.export.language import Language, filled_template
from cylcontact.impact import IMPACT_RATE_FLOOR
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


class Variable(NamedTuple):
    """A variable of an FMU, real with a unit or an integer without one."""

    name: str
    unit: str
    causality: str
    description: str
    start: float = 0.0


class Model(NamedTuple):
    """What an FMU says of its model.

    `units` has the exponents of kg, m and s, and a factor, by the units of the variables, whose
    order is that of the value references.
    """

    name: str
    title: str
    text: str
    variables: Sequence[Variable]
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
        units = ""
        for unit, exponents in self.units.items():
            base = " ".join(f'{name}="{power}"' for name, power in exponents.items())
            units += f'    <Unit name="{unit}"><BaseUnit {base}/></Unit>\n'
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
{units}  </UnitDefinitions>
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

    def fmu(self, sources: Mapping[str, str], parts: Mapping[str, str]) -> bytes:
        """Return an FMU, the same for the same sources, version and compiler.

        `parts` are what the model has for the template fmi2.c. Raises `InputError` if there is no
        C compiler, or it fails.
        """
        inputs = [v for v in self.variables if v.causality in ("input", "parameter")]
        parts = {
            **parts,
            "name": self.name,
            "contacts": "contacts" if self.indicators else "",
            "inputs": str(len(inputs)),
            "indicators": str(self.indicators),
            "reals": str(sum(bool(v.unit) for v in self.variables)),
            "first": ", ".join(repr(v.start) for v in inputs),
        }
        wrapper = filled_template("fmi2.c", {**parts, "guid": ""})
        content = "\0".join((*sources.values(), wrapper, self.description("")))
        hashed = hashlib.sha256(content.encode()).digest()
        guid = f"{{{uuid.UUID(bytes=hashed[:16])}}}"
        wrapper = filled_template("fmi2.c", {**parts, "guid": guid})
        texts = {**sources, f"{self.name}_fmi2.c": wrapper}
        system, suffix = _LIBRARIES.get(sys.platform, _LIBRARIES["linux"])
        library = f"binaries/{system}{64 if sys.maxsize > 2**32 else 32}/{self.name}{suffix}"
        return _archive({
            "modelDescription.xml": self.description(guid).encode(),
            **{f"sources/{file}": text.encode() for file, text in texts.items()},
            library: _library(texts, self.name + suffix),
        })  # fmt: skip


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


# --- of an element ---


def joint_source(element: Element, stem: str) -> dict[str, bytes]:
    """Return the FMU by its file name, with sources and a library for this platform."""
    in_mm = 1.0 if element.units == "mm" else 1e3
    one = "&" if element.contacts == 1 else ""
    inputs = [
        (body, each.name, each.ahead or each.name) for body in BODIES for each in element.motion
    ]
    bodies = []
    for k, (body, _, ahead) in enumerate(inputs):
        names = {name: f"input[{n}]" for n, (of, name, _) in enumerate(inputs) if of == body}
        bodies.append(f"bodies[{k}] = {Language(names).formula(ahead)};")
    reals = [
        f"wrench.{each.name}" + (f"[{k}]" if each.size else "")
        for each in element.results if each.quantity for k in range(max(each.size, 1))
    ]  # fmt: skip
    reals += [
        "memory->contact.impact_rate" + ("" if one else f"[{k}]") for k in range(element.contacts)
    ]
    parts = {
        "bodies": "\n".join(bodies),
        "outputs": "\n".join(f"all[{k}] = {real};" for k, real in enumerate(reals, len(inputs))),
        "rates": f"{one}memory->contact.impact_rate",
        "accepted": f"{one}next.impact_rate",
        "depths": f"{one}wrench.penetration",
        "speeds": f"{one}wrench.penetration_rate",
        "touch": repr(_TOUCH / in_mm),
        "floor": repr(IMPACT_RATE_FLOOR / in_mm),
    }
    sources = element_text(element, "c", "")
    return {f"{stem or element.name}.fmu": model_of(element).fmu(sources, parts)}


def model_of(element: Element) -> Model:
    """Return what the FMU of an element says of it."""
    in_units, bases = {"": ""}, {}
    quantities = {each.quantity for each in element.motion}
    quantities |= {each.quantity for each in element.results}
    for quantity, unit in UNITS.items():
        if quantity not in quantities:
            continue
        name = in_units[quantity] = unit.with_m if element.units == "SI" else unit.with_mm
        scaled = {} if name == unit.with_m else {"factor": 0.001}
        if unit.exponents:
            bases[name] = {**unit.exponents, **scaled}
    rows = [
        (f"{body}.{each.name}", each.quantity, "input", f"{each.meaning} {of}")
        for body, of in BODIES.items() for each in element.motion
    ]  # fmt: skip
    for each in element.results:
        what, _, body = each.name.rpartition("_")
        name = f"{body}.{what}" if body in BODIES else each.name
        rows += ((name + part, each.quantity, "output", each.meaning) for part in each.parts)
    rate = "penetration rate at first touch; 0: no contact"
    numbers = [f"_{k}" for k in range(1, element.contacts + 1)] if element.contacts > 1 else [""]
    rows[-1:-1] = [(f"impact_rate{number}", "speed", "local", rate) for number in numbers]
    return Model(
        element.name,
        comment(element.title),
        f"The clearance joint '{comment(element.title)}': law {element.law_text}",
        [Variable(name, in_units[q], causality, text) for name, q, causality, text in rows],
        bases,
        element.contacts,
    )
