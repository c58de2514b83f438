"""What a fit refuses, in one line: the file, the key, the value, the rule and the remedy.

What the schemas of campaigns and results say is in tests/cli/test_malformed.py.
"""

import json
import math
from pathlib import Path

import pytest

import cylcontact as cc
from cylcontact import InputError
from cylcontact.fitting import Campaign, fit_table, read_result
from tests.support.measured_files import (
    CONSTANTS,
    USER_LAW,
    campaign_of_table,
    write_measured,
    write_table,
)
from tests.support.noisy_series import PAIR, readings
from tests.support.spec_files import GRID, assert_told, changed, labels, write_bench, write_toml

EXTERNAL = Path(__file__).resolve().parents[2] / "fitting/results/external.json"
TABLE = {"data": "measured.csv", "contact": "internal", "law": "johnson", "constants": CONSTANTS}
INTERNAL = ("a", "b", "Y_log_scale", "Y_log_exponent", "Y_slope", "Y_offset", "n_exponent")
FREE = {"bounds": {}, "fixed": {"K_star": 1.1, "n": 1.1}}
FIXED = {"fixed": {"stiffness_factor": 1.0, "offset": 1.0}}
OWN_LAW = {"law": "mine:load", "bounds": {"K_star": [0.5, 10.0]}}
SIZE, DATASET = "genetic.population", "no such file beside the camp"
AS_ENHANCED = {"law": "enhanced", "bounds": {}}
AS_GRID = "not a parameter of power for internal"

# Changes to a campaign on a grid, or on a table: the key, the value, the rule and the remedy.
ON_GRID = [
    ({"law": "hertz"}, "law", "hertz", "is not a law that can be fitted", "enhanced or"),
    ({"objective": "rms"}, "objective", "rms", "is not a known objective", "rms-log-penetration"),
    *(
        ({SIZE: some}, SIZE, some, "must be", "integer from 4 to 100000")
        for some in (3, 100_001, [60])
    ),
    ({"bounds.n": [1.5, 1]}, "bounds.n", [1.5, 1.0], "below the upper bound", "use [fixed]"),
    ({"bounds.n": [1]}, "bounds.n.1", None, "is required", "[bounds]"),
    ({"bounds.n": ["1", 2]}, "bounds.n.0", "1", "must be a number", "[bounds]"),
    ({"fixed.n": 1.1}, "fixed.n", None, "is also in [bounds]", "keep one of them"),
    ({"ties.n": "K_star"}, "ties.n", None, "is also in [bounds]", "keep one of them"),
    (FREE, "parameters", None, "are all fixed or tied", "free at least one"),
    *(
        (AS_ENHANCED | some, "Y_switch", None, "which no fit may search", "--fix Y_switch=0.34954")
        for some in ({"bounds": {"Y_switch": [0.1, 1.0]}}, {"ties": {"Y_switch": "a"}})
    ),
    ({"bounds.m": [1, 2]}, "bounds.m", None, AS_GRID, "K_star, n"),
    ({"fixed.m": 1}, "fixed.m", None, AS_GRID, "K_star, n"),
    *(({"dataset": d}, "dataset", d, DATASET, "e.g.") for d in ("datasets/none", "datasets", "\0")),
]
ON_TABLE = [
    ({"dataset": "x.toml"}, "data", "measured.csv", "conflicts with dataset", "keep data for"),
    ({"data": "absent.csv"}, "data", "absent.csv", DATASET, "name a .csv"),
    ({"law": "hooke"}, "law", "hooke", "is not a law that can be fitted", "module:function"),
    *(
        ({"law": law, "contact": "external"}, "law", law, "is for internal contact only", "another")
        for law in ("conformal", "liu")
    ),
    ({"objective": "rms-penetration"}, "objective", "rms-penetration", "is not a known key", ""),
    ({"materials": "absent.csv"}, "materials", "absent.csv", "no such file", ""),
    (
        {"law": "enhanced", "free": ["Y_switch"]},
        "Y_switch",
        None,
        "which no fit may search",
        "--fix Y_switch=0.34954",
    ),
    (
        {"bounds": {"K": [0.0, 1.0]}},
        "bounds.K",
        None,
        "is not a parameter of",
        "stiffness_factor, c",
    ),
    (FIXED, "parameters", None, "are all fixed", "free at least one"),
    ({"ignore": ["colour"]}, "ignore", "colour", "is not a column of the table", ""),
    ({"loads": "299:", "free": ["c"]}, "data", "3 rows", "not more than the 3 free", "fix param"),
    (OWN_LAW, "bounds.n", None, "is required: your own law has no", "add n = [low, high]"),
]
CAMPAIGNS = [("grid", *case) for case in ON_GRID] + [("table", *case) for case in ON_TABLE]


@pytest.mark.parametrize(
    ("kind", "changes", "key", "value", "rule", "remedy"),
    CAMPAIGNS,
    ids=labels([case[1:] for case in CAMPAIGNS]),
)
def test_campaigns(tmp_path, kind, changes, key, value, rule, remedy):
    if kind == "grid":
        path = write_bench(tmp_path, changes)
    else:
        write_measured(tmp_path / "measured.csv", "johnson", "internal", noise=0.01)
        (tmp_path / "mine.py").write_text(USER_LAW)
        path = write_toml(tmp_path / "c.toml", changed(TABLE, changes))
    with pytest.raises(InputError) as caught:
        Campaign.read(path)
    assert_told(caught, caught.value.source, key, value, rule, remedy)
    assert caught.value.source.startswith(str(path.parent))


@pytest.mark.parametrize("values", [[0.001, 1.0], [1.0, 10.1]])
def test_clearances_that_the_law_is_not_stated_for(tmp_path, values):
    law = {"law": "enhanced", "bounds": {name: [0.1, 1.0] for name in INTERNAL}}
    path = write_bench(tmp_path, law)
    write_toml(tmp_path / "datasets/small.toml", changed(GRID, {"axes.dR": {"values": values}}))
    with pytest.raises(InputError) as caught:
        Campaign.read(path)
    rule = "ΔR (mm) leave the range of the enhanced law for internal contact, 0.005 to 10 mm"
    assert_told(caught, path, "dataset", values, rule, "narrow the dR axis of the grid")


def test_a_grid_in_the_place_of_a_campaign(tmp_path):
    write_bench(tmp_path)
    path = tmp_path / "datasets/small.toml"
    with pytest.raises(InputError) as caught:
        Campaign.read(path)
    assert_told(caught, path, "", None, "is a grid spec, not a campaign", "name a campaign")


def test_rows_that_no_coefficients_reach(tmp_path):
    columns = {"load_N_per_mm": [1, 2, 1e9], "penetration_um": [0.01, 0.02, 0.5]}
    table = write_table(tmp_path / "t.csv", columns)
    bounds = {"stiffness_factor": [0.9, 1.1], "c": [-1.5, -0.5]}
    given = {"bounds": bounds, "fixed": {"offset": 0.0}}
    constants = {**CONSTANTS, "dR_um": 50}
    with pytest.raises(InputError, match="lies outside the domain of johnson") as caught:
        fit_table(campaign_of_table(table, "johnson", "internal", constants, **given))
    assert caught.value.source == f"{table}, line 4"


REDO = "redo the fit"
COEFFICIENTS = "must be the coefficients of its campaign: a, b, n"
POINTS, NOT_FINITE = (
    {"settings.dataset.axes.E.points": 0},
    {"profiles.a.objective": [0.1, math.nan]},
)
# Changes to a committed result: what follows the file's name, then as above.
RESULTS = [
    (NOT_FINITE, "", "profiles.a.objective.1", math.nan, "a finite number", "a value that fits"),
    *(
        ({"format": old}, "", "format", old, "is not version 3, which this cylcontact reads", REDO)
        for old in (1, 2, 4)
    ),
    ({"kind": "table"}, "", "kind", "table", "must be law or readings", REDO),
    ({"formula": "eq 7"}, "", "formula", "eq 7", "is not the form of the law", REDO),
    ({"runs": []}, "", "runs", [], "must hold at least one run", REDO),
    ({"estimates": {"a": {"value": 0.4}}}, "", "estimates", ["a"], COEFFICIENTS, REDO),
    ({"settings": {}}, "", "settings", None, "lacks the campaign or the dataset", REDO),
    ({"settings.campaign.seed": "1"}, "campaign", "seed", "1", "must be an integer", "the seed"),
    (POINTS, "dataset", "axes.E.points", 0, "must be at least 2", "values = [...]"),
]


@pytest.mark.parametrize(
    ("changes", "part", "key", "value", "rule", "remedy"), RESULTS, ids=labels(RESULTS)
)
def test_results(tmp_path, changes, part, key, value, rule, remedy):
    path = tmp_path / "r.json"
    path.write_text(json.dumps(changed(json.loads(EXTERNAL.read_text("utf-8")), changes)))
    with pytest.raises(InputError) as caught:
        read_result(path)
    source = f"{path}, settings.{part}" if part else path
    assert_told(caught, source, key, value, rule, remedy)


GROUP = {"group": "group"}
GIVEN, BOTH = {"penetration_std_um": 0.05}, {"penetration_std_um": 0.05, "load_std_N_per_mm": 1.0}
# Columns beside the readings, settings that contradict them or each other, the key and the rule.
CONFLICTS = [
    (GIVEN, {"noise": "constant"}, "noise", "conflicts with the column penetration_std"),
    (GIVEN, {"noise": "both"}, "noise", "conflicts with the column penetration_std"),
    (BOTH, {"noise": "constant"}, "noise", "conflicts with the column penetration_std"),
    ({}, {"noise": "white"}, "noise", "is not a known noise"),
    ({}, {"free": ["c"], "fixed": {"c": 1.4}}, "free", "is bounded, fixed or tied as well"),
    ({}, {"free": ["n"]}, "free", "is not a parameter of explicit for internal contact"),
    ({}, {"group": "date"}, "group", ""),
    ({}, GROUP | {"drift": True, "noise": "constant"}, "group", "effects of the series"),
    ({}, {"branch": "unloading"}, "branch", "has no rows of unloading"),
]


@pytest.mark.parametrize(("columns", "settings", "key", "rule"), CONFLICTS)
def test_settings(columns, settings, key, rule):
    kept = {} if "group" in settings else {"ignore": ["group"]}
    rows = readings(0, 4, 3) if "branch" not in settings else readings(0, 1, 12)
    with pytest.raises(InputError) as caught:
        cc.fit(rows.assign(**columns), "explicit", PAIR, **settings, **kept)
    assert_told(caught, caught.value.source, key, caught.value.value, rule, "")


EXAMPLE = Path(__file__).resolve().parents[2] / "fitting/examples/pin-in-hole.toml"
INSIDE = ("--law", "johnson", "--contact", "internal")
PEEK = ("--pin", "PEEK", "--hole", "bronze")
# What follows `cylcontact fit TABLE`, and the error.
COMMANDS = [
    (
        ("--contact", "internal"),
        "lacks the law and the materials; add your own, e.g. --law explicit --material",
    ),
    ((*INSIDE, "--bound", "c=1"), "'--bound': 'c=1' is not valid"),
    ((*INSIDE, "--fix", "c=1", "--bound", "c=1:2"), "c is given twice"),
    ((*INSIDE, *PEEK, "--material-j", "PTFE"), "--pin: says the same as --material-j; keep one"),
    (
        ("--law", "johnson", "--contact", "external", *PEEK),
        "--contact = 'external': has no pin and no hole; leave out --pin; rollers have",
    ),
]


@pytest.mark.parametrize(("arguments", "message"), COMMANDS)
def test_commands(tmp_path, run, arguments, message):
    table = write_measured(tmp_path / "measured.csv", "johnson", "internal")
    code, said, errors = run("fit", table, *arguments, "-o", tmp_path / "r.json")
    assert (code, said, len(errors.splitlines())) == (2, "", 1)
    assert message in errors
    assert [path.name for path in tmp_path.iterdir()] == ["measured.csv"]


@pytest.mark.parametrize(("option", "value"), [("--law", "power"), ("--pin", "PEEK"), ("--Ri", 1)])
def test_options_for_tables_beside_a_campaign(run, option, value):
    code, _, errors = run("fit", EXAMPLE, option, value)
    assert code == 2
    assert f"toml: {option}: is an option for tables of measurements" in errors
