"""Sweeps and the commands: one tidy table, the same whatever the workers, taken up when stopped."""

import numpy as np
import pandas as pd
import pytest

from cylcontact.mechanism import (
    Case,
    Interrupted,
    Plan,
    Trajectory,
    cases,
    long_run,
    simulate,
    sweep,
)
from tests.support.mechanism_cases import CASES, ROOT, slider_crank

SPEC = ROOT / "datasets/slider_crank.toml"
WANTED = cases(["enhanced", "johnson"], [0.02], [1.0], [0.0, 0.1])
BIFURCATION, SWEEP = ((name, SPEC, "-o", "t.csv") for name in ("bifurcation", "sweep"))
PAPER = [Case(*case) for case in CASES]
PLAN = Plan(revolutions=2, first=1)


@pytest.fixture(scope="module")
def table():
    return sweep(slider_crank(), WANTED, PLAN)


def test_every_case_has_its_row(table):
    assert [
        Case(*row) for row in table[["law", "clearance_mm", "restitution", "friction"]].to_numpy()
    ] == WANTED
    statuses = dict(zip(WANTED, table["status"], strict=True))
    # Johnson's law ends where the journal whirls in a dry, elastic bearing.
    assert statuses[Case("johnson", 0.02, 1.0, 0.1)] == "stopped"
    assert {status for case, status in statuses.items() if case.law == "enhanced"} == {"complete"}
    assert "leaves its domain at t = 0.00109" in table["message"].iloc[3]
    assert np.isnan(table["impacts"].iloc[3])


@pytest.mark.slow
def test_the_table_does_not_depend_on_the_workers(table):
    pd.testing.assert_frame_equal(table, sweep(slider_crank(), WANTED, PLAN, workers=2))


def test_a_second_tolerance_gives_the_horizon_and_what_lies_beyond():
    wanted = cases(["johnson"], [0.5], [1.0, 0.9], [0.1])
    plan = Plan(revolutions=3, against=1e-10)
    actual = sweep(slider_crank(), wanted, plan)
    sensitive, steady = actual.iloc[0], actual.iloc[1]
    assert 0 < sensitive["horizon_revolutions"] < 2
    assert sensitive["first"] == np.ceil(sensitive["horizon_revolutions"])
    assert steady["horizon_revolutions"] == 3
    assert steady["first"] == 0
    later = sweep(slider_crank(), wanted, Plan(revolutions=3, first=2, against=1e-10))
    assert list(later["first"]) == [2, 2]
    assert steady["drive_work_J"] == pytest.approx(steady["drive_work_J_against"], rel=1e-5)
    assert sensitive["drive_work_J"] != pytest.approx(sensitive["drive_work_J_against"], rel=1e-5)


def test_an_interrupted_sweep_keeps_its_cases_and_goes_on(table, tmp_path):
    path = tmp_path / "cases.partial"

    def stop(_, done, __):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(slider_crank(), WANTED, PLAN, progress=stop, checkpoint=path)
    assert len(path.read_text().splitlines()) == 3
    with path.open("a") as file:
        file.write('{"case": {"law"')  # cut short by a kill
    calls = []
    again = sweep(
        slider_crank(), WANTED, PLAN, checkpoint=path, resume=True,
        progress=lambda _, done, __: calls.append(done),
    )  # fmt: skip
    assert calls == [2, 3, 4]
    pd.testing.assert_frame_equal(table, again)


# --- the committed tables ---------------------------------------------------------------------


def test_the_committed_cases_are_what_comes_out():
    """One that keeps to its path and one that does not, to its horizon."""
    committed = pd.read_csv(ROOT / "datasets/mechanism/cases.csv")
    varied = committed[["law", "clearance_mm", "restitution", "friction"]]
    committed_cases = [Case(*row) for row in varied.to_numpy()]
    assert committed_cases[:24] == PAPER
    assert {case.law for case in committed_cases[24:]} == {"explicit"}
    assert set(committed["status"]) == {"complete"}
    assert committed["energy_error"].max() < 1e-7
    # No row counts the start.
    assert committed["first"].min() == 3
    steady = [Case("johnson", 0.02, 0.9, 0.1), Case("explicit", 0.5, 0.9, 0.1)]
    actual = sweep(slider_crank(), steady, Plan(revolutions=20, first=3, beyond="tangent"))
    for case, (_, row) in zip(steady, actual.iterrows(), strict=True):
        kept = committed.iloc[committed_cases.index(case)]
        assert (kept["horizon_revolutions"], kept["first"]) == (20, 3)
        for name in ("contact_fraction", "impacts", "drive_work_J", "max_penetration_um"):
            assert row[name] == pytest.approx(kept[name], rel=1e-4)
    parting = committed[committed["horizon_revolutions"] < 20]
    assert (parting["first"] >= parting["horizon_revolutions"]).all()


# --- the commands -----------------------------------------------------------------------------


def test_simulate_says_how_well_its_means_are_known(run, tmp_path):
    table = tmp_path / "table.csv"
    options = ("--friction", 0, "--law", "johnson", "--revolutions", 12, "--table", table)
    code, out, _ = run("simulate", SPEC, *options)
    assert code == 0
    assert "Means over revolutions 3 to 12, the first 2 left out; ± half the 95 % interval" in out
    assert "tolerances of 1e-08 and 1e-09 part after " in out
    assert list(tmp_path.iterdir()) == [table]
    read = pd.read_csv(table, index_col="revolution")
    expected = long_run(slider_crank("johnson", friction=0.0), 12).by_revolution
    assert list(read.columns) == list(expected.columns)
    assert list(read["impacts"]) == list(expected["impacts"])


def test_an_interrupted_simulate_prints_what_is_complete(run, monkeypatch):
    def stop(mechanism, *_, **__):
        raise Interrupted(statistics=long_run(mechanism, 3, 1))

    monkeypatch.setattr("cylcontact.mechanism.long_run", stop)
    code, out, err = run("simulate", SPEC, "--revolutions", 1000)
    assert code == 130
    assert "Means over revolutions 2 to 3" in out
    assert "interrupted; these are the numbers of 3 complete revolutions" in err


@pytest.mark.slow
def test_bifurcation_tabulates_sections(run, tmp_path):
    out = tmp_path / "table.csv"
    options = ("--clearance", "0.4,0.5", "--points", 2, "--revolutions", 33, "--last", 4)
    code, sentence, _ = run(
        "bifurcation", SPEC, "-o", out, *options, "--impact-rate", "0,0.05", "--jobs", 1
    )
    assert code == 0
    assert "4 runs, " in sentence
    table = pd.read_csv(out)
    assert list(table["clearance_mm"].unique()) == [0.4, 0.5]
    assert list(table["revolution"].unique()) == [29, 30, 31, 32]
    assert table["held_m_per_s"].isna().sum() == 8
    alone = table[(table["clearance_mm"] == 0.5) & table["held_m_per_s"].isna()]
    expected = long_run(slider_crank(), 33).section.tail(4)
    for column in ("e_x_um", "e_y_rate_m_per_s"):
        assert alone[column].to_numpy() == pytest.approx(expected[column].to_numpy(), rel=1e-9)
    held = table[table["held_m_per_s"] == 0.05]
    assert (held["impact_rate_m_per_s"] == 0.05).any()
    short = ("--points", 1, "--revolutions", 4, "--last", 2, "--jobs", 1)
    assert run("bifurcation", SPEC, "-o", out, *short)[1].endswith("1 runs, 1 too short to tell\n")


def test_simulate_writes_what_a_later_one_goes_on_from(run, tmp_path):
    out = tmp_path / "run.parquet"
    options = ("--friction", 0, "--tolerance", "1e-7", "-o", out)
    assert run("simulate", SPEC, *options, "--revolutions", 1)[0] == 0
    assert run("simulate", SPEC, *options, "--revolutions", 2, "--resume")[0] == 0
    resumed = Trajectory.load(out)
    whole = simulate(slider_crank(friction=0.0), tolerance=1e-7, revolutions=2)
    assert resumed.revolutions == 2
    assert np.array_equal(resumed.rows.values, whole.rows.values)
    err = run("simulate", SPEC, *options, "--revolutions", 1, "--resume")[2]
    assert f"{out} has 2 revolutions, all of them kept" in err
    code, _, err = run("simulate", SPEC, "-o", out, "--revolutions", 2, "--resume")
    assert code == 2
    assert "is of another mechanism or other options" in err


def test_a_run_that_cannot_go_on_keeps_its_revolutions(run, tmp_path):
    out = tmp_path / "run.parquet"
    options = ("--law", "johnson", "--clearance", 0.028, "--restitution", 1, "--revolutions", 3)
    code, said, err = run("simulate", SPEC, *options, "-o", out, "--resume")
    note, error = err.splitlines()
    assert (code, said) == (2, "")
    assert note == f"cylcontact: there is no {out} yet; the run starts anew"
    assert "leaves its domain at t = 0.02" in error
    assert error.endswith(f"; complete revolutions kept in {out}: 1")
    assert Trajectory.load(out).revolutions == 1
    assert [*tmp_path.iterdir()] == [out]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("simulate", "none.toml"), "none.toml: cannot be read"),
        (("simulate", SPEC, "--clearance", "-1"), "wrist-pin.clearance = -1.0: must be greater"),
        (("simulate", SPEC, "--method", "newton"), "method = 'newton': is not known; choose min"),
        (("simulate", SPEC, "--tolerance", "2"), "tolerance = 2.0: must lie in [1e-14, 1e-3]"),
        (("simulate", SPEC, "--resume"), "--resume: needs a file to go on from"),
        (("simulate", SPEC, "-o", "run.csv"), "run.csv: is neither .parquet nor .gif nor .mp4"),
        (("simulate", SPEC, "--revolutions", 2, "--first", 2), "--first = 2: leaves none of 2"),
        ((*BIFURCATION, "--clearance", "0,1"), "must be two positive numbers"),
        ((*BIFURCATION, "--revolutions", 3, "--last", 3), "last = 3: must be at least 1 and below"),
        ((*BIFURCATION, "--impact-rate", "-1"), "impact_rate = -1.0: must be positive"),
        ((*SWEEP, "--clearance", "0.5;1"), "'0.5;1' is not a number"),
        ((*SWEEP, "--law", "hooke"), "'hooke': is neither a law nor a fit result"),
        ((*SWEEP, "--fit", "20H7/k6"), "--fit = '20H7/k6': is a transition fit"),
        ((*SWEEP, "--fit", "20H7/f7", "--clearance", 1), "conflicts with --clearance"),
        ((*SWEEP, "--fit", "40H7/f7"), "is of another size than the hole of wrist-pin, of 20 mm"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_two(run, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_fit_gives_its_tightest_middle_and_loosest_clearance(run, tmp_path):
    table = tmp_path / "band.csv"
    short = "--law", "explicit", "--beyond", "tangent", "--revolutions", 2, "-j", 1
    assert run("sweep", SPEC, "--fit", "20H7/f7", *short, "-o", table)[0] == 0
    clearances = pd.read_csv(table)["clearance_mm"].to_numpy()
    assert clearances == pytest.approx([0.01, 0.0205, 0.031], rel=1e-12)


def test_sweep_writes_a_table_and_tells_what_stopped(run, tmp_path):
    out, parquet = tmp_path / "table.csv", tmp_path / "table.parquet"
    options = (
        *("--law", "johnson,enhanced", "--clearance", 0.02, "--restitution", 1),
        *("--friction", 0.1, "--revolutions", 1, "--jobs", 1),
    )
    code, sentence, told = run("sweep", SPEC, "-o", out, *options)
    assert code == 1
    assert "2 cases, 1 of them stopped" in sentence
    assert "1 of 2 cases stopped; first: " in told
    assert "leaves its domain" in told
    assert told.count("\n") == 1
    assert list(pd.read_csv(out)["status"]) == ["stopped", "complete"]
    assert list(tmp_path.iterdir()) == [out]
    run("sweep", SPEC, "-o", parquet, *options)
    written = pd.read_parquet(parquet).replace({"": np.nan})
    pd.testing.assert_frame_equal(written, pd.read_csv(out), check_dtype=False)


def test_a_study_of_tolerances_has_a_row_for_each_and_both_forms(run, tmp_path):
    out = tmp_path / "tolerances.csv"
    options = ("--law", "explicit", "--tolerance", "1e-5,1e-7", "--revolutions", 1, "--jobs", 1)
    code, printed, _ = run("tolerances", SPEC, "-o", out, *options)
    table = pd.read_csv(out)
    assert code == 0
    assert list(table["method"]) == [*["minimal"] * 2, *["multiplier"] * 2]
    assert list(table["tolerance"]) == [1e-5, 1e-7] * 2
    assert set(table["cases"]) == {1}
    assert [line.split()[0] for line in printed.splitlines()] == ["method", *table["method"]]
