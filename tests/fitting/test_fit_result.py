"""What a fit to measurements gives: tables, predictions, laws, pictures and files."""

import json
import pickle

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from scipy import stats

import cylcontact as cc
from cylcontact import CylinderPair, InputError, laws
from cylcontact.fitting import DataFit, findings, read_result
from tests.support.measured_files import CONSTANTS, STEEL, USER_LAW, write_measured
from tests.support.noisy_series import LAW, PAIR, campaign_of, readings, refitted

EFFECTS = ("offset", "gain")
RIG = {"free": ["compliance"], "fixed": {"stiffness_factor": 1.1}}


@pytest.fixture(scope="module")
def plain():
    """Readings of one series with constant scatter, and a linear fit to them."""
    frame = readings(3, 1, 25, compliance=6e-7).drop(columns="group")
    return frame, cc.fit(frame, "explicit", PAIR, noise="constant", starts=1, **RIG)


@pytest.fixture(scope="module")
def series():
    """Readings of five series, and a fit with random effects and both kinds of scatter."""
    frame = readings(4, 5, offset=1e-4, gain=0.03, proportional=0.004)
    return frame, cc.fit(frame, "explicit", PAIR, group="group", starts=1)


@pytest.fixture(scope="module")
def pairs():
    """Relative scatter at two clearances, and the fit to it."""
    parts, rng = [], np.random.default_rng(6)
    for dR in (0.03, 0.1):
        pair = CylinderPair.from_dR("internal", dR, STEEL, R_i=10.0, length=12.0)
        load = np.geomspace(10.0, 1500.0, 10)
        depth = LAW.penetration(load, pair) * (1 + 0.01 * rng.normal(size=10))
        columns = {"dR_um": 1e3 * dR, "load_N_per_mm": load, "penetration_um": 1e3 * depth}
        parts.append(pd.DataFrame(columns))
    frame = pd.concat(parts, ignore_index=True)
    fixed = {"offset": 0.0}
    return frame, cc.fit(
        frame, "explicit", contact="internal", constants=CONSTANTS, starts=1, fixed=fixed
    )


def fitted_reading(result, load, pair=PAIR):
    """What a fitted explicit law of the package reads."""
    values = result.coefficients
    law = laws.Explicit({name: values[name] for name in ("c", "A", "B")})
    depth = law.penetration(np.asarray(load) / values["stiffness_factor"], pair)
    return depth + values.get("offset", 0.0) + values.get("compliance", 0.0) * np.asarray(load)


# --- tables -----------------------------------------------------------------------------------


def test_residuals_are_measured_less_fitted(plain):
    frame, result = plain
    table = result.residuals
    load, reading = frame["load_N_per_mm"], 1e-3 * frame["penetration_um"]
    assert list(table) == [
        *("line", "load_N_per_mm", "penetration_mm"),
        *("fitted_mm", "residual_mm", "standardised"),
    ]
    assert table["load_N_per_mm"].to_list() == load.to_list()
    assert table["fitted_mm"].to_numpy() == pytest.approx(fitted_reading(result, load), rel=1e-12)
    residual = reading - fitted_reading(result, load)
    assert table["residual_mm"].to_numpy() == pytest.approx(residual, abs=1e-15)
    sigma = np.sqrt((residual**2).sum() / (len(frame) - 2))
    assert table["standardised"].to_numpy() == pytest.approx(residual / sigma, rel=1e-8)


def test_residuals_of_series_say_what_the_series_adds(series):
    frame, result = series
    table, noise = result.residuals, result.noise
    assert table["group"].to_list() == frame["group"].to_list()
    own = {effect.name: effect.effects for effect in noise.series}
    depth = table["fitted_mm"] - result.coefficients["offset"]
    offset, gain = (table["group"].map({g: e[name] for g, e in own.items()}) for name in EFFECTS)
    assert table["series_mm"].to_numpy() == pytest.approx(offset + gain * depth, abs=1e-14)
    # With it the residuals scatter as single readings do, and less than without.
    left = table["residual_mm"] - table["series_mm"]
    single = np.hypot(noise.deviations["constant"], noise.deviations["proportional"] * depth)
    assert 0.7 < (left / single).std() < 1.1
    assert left.std() < 0.5 * table["residual_mm"].std()
    assert (table["standardised"] ** 2).mean() == pytest.approx(result.objective.value**2)


def test_the_table_of_coefficients_has_their_units_and_intervals(plain):
    _, result = plain
    table = result.to_frame()
    assert list(table) == ["value", "unit", "standard_error", "low", "high", "verdict"]
    assert table["value"].to_dict() == result.coefficients
    units = table["unit"]
    assert (units["offset"], units["compliance"]) == ("mm", "mm/(N/mm)")
    for name in result.free:
        row, estimate = table.loc[name], result.estimates[name]
        assert row["standard_error"] == estimate.standard_error
        # The model is linear: the profile's interval is Student's.
        reach = stats.t.ppf(0.975, 23) * estimate.standard_error
        assert row["low"] == pytest.approx(estimate.value - reach, rel=1e-3)
        assert row["high"] == pytest.approx(estimate.value + reach, rel=1e-3)
    held = table.loc[["c", "A", "B", "stiffness_factor"]]
    assert held[["standard_error", "low", "high"]].isna().all(axis=None)
    assert set(held["verdict"]) == {"fixed"}


def test_the_largest_difference_is_in_percent_of_the_readings(plain):
    frame, result = plain
    off = fitted_reading(result, frame["load_N_per_mm"]) / (1e-3 * frame["penetration_um"]) - 1
    assert result.max_abs_diff_percent.fitted == pytest.approx(100 * off.abs().max(), rel=1e-6)


@pytest.mark.parametrize(
    ("low", "high", "told"),
    [(0.5, 0.7, True), (0.5, 0.9, False), (0.9, 1.4, False), (1.3, 2, True)],
)
def test_a_stiffness_is_told_if_its_whole_interval_is_unusual(pairs, low, high, told):
    _, result = pairs
    own = {"value": (low + high) / 2, "low": low, "high": high}
    estimate = result.estimates["stiffness_factor"].model_copy(update=own)
    estimates = result.estimates | {"stiffness_factor": estimate}
    assert bool(findings._on_stiffness(result.optimum, estimates)) == told


def test_figures_of_merit_are_those_of_a_normal_distribution(plain):
    frame, result = plain
    load, reading = frame["load_N_per_mm"].to_numpy(), 1e-3 * frame["penetration_um"].to_numpy()
    r = reading - fitted_reading(result, load)
    log_likelihood = stats.norm.logpdf(r, scale=np.sqrt((r**2).mean())).sum()
    # Two coefficients and the deviation.
    assert result.aic == pytest.approx(6 - 2 * log_likelihood, rel=1e-9)
    assert result.bic == pytest.approx(3 * np.log(25) - 2 * log_likelihood, rel=1e-9)
    assert result.r_squared == pytest.approx(1 - r.var() / reading.var(), abs=1e-9)
    X = np.column_stack([np.ones(load.size), load])
    normal = np.linalg.inv(X.T @ X)
    expected = normal[0, 1] / np.sqrt(normal[0, 0] * normal[1, 1])
    correlations = result.correlations
    assert list(correlations) == list(correlations.index) == ["offset", "compliance"]
    assert correlations.loc["offset", "compliance"] == pytest.approx(expected, rel=1e-6)
    assert np.diag(correlations) == pytest.approx([1, 1])


def test_a_length_as_published_is_in_the_unit_of_the_fitted_one():
    result = cc.fit(readings(1, 1, 12), "johnson", PAIR, uncertain={"dR": "2 um"}, starts=1)
    (row,) = (line.split() for line in str(result).splitlines() if line.startswith("dR "))
    assert (row[2], row[-3:]) == ("µm", ["30", "as", "given"])


def test_a_published_law_is_that_of_the_pair_as_given_with_the_gauge_at_zero():
    result = cc.fit(readings(1, 1, 12), "lankarani-nikravesh", PAIR, starts=1)
    published = {"n": 1.5, "stiffness_factor": 1.0, "offset": 0.0}
    assert result.published.coefficients == published


def test_deviations_and_fixed_effects_count_as_estimated(series):
    frame, result = series
    assert result.estimated == 2 + 4
    assert result.aic == 2 * 6 - 2 * result.log_likelihood
    few = cc.fit(frame.iloc[:36], "explicit", PAIR, group="group", noise="constant", starts=1)
    assert not few.noise.random
    # Two coefficients, a deviation, and two offsets and two gains that sum to zero with a third.
    assert few.estimated == 2 + 1 + 4


# --- predictions ------------------------------------------------------------------------------


def test_a_prediction_is_the_law_with_the_textbook_bands(plain):
    frame, result = plain
    load = frame["load_N_per_mm"].to_numpy()
    at = np.array([20.0, 300.0, 2000.0])
    table = result.predict(at, level=0.9)
    assert table["load_N_per_mm"].to_list() == at.tolist()
    assert table["penetration_mm"].to_numpy() == pytest.approx(fitted_reading(result, at))
    X, new = np.column_stack([np.ones(load.size), load]), np.column_stack([np.ones(3), at])
    variance = ((new @ np.linalg.inv(X.T @ X)) * new).sum(axis=1)
    sigma, reach = result.noise.deviations["constant"], stats.t.ppf(0.95, 23)
    for columns, expected in (
        (("curve_low_mm", "curve_high_mm"), reach * sigma * np.sqrt(variance)),
        (("low_mm", "high_mm"), reach * sigma * np.sqrt(1 + variance)),
    ):
        low, high = (table[column].to_numpy() for column in columns)
        assert (high - low) / 2 == pytest.approx(expected, rel=1e-6)
        assert (high + low) / 2 == pytest.approx(table["penetration_mm"].to_numpy(), rel=1e-9)


def test_a_new_reading_is_one_of_a_new_series(series):
    _, result = series
    table, noise = result.predict([20.0, 300.0]), result.noise.deviations
    half = (table[["high_mm", "curve_high_mm"]].to_numpy() - table[["penetration_mm"]].to_numpy()).T
    load = table["load_N_per_mm"].to_numpy()
    _, slopes = result.optimum.slopes_of(lambda law: law.penetration(load, PAIR))
    reach = stats.t.ppf(0.975, result.optimum.satterthwaite(slopes))
    added = (half[0] ** 2 - half[1] ** 2) / reach**2
    depth = table["penetration_mm"] - result.coefficients["offset"]
    share = noise["proportional"] ** 2 + noise["gain"] ** 2
    expected = noise["constant"] ** 2 + noise["offset"] ** 2 + share * depth**2
    assert added == pytest.approx(expected.to_numpy(), rel=1e-6)


def test_a_prediction_for_a_pair_of_many(pairs):
    _, result = pairs
    other = CylinderPair.from_dR("internal", 0.06, STEEL, R_i=10.0, length=12.0)
    table = result.predict(100.0, pair=other)
    assert table["penetration_mm"][0] == pytest.approx(fitted_reading(result, 100.0, other))
    assert table["low_mm"][0] < table["curve_low_mm"][0] < table["penetration_mm"][0]
    both = result.predict([100.0, 200.0])
    names, groups = result.optimum.fit.data.groups("pair")
    assert list(both["pair"]) == [name for name in names for _ in range(2)]
    second = result.optimum.fit.data.take(np.flatnonzero(groups == 1)[:1]).pair
    alone = result.predict([100.0, 200.0], pair=second)
    assert both[both["pair"] == names[1]]["low_mm"].to_list() == alone["low_mm"].to_list()


def test_a_total_load_has_no_prediction_for_rows_of_several_lengths(plain):
    frame = plain[0].assign(length_mm=[10.0, 20.0] * 12 + [20.0])
    alone = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL)
    result = cc.fit(frame, "explicit", alone, starts=1)
    with pytest.raises(InputError, match="no single axial length is known"):
        result.predict("4500 N")
    assert result.predict("225 N/mm")["load_N_per_mm"].tolist() == [225.0]


SIMULATED = {
    "one series": (100, {"series": 1, "rows": 15}, {"noise": "constant", "ignore": ["group"]}),
    "series": (25, {"offset": 1e-4, "gain": 0.03}, {"noise": "constant", "group": "group"}),
}


@pytest.mark.parametrize("kind", SIMULATED)
@pytest.mark.slow
def test_the_band_covers_new_readings_as_often_as_it_says(kind):
    number, simulated, settings = SIMULATED[kind]
    campaign = campaign_of(readings(0, **simulated), "explicit", PAIR, **settings)
    load = np.geomspace(10.0, 1500.0, 5)
    hits = []
    for seed in range(number):
        band = refitted(campaign, readings(500 + seed, **simulated)).band(PAIR, 0.95, load=load)
        new = readings(5000 + seed, **{**simulated, "series": 20, "rows": 5})
        new = 1e-3 * new["penetration_um"].to_numpy().reshape(20, 5)
        hits.append((np.array(band.new_low) <= new) & (new <= np.array(band.new_high)))
    assert np.mean(hits) == pytest.approx(0.95, abs=0.02)
    # At the least load and at the greatest too.
    assert np.mean(hits, axis=(0, 1)) == pytest.approx(0.95, abs=0.035)


# --- the law ----------------------------------------------------------------------------------


def test_the_law_of_a_fit_leaves_the_rig_out(plain):
    _, result = plain
    law, load = result.to_law(), np.array([20.0, 700.0])
    rig = result.coefficients["offset"] + result.coefficients["compliance"] * load
    expected = fitted_reading(result, load) - rig
    assert law.penetration(load, PAIR) == pytest.approx(expected, rel=1e-12)
    assert law.load(expected, PAIR) == pytest.approx(load, rel=1e-9)


# --- pictures ---------------------------------------------------------------------------------


def points_of(axes):
    """The lines of an axes that are markers, and those that are curves."""
    lines = [line for line in axes.lines if line.get_transform() == axes.transData]
    return (
        [line for line in lines if line.get_linestyle() == "None"],
        [line for line in lines if line.get_linestyle() != "None"],
    )


def test_a_plot_shows_the_data_the_law_and_its_band(series):
    frame, result = series
    axes = Figure().subplots()
    assert result.plot(axes) is axes
    markers, (curve,) = points_of(axes)
    assert [line.get_label() for line in markers] == ["s0", "s1", "s2", "s3", "s4"]
    for line in markers:
        own = frame[frame["group"] == line.get_label()]
        assert line.get_xdata() == pytest.approx(own["load_N_per_mm"].to_numpy())
        assert line.get_ydata() == pytest.approx(own["penetration_um"].to_numpy(), rel=1e-12)
    table = result.predict(curve.get_xdata())
    assert curve.get_ydata() == pytest.approx(1e3 * table["penetration_mm"].to_numpy())
    (band,) = axes.collections
    drawn = band.get_datalim(axes.transData)
    assert drawn.y0 == pytest.approx(1e3 * table["low_mm"].min())
    assert drawn.y1 == pytest.approx(1e3 * table["high_mm"].max())


def test_a_profile_is_the_distance_in_errors_where_the_law_is_linear(plain):
    _, result = plain
    axes = Figure().subplots()
    assert result.plot_profile("compliance", axes) is axes
    _, curves = points_of(axes)
    estimate = result.estimates["compliance"]
    x, y = curves[0].get_data()
    assert y == pytest.approx(np.abs(x - estimate.value) / estimate.standard_error, abs=1e-5)
    levels = [line.get_ydata()[0] for line in axes.lines if line.get_linestyle() == ":"]
    assert levels == [pytest.approx(stats.t.ppf(0.975, 23), rel=1e-9)]
    ends = [line.get_xdata()[0] for line in axes.lines if line.get_linestyle() == "--"]
    assert ends == [estimate.low, estimate.high, estimate.value]
    assert axes.get_xlabel() == "compliance (mm/(N/mm))"


# --- refusals ---------------------------------------------------------------------------------

ROLLERS = CylinderPair.external(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda fit: fit.predict(100.0, pair=ROLLERS), "'external': is not internal, as the fit"),
        (lambda fit: fit.predict(1.0, level=1.0), "level = 1.0: must lie between 0 and 1; 0.95"),
        (lambda fit: fit.predict(1.0, level=np.nan), "level = nan: must lie between 0 and 1"),
        (lambda fit: fit.predict([10.0, -1.0]), "load in N/mm = -1.0: must be above zero"),
        (lambda fit: fit.predict("4 tf"), "is not a load with its unit"),
        (lambda fit: fit.plot_profile("speed"), "do not determine it; choose offset, compliance"),
        (lambda fit: fit.plan([20.0], parameter="kappa"), "is not free; choose offset, comp"),
        (lambda fit: fit.plan([20.0], add=0), "add = 0: must be a whole number from 1"),
    ],
)
def test_what_cannot_be_answered_is_refused(plain, ask, words):
    with pytest.raises(InputError) as refused:
        ask(plain[1])
    assert words in str(refused.value)


# --- files ------------------------------------------------------------------------------------


def test_a_file_gives_the_same_tables(series, tmp_path):
    _, result = series
    result.save(tmp_path / "r.json")
    read = read_result(tmp_path / "r.json")
    assert read == result
    exactly = {"rtol": 1e-12, "atol": 1e-15}
    pd.testing.assert_frame_equal(read.residuals, result.residuals, **exactly)
    load = [20.0, 300.0]
    pd.testing.assert_frame_equal(read.predict(load), result.predict(load), **exactly)
    assert (read.aic, read.bic, read.summary()) == (result.aic, result.bic, result.summary())
    back = pickle.loads(pickle.dumps(result))
    assert back == result
    assert back.predict(100.0).equals(result.predict(100.0))


def test_a_function_of_ones_own_is_drawn_in_memory_and_has_no_law_of_the_package(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(USER_LAW)
    frame = readings(3, 1, 15, zero=0.0, constant=1e-6).drop(columns="group")
    bounds = {"K_star": (0.1, 30.0), "n": (0.9, 1.6)}
    result = cc.fit(frame, "mine:load", PAIR, bounds=bounds, starts=1)
    assert result.plot().has_data()
    with pytest.raises(InputError, match="is your own Python function"):
        result.to_law()


# --- levels and JSON --------------------------------------------------------------------------


def test_the_level_of_a_fit_is_that_of_all_its_intervals(plain, tmp_path):
    frame, _ = plain
    settings = {"noise": "constant", "fixed": {"offset": 0.0}, "starts": 1}
    usual = cc.fit(frame, "explicit", PAIR, **settings)
    wide = cc.fit(frame, "explicit", PAIR, **settings, level=0.99)
    degrees = usual.degrees_of_freedom
    ratio = stats.t.ppf(0.995, degrees) / stats.t.ppf(0.975, degrees)
    for name in wide.free:
        at_99, at_95 = wide.estimates[name], usual.estimates[name]
        assert at_99.standard_error == pytest.approx(at_95.standard_error, rel=1e-6)
        # A profile is nearly that of a linear law.
        assert at_99.high - at_99.low == pytest.approx(ratio * (at_95.high - at_95.low), rel=2e-3)
    assert "99 % profile interval" in str(wide)
    stiffness = [fit.interval(lambda law: law.stiffness(1e-3, PAIR)) for fit in (wide, usual)]
    width = [float((one["high"] - one["low"]).iloc[0]) for one in stiffness]
    assert width[0] / width[1] == pytest.approx(ratio, rel=1e-4)
    pd.testing.assert_frame_equal(
        wide.predict([100.0]), usual.predict([100.0], level=0.99), rtol=1e-6
    )
    wide.save(tmp_path / "r.json")
    assert DataFit.read(tmp_path / "r.json").level == 0.99


def test_commands_print_json(run, tmp_path):
    write_measured(tmp_path / "mine.csv", "johnson", "internal", noise=0.01)
    of_pair = ("--contact", "internal", "--E", "207 GPa", "--nu", 0.3, "--Ri", 10)
    code, said, _ = run("fit", tmp_path / "mine.csv", *of_pair, "--law", "johnson", "--json",
                        "--level", 0.9, "--runs", 1, "-o", tmp_path / "r.json")  # fmt: skip
    result = tmp_path / "r.json"
    assert (code, json.loads(said)) == (0, json.loads(result.read_text("utf-8")))
    assert json.loads(said)["level"] == 0.9
    code, said, _ = run("predict", result, "--load", "50 N/mm", "--json")
    told = json.loads(said)
    row = DataFit.read(result).predict([50.0]).iloc[0]
    assert (code, told["level"], told["rows"][0]["low_mm"]) == (
        0,
        0.9,
        pytest.approx(row["low_mm"]),
    )
    code, said, _ = run("choose", tmp_path / "mine.csv", *of_pair, "--law", "johnson",
                        "--json", "-j", 1)  # fmt: skip
    assert (code, [row["law"] for row in json.loads(said)["rows"]]) == (0, ["johnson"])
