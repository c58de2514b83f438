"""FMUs by FMI 2.0: the archive, its library and its description."""

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
    with TemporaryDirectory(prefix="cylcontact-") as name:
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
