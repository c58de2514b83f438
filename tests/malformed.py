"""Malformed inputs: good files broken by schema and by rule, always the same."""

import copy
import itertools
import json
import re
import tomllib
from datetime import date
from math import inf, nan
from pathlib import Path
from typing import NamedTuple

from cylcontact import InputError
from cylcontact.datasets.finite_element.spec import StudySpec
from cylcontact.datasets.grid import DimensionlessGridSpec, GridSpec
from cylcontact.fitting import FitResult
from cylcontact.fitting.specs import CampaignSpec, MeasuredSpec
from cylcontact.materials import COLUMNS
from cylcontact.mechanism.joint import ClearanceJointSpec
from cylcontact.mechanism.model import MechanismSpec
from cylcontact.plots.style import StyleFile
from tests.spec_files import CAMPAIGN, DROP, GRID, changed, toml

ROOT = Path(__file__).resolve().parents[1]
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
STYLE = {
    **{"style": "slides", "width_mm": 100.0, "font_size": 9.0, "lines": 1.5},
    **{"font": "DejaVu Sans", "formats": ["png"]},
}


class Case(NamedTuple):
    """A command line, a file that it reads, what that file holds, and a pattern of what is said."""

    name: str
    arguments: tuple[str, ...]
    path: str = ""
    contents: bytes = b""
    line: str = ""


# --- the good files, and the commands that read them --------------------------------------------

OUT = ("-j", "1", "-o", "out.json")
POWER = ("--law", "power", "--contact", "internal", *OUT)
JOINT = ("export", "--joint", "{}", "--to", "c", "-o", "out.c")
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
# The shipped specs, each under the first pattern that it matches.
SPECS = (
    ("datasets/slider_crank.toml", MechanismSpec, ("simulate", "{}", "--revolutions", "1")),
    ("datasets/four_bar.toml", MechanismSpec, ("simulate", "{}", "--revolutions", "1")),
    ("datasets/joint.toml", ClearanceJointSpec, JOINT),
    ("datasets/finite_element/*.toml", StudySpec, ("finite-element", "{}", "-o", "out.csv")),
    ("datasets/any-pair.toml", DimensionlessGridSpec, ("sample", "{}", "-o", "out.csv")),
    ("datasets/*.toml", GridSpec, ("sample", "{}", "-o", "out.csv")),
    ("fitting/examples/*.toml", MeasuredSpec, ("fit", "{}", *OUT)),
    ("fitting/*.toml", CampaignSpec, ("fit", "{}", *OUT)),
    ("reports/style.toml", StyleFile, ("figure", "fig12")),
    ("good.json", FitResult, READERS["good.json"]),
)


def good_files(result):
    """Return every file of a bench that all commands accept, name → contents."""
    shipped = (path for pattern, *_ in SPECS for path in ROOT.glob(pattern))
    return {path.relative_to(ROOT).as_posix(): path.read_bytes() for path in shipped} | {
        "fitting/small.toml": document(QUICK),
        "datasets/small.toml": document(GRID),
        "good.json": result,
        "table.csv": TABLE.encode(),
        "semicolons.csv": SEMICOLONS.encode("cp1252"),
        "steel.csv": STEEL.encode(),
        "materials.csv": OWN_MATERIALS.encode(),
        "reports/style.toml": document(STYLE),
        "mechanism.toml": (ROOT / "datasets/slider_crank.toml").read_bytes(),
        "elements.toml": (ROOT / "datasets/finite_element/recommended.toml").read_bytes(),
    }


def specs(files):
    """Yield the specs among the files, each with its model and the command that reads it."""
    remaining = list(files)
    for pattern, model, command in SPECS:
        for path in [path for path in remaining if Path(path).match(pattern)]:
            remaining.remove(path)
            yield path, model, tuple(word.format(path) for word in command)


def document(spec):
    """Return a spec as the bytes of a TOML file."""
    return "".join(f"{key} = {toml(value)}\n" for key, value in spec.items()).encode()


# --- by schema ----------------------------------------------------------------------------------

# A value of each type in the words of JSON's schemas, and one that only TOML has; null only JSON.
SAMPLES = {
    **{"number": 3.0, "string": "3", "boolean": True, "array": [[1.0]], "object": {}},
    **{"date": date(2015, 1, 1), "null": None},
}
RULES = {
    **{"number": "must be a number", "integer": "must be an integer", "array": "must be a list"},
    **{"string": "must be a string", "boolean": "must be true or false"},
    "object": "must be a table",
}
# Of each bound: how far beyond it a value is refused, and the rule.
BOUNDS = {
    "minimum": (-1, "must be at least"),
    "exclusiveMinimum": (0, "must be greater than"),
    "maximum": (1, "must be less than or equal to"),
    "exclusiveMaximum": (0, "must be less than"),
}


class Mistake(NamedTuple):
    """A value at some keys, the rule that it breaks and the remedy; "" if no schema says them."""

    keys: tuple[str | int, ...]
    value: object
    rule: str = ""
    remedy: str = ""


def by_schema(files):
    """Yield a case for each key of each spec and all its schema rules out; no case twice."""
    seen = set()
    for path, model, arguments in specs(files):
        root = model.model_json_schema()
        is_toml = path.endswith(".toml")
        spec = tomllib.loads(files[path].decode()) if is_toml else json.loads(files[path])
        for keys, value, rule, remedy in mistakes(root, spec, root):
            key = ".".join(map(str, keys))
            case = (model, key, repr(value))
            if case in seen or (value is None if is_toml else isinstance(value, date)):
                continue
            seen.add(case)
            broken = put(spec, keys, value)
            contents = document(broken) if is_toml else json.dumps(broken).encode()
            given = None if value is DROP else value
            line = str(InputError(path, key, given, rule, remedy)) if rule else path
            line = re.escape(f"cylcontact: {line}")
            yield Case(f"{path}: {key} = {value!r}", arguments, path, contents, line)


def mistakes(schema, value, root, keys=(), description=""):
    """Yield the mistakes that a value's schema rules out, in it and in all that it holds."""
    forms = [resolved(form, root) for form in resolved(schema, root).get("anyOf", [schema])]
    nullable = {"type": "null"} in forms
    forms = [form for form in forms if form.get("type") != "null"]
    remedy = f"give {description}"
    for form in forms:
        rule = rule_of(form)
        if keys and len(forms) == 1 and "type" in form:
            allowed = {form["type"]} | ({"null"} if nullable else set())
            wrong = [sample for name, sample in SAMPLES.items() if name not in allowed]
            wrong += ["nonsense"] if "enum" in form else []
            yield from (Mistake(keys, sample, rule, remedy) for sample in wrong)
        if form.get("type") == "number":
            finite = "must be a finite number"
            yield from (Mistake(keys, number, finite, remedy) for number in (nan, inf, -inf))
            yield Mistake(keys, 10**400)
        for bound, (step, words) in BOUNDS.items():
            if bound in form:
                yield Mistake(keys, form[bound] + step, f"{words} {form[bound]:g}", remedy)
        if form.get("type") == "object":
            yield from mistakes_in_table(form, value, root, keys, description)
        if form.get("type") == "array" and value:
            if schema.get("default") != []:
                yield Mistake(keys, [])
            if form.get("minItems", 0) > 1:
                yield from (Mistake(keys, wrong) for wrong in (value[:-1], [*value, value[-1]]))
            item = form.get("prefixItems", [form.get("items", {})])[0]
            yield from mistakes(item, value[0], root, (*keys, 0), description)


def mistakes_in_table(form, value, root, keys, description):
    """Yield the mistakes in a table: missing and unknown keys, and those in what it holds."""
    inner = form.get("properties", {})
    others = form.get("additionalProperties", {})
    # Without `data` a campaign on measurements reads as one on a grid, and `contact` is blamed.
    for key in [key for key in form.get("required", ()) if key in value and key != "data"]:
        yield Mistake((*keys, key), DROP, "is required", f"add {inner[key]['description']}")
    if others is False:
        known = f"known keys here: {', '.join(inner)}"
        yield Mistake((*keys, "colour"), 1, "is not a known key", known)
    for key, part in value.items():
        schema = inner.get(key, others)
        # A grid's `table` that is no string is called missing.
        if isinstance(schema, dict) and part is not None and key != "table":
            own = inner.get(key, {}).get("description", description)
            yield from mistakes(schema, part, root, (*keys, key), own)


def rule_of(form):
    """Return the rule that a value of another type breaks."""
    if "enum" not in form:
        return RULES.get(form.get("type"), "")
    *most, last = map(repr, form["enum"])
    return f"must be {', '.join(most)} or {last}"


def resolved(schema, root):
    """Return a schema, or the definition that it refers to."""
    return root["$defs"][schema["$ref"].rpartition("/")[2]] if "$ref" in schema else schema


def put(spec, keys, value):
    """Return a copy of a spec with one value replaced, or dropped."""
    result = copy.deepcopy(spec)
    *outer, last = keys
    table = result
    for key in outer:
        table = table[key]
    if value is DROP:
        del table[last]
    else:
        table[last] = value
    return result


# --- by rule: what no schema can know -----------------------------------------------------------

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
# What is said, as a pattern, of texts in a spec's place.
NOT_TEXT = (b"\xff\xfe", b"\x89PNG\r\n\x1a\n\0\0", b"PAR1\x80\0", 'name = "ä"'.encode("latin-1"))
NOT_TOML = {
    "is not a text file; give a TOML file in UTF-8": NOT_TEXT,
    r"is not valid TOML \(.*\); correct the line it names": (
        *(b"contact = internal", b"a = 1\na = 2", b"name = ["),
        *(b"a = " + b"[" * 5000, b"a = " + b"9" * 5000),
    ),
}
NOT_JSON = {
    "is not a text file; name a result, a JSON file": NOT_TEXT,
    r"is not JSON \(.*\); name a result, or redo the fit": (
        *(b"", b"{", b"[" * 100_000, b"9" * 5000, b'{"name": "small", "law"'),
        b"[axes.E]\nmin = 69\n",
    ),
    "is not a result; name one that a fit has written": (b"[]", b"null", b"3", b'"x"', b"NaN"),
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
fit fitting/small.toml --optimizer genetic,simplex; fit fitting/small.toml --optimizer all,cma;
fit fitting/small.toml --optimizer all -o out.json; fit no.toml --optimizer all;
fit fitting/small.toml --optimizer all -o .; fit datasets/small.toml --optimizer all;
fit fitting/small.toml --optimizer all --force; fit fitting/small.toml --level 0.9;
fit table.csv --law power --contact internal --pairs; fit good.json --runs 2;
fit good.json --resume;
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
simulate mechanism.toml --tolerance x; simulate no.toml --study cases -o t.csv;
simulate mechanism.toml --study cases -o t.csv --jobs 0; simulate mechanism.toml --jobs 2;
simulate mechanism.toml --study cases; simulate mechanism.toml --study chaos -o t.csv;
finite-element no.toml; finite-element mechanism.toml
"""


def by_rule(files):
    """Yield every case that breaks a known rule, given the good files."""
    good = {"fitting/small.toml": QUICK, "datasets/small.toml": GRID}
    for path, key, value in ((p, k, v) for p in VALUES for k in VALUES[p] for v in VALUES[p][k]):
        contents = document(changed(good[path], {key: value}))
        yield Case(f"{path}: {key} = {value!r}", READERS[path], path, contents)
    result = "good.json"  # whose parts contradict one another
    places = (("settings", "campaign"), ("coefficients",), ("law",), ("reference",))
    for keys, value in itertools.product(places, (DROP, "x", [1, 2], 10**400)):
        contents = json.dumps(put(json.loads(files[result]), keys, value)).encode()
        yield Case(f"{result}: {keys} = {value!r}", READERS[result], result, contents)
    for path, model, arguments in {spec[1]: spec for spec in specs(files)}.values():
        for rule, texts in (NOT_JSON if model is FitResult else NOT_TOML).items():
            line = f"cylcontact: {re.escape(path)}: {rule}"
            yield from (Case(f"{path}: {t[:24]!r}", arguments, path, t, line) for t in texts)
        for other, reason in (("no.toml", "No such file or directory"), (".", "Is a directory")):
            line = rf"cylcontact: {re.escape(other)}: cannot be read \({reason}\); check the path"
            words = tuple(other if word == path else word for word in arguments)
            if words != arguments:
                yield Case(f"{other} for {path}", words, line=line)
    path = "datasets/small.toml"
    line = rf'cylcontact: {path}: contact: is required; add "internal" or "external" \(2 more mist'
    yield Case("an empty file", READERS[path], path, b"", line)
    for path, (old, new) in ((name, pair) for name in REPLACED for pair in REPLACED[name]):
        coding = "cp1252" if path == "semicolons.csv" else "utf-8"
        contents = files[path].replace(old.encode(coding), new.encode(coding))
        yield Case(f"{path}: {new!r} for {old!r}", READERS[path], path, contents)
    yield Case("table.csv: not text", READERS["table.csv"], "table.csv", NOT_TEXT[1])
    yield from (Case(f"cylcontact {line}", tuple(line.split())) for line in COMMANDS.split(";"))
