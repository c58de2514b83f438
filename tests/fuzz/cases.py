"""Inputs made by chance: files from schemas and by mutation, and command lines, from a seed."""

import functools
import io
import json
import random
import re
import tomllib
import zipfile
from datetime import date
from math import inf, nan
from typing import Any, NamedTuple

import typer

from cylcontact import choices
from cylcontact.cli.app import app
from cylcontact.export import TARGETS
from cylcontact.laws import LAWS
from tests.malformed import put, resolved
from tests.programs import require_package
from tests.spec_files import DROP, toml


class Source(NamedTuple):
    """A good file with its kind, the command that reads it, and the model of a spec."""

    kind: str
    path: str
    command: tuple[str, ...]
    model: Any = None


class Case(NamedTuple):
    """A command line, and the files that differ from the good ones; `kind` is that of the file."""

    kind: str
    words: tuple[str, ...]
    files: dict[str, bytes]


# What an input might hold that nobody thought of.
TEXTS = (
    *("", " ", "é", "١", "\u202e", "a\0b", "\x1b[31m", "\n", "-", "--", "=", ",", "..", ".", "~"),
    *("no.toml", "no/such/file.csv", "loop.toml", "1e999", "-1", "0", "1", "2", "0.5", "nan"),
    *("inf", "1e-300", "1_000", "0x1F", "1,5", "a:b", "os:system", "x=1", "n=1:2", "n=1.1", "1%"),
    *("x" * 300, "x" * 5000, "../" * 1500 + "x", "\ufeff", "{}", "%s", "[bold]", "$HOME", "\ud800"),
)
NUMBERS = (0, 1, -1, 2, 0.5, 1e-300, 5e-324, 1e300, nan, inf, -inf, 10**400, 2**63, 10**9, -0.0)
OTHERS = (True, False, None, [], {}, [[]], [1.0], [1.0, 2.0], {"a": 1}, date(2015, 1, 1))
# Words that are right somewhere.
WORDS = (
    *LAWS, *TARGETS, *choices.METHODS, *choices.BEYOND, *choices.ENGINES, *choices.STUDIES,
    *choices.FORMATS, *choices.BRANCHES, "internal", "external", "steel", "bronze", "rms-load",
    "genetic", "all", "huber", "constant", "rows", "material", "dR", "load", "207 GPa", "10", "0.3",
)  # fmt: skip
JUNK = ("\0", "\x1b[31m", '"', "'", "[", "]]", "{", "=", ",", ";", "#", "\n", "é", "١", "-", "e")
CELLS = ("-1", "1e999", "nan", "inf", "-inf", "''", "1e-300", "true", "0x1F", "--", "1_", "0", "7")
COLUMNS = (None, "x", "1,5", True, nan, 1e308, 2**62, 0, -1.0, date(2015, 1, 1), [1.0], b"\xff")


def case_of(seed, number, sources, files):
    """Return the case of a number, which depends on the seed and on nothing before it."""
    chance = random.Random(f"{seed} {number}")
    kind, roll = chance.choice([*sources]), chance.random()
    source = chance.choice(sources[kind])
    words, changed = [*source.command], {}
    if source.path and roll < 0.7:
        contents = files[source.path]
        for _ in range(chance.choice((1, 1, 1, 2, 3))):
            contents = _mutated(contents, source, files, chance)
        changed[source.path] = contents
    if 0.6 < roll < 0.95 or not (source.path or roll > 0.95):
        for _ in range(chance.choice((1, 1, 2, 4))):
            _change(words, files, chance)
    return Case(source.kind, tuple(words), changed)


# --- command lines ------------------------------------------------------------------------------


@functools.cache
def options():
    """Return each command with its options, True where one takes a value."""
    commands = typer.main.get_command(app).commands.items()
    return {
        name: [(o, not p.is_flag) for p in command.params for o in p.opts if o.startswith("-")]
        for name, command in commands
    }


def _change(words, files, chance):
    """Change a command line in one place; what it writes stays in its folder."""
    known = options().get(words[0] if words else "") or [("--out", True), ("--version", False)]
    at = chance.randrange(len(words) + 1)
    way = chance.choice(("option", "option", "option", "drop", "double", "word", "swap", "cut"))
    if way == "option":
        option, takes_value = chance.choice(known)
        value = [_word(files, chance)] if takes_value else []
        words += [option, *value] if chance.random() < 0.9 else [f"{option}={''.join(value)}"]
    elif way == "word" and at < len(words):
        words[at] = _word(files, chance)
    elif way == "swap" and at < len(words):
        words[0], words[at] = words[at], words[0]
    elif way == "cut" and at < len(words):
        words[at] = words[at][: chance.randrange(len(words[at]) + 1)]
    elif way == "double":
        words += words[at : at + 2]
    else:
        del words[at : at + chance.choice((1, 2))]


def _word(files, chance):
    return chance.choice((chance.choice(TEXTS), chance.choice(WORDS), chance.choice([*files])))


# --- files --------------------------------------------------------------------------------------


def _mutated(contents, source, files, chance):
    """Change a file in one place, by what it is or as bytes."""
    roll = chance.random()
    try:
        if source.path.endswith((".toml", ".json")) and roll < 0.75:
            return _changed_spec(contents, source, chance)
        if source.path.endswith(".partial") and roll < 0.5:
            return _changed_line(contents, chance)
        if source.path.endswith(".parquet") and roll < 0.6:
            return _changed_column(contents, chance)
        if source.path.endswith(".xlsx") and roll < 0.7:
            return _changed_member(contents, chance)
    except Exception:  # it is broken already, in one of many ways
        return _broken(contents, files, chance)
    return _broken(contents, files, chance)


def _changed_spec(contents, source, chance):
    """Change a value of a spec, or make a spec of what its schema allows."""
    is_toml = source.path.endswith(".toml")
    text = contents.decode()
    spec = tomllib.loads(text) if is_toml else json.loads(text)
    root = _schema(source.model)
    made = chance.random() < 0.2
    spec = _from_schema(root, root, chance) if made else _with_other_value(spec, root, chance)
    if not is_toml:
        return json.dumps(spec, default=str).encode()
    pairs = spec.items() if isinstance(spec, dict) else {"spec": spec}.items()
    lines = [f"{json.dumps(key)} = {toml(value)}\n" for key, value in pairs]
    return "".join(lines).encode(errors="surrogatepass")


@functools.cache
def _schema(model):
    return model.model_json_schema()


def _with_other_value(spec, root, chance):
    """Change one value of a spec: dropped, renamed, moved, scaled or replaced by chance."""
    places = [*_places(spec)] or [((), spec)]
    keys, value = chance.choice(places)
    scalable = [place for place in places if type(place[1]) in (int, float)]
    way = chance.choice(("drop", "name", "move", "scale", "scale", "scale", "odd", "odd", "schema"))
    if not keys:
        return spec
    if way == "drop":
        value = DROP
    elif way == "name" and isinstance(keys[-1], str):
        keys = (*keys[:-1], chance.choice((*TEXTS, "colour")))
    elif way == "move":
        value = chance.choice(places)[1]
    elif way == "scale" and scalable:
        keys, value = chance.choice(scalable)
        scaled = value * chance.choice((0.5, 0.9, 1.1, 2, 10.0 ** chance.uniform(-6, 6), -1))
        value = round(scaled) if type(value) is int else scaled
    elif way == "schema":
        value = _from_schema(chance.choice([*root.get("$defs", {}).values(), root]), root, chance)
    else:
        value = _odd(chance)
    return put(spec, keys, value)


def _places(value, keys=()):
    """Yield the keys of each value in a spec, with the value."""
    if keys:
        yield keys, value
    if isinstance(value, dict | list):
        for key, part in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _places(part, (*keys, key))


def _odd(chance):
    return chance.choice(chance.choice((TEXTS, NUMBERS, OTHERS, WORDS)))


def _from_schema(schema, root, chance):
    """Return a value that a schema allows, now and then another one."""
    form = resolved(schema, root)
    if "anyOf" in form:
        return _from_schema(chance.choice(form["anyOf"]), root, chance)
    if chance.random() < 0.02:
        return _odd(chance)
    if "const" in form or "enum" in form:
        return chance.choice(form.get("enum", [form.get("const")]))
    makers = {"object": _object, "array": _array, "number": _number, "integer": _number}
    if form.get("type") in makers:
        return makers[form["type"]](form, root, chance)
    return {"boolean": True, "null": None}.get(form.get("type"), chance.choice(WORDS))


def _object(form, root, chance):
    inner, others = form.get("properties", {}), form.get("additionalProperties")
    required = form.get("required", ())
    keys = [key for key in inner if key in required or chance.random() < 0.5]
    made = {key: _from_schema(inner[key], root, chance) for key in keys}
    if isinstance(others, dict):
        made |= {chance.choice(WORDS): _from_schema(others, root, chance) for _ in "ab"}
    return made


def _array(form, root, chance):
    number = chance.choice((form.get("minItems", 1), form.get("maxItems", 3)))
    items = form.get("prefixItems", [form.get("items", {})] * number)
    return [_from_schema(item, root, chance) for item in items]


def _number(form, _root, chance):
    low = max(form.get("minimum", -1), form.get("exclusiveMinimum", -1))
    value = low + 10.0 ** chance.uniform(-3, 3)
    value = min(value, form.get("maximum", value), form.get("exclusiveMaximum", value))
    return value if form["type"] == "number" else int(value)


def _changed_line(contents, chance):
    """Change a value on a line of a journal."""
    lines = contents.splitlines(keepends=True)
    at = chance.randrange(len(lines))
    part = _with_other_value(json.loads(lines[at]), {}, chance)
    lines[at] = json.dumps(part, default=str).encode() + b"\n"
    return b"".join(lines)


def _changed_column(contents, chance):
    """Change a column of a table in Parquet: its values, its name, or that it is there."""
    pa = require_package("pyarrow")
    table = pa.parquet.read_table(io.BytesIO(contents))
    at, name = chance.randrange(table.num_columns), chance.choice((*TEXTS[:6], "E_GPa", "load_N"))
    way = chance.choice(("values", "name", "drop", "double", "none"))
    if way == "values":
        table = table.set_column(
            at, table.column_names[at], pa.array([chance.choice(COLUMNS)] * table.num_rows)
        )
    elif way == "name":
        table = table.set_column(at, name, table.column(at))
    elif way == "double":
        table = table.append_column(table.column_names[at], table.column(at))
    else:
        table = table.remove_column(at) if way == "drop" else table.slice(0, 0)
    return as_parquet(table)


def as_parquet(table):
    """Return a table as the bytes of a file."""
    buffer = io.BytesIO()
    require_package("pyarrow.parquet").write_table(table, buffer)
    return buffer.getvalue()


def _changed_member(contents, chance):
    """Change a file inside a spreadsheet, mostly the sheet itself."""
    with zipfile.ZipFile(io.BytesIO(contents)) as archive:
        members = {name: archive.read(name) for name in sorted(archive.namelist())}
    sheets = [name for name in members if "sheet1" in name]
    name = chance.choice(sheets * 10 + [*members])
    return zipped(members | {name: _broken(members[name], {}, chance)})


def zipped(members):
    """Return files as a zip archive, the same bytes at any time."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, contents in members.items():
            archive.writestr(zipfile.ZipInfo(name), contents)
    return buffer.getvalue()


def _broken(contents, files, chance):
    """Break a file in one place, as bytes, as lines or as numbers."""
    at, text = chance.randrange(len(contents) + 1), contents.decode(errors="replace")
    others = [*files.values()] or [b"other"]

    def line():
        lines = text.splitlines(keepends=True) or [""]
        lines[chance.randrange(len(lines))] = chance.choice(lines) * chance.choice((0, 1, 2, 20))
        return "".join(lines).encode()

    def number():
        found = [m.span() for m in re.finditer(r"(?<![\w.])\d+(\.\d+)?(?![\w.])", text)]
        begin, end = chance.choice(found or [(0, 0)])
        return (text[:begin] + chance.choice(CELLS) + text[end:]).encode()

    def code():
        coding, ending = chance.choice(("utf-8-sig", "utf-16", "cp1252")), chance.choice("\r\n")
        return text.replace("\n", ending).encode(coding, "replace")

    def other():
        return chance.choice(others)[: chance.choice((50, 10**9))] + contents[at:]

    ways = (
        lambda: contents[:at],
        lambda: contents[:at] + contents[at + chance.randrange(1, 12) :],
        lambda: contents[:at] + chance.choice(JUNK).encode() + contents[at:],
        lambda: contents[:at] + bytes([chance.randrange(256)]) + contents[at + 1 :],
        *(line, line, number, number, code, other),
    )
    return chance.choice(ways)()
