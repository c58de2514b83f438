"""Which law describes measurements: all that apply, ranked, and whether the data can tell.

Each law is fitted as `cylcontact fit` does, with one parameter of stiffness, the offset and the
compliance free and the constants of its shape held. The compliance has either sign: what the
readings yield beyond the law's own datum, for the points between which they are taken, the housing
and the rig. A law would else be ranked by its datum, not by its shape. Two criteria rank them:

- AICc, Akaike's information criterion with the correction for few readings (Hurvich and Tsai 1989);
- the cross-validated error: each part of the data is predicted by a fit to the rest. Parts are the
  series, if there are three or more, since readings of one series err alike; with a noise model,
  which predicts what a series adds from its other readings, and without series they are ten parts
  of the rows at random.

A law is told apart from the best only where both do so: its AICc is larger by more than 7 (Burnham
and Anderson 2002), and its cross-validated error by more than one standard error of the difference
between the two, part by part (Breiman and others 1984). The information criterion alone trusts the
noise to be as assumed. If the best misses the readings by far more than they scatter, none of
the laws describes them.
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
from cylcontact.fitting.assessment import COMPLIANCE, data_warnings, describes
from cylcontact.fitting.calibration import calibrate, problem_of
from cylcontact.fitting.campaign import Campaign, MeasuredTable
from cylcontact.fitting.least_squares import descend, starting_points
from cylcontact.fitting.measured_objective import MeasuredObjective, measured
from cylcontact.fitting.noise_model import FittedNoise
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.uncertainty.estimates import uncertainty_of
from cylcontact.fitting.uncertainty.information import log_likelihood, number_estimated
from cylcontact.fitting.uncertainty.residual_model import residual_model_at, with_rows
from cylcontact.housing_spec import takes_housing
from cylcontact.laws import LAW_TYPES
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
# Laws that are compared if they are named, and those that are the same for a single pair.
_IF_NAMED = ("power-one-pair", "power-clearance")
_SAME_FOR_ONE = (*_IF_NAMED, "power-dimensionless")


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
    def compliance(self) -> tuple[float, float]:
        """The compliance in mm/(N/mm) and its standard error, NaN where it has none."""
        names = [p.name for p in self.problem.free]
        if "compliance" not in names:
            return self.problem.coefficients(self.point).get("compliance", np.nan), np.nan
        place = names.index("compliance")
        covariance = residual_model_at(self.problem, self.point).covariance
        error = np.nan if covariance is None else float(np.sqrt(covariance[place, place]))
        return float(self.point[place]), error

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
    warnings : tuple of str
        What the readings show against the fit of the best law, as in its report.
    describes : bool
        Whether the best law describes the readings at all; if not, none does.
    """

    data: MeasuredTable
    laws: tuple[RankedLaw, ...]
    left_out: dict[str, str]
    parts: str
    warnings: tuple[str, ...] = ()
    describes: bool = True

    @property
    def best(self) -> RankedLaw:
        """The law of the smallest AICc."""
        return self.laws[0]

    @property
    def undecided(self) -> list[str]:
        """The laws that the data cannot tell from the best, that among them.

        There are none if no law describes the data.
        """
        table = self.table
        return [str(name) for name in table.index[table["verdict"].isin(("best", "undecided"))]]

    @property
    def table(self) -> pd.DataFrame:
        """The laws with their criteria, best first.

        Columns parameters (free ones and deviations), aicc, aicc_behind, weight (Akaike's),
        cv_error with cv_standard_error (in the unit of the residuals), cv_behind (in standard
        errors of the difference), compliance with compliance_error (in mm/(N/mm)), and verdict:
        best, undecided or worse, or misses if no law describes the data.
        """
        behind = np.array([law.aicc - self.best.aicc for law in self.laws])
        weight = np.exp(-behind / 2)
        compliances = [law.compliance for law in self.laws]
        rows = [
            {
                "parameters": number_estimated(law.problem),
                "aicc": law.aicc,
                "aicc_behind": behind[k],
                "weight": weight[k] / weight.sum(),
                "cv_error": law.cv_error,
                "cv_standard_error": law.cv_standard_error,
                "cv_behind": law.behind(self.best),
                "compliance": compliances[k][0],
                "compliance_error": compliances[k][1],
                "verdict": self._verdict(law),
            }
            for k, law in enumerate(self.laws)
        ]
        return pd.DataFrame(rows, index=pd.Index([law.law for law in self.laws], name="law"))

    def _verdict(self, law: RankedLaw) -> str:
        """Return whether the data tell a law from the best."""
        if not self.describes:
            return "misses"
        if law is self.best:
            return "best"
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
        criteria = ("AICc", "behind", "weight", f"CV error, {unit}")
        head = ("", "parameters", *criteria, "compliance, mm/(N/mm)", "verdict")
        factor = 100 if unit == "%" else 1
        rows = [
            (
                str(name),
                str(row["parameters"]),
                f"{row['aicc']:.1f}",
                f"{row['aicc_behind']:.1f}",
                f"{row['weight']:.2f}",
                _with_error(factor, row["cv_error"], row["cv_standard_error"]),
                _with_error(1, row["compliance"], row["compliance_error"]),
                str(row["verdict"]),
            )
            for name, row in self.table.iterrows()
        ]
        notes = [f"{'-' if self.describes else '!'} {self._conclusion()}"]
        notes += [f"! {self.best.law}: {warning}" for warning in self.warnings]
        notes += [f"- {note}" for note in self._on_datum()]
        notes += [f"- {law}: {why}" for law, why in self.left_out.items()]
        items = (fill(note, 100, subsequent_indent="  ") for note in notes)
        count = len(measured(self.best.problem).data)
        title = f"{brief(self.data.name)}: {len(self.laws)} laws fitted to {count:,} measurements"
        return joined([title, "", text_table(head, rows), *items])

    def _conclusion(self) -> str:
        """Return whether the data decide, in a sentence."""
        undecided = self.undecided
        if not self.describes:
            return f"none of the laws describes these readings; {self.best.law} comes nearest"
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

    def _on_datum(self) -> list[str]:
        """Return what the compliance means, and whether the data tell law from datum by it."""
        near = [law for law in self.laws if law.law in self.undecided]
        values, errors = np.array([law.compliance for law in near]).reshape(-1, 2).T
        if not near or not np.isfinite(errors).any():
            return []
        sentences = [COMPLIANCE]
        if np.ptp(values) > _STANDARD_ERRORS * np.nanmax(errors):
            sentences.append(
                "the data cannot tell the law from the datum: each of these laws follows them with "
                "a compliance of its own; if yours is known, give it with --fix compliance=VALUE"
            )
        return sentences

    def _repr_html_(self) -> str:
        numbers = self.table.drop(columns=["compliance", "compliance_error"]).round(3)
        notes = (self._conclusion(), *self.warnings, *self._on_datum())
        return numbers.to_html() + "".join(f"<p>{html(note)}</p>" for note in notes)


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
    """Return a number with its standard error; one that is held has none.

    Examples
    --------
    >>> _with_error(100, 0.0182, 0.0011)
    '1.82 ± 0.11'
    """
    if np.isnan(error):
        return f"{factor * value:.3g}"
    return f"{factor * value:.3g} ± {factor * error:.2g}"


def laws_for(contact: Contact, pairs: int) -> list[str]:
    """Return the names of the laws that may be fitted to measurements of a contact.

    Power laws that are the same for a single pair are listed once, and none whose factor and
    exponent follow the clearance.

    Examples
    --------
    >>> "persson" in laws_for("external", 1), "power-dimensionless" in laws_for("internal", 2)
    (False, True)
    """
    names: list[str] = []
    for law in LAW_TYPES:
        models = [model.law for model in law.models() if model.contact == contact]
        names += models or [law.name] * (contact in law.contacts)
    left_out = _SAME_FOR_ONE if pairs == 1 else _IF_NAMED
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
    data, spec = table.measurements, table.spec
    # Without names the laws that know the housing are one curve: the reference stands for them.
    known = ["conformal"] if spec.housing is not None else []
    chosen = list(names) or known + laws_for(data.contact, len(data.groups("pair")[0]))
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
            where = (
                error.source.rpartition(", ")[2] if error.key.startswith("load, ") else error.key
            )
            left_out[name] = f"left out: {where}: {error.rule}".replace(": : ", ": ")
            continue
        k = number_estimated(fitted[-1][1])
        if len(data) <= k + 1:
            left_out[name] = (
                f"left out: {len(data)} readings are too few to rank it, which estimates {k} "
                f"numbers; AICc needs {k + 2}"
            )
            fitted.pop()
    progress("fitting", len(chosen), len(chosen))
    _require_some(fitted, left_out, table, "measure more, or hold some (--fix compliance=0)")
    parts, words = _parts(measured(fitted[0][1]), spec.seed)
    missed = {}
    for name, problem, point, _ in fitted:
        with threadpool_limits(limits=1):
            missed[name] = _missed(problem, point, parts)
        if not np.isfinite(missed[name]).all():
            left_out[name] = (
                "left out: cannot be cross-validated: a fit to some of the readings has no value "
                "at others, as its curve ends before them or passes below 0"
            )
    fitted = [each for each in fitted if each[0] not in left_out]
    _require_some(
        fitted, left_out, table, "look at the readings: a kink, an outlier or a few only?"
    )
    fitted.sort(key=lambda each: each[-1])
    # Deviations are those of the best law's noise model, so that the errors of laws compare.
    noise = measured(fitted[0][1]).noise
    scale = np.ones(len(data)) if noise is None else noise.whitening.scale
    sizes = np.array([float(part.size) for part in parts])
    ranked = []
    for name, problem, point, aicc in fitted:
        squares = (missed[name] / scale) ** 2
        errors = as_floats([squares[part].mean() for part in parts])
        ranked.append(RankedLaw(name, problem, point, aicc, errors, sizes))
    best = ranked[0]
    with threadpool_limits(limits=1):
        uncertainty = uncertainty_of(best.problem, best.problem.coefficients(best.point))
    told = tuple(data_warnings(uncertainty))
    return Choice(table, tuple(ranked), left_out, words, told, describes(uncertainty))


def _require_some(
    fitted: Sequence[object], left_out: dict[str, str], table: MeasuredTable, remedy: str
) -> None:
    """Refuse measurements to which no law is left, with the reason of the first."""
    if not fitted:
        name, why = next(iter(left_out.items()))
        rule = f"no law can be ranked on them; {name} is {why}"
        raise InputError(table.source, "", None, rule, remedy)


def _campaign(table: MeasuredTable, law: str, starts: int | None = None) -> Campaign:
    """Return the campaign of a law with offset and, in an unknown housing, compliance free."""
    if starts is not None:
        table = replace(table, spec=table.spec.model_copy(update={"starts": starts}))
    known = table.spec.housing is not None and takes_housing(law)
    freed = _FREED[:1] if known else _FREED
    return table.campaign(law, [name for name in freed if name not in table.spec.named])


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
    # With N ≤ k + 1 it is undefined, and the law is not ranked.
    return problem, point, 2 * k - 2 * likelihood + 2 * k * (k + 1) / max(N - k - 1, 1)


def _missed(problem: Problem, start: FloatArray, parts: Sequence[Indices]) -> FloatArray:
    """Return by how much each reading is missed by a fit without its part, shape (N,).

    In mm with a noise model, else in the unit of the residuals.
    """
    objective = measured(problem)
    missed = np.empty(len(objective.data))
    for part in parts:
        rest = with_rows(problem, np.setdiff1d(np.arange(missed.size), part))
        point, _, _ = descend(rest, start, most=1)
        form = problem.form(point[None, :])
        if objective.noise is None:
            missed[part] = objective.raw(form)[0][part]
        else:
            difference = objective.differences(form)[0] + _of_series(rest, point, objective.noise)
            missed[part] = difference[part]
    return missed


def _of_series(rest: Problem, point: FloatArray, noise: FittedNoise) -> FloatArray:
    """Return what the series add to all readings in mm, estimated from a part of them."""
    covariance, known = noise.covariance, measured(rest).noise
    if not covariance.model.effects or known is None:
        return np.zeros(covariance.load.size)
    estimated = known.series_effects(measured(rest).differences(rest.form(point[None, :]))[0])
    effects = np.zeros((int(covariance.series.max()) + 1, len(covariance.model.effects)))
    effects[np.unique(known.covariance.series)] = estimated
    return as_floats((covariance.columns * effects[covariance.series]).sum(axis=1))
