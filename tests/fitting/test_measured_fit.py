"""Fits to measurements: every law gives its own coefficients back, and every way to go wrong."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import cylcontact as cc
from cylcontact import CylinderPair, InputError, laws
from cylcontact.fitting import DataFit, FitResult, compare
from cylcontact.fitting.comparison import verify
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.tables import campaign_of_table, fit_table, read_campaign
from cylcontact.laws.adapters import RigCompliance, ScaledLaw
from tests.support.measured_files import (
    CONSTANTS,
    LOADS,
    STEEL,
    TRUTHS,
    USER_LAW,
    all_free,
    measured_campaign,
    user_campaign,
    whole_truth,
    write_measured,
    write_table,
)
from tests.support.spec_files import changed, tree, write_toml

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "fitting/examples/pin-in-hole.toml"
SPEC = {"data": "measured.csv", "contact": "internal", "law": "johnson", "constants": CONSTANTS}


# --- recovery ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("law", "contact"), TRUTHS, ids=lambda word: word)
def test_exact_points_of_a_law_give_its_coefficients_back(tmp_path, law, contact):
    result = fit_table(measured_campaign(tmp_path, law, contact, starts=4))
    truth = whole_truth(law, contact, result.coefficients)
    assert result.coefficients == pytest.approx(truth, rel=1e-6)
    free = {p.name for p in MODELS[law, contact].parameters if p.value is None}
    assert result.uncertainty.estimates.keys() == free
    assert result.objective.value < 1e-9
    assert "no noise to estimate" in result.verdicts[0]


def test_a_parameter_is_held_or_bounded_as_the_campaign_says(tmp_path):
    given = {"fixed": {"kappa": 1.1}, "bounds": {"c": [-2.0, -0.9]}}
    result = fit_table(measured_campaign(tmp_path, starts=3, **given))
    assert result.coefficients["kappa"] == 1.1
    assert result.coefficients["c"] == pytest.approx(-0.9)
    assert result.uncertainty.estimates.keys() == {"c"}


def test_the_result_does_not_depend_on_workers(tmp_path):
    campaign = measured_campaign(tmp_path, noise=0.02, starts=3)
    one, two = fit_table(campaign, 1), fit_table(campaign, 2)
    assert one.repeatable() == two.repeatable()


def test_smaller_deviations_count_like_repeated_rows(tmp_path):
    table = write_measured(tmp_path / "measured.csv", "johnson", "internal", noise=0.02)
    header, *rows = table.read_text().splitlines()
    header = f"{header},penetration_std_um"
    repeated = tmp_path / "repeated.csv"
    repeated.write_text("\n".join([header, *(f"{row},0.1" for row in [*rows, *rows[:5]])]))
    once = tmp_path / "once.csv"
    std = [0.1 / np.sqrt(2) if k < 5 else 0.1 for k in range(len(rows))]
    text = [header, *(f"{row},{size!r}" for row, size in zip(rows, map(float, std), strict=True))]
    once.write_text("\n".join(text))
    actual = [
        fit_table(campaign_of_table(path, "johnson", "internal", CONSTANTS, starts=2))
        for path in (repeated, once)
    ]
    assert actual[1].coefficients == pytest.approx(actual[0].coefficients, rel=1e-6)
    assert len(actual[0].uncertainty.duplicates) == 5
    assert any("identical rows" in sentence for sentence in actual[0].verdicts)


# --- what is free if nothing is said ----------------------------------------------------------

# The parameter of stiffness of each family; the other laws get a factor of the load.
STIFFNESS = {
    "persson": "modulus_factor",
    "liu": "modulus_factor",
    "lankarani-nikravesh": "factor",
    "enhanced": "stiffness_factor",
    "explicit": "stiffness_factor",
}


def default_campaign(folder, law, contact, **settings):
    table = write_measured(folder / "measured.csv", law, contact)
    return campaign_of_table(table, law, contact, CONSTANTS, **settings)


@pytest.mark.parametrize(("law", "contact"), TRUTHS, ids=lambda word: word)
def test_stiffness_and_offset_are_free_and_the_shape_is_held(tmp_path, law, contact):
    campaign = default_campaign(tmp_path, law, contact)
    free = {p.name for p in campaign.parameters if p.is_free}
    own = MODELS[law, contact].parameters
    if law.startswith("power"):
        assert free == {p.name for p in own if p.value is None}
        return
    assert free == {STIFFNESS.get(law, "kappa"), "offset"}
    held = {p.name: p.value for p in campaign.parameters if not p.is_free}
    assert held == {p.name: p.nominal for p in own if p.name not in free}


# --- a law of the user's own ------------------------------------------------------------------


@pytest.mark.parametrize("objective", [None, "rms-penetration"])
def test_a_function_of_ones_own_is_fitted_like_a_law(tmp_path, objective):
    campaign = user_campaign(tmp_path, objective=objective)
    assert campaign.spec.objective == (objective or "rms-log-penetration")
    result = fit_table(campaign, jobs=2)
    truth = {**TRUTHS["power", "internal"], "offset": 0.0}
    assert result.coefficients == pytest.approx(truth, rel=1e-6)
    law = campaign.model.build(truth)
    pair = CylinderPair.from_dR("internal", 0.3, STEEL)
    power = MODELS["power", "internal"].build(TRUTHS["power", "internal"])
    assert law.penetration(LOADS, pair) == pytest.approx(power.penetration(LOADS, pair), rel=1e-12)
    assert law.stiffness(1e-3, pair) == pytest.approx(power.stiffness(1e-3, pair), rel=1e-8)
    assert law.load(-1.0, pair) == 0
    assert law.penetration(0.0, pair) == 0
    assert np.isinf(law.max_load(pair))
    assert np.isinf(law.max_penetration(pair))


def test_nothing_is_imported_because_a_result_names_it(tmp_path):
    result = fit_table(user_campaign(tmp_path))
    path = tmp_path / "r.json"
    result.save(path)
    marker = tmp_path / "ran"
    (tmp_path / "mine.py").write_text(f"open({str(marker)!r}, 'w')\n{USER_LAW}")
    again = FitResult.read(path)
    assert "mine:load" in compare([again])
    with pytest.raises(InputError, match="not run because a result names it"):
        verify(path, 1, lambda *_: None)
    assert not marker.exists()


# --- what the result holds --------------------------------------------------------------------


@pytest.fixture(scope="module")
def example():
    return fit_table(read_campaign(EXAMPLE))


def test_the_shipped_example_finds_the_law_it_was_made_of(example):
    assert isinstance(example, DataFit)
    actual = example.uncertainty
    for name, truth in (("kappa", 1.0), ("c", -1.0)):
        assert actual.estimates[name].profile.low < truth < actual.estimates[name].profile.high
    assert actual.duplicates == [[16, 17]]
    [outlier] = actual.outliers
    rows = example.residuals.set_index("line")
    assert outlier.line == 38
    # The reading is off upwards; 1.4826 times the median is the deviation of normal noise.
    assert rows["penetration_mm"][38] > rows["fitted_mm"][38]
    robust = 1.4826 * rows["standardised"].abs().median()
    assert outlier.deviations == pytest.approx(rows["standardised"][38] / robust, rel=1e-4)
    assert actual.without_outliers["kappa"] == pytest.approx(1.0, rel=0.03)
    assert "<table>" in example._repr_html_()


@pytest.mark.parametrize(
    ("changes", "key", "rule"),
    [
        ({"uncertainty": None}, "uncertainty", "must be a table"),
        ({"settings.measurements.colour": 1}, "colour", "is not a known key"),
    ],
)
def test_a_damaged_result_is_told(tmp_path, example, changes, key, rule):
    path = tmp_path / "r.json"
    example.save(path)
    data = changed(json.loads(path.read_text("utf-8")), changes)
    path.write_text(json.dumps(data))
    with pytest.raises(InputError) as caught:
        FitResult.read(path)
    assert caught.value.key == key
    assert rule in caught.value.rule


LOAD = np.geomspace(10.0, 1000.0, 15)
ONE = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)


def table(**columns):
    """Readings of the explicit law with 1 % of noise, and further columns."""
    depth = 1e3 * laws.Explicit().penetration(LOAD, ONE) * (1 + 0.01 * np.cos(7 * LOAD))
    return pd.DataFrame({"load_N_per_mm": LOAD, "penetration_um": depth, **columns})


@pytest.mark.parametrize("given", [{}, {"load_std_N": 1e-6}], ids=["one", "both"])
def test_residuals_beyond_given_deviations_are_a_warning_in_their_unit(given):
    result = cc.fit(table(penetration_std_um=1e-4, **given), "explicit", ONE, starts=2)
    assert any("larger than the given standard deviations" in text for text in result.warnings)
    assert result.objective_unit == "std. dev."
    assert f"{result.objective.name}, std. dev." in compare([result])


def test_one_series_alone_is_said_to_be_one():
    result = cc.fit(table(run="A"), "explicit", ONE, group="run", starts=2)
    assert "there is one series" in str(result)


def test_readings_that_are_all_equal_are_fitted_and_not_described():
    result = cc.fit(table(penetration_um=1.0), "explicit", ONE, starts=2)
    assert result.uncertainty.r_squared is None
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
        pd.DataFrame(rows), "conformal", contact="internal", constants=constants, starts=2
    )
    assert result.coefficients["stiffness_factor"] == pytest.approx(1.2, rel=2e-3)


# --- campaign files ---------------------------------------------------------------------------


# What no schema says; tests/cli/test_malformed.py has the rest.
BAD_CAMPAIGNS = [
    ({"dataset": "x.toml"}, "data", "conflicts with dataset"),
    ({"data": "absent.csv"}, "data", "no such file beside the campaign"),
    ({"law": "hooke"}, "law", "is not a law that can be fitted"),
    ({"law": "conformal", "contact": "external"}, "law", "is for internal contact only"),
    ({"law": "liu", "contact": "external"}, "law", "is for internal contact only"),
    ({"loss_scale": 1.0}, "loss_scale", "is gone"),
    ({"loss": "huber"}, "loss", "is gone"),
    ({"objective": "rms-luck"}, "objective", "is not an objective for measurements"),
    ({"materials": "absent.csv"}, "materials", "no such file"),
    ({"bounds": {"K": [0.0, 1.0]}}, "bounds.K", "is not a parameter of"),
    (
        {"fixed": {"kappa": 1.0, "offset": 1.0}},
        *("parameters", "are all fixed"),
    ),
    ({"ignore": ["colour"]}, "ignore", "is not a column of the table"),
    ({"loads": "299:", "free": ["c"]}, "data", "are not more than the 3 free"),
    ({"law": "mine:load", "bounds": {"K_star": [0.5, 10.0]}}, "bounds.n", "is required: a law of"),
]


@pytest.mark.parametrize(("changes", "key", "rule"), BAD_CAMPAIGNS, ids=lambda c: str(c)[:40])
def test_a_bad_campaign_is_told(tmp_path, changes, key, rule):
    write_measured(tmp_path / "measured.csv", "johnson", "internal", noise=0.01)
    (tmp_path / "mine.py").write_text(USER_LAW)
    path = write_toml(tmp_path / "c.toml", changed(SPEC, changes))
    with pytest.raises(InputError) as caught:
        read_campaign(path)
    assert caught.value.key == key
    assert rule in caught.value.rule
    assert len(str(caught.value).splitlines()) == 1


def test_rows_that_no_coefficients_reach_are_named(tmp_path):
    columns = {"load_N_per_mm": [1, 2, 1e9], "penetration_um": [0.01, 0.02, 0.5]}
    table = write_table(tmp_path / "t.csv", columns)
    bounds = {"kappa": [0.9, 1.1], "c": [-1.5, -0.5]}
    campaign = campaign_of_table(
        table,
        "johnson",
        "internal",
        {**CONSTANTS, "dR_um": 50},
        bounds=bounds,
        fixed={"offset": 0.0},
    )
    with pytest.raises(InputError) as caught:
        fit_table(campaign)
    assert caught.value.source == f"{table}, line 4"
    assert "lies outside the domain of johnson" in caught.value.rule


# --- the command line -------------------------------------------------------------------------


JOHNSON = ("--law", "johnson", "--contact", "internal")


@pytest.mark.parametrize("given", [(), ("-o", "elsewhere/fit")])
def test_a_fitted_table_has_a_folder_of_its_own(tmp_path, run, monkeypatch, given):
    monkeypatch.chdir(tmp_path)
    table = write_measured(tmp_path / "mine.csv", "johnson", "internal", noise=0.01)
    options = ("--E", "207 GPa", "--nu", 0.3, "--Ri", 10, "--bound", "c=-2:0", "--fix", "offset=0")
    command = ("fit", table, *JOHNSON, *options, "--runs", 2, "--seed", 3, "-j", 1)
    code, said, errors = run(*command, *given)
    assert (code, errors) == (0, "")
    folder = tmp_path / (given[1] if given else "results/mine")
    assert "result.json, residuals.csv, fit.png, fit.pdf" in said
    assert {path.name for path in folder.iterdir()} == {
        *("result.json", "residuals.csv", "fit.png", "fit.pdf")
    }
    result = FitResult.read(folder / "result.json")
    assert result.uncertainty.estimates.keys() == {"kappa", "c"}
    settings = result.settings["campaign"]
    assert (settings["seed"], settings["bounds"]["c"][0], len(result.runs)) == (3, -2, 2)
    rows = pd.read_csv(folder / "residuals.csv", comment="#")
    assert rows["line"].tolist() == list(range(2, 38))
    assert rows["residual_mm"].to_numpy() == pytest.approx(result.residuals["residual_mm"])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--contact", "internal"), "--law: is required for a table"),
        ((*JOHNSON, "--bound", "c=1"), "'--bound': 'c=1' is not valid"),
        ((*JOHNSON, "--fix", "c=1", "--bound", "c=1:2"), "c is given twice"),
        (
            (*JOHNSON, "--pin", "PEEK", "--hole", "bronze", "--material-j", "PTFE"),
            "--pin: says the same as --material-j; keep one of them",
        ),
        (
            ("--law", "johnson", "--contact", "external", "--pin", "PEEK", "--hole", "bronze"),
            "--contact = 'external': has no pin and no hole; leave out --pin; rollers have",
        ),
    ],
)
def test_a_bad_command_line_is_told_and_leaves_nothing(tmp_path, run, arguments, message):
    table = write_measured(tmp_path / "measured.csv", "johnson", "internal")
    before = tree(tmp_path)
    code, said, errors = run("fit", table, *arguments, "-o", tmp_path / "r.json")
    assert (code, said, len(errors.splitlines())) == (2, "", 1)
    assert message in errors
    assert tree(tmp_path) == before


def test_options_for_tables_are_refused_beside_a_campaign(run):
    for option, value in (("--law", "power"), ("--pin", "PEEK"), ("--Ri", 1)):
        code, _, errors = run("fit", EXAMPLE, option, value)
        assert code == 2
        assert f"toml: {option}: is an option for tables of measurements" in errors


# --- the rig ----------------------------------------------------------------------------------

RIG = {"offset": [-0.01, 0.01], "compliance": [0.0, 1e-4]}


def write_readings(folder, law, offset, compliance, noise=0.0):
    """Write what a rig reads of a law: its points, moved and given way."""
    header, *rows = write_measured(folder / "exact.csv", law, "internal").read_text().splitlines()
    rng = np.random.default_rng(5)
    lines = [header]
    for row in rows:
        dR, f, depth = map(float, row.split(","))
        seen = depth + 1e3 * (offset + compliance * f) + noise * rng.normal()
        lines.append(f"{dR!r},{f!r},{seen!r}")
    table = folder / "readings.csv"
    table.write_text("\n".join(lines))
    return table


@pytest.mark.parametrize("objective", ["rms-penetration"])
def test_a_rig_that_is_off_and_gives_way_is_found_with_the_law(tmp_path, objective):
    table = write_readings(tmp_path, "persson", 2e-3, 1.5e-6)
    campaign = campaign_of_table(
        table, "persson", "internal", CONSTANTS, bounds=RIG, objective=objective, starts=2
    )
    result = fit_table(campaign)
    truth = {**TRUTHS["persson", "internal"], "offset": 2e-3, "compliance": 1.5e-6}
    assert result.coefficients == pytest.approx(truth, rel=1e-6)
    result.save(tmp_path / "r.json")
    assert FitResult.read(tmp_path / "r.json") == result
    assert all(check.holds for check in verify(tmp_path / "r.json", 1, lambda *_: None))


def test_a_compliance_is_not_to_be_told_from_the_constant_of_a_logarithm(tmp_path):
    table = write_readings(tmp_path, "johnson", 0.0, 1.5e-6, noise=1e-3)
    campaign = campaign_of_table(
        *(table, "johnson", "internal", CONSTANTS),
        **all_free("johnson", "internal", {"compliance": RIG["compliance"]}),
        objective="rms-penetration",
        starts=3,
    )
    assert set(fit_table(campaign).uncertainty.only_together) == {"c", "compliance"}


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


@pytest.mark.parametrize("noise", [None, "constant", "both"])
def test_a_reading_of_0_is_fitted_and_drawn(noise):
    load = np.array([1.0, 3, 10, 30, 100, 300, 1000, 1500, 2000, 3000])
    one = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)
    depth = 1e3 * laws.Explicit().penetration(load, one) * (1 + 0.01 * np.cos(7 * load))
    data = pd.DataFrame({"load_N_per_mm": load, "penetration_um": depth - depth[0]})
    result = cc.fit(data, "explicit", one, free=["offset"], noise=noise)
    assert np.isfinite(result.max_abs_diff_percent.fitted)
    assert "R² = 0.99" in str(result)
    assert (result.predict(load)["high_mm"] > result.predict(load)["low_mm"]).all()


# --- loads above first yield --------------------------------------------------------------------

YIELDING = {"load_N_per_mm": [100, 1000, 9000, 12000], "penetration_um": [1.6, 13, 110, 140]}


@pytest.mark.parametrize(
    ("words", "count"),
    [
        (("--material", "high-strength steel"), 0),
        (("--pin", "high-strength steel", "--hole", "low-carbon steel"), 2),
        (("--E", "200000", "--nu", "0.3"), 0),  # of unknown strength
    ],
)
def test_loads_above_first_yield_are_told(run, tmp_path, words, count):
    table = write_table(tmp_path / "t.csv", YIELDING | {"dR_um": [50] * 4})
    options = ("--law", "power-one-pair", "--contact", "internal", "--Ri", "10", "-j", "1")
    code, said, _ = run("fit", table, *options, *words, "-o", tmp_path / "r.json")
    assert code == 0
    assert (f"{count} of 4 loads are above first yield by von Mises" in said) == (count > 0)


@pytest.mark.slow
def test_a_pulled_eye_yields_far_below_an_infinite_plate(run, tmp_path):
    table = write_table(tmp_path / "t.csv", YIELDING | {"dR_um": [50] * 4})
    options = ("--law", "conformal", "--contact", "internal", "--Ri", "10", "-j", "1")
    pair = ("--pin", "high-strength steel", "--hole", "low-carbon steel")
    eye = ("--R-o", 15, "--clamp", "far:60")
    code, said, _ = run("fit", table, *options, *pair, *eye, "-o", tmp_path / "e.json")
    assert code == 0
    assert "3 of 4 loads are above first yield" in said
