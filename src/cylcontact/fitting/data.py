"""The data of a campaign: samples of a reference law on a grid, or a table of measurements.

Both answer the same questions: which problem to minimise, which searches to run, and how good the
best coefficients are. So `calibrate` does not tell them apart.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.datasets.grid import Grid
from cylcontact.datasets.measurements import Measurements
from cylcontact.datasets.moments import Moments
from cylcontact.datasets.sampling import Counts, reduce_grid
from cylcontact.errors import InputError
from cylcontact.fitting.least_squares import descend, run_from, starting_points
from cylcontact.fitting.loss import TUNING, Loss
from cylcontact.fitting.measured_objective import MeasuredObjective
from cylcontact.fitting.objectives import ON_ROWS, make_objective, max_abs_difference_percent
from cylcontact.fitting.problem import Problem, require_defined_somewhere
from cylcontact.fitting.run import execute, plan_runs
from cylcontact.fitting.samples import Samples, collect_samples
from cylcontact.fitting.uncertainty.estimates import Uncertainty, uncertainty_of
from cylcontact.fitting.uncertainty.profiles import Profile, profile
from cylcontact.fitting.uncertainty.residual_model import MEDIAN_TO_SIGMA, measured
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.parallel import Call, Workers, call, collect
from cylcontact.progress import Progress

if TYPE_CHECKING:
    from cylcontact.fitting.campaign import Campaign

__all__ = [
    "Data",
    "GridData",
    "Quality",
    "TableData",
    "grid_of",
    "plain_problem",
    "with_grid",
    "with_loss",
]

# Every worker keeps all samples in memory, 24 bytes each.
_MAX_ROWS = 20_000_000
# Iterations for the scale of a robust loss.
_SCALE_ROUNDS = 5
# Points evaluated before data are refused as outside a law's domain.
_TRIALS = 256


@dataclass(frozen=True)
class Quality:
    """How good the best coefficients are.

    Attributes
    ----------
    bound : float or None
        The per-clearance lower bound of the objective.
    largest_percent : float
        Largest |Eq 9| of the best coefficients over the data, in percent.
    largest_percent_published : float or None
        That of the published ones.
    profiles : dict
        Profiles of the objective, for a reference law.
    uncertainty : Uncertainty or None
        For measurements.
    """

    bound: float | None
    largest_percent: float
    largest_percent_published: float | None
    profiles: dict[str, Profile]
    uncertainty: Uncertainty | None = None


class Data(Protocol):
    """The data of a campaign."""

    @property
    def kind(self) -> Literal["discrepancy", "noise"]:
        """Whether residuals are discrepancy of laws, or noise of measurements."""
        ...

    @property
    def reference(self) -> str:
        """The name of the reference law, or "measurements"."""
        ...

    @property
    def settings(self) -> dict[str, Any]:
        """The data as results store them, under their key in `settings`."""
        ...

    def problem(
        self, campaign: Campaign, jobs: Workers, progress: Progress, /
    ) -> tuple[Problem, Counts]:
        """Return the problem to minimise, and the numbers of samples used and masked."""
        ...

    def searches(self, campaign: Campaign, problem: Problem) -> list[Call]:
        """Return the runs of a campaign as calls, each of which returns its RunRecord."""
        ...

    def quality(
        self,
        problem: Problem,
        best: Mapping[str, float],
        published: Mapping[str, float] | None,
        jobs: Workers,
        progress: Progress,
    ) -> Quality:
        """Return how good the best coefficients are, and the published ones beside them."""
        ...


def grid_of(campaign: Campaign) -> Grid:
    """Return the grid of a campaign, which has to be on one."""
    return _grid_data(campaign).grid


def with_grid(campaign: Campaign, grid: Grid) -> Campaign:
    """Return a campaign on another grid; its settings remain those of its file."""
    return replace(campaign, data=replace(_grid_data(campaign), grid=grid))


def _grid_data(campaign: Campaign) -> GridData:
    """Return the data of a campaign on a grid."""
    if not isinstance(campaign.data, GridData):
        raise TypeError(f"{campaign.name} is not on a grid")
    return campaign.data


def plain_problem(campaign: Campaign) -> Problem:
    """Return the problem of a campaign on measurements, by plain least squares."""
    if not isinstance(campaign.data, TableData):
        raise TypeError(f"{campaign.name} is not on measurements")
    objective = MeasuredObjective(campaign.data.measurements, campaign.objective)
    return Problem(campaign.model, campaign.parameters, objective)


def _planned(campaign: Campaign, problem: Problem) -> list[Call]:
    """Return the runs of a campaign with its optimiser, as calls."""
    genetic, optimizer = campaign.spec.genetic, campaign.spec.optimizer
    if optimizer is None:
        raise TypeError(f"{campaign.name} names no optimiser")
    plans = plan_runs(
        genetic.runs,
        genetic.populations,
        genetic.crossovers,
        genetic.generations,
        campaign.spec.seed,
        optimizer,
    )
    return [call(execute, problem, plan, campaign.source) for plan in plans]


# --- a grid ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class GridData:
    """Samples of a reference law on a grid.

    Attributes
    ----------
    grid : Grid
        The grid.
    spec : dict
        The contents of its file.
    """

    grid: Grid
    spec: dict[str, Any]
    kind: ClassVar[Literal["discrepancy"]] = "discrepancy"

    @property
    def reference(self) -> str:
        """The reference law."""
        return self.grid.reference

    @property
    def settings(self) -> dict[str, Any]:
        """The grid's file."""
        return {"dataset": self.spec}

    def problem(
        self, campaign: Campaign, jobs: Workers, progress: Progress, /
    ) -> tuple[Problem, Counts]:
        """Sample the grid: moments where the objective allows, else rows."""
        name = campaign.objective
        samples: Moments | Samples
        if campaign.model.power_form is not None and name not in ON_ROWS:
            done = self._progress(progress, "sampling")
            samples, counts = reduce_grid(self.grid, jobs, done)
        else:
            self._require_few(name, campaign.source)
            samples, counts = collect_samples(self.grid)
        objective = make_objective(name, samples)
        problem = Problem(campaign.model, campaign.parameters, objective)
        require_defined_somewhere(problem, campaign.source)
        return problem, counts

    def searches(self, campaign: Campaign, problem: Problem) -> list[Call]:
        """Return the runs of the campaign's optimiser."""
        return _planned(campaign, problem)

    def quality(
        self,
        problem: Problem,
        best: Mapping[str, float],
        published: Mapping[str, float] | None,
        jobs: Workers,
        progress: Progress,
    ) -> Quality:
        """Compare over the whole grid, and profile every free parameter."""
        candidates = [best] if published is None else [best, published]
        progress("comparing", 0, self.grid.dR.size)
        done = self._progress(progress, "comparing")
        worst = max_abs_difference_percent(self.grid, problem.model, candidates, jobs, done)
        return Quality(
            bound=problem.objective.bound if problem.model.power_form is not None else None,
            largest_percent=float(worst[0]),
            largest_percent_published=None if published is None else float(worst[1]),
            profiles=_profiles(problem, best, published, jobs, progress),
        )

    def _progress(self, progress: Progress, stage: str) -> Callable[[int], None]:
        """Return a function that reports how many clearances are done."""
        return lambda done: progress(stage, done, self.grid.dR.size)

    def _require_few(self, objective: str, source: str) -> None:
        """Refuse a grid whose samples do not fit into memory."""
        if self.grid.size > _MAX_ROWS:
            raise InputError(
                source,
                "objective",
                objective,
                f"keeps every sample in memory and the grid has {self.grid.size} "
                f"(at most {_MAX_ROWS})",
                "thin the grid, or use rms-log-penetration, which needs only moments",
            )


def _profiles(
    problem: Problem,
    best: Mapping[str, float],
    published: Mapping[str, float] | None,
    jobs: Workers,
    progress: Progress,
) -> dict[str, Profile]:
    """Profile every free parameter."""
    names = [p.name for p in problem.free]
    work = [
        call(profile, problem, name, best, published[name] if published else None) for name in names
    ]
    progress("profiling", 0, len(names))
    return dict(zip(names, collect(work, jobs, progress, "profiling"), strict=True))


# --- a table -----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class TableData:
    """A table of measurements.

    Attributes
    ----------
    measurements : Measurements
        The table.
    loss : str
        One of `LOSSES`.
    loss_scale : float or None
        Where the loss bends; None for 1.345 times the standard deviation, known or estimated.
    starts : int
        The number of descents without an optimiser.
    """

    measurements: Measurements
    loss: str
    loss_scale: float | None
    starts: int
    kind: ClassVar[Literal["noise"]] = "noise"
    reference: ClassVar[str] = "measurements"

    @property
    def settings(self) -> dict[str, Any]:
        """The whole table."""
        return {"measurements": self.measurements.data.model_dump(mode="json")}

    def problem(
        self, campaign: Campaign, _jobs: Workers, _progress: Progress, /
    ) -> tuple[Problem, Counts]:
        """Return the problem, with the scale of a robust loss."""
        problem = plain_problem(campaign)
        _require_defined(problem, campaign)
        if self.loss != "linear":
            problem = self._robust(problem, campaign)
        return problem, Counts(len(self.measurements), 0)

    def searches(self, campaign: Campaign, problem: Problem) -> list[Call]:
        """Return descents from several starts, or the runs of an optimiser that is named."""
        spec = campaign.spec
        if spec.optimizer is not None:
            return _planned(campaign, problem)
        starts = starting_points(problem, campaign.nominal, self.starts, spec.seed)
        return [call(run_from, problem, start, k, spec.seed) for k, start in enumerate(starts)]

    def quality(
        self,
        problem: Problem,
        best: Mapping[str, float],
        published: Mapping[str, float] | None,
        jobs: Workers,
        progress: Progress,
    ) -> Quality:
        """Compare with the measurements, and estimate the uncertainty."""
        build = problem.model.build
        progress("profiling", 0, 1)
        uncertainty = uncertainty_of(problem, best, jobs=jobs)
        progress("profiling", 1, 1)
        return Quality(
            bound=None,
            largest_percent=self._largest_percent(build(best)),
            largest_percent_published=None
            if published is None
            else self._largest_percent(build(published)),
            profiles={},
            uncertainty=uncertainty,
        )

    def _robust(self, problem: Problem, campaign: Campaign) -> Problem:
        """Return the problem with a robust loss and its scale.

        A scale that is not given is 1.345 times the standard deviation if that is known, else
        1.345 times the robust spread of the residuals, by a few iterations from a least-squares
        fit.
        """
        objective = measured(problem)
        if self.loss_scale is not None or objective.has_sigma:
            return with_loss(problem, Loss(self.loss, self.loss_scale or TUNING))
        starts = starting_points(problem, campaign.nominal, self.starts, campaign.spec.seed)
        minima = [descend(problem, start)[:2] for start in starts]
        point = min(minima, key=lambda pair: pair[1])[0]
        for _ in range(_SCALE_ROUNDS):
            r = objective.raw(problem.form(point[None, :]))[0]
            spread = MEDIAN_TO_SIGMA * float(np.median(np.abs(r)))
            problem = with_loss(problem, Loss(self.loss, max(TUNING * spread, 1e-12)))
            point = descend(problem, point)[0]
        return problem

    def _largest_percent(self, law: ContactLaw) -> float:
        """Return the largest |Eq 9| against the measurements, in percent."""
        predicted: FloatArray = law.penetration(self.measurements.load, self.measurements.pair)
        ratio = predicted / self.measurements.penetration - 1
        return float(100 * np.nanmax(np.abs(ratio))) if np.isfinite(ratio).any() else 0.0


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
    raise InputError(
        f"{campaign.source}, {data.data.row_word} {data.line(row)}",
        "load, penetration, dR",
        [float(data.columns[name][row]) for name in ("load", "penetration", "dR")],
        f"lies outside the domain of {campaign.model.law} for all coefficients tried within the "
        "bounds",
        "move the bounds, remove the row, or choose a law that reaches that far",
    )


def with_loss(problem: Problem, loss: Loss) -> Problem:
    """Return a problem on measurements with another loss."""
    return replace(problem, objective=replace(measured(problem), loss=loss))
