"""Fit a law to readings: descend from several starts, and say how sure the coefficients are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.datasets.measurements import Constants
from cylcontact.files.journal import Journal
from cylcontact.fitting.diagnose import LEVEL, uncertainty_of
from cylcontact.fitting.measured import singular
from cylcontact.fitting.optimum import Optimum
from cylcontact.fitting.records import MaxDifference, ObjectiveValue, SampleCounts
from cylcontact.fitting.results import DataFit
from cylcontact.fitting.runs import best_of, descend_from, published_on, run_all
from cylcontact.fitting.table_campaign import TableCampaign, require_increasing, table_of
from cylcontact.laws.law import ContactLaw
from cylcontact.support.parallel import Workers, call
from cylcontact.support.progress import Progress, silent

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
        If the law is undefined for some of the data, or `checkpoint` belongs to another campaign.
    """
    try:
        return _fitted(campaign, jobs, progress, checkpoint, resume)
    except np.linalg.LinAlgError as error:
        raise singular(campaign.source) from error


def _fitted(
    campaign: TableCampaign,
    jobs: Workers,
    progress: Progress,
    checkpoint: Path | None,
    resume: bool,
) -> DataFit:
    spec = campaign.spec
    if isinstance(jobs, int) and len(campaign.measurements) <= _FEW_ROWS:
        jobs = 1
    provenance = campaign.provenance  # of what is run, not of what is there when it ends
    fit = campaign.fit()
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    starts = fit.starts(campaign.nominal, spec.starts, spec.seed)
    calls = [call(descend_from, fit, start, k, spec.seed) for k, start in enumerate(starts)]
    records = run_all(calls, jobs, progress, journal, resume)
    best, published = best_of(records), published_on(fit)
    fit = fit.at_best(best.coefficients)
    require_increasing(fit, best.coefficients)
    optimum = Optimum.of(fit, best.coefficients)
    progress("profiling", 0, 1)
    uncertainty = uncertainty_of(optimum, spec.level or LEVEL, jobs)
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


def _largest_percent(campaign: TableCampaign, law: ContactLaw) -> float | None:
    """Return the largest difference from the measurements in percent; None if undefined."""
    data = campaign.measurements
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(law.penetration(data.load, data.pair) / data.penetration - 1)
    finite = ratio[np.isfinite(ratio)]  # a reading may be 0
    return float(100 * finite.max()) if finite.size else None


def fit(
    data: pd.DataFrame | Path | str,
    law: str,
    pair: CylinderPair | None = None,
    *,
    contact: Contact | None = None,
    constants: Constants | None = None,
    free: Sequence[str] | str = (),
    fixed: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    ties: Mapping[str, str] | None = None,
    level: float = LEVEL,
    jobs: Workers = 1,
    **settings: Any,
) -> DataFit:
    """Fit a law to measurements.

    Parameters
    ----------
    data : DataFrame or path
        Columns of loads and penetrations with their units, such as load_N and penetration_um, and
        of whatever differs from row to row: dR_um, E_GPa, material, ….
    law : str
        Its name, or module:function for one of your own.
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
        Parameters to hold at a value.
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
        ignore, sheet, header, decimal, loads, sign, objective, materials, starts, seed, name.

    Returns
    -------
    DataFit

    Raises
    ------
    InputError
        If the data or a setting is invalid, or the law is undefined for some of the data.

    Examples
    --------
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
    settings["free"] = ((free,) if isinstance(free, str) else tuple(free)) or None
    settings["ties"] = dict(ties) if ties else None
    settings["level"] = level
    table = table_of(data, law, pair, contact, constants, fixed, bounds, **settings)
    return fit_table(table.campaign(law), jobs)
