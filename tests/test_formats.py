"""Files of every format that was ever written open today, and today's writers keep their formats.

tests/formats holds an example of each kind and version, as KIND-VERSION, of each plain table in
`tables`, and in `specs` what users write: every spec that was shipped with 0.1.0. They are never
changed. Where a file is missing, WRITE_FORMATS=1 stores what is written today.
"""

import ast
import csv
import json
import os
import re
import shutil
from functools import partial
from pathlib import Path

import pytest
from _cylcontact_bench.fig_bifurcation import draw as draw_bifurcation
from _cylcontact_bench.fig_readings import readings
from _cylcontact_bench.slider_crank import horizons

from benchmarks.page import load, save
from cylcontact import InputError
from cylcontact.datasets import read_grid
from cylcontact.datasets.finite_element import read_study, read_table, run_study
from cylcontact.fitting import FitResult, calibrate, read_campaign
from cylcontact.formats import FORMATS, upgraded
from cylcontact.journal import Journal
from cylcontact.materials import read_materials
from cylcontact.mechanism import Plan, Trajectory, cases, read_joint, read_mechanism, sweep
from cylcontact.plots.style import choose
from cylcontact.reports.bench import Bench
from cylcontact.reports.fit_figures import runs_table
from cylcontact.spec import read_toml
from tests.counts import counted
from tests.programs import require_package
from tests.spec_files import ELEMENTS, GRID, assert_told, changed, tree, write_bench, write_toml

ROOT = Path(__file__).resolve().parents[1]
STORED = ROOT / "tests/formats"
SPECS = STORED / "specs"
SPEC_FILES = sorted(path.relative_to(SPECS).as_posix() for path in SPECS.rglob("*.toml"))
TABLES = ROOT / "datasets"
CASE = ("--law", "explicit", "--clearance", 0.5, "--restitution", 0.9, "--friction", 0.1)
COARSE = ("--tolerance", 1e-3, "--revolutions", 1)
ONE_CASE = (*CASE, "--against", 1e-4, *COARSE)
CLAIM = '''
from cylcontact.reports.claims import Finding, claim

@claim("1-a", "the laws agree to 10 %", paper="< 10 %", rule="below 10 % at every load")
def trial() -> Finding:
    """Return the largest difference in percent."""
    return Finding("12.5 %", holds=False, choice="1 to 100 N/mm", values={"percent": 12.5})
'''


def kind_of(name):
    """Return the kind of a stored file."""
    return re.split(r"-\d", name)[0]


def number_of(kind, path):
    """Read a file as the program does, and return one number of it."""
    return {
        "fit-result": lambda: FitResult.read(path).objective.value,
        "trajectory": lambda: Trajectory.load(path).statistics().mean["max_force_N"],
        "finite-elements": lambda: read_table(path).rows["penetration_mm"].iloc[0],
        "benchmarks": lambda: load(path)["rows"][0].value,
    }[kind]()


# Each stored file that opens, with a number that it said when it was written.
OPENS = {
    "fit-result-0-before-searched.json": 0.9546326270326118,
    "fit-result-0-measured-before-searched.json": 0.038624252564762214,
    "fit-result-0.json": 0.9546326270326118,
    "fit-result-0-measured.json": 0.03862425256147237,
    "fit-result-1.json": 0.9546326270326118,
    "fit-result-1-measured.json": 0.03862425256147237,
    "trajectory-1.parquet": 53190.88164845541,
    "finite-elements-0.csv": 0.0004004685,
    "finite-elements-1.csv": 0.0004004685,
    "benchmarks-0.json": 13.879901450928774,
    "benchmarks-1.json": 13.879901450928774,
}
# What only other programs read, and journals, with the parts of those.
WRITTEN = ("law-1.json", "claims-1.json", "uncertainty-1-noise.json", "uncertainty-1-law.json")
PARTS = {"campaign": 3, "sweep": 1, "study": 4}

# The command that writes each file of today's format, in a bench of its own.
COMMANDS = {
    "fit-result-1.json": ("fit", "fitting/small.toml"),
    "fit-result-1-measured.json": ("fit", SPECS / "fitting/examples/pin-in-hole.toml"),
    "trajectory-1.parquet": ("simulate", "slider_crank.toml", *CASE, *COARSE),
    "finite-elements-1.csv": ("finite-element", "elements.toml", "-j", 1),
    "law-1.json": ("export", "liu", "--contact", "internal", "--to", "json"),
    "claims-1.json": ("claims",),
    "uncertainty-1-noise.json": (
        *("fit", STORED / "fit-result-1-measured.json", "-j", 1),
        *("--leave-out", "dR", "--bootstrap", 2, "--pairs"),
    ),
    "uncertainty-1-law.json": (
        *("fit", STORED / "fit-result-1.json", "-j", 1),
        *("--leave-out", "dR", "--pairs"),
    ),
    "tables/claims.csv": ("claims",),
    "tables/samples.csv": ("sample", "datasets/small.toml"),
    "tables/samples.parquet": ("sample", "datasets/small.toml"),
    "tables/samples-of-any-pair.csv": ("sample", "datasets/any.toml"),
    "tables/optimizers.csv": (
        *("fit", "fitting/small.toml", "--optimizer", "genetic,differential-evolution", "-j", 1),
    ),
    "tables/cases.csv": ("simulate", "slider_crank.toml", "--study", "cases", *ONE_CASE),
    "tables/tolerances.csv": ("simulate", "slider_crank.toml", "--study", "tolerances", *COARSE),
    "tables/bifurcation.csv": (
        *("simulate", "slider_crank.toml", "--study", "bifurcation", "--law", "explicit"),
        *("--clearance", "0.4,0.5", "--points", 2, "--last", 1, "--revolutions", 2),
    ),
}
# Tables that the bench's own scripts write, which take long.
COMMITTED = {
    "tables/readings.csv": TABLES / "readings.csv",
    "tables/coverage.csv": TABLES / "coverage.csv",
}


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A small bench, in which the commands are run."""
    write_bench(tmp_path)
    span = {"min": 0.1, "max": 10.0, "points": 3, "spacing": "log"}
    axes = {"alpha": {"values": [0.1, 0.5]}, "beta": {"values": [0.1, 0.2]}, "phi": span}
    any_pair = changed(GRID, {"reference": "conformal", "axes": axes})
    write_toml(tmp_path / "datasets/any.toml", any_pair)
    write_toml(tmp_path / "elements.toml", ELEMENTS)
    shutil.copy(SPECS / "datasets/slider_crank.toml", tmp_path)
    (tmp_path / "reports/claims").mkdir(parents=True)
    (tmp_path / "reports/claims/trial.py").write_text(CLAIM, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


# --- the form of a file -----------------------------------------------------------------------


def form_of(path):
    """Return what a file's format fixes: its keys with the types of their values, its columns."""
    if path.suffix == ".json":
        return keys(json.loads(path.read_text(encoding="utf-8")))
    if path.suffix == ".partial":
        header, first, *_ = path.read_text(encoding="utf-8").splitlines()
        return keys({"header": json.loads(header), "part": json.loads(first)})
    if path.suffix == ".parquet":
        schema = require_package("pyarrow.parquet").read_schema(path)
        metadata = schema.metadata or {}
        about = json.loads(metadata.get(b"cylcontact.trajectory", b"null"))
        return keys(about) | {field.name: {str(field.type)} for field in schema}
    lines = path.read_text(encoding="utf-8").splitlines()
    head = [line.partition(":")[0] for line in lines if line.startswith("# ")]
    return head + next(csv.reader([lines[len(head)]]))


def keys(value, path=""):
    """Return the types of all values below a value of JSON, by the path of their keys."""
    found = {}
    if isinstance(value, dict | list):
        items = value.items() if isinstance(value, dict) else (("[]", each) for each in value)
        for key, each in items:
            for place, types in keys(each, f"{path}.{key}").items():
                found[place] = found.get(place, set()) | types
        return found or {path: {type(value).__name__}}
    # Whether a number is whole or null may differ by a rounding error.
    name = {"int": "number", "float": "number", "NoneType": ""}.get(type(value).__name__)
    return {path: {type(value).__name__ if name is None else name} - {""}}


def difference(stored, now):
    """Return what differs between two forms, as text."""
    if isinstance(stored, list):
        return "" if stored == now else f"columns {stored} are now {now}"
    lost, new = sorted(stored.keys() - now.keys()), sorted(now.keys() - stored.keys())
    other = [key for key in stored.keys() & now.keys() if stored[key] and now[key]]
    other = sorted(key for key in other if stored[key] != now[key])
    parts = (("lost", lost), ("new", new), ("of another type", other))
    return "; ".join(f"{word}: {names}" for word, names in parts if names)


def assert_same_form(name, written):
    """Hold what is written today against the stored file; store it if there is none."""
    stored = STORED / name
    if not stored.exists() and os.environ.get("WRITE_FORMATS"):
        stored.parent.mkdir(exist_ok=True)
        shutil.copy(written, stored)
    assert stored.exists(), f"store an example of this format: WRITE_FORMATS=1 pytest {__file__}"
    found = difference(form_of(stored), form_of(written))
    remedy = (
        "keep tests/formats as it is. For a table, give a column of another meaning another name, "
        "and store the table under a new name here. For any other file, raise its version in "
        "cylcontact/formats.py, add to _UPGRADES there what makes an older file like a new one, "
        "and add the new version to this test"
    )
    assert not found, f"{name} is written in another form now ({found}): {remedy}"


# --- older files open -------------------------------------------------------------------------


@pytest.mark.parametrize("name", OPENS)
def test_a_stored_file_opens_and_says_what_it_said(name):
    assert number_of(kind_of(name), STORED / name) == pytest.approx(OPENS[name], rel=1e-9)


@pytest.mark.parametrize("name", [name for name in OPENS if name.startswith("fit-result")])
def test_a_stored_result_gives_its_law_its_report_and_its_runs(name):
    result = FitResult.read(STORED / name)
    said = json.loads((STORED / name).read_text(encoding="utf-8"))
    assert result.coefficients == said["coefficients"]
    assert str(result).startswith(f"{said['name']}: ")
    assert result.to_law().name == said["law"]
    searched = runs_table(result).filter(like="_searched") if result.kind != "noise" else None
    if searched is not None:
        assert searched.isna().all(axis=None) == ("before-searched" in name)


def test_a_stored_result_saved_again_is_of_todays_format(tmp_path):
    path = tmp_path / "again.json"
    FitResult.read(STORED / "fit-result-0-before-searched.json").save(path)
    again = json.loads(path.read_text(encoding="utf-8"))
    assert next(iter(again)) == "format"
    assert again["format"] == FORMATS["fit result"]
    assert {run["coefficients_before_polish"] for run in again["runs"]} == {None}
    assert FitResult.read(path).coefficients == again["coefficients"]


def test_a_trajectory_with_a_table_of_its_clearance_is_refused():
    require_package("pyarrow")
    path = STORED / "trajectory-0.parquet"
    with pytest.raises(InputError) as caught:
        Trajectory.load(path)
    rule = "is of a version of cylcontact with one clearance"
    assert_told(caught, path, "", None, rule, "simulate anew")


@pytest.mark.parametrize("kind", PARTS)
def test_a_stored_journal_gives_its_parts(kind, tmp_path):
    stored = STORED / f"{kind}-1.partial"
    key = json.loads(stored.read_text(encoding="utf-8").splitlines()[0])[kind]
    path = shutil.copy(stored, tmp_path)
    assert len(Journal(Path(path), kind, key).load(dict)) == PARTS[kind]


@pytest.mark.parametrize("kind", PARTS)
def test_a_journal_from_before_versions_is_refused_and_kept(kind, tmp_path):
    path = Path(shutil.copy(STORED / f"{kind}-0.partial", tmp_path))
    key = json.loads(path.read_text(encoding="utf-8").splitlines()[0])[kind]
    before = tree(tmp_path)
    with pytest.raises(InputError) as caught:
        Journal(path, kind, key).load(dict)
    remedy = "finish the work with that version, or run without --resume"
    assert_told(caught, path, "format", None, "is that of another version", remedy)
    assert tree(tmp_path) == before


# --- newer files are told ---------------------------------------------------------------------


def newer(name, folder, version=9):
    """Return a copy of a stored file that says another version."""
    path = Path(shutil.copy(STORED / name, folder))
    if path.suffix == ".parquet":
        pq = require_package("pyarrow.parquet")
        table = pq.read_table(path)
        about = json.loads(table.schema.metadata[b"cylcontact.trajectory"]) | {"format": version}
        table = table.replace_schema_metadata({b"cylcontact.trajectory": json.dumps(about)})
        pq.write_table(table, path)
    else:
        text, mark = path.read_text(encoding="utf-8"), "format: 1" if ".csv" in name else '": 1'
        assert mark in text
        new = mark.replace("1", str(version) if ".csv" in name else json.dumps(version))
        path.write_text(text.replace(mark, new, 1), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", [name for name in OPENS if "-1" in name])
def test_a_newer_file_is_told_in_a_line(name, tmp_path):
    path = newer(name, tmp_path)
    with pytest.raises(InputError) as caught:
        number_of(kind_of(name), path)
    rule = "is newer than this version of cylcontact reads (1)"
    remedy = "upgrade cylcontact: pip install -U cylcontact"
    assert_told(caught, path, "format", 9, rule, remedy)


@pytest.mark.parametrize("version", [-1, 1.0, True, "1", None, [1]])
def test_a_version_that_is_no_whole_number_is_told(version):
    with pytest.raises(InputError) as caught:
        upgraded("law", {"format": version}, "law.json")
    assert_told(caught, "law.json", "format", version, "must be a whole number", "make it anew")


@pytest.mark.parametrize("version", ["x", "1.0", "-1", "9" * 5000])
def test_a_table_whose_version_is_no_whole_number_is_told(version, tmp_path):
    path = newer("finite-elements-1.csv", tmp_path, version)
    with pytest.raises(InputError, match="must be a whole number") as caught:
        read_table(path)
    assert len(str(caught.value)) < 400


def test_commands_tell_a_newer_result(run, bench):
    path = newer("fit-result-1.json", bench)
    for command in (("compare", path), ("export", path, "--to", "c"), ("fit", path)):
        code, _, err = run(*command)
        assert code == 2
        assert err.endswith(
            f"{path}: format = 9: is newer than this version of cylcontact reads (1); "
            "upgrade cylcontact: pip install -U cylcontact\n"
        )


@pytest.mark.parametrize(
    ("name", "read", "column"),
    [
        ("readings.csv", readings, "contact"),
        ("mechanism/bifurcation.csv", draw_bifurcation, "clearance_mm"),
        ("mechanism/cases.csv", partial(horizons, clearance=0.5), "clearance_mm"),
    ],
)
def test_a_table_that_lacks_a_column_is_told(name, read, column, tmp_path):
    path = tmp_path / "datasets" / name
    path.parent.mkdir(parents=True)
    path.write_text("load_kN\n1.0\n", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read(Bench(tmp_path))
    assert_told(caught, path, column, None, "is a column that it lacks", "make ")
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError) as caught:
        read(Bench(tmp_path))
    assert_told(caught, path, "", None, "cannot be read", "make ")


# --- today's files keep their form ------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_a_file_is_written_in_its_stored_form(name, run, bench):
    written = bench / Path(name).name
    code, _, err = run(*COMMANDS[name], "-o", written)
    assert code == 0, err
    assert_same_form(name, written)


@pytest.mark.slow
def test_the_tables_beside_a_run_and_a_fit_keep_their_columns(run, bench):
    assert (
        run("simulate", "slider_crank.toml", *CASE, *COARSE, "--table", "revolutions.csv")[0] == 0
    )
    assert_same_form("tables/revolutions.csv", bench / "revolutions.csv")
    table = SPECS / "datasets/examples/pin-in-hole.csv"
    assert run("fit", table, "--law", "explicit", "--contact", "internal", "-o", "fit")[0] == 0
    assert_same_form("tables/residuals.csv", bench / "fit/residuals.csv")
    assert FitResult.read(bench / "fit/result.json").law == "explicit"
    laws = ("--law", "explicit", "--law", "johnson")
    assert run("choose", table, "--contact", "internal", *laws, "-o", "choice")[0] == 0
    assert_same_form("tables/choice.csv", bench / "choice/choice.csv")


@pytest.mark.parametrize("name", COMMITTED)
def test_a_committed_table_has_its_stored_columns(name):
    assert_same_form(name, COMMITTED[name])


@pytest.mark.parametrize("name", ["cases", "tolerances", "bifurcation"])
def test_committed_tables_have_the_columns_of_their_commands(name):
    assert_same_form(f"tables/{name}.csv", TABLES / f"mechanism/{name}.csv")


def test_journals_are_written_in_their_stored_form(bench):
    path = bench / "all.partial"
    calibrate(read_campaign("fitting/small.toml"), checkpoint=path)
    assert_same_form("campaign-1.partial", path)
    mechanism = read_mechanism("slider_crank.toml")
    wanted = cases(["explicit"], [0.5], [0.9], [0.1])
    sweep(mechanism, wanted, Plan(1, tolerance=1e-3), checkpoint=path)
    assert_same_form("sweep-1.partial", path)
    run_study(read_study("elements.toml"), checkpoint=path)
    assert_same_form("study-1.partial", path)


def test_benchmarks_are_written_in_their_stored_form(tmp_path):
    results = load(STORED / "benchmarks-0.json")
    save(tmp_path / "benchmarks.json", results)
    assert_same_form("benchmarks-1.json", tmp_path / "benchmarks.json")


def test_a_changed_form_fails_with_what_to_do(tmp_path):
    path = tmp_path / "fit-result-1.json"
    data = json.loads((STORED / "fit-result-1.json").read_text(encoding="utf-8"))
    data["runs"][0]["colour"] = data.pop("bound")
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(AssertionError, match=r"lost: \['.bound'\]; new: \['.runs.\[\].colour'\]"):
        assert_same_form("fit-result-1.json", path)
    path = tmp_path / "cases.csv"
    path.write_text("law,clearance_um\n", encoding="utf-8")
    with pytest.raises(AssertionError, match="give a column of another meaning another name"):
        assert_same_form("tables/cases.csv", path)


# --- what users write -------------------------------------------------------------------------


def read_any(path):
    """Read a spec as its command does; return what was read as plain data."""
    data = read_toml(path)
    if path.name == "style.toml":
        return choose(path).style
    if path.parts[-2] == "fitting" or "fitting" in path.parts[-3:]:
        return read_campaign(path).settings["campaign"]
    if "bodies" in data:
        return read_mechanism(path).data
    if "bearing" in data:
        return read_joint(path)
    return read_study(path) if "hole_radius" in data else read_grid(path)


@pytest.mark.parametrize("name", SPEC_FILES)
def test_a_spec_once_shipped_is_accepted(name, monkeypatch):
    monkeypatch.chdir(SPECS)
    read = read_any(SPECS / name)
    if isinstance(read, dict):  # what it says is what is run
        said = keys(read_toml(SPECS / name))
        assert not [key for key in said if key not in keys(read)]


def test_a_table_of_materials_once_shipped_is_accepted():
    rows = read_materials(SPECS / "datasets/materials.csv")
    assert len(rows) == len((SPECS / "datasets/materials.csv").read_text("utf-8").splitlines()) - 1


# --- all of them ------------------------------------------------------------------------------


def test_every_stored_file_is_tried_and_every_format_is_stored():
    stored = {path.relative_to(STORED).as_posix() for path in STORED.rglob("*") if path.is_file()}
    journals = {f"{kind}-{version}.partial" for kind in PARTS for version in (0, 1)}
    beside = {"tables/revolutions.csv", "tables/residuals.csv", "tables/choice.csv"}
    specs = {f"specs/{name}" for name in SPEC_FILES}
    needed = {
        "specs/datasets/materials.csv",
        "specs/datasets/examples/pin-in-hole.csv",
        "specs/datasets/finite_element/recommended-embedded.csv",
    }
    refused = {"trajectory-0.parquet"}
    tried = {*OPENS, *WRITTEN, *COMMANDS, *COMMITTED}
    assert stored == tried | journals | beside | specs | needed | refused
    today = {kind_of(name) for name in {*OPENS, *WRITTEN} if "-1" in name}
    assert len(FORMATS) == len(today | {"journal"})
    counted("stored files of every format", len(stored))


def test_no_file_is_written_or_read_as_a_pickle():
    """A file would be bound to a version of the code."""
    files = set((ROOT / "src").rglob("*.py"))
    assert len(files) > 100
    for path in files:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                called = ast.unparse(node.func)
                assert not re.search(
                    r"(pickle|dill|joblib|shelve|marshal)\.(dump|load|open)$", called
                )
                assert not re.search(r"(to|read)_pickle$", called), path
                assert "allow_pickle" not in {each.arg for each in node.keywords}, path
