"""Noise models against statsmodels and ODRPACK, and against dense matrices."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from scipy.optimize import minimize

import cylcontact as cc
from cylcontact import CylinderPair, laws
from cylcontact.fitting.campaign import read_table
from cylcontact.fitting.noise import (
    Covariance,
    Degrees,
    Likelihood,
    NoiseModel,
    estimate,
)
from cylcontact.fitting.readings import Optimum, fit_with_noise
from tests.support.measured_files import CONSTANTS, STEEL
from tests.support.noisy_series import LAW, PAIR, readings
from tests.support.programs import require_package

# With the stiffness held, a reading is linear in what is left.
LINEAR = {"fixed": {"stiffness_factor": 1.0}, "free": ["compliance"], "starts": 3}


def likelihood_of(result):
    """The likelihood of deviations at the best coefficients of a fit."""
    return result.optimum.likelihood


# --- the wrong kind of noise ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("made", "assumed", "says"),
    [("proportional", "constant", "grows"), ("constant", "proportional", "falls")],
)
def test_scatter_of_another_kind_is_warned_of_by_its_rank_correlation(made, assumed, says):
    scatter = {"constant": 0.0} | {made: {"constant": 1e-4, "proportional": 0.1}[made]}
    frame = readings(1, 1, 60, **scatter).round(1)  # with ties
    result = cc.fit(frame, "explicit", PAIR, noise=assumed, starts=1)
    (warning,) = [each for each in result.warnings if "relative to the noise assumed" in each]
    size = result.residuals["standardised"].abs()
    p = stats.spearmanr(size, frame["penetration_um"]).pvalue
    assert f"{says} with the reading (p = {p:.2g}): allow for both kinds of scatter" in warning


# --- statsmodels ------------------------------------------------------------------------------


def mixed(frame, result, names):
    """The linear mixed model with these random effects, in nm, and of loads in kN/mm."""
    sm = require_package("statsmodels.api")
    load = frame["load_N_per_mm"].to_numpy()
    contact = LAW.penetration(load, PAIR)
    depth = contact + result.coefficients["compliance"] * load
    position = np.tile(np.linspace(0.0, 1.0, 12), len(frame) // 12)
    # Columns of like size, for its optimiser.
    columns = {"offset": np.ones(load.size), "gain": 1e3 * depth, "drift": position}
    design = np.column_stack([np.ones(load.size), 1e-3 * load])
    reading = 1e3 * frame["penetration_um"].to_numpy() - 1e6 * contact
    random = np.column_stack([columns[name] for name in names])
    model = sm.MixedLM(reading, design, frame["group"], exog_re=random)
    independent = _independent(design.shape[1], len(names))
    return model.fit(reml=True, free=independent, method="bfgs", maxiter=5000, gtol=1e-8)


def _independent(fixed, random):
    """Parameters of which the covariances of the random effects are not searched."""
    from statsmodels.regression.mixed_linear_model import MixedLMParams

    return MixedLMParams.from_components(fe_params=np.ones(fixed), cov_re=np.eye(random))


@pytest.fixture(
    scope="module",
    params=[pytest.param("group", marks=pytest.mark.slow), "group and drift"],
)
def linear(request):
    """Readings whose model is linear, and its fit."""
    drift = "drift" in request.param
    frame = readings(3, 10, offset=1.5e-4, gain=0.03, drift=2e-4 if drift else 0.0, compliance=4e-7)
    result = cc.fit(frame, "explicit", PAIR, group="group", noise="constant", drift=drift, **LINEAR)
    return frame, result, ("offset", "gain", *(("drift",) if drift else ()))


def test_statsmodels_agrees_on_estimates_errors_and_deviations(linear):
    frame, result, names = linear
    peer = mixed(frame, result, names)
    estimates = [result.estimates[name] for name in ("offset", "compliance")]
    in_mm = np.array([1e-6, 1e-9])
    assert [e.value for e in estimates] == pytest.approx(peer.fe_params * in_mm, rel=1e-4, abs=0)
    # Its errors are from second derivatives that include the deviations'; ours, and those that its
    # own deviations give, take these as they are.
    errors = [e.standard_error for e in estimates]
    assert errors == pytest.approx(peer.bse_fe * in_mm, rel=5e-3, abs=0)
    X, Z, group = peer.model.exog, peer.model.exog_re, frame["group"].to_numpy()
    shared = (group[:, None] == group) * (Z @ np.diag(np.diag(peer.cov_re)) @ Z.T)
    V = shared + peer.scale * np.eye(group.size)
    normal = least_squares(X, peer.model.endog, V)[1]
    assert errors == pytest.approx(np.sqrt(np.diag(normal)) * in_mm, rel=1e-4, abs=0)
    variances = np.array([peer.scale, *np.diag(peer.cov_re)])
    units = [1e-6, *(1e-3 if name == "gain" else 1e-6 for name in names)]
    deviations = dict(zip(("constant", *names), np.sqrt(variances) * units, strict=True))
    assert result.noise.deviations == pytest.approx(deviations, rel=1e-3, abs=0)
    effects = np.array([[*peer.random_effects[f"s{k}"]] for k in range(10)])
    own = [[e.effects[name] for name in names] for e in result.noise.series]
    assert own == pytest.approx(effects * units[1:], rel=1e-2, abs=1e-7)


def test_statsmodels_agrees_on_what_the_gain_adds_to_the_likelihood(linear):
    frame, result, names = linear
    without = tuple(name for name in names if name != "gain")
    expected = mixed(frame, result, names).llf - mixed(frame, result, without).llf
    likelihood, best = likelihood_of(result), result.noise.deviations

    def value(logarithms):
        others = zip(("constant", *without), np.exp(logarithms), strict=True)
        return likelihood({**dict(others), "gain": 0.0})

    start = np.log([best[name] for name in ("constant", *without)])
    rise = minimize(value, start, method="Nelder-Mead", options={"fatol": 1e-8}).fun
    assert (rise - likelihood(best)) / 2 == pytest.approx(expected, rel=1e-4)
    assert expected > 5


# --- ODRPACK ----------------------------------------------------------------------------------


def test_odrpack_agrees_where_both_deviations_are_given():
    odrpack = require_package("odrpack")
    frame = readings(5, 3, constant=1e-5, load_error=0.003).drop(columns="group")
    frame["load_std_N_per_mm"] = 0.003 * frame["load_N_per_mm"]
    frame["penetration_std_um"] = 0.01
    result = cc.fit(frame, "explicit", PAIR, free=["c"])
    names, shape = ["c", "stiffness_factor", "offset"], LAW.coefficients_for("internal")

    def predicted(load, beta):
        c, factor, offset = beta
        law = laws.Explicit({"c": c, "A": shape.A, "B": shape.B})
        return 1e3 * (law.penetration(load / factor, PAIR) + offset)

    deviations = (frame["load_std_N_per_mm"].to_numpy(), frame["penetration_std_um"].to_numpy())
    peer = odrpack.odr_fit(
        predicted,
        frame["load_N_per_mm"].to_numpy(),
        frame["penetration_um"].to_numpy(),
        np.array([shape.c, 1.0, 1e-4]),
        weight_x=1 / deviations[0] ** 2,
        weight_y=1 / deviations[1] ** 2,
        diff_scheme="central",
        sstol=1e-14,
        partol=1e-14,
        maxit=500,
    )
    # Its sd_beta are scaled to residuals of variance 1; given deviations are taken as they are.
    errors = np.sqrt(np.diag(peer.cov_beta))
    assert peer.sd_beta == pytest.approx(errors * np.sqrt(peer.res_var), rel=1e-6)
    estimates = result.estimates
    assert np.isinf(result.optimum.degrees_of_each()).all()
    assert result.optimum.fit.noise.is_given
    for name, value, error in zip(names, peer.beta, errors, strict=True):
        assert estimates[name].value == pytest.approx(value, abs=0.02 * error)
        assert estimates[name].standard_error == pytest.approx(error, rel=0.02)


# --- dense matrices ---------------------------------------------------------------------------

DEVIATIONS = {"constant": 0.3, "proportional": 0.2, "offset": 0.7, "gain": 0.4, "drift": 0.5}
FULL = NoiseModel("both", "group", drift=True)


def covariance_of(series, model=FULL, rows=6, seed=4):
    """A covariance of rows of so many series in random order, with all that a row may have."""
    rng = np.random.default_rng(seed)
    size = series * rows
    return Covariance(
        model=model,
        load=rng.uniform(1.0, 2.0, size),
        given=rng.uniform(0.01, 0.1, size),
        depth=rng.uniform(0.5, 2.0, size),
        series=rng.permutation(np.repeat(np.arange(series), rows)),
        position=rng.uniform(0.0, 1.0, size),
    )


def dense(covariance, deviations):
    """V as a matrix, the variances of single readings, and the columns of all series."""
    given, depth, series = covariance.given, covariance.depth, covariance.series
    scatter = deviations["constant"] ** 2 + (deviations["proportional"] * depth) ** 2
    single = given + scatter
    columns = []
    for number in range(series.max() + 1):
        columns += [
            np.where(series == number, values, 0.0)
            for values in (np.ones(depth.size), depth, covariance.position)
        ]
    Z = np.array(columns).T
    G = np.tile([deviations["offset"], deviations["gain"], deviations["drift"]], series.max() + 1)
    return np.diag(single) + Z @ np.diag(G**2) @ Z.T, single, Z


def likelihood_and_design(series, model=FULL):
    """A likelihood at generalised least squares of random readings."""
    covariance, rng = covariance_of(series, model), np.random.default_rng(9)
    slopes = np.column_stack([np.ones(covariance.depth.size), covariance.load**2])
    slopes[:, 1] *= 1e-3  # parameters have units of their own
    likelihood = Likelihood(covariance, rng.normal(size=slopes.shape[0]), slopes)
    return covariance, likelihood, slopes


def least_squares(X, y, V):
    """Coefficients of generalised least squares, their covariance, and what is left over."""
    inverse = np.linalg.inv(V)
    normal = np.linalg.inv(X.T @ inverse @ X)
    beta = normal @ X.T @ inverse @ y
    rest = y - X @ beta
    return beta, normal, rest, float(rest @ inverse @ rest)


@pytest.mark.parametrize("rows", [42, 32])
def test_whitened_residuals_have_the_norm_of_the_full_covariance(rows):
    # Without the last rows the series differ in length, and one of them has fewer than effects.
    covariance = covariance_of(7).take(np.argsort(covariance_of(7).series)[:rows])
    assert np.unique(np.bincount(covariance.series)).size == (1 if rows == 42 else 2)
    V, _, _ = dense(covariance, DEVIATIONS)
    vectors = np.random.default_rng(1).normal(size=(3, rows))
    before = vectors.copy()
    covariance = replace(covariance, deviations=DEVIATIONS)
    whitened = covariance.residuals(vectors, 0.0)
    assert vectors == pytest.approx(before)
    expected = vectors @ np.linalg.inv(V) @ vectors.T
    assert whitened @ whitened.T == pytest.approx(expected, rel=1e-11)
    # It is a root of the inverse: independent noise of variance 1 comes out.
    W = covariance.residuals(np.eye(rows), 0.0).T
    assert W @ V @ W.T == pytest.approx(np.eye(rows), abs=1e-11)


def test_fixed_offsets_sum_to_zero_beside_the_laws_own():
    model = NoiseModel("both", "group", drift=True, has_offset=True)
    covariance, likelihood, slopes = likelihood_and_design(3, model)
    scatter = {name: DEVIATIONS[name] for name in covariance.names}
    _, single, Z = dense(covariance, DEVIATIONS)
    sums = [Z[:, 3 * k + place] - Z[:, place] for k in (1, 2) for place in (0, 1)]
    X = np.column_stack([slopes, *sums, Z[:, [2, 5, 8]]])
    beta, normal, _, squares = least_squares(X, likelihood.residuals, np.diag(single))
    at = replace(covariance, deviations=scatter)
    X_and_y = [at.residuals(each, 0.0).T for each in (slopes.T, likelihood.residuals)]
    own, rest, _, _ = np.linalg.lstsq(*X_and_y, rcond=None)
    assert own == pytest.approx(beta[:2], rel=1e-9)
    assert rest[0] == pytest.approx(squares, rel=1e-9)
    assert likelihood.parameter_covariance(scatter) == pytest.approx(normal[:2, :2], rel=1e-9)
    # The effects of the series are those of the dummy columns.
    left = likelihood.residuals - slopes @ beta[:2]
    effects = replace(covariance, deviations=scatter).series_effects(-left)
    assert effects[1:, :2].ravel() == pytest.approx(beta[2:6], rel=1e-8)
    assert effects[:, :2].sum(axis=0) == pytest.approx(0.0, abs=1e-9)
    assert effects[:, 2] == pytest.approx(beta[6:], rel=1e-8)


def restricted(X, y, V):
    """−2 ln of the restricted likelihood, up to a constant."""
    squares = least_squares(X, y, V)[3]
    normal = np.linalg.slogdet(X.T @ np.linalg.inv(V) @ X)[1]
    return np.linalg.slogdet(V)[1] + normal + squares


def test_the_restricted_likelihood_is_that_of_the_full_covariance():
    covariance, likelihood, slopes = likelihood_and_design(7)
    differences = []
    for changes in (1.0, 0.5, 2.0, {"constant": 0.0, "drift": 0.0}):
        own = (
            changes
            if isinstance(changes, dict)
            else {n: v * changes for n, v in DEVIATIONS.items()}
        )
        deviations = DEVIATIONS | own
        V, _, _ = dense(covariance, deviations)
        differences.append(likelihood(deviations) - restricted(slopes, likelihood.residuals, V))
    assert np.ptp(differences) == pytest.approx(0.0, abs=1e-9)


def test_errors_likelihood_and_effects_are_those_of_the_full_covariance():
    covariance, likelihood, X = likelihood_and_design(7)
    V, single, Z = dense(covariance, DEVIATIONS)
    y = likelihood.residuals
    beta, normal, rest, _ = least_squares(X, y, V)
    assert likelihood.parameter_covariance(DEVIATIONS) == pytest.approx(normal, rel=1e-10)
    expected = stats.multivariate_normal.logpdf(rest, cov=V)
    log_det, _, squares = likelihood._terms(DEVIATIONS)
    constant = rest.size * np.log(2 * np.pi)
    assert -0.5 * (constant + log_det + squares) == pytest.approx(expected, rel=1e-11)
    assert likelihood.log_likelihood >= expected  # at the deviations of the largest likelihood
    # The effects of the series solve Henderson's equations.
    R, G = 1 / single, np.tile([DEVIATIONS[n] ** 2 for n in ("offset", "gain", "drift")], 7)
    both = np.hstack([X, Z])
    left = (both.T * R) @ both + np.diag(np.concatenate([[0.0, 0.0], 1 / G]))
    solution = np.linalg.solve(left, (both.T * R) @ y)
    assert solution[:2] == pytest.approx(beta, rel=1e-9)
    effects = replace(covariance, deviations=DEVIATIONS).series_effects(-rest)
    assert effects.ravel() == pytest.approx(solution[2:], rel=1e-9)


@pytest.mark.parametrize("noise", [pytest.param("constant", marks=pytest.mark.slow), "both"])
def test_one_noise_has_one_aic_however_it_is_stated(noise):
    frame = readings(1, 1, 15).drop(columns="group")
    stated = frame.assign(load_std_N_per_mm=1e-9 * frame["load_N_per_mm"])
    ways = ((frame, {}), (frame, {"load_error": 1e-9}), (stated, {}))
    aic = [cc.fit(data, "explicit", PAIR, noise=noise, starts=1, **more).aic for data, more in ways]
    assert np.ptp(aic) == pytest.approx(0.0, abs=1e-6)


# --- limits -----------------------------------------------------------------------------------


def test_a_balanced_layout_has_the_error_and_the_degrees_of_an_analysis_of_variance():
    # The mean of readings of random series: the mean square between the series over N, G − 1.
    series, rows = 9, 5
    rng = np.random.default_rng(2)
    group = np.repeat(np.arange(series), rows)
    y = 0.8 * rng.normal(size=series)[group] + 0.3 * rng.normal(size=group.size)
    one, none = np.ones(group.size), np.zeros(group.size)

    class Offsets(NoiseModel):
        effects = ("offset",)

    covariance = Covariance(Offsets("constant", "group"), one, none, one, group, none)
    likelihood = Likelihood(covariance, y - y.mean(), one[:, None])
    best = estimate(likelihood)
    means = y.reshape(series, rows).mean(axis=1)
    between = rows * means.var(ddof=1)
    within = float(((y.reshape(series, rows) - means[:, None]) ** 2).sum()) / (series * (rows - 1))
    assert best["constant"] == pytest.approx(np.sqrt(within), rel=1e-5)
    assert best["offset"] == pytest.approx(np.sqrt((between - within) / rows), rel=1e-5)
    degrees = Degrees.of(likelihood, best)
    assert degrees.covariance[0, 0] == pytest.approx(between / y.size, rel=1e-5)
    assert degrees(np.eye(1))[0] == pytest.approx(series - 1, rel=1e-3)


# --- findings ---------------------------------------------------------------------------------


# What is in the warning of each test.
TESTS = {
    "series": "series of the column group differ by more than the scatter",
    "pairs": "the residuals differ between the",
    "drift": "the residuals drift along the rows",
    "sequence": "the errors of successive readings are alike",
    "spread": "with the reading (p",
}


def found(frame, law="explicit", pair=PAIR, **settings):
    """The warnings of a fit by the name of the test that failed."""
    settings = {"starts": 1, "noise": "constant"} | settings
    warnings = cc.fit(frame, law, pair, **settings).warnings
    return {test: text for test, start in TESTS.items() for text in warnings if start in text}


def ungrouped(frame):
    return frame.drop(columns="group")


def of_pairs():
    """Relative scatter at three clearances, of which each has a stiffness of its own."""
    parts = []
    for number, (dR, factor) in enumerate(((0.03, 1.0), (0.1, 1.15), (0.3, 0.9))):
        pair = CylinderPair.from_dR("internal", dR, STEEL, R_i=10.0, length=20.0)
        load = np.geomspace(10.0, 1500.0, 12)
        depth = LAW.penetration(load * factor, pair)
        depth *= 1 + 0.01 * np.random.default_rng(number).normal(size=12)
        columns = {"load_N_per_mm": load, "penetration_um": 1e3 * depth, "dR_um": 1e3 * dR}
        parts.append(pd.DataFrame({**columns, "pin": f"p{number}"}))
    return pd.concat(parts, ignore_index=True)


def by_load(**columns):
    """Readings that drift, in the order of their loads."""
    frame = ungrouped(readings(7, 1, 40, drift=4e-4, shuffled=True)).assign(**columns)
    return frame.sort_values("load_N_per_mm")


def unnamed():
    """Series that no column names."""
    frame = ungrouped(readings(1, offset=1e-4, gain=0.02))
    return frame.assign(run=np.repeat(np.arange(8), 12).astype(str))


PAIRS = {"pair": None, "contact": "internal", "constants": CONSTANTS, "noise": None}
SLOW = pytest.mark.slow
# Readings, how they are fitted, the finding, what its remedy names, and what allows for it.
FINDINGS = {
    "series": (
        *(lambda: readings(1, offset=1e-4, gain=0.02), {}),
        *("series", "--group group", {"group": "group"}),
    ),
    "series without a name": (
        *(unnamed, {"ignore": ["run"]}, "sequence", "--group COLUMN"),
        {"group": "run", "ignore": []},
    ),
    "pairs": (
        *(of_pairs, {"ignore": ["pin"], **PAIRS}, "pairs", "--group COLUMN"),
        {"group": "pin", "ignore": []},
    ),
    "drifts": (
        *(lambda: readings(7, 8, 12, drift=4e-4, shuffled=True), {"group": "group"}),
        *("drift", "--drift", {"drift": True}),
    ),
    "a drift in time": (
        *(lambda: by_load(time_s=np.arange(40.0)), {}, "drift", "--drift", {"drift": True}),
    ),
    "scatter that grows": (
        *(lambda: ungrouped(readings(3, 4, proportional=0.03, constant=1e-5)), {}),
        *("spread", "leave --noise out", {"noise": None}),
    ),
    "relative scatter that falls": (
        *(lambda: ungrouped(readings(3, 4)), {"noise": "proportional"}),
        *("spread", "leave --noise out", {"noise": None}),
    ),
    "a single sweep of a wrong law": (
        *(lambda: ungrouped(readings(1, 1, 40, compliance=2e-6)), {"law": "liu"}),
        *("sequence", "repeat some loads", {"law": "explicit", "free": ["compliance"]}),
    ),
}
QUICK = ("a drift in time", "scatter that grows", "a single sweep of a wrong law")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else SLOW) for name in FINDINGS]
)
def test_noise_other_than_assumed_is_found_and_what_is_advised_allows_for_it(name):
    frame, settings, test, remedy, allowed = FINDINGS[name]
    warning = found(frame(), **settings)[test]
    says, at_p = warning.split("(p = ")
    assert says
    assert float(at_p.split(")")[0]) < 0.01
    assert remedy in at_p
    assert test not in found(frame(), **settings | allowed)


@pytest.mark.parametrize("test", ["sequence", pytest.param("drift", marks=SLOW)])
def test_an_unused_column_of_words_is_offered_by_its_name(test):
    if test == "drift":
        frame = by_load(time_s=np.arange(40.0))
    else:
        frame = ungrouped(readings(1, offset=1e-4, gain=0.02))
    names = np.array([f"S{k}" for k in range(8)])
    frame["Test piece"] = names[np.arange(len(frame)) * 8 // len(frame)]
    frame["remark"], frame["shot"] = "sound", [f"p{k}.png" for k in range(len(frame))]
    warning = found(frame)[test]
    assert "allow for series with --group 'Test piece'" in warning
    assert ("remark" in warning, "shot" in warning, "--drift" in warning) == (False, False, True)


def test_a_drift_along_one_sweep_cannot_be_told_from_the_law():
    assert "drift" not in found(ungrouped(readings(7, 1, 40, drift=4e-4)))
    assert "drift" not in found(by_load())  # nor where no time is given


@pytest.mark.slow
def test_chi_square_counts_the_fixed_effects_of_series():
    """Of tables with given deviations that are true, p is even: its mean is ½ ± 1/√(12·60)."""
    values = []
    for seed in range(60):
        frame = readings(seed, 4, 6, offset=2e-4).assign(penetration_std_um=0.05)
        campaign = read_table(frame, "explicit", PAIR, group="group").campaign("explicit")
        fit = fit_with_noise(campaign)
        optimum = Optimum(fit, fit.minimise(np.array([1.0, 2e-4]))[0])
        values.append(optimum.chi_square_p)
    assert optimum.degrees == 24 - 2 - 3 - 3  # offsets and gains of four series sum to zero
    assert np.mean(values) == pytest.approx(0.5, abs=0.1)
