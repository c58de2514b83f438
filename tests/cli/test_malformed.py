"""Every malformed input gets one clear line and exit code 2, and nothing is written."""

import itertools
import json
import re
from pathlib import Path
from typing import NamedTuple

import pytest

from cylcontact.materials import COLUMNS
from tests.support.spec_files import CAMPAIGN, DROP, GRID, changed, toml, tree

ROOT = Path(__file__).resolve().parents[2]
QUICK = changed(
    CAMPAIGN,
    {"parameters.n": {"value": 1.2, "fixed": True}, "genetic.runs": 1, "genetic.generations": 2},
)
TABLE = """\
# penetration of a pin in a hole
dR_um,E_GPa,nu,load_N_per_mm,penetration_um
50,207,0.3,10,0.21
50,207,0.3,100,1.7
50,207,0.3,1000,13.2
100,207,0.3,10,0.23
100,207,0.3,100,1.9
"""
# As a spreadsheet program of another country writes it, in Windows-1252.
SEMICOLONS = """\
Kraft;displacement;Probe;Prüfer
N/mm;µm;;
0;0,02;A;X
10,5;0,21;A;X
100;1,7;A;X
300;4,6;A;X
1000;13,1;A;X
1000;13,2;B;X
500;7,1;B;X
100;1,9;B;X
30;0,58;B;X
10,5;0,23;B;X
"""
OWN_MATERIALS = f"{','.join(COLUMNS)}\ngunmetal,110,paper,0.34,paper,220,assumed,a note\n"
STEEL = "dR_um,load_N_per_mm,penetration_um\n50,10,0.21\n50,100,1.7\n50,1000,13.2\n"


class Case(NamedTuple):
    """A command line, a file that it reads, what that file holds, and a pattern of what is said."""

    name: str
    arguments: tuple[str, ...]
    path: str = ""
    contents: bytes = b""
    line: str = ""


OUT = ("-j", "1", "-o", "out.json")
POWER = ("--law", "power", "--contact", "internal", *OUT)
# Small files, which are run in full.
READERS = {
    "fitting/small.toml": ("fit", "fitting/small.toml", *OUT),
    "datasets/small.toml": ("sample", "datasets/small.toml", "-o", "out.csv"),
    "good.json": ("compare", "good.json"),
    "table.csv": ("fit", "table.csv", *POWER),
    "semicolons.csv": (
        *("fit", "semicolons.csv", *POWER, "--columns", "load=Kraft", "--group", "Probe"),
        *("--E", "207000", "--nu", "0.3", "--dR", "0.05"),
    ),
    "materials.csv": (
        *("fit", "steel.csv", *POWER, "--material", "gunmetal", "--materials", "materials.csv"),
    ),
}
SAMPLE = READERS["datasets/small.toml"]


def document(spec):
    """Return a spec as the bytes of a TOML file."""
    return "".join(f"{key} = {toml(value)}\n" for key, value in spec.items()).encode()


# Those with a message of their own are in test_campaign_files.py, test_grid.py and test_ties.py.
VALUES = {
    "fitting/small.toml": {
        "dataset": ["../../../no.toml"],
        "law": ["", "Power"],
        "objective": ["", "max"],
        "optimizer": [""],
        "parameters.n": [{"value": 1.2}, {"fixed": True}, {"low": 1.0}],
        "ties": ["n", {"z": "n"}, {"n": "K_star"}, {"n": 2}, {"n": ""}, {"n": "2*(" * 100}],
        "genetic.populations": [[10**9]],
    },
    "datasets/small.toml": {
        "reference": ["", "lankarani-nikravesh"],
        "axes.E.min": [700.0, 1e-300],
        "axes.nu.values": [[0.3, "x"]],
        "axes.load": [{"values": [1e9]}, {"min": 1, "max": 2}],
        "axes.dR": [{"values": [1e13]}, {"values": [1.0], "min": 1}],
    },
}
# Of tables: a text, and what takes its place.
REPLACED = {
    "table.csv": [
        *(("dR_um", "gap_um"), ("dR_um", "dR_furlong"), ("dR_um", "dR"), ("nu,", "E_GPa,")),
        *(("load_N_per_mm", "weight"), (",100,", ",-100,"), ("0.3,", "0.7,"), ("207", "-207")),
        *(("0.21", new) for new in ("small", "", "nan", "inf", "0", "0.21,1", '"0.21')),
        *((",0.21", ""), (TABLE, ""), (TABLE, TABLE.splitlines()[1]), (TABLE, "\0\0\0\0")),
    ],
    "semicolons.csv": [
        *(("10,5", new) for new in ("1.010,5", "10.5", "-10,5", "10,5 N", "", "1e999")),
        *(("N/mm;", "N;"), ("N/mm;", "N/m²;"), ("displacement", "E"), ("Probe", "displacement")),
        *(("Kraft", "Last"), ("Probe", "Charge"), (";A;", ";;"), ("0,02;A;X", "0,02;A")),
    ],
    "materials.csv": [
        *(("E_GPa,", ""), ("E_GPa", "E_MPa"), (",110,", ",hard,"), (",110,", ",-110,")),
        *((",0.34,paper", ",0.90,paper"), ("paper", "rumour"), ("gunmetal", "")),
        *(("gunmetal", "ceramics"), (OWN_MATERIALS, ""), (OWN_MATERIALS, "\0")),
        (OWN_MATERIALS, OWN_MATERIALS + "steel,200\n"),
        (OWN_MATERIALS, OWN_MATERIALS + OWN_MATERIALS.splitlines()[1] + "\n"),
    ],
}
# What is said, as a pattern, of texts in the place of a spec and of a result.
NOT_TEXT = (b"\xff\xfe", b"\x89PNG\r\n\x1a\n\0\0", 'name = "ä"'.encode("latin-1"))
NOT_TOML = {
    "is not a text file; give a TOML file in UTF-8": NOT_TEXT,
    r"is not valid TOML \(.*\); correct the line it names": (
        *(b"contact = internal", b"a = 1\na = 2", b"name = [", b"a = " + b"[" * 5000),
    ),
    r'contact: is required; add "internal" or "external" \(2 more mistakes\)': (b"",),
    r"colour = 1: is not a known key; known keys here: contact, reference, ": (
        document(GRID | {"colour": 1}),
    ),
    r"axes: is required; add ": (document(changed(GRID, {"axes": DROP})),),
    r"reference = 3: must be a string; give ": (document(GRID | {"reference": 3}),),
    r"contact = \[1\]: must be 'internal' or 'external'; give ": (
        document(GRID | {"contact": [1]}),
    ),
    r"axes = \[\]: must be a table; give ": (document(GRID | {"axes": []}),),
    r"axes.E.min = True: must be a number; give ": (document(changed(GRID, {"axes.E.min": True})),),
    r"axes.E.min = nan: must be a finite number; give ": (
        document(changed(GRID, {"axes.E.min": float("nan")})),
    ),
    r"axes.E.points = 1.5: must be an integer; give ": (
        document(changed(GRID, {"axes.E.points": 1.5})),
    ),
    r"axes.E.points = 0: must be at least 2; ": (document(changed(GRID, {"axes.E.points": 0})),),
    "is a mechanism, not a grid spec; name a grid spec": (
        (ROOT / "datasets/slider_crank.toml").read_bytes(),
    ),
}
NOT_JSON = {
    "is not a text file; name a result, a JSON file": NOT_TEXT,
    r"is not JSON \(.*\); name a result, or redo the fit": (
        *(b"", b"{", b"[" * 100_000, b'{"name": "small", "law"', b"[axes.E]\nmin = 69\n"),
    ),
    "is not a result; name one that a fit has written": (b"[]", b"null", b"3", b'"x"'),
}
# Separated by semicolons; test_cli.py, test_mechanism_sweep.py and others have more, with messages.
COMMANDS = """
export; simulate; finite-element; fit; sample elements.toml -o out.csv;
sample . -o out.csv; fit mechanism.toml; fit fitting/small.toml --optimizer;
fit fitting/small.toml --optimizer simplex; fit fitting/small.toml --scheduler nowhere;
fit fitting/small.toml --scheduler tcp://x:y; fit table.csv --law hertz --contact internal;
fit table.csv --law power --contact x;
fit table.csv --law os:system --contact internal -o out.json;
fit table.csv --law power --contact internal --loss steep -o out.json;
fit table.csv --law nomodule:f --contact internal -o out.json;
optimizers fitting/small.toml genetic simplex; fit fitting/small.toml --optimizer all;
optimizers fitting/small.toml -o out.json; optimizers no.toml;
optimizers fitting/small.toml -o .; optimizers datasets/small.toml;
optimizers table.csv; fit fitting/small.toml --level 0.9;
fit table.csv --law power --contact internal --pairs; fit good.json;
uncertainty good.json --level 2; uncertainty table.csv;
compare mechanism.toml; export good.json; export good.json --to cobol;
export --to c; export --joint no.toml --to c -o out.c; export --joint good.json --to c -o out.c;
export --joint datasets/slider_crank.toml --to c -o out.c;
export --joint datasets/joint.toml --to c; export --joint datasets/joint.toml --to c -o out.f90;
export --joint datasets/joint.toml --to json -o out.json;
export --joint datasets/joint.toml --to python -o 2-pins.py;
export explicit --joint datasets/joint.toml --to c -o out.c;
export --joint datasets/joint.toml --contact internal --to c -o out.c;
export nonsense --to c; export johnson --to c --contact sideways; export no.json --to c;
laws --E -1; laws --nu 2; laws --dR 0; laws --load x; laws --contact sideways; claims -o out.txt;
figure nonsense; figure fig12 --format gif; figure --html;
simulate datasets/small.toml; simulate mechanism.toml --restitution 2;
simulate mechanism.toml --tolerance x; sweep no.toml -o t.csv;
sweep mechanism.toml -o t.csv --jobs 0; simulate mechanism.toml --jobs 2;
sweep mechanism.toml; simulate mechanism.toml --study cases -o t.csv;
finite-element no.toml; finite-element mechanism.toml
"""


def cases(files):
    """Yield every case that breaks a known rule, given the good files."""
    good = {"fitting/small.toml": QUICK, "datasets/small.toml": GRID}
    for path, key, value in ((p, k, v) for p in VALUES for k in VALUES[p] for v in VALUES[p][k]):
        contents = document(changed(good[path], {key: value}))
        yield Case(f"{path}: {key} = {value!r}", READERS[path], path, contents)
    result = "good.json"  # whose parts contradict one another
    for key, value in itertools.product(
        ("settings.campaign", "coefficients", "law", "reference"), (DROP, "x", [1, 2])
    ):
        contents = json.dumps(changed(json.loads(files[result]), {key: value})).encode()
        yield Case(f"{result}: {key} = {value!r}", READERS[result], result, contents)
    for path, rules in (("datasets/small.toml", NOT_TOML), (result, NOT_JSON)):
        for rule, texts in rules.items():
            line = f"cylcontact: {re.escape(path)}: {rule}"
            yield from (Case(f"{path}: {t[:24]!r}", READERS[path], path, t, line) for t in texts)
    for path, (old, new) in ((name, pair) for name in REPLACED for pair in REPLACED[name]):
        coding = "cp1252" if path == "semicolons.csv" else "utf-8"
        contents = files[path].replace(old.encode(coding), new.encode(coding))
        yield Case(f"{path}: {new!r} for {old!r}", READERS[path], path, contents)
    yield Case("table.csv: not text", READERS["table.csv"], "table.csv", NOT_TEXT[1])
    yield from (Case(f"cylcontact {line}", tuple(line.split())) for line in COMMANDS.split(";"))


@pytest.fixture
def bench(small_result, tmp_path, monkeypatch):
    """The good files in a folder of their own."""
    small_result.save(tmp_path / "good.json")
    files = {
        "fitting/small.toml": document(QUICK),
        "datasets/small.toml": document(GRID),
        "table.csv": TABLE.encode(),
        "semicolons.csv": SEMICOLONS.encode("cp1252"),
        "steel.csv": STEEL.encode(),
        "materials.csv": OWN_MATERIALS.encode(),
        "datasets/joint.toml": (ROOT / "datasets/joint.toml").read_bytes(),
        "datasets/slider_crank.toml": (ROOT / "datasets/slider_crank.toml").read_bytes(),
        "mechanism.toml": (ROOT / "datasets/slider_crank.toml").read_bytes(),
        "elements.toml": (ROOT / "datasets/finite_element/recommended.toml").read_bytes(),
    }
    for name, contents in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(contents)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("bench")
def test_the_good_files_are_accepted(run):
    """So that what is refused below is refused for what was broken in it."""
    for path, arguments in READERS.items():
        code, _, errors = run(*arguments)
        assert (code, errors) == (0, ""), path


def test_every_case_that_breaks_a_rule_is_told_in_one_line(bench, run):
    before, wrong = tree(bench), []
    for case in cases(before):
        if case.path:
            (bench / case.path).write_bytes(case.contents)
        code, _, errors = run(*case.arguments)
        if case.path:
            (bench / case.path).write_bytes(before[case.path])
        clear = re.fullmatch(rf"{case.line or 'cylcontact: '}[^\n]*\n", errors)
        if code != 2 or not clear or tree(bench) != before:
            wrong.append(f"{case.name}: exit code {code}: {errors!r}")
    assert wrong == []
