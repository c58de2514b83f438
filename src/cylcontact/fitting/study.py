"""Study the uncertainty of a fit to readings: intervals by covariance, profile and bootstrap.

Rows of one specimen share its errors. Resampling whole groups (materials, clearances, pairs)
preserves this.
"""

from __future__ import annotations

from contextlib import closing

import numpy as np

from cylcontact.datasets.measurements import Indices
from cylcontact.files.spec import Spec
from cylcontact.fitting.diagnose import LEVEL, uncertainty_of
from cylcontact.fitting.optimum import Optimum
from cylcontact.fitting.records import Bootstrap, Interval, Uncertainty
from cylcontact.fitting.results import DataFit
from cylcontact.fitting.words import Rows, item, noise_verdicts, noise_warnings
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call, run_calls
from cylcontact.support.plain_text import brief
from cylcontact.support.progress import Progress, silent
from cylcontact.support.text_tables import Table


class NoiseStudy(Spec):
    """The uncertainty of the coefficients of a fit to measurements; `print` gives the report."""

    name: str
    uncertainty: Uncertainty
    bootstrap: Bootstrap | None

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
            resampled = "-"
            if bootstrap is not None and name in bootstrap.intervals:
                ends = bootstrap.intervals[name]
                resampled = _interval(ends.low, ends.high)
            elif bootstrap is not None:
                resampled = f"error {bootstrap.standard_errors[name]:.3g}"
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
        ]
        return "\n\n".join(parts)


def study_noise(
    result: DataFit,
    *,
    level: float = LEVEL,
    replicates: int | None = None,
    over: str = "rows",
    seed: int | None = None,
    law: str | None = None,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> NoiseStudy:
    """Return the uncertainty of the coefficients of a fit to measurements.

    With `replicates` it is refitted so often to resampled rows, or to other groups. A function of
    the user's own is run only if it is named again as the law.
    """
    optimum = (result if law is None else result.with_law(law)).optimum
    uncertainty = uncertainty_of(optimum, level, jobs)
    resampled = None
    if replicates is not None:
        seed = int(result.settings["campaign"]["seed"]) if seed is None else seed
        resampled = bootstrap(optimum, over, replicates, seed, level, jobs, progress)
    return NoiseStudy(name=result.name, uncertainty=uncertainty, bootstrap=resampled)


def _interval(low: float | None, high: float | None) -> str:
    return "-" if low is None or high is None else f"{low:.5g} … {high:.5g}"


def _on_bootstrap(bootstrap: Bootstrap, level: str) -> str:
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


# Replicates per call of a worker.
_BATCH = 25
# With fewer groups than this intervals are too narrow.
FEW_GROUPS = 8
# Fewer refits than this give standard errors, but no percentile intervals.
FEWEST_REFITS = 40
# With this many refits the ends of a 95 % interval vary with the seed by about a tenth of a
# standard error. The report warns of fewer.
FEW_REFITS = 1000


def bootstrap(
    optimum: Optimum,
    over: str,
    replicates: int,
    seed: int,
    level: float,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> Bootstrap:
    """Refit to resampled rows or groups, `over` as in `Measurements.groups`, from the optimum."""
    names, _ = _groups(optimum, over)
    noise, source = optimum.fit.noise, optimum.fit.data.data.source
    if noise is not None and noise.model.over not in (None, over):
        rule = "would tear apart the series of the noise model"
        raise InputError(source, "over", over, rule, "resample whole series with --over group")
    seeds = np.random.SeedSequence(seed).spawn(replicates)
    batches = [seeds[k : k + _BATCH] for k in range(0, replicates, _BATCH)]
    refits: list[FloatArray | None] = []
    with closing(
        run_calls([call(_replicates, optimum, over, b) for b in batches], jobs)
    ) as results:
        for batch in results:
            refits.extend(batch)
            progress("resampling", len(refits), replicates)
    points = np.array([point for point in refits if point is not None])
    if len(points) < 2:
        rule = f"refits left the law defined in {len(points)}, and a spread needs two"
        remedy = "request more, or fit again so that the law is defined for all rows"
        raise InputError(source, "bootstrap", replicates, rule, remedy)
    intervals = {}
    if len(points) >= FEWEST_REFITS:
        ends = np.percentile(points, [50 * (1 - level), 50 * (1 + level)], axis=0).T
        intervals = {
            p.name: Interval(
                low=float(low),
                high=float(high),
                low_is_bound=bool(low <= p.low),
                high_is_bound=bool(high >= p.high),
            )
            for p, (low, high) in zip(optimum.fit.free, ends, strict=True)
        }
    errors = zip(optimum.fit.names, points.std(axis=0, ddof=1).tolist(), strict=True)
    return Bootstrap(
        over=over,
        groups=len(names),
        replicates=replicates,
        undefined=replicates - len(points),
        seed=seed,
        intervals=intervals,
        standard_errors=dict(errors),
    )


def _groups(optimum: Optimum, over: str) -> tuple[list[str], Indices]:
    """Return the names of the groups, at least two, and the group of each row."""
    data = optimum.fit.data
    names, group = data.groups(over)
    if len(names) < 2:
        rule = f"all rows are of one group, {names[0]}"
        raise InputError(data.data.source, "over", over, rule, "choose rows, or measure another")
    return names, group


def _replicates(
    optimum: Optimum, over: str, seeds: list[np.random.SeedSequence]
) -> list[FloatArray | None]:
    """Refit once per seed; None if the law is undefined for a row at the start."""
    names, group = optimum.fit.data.groups(over)
    members = [np.flatnonzero(group == number) for number in range(len(names))]
    points: list[FloatArray | None] = []
    for seed in seeds:
        drawn = np.random.default_rng(seed).integers(len(names), size=len(names))
        rows = np.concatenate([members[k] for k in drawn])
        copies = np.repeat(np.arange(drawn.size), [members[k].size for k in drawn])
        point, value, _ = optimum.fit.take(rows, copies).minimise(optimum.point)
        points.append(point if np.isfinite(value) else None)
    return points
