"""Which law describes measurements: all that apply, ranked, and whether the data can tell.

Each law is fitted as `cylcontact fit` does, with the offset and one parameter of stiffness free and
the constants of its shape held. Two criteria rank them:

- AICc, Akaike's information criterion with the correction for few readings (Hurvich and Tsai 1989);
- the cross-validated error: each part of the data is predicted by a fit to the rest. Parts are the
  series, if there are three or more, since readings of one series err alike; with a noise model,
  which predicts what a series adds from its other readings, and without series they are ten parts
  of the rows at random.

A law is told apart from the best only where both do so: its AICc is larger by more than 7 (Burnham
and Anderson 2002), and its cross-validated error by more than one standard error of the difference
between the two, part by part (Breiman and others 1984). The information criterion alone trusts the
noise to be as assumed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.measurements import Indices
from cylcontact.errors import InputError
from cylcontact.fitting.calibration import calibrate, problem_of
from cylcontact.fitting.campaign import Campaign, MeasuredTable
from cylcontact.fitting.least_squares import descend, starting_points
from cylcontact.fitting.measured_objective import MeasuredObjective, measured
from cylcontact.fitting.noise_model import FittedNoise
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.uncertainty.information import log_likelihood, number_estimated
from cylcontact.fitting.uncertainty.residual_model import with_rows
from cylcontact.laws import DEFINITIONS
from cylcontact.pair import Contact
from cylcontact.plain_text import brief, html
from cylcontact.progress import Progress, silent
from cylcontact.text_tables import joined, text_table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Choice", "RankedLaw", "choose_law", "laws_for"]

# Starts of each fit; the usual start is one of them.
_STARTS = 3
_PARTS, _FEWEST_SERIES = 10, 3
# A law is told apart by more than these.
_AICC, _STANDARD_ERRORS = 7.0, 1.0
# Names that a sentence lists.
_LISTED = 5
_FREED = ("offset", "compliance")
_ONE_PAIR = ("power-one-pair", "power-dimensionless")


@dataclass(frozen=True, eq=False)
class RankedLaw:
    """A law fitted to the data.

    Attributes
    ----------
    law : str
        Its name.
    problem : Problem
        The problem solved.
    point : array of float, shape (k,)
        The best free parameters.
    aicc : float
        Its information criterion.
    errors : array of float, shape (m,)
        The mean squared error of each part, predicted from the others.
    sizes : array of float, shape (m,)
        The readings of each part.
    """

    law: str
    problem: Problem
    point: FloatArray
    aicc: float
    errors: FloatArray
    sizes: FloatArray

    @property
    def cv_error(self) -> float:
        """The cross-validated error, root mean square, in the unit of the residuals."""
        return float(np.sqrt(np.average(self.errors, weights=self.sizes)))

    @property
    def cv_standard_error(self) -> float:
        """The standard error of `cv_error`, from the spread of the parts."""
        return _error_of_mean(self.errors, self.sizes) / (2 * self.cv_error)

    def behind(self, best: RankedLaw) -> float:
        """Return how much worse it predicts than another law, in standard errors of that."""
        difference = self.errors - best.errors
        error = _error_of_mean(difference, self.sizes)
        mean = float(np.average(difference, weights=self.sizes))
        return mean / error if error > 0 else float(np.sign(mean)) * np.inf if mean else 0.0


def _error_of_mean(values: FloatArray, weights: FloatArray) -> float:
    """Return the standard error of a weighted mean."""
    share = weights / weights.sum()
    spread = (share * (values - np.average(values, weights=weights))) ** 2
    return float(np.sqrt(spread.sum() * values.size / (values.size - 1)))


@dataclass(frozen=True, eq=False)
class Choice:
    """The laws that apply to measurements, best first.

    Attributes
    ----------
    data : MeasuredTable
        The measurements.
    laws : tuple of RankedLaw
        In the order of AICc.
    left_out : dict of str to str
        Laws that do not apply, and why.
    parts : str
        What the cross-validation left out in turn.
    """

    data: MeasuredTable
    laws: tuple[RankedLaw, ...]
    left_out: dict[str, str]
    parts: str

    @property
    def best(self) -> RankedLaw:
        """The law of the smallest AICc."""
        return self.laws[0]

    @property
    def undecided(self) -> list[str]:
        """The laws that the data cannot tell from the best, that among them."""
        table = self.table
        return [str(name) for name in table.index[table["verdict"] != "worse"]]

    @property
    def table(self) -> pd.DataFrame:
        """The laws with their criteria, best first.

        Columns parameters (free ones and deviations), aicc, aicc_behind, weight (Akaike's),
        cv_error with cv_standard_error (in the unit of the residuals), cv_behind (in standard
        errors of the difference), and verdict: best, undecided or worse.
        """
        behind = np.array([law.aicc - self.best.aicc for law in self.laws])
        weight = np.exp(-behind / 2)
        rows = [
            {
                "parameters": number_estimated(law.problem),
                "aicc": law.aicc,
                "aicc_behind": behind[k],
                "weight": weight[k] / weight.sum(),
                "cv_error": law.cv_error,
                "cv_standard_error": law.cv_standard_error,
                "cv_behind": law.behind(self.best),
                "verdict": self._verdict(law) if k else "best",
            }
            for k, law in enumerate(self.laws)
        ]
        return pd.DataFrame(rows, index=pd.Index([law.law for law in self.laws], name="law"))

    def _verdict(self, law: RankedLaw) -> str:
        """Return whether the data tell a law from the best."""
        is_worse = law.aicc - self.best.aicc > _AICC and law.behind(self.best) > _STANDARD_ERRORS
        return "worse" if is_worse else "undecided"

    def fit(self, law: str = "", jobs: int = 1) -> FitResult:
        """Return the fit of a law, by default of the best, with its intervals."""
        return calibrate(_campaign(self.data, law or self.best.law), jobs)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the data with the best laws; return the axes."""
        from cylcontact.fitting import drawings

        return drawings.plot_choice(self, ax)

    def summary(self) -> str:
        """Return the report as text."""
        return str(self)

    def __str__(self) -> str:
        unit = _unit(measured(self.best.problem))
        head = ("", "parameters", "AICc", "behind", "weight", f"CV error, {unit}", "verdict")
        factor = 100 if unit == "%" else 1
        rows = [
            (
                str(name),
                str(row["parameters"]),
                f"{row['aicc']:.1f}",
                f"{row['aicc_behind']:.1f}",
                f"{row['weight']:.2f}",
                _with_error(factor, row["cv_error"], row["cv_standard_error"]),
                str(row["verdict"]),
            )
            for name, row in self.table.iterrows()
        ]
        notes = [self._conclusion(), *(f"{law}: {why}" for law, why in self.left_out.items())]
        items = (fill(note, 100, initial_indent="- ", subsequent_indent="  ") for note in notes)
        count = len(measured(self.best.problem).data)
        title = f"{brief(self.data.name)}: {len(self.laws)} laws fitted to {count:,} measurements"
        return joined([title, "", text_table(head, rows), *items])

    def _conclusion(self) -> str:
        """Return whether the data decide, in a sentence."""
        undecided = self.undecided
        if len(undecided) == 1:
            return (
                f"{undecided[0]} describes the data best, by AICc and by the cross-validated error "
                f"(over {self.parts})"
            )
        return (
            f"the data cannot tell {listed_with_and(undecided)} apart: AICc within {_AICC:g}, or "
            f"the cross-validated error (over {self.parts}) within {_STANDARD_ERRORS:g} standard "
            "error of the difference; take the one that is known to be right for this contact, or "
            "measure at loads where they differ"
        )

    def _repr_html_(self) -> str:
        return f"{self.table.round(3).to_html()}<p>{html(self._conclusion())}</p>"


def listed_with_and(names: Sequence[str]) -> str:
    """Return names as a sentence lists them, the first few.

    Examples
    --------
    >>> listed_with_and(["a", "b", "c"]), listed_with_and("abcdefgh")
    ('a, b and c', 'a, b, c, d, e and 3 more')
    """
    *first, last = names if len(names) <= _LISTED else (*names[:_LISTED], "")
    more = f"{len(names) - _LISTED} more" if len(names) > _LISTED else last
    return f"{', '.join(first)} and {more}"


def _unit(objective: MeasuredObjective) -> str:
    """Return the unit of residuals."""
    if objective.is_log:
        return "%"
    if objective.noise is not None or objective.has_sigma:
        return "std. dev."
    return "N/mm" if objective.of_load else "mm"


def _with_error(factor: float, value: float, error: float) -> str:
    """Return a number with its standard error.

    Examples
    --------
    >>> _with_error(100, 0.0182, 0.0011)
    '1.82 ± 0.11'
    """
    return f"{factor * value:.3g} ± {factor * error:.2g}"


def laws_for(contact: Contact, pairs: int) -> list[str]:
    """Return the names of the laws that may be fitted to measurements of a contact.

    Power laws that are the same for a single pair are listed once.

    Examples
    --------
    >>> "persson" in laws_for("external", 1), "power-dimensionless" in laws_for("internal", 2)
    (False, True)
    """
    names: list[str] = []
    for definition in DEFINITIONS:
        models = [model.law for model in definition.models if model.contact == contact]
        names += models or [definition.law.name] * (contact in definition.contacts)
    left_out = _ONE_PAIR if pairs == 1 else _ONE_PAIR[:1]
    return [name for name in dict.fromkeys(names) if name not in left_out]


def choose_law(
    table: MeasuredTable, names: Iterable[str] = (), progress: Progress = silent
) -> Choice:
    """Fit all laws that apply to measurements, and rank them.

    Parameters
    ----------
    table : MeasuredTable
        The measurements.
    names : iterable of str, optional
        The laws to compare; by default all for the contact.
    progress : callable, optional
        Called with the stage, how many of its parts are done, and their number.

    Returns
    -------
    Choice

    Raises
    ------
    InputError
        If no law can be fitted.
    """
    data = table.measurements
    chosen = list(names) or laws_for(data.contact, len(data.groups("pair")[0]))
    fitted: list[tuple[str, Problem, FloatArray, float]] = []
    left_out: dict[str, str] = {}
    for number, name in enumerate(chosen):
        progress("fitting", number, len(chosen))
        try:
            # Matrices this small are slower on several threads.
            with threadpool_limits(limits=1):
                fitted.append((name, *_fitted(_campaign(table, name, starts=_STARTS))))
        except InputError as error:
            if names:
                raise
            reason = ": ".join(part for part in (error.key, error.rule) if part)
            left_out[name] = f"left out: {reason}"
    progress("fitting", len(chosen), len(chosen))
    if not fitted:
        rule, remedy = "no law can be fitted to them", "fit one with `cylcontact fit` to see why"
        raise InputError(table.source, "", None, rule, remedy)
    fitted.sort(key=lambda each: each[-1])
    best = measured(fitted[0][1])
    parts, words = _parts(best, table.spec.seed)
    sizes = np.array([float(part.size) for part in parts])
    ranked = []
    for name, problem, point, aicc in fitted:
        with threadpool_limits(limits=1):
            errors = [_error_of_part(problem, point, part, best) for part in parts]
        if not np.isfinite(errors).all():
            left_out[name] = "left out: undefined for a part of the data by a fit to the others"
            continue
        ranked.append(RankedLaw(name, problem, point, aicc, as_floats(errors), sizes))
    return Choice(table, tuple(ranked), left_out, words)


def _campaign(table: MeasuredTable, law: str, starts: int | None = None) -> Campaign:
    """Return the campaign of a law with a free offset and compliance, unless they are given."""
    if starts is not None:
        table = replace(table, spec=table.spec.model_copy(update={"starts": starts}))
    return table.campaign(law, [name for name in _FREED if name not in table.spec.named])


def _parts(objective: MeasuredObjective, seed: int) -> tuple[list[Indices], str]:
    """Return the parts of the data that are left out in turn, and what they are."""
    data = objective.data
    if "group" in data.data.labels and objective.noise is None:
        names, index = data.groups("group")
        if len(names) >= _FEWEST_SERIES:
            return [np.flatnonzero(index == k) for k in range(len(names))], f"{len(names)} series"
    number = min(_PARTS, len(data))
    order = np.random.default_rng(seed).permutation(len(data))
    return [np.sort(part) for part in np.array_split(order, number)], f"{number} parts of the rows"


def _fitted(campaign: Campaign) -> tuple[Problem, FloatArray, float]:
    """Return the problem of a law, its best point, and its AICc."""
    problem, _ = problem_of(campaign, 1, silent)
    starts = starting_points(problem, campaign.nominal, _STARTS, campaign.spec.seed)
    minima = [descend(problem, start, most=1)[:2] for start in starts]
    point = descend(problem, min(minima, key=lambda minimum: minimum[1])[0])[0]
    likelihood = log_likelihood(problem, point)
    if likelihood is None:
        raise InputError(
            campaign.source,
            "loss",
            None,
            "leaves no likelihood to rank laws by",
            "compare them by least squares",
        )
    k, N = number_estimated(problem), len(measured(problem).data)
    return problem, point, 2 * k - 2 * likelihood + 2 * k * (k + 1) / max(N - k - 1, 1)


def _error_of_part(
    problem: Problem, start: FloatArray, part: Indices, best: MeasuredObjective
) -> float:
    """Return the mean squared error of a part, predicted by a fit to the rest.

    Deviations are those of the best law's noise model, so that the errors of laws compare.
    """
    rows = np.setdiff1d(np.arange(len(best.data)), part)
    rest = with_rows(problem, rows)
    point, _, _ = descend(rest, start, most=1)
    objective, form = measured(problem), problem.form(point[None, :])
    if objective.noise is None or best.noise is None:
        return float((objective.raw(form)[0][part] ** 2).mean())
    difference = objective.differences(form)[0] + _of_series(rest, point, objective.noise)
    return float(((difference / best.noise.whitening.scale)[part] ** 2).mean())


def _of_series(rest: Problem, point: FloatArray, noise: FittedNoise) -> FloatArray:
    """Return what the series add to all readings in mm, estimated from a part of them."""
    covariance, known = noise.covariance, measured(rest).noise
    if not covariance.model.effects or known is None:
        return np.zeros(covariance.load.size)
    estimated = known.series_effects(measured(rest).differences(rest.form(point[None, :]))[0])
    effects = np.zeros((int(covariance.series.max()) + 1, len(covariance.model.effects)))
    effects[np.unique(known.covariance.series)] = estimated
    return as_floats((covariance.columns * effects[covariance.series]).sum(axis=1))
