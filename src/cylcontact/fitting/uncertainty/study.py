"""Study the uncertainty of a fit to measurements."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from cylcontact.errors import InputError
from cylcontact.fitting.campaign import campaign_from_settings
from cylcontact.fitting.law_models import user_model, with_rig
from cylcontact.fitting.loss import Loss
from cylcontact.fitting.measured_fit import (
    noise_model_of,
    plain_problem,
    require_increasing,
    with_loss,
)
from cylcontact.fitting.noise_fit import with_noise
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.bands import Band, bands_of_data
from cylcontact.fitting.uncertainty.estimates import LEVEL, Uncertainty, uncertainty_of
from cylcontact.fitting.uncertainty.profiles import PairMap, pair_map, pairs_of
from cylcontact.fitting.uncertainty.resampling import Bootstrap, LeftOut, bootstrap, leave_one_out
from cylcontact.fitting.uncertainty.residual_model import residual_model_at
from cylcontact.parallel import Workers, call, collect
from cylcontact.progress import Progress, silent
from cylcontact.spec import Spec

if TYPE_CHECKING:
    from cylcontact.fitting.result import FitResult

__all__ = ["NoiseStudy", "Resampling", "problem_of_result", "study_noise"]

# Levels of the contours of pairs.
_CONTOURS = (0.68, 0.95)


@dataclass(frozen=True)
class Resampling:
    """The options of the bootstrap.

    Attributes
    ----------
    replicates : int
        Refits.
    over : str
        What is resampled: rows, material, dR, pair or group.
    seed : int or None
        Of the resampling; by default that of the campaign.
    """

    replicates: int
    over: str = "rows"
    seed: int | None = None


class NoiseStudy(Spec):
    """The uncertainty of the coefficients of a fit to measurements."""

    name: str = Field(description="the fit's name")
    kind: Literal["noise"] = Field("noise", description="what the intervals are about")
    uncertainty: Uncertainty = Field(description="covariance, profiles and verdicts")
    pairs: list[PairMap] = Field(description="the likelihood over each pair of parameters")
    bootstrap: Bootstrap | None = Field(description="refits to resampled data")
    left_out: list[LeftOut] = Field(description="fits without one group")
    bands: list[Band] = Field(description="predictions with their bands")


def problem_of_result(result: FitResult, law: str | None = None) -> Problem:
    """Return the problem of a fit to measurements, from the result alone.

    Parameters
    ----------
    result : FitResult
        Of kind "noise".
    law : str, optional
        The user's function, which is run only if it is named again. The current folder is
        searched first.

    Returns
    -------
    Problem

    Raises
    ------
    InputError
        If the result is not of measurements, `law` is not its law, or the law is undefined for
        the coefficients.
    """
    campaign = campaign_from_settings(result.name, result.settings, f"fit result {result.name!r}")
    if result.uncertainty is None:
        raise InputError(
            f"fit result {result.name!r}",
            "kind",
            result.kind,
            "was not fitted to measurements",
            "name a fit to measurements, or study its discrepancy",
        )
    if law is not None:
        if law != result.law:
            raise InputError(
                f"fit result {result.name!r}",
                "law",
                law,
                f"is not its law, {result.law}",
                "leave --law out, or name that one",
            )
        model = user_model(law, result.contact, f"fit result {result.name!r}", Path.cwd())
        campaign = replace(campaign, model=with_rig(model, campaign.spec.parameters))
    problem = plain_problem(campaign)
    noise = noise_model_of(campaign)
    if noise is not None and result.uncertainty.noise is not None:
        deviations = result.uncertainty.noise.deviations
        problem = with_noise(problem, noise, result.coefficients, deviations)
    if result.uncertainty.loss_scale is not None:
        loss = Loss(result.settings["campaign"]["loss"], result.uncertainty.loss_scale)
        problem = with_loss(problem, loss)
    if not np.isfinite(problem.value_of(result.coefficients)):
        raise InputError(
            f"fit result {result.name!r}",
            "coefficients",
            result.coefficients,
            "leave the law undefined for some of the data",
            "redo the fit",
        )
    require_increasing(problem, result.coefficients)
    return problem


def study_noise(
    result: FitResult,
    *,
    level: float = LEVEL,
    resampling: Resampling | None = None,
    leave_out: str | None = None,
    with_pairs: bool = False,
    law: str | None = None,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> NoiseStudy:
    """Return the uncertainty of the coefficients of a fit to measurements.

    Parameters
    ----------
    result : FitResult
        Of kind "noise".
    level : float
        Of all intervals.
    resampling : Resampling, optional
        Of the bootstrap; none by default.
    leave_out : str, optional
        The kind of group to leave out one after the other.
    with_pairs : bool
        Whether to map the likelihood over each pair of free parameters.
    law : str, optional
        As for `problem_of_result`.
    jobs : int or Cluster
        Worker processes, or a Dask cluster; the result does not depend on it.
    progress : callable, optional
        Called with the stage, how many of its parts are done, and their number.

    Returns
    -------
    NoiseStudy

    Raises
    ------
    InputError
        If the result is not of measurements, or a grouping has one group only.
    """
    problem, best = problem_of_result(result, law), result.coefficients
    noise = residual_model_at(problem, problem.point(best))
    uncertainty = uncertainty_of(problem, best, level, jobs)
    pairs: list[PairMap] = []
    if with_pairs:
        ends = {n: e.profile for n, e in uncertainty.estimates.items() if e.profile is not None}
        names = [pair for pair in pairs_of(problem) if {*pair} <= {*ends}]
        calls = [call(pair_map, problem, noise, pair, best, ends, _CONTOURS) for pair in names]
        pairs = collect(calls, jobs, progress, "mapping")
    resampled = None
    if resampling is not None:
        seed = resampling.seed
        if seed is None:
            seed = int(result.settings["campaign"]["seed"])
        replicates, over = resampling.replicates, resampling.over
        resampled = bootstrap(problem, best, over, replicates, seed, level, jobs, progress)
    return NoiseStudy(
        name=result.name,
        uncertainty=uncertainty,
        pairs=pairs,
        bootstrap=resampled,
        left_out=leave_one_out(problem, best, leave_out, jobs, progress) if leave_out else [],
        bands=bands_of_data(problem, noise, best, level),
    )
