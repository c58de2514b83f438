"""Study the uncertainty of a fit to readings: intervals, maps of pairs, the bootstrap, bands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import Field

from cylcontact.fitting.estimates import LEVEL, Uncertainty, uncertainty_of
from cylcontact.fitting.noise_words import noise_verdicts, noise_warnings
from cylcontact.fitting.optimum import Band, PairMap
from cylcontact.fitting.records import LeftOut
from cylcontact.fitting.resampling import (
    FEW_GROUPS,
    FEW_REFITS,
    FEWEST_REFITS,
    Bootstrap,
    bootstrap,
    leave_one_out,
)
from cylcontact.fitting.results import DataFit, Rows, item, left_out_table
from cylcontact.parallel import Workers, call, collect
from cylcontact.plain_text import brief
from cylcontact.progress import Progress, silent
from cylcontact.spec import Spec
from cylcontact.text_tables import Table

# Levels of the contours of pairs.
_CONTOURS = (0.68, 0.95)


@dataclass(frozen=True)
class Resampling:
    """The options of the bootstrap: refits, what is resampled, and the seed if not the fit's."""

    replicates: int
    over: str = "rows"
    seed: int | None = None


class NoiseStudy(Spec):
    """The uncertainty of the coefficients of a fit to measurements; `print` gives the report."""

    name: str = Field(description="the fit's name")
    uncertainty: Uncertainty = Field(description="covariance, profiles and verdicts")
    pairs: list[PairMap] = Field(description="the likelihood over each pair of parameters")
    bootstrap: Bootstrap | None = Field(description="refits to resampled data")
    left_out: list[LeftOut] = Field(description="fits without one group")
    bands: list[Band] = Field(description="predictions with their bands")

    def __str__(self) -> str:
        uncertainty, bootstrap = self.uncertainty, self.bootstrap
        level = f"{100 * uncertainty.level:g} %"
        rows: Rows = []
        for name, estimate in uncertainty.estimates.items():
            error = covariance = profile = "-"
            if estimate.standard_error is not None:
                error = f"{estimate.standard_error:.3g}"
                covariance = _interval(estimate.low, estimate.high)
            if estimate.profile is not None:
                profile = _interval(estimate.profile.low, estimate.profile.high)
            resampled = "-" if bootstrap is None else _resampled(bootstrap, name)
            rows.append((name, f"{estimate.value:.5g}", error, covariance, profile, resampled))
        intervals = [f"{level}, {method}" for method in ("covariance", "profile", "bootstrap")]
        warned = noise_warnings(uncertainty)
        sentences = [each for each in noise_verdicts(uncertainty) if each not in warned]
        if bootstrap is not None:
            sentences.append(_on_bootstrap(bootstrap, level))
        title = f"{brief(self.name)}: uncertainty from the noise of the measurements"
        parts = [
            "\n".join([title, *(item(sentence, "! ") for sentence in warned)]),
            str(Table(("", "fitted", "std. error", *intervals), rows)),
            "\n".join(map(item, sentences)),
            *left_out_table(self.left_out, list(uncertainty.estimates)),
            *_on_bands(self.bands, level),
        ]
        return "\n\n".join(parts)


def study_noise(
    result: DataFit,
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
    result : DataFit
        The fit.
    level : float
        Of all intervals.
    resampling : Resampling, optional
        Of the bootstrap; none by default.
    leave_out : str, optional
        The kind of group to leave out one after the other.
    with_pairs : bool
        Whether to map the likelihood over each pair of free parameters.
    law : str, optional
        The user's function, which is run only if it is named again.
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
    optimum = (result if law is None else result.with_law(law)).optimum
    uncertainty = uncertainty_of(optimum, level, jobs)
    pairs: list[PairMap] = []
    if with_pairs:
        ends = {n: e.profile for n, e in uncertainty.estimates.items() if e.profile is not None}
        names = [pair for pair in optimum.pairs if {*pair} <= {*ends}]
        calls = [call(optimum.map_of_pair, pair, ends, _CONTOURS) for pair in names]
        pairs = collect(calls, jobs, progress, "mapping")
    resampled = None
    if resampling is not None:
        seed = resampling.seed
        if seed is None:
            seed = int(result.settings["campaign"]["seed"])
        replicates, over = resampling.replicates, resampling.over
        resampled = bootstrap(optimum, over, replicates, seed, level, jobs, progress)
    return NoiseStudy(
        name=result.name,
        uncertainty=uncertainty,
        pairs=pairs,
        bootstrap=resampled,
        left_out=leave_one_out(optimum, leave_out, jobs, progress) if leave_out else [],
        bands=optimum.bands_of_data(level),
    )


def _interval(low: float | None, high: float | None) -> str:
    """Return an interval."""
    return "-" if low is None or high is None else f"{low:.5g} … {high:.5g}"


def _resampled(bootstrap: Bootstrap, name: str) -> str:
    """Return the bootstrap interval, or only the standard error after too few refits."""
    if name not in bootstrap.intervals:
        return f"error {bootstrap.standard_errors[name]:.3g}"
    return _interval(bootstrap.intervals[name].low, bootstrap.intervals[name].high)


def _on_bootstrap(bootstrap: Bootstrap, level: str) -> str:
    """Return a sentence on the bootstrap: the groups resampled, and if the refits suffice."""
    plural = {"rows": "rows", "dR": "clearances"}.get(bootstrap.over, f"{bootstrap.over}s")
    sentence = f"bootstrap: {bootstrap.replicates} refits to {bootstrap.groups} resampled {plural}"
    refits = bootstrap.replicates - bootstrap.undefined
    if bootstrap.undefined:
        sentence += f", of which {bootstrap.undefined} left the law undefined and do not count"
    if not bootstrap.intervals:
        sentence += (
            f"; {refits} refits give standard errors, and {level} intervals from {FEWEST_REFITS}"
        )
    elif refits < FEW_REFITS:
        sentence += f"; {refits} refits are few for {level} intervals, take {FEW_REFITS} or more"
    if bootstrap.groups < FEW_GROUPS:
        sentence += f"; {bootstrap.groups} are few, and their intervals too narrow as a rule"
    return sentence


def _on_bands(bands: Sequence[Band], level: str) -> list[str]:
    """Return the half-widths of the bands at both ends of each pair's range."""
    if not bands:
        return []
    rows = [
        (band.name, band.quantity, *_half_widths(band, 0), *_half_widths(band, -1))
        for band in bands
    ]
    end = ("at", "curve ±%", "new ±%")
    table = Table(("pair", "predicted", *end, *end), rows)
    return [f"Bands at the ends of the range ({level}):\n{table}"]


def _half_widths(band: Band, k: int) -> tuple[str, str, str]:
    """Return a point of a band and its half-widths there, in percent."""
    value = abs(band.value[k])  # a predicted reading may be 0 or below
    widths = (band.high[k] - band.low[k], band.new_high[k] - band.new_low[k])
    curve, new = (f"{50 * width / value:.2g}" if value > 0 else "-" for width in widths)
    return f"{band.at[k]:.4g}", curve, new
