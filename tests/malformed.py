"""Malformed inputs: good files broken by rule, and good files broken by chance, always the same."""

import copy
import itertools
import json
import random
import re
import tomllib
from datetime import date
from pathlib import Path
from typing import NamedTuple

from cylcontact.materials import COLUMNS
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


class Case(NamedTuple):
    """A command line and a file that it reads, with what that file holds."""

    name: str
    arguments: tuple[str, ...]
    path: str = ""
    contents: bytes = b""


# --- the good files, and the commands that read them --------------------------------------------

READERS = {
    "fitting/small.toml": ("fit", "fitting/small.toml", "-j", "1", "-o", "out.json"),
    "datasets/small.toml": ("sample", "datasets/small.toml", "-o", "out.csv"),
    "good.json": ("compare", "good.json"),
    "table.csv": ("fit", "table.csv", "--law", "power", "--contact", "internal", "-o", "out.json"),
    "datasets/materials.csv": ("export", "johnson"),
    "mechanism.toml": ("simulate", "mechanism.toml", "--revolutions", "1"),
    "elements.toml": ("finite-element", "elements.toml", "-j", "1", "-o", "out.csv"),
}
MATERIALS = ("fit", "steel.csv", "--law", "power", "--contact", "internal", "-o", "out.json")
READERS["datasets/materials.csv"] = (
    *MATERIALS,
    *("--material", "bronze", "--materials", "datasets/materials.csv"),
)
OWN_MATERIALS = f"{','.join(COLUMNS)}\nbronze,110,paper,0.34,paper,220,assumed,a note\n"
STEEL = "dR_um,load_N_per_mm,penetration_um\n50,10,0.21\n50,100,1.7\n50,1000,13.2\n"


def good_files(result):
    """Every file of a bench that all commands accept, name → contents, for a saved result."""
    return {
        "fitting/small.toml": document(QUICK),
        "datasets/small.toml": document(GRID),
        "good.json": result,
        "table.csv": TABLE.encode(),
        "steel.csv": STEEL.encode(),
        "datasets/materials.csv": OWN_MATERIALS.encode(),
        "mechanism.toml": (ROOT / "datasets/slider_crank.toml").read_bytes(),
        "elements.toml": (ROOT / "datasets/finite_element/recommended.toml").read_bytes(),
    }


def document(spec):
    """Return a spec as the bytes of a TOML file."""
    return "".join(f"{key} = {toml(value)}\n" for key, value in spec.items()).encode()


# --- by rule ------------------------------------------------------------------------------------

# What no key of any spec takes.
WRONG = {"date": date(2015, 1, 1), "table": {}, "nested": [[1.0]], "nan": float("nan")}


def leaves(spec, prefix=()):
    """Yield the keys of everything in a spec that is not a table."""
    for key, value in spec.items():
        if isinstance(value, dict) and value:
            yield from leaves(value, (*prefix, key))
        else:
            yield (*prefix, key)


def tables(spec, prefix=()):
    """Yield the keys of every table in a spec, its own first."""
    yield prefix
    for key, value in spec.items():
        if isinstance(value, dict) and value:
            yield from tables(value, (*prefix, key))


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


def broken_specs(path, spec, wrong=tuple(WRONG), unknown=True):
    """Break a spec at every key in every way."""
    for keys, kind in itertools.product(leaves(spec), wrong):
        contents = document(put(spec, keys, WRONG[kind]))
        yield Case(f"{path}: {'.'.join(keys)} is a {kind}", READERS[path], path, contents)
    for keys in tables(spec) if unknown else ():
        contents = document(put(spec, (*keys, "colour"), 1))
        yield Case(f"{path}: {'.'.join((*keys, 'colour'))}", READERS[path], path, contents)


REQUIRED = {
    "fitting/small.toml": ("dataset", "law", "parameters", "parameters.K_star"),
    "datasets/small.toml": ("contact", "reference", "axes", "axes.E", "axes.nu", "axes.dR.points"),
}
VALUES = {
    "fitting/small.toml": {
        "dataset": ["", "no.toml", "fitting", "a\0b", "../../../no.toml"],
        "law": ["", "hertz", "Power"],
        "objective": ["", "rms", "max"],
        "seed": [-1, 1.5, "7"],
        "optimizer": ["", "simplex"],
        "parameters.K_star.low": [10.0, 11.0, 1e999],
        "parameters.n": [{"value": 1.2}, {"fixed": True}, {"low": 1.0}, {"low": 2, "high": 1}],
        "genetic.runs": [0, -1, 10**9],
        "genetic.populations": [[], [3], [8, 1], [10**9], 8],
        "genetic.generations": [0, -5],
        "genetic.crossovers": [[], ["none"], "blend"],
    },
    "datasets/small.toml": {
        "contact": ["", "Internal", "inside"],
        "reference": ["", "hertz", "lankarani-nikravesh"],
        "axes.E.min": [0, -1, 600.0, 700.0, 1e-300],
        "axes.E.points": [0, 1, -3, 2.5, 10**9],
        "axes.E.spacing": ["", "cubic"],
        "axes.nu.values": [[], [0.3, 0.3], [0.5, 0.6], [-0.1], 0.3, [0.3, "x"]],
        "axes.load": [{"values": [1e9]}, {"values": [0.0]}, {"min": 1, "max": 2}],
        "axes.dR": [{"values": [1e13]}, {"values": [1.0], "min": 1}, {}],
    },
}


def broken_values():
    """Values of the right kind that break a rule, and keys that are missing."""
    good = {"fitting/small.toml": QUICK, "datasets/small.toml": GRID}
    for path, spec in good.items():
        changes = [(key, DROP) for key in REQUIRED[path]]
        changes += [(key, value) for key, values in VALUES[path].items() for value in values]
        for key, value in changes:
            shown = "missing" if value is DROP else repr(value)
            contents = document(changed(spec, {key: value}))
            yield Case(f"{path}: {key} {shown}", READERS[path], path, contents)


def broken_results(result):
    """Results with parts missing, of another kind, or contradicting one another."""
    data = json.loads(result)
    for keys in [(key,) for key in data] + [("objective", "value"), ("settings", "campaign")]:
        for value in (DROP, "x", [1, 2], 10**400):
            if (keys, value) == (("name",), "x"):
                continue  # a name is free
            contents = json.dumps(put(data, keys, value)).encode()
            shown = "missing" if value is DROP else repr(value)
            yield Case(
                f"result: {'.'.join(keys)} {shown}", READERS["good.json"], "good.json", contents
            )
    for text in (b"", b"{", b"[]", b"null", b"3", b'"x"', b"\xff\xfe", b"[" * 5000, b"NaN"):
        yield Case(f"result: {text[:8]!r}", READERS["good.json"], "good.json", text)


def broken_tables():
    """Tables of measurements with columns, cells and rows that cannot be."""
    lines = TABLE.splitlines()
    broken = {
        "nothing": "",
        "no rows": lines[1],
        "unknown column": TABLE.replace("dR_um", "gap_um"),
        "unknown unit": TABLE.replace("dR_um", "dR_furlong"),
        "no unit": TABLE.replace("dR_um", "dR"),
        "doubled column": TABLE.replace("nu,", "E_GPa,"),
        "no load": TABLE.replace("load_N_per_mm", "weight"),
        "word": TABLE.replace("0.21", "small"),
        "empty cell": TABLE.replace("0.21", ""),
        "nan": TABLE.replace("0.21", "nan"),
        "infinite": TABLE.replace("0.21", "inf"),
        "negative load": TABLE.replace(",100,", ",-100,"),
        "zero penetration": TABLE.replace("0.21", "0"),
        "impossible nu": TABLE.replace("0.3,", "0.7,"),
        "negative modulus": TABLE.replace("207", "-207"),
        "more cells": TABLE.replace("0.21", "0.21,1"),
        "fewer cells": TABLE.replace(",0.21", ""),
        "open quote": TABLE.replace("0.21", '"0.21'),
        "binary": "\0\0\0\0",
    }
    for name, text in broken.items():
        yield Case(f"table: {name}", READERS["table.csv"], "table.csv", text.encode())
    yield Case("table: not text", READERS["table.csv"], "table.csv", b"\x89PNG\xff\xfe")


def broken_materials():
    """Tables of materials with wrong columns, numbers and provenances."""
    text = OWN_MATERIALS
    broken = {
        "nothing": "",
        "no column": text.replace("E_GPa,", "", 1),
        "other column": text.replace("E_GPa", "E_MPa", 1),
        "word": text.replace(",110,", ",hard,"),
        "negative": text.replace(",110,", ",-110,"),
        "nu": text.replace(",0.34,paper", ",0.90,paper"),
        "provenance": text.replace("paper", "rumour"),
        "no name": text.replace("bronze", ""),
        "short row": text + "steel,200\n",
        "name that ships": text.replace("bronze", "ceramics"),
        "twice": text + text.splitlines()[1] + "\n",
        "binary": "\0",
    }
    path = "datasets/materials.csv"
    for name, changed_text in broken.items():
        yield Case(f"materials: {name}", READERS[path], path, changed_text.encode())


COMMANDS = (
    *("", "nonsense", "--nonsense", "sample", "fit", "compare", "export", "simulate", "sweep"),
    *("finite-element", "optimizers", "uncertainty", "fit good.json", "fit table.csv"),
    *("sample datasets/small.toml", "sample datasets/small.toml -o out.xlsx"),
    *("sample fitting/small.toml -o out.csv", "sample good.json -o out.csv", "sample . -o out.csv"),
    *("fit fitting/small.toml --optimizer", "fit fitting/small.toml --optimizer simplex"),
    *("fit fitting/small.toml --jobs 0", "fit fitting/small.toml --seed x"),
    *("fit fitting/small.toml --scheduler nowhere", "fit fitting/small.toml --scheduler tcp://x:y"),
    "fit fitting/small.toml --scheduler tcp://127.0.0.1:9 --jobs 2",
    *("fit fitting/small.toml -o fitting", "fit fitting/small.toml -o good.json/x.json"),
    *("optimizers fitting/small.toml simplex", "optimizers fitting/small.toml -o out.json"),
    *("optimizers datasets/small.toml", "optimizers no.toml", "optimizers fitting/small.toml -o ."),
    *("compare no.json", "compare fitting/small.toml", "compare datasets", "verify table.csv"),
    *("export good.json", "export good.json --to cobol", "export nonsense --to c"),
    *("export johnson --to c --contact sideways", "export no.json --to c"),
    *("laws --E -1", "laws --nu 2", "laws --dR 0", "laws --load x", "laws --contact sideways"),
    *("claims -o out.txt", "report nonsense", "simulate no.toml", "simulate good.json"),
    *(
        "claims --results nosuch",
        "report fig12 --results nosuch",
        "report fig12 --results good.json",
    ),
    *("fit mechanism.toml", "simulate datasets/small.toml", "simulate fitting/small.toml"),
    *("compare table.csv", "compare mechanism.toml", "sample elements.toml -o out.csv"),
    *("simulate mechanism.toml --law nonsense", "simulate mechanism.toml --revolutions 0"),
    *("simulate mechanism.toml --clearance -1", "simulate mechanism.toml --restitution 2"),
    *("simulate mechanism.toml --method magic", "simulate mechanism.toml --tolerance x"),
    *("sweep mechanism.toml --jobs 0", "sweep no.toml", "finite-element no.toml"),
    *("finite-element elements.toml --engine abaqus", "finite-element mechanism.toml"),
    *("fit table.csv --law hertz --contact internal", "fit table.csv --law power --contact x"),
    *("fit table.csv --law power --contact internal --loss steep -o out.json",),
    *("fit table.csv --law power --contact internal --bound n -o out.json",),
    *("fit table.csv --law power --contact internal --fix n=x -o out.json",),
    *("fit table.csv --law os:system --contact internal -o out.json",),
    *("fit table.csv --law nomodule:f --contact internal -o out.json",),
)


def by_rule(result):
    """Return every case that breaks a known rule, given the bytes of a good result."""
    mechanism = tomllib.loads((ROOT / "datasets/slider_crank.toml").read_text(encoding="utf-8"))
    elements = (ROOT / "datasets/finite_element/recommended.toml").read_text(encoding="utf-8")
    return [
        *broken_specs("fitting/small.toml", QUICK),
        *broken_specs("datasets/small.toml", GRID),
        *broken_values(),
        *broken_results(result),
        *broken_tables(),
        *broken_materials(),
        *broken_specs("mechanism.toml", mechanism, ("date",)),
        *broken_specs("elements.toml", tomllib.loads(elements), ("date", "table")),
        *(Case(f"cylcontact {line}", tuple(line.split())) for line in COMMANDS),
    ]


# --- by chance ----------------------------------------------------------------------------------

# Nothing in it is a digit: a number made longer by chance would only make a long calculation.
JUNK = (
    "\0",
    "\x1b[31m",
    '"',
    "'",
    "[",
    "]]",
    "{",
    "=",
    ",",
    ";",
    "#",
    "\n",
    "é",
    "١",
    "-",
    "e",
    "x" * 300,
)
NUMBERS = ("-1", "1e999", "nan", "inf", "-inf", "''", "1e-300", "true", "0x1F", "--", "1_")


def by_chance(files, number, seed=20150101):
    """Return cases of good files, each broken in one place; a few remain good."""
    chance = random.Random(seed)
    found = []
    for path, arguments in READERS.items():
        if path in {"mechanism.toml", "elements.toml"}:
            continue  # what is left good would take seconds to run
        for count in range(number):
            contents = _break(files[path], chance)
            found.append(Case(f"{path} #{count}", arguments, path, contents))
    return found


def _break(contents, chance):
    """Break a file in one place."""
    way = chance.choice(("cut", "drop", "line", "junk", "number", "byte"))
    where = chance.randrange(len(contents))
    if way == "cut":
        return contents[:where]
    if way == "drop":
        return contents[:where] + contents[where + chance.randrange(1, 12) :]
    if way == "junk":
        return contents[:where] + chance.choice(JUNK).encode() + contents[where:]
    if way == "byte":
        return contents[:where] + bytes([chance.randrange(128, 256)]) + contents[where + 1 :]
    text = contents.decode()
    if way == "line":
        lines = text.splitlines(keepends=True)
        lines.insert(chance.randrange(len(lines)), chance.choice(lines))
        return "".join(lines).encode()
    pieces = _numbers(text)
    begin, end = chance.choice(pieces)
    return (text[:begin] + chance.choice(NUMBERS) + text[end:]).encode()


def _numbers(text):
    """Return where the numbers of a text begin and end."""
    return [match.span() for match in re.finditer(r"(?<![\w.])\d+(\.\d+)?(?![\w.])", text)]
