"""Malformed input, by hand and at random: one line and exit code 2, and nothing is written.

Random cases start from good files and command lines, and spoil them in one or two places.
"""

import copy
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cylcontact import InputError
from cylcontact.datasets import read_grid
from cylcontact.datasets.finite_element.study import read_study
from cylcontact.datasets.measurements import read_measured
from cylcontact.fitting import Campaign
from cylcontact.mechanism import SpatialJoint, read_joint, read_mechanism
from tests.support.spec_files import CAMPAIGN, DROP, ELEMENTS, GRID, changed, toml, tree, write_toml

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = ("slider_crank", "joint", "spatial_joint")
FILES = {name: tomllib.loads((ROOT / f"datasets/{name}.toml").read_text()) for name in SHIPPED}
QUICK = {"bounds.n": DROP, "fixed.n": 1.2, "genetic.runs": 1, "genetic.generations": 2}
FILES |= {"small": GRID, "campaign": changed(CAMPAIGN, QUICK), "elements": ELEMENTS}
READERS = {
    "slider_crank": read_mechanism,
    "joint": read_joint,
    "spatial_joint": SpatialJoint.read,
    "small": read_grid,
    "campaign": Campaign.read,
    "elements": read_study,
}
TABLE = """\
dR_um,E_GPa,nu,load_N_per_mm,penetration_um
50,207,0.3,10,0.21
50,207,0.3,100,1.7
50,207,0.3,1000,13.2
100,207,0.3,10,0.23
"""
FIT = "--law power --contact internal -j 1 -o out.json"
LINES = f"""
sample datasets/small.toml -o out.csv
fit campaign.toml --seed 1 -j 1 -o out.json
fit table.csv --bound n=1:1.5 --noise proportional {FIT}
fit table.csv --fixed n=1.1 --columns load=load_N_per_mm {FIT}
compare good.json
check --material 207GPa,0.3 --Ri 10 --radial-clearance 0.05 --load 100
export johnson --to c --contact internal -o out.c
export good.json --to matlab -o out.m
export --joint joint.toml --to c -o out.c
simulate slider_crank.toml --law explicit --revolutions 1 --restitution 0.9 --table out.parquet
sweep slider_crank.toml --law explicit --revolutions 1 -j 1 -o out.csv
finite-element elements.toml -j 1 -o out.csv
"""
# What takes the place of an argument; none asks for more work.
WRONG = (
    *("", "x", "-1", "0", "nan", "1e999", "1,5", "9:1", "a=b", "ä", "--", "--law", "-o", ".", "/"),
    *("no.toml", "empty", "table.csv", "good.json", "joint.toml", "slider_crank.toml", "os:system"),
)

# --- what is said -----------------------------------------------------------------------------

SAID = [
    ("small.toml", b"\xff\xfe", "is not a text file; give a TOML file in UTF-8"),
    ("small.toml", b"a = " + b"[" * 5000, r"is not valid TOML \(.*\); correct the line it names"),
    ("small.toml", b"", r'contact: is required; add "internal" or "external" \(2 more mistakes\)'),
    ("good.json", b"\x89PNG\r\n", "is not a text file; name a result, a JSON file"),
    ("good.json", b"[" * 100_000, r"is not JSON \(.*\); name a result, or redo the fit"),
    ("good.json", b"[]", "is not a result; name one that a fit has written"),
]
GRID_WITH = {
    r"colour = 1: is not a known key; known keys here: contact, reference, ": {"colour": 1},
    r"axes: is required; add ": {"axes": DROP},
    r"reference = 3: must be a string; give ": {"reference": 3},
    r"axes.E.min = nan: must be a finite number; give ": {"axes.E.min": float("nan")},
    r"axes.E.points = 1.5: must be an integer; give ": {"axes.E.points": 1.5},
}
SAID += [
    ("small.toml", "\n".join(f"{k} = {toml(v)}" for k, v in changed(GRID, spoiled).items()), rule)
    for rule, spoiled in GRID_WITH.items()
]


@pytest.fixture
def bench(small_result, tmp_path, monkeypatch):
    """A good file of every kind in a folder of its own."""
    for name, spec in FILES.items():
        write_toml(tmp_path / f"{name}.toml", spec)
    write_toml(tmp_path / "datasets/small.toml", GRID)
    small_result.save(tmp_path / "good.json")
    (tmp_path / "table.csv").write_text(TABLE)
    (tmp_path / "empty").touch()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_mistake_has_its_line(bench, run):
    commands = {"small.toml": ("sample", "small.toml", "-o", "s.csv"), "good.json": ("compare",)}
    commands["good.json"] += ("good.json",)
    for path, text, rule in SAID:
        (bench / path).write_bytes(text if isinstance(text, bytes) else text.encode())
        before = tree(bench)
        code, _, errors = run(*commands[path])
        assert code == 2
        assert re.fullmatch(rf"cylcontact: {re.escape(path)}: {rule}[^\n]*\n", errors), errors
        assert tree(bench) == before


# --- at random --------------------------------------------------------------------------------

numbers = st.sampled_from([-1, 0, 1, 3, 10**19, True, -0.5, 1e-300, 1e13, np.inf, np.nan])
words = st.text(st.characters(codec="utf-8"), max_size=6) | st.sampled_from(["steel", "207 GPa"])
values = st.recursive(
    numbers.map(lambda x: x if isinstance(x, int) else float(x)) | words,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=2),
    max_leaves=4,
)
# Together some 300 cases in make test and 15,000 in the night.
few_or_many = pytest.mark.parametrize("times", [1, pytest.param(50, marks=pytest.mark.long)])


def places(value, path=()):
    """Yield the path of everything in nested tables and lists."""
    if isinstance(value, dict | list):
        for key in value if isinstance(value, dict) else range(len(value)):
            yield (*path, key)
            yield from places(value[key], (*path, key))


@st.composite
def spoiled(draw, spec):
    """A spec with one or two entries left out, renamed or given another value."""
    spec = copy.deepcopy(spec)
    for _ in range(draw(st.integers(1, 2))):
        *path, key = draw(st.sampled_from(list(places(spec)) or [("new",)]))
        table = spec
        for name in path:
            table = table[name]
        how = draw(st.sampled_from(["drop", "rename", "other", "other"]))
        if how == "other":
            table[key] = draw(values)
        elif key in table or isinstance(table, list):
            old = table.pop(key)
            if how == "rename" and isinstance(table, dict):
                table[draw(words)] = old
    return spec


def many(examples, strategy):
    """Return a decorator that runs a check with so many random cases."""

    def decorate(check):
        random = settings(max_examples=examples, suppress_health_check=list(HealthCheck))
        return random(given(strategy)(check))()

    return decorate


def is_refused(read, path):
    """Whether a reader refuses a file, which it must do in a line with a rule and a remedy."""
    try:
        read(path)
    except InputError as refused:
        error = refused
    else:
        return False
    assert len(str(error).splitlines()) == 1
    assert error.rule
    assert error.remedy
    return True


@few_or_many
@pytest.mark.parametrize("name", READERS)
def test_a_spec_is_read_or_refused(bench, name, times):
    path, refused = bench / f"{name}.toml", []
    assert not is_refused(READERS[name], path)

    @many(20 * times, spoiled(FILES[name]))
    def check(spec):
        refused.append(is_refused(READERS[name], write_toml(path, spec)))

    assert sum(refused) > len(refused) / 2


@few_or_many
def test_a_table_is_read_or_refused(bench, times):
    cells = re.split(r"([,\n])", TABLE)
    wrong = words | st.sampled_from(["", ",", "\n", '"', ";", "-1", "1,5", "nan", "1e999", "\0"])
    spoil = st.lists(st.tuples(st.integers(0, len(cells) - 2), wrong), min_size=1, max_size=3)

    @many(100 * times, spoil)
    def check(spoil):
        text = list(cells)
        for place, cell in spoil:
            text[place] = cell
        (bench / "table.csv").write_text("".join(text), encoding="utf-8")
        is_refused(lambda path: read_measured(path, "internal"), bench / "table.csv")


@few_or_many
def test_a_command_line_is_done_or_refused(bench, run, times):
    before, lines = tree(bench), [line.split() for line in LINES.strip().splitlines()]
    place, other = st.integers(0, 20), st.sampled_from([None, *WRONG])

    @many(100 * times, st.tuples(st.sampled_from(lines), place, other))
    def check(case):
        line, place, other = case
        place %= len(line)
        arguments = [*line[:place], *([] if other is None else [other]), *line[place + 1 :]]
        code, _, errors = run(*arguments)
        after = tree(bench)
        if code == 2:
            assert re.fullmatch(r"cylcontact: [^\n]+\n", errors), (arguments, errors)
            assert after == before, arguments
            return
        assert code == 0, (arguments, errors)
        for name in sorted(after.keys() - before.keys(), reverse=True):
            (bench / name).rmdir() if after[name] is None else (bench / name).unlink()
        for name in before:
            if after[name] != before[name]:
                (bench / name).write_bytes(before[name])
