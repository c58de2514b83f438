"""Fits to measurements: every law gives its own coefficients back, and every way to go wrong."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import typer

import cylcontact as cc
from cylcontact import CylinderPair, InputError, laws
from cylcontact.fitting import Campaign, DataFit, compare, fit_table, read_result
from cylcontact.fitting.adapters import RigCompliance, ScaledLaw
from cylcontact.fitting.comparison import verify
from cylcontact.fitting.law_models import MODELS
from tests.support.measured_files import (
    CONSTANTS,
    TRUTHS,
    USER_LAW,
    campaign_of_table,
    measured_campaign,
    user_campaign,
    whole_truth,
    write_measured,
    write_table,
)
from tests.support.noisy_series import PAIR

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "fitting/examples/pin-in-hole.toml"


# --- recovery ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("law", "contact"), TRUTHS, ids=lambda word: word)
def test_exact_points_of_a_law_give_its_coefficients_back(tmp_path, law, contact):
    result = fit_table(measured_campaign(tmp_path, law, contact, starts=2))
    truth = whole_truth(law, contact, result.coefficients)
    assert result.coefficients == pytest.approx(truth, rel=1e-6)
    free = {p.name for p in MODELS[law, contact].parameters if p.value is None}
    assert result.free.keys() == free
    assert result.residuals["residual_mm"].abs().max() < 1e-9
    assert "no noise to estimate" in result.notes[0]


def test_a_parameter_is_held_or_bounded_as_the_campaign_says(tmp_path):
    given = {"fixed": {"stiffness_factor": 1.1}, "bounds": {"c": [-2.0, -0.9]}}
    result = fit_table(measured_campaign(tmp_path, starts=3, **given))
    assert result.coefficients["stiffness_factor"] == 1.1
    assert result.coefficients["c"] == pytest.approx(-0.9)
    assert result.free.keys() == {"c"}


def test_smaller_deviations_count_like_repeated_rows(tmp_path):
    table = write_measured(tmp_path / "measured.csv", "johnson", "internal", noise=0.02)
    once = pd.read_csv(table).assign(penetration_std_um=0.1)
    repeated = pd.concat([once, once[:5]])
    once.loc[:4, "penetration_std_um"] = 0.1 / np.sqrt(2)
    given = {"contact": "internal", "constants": CONSTANTS, "starts": 2}
    twice, fitted = (cc.fit(data, "johnson", **given) for data in (repeated, once))
    assert fitted.coefficients == pytest.approx(twice.coefficients, rel=1e-6)
    (duplicates,) = [note for note in twice.notes if "identical rows" in note]
    assert duplicates.count("=") == 5


# --- what is free if nothing is said ----------------------------------------------------------


@pytest.mark.parametrize(("law", "contact"), TRUTHS, ids=lambda word: word)
def test_stiffness_and_offset_are_free_and_the_shape_is_held(tmp_path, law, contact):
    table = write_measured(tmp_path / "measured.csv", law, contact)
    campaign = campaign_of_table(table, law, contact, CONSTANTS)
    free = {p.name for p in campaign.parameters if p.is_free}
    own = MODELS[law, contact].parameters
    if law.startswith("power"):
        assert free == {p.name for p in own if p.value is None}
        return
    assert free == {"stiffness_factor", "offset"}
    held = {p.name: p.value for p in campaign.parameters if not p.is_free}
    assert held == {p.name: p.nominal for p in own if p.name not in free}


# --- a law of the user's own ------------------------------------------------------------------


def test_a_function_of_ones_own_is_fitted_like_a_law(tmp_path):
    result = fit_table(user_campaign(tmp_path))
    truth = {**TRUTHS["power", "internal"], "offset": 0.0}
    assert result.coefficients == pytest.approx(truth, rel=1e-6)


def test_nothing_is_imported_because_a_result_names_it(tmp_path):
    result = fit_table(user_campaign(tmp_path))
    path = tmp_path / "r.json"
    result.save(path)
    marker = tmp_path / "ran"
    (tmp_path / "mine.py").write_text(f"open({str(marker)!r}, 'w')\n{USER_LAW}")
    again = read_result(path)
    assert "mine:load" in compare([again])
    with pytest.raises(InputError, match="never run from a stored result"):
        verify(path, 1, lambda *_: None)
    assert not marker.exists()


# --- what the result holds --------------------------------------------------------------------


def test_the_shipped_example_finds_the_law_it_was_made_of():
    example = fit_table(Campaign.read(EXAMPLE))
    assert isinstance(example, DataFit)
    for name, truth in (("stiffness_factor", 1.0), ("c", -1.0)):
        assert example.estimates[name].low < truth < example.estimates[name].high
    assert any(note.endswith("counted: lines 16 = 17") for note in example.notes)
    assert example.outliers == [38]
    rows = example.residuals.set_index("line")
    # The reading is off upwards; 1.4826 times the median is the deviation of normal noise.
    assert rows["penetration_mm"][38] > rows["fitted_mm"][38]
    robust = 1.4826 * rows["standardised"].abs().median()
    (warning,) = [sentence for sentence in example.warnings if "outliers" in sentence]
    assert f"lines 38 ({rows['standardised'][38] / robust:+.1f})" in warning
    without = float(warning.split("stiffness_factor")[1].split("→")[1].split(",")[0])
    assert without == pytest.approx(1.0, rel=0.03)
    assert "<table>" in example._repr_html_()


def test_the_bounds_that_a_function_states_are_those_of_its_fit(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, bounds in (("good", "(0.1, 0.4)"), ("bad", "(0.4, 0.1)")):
        Path(f"{name}_bounds.py").write_text(
            f"def load(penetration, E_star, K: {bounds}):\n    return K * E_star * penetration\n"
        )
    depth = np.geomspace(1e-4, 1e-2, 9)
    data = pd.DataFrame({"load_N_per_mm": 0.5 * PAIR.E_star * depth, "penetration_um": 1e3 * depth})
    assert cc.fit(data, "good_bounds:load", PAIR).coefficients["K"] == pytest.approx(0.4)
    with pytest.raises(
        InputError, match=r"bounds of K = \(0.4, 0.1\): must be two numbers, the lo"
    ):
        cc.fit(data, "bad_bounds:load", PAIR)


def test_readings_that_are_all_equal_are_fitted_and_not_described():
    data = pd.DataFrame({"load_N_per_mm": np.geomspace(10.0, 1000.0, 15), "penetration_um": 1.0})
    result = cc.fit(data, "johnson", PAIR, starts=1, fixed={"offset": 0.0})
    assert result.r_squared is None
    assert "the law does not describe these readings" in result.warnings[0]


def test_conformal_contact_is_fitted_to_rows_of_several_moduli_and_clearances():
    rng = np.random.default_rng(1)
    f, dR = np.geomspace(20, 2000, 40), rng.choice([0.02, 0.05, 0.1], 40)
    E = rng.choice([70.0, 110.0], 40)
    body = cc.Material("body", 1e3 * E, 0.33)
    pairs = CylinderPair("internal", dR, body, body, 10.0, 10.0 - dR)
    depth = 1e3 * laws.Conformal().penetration(f / 1.2, pairs)
    depth *= 1 + 0.003 * rng.standard_normal(40)
    rows = {"load_N_per_mm": f, "penetration_um": depth, "dR_mm": dR, "E_GPa": E}
    constants = {"nu": 0.33, "R_i_mm": 10.0}
    result = cc.fit(
        pd.DataFrame(rows), "conformal", contact="internal", constants=constants, starts=1
    )
    assert result.coefficients["stiffness_factor"] == pytest.approx(1.2, rel=2e-3)


# --- the command line -------------------------------------------------------------------------


JOHNSON = ("--law", "johnson", "--contact", "internal")


@pytest.mark.parametrize("given", [(), ("-o", "elsewhere/fit", "--pdf", "--show")])
def test_a_fitted_table_has_a_folder_of_its_own(tmp_path, run, monkeypatch, given):
    monkeypatch.chdir(tmp_path)
    opened = []
    monkeypatch.setattr(typer, "launch", opened.append)
    table = write_measured(tmp_path / "mine.csv", "johnson", "internal", noise=0.01)
    options = ("--E", "207 GPa", "--nu", 0.3, "--Ri", 10, "--bound", "c=-2:0", "--fix", "offset=0")
    command = ("fit", table, *JOHNSON, *options, "--runs", 2, "--seed", 3, "-j", 1)
    code, said, errors = run(*command, *given)
    assert (code, errors) == (0, "")
    folder = tmp_path / (given[1] if "-o" in given else "results/mine")
    files = ["result.json", "residuals.csv", "fit.png", *["fit.pdf"] * ("--pdf" in given)]
    assert said.rstrip().endswith(f": {', '.join(files)}")
    assert {path.name for path in folder.iterdir()} == {*files}
    assert [*map(Path, opened)] == [folder.relative_to(tmp_path) / "fit.png"] * ("--show" in given)
    result = read_result(folder / "result.json")
    assert result.free.keys() == {"stiffness_factor", "c"}
    settings = result.settings["campaign"]
    assert (settings["seed"], settings["bounds"]["c"][0], len(result.runs)) == (3, -2, 2)
    rows = pd.read_csv(folder / "residuals.csv", comment="#")
    assert rows["line"].tolist() == list(range(2, 38))
    assert rows["residual_mm"].to_numpy() == pytest.approx(result.residuals["residual_mm"])


def test_coefficients_alone_are_a_table_of_csv_or_latex(tmp_path, run):
    table = write_measured(tmp_path / "mine.csv", "johnson", "internal", noise=0.01)
    command = ("fit", table, *JOHNSON, "--E", "207 GPa", "--nu", 0.3, "--Ri", 10, "--runs", 2)
    code, said, _ = run(*command, "-o", tmp_path / "one.csv")
    rows = pd.read_csv(tmp_path / "one.csv", index_col="coefficient")
    assert code == 0
    assert f"{rows.loc['stiffness_factor', 'value']:.5g}" in said
    assert run(*command, "-o", tmp_path / "one.tex")[0] == 0
    assert r"stiffness\_factor & " in (tmp_path / "one.tex").read_text(encoding="utf-8")
    before = table.read_bytes()
    for given, refused in (
        (("-o", table), "cannot be written (it is an input); choose another file"),
        (("--pdf", "-o", "one.json"), "--pdf: is for a fit to tables that has a folder"),
        (("--show", "-o", "one.json"), "--show: is for a fit to tables that has a folder"),
    ):
        code, _, errors = run(*command, *given)
        assert (code, refused in errors) == (2, True), errors
    assert table.read_bytes() == before


# --- the rig ----------------------------------------------------------------------------------


def test_a_rig_that_is_off_and_gives_way_is_found_with_the_law(tmp_path):
    data = pd.read_csv(write_measured(tmp_path / "exact.csv", "persson", "internal"))
    data["penetration_um"] += 1e3 * (2e-3 + 1.5e-6 * data["load_N_per_mm"])
    rig = {"offset": [-0.01, 0.01], "compliance": [0.0, 1e-4]}
    given = {"bounds": rig, "noise": "constant", "starts": 2}
    result = cc.fit(data, "persson", contact="internal", constants=CONSTANTS, **given)
    truth = {**TRUTHS["persson", "internal"], "offset": 2e-3, "compliance": 1.5e-6}
    assert result.coefficients == pytest.approx(truth, rel=1e-6)
    result.save(tmp_path / "r.json")
    assert read_result(tmp_path / "r.json") == result
    assert all(check.holds for check in verify(tmp_path / "r.json", 1, lambda *_: None))


@pytest.mark.parametrize("compliance", [0.0, 3e-6, -2e-6])
def test_a_mounted_and_scaled_law_answers_consistently(pair, compliance):
    law = RigCompliance(ScaledLaw(laws.Johnson(), load_factor=2.0), 1e-4, compliance)
    loads = np.array([1.0, 50.0, 400.0])
    seen = law.penetration(loads, pair)
    expected = laws.Johnson().penetration(loads / 2, pair) + compliance * loads + 1e-4
    assert seen == pytest.approx(expected, rel=1e-14)
    assert law.load(seen, pair) == pytest.approx(loads, rel=1e-9)
    step = 1e-7
    slope = (law.load(seen + step, pair) - law.load(seen - step, pair)) / (2 * step)
    assert law.stiffness(seen, pair) == pytest.approx(slope, rel=1e-4)
    assert law.load(9e-5, pair) == law.stiffness(9e-5, pair) == 0
    # Where the law ends, or the reading would fall with the load.
    end = law.max_penetration(pair)
    assert law.load(end * (1 - 1e-9), pair) == pytest.approx(law.max_load(pair), rel=1e-3)
    assert np.isnan(law.penetration(1.001 * law.max_load(pair), pair))
    assert np.isnan(law.load(1.001 * end, pair))


def test_a_reading_of_0_is_fitted_and_drawn():
    load = np.geomspace(1.0, 3000.0, 10)
    depth = 1e3 * laws.Explicit().penetration(load, PAIR) * (1 + 0.01 * np.cos(7 * load))
    data = pd.DataFrame({"load_N_per_mm": load, "penetration_um": depth - depth[0]})
    result = cc.fit(data, "explicit", PAIR, free=["offset"], starts=1)
    assert result.max_abs_diff_percent.fitted is None  # relative to 0
    assert result.r_squared > 0.99
    assert (result.predict(load)["high_mm"] > result.predict(load)["low_mm"]).all()


# --- loads above first yield --------------------------------------------------------------------

YIELDING = {"load_N_per_mm": [100, 1000, 9000, 12000], "penetration_um": [1.6, 13, 110, 140]}


PIN_AND_HOLE = ("--pin", "high-strength steel", "--hole", "low-carbon steel")


@pytest.mark.parametrize(
    ("law", "words", "count"),
    [
        ("power-one-pair", ("--material", "high-strength steel"), 0),
        ("power-one-pair", PIN_AND_HOLE, 2),
        ("power-one-pair", ("--E", "200000", "--nu", "0.3"), 0),  # of unknown strength
        # A pulled eye yields far below an infinite plate.
        pytest.param(
            "conformal",
            (*PIN_AND_HOLE, "--R-o", 15, "--clamp", "pulled:60"),
            3,
            marks=pytest.mark.slow,
        ),
    ],
)
def test_loads_above_first_yield_are_told(run, tmp_path, law, words, count):
    table = write_table(tmp_path / "t.csv", YIELDING | {"dR_um": [50] * 4})
    options = ("--law", law, "--contact", "internal", "--Ri", "10", "--runs", 2)
    code, said, _ = run("fit", table, *options, *words, "-o", tmp_path / "r.json")
    assert code == 0
    assert (f"{count} of 4 loads are above first yield by von Mises" in said) == (count > 0)
