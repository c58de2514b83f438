"""Fits to a table of measurements: the problem of a campaign, and descents from several starts."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.fitting.campaign import Campaign, TableData, measured_of
from cylcontact.fitting.least_squares import descend, starting_points
from cylcontact.fitting.loss import TUNING, Loss
from cylcontact.fitting.measured_objective import MeasuredObjective, measured
from cylcontact.fitting.noise_fit import fit_noise
from cylcontact.fitting.noise_model import NoiseModel
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.records import RunRecord
from cylcontact.fitting.uncertainty.residual_model import MEDIAN_TO_SIGMA
from cylcontact.laws.adapters import RigCompliance, ScaledLaw
from cylcontact.laws.law import Coefficients, ContactLaw
from cylcontact.laws.user import UserLaw
from cylcontact.parallel import Call, call

__all__ = [
    "descents",
    "largest_percent",
    "measured_problem",
    "noise_model_of",
    "plain_problem",
    "require_increasing",
    "with_loss",
]

# Iterations for the scale of a robust loss.
_SCALE_ROUNDS = 5
# Penetrations at which a function of the user's own is looked at.
_LOOKS = 101
# Points evaluated before data are refused as outside a law's domain.
_TRIALS = 256


def plain_problem(campaign: Campaign) -> Problem:
    """Return the problem of a campaign on measurements, by plain least squares."""
    measurements, _ = measured_of(campaign)
    objective = MeasuredObjective(measurements, campaign.objective)
    return Problem(campaign.model, campaign.parameters, objective)


def measured_problem(campaign: Campaign) -> Problem:
    """Return the problem of a campaign on measurements, with its noise or robust loss.

    Raises
    ------
    InputError
        If the law is undefined for some row at all coefficients tried.
    """
    problem = plain_problem(campaign)
    _require_defined(problem, campaign)
    noise = noise_model_of(campaign)
    if noise is not None:
        return fit_noise(problem, noise, _best_of_starts(problem, campaign))
    return problem if measured_of(campaign)[1].loss == "linear" else _robust(problem, campaign)


def noise_model_of(campaign: Campaign) -> NoiseModel | None:
    """Return the noise model of a campaign on measurements."""
    return campaign.data.noise if isinstance(campaign.data, TableData) else None


def _best_of_starts(problem: Problem, campaign: Campaign) -> FloatArray:
    """Return the best point of descents from several starts."""
    _, spec = measured_of(campaign)
    starts = starting_points(problem, campaign.nominal, spec.starts, spec.seed)
    minima = [descend(problem, start)[:2] for start in starts]
    return min(minima, key=lambda pair: pair[1])[0]


def descents(campaign: Campaign, problem: Problem) -> list[Call]:
    """Return descents from several starts as calls, each of which returns its RunRecord."""
    _, spec = measured_of(campaign)
    starts = starting_points(problem, campaign.nominal, spec.starts, spec.seed)
    return [call(_run_from, problem, start, k, spec.seed) for k, start in enumerate(starts)]


def largest_percent(campaign: Campaign, law: ContactLaw) -> float | None:
    """Return the largest |Eq 9| against the measurements of a campaign, in percent.

    None if the law has no penetration at any of the loads.
    """
    measurements, _ = measured_of(campaign)
    seen = measurements.penetration
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(law.penetration(measurements.load, measurements.pair) / seen - 1)
    finite = ratio[np.isfinite(ratio)]  # a reading may be 0
    return float(100 * finite.max()) if finite.size else None


def with_loss(problem: Problem, loss: Loss) -> Problem:
    """Return a problem on measurements with another loss."""
    return replace(problem, objective=replace(measured(problem), loss=loss))


def require_increasing(problem: Problem, coefficients: Coefficients) -> None:
    """Refuse a function of the user's own that is no contact law at some coefficients.

    Raises
    ------
    InputError
        With the penetration where the load decreases, or is negative.
    """
    law, data = problem.model.build(coefficients), measured(problem).data
    if isinstance(law, RigCompliance):
        law = law.base
    function = law.base if isinstance(law, ScaledLaw) else law
    if not isinstance(function, UserLaw):
        return
    at = ", ".join(f"{name} = {value:.6g}" for name, value in function.values.items())
    with np.errstate(all="ignore"):
        deepest = np.fmax(data.penetration, law.penetration(data.load, data.pair))
    deepest = np.where(deepest > 0, deepest, np.abs(data.penetration).max())
    before = np.full(len(data), -np.inf)
    for share in np.linspace(0.0, 1.0, _LOOKS):
        loads = function.load(share * deepest, data.pair)
        wrong = np.flatnonzero((loads <= before) | ((loads < 0) & (share > 0)))
        if wrong.size:
            row = int(wrong[0])
            what = "decreases with" if loads[row] < before[row] else "does not grow with"
            if loads[row] < 0:
                what = f"is negative, {loads[row]:.6g} N/mm, at"
            rule = f"{what} the penetration at {share * deepest[row]:.6g} mm, with {at}"
            remedy = "the load of a contact grows from 0; correct the function, or move the bounds"
            raise InputError(function.name, "load", None, rule, remedy)
        before = np.where(np.isfinite(loads), loads, before)


def _run_from(problem: Problem, start: FloatArray, index: int, seed: int) -> RunRecord:
    """Descend from one start and return the record of the run."""
    began = time.perf_counter()
    before = problem.value(start)
    point, value, evaluations = descend(problem, start)
    return RunRecord(
        index=index,
        seed=seed,
        population=None,
        crossover=None,
        objective_before_polish=before,
        coefficients_before_polish=problem.coefficients(start),
        objective=value,
        coefficients=problem.coefficients(point),
        evaluations=evaluations,
        seconds=round(time.perf_counter() - began, 3),
    )


def _robust(problem: Problem, campaign: Campaign) -> Problem:
    """Return the problem with a robust loss and its scale.

    A scale that is not given is 1.345 times the standard deviation if that is known, else
    1.345 times the robust spread of the residuals, by a few iterations from a least-squares
    fit.
    """
    objective, (_, spec) = measured(problem), measured_of(campaign)
    if spec.loss_scale is not None or objective.has_sigma:
        return with_loss(problem, Loss(spec.loss, spec.loss_scale or TUNING))
    point = _best_of_starts(problem, campaign)
    for _ in range(_SCALE_ROUNDS):
        r = objective.raw(problem.form(point[None, :]))[0]
        spread = MEDIAN_TO_SIGMA * float(np.median(np.abs(r)))
        problem = with_loss(problem, Loss(spec.loss, max(TUNING * spread, 1e-12)))
        point = descend(problem, point)[0]
    return problem


def _require_defined(problem: Problem, campaign: Campaign) -> None:
    """Refuse data that no coefficients within the bounds can describe, and name the row."""
    unit = np.random.default_rng(0).uniform(size=(_TRIALS, len(problem.free)))
    points = problem.low + unit * (problem.high - problem.low)
    if campaign.nominal is not None:
        points = np.vstack([campaign.nominal, points])
    data = measured(problem).data
    defined = np.zeros(len(data), dtype=int)
    for point in points:
        inside = np.isfinite(measured(problem).raw(problem.form(point[None, :]))[0])
        if inside.all():
            return
        defined += inside
    row = int(np.argmin(defined))
    others = ", and other rows at the rest" if defined[row] else ""
    tried = f"{len(points) - defined[row]} of {len(points)} sets of" if defined[row] else "all"
    raise InputError(
        f"{campaign.source}, {data.data.row_word} {data.line(row)}",
        "load, penetration, dR",
        [float(data.columns[name][row]) for name in ("load", "penetration", "dR")],
        f"lies outside the domain of {campaign.model.law} at {tried} coefficients tried within the "
        f"bounds{others}",
        "move the bounds, remove the row, or choose a law that reaches that far",
    )
