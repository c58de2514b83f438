"""The bench that the fuzzer changes: good files of every kind, and the work they would start."""

import contextlib
import io
import json
import re
import shlex
import sys
import zipfile
from unittest import mock

import pandas as pd

from cylcontact import cli
from cylcontact.fitting import FitResult
from tests import malformed
from tests.fuzz.cases import Source, as_parquet, zipped
from tests.malformed import QUICK, ROOT
from tests.manuscript_files import write_manuscript
from tests.programs import require_package
from tests.spec_files import ELEMENTS, changed

RECIPE = """\
import pandas as pd
from cylcontact.plots import Drawing, new_figure

def draw(bench):
    table = pd.DataFrame({"load_N_per_mm": [10.0]})
    return Drawing(new_figure("column", 60), table, {"largest load, N/mm": 10.0}, "A load.")
"""


class Planned(BaseException):
    """The input is good, and work would begin."""


def planned(*_, **__):
    raise Planned


# Where work begins: workers, samples, descents, steps of a mechanism, a compiler, copies of files.
SEAMS = (
    *(f"cylcontact.parallel.run.{name}" for name in ("in_processes", "in_threads", "on_cluster")),
    *("cylcontact.fitting.uncertainty.discrepancy.blocks", "cylcontact.datasets.sampling.blocks"),
    *("cylcontact.fitting.measured_fit.descend", "cylcontact.fitting.choice.descend"),
    "cylcontact.mechanism.run.Run.advance",
    *("cylcontact.export.fmi._library", "cylcontact.cli.init.copy_files"),
)
TABLES = ("datasets/examples/pin-in-hole.csv", "datasets/finite_element/recommended-embedded.csv")
FIT = "fit {} --law power --contact internal -j 1 -o "
CASES = "simulate mechanism.toml --study cases --restitution 0.9,0.8 --revolutions 1 -o cases.csv"
# Good files that are no specs: what each is, and a command that reads it.
FILES = {
    "table.csv": ("table .csv", FIT + "out.json"),
    "semicolons.csv": ("table .csv", " ".join(malformed.READERS["semicolons.csv"])),
    "table.xlsx": ("table .xlsx", FIT + "out.json"),
    "table.parquet": ("table .parquet", "choose {} --contact internal --law power -o out"),
    "materials.csv": ("table of materials", " ".join(malformed.READERS["materials.csv"])),
    "small.json.partial": ("journal", "fit fitting/small.toml -j 1 -o small.json --resume"),
    "cases.csv.partial": ("journal", f"{CASES} --resume"),
    "fe.csv.partial": ("journal", "finite-element fe.toml -o fe.csv --resume"),
    "run.parquet": ("trajectory", "simulate mechanism.toml --revolutions 2 -o {} --resume"),
    "noise.json": ("fit result", "fit {} --bootstrap 5 -j 1 -o study.json"),
    "good.json": ("fit result", "verify {} -j 1"),
    "pair.json": ("fit result", "compare {}"),
    "reports/mine/a.md": ("manuscript", "manuscript {} -o set -j 1"),
    "reports/mine/references.bib": ("manuscript", "manuscript reports/mine/a.md -o set -j 1"),
}
ALONE = """
sample datasets/small.toml -o out.parquet; compare good.json good.json; verify good.json; laws;
laws --E 100000 --dR 0.1; laws --contact external; laws --pin "low-carbon steel" --hole bronze;
export johnson --to c; export good.json --to json -o out.json; figure; figure fig99 --format png;
export --joint datasets/joint.toml --to python -o out.py; simulate mechanism.toml -o film.gif;
simulate mechanism.toml --study tolerances --tolerance 1e-5 -o t.csv; init mine; --version;
simulate mechanism.toml --study bifurcation --clearance 0.01,0.1 -o b.csv; report -o site;
report --tables csv -o tables; claims; claims -o claims.csv; manuscript reports/mine/a.md -o set
"""
KINDS = {
    **{"MechanismSpec": "mechanism", "ClearanceJointSpec": "joint", "FitResult": "fit result"},
    **{"DimensionlessGridSpec": "grid", "GridSpec": "grid", "StudySpec": "finite-element set-up"},
    **{"MeasuredSpec": "campaign on measurements", "CampaignSpec": "campaign"},
    "StyleFile": "style",
}


CLAIM = b"""
from cylcontact.reports.claims import Finding, claim

from ..paper import LOADS


@claim("7-light", "the loads are light", paper="light", rule="at most 1000 N/mm")
def light():
    return Finding(f"{max(LOADS):g} N/mm", holds=max(LOADS) <= 1000)
"""


def good_files(folder):
    """Write the good files of a bench into an empty folder, and return them: name → contents."""
    require_package("pyarrow.parquet")
    files = malformed.good_files(b"") | {
        "pair.json": (ROOT / "fitting/results/explicit-pair.json").read_bytes(),
        "reports/fig99.py": RECIPE.encode(),
        "reports/paper.py": b"LOADS = (10.0, 1000.0)\n",
        "reports/claims/mine.py": CLAIM,
        **{name: (ROOT / name).read_bytes() for name in TABLES},
        "fe.toml": malformed.document(changed(ELEMENTS, {"cells": 4})),
        "fitting/small.toml": malformed.document(changed(QUICK, {"genetic.runs": 3})),
    }
    for name, contents in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(contents)
    write_manuscript(folder / "reports/mine")
    (folder / "loop.toml").symlink_to("loop.toml")
    table = pd.read_csv(folder / "table.csv", comment="#")
    table.to_parquet(folder / "table.parquet")
    table.to_excel(folder / "table.xlsx", index=False)
    run(shlex.split(FIT.format("table.csv") + "noise.json"))
    run(shlex.split("fit fitting/small.toml -j 1 -o good.json"))
    run(shlex.split("simulate mechanism.toml --revolutions 1 -o run.parquet"))
    with mock.patch("cylcontact.parallel.run.in_processes", _interrupted):
        for line in (
            "fit fitting/small.toml -o small.json",
            CASES,
            "finite-element fe.toml -o fe.csv",
        ):
            run(shlex.split(line))
    names = (path for path in folder.rglob("*") if path.is_file())
    files = {path.relative_to(folder).as_posix(): path.read_bytes() for path in names}
    return {name: _timeless(name, contents) for name, contents in sorted(files.items())}


def sources(files):
    """Return by kind the good files with the commands that read them; "none" reads no file."""
    specs = [Source(KINDS[m.__name__], path, words, m) for path, m, words in malformed.specs(files)]
    others = [
        Source(kind, path, shlex.split(line.format(path)), path.endswith(".json") and FitResult)
        for path, (kind, line) in FILES.items()
    ]
    alone = [Source("none", "", shlex.split(line)) for line in ALONE.split(";")]
    kinds = {}
    for source in specs + others + alone:
        words = ("figure", "fig99") if source.kind == "style" else tuple(source.command)
        kinds.setdefault(source.kind, []).append(source._replace(command=words))
    return kinds


def run(words):
    """Run a command line in this process, and return its exit code and what it says of errors."""
    out, errors = (io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2))
    code = None
    with (
        mock.patch.object(sys, "argv", ["cylcontact", *words]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(errors),
    ):
        try:
            cli.main()
        except SystemExit as stop:
            code = stop.code
        except Planned:
            code = 0
    return code, errors.buffer.getvalue().decode()


def _interrupted(calls, *_):
    """Make the first call, and end there as Ctrl-C does."""
    function, arguments, named = calls[0]
    yield function(*arguments, **named)
    raise KeyboardInterrupt


def _timeless(name, contents):
    """Return a file without the times in it."""
    if name.endswith((".json", ".partial")):
        return re.sub(rb'("seconds": )[\d.]+', rb"\g<1>0.5", contents)
    if name == "run.parquet":
        table = require_package("pyarrow.parquet").read_table(io.BytesIO(contents))
        (key, text), *_ = table.schema.metadata.items()
        metadata = json.loads(text)
        metadata["counts"] = [[*counts[:2], 0.5] for counts in metadata["counts"]]
        metadata.pop("provenance", None)
        return as_parquet(table.replace_schema_metadata({key: json.dumps(metadata)}))
    if name.endswith(".xlsx"):
        with zipfile.ZipFile(io.BytesIO(contents)) as archive:
            members = {each: archive.read(each) for each in archive.namelist()}
        members["docProps/core.xml"] = re.sub(
            rb"\d{4}-\d\d-\d\dT[\d:]+Z", b"2015-01-01T00:00:00Z", members["docProps/core.xml"]
        )
        return zipped(members)
    return contents
