"""Fit a law to measurements: descend from several starts, take the best, and its uncertainty."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.fitting.least_squares import descend, run_from, starting_points
from cylcontact.fitting.loss import TUNING, Loss
from cylcontact.fitting.measured_campaign import MeasuredCampaign
from cylcontact.fitting.measured_objective import MeasuredObjective
from cylcontact.fitting.optimizers import require_installed
from cylcontact.fitting.planning import provenance
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.result import (
    FitResult,
    MaxDifference,
    ObjectiveValue,
    Published,
    SampleCounts,
)
from cylcontact.fitting.run import RunRecord, execute, plan_runs
from cylcontact.fitting.uncertainty.estimates import uncertainty_of
from cylcontact.fitting.uncertainty.residual_model import MEDIAN_TO_SIGMA, measured
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.parallel import Workers, call, run_calls
from cylcontact.progress import Progress, silent

__all__ = ["fit_measurements", "robust_problem"]

# Iterations for the scale of a robust loss.
_SCALE_ROUNDS = 5
# Points evaluated before data are refused as outside a law's domain.
_TRIALS = 256


def fit_measurements(
    campaign: MeasuredCampaign, jobs: Workers = 1, progress: Progress = silent
) -> FitResult:
    r"""Fit a law to measurements.

    Parameters
    ----------
    campaign : MeasuredCampaign
        From `read_campaign` or `campaign_of_table`.
    jobs : int or Cluster
        Worker processes, or a Dask cluster; the result does not depend on it.
    progress : callable, optional
        Called with the stage, how many of its parts are done, and their number.

    Returns
    -------
    FitResult
        Of kind "noise", with its uncertainty.

    Raises
    ------
    InputError
        If the law is undefined for some row at every point tried.

    Examples
    --------
    Points of Johnson's law with 1 % noise recover its constants, within their errors:

    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> import cylcontact as cc
    >>> from cylcontact.fitting.measured_campaign import campaign_of_table
    >>> steel = cc.Material("steel", E=207e3, nu=0.3)
    >>> pair = cc.CylinderPair.from_dR("internal", 0.05, steel)
    >>> load = np.geomspace(1, 1000, 40)
    >>> noise = np.exp(0.01 * np.random.default_rng(1).normal(size=40))
    >>> depth = cc.laws.Johnson().penetration(load, pair) * noise
    >>> table = Path(mkdtemp()) / "measured.csv"
    >>> rows = "".join(f"{f},{1e3 * d}\n" for f, d in zip(load, depth))
    >>> _ = table.write_text("load_N_per_mm,penetration_um\n" + rows)
    >>> constants = {"E_GPa": 207.0, "nu": 0.3, "dR_um": 50.0}
    >>> result = fit_measurements(campaign_of_table(table, "johnson", "internal", constants))
    >>> kappa = result.uncertainty.estimates["kappa"]
    >>> print(f"{kappa.value:.3f} from {kappa.low:.3f} to {kappa.high:.3f}")
    1.001 from 0.992 to 1.010
    """
    problem = robust_problem(campaign)
    runs = _runs(problem, campaign, jobs, progress)
    best = min(runs, key=lambda run: (run.objective, run.index))
    published = campaign.model.published
    value = None if published is None else problem.value_of(published)
    usable = published is not None and value is not None and np.isfinite(value)
    law = campaign.model.build(best.coefficients)
    nominal = campaign.model.build(published) if published is not None and usable else None
    progress("profiling", 0, 1)
    uncertainty = uncertainty_of(problem, best.coefficients, jobs=jobs)
    progress("profiling", 1, 1)
    return FitResult(
        name=campaign.name,
        kind="noise",
        law=campaign.model.law,
        contact=campaign.model.contact,
        reference="measurements",
        coefficients=best.coefficients,
        objective=ObjectiveValue(name=campaign.objective, value=best.objective),
        bound=None,
        published=Published(coefficients=dict(published), objective=value)
        if published is not None and value is not None and usable
        else None,
        max_abs_diff_percent=MaxDifference(
            fitted=_largest_percent(campaign, law),
            published=None if nominal is None else _largest_percent(campaign, nominal),
        ),
        profiles={},
        runs=runs,
        counts=SampleCounts(samples=len(campaign.measurements), masked=0),
        uncertainty=uncertainty,
        settings=campaign.settings,
        provenance=provenance(campaign),
    )


def robust_problem(campaign: MeasuredCampaign) -> Problem:
    """Return the problem of a campaign, with the scale of a robust loss.

    A scale that is not given is 1.345 times the standard deviation if that is known, else 1.345
    times the robust spread of the residuals, by a few iterations from a least-squares fit.
    """
    problem = campaign.problem()
    _require_defined(problem, campaign)
    spec = campaign.spec
    if spec.loss == "linear":
        return problem
    objective = measured(problem)
    if spec.loss_scale is not None or objective.has_sigma:
        return _with_loss(problem, Loss(spec.loss, spec.loss_scale or TUNING))
    starts = starting_points(problem, campaign.nominal, spec.starts, spec.seed)
    minima = [descend(problem, start)[:2] for start in starts]
    point = min(minima, key=lambda pair: pair[1])[0]
    for _ in range(_SCALE_ROUNDS):
        r = objective.raw(problem.form(point[None, :]))[0]
        spread = MEDIAN_TO_SIGMA * float(np.median(np.abs(r)))
        problem = _with_loss(problem, Loss(spec.loss, max(TUNING * spread, 1e-12)))
        point = descend(problem, point)[0]
    return problem


def _require_defined(problem: Problem, campaign: MeasuredCampaign) -> None:
    """Refuse data that no coefficients within the bounds can describe, and name the row."""
    unit = np.random.default_rng(0).uniform(size=(_TRIALS, len(problem.free)))
    points = problem.low + unit * (problem.high - problem.low)
    if campaign.nominal is not None:
        points = np.vstack([campaign.nominal, points])
    data = campaign.measurements
    defined = np.zeros(len(data), dtype=int)
    for point in points:
        inside = np.isfinite(measured(problem).raw(problem.form(point[None, :]))[0])
        if inside.all():
            return
        defined += inside
    row = int(np.argmin(defined))
    raise InputError(
        f"{campaign.source}, {data.data.row_word} {data.line(row)}",
        "load, penetration, dR",
        [float(data.columns[name][row]) for name in ("load", "penetration", "dR")],
        f"lies outside the domain of {campaign.model.law} for all coefficients tried within the "
        "bounds",
        "move the bounds, remove the row, or choose a law that reaches that far",
    )


def _with_loss(problem: Problem, loss: Loss) -> Problem:
    """Return the problem with another loss."""
    objective = measured(problem)
    return replace(problem, objective=MeasuredObjective(objective.data, objective.name, loss))


def _runs(
    problem: Problem, campaign: MeasuredCampaign, jobs: Workers, progress: Progress
) -> list[RunRecord]:
    """Run from every start, or with the optimiser of the campaign."""
    spec = campaign.spec
    if spec.optimizer is not None:
        require_installed(spec.optimizer, campaign.source)
        plans = plan_runs(
            spec.genetic.runs,
            spec.genetic.populations,
            spec.genetic.crossovers,
            spec.genetic.generations,
            spec.seed,
            spec.optimizer,
        )
        calls = [call(execute, problem, plan, campaign.source) for plan in plans]
    else:
        starts = starting_points(problem, campaign.nominal, spec.starts, spec.seed)
        calls = [call(run_from, problem, start, k, spec.seed) for k, start in enumerate(starts)]
    runs: list[RunRecord] = []
    progress("searching", 0, len(calls))
    with closing(run_calls(calls, jobs)) as results:
        for run in results:
            runs.append(run)
            progress("searching", len(runs), len(calls))
    return runs


def _largest_percent(campaign: MeasuredCampaign, law: ContactLaw) -> float:
    """Return the largest |Eq 9| against the measurements, in percent."""
    data = campaign.measurements
    predicted: FloatArray = law.penetration(data.load, data.pair)
    ratio = predicted / data.penetration - 1
    return float(100 * np.nanmax(np.abs(ratio))) if np.isfinite(ratio).any() else 0.0
