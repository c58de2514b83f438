"""Fit a law to readings: descend from several starts, and say how sure the coefficients are."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from cylcontact.arrays import FloatArray
from cylcontact.fitting.estimates import uncertainty_of
from cylcontact.fitting.measured import Fit
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.fitting.optimum import Optimum
from cylcontact.fitting.records import MaxDifference, ObjectiveValue, RunRecord, SampleCounts
from cylcontact.fitting.results import DataFit
from cylcontact.fitting.runs import best_of, published_on, run_all, searches
from cylcontact.fitting.table_campaign import TableCampaign, require_increasing
from cylcontact.journal import Journal
from cylcontact.laws.law import ContactLaw
from cylcontact.parallel import Workers, call
from cylcontact.progress import Progress, silent

# Descents to so few measurements take less time than starting worker processes.
_FEW_ROWS = 2_000


def fit_table(
    campaign: TableCampaign,
    jobs: Workers = 1,
    progress: Progress = silent,
    checkpoint: Path | None = None,
    resume: bool = False,
) -> DataFit:
    """Fit a law to a table of measurements.

    Parameters
    ----------
    campaign : TableCampaign
        From `read_campaign` or `campaign_of_table`.
    jobs, progress, checkpoint, resume
        As for `calibrate`.

    Returns
    -------
    DataFit

    Raises
    ------
    InputError
        If the law is undefined for some of the data, the optimiser's library is missing, or
        `checkpoint` belongs to another campaign.
    """
    spec = campaign.spec
    if spec.optimizer is not None:
        OPTIMIZERS[spec.optimizer].require_installed(campaign.source, spec.optimizer)
    elif isinstance(jobs, int) and len(campaign.measurements) <= _FEW_ROWS:
        jobs = 1
    provenance = campaign.provenance  # of what is run, not of what is there when it ends
    fit = campaign.fit()
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    if spec.optimizer is None:
        starts = fit.starts(campaign.nominal, spec.starts, spec.seed)
        calls = [call(_run_from, fit, start, k, spec.seed) for k, start in enumerate(starts)]
    else:
        calls = searches(fit, spec.optimizer, spec.genetic, spec.seed, campaign.source)
    records = run_all(calls, jobs, progress, journal, resume)
    best, published = best_of(records), published_on(fit)
    fit = fit.at_best(best.coefficients)
    require_increasing(fit, best.coefficients)
    optimum = Optimum.of(fit, best.coefficients)
    progress("profiling", 0, 1)
    uncertainty = uncertainty_of(optimum, jobs=jobs)
    progress("profiling", 1, 1)
    law_of = campaign.model.build
    return DataFit(
        name=campaign.name,
        law=campaign.model.law,
        contact=campaign.model.contact,
        reference=campaign.reference,
        coefficients=best.coefficients,
        objective=ObjectiveValue(name=campaign.objective, value=best.objective),
        published=published,
        max_abs_diff_percent=MaxDifference(
            fitted=_largest_percent(campaign, law_of(best.coefficients)),
            published=_largest_percent(campaign, law_of(published.coefficients))
            if published
            else None,
        ),
        runs=records,
        counts=SampleCounts(samples=len(campaign.measurements), masked=0),
        settings=campaign.settings,
        provenance=provenance,
        uncertainty=uncertainty,
    ).with_optimum(optimum)


def _run_from(fit: Fit, start: FloatArray, index: int, seed: int) -> RunRecord:
    """Descend from one start and return the record of the run."""
    began = time.perf_counter()
    before = fit.value(start)
    with threadpool_limits(limits=1):  # matrices this small are slower on several threads
        point, value, evaluations = fit.minimise(start)
    return RunRecord(
        index=index,
        seed=seed,
        population=None,
        crossover=None,
        objective_before_polish=before,
        coefficients_before_polish=fit.coefficients(start),
        objective=value,
        coefficients=fit.coefficients(point),
        evaluations=evaluations,
        seconds=round(time.perf_counter() - began, 3),
    )


def _largest_percent(campaign: TableCampaign, law: ContactLaw) -> float | None:
    """Return the largest |Eq 9| against the measurements in percent; None if undefined."""
    data = campaign.measurements
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(law.penetration(data.load, data.pair) / data.penetration - 1)
    finite = ratio[np.isfinite(ratio)]  # a reading may be 0
    return float(100 * finite.max()) if finite.size else None
