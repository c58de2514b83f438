"""Redo a committed fit and compare the results."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cylcontact.fitting.calibration import calibrate, problem_of
from cylcontact.fitting.problem import ParameterSpace
from cylcontact.fitting.results import FitResult, LawFit
from cylcontact.fitting.table_campaign import TableCampaign, campaign_of
from cylcontact.fitting.table_fit import fit_table
from cylcontact.parallel import Workers
from cylcontact.progress import Progress

__all__ = ["Check", "compare_results", "verify"]

# On another processor a fit may end in a neighbouring kink of Y, less than 0.1 % away.
_OBJECTIVE_TOLERANCE = 1e-3
# Without a search the numbers are the same to round-off.
_EXACT_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Check:
    """A number of a committed result and its fresh value.

    Below `exact` both are round-off.
    """

    what: str
    committed: float
    fresh: float
    tolerance: float
    exact: float = 0.0

    @property
    def deviation(self) -> float:
        """Relative deviation of the fresh value."""
        difference = abs(self.fresh - self.committed)
        return difference / abs(self.committed) if self.committed else difference

    @property
    def holds(self) -> bool:
        """Whether it is within the tolerance, or both numbers are round-off."""
        is_round_off = max(abs(self.committed), abs(self.fresh)) < self.exact
        return is_round_off or self.deviation <= self.tolerance

    def __str__(self) -> str:
        verdict = "holds" if self.holds else "DOES NOT HOLD"
        return (
            f"{self.what}: committed {self.committed:.10g}, fresh {self.fresh:.10g}, "
            f"deviation {self.deviation:.1e}, allowed {self.tolerance:.0e}: {verdict}"
        )


def verify(path: Path, jobs: Workers, progress: Progress) -> list[Check]:
    """Redo a fit with the settings in a result file and compare.

    Parameters
    ----------
    path : Path
        The result file.
    jobs : int or Cluster
        Worker processes, or a Dask cluster.
    progress : callable
        As for `calibrate`.

    Returns
    -------
    list of Check
        The objective of the committed coefficients against the committed one. Then the fresh
        objective, lower bound, published coefficients' objective and number of samples against
        the committed ones.

    Raises
    ------
    InputError
        If the file is not a result.
    """
    committed = FitResult.read(path)
    campaign = campaign_of(committed.name, committed.settings, str(path))
    problem: ParameterSpace
    fresh: FitResult
    if isinstance(campaign, TableCampaign):
        problem, fresh = campaign.fit(), fit_table(campaign, jobs, progress)
    else:
        problem, _ = problem_of(campaign, jobs, progress)
        fresh = calibrate(campaign, jobs, progress)
    of_coefficients = Check(
        "objective of the coefficients",
        committed.objective.value,
        problem.value_of(committed.coefficients),
        _EXACT_TOLERANCE,
        committed.round_off,
    )
    return [of_coefficients, *compare_results(committed, fresh)]


def compare_results(committed: FitResult, fresh: FitResult) -> list[Check]:
    """Compare a committed result with a fresh one."""
    objective, exact = (committed.objective.value, fresh.objective.value), committed.round_off
    checks = [
        Check("objective", *objective, _OBJECTIVE_TOLERANCE, exact),
        Check("samples", committed.counts.samples, fresh.counts.samples, 0.0),
    ]
    if isinstance(committed, LawFit) and isinstance(fresh, LawFit) and committed.bound is not None:
        checks.append(
            Check("lower bound", committed.bound, fresh.bound or 0.0, _EXACT_TOLERANCE, exact)
        )
    if committed.published and fresh.published:
        published = committed.published.objective, fresh.published.objective
        checks.append(Check("published objective", *published, _EXACT_TOLERANCE, exact))
    return checks
