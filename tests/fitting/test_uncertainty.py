"""How sure: against NIST's certified values, iminuit and lmfit; test_coverage repeats fits."""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import pytest
from scipy import stats

import cylcontact as cc
from cylcontact import CylinderPair, laws
from cylcontact.fitting import findings, fit_table
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.noise import NoiseModel
from cylcontact.fitting.parameters import LawModel, Parameter
from cylcontact.fitting.readings import (
    Fit,
    Optimum,
    fit_with_noise,
    independent,
)
from tests.support.measured_files import (
    STEEL,
    TRUTHS,
    campaign_of_table,
    measured_campaign,
    user_campaign,
    with_columns,
    write_measured,
)
from tests.support.spec_files import golden

LEVEL = 0.95
NOISE = 0.03


def descended(problem, start, noise="constant"):
    """The optimum next to a start, and the noise there, of this kind if it is not given."""
    point, _ = problem.minimise(np.array(start, dtype=float))
    if not problem.noise.is_given:
        problem = problem.estimating(NoiseModel(noise=noise), point)
        point, _ = problem.minimise(point)
    return point, Optimum(problem, point)


# --- certified values -------------------------------------------------------------------------

# NIST Statistical Reference Datasets, nonlinear regression (National Institute of Standards and
# Technology, public domain): data, certified parameters and standard deviations, residual sum of
# squares, and the second of NIST's starts.
NIST = golden("nist")
NIST_MODELS = {
    "Misra1a": lambda x, b1, b2: b1 * (1 - np.exp(-b2 * x)),
    "Thurber": lambda x, b1, b2, b3, b4, b5, b6, b7: (
        (b1 + b2 * x + b3 * x**2 + b4 * x**3) / (1 + b5 * x + b6 * x**2 + b7 * x**3)
    ),
    "MGH09": lambda x, b1, b2, b3, b4: b1 * (x**2 + x * b2) / (x**2 + x * b3 + b4),
}


@dataclass(frozen=True)
class Curve:
    """A law that only knows the penetration, at loads of any sign."""

    model: object
    values: dict
    name: str = "curve"

    def penetration(self, load, _):
        return self.model(load, **self.values)


def curve_problem(campaign, model, x, y, low, high):
    """A regression of y on x by the machinery that fits laws."""
    names = [f"b{k + 1}" for k in range(len(low))]
    parameters = tuple(Parameter(name, *ends) for name, *ends in zip(names, low, high, strict=True))
    law = LawModel("curve", "internal", parameters, lambda actual: Curve(model, dict(actual)))
    x, y = np.array(x, dtype=float), np.array(y, dtype=float)
    data = campaign.data.take(np.zeros(x.size, dtype=int))
    data = with_columns(data, load=x, penetration=y)
    return Fit(law, parameters, data, independent(data))


@pytest.mark.parametrize("name", NIST_MODELS)
def test_nist_certified_values_and_standard_deviations(tmp_path, name):
    dataset = NIST[name]
    certified = np.array(dataset["certified"])
    low, high = certified - 20 * abs(certified), certified + 20 * abs(certified)
    problem = curve_problem(
        measured_campaign(tmp_path), NIST_MODELS[name], dataset["x"], dataset["y"], low, high
    )
    point, noise = descended(problem, dataset["start"])
    assert point == pytest.approx(certified, rel=1e-7)
    assert np.sqrt(np.diag(noise.covariance)) == pytest.approx(dataset["errors"], rel=1e-5)
    assert (noise.differences**2).sum() == pytest.approx(dataset["squares"], rel=1e-9)
    assert noise.degrees == len(dataset["x"]) - certified.size
    sigma = np.sqrt(dataset["squares"] / noise.degrees)
    assert noise.fit.noise.deviations["constant"] == pytest.approx(sigma, rel=1e-6)


# --- peers ------------------------------------------------------------------------------------


def best_of(campaign):
    """The optimum of a campaign."""
    fit = fit_with_noise(campaign)
    truth = fit.point(TRUTHS[campaign.model.law, campaign.model.contact])
    point, _ = fit.minimise(truth)
    return Optimum(fit.at_best(point), point)


def johnson_of(coefficients):
    """Johnson's law with its own constants, and no rig."""
    model = MODELS["johnson", "internal"]
    return model.build({name: coefficients[name] for name in model.names})


def in_mm(campaign):
    """The same campaign with constant noise."""
    return replace(campaign, noise=NoiseModel(noise="constant"))


@pytest.fixture(scope="module")
def noisy(tmp_path_factory):
    return best_of(measured_campaign(tmp_path_factory.mktemp("noisy"), noise=NOISE))


@pytest.mark.slow
def test_iminuit_agrees_on_errors_and_profiles_with_known_deviations(noisy):
    import iminuit

    problem, best = noisy.fit, noisy.best
    data = problem.data
    known = replace(problem, noise=independent(data, NOISE * data.penetration))
    names = [p.name for p in known.free]

    def chi_square(values):
        return len(data) * known.value(np.array(values)) ** 2

    chi_square.errordef = iminuit.Minuit.LEAST_SQUARES
    minuit = iminuit.Minuit(chi_square, known.point(best), name=names)
    minuit.tol = 1e-4
    minuit.strategy = 2
    minuit.migrad()
    minuit.hesse()
    minuit.minos(cl=LEVEL)
    point, noise = descended(known, known.point(best))
    assert point == pytest.approx(np.array(minuit.values), rel=1e-4)
    # Minuit takes all second derivatives; without those of the law the errors are Gauss-Newton's.
    assert np.diag(noise.covariance) ** 0.5 == pytest.approx(np.array(minuit.errors), rel=0.02)
    for name in names:
        actual = noise.interval(name, LEVEL)
        merror = minuit.merrors[name]
        assert actual.low == pytest.approx(minuit.values[name] + merror.lower, rel=1e-3)
        assert actual.high == pytest.approx(minuit.values[name] + merror.upper, rel=1e-3)


def test_lmfit_agrees_on_errors_correlation_and_profiles(tmp_path):
    import lmfit

    noisy = best_of(in_mm(measured_campaign(tmp_path, noise=NOISE)))
    problem, best = noisy.fit, noisy.best
    names = [p.name for p in problem.free]

    def residuals(parameters):
        point = np.array([parameters[name].value for name in names])
        return problem.raw(point[None, :])[0]

    parameters = lmfit.Parameters()
    for name in names:
        parameters.add(name, value=best[name])
    fitter = lmfit.Minimizer(residuals, parameters)
    actual = fitter.minimize()
    ends = lmfit.conf_interval(fitter, actual, sigmas=[LEVEL])
    mine = Optimum(problem, problem.point(best))
    estimates, _ = findings.estimates_of(mine, LEVEL)
    # With one kind of scatter the degrees of freedom are N − k.
    assert mine.degrees_of_each() == pytest.approx(actual.nfree, rel=1e-3)
    for name in names:
        estimate = estimates[name]
        assert estimate.value == pytest.approx(actual.params[name].value, rel=1e-6)
        assert estimate.standard_error == pytest.approx(actual.params[name].stderr, rel=1e-3)
        (_, low), _, (_, high) = ends[name]
        assert estimate.low == pytest.approx(low, rel=2e-4)
        assert estimate.high == pytest.approx(high, rel=2e-4)
    assert findings.correlation_of(mine)[0, 1] == pytest.approx(
        actual.params[names[0]].correl[names[1]], abs=1e-4
    )
    assert np.sqrt(actual.redchi) == pytest.approx(1.0, rel=1e-3)  # in standard deviations


# --- profiles ---------------------------------------------------------------------------------


def test_an_interval_that_the_data_leave_open_ends_at_the_bound(tmp_path):
    bounds = {"clearance_factor": [0.5, 2.0]}
    campaign = in_mm(measured_campaign(tmp_path, "liu", noise=NOISE, bounds=bounds, starts=1))
    actual = fit_table(campaign)
    ends = actual.estimates["clearance_factor"]
    assert (ends.low, ends.low_is_bound, ends.high, ends.high_is_bound) == (0.5, True, 2.0, True)
    assert actual.estimates["clearance_factor"].verdict in ("not", "at a bound")
    assert abs(actual.correlations.loc["stiffness_factor", "clearance_factor"]) > 0.99
    assert any("correlation" in sentence for sentence in actual.notes)


def test_an_interval_ends_where_the_law_is_undefined_with_the_refit_before(tmp_path):
    # With PEEK for steel the stiffness ends at its bound, and the offset takes up all of the
    # smallest reading: at the stiffness of one refit the law has no logarithm at the offset of the
    # one before.
    table = write_measured(tmp_path / "measured.csv", "johnson", "internal")
    peek = {"R_i_mm": 10.0, "material_j": "PEEK", "material_i": "low-carbon steel"}
    result = fit_table(campaign_of_table(table, "johnson", "internal", peek, starts=1))
    ends = result.estimates["stiffness_factor"]
    assert (ends.high, ends.high_is_bound, ends.low_is_bound) == (20.0, True, False)
    optimum = result.optimum
    held = optimum.fit.fixing(stiffness_factor=ends.low)
    _, lowest = held.minimise(held.point(optimum.best))
    limit = optimum.limits(LEVEL, "stiffness_factor")[0]
    assert optimum.rise(np.array([lowest]))[0] == pytest.approx(limit, rel=1e-3)


def test_parameters_that_act_only_together_are_named(tmp_path):
    bounds = {"Lambda_factor": [0.1, 10.0]}
    campaign = measured_campaign(tmp_path, noise=NOISE, bounds=bounds, starts=1)
    result = fit_table(campaign)
    assert set(result.optimum.unidentifiable) == {"c", "Lambda_factor"}
    verdicts = {name: result.estimates[name].verdict for name in result.free}
    assert (verdicts["c"], verdicts["Lambda_factor"]) == ("not", "not")
    assert "c and Lambda_factor are not identifiable" in result.warnings[0]
    # The stiffness keeps its interval, which is that of a fit with one of the two fixed.
    fixed = fit_table(measured_campaign(tmp_path, noise=NOISE, starts=1))
    for end in ("low", "high"):
        actual, expected = (getattr(r.estimates["stiffness_factor"], end) for r in (result, fixed))
        assert actual == pytest.approx(expected, rel=1e-3)
    assert "not identifiable" in str(result)
    # So does what follows from both together.
    pair = CylinderPair.from_dR("internal", 0.3, STEEL, R_i=10.0)
    bands = [r.optimum.band(pair, LEVEL, load=[1.0]) for r in (result, fixed)]
    assert np.ravel(bands[0]) == pytest.approx(np.ravel(bands[1]), rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 2])
def test_an_interval_does_not_end_at_its_estimate_because_another_is_at_its_bound(seed):
    pair = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)
    load = np.geomspace(10.0, 1000.0, 24)
    scatter = 1 + 0.01 * np.random.default_rng(seed).normal(size=24)
    depth = 1e3 * laws.Explicit().penetration(load, pair) * scatter
    frame = pd.DataFrame({"load_N_per_mm": load, "penetration_um": depth})
    result = cc.fit(frame, "explicit", pair, free=["c", "A", "B"], starts=3)
    assert result.estimates["B"].verdict == "at a bound"
    stiffness = result.estimates["stiffness_factor"]
    assert stiffness.low < stiffness.value < 1 < stiffness.high


# --- bands ------------------------------------------------------------------------------------


def test_a_band_of_a_new_reading_is_that_of_students_t(noisy):
    pair = CylinderPair.from_dR("internal", 0.3, STEEL, R_i=10.0)
    band = noisy.band(pair, LEVEL, load=[50.0])
    _, slopes = noisy.slopes_of(lambda law: law.penetration(np.array([50.0]), pair))
    reach = stats.t.ppf(0.975, noisy.satterthwaite(slopes))
    value = johnson_of(noisy.best).penetration(50.0, pair)
    assert band.value == pytest.approx(value, rel=1e-12)
    curve, noise = (band.high - band.low) / (2 * reach), noisy.fit.noise.deviations
    scatter = np.hypot(noise["constant"], noise["proportional"] * value)
    assert band.new_high - band.value == pytest.approx(reach * np.hypot(curve, scatter), rel=1e-9)


# --- what the noise says ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (1.0, "as large as the given standard deviations allow"),
        (0.3, "larger than the given standard deviations allow: the law is wrong"),
        (5.0, "those look too large"),
    ],
)
def test_given_deviations_are_held_against_the_residuals(noisy, size, words):
    data = noisy.fit.data
    known = replace(noisy.fit, noise=independent(data, size * NOISE * data.penetration))
    actual = descended(known, known.point(noisy.best))[1]
    estimates, _ = findings.estimates_of(actual, LEVEL)
    sentences = [*findings.warnings_of(actual, estimates), *findings.notes_of(actual, LEVEL, [])]
    assert words in sentences[0]
    degrees = actual.degrees
    expected = stats.chi2.sf(actual.sum_of_squares, degrees)
    assert actual.chi_square_p == pytest.approx(expected, rel=1e-6)


def test_an_effect_is_the_relative_change_of_the_prediction(tmp_path):
    noise = best_of(in_mm(measured_campaign(tmp_path, noise=NOISE)))
    data, step = noise.fit.data, 1e-6
    before, after = (
        johnson_of(noise.best | {"c": noise.best["c"] + sign * step}).penetration(
            data.load, data.pair
        )
        for sign in (-1, 1)
    )
    size = np.sqrt(np.mean(data.penetration**2))
    change = np.sqrt(np.mean((after - before) ** 2)) / size / (2 * step)
    assert noise.per_unit == pytest.approx([1 / noise.best["stiffness_factor"], change], rel=1e-5)


@pytest.mark.slow
def test_a_profile_says_when_it_finds_a_better_fit(noisy):
    problem, best = noisy.fit, noisy.best
    short = problem.fixing(stiffness_factor=best["stiffness_factor"] / 1.02)
    point, _ = descended(short, short.point(best))
    above = Optimum(problem, problem.point(short.coefficients(point)))
    assert above.interval("c", LEVEL).lowest < -1e-3
    _, better = findings.estimates_of(above, LEVEL)
    assert "the profile of c found a better fit" in " ".join(better)
    assert findings.estimates_of(noisy, LEVEL)[1] == []


# --- a law of one's own -----------------------------------------------------------------------


@pytest.mark.slow
def test_a_law_of_ones_own_is_run_again_only_if_it_is_named(tmp_path, monkeypatch, run):
    fit_table(user_campaign(tmp_path)).save(tmp_path / "r.json")
    monkeypatch.chdir(tmp_path)
    load = ("predict", "r.json", "--load", "5 N/mm")
    assert "never run from a stored result" in run(*load)[2]
    assert run(*load, "--law", "mine:load")[0] == 0
    assert "is not the law of this fit, mine:load" in run(*load, "--law", "mine:flat")[2]
