"""Which law describes measurements: all that apply, ranked, and whether the data can tell.

Each law is fitted as `cylcontact fit` does. One parameter of stiffness, the offset and the
compliance are free; the constants of its shape are fixed. The compliance is the extra displacement
per unit load of mounting, rig and housing, and may be negative. Without it a law would be ranked by
the reference point of its penetration, not by its shape. If the housing is known, the laws that
take it have no compliance; the others are fitted without the housing. Two criteria rank the laws:

- AICc, Akaike's information criterion with the correction for few readings (Hurvich and Tsai 1989);
- the cross-validated error: each part of the data is predicted by a fit to the rest. With
  three or more series, one series is left out at a time, since its errors are alike. Otherwise, and
  where the noise has series (--group), a tenth of the rows is, drawn at random.

A law is told apart from the best only where both do so: its AICc is larger by more than 7 (Burnham
and Anderson 2002), and its cross-validated error by more than one standard error of the difference
between the two, part by part (Breiman and others 1984). The information criterion alone trusts the
noise to be as assumed. If the best misses the readings by far more than they scatter, none of
the laws describes them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.datasets.measurements import Constants, Indices
from cylcontact.fitting.campaign import Campaign, MeasuredTable, read_table
from cylcontact.fitting.findings import COMPLIANCE, LEVEL, describes, estimates_of, warnings_of
from cylcontact.fitting.law_models import RIG_NAMES, fittable_laws, is_user_law
from cylcontact.fitting.measure import fit_table
from cylcontact.fitting.noise import Covariance
from cylcontact.fitting.readings import Optimum, fit_and_starts
from cylcontact.laws.housing_spec import takes_housing
from cylcontact.support.arrays import FloatArray, as_floats, on_one_thread
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call, collect
from cylcontact.support.plain_text import advice, brief, item
from cylcontact.support.progress import Progress, silent
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from cylcontact.fitting.data_fit import DataFit
    from cylcontact.plots.figure import Drawing

# Starts of each fit; the usual start is one of them.
_STARTS = 3
_PARTS, _FEWEST_SERIES = 10, 3
# A law is told apart by more than these.
_AICC, _STANDARD_ERRORS = 7.0, 1.0
# Columns of a report on a screen.
_WIDTH = 80
# Names that a sentence lists.
_LISTED = 5
# Laws that are compared if they are named, and those that are the same for a single pair.
_IF_NAMED = ("power-one-pair", "power-clearance", "persson")
_SAME_FOR_ONE = (*_IF_NAMED, "power-dimensionless")


@dataclass(frozen=True, eq=False)
class RankedLaw:
    """A law fitted to the data: squared errors of prediction by parts, and the parts' sizes."""

    law: str
    optimum: Optimum
    aicc: float
    errors: FloatArray
    sizes: FloatArray

    @property
    def compliance(self) -> tuple[float, float]:
        """The compliance in mm/(N/mm) and its standard error, NaN where it is held."""
        errors = dict(zip(self.optimum.fit.names, self.optimum.errors.tolist(), strict=True))
        value = self.optimum.best.get("compliance", 0.0)
        return value, errors.get("compliance", np.nan)

    @property
    def cv_error(self) -> tuple[float, float]:
        """The cross-validated error in standard deviations, and its standard error."""
        mean, error = _mean(self.errors, self.sizes)
        return float(np.sqrt(mean)), float(error / (2 * np.sqrt(mean)))

    def behind(self, best: RankedLaw) -> float:
        """Return how much worse it predicts than another law, in standard errors of that."""
        mean, error = _mean(self.errors - best.errors, self.sizes)
        return mean / error if error > 0 else float(np.sign(mean)) * np.inf if mean else 0.0


def _mean(values: FloatArray, weights: FloatArray) -> tuple[float, float]:
    """Return a weighted mean and its standard error."""
    share, mean = weights / weights.sum(), np.average(values, weights=weights)
    spread = (share * (values - mean)) ** 2
    return float(mean), float(np.sqrt(spread.sum() * values.size / (values.size - 1)))


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
        """The best law and those that the data cannot distinguish from it.

        There are none if no law describes the data.
        """
        return [
            law.law
            for law in self.laws
            if self.describes
            and not (law.aicc - self.best.aicc > _AICC and law.behind(self.best) > _STANDARD_ERRORS)
        ]

    @property
    def table(self) -> pd.DataFrame:
        """The laws with their criteria, best first.

        Columns parameters (free ones and deviations), aicc, aicc_behind, weight (Akaike's),
        cv_error with cv_standard_error (in standard deviations), cv_behind (in standard
        errors of the difference), compliance with compliance_error (in mm/(N/mm)), and verdict:
        best, undecided or worse, or misses if no law describes the data. None is best where
        several are undecided.
        """
        import pandas as pd

        behind = np.array([law.aicc - self.best.aicc for law in self.laws])
        weight = np.exp(-behind / 2)
        rows = [
            {
                "parameters": law.optimum.estimated,
                "aicc": law.aicc,
                "aicc_behind": behind[k],
                "weight": weight[k] / weight.sum(),
                **dict(zip(("cv_error", "cv_standard_error"), law.cv_error, strict=True)),
                "cv_behind": law.behind(self.best),
                **dict(zip(("compliance", "compliance_error"), law.compliance, strict=True)),
                "verdict": self._verdict(law),
            }
            for k, law in enumerate(self.laws)
        ]
        return pd.DataFrame(rows, index=pd.Index([law.law for law in self.laws], name="law"))

    def _verdict(self, law: RankedLaw) -> str:
        if not self.describes:
            return "misses"
        if law.law not in self.undecided:
            return "worse"
        return "best" if len(self.undecided) == 1 else "undecided"

    def fit(self, law: str = "", jobs: int = 1) -> DataFit:
        """Return the fit of a law, by default of the best, with its intervals."""
        return fit_table(_campaign(self.data, law or self.best.law), jobs)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the data with the best laws; return the axes."""
        from cylcontact.fitting import pictures

        return pictures.plot_choice(self._optima, ax)

    def drawing(self) -> Drawing:
        """Return a figure of the data with the best laws, and beneath both less the best law."""
        from cylcontact.fitting import pictures

        return pictures.choice_drawing(self.data.name, self._optima, self.table)

    @property
    def _optima(self) -> dict[str, Optimum]:
        return {law.law: law.optimum for law in self.laws}

    def summary(self) -> str:
        """Return the report as text."""
        return str(self)

    def __str__(self) -> str:
        head = ("", "free", "AICc behind", "CV error", "compliance", "verdict")
        rows = [
            (
                str(name),
                str(row["parameters"]),
                f"{row['aicc_behind']:.1f}",
                _with_error(1.0, row["cv_error"], row["cv_standard_error"]),
                _with_error(1e6, row["compliance"], row["compliance_error"]),
                str(row["verdict"]),
            )
            for name, row in self.table.iterrows()
        ]
        notes = [f"{'-' if self.describes else '!'} {self._conclusion()}"]
        notes += [f"! {self.best.law}: {warning}" for warning in self.warnings]
        notes += [
            "- the CV error is in standard deviations of the readings by the best law, the "
            "compliance in 1e-6 mm/(N/mm)"
        ]
        notes += [f"- {note}" for note in self._on_datum()]
        notes += [f"- {law}: {why}" for law, why in self.left_out.items()]
        items = (item(note, "", _WIDTH) for note in notes)
        count = len(self.data.measurements)
        title = f"{brief(self.data.name)}: {len(self.laws)} laws fitted to {count:,} measurements"
        read = (item(line, "", _WIDTH) for line in self.data.measurements.read)
        return "\n".join([*read, title, "", str(TextTable(head, rows)), *items])

    def _conclusion(self) -> str:
        undecided = self.undecided
        if not self.describes:
            return f"none of the laws describes these readings; {self.best.law} comes nearest"
        if len(undecided) == 1:
            return (
                f"{undecided[0]} describes the data best, by AICc and by the cross-validated error "
                f"(over {self.parts})"
            )
        *first, last = undecided
        if len(undecided) > _LISTED:
            first, last = undecided[:_LISTED], f"{len(undecided) - _LISTED} more"
        exact = {"internal": "conformal", "external": "johnson"}[self.data.measurements.contact]
        solution = f" ({exact} is its elastic solution)" if exact in undecided else ""
        return (
            f"the data cannot tell {', '.join(first)} and {last} apart: AICc within {_AICC:g}, or "
            f"the cross-validated error (over {self.parts}) within {_STANDARD_ERRORS:g} standard "
            f"error of the difference; choose the law that is right for this contact{solution}, "
            "or measure at loads where they differ"
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
                "the data cannot tell the law from the compliance: these laws fit with different "
                "compliances; if you know yours, give it with --fix compliance=VALUE"
            )
        return sentences

    def _repr_html_(self) -> str:
        numbers = self.table.drop(columns=["compliance", "compliance_error"]).round(3)
        notes = (self._conclusion(), *self.warnings, *self._on_datum())
        read, below = (
            "".join(f"<p>{escape(advice(line))}</p>" for line in lines)
            for lines in (self.data.measurements.read, notes)
        )
        return f"{read}{numbers.to_html()}{below}"


def _with_error(factor: float, value: float, error: float) -> str:
    """Return a number with its standard error; one that is held has none."""
    if np.isnan(error):
        return f"{factor * value:.3g}"
    return f"{factor * value:.3g} ± {factor * error:.2g}"


def laws_for(contact: Contact, pairs: int) -> list[str]:
    """Return the laws that may be fitted to a contact; for a single pair each power law once."""
    left_out = _SAME_FOR_ONE if pairs == 1 else _IF_NAMED
    return [name for name in fittable_laws(contact) if name not in left_out]


def choose_law(
    table: MeasuredTable, names: Iterable[str] = (), progress: Progress = silent, jobs: Workers = 1
) -> Choice:
    """Fit all laws that apply to measurements, and rank them."""
    data, spec = table.measurements, table.spec
    named = list(names)
    chosen = named or laws_for(data.contact, len(data.groups("pair")[0]))
    if spec.housing is not None and not named:
        chosen = ["conformal", *(name for name in chosen if not takes_housing(name))]
    calls = [call(_fit_or_reason, table, name, bool(named)) for name in chosen]
    outcomes = dict(zip(chosen, collect(calls, jobs, progress, "fitting"), strict=True))
    fitted = {name: end for name, end in outcomes.items() if isinstance(end, Optimum)}
    left_out = {name: end for name, end in outcomes.items() if isinstance(end, str)}
    _require_some(fitted, left_out, table, "measure more, or hold some (--fix compliance=0)")
    aicc = {name: _aicc(optimum, table.source) for name, optimum in fitted.items()}
    parts, words = _parts(next(iter(fitted.values())), spec.seed)
    calls = [call(_missed, optimum, parts) for optimum in fitted.values()]
    missed = dict(zip(fitted, collect(calls, jobs, progress, "predicting"), strict=True))
    for name in [name for name in fitted if not np.isfinite(missed[name]).all()]:
        del fitted[name]
        left_out[name] = (
            "left out: cannot be cross-validated: fitted to part of the readings, its curve "
            "ends before the others or is below 0 there"
        )
    remedy = "look at the readings: a kink, an outlier or a few only?"
    _require_some(fitted, left_out, table, remedy)
    # Laws of one shape differ by round-off, and keep their order.
    order = sorted(fitted, key=lambda name: round(aicc[name], 6))
    best = fitted[order[0]]
    # Deviations are those of the best law, so that the errors of laws compare.
    scale = best.fit.noise.scale
    sizes = np.array([float(part.size) for part in parts])
    ranked = []
    for name in order:
        squares = (missed[name] / scale) ** 2
        errors = as_floats([squares[part].mean() for part in parts])
        ranked.append(RankedLaw(name, fitted[name], aicc[name], errors, sizes))
    with on_one_thread():
        warnings = tuple(warnings_of(best, estimates_of(best, spec.level or LEVEL)[0]))
    return Choice(table, tuple(ranked), left_out, words, warnings, describes(best))


def _fit_or_reason(table: MeasuredTable, name: str, is_named: bool) -> Optimum | str:
    """Return the fit of a law, or why it is left out."""
    try:
        with on_one_thread():
            optimum = _fitted(_campaign(table, name, starts=_STARTS))
            _ = optimum.log_likelihood, optimum.covariance  # singular now, or never
    except np.linalg.LinAlgError:
        return "left out: its information matrix is singular"
    except InputError as error:
        if is_named:
            raise
        key = error.key
        where = error.source.rpartition(", ")[2] if key.startswith("load, ") else key
        return f"left out: {where}: {error.rule}".replace(": : ", ": ")
    k, rows = optimum.estimated, len(table.measurements)
    if rows > k + 1:
        return optimum
    return (
        f"left out: {rows} readings are too few to rank it: it has {k} estimated numbers, and "
        f"AICc needs {k + 2} readings"
    )


def _require_some(
    fitted: Mapping[str, object], left_out: dict[str, str], table: MeasuredTable, remedy: str
) -> None:
    """Refuse measurements to which no law is left, with the reason of the first."""
    if not fitted:
        name, why = next(iter(left_out.items()))
        rule = f"no law can be ranked; {name} is {why}"
        raise InputError(table.source, "", None, rule, remedy)


def _campaign(table: MeasuredTable, law: str, starts: int | None = None) -> Campaign:
    """Return the campaign of a law with offset and, in an unknown housing, compliance free.

    The housing is only for laws that take one; your own law is scaled in stiffness like others.
    """
    changes: dict[str, object] = {} if starts is None else {"starts": starts}
    if not takes_housing(law):
        changes["housing"] = None
    spec = table.spec.model_copy(update=changes)
    freed = ["offset"] if spec.housing is not None else ["offset", "compliance"]
    if is_user_law(law) and {*spec.named} <= {*RIG_NAMES}:  # none of its own constants is searched
        freed.append("stiffness_factor")
    free = [name for name in freed if name not in spec.named]
    return replace(table, spec=spec).campaign(law, free)


def _parts(optimum: Optimum, seed: int) -> tuple[list[Indices], str]:
    """Return the parts of the data that are left out in turn, and what they are."""
    data = optimum.fit.data
    if "group" in data.data.labels and not optimum.fit.noise.model.over:
        names, index = data.groups("group")
        if len(names) >= _FEWEST_SERIES:
            return [np.flatnonzero(index == k) for k in range(len(names))], f"{len(names)} series"
    number = min(_PARTS, len(data))
    order = np.random.default_rng(seed).permutation(len(data))
    return [np.sort(part) for part in np.array_split(order, number)], f"{number} parts of the rows"


def _fitted(campaign: Campaign) -> Optimum:
    fit, starts = fit_and_starts(campaign)
    return Optimum(fit, fit.lowest(starts))


def _aicc(optimum: Optimum, source: str) -> float:
    likelihood = optimum.log_likelihood
    if likelihood is None:
        rule = "fit a law exactly (no noise), so laws cannot be ranked"
        raise InputError(source, "readings", None, rule, "fit that law")
    k, N = optimum.estimated, len(optimum.fit.data)
    return 2 * k - 2 * likelihood + 2 * k * (k + 1) / (N - k - 1)


def _missed(optimum: Optimum, parts: Sequence[Indices]) -> FloatArray:
    """Return the misses in mm of fits without each reading's part."""
    fit, missed = optimum.fit, np.empty(len(optimum.fit.data))
    with on_one_thread():
        for part in parts:
            rest = fit.take(np.setdiff1d(np.arange(missed.size), part))
            point, _ = rest.minimise(optimum.point)
            added = _of_series(Optimum(rest, point), fit.noise)
            missed[part] = (fit.differences(point[None])[0] + added)[part]
    return missed


def _of_series(rest: Optimum, noise: Covariance) -> FloatArray:
    """Return what the series add to all readings in mm, estimated from a part of them."""
    estimated, of_rest = rest.series, rest.fit.noise
    if estimated is None:
        return np.zeros(noise.load.size)
    effects = np.zeros((int(noise.series.max()) + 1, len(noise.model.effects)))
    effects[np.unique(of_rest.series)] = estimated
    return as_floats((noise.columns * effects[noise.series]).sum(axis=1))


def choose(
    data: pd.DataFrame | Path | str | Sequence[pd.DataFrame | Path | str],
    pair: CylinderPair | None = None,
    *,
    contact: Contact | None = None,
    constants: Constants | None = None,
    laws: Sequence[str] | str = (),
    fixed: Mapping[str, float] | None = None,
    jobs: Workers = 1,
    **settings: Any,
) -> Choice:
    """Fit all laws that apply to measurements, rank them, and say whether the data can tell.

    Parameters
    ----------
    data, pair, contact, constants
        As for `fit`.
    laws : str or sequence of str, optional
        The laws to compare; by default all for the contact.
    fixed : mapping of str to float, optional
        Known values: of offset, compliance, or a parameter that all these laws share.
    jobs : int or Cluster, optional
        Worker processes; the result does not depend on them.
    **settings
        As for `fit`.

    Returns
    -------
    Choice

    Raises
    ------
    InputError
        If the data or a setting is invalid, or no law can be fitted.

    Examples
    --------
    >>> import pandas as pd
    >>> import cylcontact as cc
    >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
    >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
    >>> load, noise = np.geomspace(10.0, 3000.0, 30), 1 + 0.01 * np.cos(np.arange(30))
    >>> depth = cc.laws.Explicit().penetration(load, pair) * noise
    >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": 1e3 * depth})
    >>> cc.choose(data, pair, laws=["johnson", "explicit"]).undecided
    ['explicit']
    """
    names = [laws] if isinstance(laws, str) else [*laws]
    first = names[0] if names else "johnson"
    settings |= {"fixed": dict(fixed)} if fixed else {}
    table = read_table(data, first, pair, contact, constants, **settings)
    return choose_law(table, names, jobs=jobs)
