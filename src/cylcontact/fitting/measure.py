"""Fit a law to a table of readings: descend, find intervals, test the noise, and report.

table, pair, law, options
→ `read_table`        MeasuredTable: checked readings and the settings of a fit
→ `.campaign`         Campaign: the law, its parameters and the noise
→ `fit_and_starts`    Fit: free parameters and residuals, with the noise estimated
→ `fit_table`         descends from several starts, and finds intervals and tests
→ `DataFit`           the result
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.datasets.measurements import Constants
from cylcontact.files.journal import Journal
from cylcontact.fitting import findings
from cylcontact.fitting.campaign import Campaign, read_table
from cylcontact.fitting.data_fit import DataFit
from cylcontact.fitting.parameters import LawModel
from cylcontact.fitting.readings import (
    Optimum,
    agree,
    fit_and_starts,
    measurements_in,
    require_increasing,
    singular,
)
from cylcontact.fitting.records import (
    Estimate,
    MaxDifference,
    ObjectiveValue,
    Published,
    RunRecord,
    SampleCounts,
)
from cylcontact.fitting.results import on_runs
from cylcontact.fitting.runs import best_of, descend_from, published_on, run_all
from cylcontact.fitting.specs import MeasuredSpec
from cylcontact.support.parallel import Workers, call
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

# Descents to so few measurements take less time than starting worker processes.
_FEW_ROWS = 200_000


def fit_table(
    campaign: Campaign,
    jobs: Workers = 1,
    progress: Progress = silent,
    checkpoint: Path | None = None,
    resume: bool = False,
) -> DataFit:
    """Fit a law to a table of measurements.

    Parameters
    ----------
    campaign : Campaign
        On measurements, from `Campaign.read`.
    jobs, progress, checkpoint, resume
        As for `calibrate`.

    Returns
    -------
    DataFit

    Raises
    ------
    InputError
        If the law is undefined for some of the data, or `checkpoint` belongs to another campaign.
    """
    try:
        return _fitted(campaign, jobs, progress, checkpoint, resume)
    except np.linalg.LinAlgError as error:
        raise singular(campaign.source) from error


def _fitted(
    campaign: Campaign,
    jobs: Workers,
    progress: Progress,
    checkpoint: Path | None,
    resume: bool,
) -> DataFit:
    spec, data = campaign.spec, measurements_in(campaign)
    assert isinstance(spec, MeasuredSpec)
    if isinstance(jobs, int) and len(data) <= _FEW_ROWS:
        jobs = 1
    provenance = campaign.provenance  # of what is run, not of what is there when it ends
    fit, starts = fit_and_starts(campaign)
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    calls = [call(descend_from, fit, start, k, spec.seed) for k, start in enumerate(starts)]
    # Where two starts agree, the others do.
    records = run_all(calls[:2], RunRecord, jobs, progress, journal, resume)
    if not agree([record.objective for record in records]):
        records = run_all(calls, RunRecord, jobs, progress, journal, resume or journal is not None)
    point = fit.point(best_of(records).coefficients)
    optimum = Optimum(fit.at_best(point), point)
    require_increasing(fit, point)
    progress("profiling", 0, 1)
    level = spec.level or findings.LEVEL
    searched, better = findings.estimates_of(optimum, level, jobs)
    progress("profiling", 1, 1)
    published = published_on(fit)
    warnings, notes = _sentences(optimum, searched, better, records, published, level)
    return DataFit(
        name=campaign.name,
        law=campaign.model.law,
        contact=campaign.model.contact,
        formula=campaign.model.formula,
        reference=campaign.reference,
        estimates=_estimates(campaign, searched, optimum.best),
        objective=ObjectiveValue(
            name=campaign.objective, value=best_of(records).objective, unit="std. dev."
        ),
        published=published,
        max_abs_diff_percent=_largest_percent(optimum, campaign.model, published),
        runs=records,
        counts=SampleCounts(samples=len(data), masked=0),
        warnings=warnings,
        notes=notes,
        settings=campaign.settings,
        provenance=provenance,
        level=level,
        degrees_of_freedom=optimum.degrees,
        is_rounding=optimum.is_rounding,
        chi_square_p=optimum.chi_square_p,
        correlation=findings.correlation_of(optimum).tolist(),
        outliers=[data.line(row) for row in findings.outliers(optimum)],
        noise=findings.deviations_of(optimum),
        log_likelihood=optimum.log_likelihood,
        estimated=optimum.estimated,
        r_squared=findings.r_squared(optimum),
    ).with_optimum(optimum)


def _estimates(
    campaign: Campaign, searched: Mapping[str, Estimate], best: Mapping[str, float]
) -> dict[str, Estimate]:
    """Return all coefficients: those that were searched, and the fixed and the tied ones."""
    estimates = {}
    for p in campaign.parameters:
        said = f"= {p.tie}" if p.tie else "fixed"
        known = Estimate(value=best[p.name], unit=p.unit, verdict=said)
        estimates[p.name] = searched.get(p.name, known)
    return estimates


def _sentences(
    optimum: Optimum,
    searched: Mapping[str, Estimate],
    better: Sequence[str],
    records: Sequence[RunRecord],
    published: Published | None,
    level: float,
) -> tuple[list[str], list[str]]:
    """Return the warnings and the notes of a report."""
    undetermined = findings.on_lack_of_determination(optimum, searched)
    disagreement, agreement = on_runs(records, DataFit.round_off, (), "--fix NAME=VALUE", "starts")
    warnings = [*findings.warnings_of(optimum, searched), *undetermined, *disagreement]
    of_data = optimum.fit.data.data.notes
    notes = [*findings.notes_of(optimum, level, undetermined), *better, *of_data]
    if published is not None and not optimum.is_rounding:
        notes.append(
            "with the published constants of the law the residuals are "
            f"{published.objective / best_of(records).objective:.3g} times as large (root mean "
            "square, in standard deviations)"
        )
    return warnings, [*notes, *agreement]


def _largest_percent(
    optimum: Optimum, model: LawModel, published: Published | None
) -> MaxDifference:
    """Return the largest differences from the measurements in percent; None if undefined."""
    data = optimum.fit.data
    laws = {"fitted": optimum.law}
    if published is not None:
        laws["published"] = model.build(published.coefficients)
    largest: dict[str, float | None] = dict.fromkeys(("fitted", "published"))
    if data.penetration.min() > 0:  # about zero a relative difference says nothing
        for name, law in laws.items():
            with np.errstate(divide="ignore", invalid="ignore"):
                ratio = np.abs(law.penetration(data.load, data.pair) / data.penetration - 1)
            finite = ratio[np.isfinite(ratio)]
            largest[name] = float(100 * finite.max()) if finite.size else None
    return MaxDifference(**largest)


def fit(
    data: pd.DataFrame | Path | str | Sequence[pd.DataFrame | Path | str],
    law: str,
    pair: CylinderPair | None = None,
    *,
    contact: Contact | None = None,
    constants: Constants | None = None,
    free: Sequence[str] | str = (),
    fixed: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    ties: Mapping[str, str] | None = None,
    level: float = findings.LEVEL,
    jobs: Workers = 1,
    **settings: Any,
) -> DataFit:
    """Fit a law to measurements.

    Parameters
    ----------
    data : DataFrame or path, or a list of them
        Columns of loads and penetrations with their units, such as load_N and penetration_um, and
        of whatever differs from row to row: dR_um, E_GPa, material, …. Several tables are fitted
        together, each in its own units; group="file" takes each as a series.
    law : str
        Its name, or module:function for your own.
    pair : CylinderPair, optional
        The two cylinders, if they are the same in all rows.
    contact : {"internal", "external"}, optional
        Without a pair, a pin in a hole or two rollers.
    constants : mapping, optional
        Values for all rows by column name, in place of a pair or beside it.
    free : str or sequence of str, optional
        Parameters to search beside the usual ones, with their default bounds: the constants of a
        law's shape, or the compliance of the rig.
    fixed : mapping of str to float, optional
        Known values of parameters, which are not searched.
    bounds : mapping of str to (low, high), optional
        Parameters to search between two values.
    ties : mapping of str to str, optional
        Parameters to set by an expression of others, such as "a/10".
    level : float, optional
        The level of the intervals, between 0 and 1.
    jobs : int or Cluster, optional
        Worker processes; the result does not depend on them.
    **settings
        Other keys of a campaign file: noise, group, drift, load_error, columns, branch,
        ignore, sheet, header, decimal, loads, sign, materials, starts, seed, name.

    Returns
    -------
    DataFit

    Raises
    ------
    InputError
        If the data or a setting is invalid, or the law is undefined for some of the data.

    Examples
    --------
    >>> import pandas as pd
    >>> import cylcontact as cc
    >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
    >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
    >>> load, noise = np.geomspace(10.0, 1000.0, 9), 1 + 0.01 * np.cos(np.arange(9))
    >>> depth = cc.laws.Explicit().penetration(load, pair) * noise
    >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": 1e3 * depth})
    >>> result = cc.fit(data, "explicit", pair)
    >>> print(result.to_frame().loc["stiffness_factor", ["value", "standard_error"]].to_dict())
    {'value': 1.0008..., 'standard_error': 0.0043...}
    """
    tables = {"fixed": fixed, "bounds": bounds, "ties": ties}
    settings |= {key: dict(table) for key, table in tables.items() if table}
    settings |= {"free": ((free,) if isinstance(free, str) else tuple(free)) or None}
    table = read_table(data, law, pair, contact, constants, level=level, **settings)
    return fit_table(table.campaign(law), jobs)
