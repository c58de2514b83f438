"""Fit results: coefficients, their quality in words, and everything needed to redo the fit."""

from __future__ import annotations

import json
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from html import escape
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.datasets.measurements import MeasuredData, Measurements, measurements_of
from cylcontact.files.reading import read_text
from cylcontact.files.spec import Spec, parse_spec, require_other_kind
from cylcontact.files.units import column_named, load_in_N_per_mm
from cylcontact.files.writing import replacing
from cylcontact.fitting.campaign import CampaignBase
from cylcontact.fitting.design import Design, design
from cylcontact.fitting.law_models import fitted_law, units_of, user_model, with_rig
from cylcontact.fitting.measured import Fit
from cylcontact.fitting.optimum import Optimum
from cylcontact.fitting.records import (
    FAIRLY,
    SAME_BASIN,
    TOLERANCE,
    WELL,
    Ends,
    Interval,
    MaxDifference,
    ObjectiveValue,
    Profile,
    Published,
    RunRecord,
    SampleCounts,
    Uncertainty,
    same_basin,
)
from cylcontact.fitting.table_campaign import TableCampaign, campaign_of
from cylcontact.fitting.words import (
    OBJECTIVE_UNITS,
    OBJECTIVE_WORDS,
    WIDTH,
    Rows,
    item,
    label_of,
    noise_verdicts,
    noise_warnings,
    or_dash,
)
from cylcontact.laws.adapters import RigCompliance
from cylcontact.laws.law import ContactLaw
from cylcontact.support.arrays import as_floats
from cylcontact.support.errors import InputError, short
from cylcontact.support.plain_text import advice, as_label, brief
from cylcontact.support.text_tables import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from cylcontact.plots.figure import Drawing

# A coefficient this close to a bound, relative to the search interval, is at the bound.
_AT_BOUND = 1e-6
# The version of result files, and what only the files of the version before have.
_FORMAT = 2
_FORMER = ("kind", "bound", "profiles")


class FitResult(Spec):
    """What a fit gives: a `LawFit` of a law to a law, or a `DataFit` to readings.

    `print(result)` gives the report, and a notebook shows it. `to_law` returns the fitted law.
    """

    name: str
    law: str
    contact: Contact
    # A law, or "measurements".
    reference: str
    coefficients: dict[str, float]
    objective: ObjectiveValue
    published: Published | None
    max_abs_diff_percent: MaxDifference
    runs: list[RunRecord]
    counts: SampleCounts
    # The campaign and the grid, or the data, as run; then versions and hashes.
    settings: dict[str, Any]
    provenance: dict[str, Any]

    # The objective below which the law follows the samples exactly.
    round_off: ClassVar[float]

    @classmethod
    def read(cls, path: Path | str) -> Self:
        """Read a result file, of this version of the program or an older one.

        Raises
        ------
        InputError
            If the file cannot be read, is not a result, is of a newer format, or is inconsistent.
        """
        source = str(path)
        text = read_text(path, "name a result, a JSON file")
        try:
            data = json.loads(text)
        except (ValueError, RecursionError) as error:
            require_other_kind(path, text, "a fit result")
            rule = f"is not JSON ({error})"
            raise InputError(source, "", None, rule, "name a result, or redo the fit") from error
        if not isinstance(data, dict):
            raise InputError(source, "", None, "is not a result", "name one that a fit has written")
        kind: type[FitResult] = LawFit
        settings = data.get("settings")
        if isinstance(settings, dict) and "measurements" in settings:
            kind, data = DataFit, _without_gone(data)
        result = parse_spec(kind, _of_this_format(data, source), source)
        if not isinstance(result, cls):
            what = "readings" if cls is DataFit else "a law"
            rule, remedy = f"is not a fit to {what}", f"name a fit to {what}"
            raise InputError(source, "", None, rule, remedy)
        result.require_consistent(source)
        return result

    def save(self, path: Path | str) -> None:
        """Write the result as JSON, complete or not at all."""
        with replacing(path) as temporary:
            self.write(temporary)

    def to_json(self) -> str:
        """Return the result as JSON, as `save` writes it."""
        contents = {"format": _FORMAT, **self.model_dump()}
        return json.dumps(contents, indent=1, ensure_ascii=False, allow_nan=False)

    def write(self, path: Path | str) -> None:
        """Write the result as JSON to a file that is not yet in its place."""
        try:
            Path(path).write_text(self.to_json() + "\n", encoding="utf-8")
        except UnicodeEncodeError as error:
            source = f"fit result {self.name!r}"
            raise InputError(source, "", None, "is not text in UTF-8", "rename it") from error

    def require_consistent(self, source: str) -> None:
        """Raise `InputError` unless the coefficients are those of the campaign."""
        names = campaign_of(self.name, self.settings, source).model.names
        sets = {"coefficients": self.coefficients}
        if self.published is not None:
            sets["published.coefficients"] = self.published.coefficients
        for key, coefficients in sets.items():
            if set(coefficients) != set(names):
                rule = f"must be the coefficients of its campaign: {', '.join(names)}"
                raise InputError(source, key, sorted(coefficients), rule, "redo the fit")
        if not self.runs:
            raise InputError(source, "runs", [], "must hold at least one run", "redo the fit")

    def to_law(self, source: str = "") -> ContactLaw:
        """Return the fitted law of the contact, without the offset and compliance of the rig.

        Parameters
        ----------
        source : str, optional
            The result's file, for errors; by default its name.

        Raises
        ------
        InputError
            If the law is a Python function of your own.
        """
        housing = self.settings["campaign"].get("housing")
        return fitted_law(self.law, self.contact, self.coefficients, housing, source or self.name)

    def repeatable(self) -> dict[str, Any]:
        """Return what the same seed reproduces: everything but times and provenance."""
        data = self.model_dump(exclude={"provenance"})
        for run in data["runs"]:
            del run["seconds"]
        return data

    # --- in words -----------------------------------------------------------------------------

    @property
    def ties(self) -> dict[str, str]:
        """The expressions that set coefficients, by name."""
        return self.settings["campaign"].get("ties") or {}

    @property
    def fixed(self) -> list[str]:
        """The coefficients that the campaign fixes at a value."""
        return list(self.settings["campaign"]["fixed"])

    @property
    def objective_unit(self) -> str:
        """The unit of the objective, empty if it is relative."""
        return OBJECTIVE_UNITS.get(self.objective.name, "")

    @property
    def objective_words(self) -> str:
        """What the objective is."""
        return OBJECTIVE_WORDS.get(self.objective.name, self.objective.name)

    @property
    def units(self) -> dict[str, str]:
        """The units of the coefficients that have one, by name."""
        return units_of(self.law, self.contact)

    def basins(self) -> list[tuple[float, int]]:
        """Return the distinct objectives of the runs, best first, and the runs at each."""
        counts: list[tuple[float, int]] = []
        for record in sorted(self.runs, key=lambda record: record.objective):
            if counts and same_basin(record, counts[-1][0], self.round_off):
                counts[-1] = (counts[-1][0], counts[-1][1] + 1)
            else:
                counts.append((record.objective, 1))
        return counts

    def identification(self, name: str) -> str:
        """Return "well", "fairly", "poorly", "not", "at a bound", "fixed", a tie, or "-"."""
        return f"= {self.ties[name]}" if name in self.ties else self._verdict(name)

    @abstractmethod
    def _verdict(self, name: str) -> str: ...

    @property
    @abstractmethod
    def warnings(self) -> list[str]:
        """What makes the result doubtful, with the remedy."""

    @property
    @abstractmethod
    def verdicts(self) -> list[str]:
        """Sentences on the quality of the fit, computed from its numbers, most important first."""

    @property
    def _unwarned(self) -> list[str]:
        return [sentence for sentence in self.verdicts if sentence not in self.warnings]

    @property
    @abstractmethod
    def headline(self) -> str:
        """What was fitted to what."""

    @property
    def status(self) -> str:
        """In a line whether the fit can be taken as it is; empty for a fit to a law."""
        return ""

    @abstractmethod
    def _table(self) -> tuple[tuple[str, ...], Rows]:
        """Return the headings and the rows of the report's table."""

    @abstractmethod
    def _ends(self, name: str) -> Ends | None:
        """Return the interval of a coefficient; None without one."""

    def _error(self, _: str) -> float | None:
        """Return the standard error of a coefficient; None without one."""
        return None

    @abstractmethod
    def _draw_profile(self, name: str, axes: Axes) -> None:
        """Draw the profile of a coefficient."""

    def plot_profile(self, name: str, ax: Axes | None = None) -> Axes:
        """Draw how much worse the fit gets when a coefficient moves and all others follow.

        Parameters
        ----------
        name : str
            A coefficient that was searched.
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a figure of its own.
        """
        from cylcontact.plots.arguments import axes_for
        from cylcontact.plots.style import ACCENT

        if self._ends(name) is None:
            known = [each for each in self.coefficients if self._ends(each) is not None]
            rule = "has no profile: it was not searched, or the data do not determine it"
            remedy = f"choose {', '.join(known)}" if known else "free it"
            raise InputError(f"fit result {self.name!r}", "name", name, rule, remedy)
        unit = self.units.get(name)
        with axes_for(ax, "plot_profile", "column", 60.0) as axes:
            self._draw_profile(name, axes)
            axes.axvline(self.coefficients[name], color=ACCENT, linestyle="--", marker="")
            axes.set_xlabel(f"{as_label(name)} ({unit})" if unit else as_label(name))
        return axes

    def to_frame(self) -> pd.DataFrame:
        """Return the coefficients as a table.

        Returns
        -------
        pandas.DataFrame
            A row for each coefficient: value, unit, standard_error, low, high (the ends of the
            interval; NaN for one that was not searched), and verdict.
        """
        rows = {}
        for name, value in self.coefficients.items():
            error, ends = self._error(name), self._ends(name)
            rows[name] = {
                "value": value,
                "unit": self.units.get(name, ""),
                "standard_error": np.nan if error is None else error,
                "low": np.nan if ends is None else ends.low,
                "high": np.nan if ends is None else ends.high,
                "verdict": self.identification(name),
            }
        return pd.DataFrame.from_dict(rows, orient="index")

    def summary(self) -> str:
        """Return the report as text, as `print` shows it."""
        return str(self)

    @property
    def _read(self) -> list[str]:
        """Lines that say what was read of a table; empty for a fit to a law."""
        return []

    def __str__(self) -> str:
        return "\n".join(
            [
                *(item(line, "") for line in self._read),
                fill(self.headline, WIDTH),
                *([self.status] if self.status else []),
                *(item(sentence, "! ") for sentence in self.warnings),
                "",
                str(Table(*self._table())),
                *map(item, self._unwarned),
            ]
        )

    def __repr__(self) -> str:
        return (
            f"{type(self).__name__}({self.name!r}, {self.objective.name} = "
            f"{self.objective.value:.6g}, coefficients={self.coefficients})"
        )

    def _repr_html_(self) -> str:
        items = "".join(f"<li>{escape(sentence)}</li>" for sentence in self._unwarned)
        status = f"<p>{escape(self.status)}</p>" if self.status else ""
        style = "border-left: 4px solid #D55E00; padding-left: 0.5em"
        warned = "".join(f'<p style="{style}">{escape(sentence)}</p>' for sentence in self.warnings)
        read = "".join(f"<p>{escape(advice(line))}</p>" for line in self._read)
        return (
            f"{read}<p>{escape(self.headline)}</p>{status}{warned}"
            f"{Table(*self._table())._repr_html_()}<ul>{items}</ul>"
        )

    def _on_disagreement(self, poor: Sequence[str], how: str) -> list[str]:
        (_, agreeing), *_ = self.basins()
        runs = len(self.runs)
        if 2 * agreeing >= runs:
            return []
        held = " or ".join(poor) or "a coefficient"
        return [
            f"only {agreeing} of {runs} runs reached the best objective within 0.1 %, so a lower "
            f"one may have been missed: make more runs (--runs {4 * runs}), or hold {held} at a "
            f"value ({how})"
        ]

    def _on_runs(self) -> list[str]:
        (_, agreeing), *others = self.basins()
        sentences = [f"{agreeing} of {len(self.runs)} runs reached the best objective within 0.1 %"]
        if others:
            objectives = ", ".join(f"{objective:.4g} ({count})" for objective, count in others)
            sentences.append(f"the others ended in other basins, at (runs): {objectives}")
        return sentences


class LawFit(FitResult):
    """A law fitted to a law; `calibrate` has an example."""

    # The per-clearance lower bound of the objective, for power laws.
    bound: float | None
    profiles: dict[str, Profile]

    round_off: ClassVar[float] = 1e-6  # moments have half of the digits

    def _draw_profile(self, name: str, axes: Axes) -> None:
        from cylcontact.plots.style import QUIET

        profile = self.profiles[name]
        axes.plot(profile.values, profile.objective, marker="", linestyle="-")
        limit = (1 + TOLERANCE) * self.objective.value
        axes.axhline(limit, color=QUIET, linestyle=":", marker="")
        axes.set_ylabel(f"best {as_label(self.objective.name)}")

    def _verdict(self, name: str) -> str:
        if name not in self.profiles:
            return "fixed" if self.profiles or name in self.fixed else "-"
        return self.profiles[name].verdict(self.coefficients[name])

    def _ends(self, name: str) -> Profile | None:
        return self.profiles.get(name)

    @property
    def headline(self) -> str:
        """What was fitted to what."""
        return (
            f"{brief(self.name)}: {brief(self.law)} law, {self.contact} contact, fitted to "
            f"{self.reference} by the {self.objective_words} on {self.counts.samples:,} samples "
            f"({self.counts.masked:,} masked by the reference's domain)"
        )

    @property
    def warnings(self) -> list[str]:
        """What makes the result doubtful: fewer than half of the runs at the best."""
        return self._on_disagreement(self._poor, "[fixed] in the campaign, or --fix")

    @property
    def verdicts(self) -> list[str]:
        """Sentences on the fit, most important first.

        They are its `warnings`; then they state whether the published coefficients are the optimum,
        how far the fit is from the lower bound, which coefficients are well identified, which are
        at a bound, and how many runs agree.
        """
        above = ""
        if self.bound:
            above = (
                f"the fit is {100 * (self.objective.value / self.bound - 1):.1f} % above the lower "
                f"bound {self.bound:.4g}, reached with K* and n fitted separately at each clearance"
            )
        sentences = [
            *self.warnings,
            self._on_published(),
            above,
            self._on_identification(),
            *self._on_search_bounds(),
            *self._on_runs(),
        ]
        return [sentence for sentence in sentences if sentence]

    def _table(self) -> tuple[tuple[str, ...], Rows]:
        """Return the headings and the rows of the report's table.

        The penalty is the relative rise of the best objective when a coefficient is fixed at its
        published value.
        """
        columns = ("", "fitted", "published", "penalty at published", "within 1 %", "identified")
        published, optimum = self.published, self.objective.value
        rows: Rows = []
        for name, value in self.coefficients.items():
            paper = f"{published.coefficients[name]:g}" if published else "-"
            interval = penalty = ""
            if name in self.profiles:
                profile = self.profiles[name]
                interval = profile.interval
                if profile.objective_at_published is not None:
                    penalty = f"{profile.objective_at_published / optimum - 1:+.1%}"
            label = label_of(name, self.units.get(name, ""))
            verdict = self.identification(name)
            rows.append((label, f"{value:.5g}", paper, penalty, interval, verdict))
        paper = f"{published.objective:.5g}" if published else "-"
        bound = f"bound {self.bound:.5g}" if self.bound is not None else ""
        label = label_of(self.objective_words, self.objective_unit)
        rows.append((label, f"{optimum:.5g}", paper, "", bound, ""))
        worst = self.max_abs_diff_percent
        largest = (or_dash(worst.fitted, ".4g"), or_dash(worst.published))
        return columns, [*rows, ("largest difference, %", *largest, "", "", "")]

    def _on_published(self) -> str:
        if self.published is None:
            return ""
        published, best = self.published.objective, self.objective.value
        if published <= best * (1 + SAME_BASIN) + self.round_off:
            return "the published coefficients are the optimum on this grid, within 0.1 %"
        ratio = published / best
        excess = f"{100 * (ratio - 1):.1f} % above" if ratio < 1.1 else f"{ratio:.2f} times"
        searched = f"only {' and '.join(self.profiles)} free"
        if not self.fixed and not self.ties:
            searched = "all coefficients free"
        return (
            f"with {searched} the published coefficients are not the optimum on this grid: "
            f"their objective is {published:.4g}, {excess} the fitted one"
        )

    @property
    def _poor(self) -> list[str]:
        return [name for name in self.profiles if self.identification(name) == "poorly"]

    def _on_identification(self) -> str:
        if not self.profiles:
            return ""
        if not self._poor:
            return "every coefficient inside its bounds is at least fairly identified"
        return (
            f"poorly identified: {', '.join(self._poor)} (the best objective rises by less than "
            f"{100 * TOLERANCE:g} % while the coefficient moves by more than {100 * FAIRLY:g} % of "
            f"its value, or to a bound; well identified is {100 * WELL:g} %)"
        )

    def _on_search_bounds(self) -> list[str]:
        sentences = []
        for name, ends in self.settings["campaign"]["bounds"].items():
            margin = _AT_BOUND * (ends[1] - ends[0])
            for bound, end in zip(("lower", "upper"), ends, strict=True):
                if abs(self.coefficients[name] - end) <= margin:
                    sentences.append(f"{name} is at its {bound} bound {end:g}: widen it")
        return sentences


class DataFit(FitResult):
    """A law fitted to readings, with the uncertainty of its coefficients; from `cylcontact.fit`.

    `print(result)` gives the report, and a notebook shows it with its picture.
    """

    uncertainty: Uncertainty

    round_off: ClassVar[float] = 1e-12

    # --- the fit itself -----------------------------------------------------------------------

    @cached_property
    def optimum(self) -> Optimum:
        """The fit at its best parameters, with its residuals and their derivatives.

        Raises
        ------
        InputError
            If it was read from a file and has a law of your own: `with_law` names that again.
        """
        return self._optimum(None)

    def with_law(self, law: str) -> Self:
        """Return the result with its law, a function of your own, run again.

        The current folder is searched first.

        Raises
        ------
        InputError
            If that is not its law.
        """
        if law != self.law:
            rule, remedy = f"is not its law, {self.law}", "leave --law out, or name that one"
            raise InputError(f"fit result {self.name!r}", "law", law, rule, remedy)
        return self.with_optimum(self._optimum(law))

    def with_optimum(self, optimum: Optimum) -> Self:
        """Return the result, which remembers the fit that it is of, with a law of your own too."""
        self.__dict__["optimum"] = optimum
        return self

    def __getstate__(self) -> dict[Any, Any]:
        # The fit holds functions, and is made again where it is needed.
        state = super().__getstate__()
        fields = {k: v for k, v in state["__dict__"].items() if k != "optimum"}
        return {**state, "__dict__": fields}

    def _optimum(self, law: str | None) -> Optimum:
        source = f"fit result {self.name!r}"
        campaign = TableCampaign.of_settings(self.name, self.settings, source)
        if law is not None:
            model = user_model(law, self.contact, source, Path.cwd())
            campaign = replace(campaign, model=with_rig(model, campaign.spec.named))
        fit: Fit = campaign.plain
        if campaign.noise is not None and self.uncertainty.noise is not None:
            deviations = self.uncertainty.noise.deviations
            fit = fit.with_noise(campaign.noise, self.coefficients, deviations)
        if not np.isfinite(fit.value_of(self.coefficients)):
            rule = "leave the law undefined for some of the data"
            raise InputError(source, "coefficients", self.coefficients, rule, "redo the fit")
        return Optimum.of(fit, self.coefficients)

    @cached_property
    def data(self) -> Measurements:
        """The measurements; `data.read` says what was read of the table."""
        where = f"fit result {self.name!r}, settings.measurements"
        settings = self.settings["measurements"]
        return measurements_of(parse_spec(MeasuredData, settings, where), where)

    @property
    def _read(self) -> list[str]:
        return self.data.read

    # --- tables -------------------------------------------------------------------------------

    @property
    def residuals(self) -> pd.DataFrame:
        """The data beside the fit, a row for each measurement.

        Columns line, the labels of the table, load_N_per_mm, penetration_mm, fitted_mm, residual_mm
        (measured less fitted), standardised (in standard deviations), and with series series_mm,
        what the series adds to the law.
        """
        optimum = self.optimum
        fit, data = optimum.fit, optimum.fit.data
        size = 1.0 if optimum.known or fit.noise is not None else optimum.sigma
        columns: dict[str, object] = {"line": [data.line(k) for k in range(len(data))]}
        for name, words in data.data.labels.items():
            columns[name] = [words[int(row) % len(words)] for row in data.rows]
        columns |= {
            "load_N_per_mm": data.load,
            "penetration_mm": data.penetration,
            "fitted_mm": fit.observed + optimum.differences,
            "residual_mm": -optimum.differences,
            "standardised": -optimum.r / size if size > 0 else np.zeros(len(data)),
        }
        if optimum.series_in_mm is not None:
            columns["series_mm"] = optimum.series_in_mm
        return pd.DataFrame(columns)

    def predict(
        self,
        load: ArrayLike | str | Sequence[str],
        level: float | None = None,
        pair: CylinderPair | None = None,
    ) -> pd.DataFrame:
        """Return what the fitted law predicts for readings, with bands.

        Parameters
        ----------
        load : array_like, str or sequence of str
            Loads in N/mm, or with their unit, such as "4500 N".
        level : float, optional
            Of the bands, between 0 and 1; by default that of the fit.
        pair : CylinderPair, optional
            Any pair of the same contact; by default those of the data.

        Returns
        -------
        pandas.DataFrame
            Columns load_N_per_mm, penetration_mm, low_mm and high_mm (band of a new reading),
            curve_low_mm and curve_high_mm (band of the curve), and beyond (whether the load is
            beyond the readings). Where the table has other units, the load, the penetration and
            the band of a new reading in these as well. Where the data have several pairs and none
            is given, rows for each, named in the column pair.

        Raises
        ------
        InputError
            If the coefficients have no covariance, or the law is undefined at a load.
        """
        level = self._level(level)
        if pair is not None and pair.contact != self.contact:
            rule, remedy = f"is not {self.contact}, as the fit is", "give a pair of its contact"
            raise InputError("prediction", "pair.contact", pair.contact, rule, remedy)
        data = self.optimum.fit.data
        if pair is None:
            names, groups = data.groups("pair")
            rows = [np.flatnonzero(groups == k) for k in range(len(names))]
            tables = [self.predict(load, level, _pair_of(data.take(own))) for own in rows]
            named = [table.assign(pair=name) for name, table in zip(names, tables, strict=True)]
            return tables[0] if len(names) == 1 else pd.concat(named, ignore_index=True)
        texts = [load] if isinstance(load, str) else load
        if isinstance(texts, Sequence) and all(isinstance(text, str) for text in texts):
            length = None if pair.length is None else float(np.ravel(pair.length)[0])
            texts = [load_in_N_per_mm(str(text), length) for text in texts]
        loads = np.atleast_1d(as_floats(texts))
        ends = self.optimum.band(pair, level, load=loads)
        table = pd.DataFrame(
            {
                "load_N_per_mm": loads,
                "penetration_mm": ends.value,
                "low_mm": ends.new_low,
                "high_mm": ends.new_high,
                "curve_low_mm": ends.low,
                "curve_high_mm": ends.high,
                "beyond": (loads < data.load.min()) | (loads > data.load.max()),
            }
        )
        return table.assign(**self._in_units_of_the_table(table, pair))

    def _in_units_of_the_table(
        self, table: pd.DataFrame, pair: CylinderPair
    ) -> dict[str, pd.Series[float]]:
        units, columns = self.optimum.fit.data.data.units, {}
        load = column_named(f"load_{units.get('load', '')}")
        if load is not None and load.unit != "N_per_mm" and not (load.is_total and not pair.length):
            length = pair.length if load.is_total and pair.length is not None else 1.0
            columns[load.name] = table["load_N_per_mm"] * length / load.factor
        depth = column_named(f"penetration_{units.get('penetration', '')}")
        if depth is not None and depth.unit != "mm":
            for name in ("penetration", "low", "high"):
                columns[f"{name}_{depth.unit}"] = table[f"{name}_mm"] / depth.factor
        return columns

    def interval(
        self, function: Callable[[ContactLaw], ArrayLike], level: float | None = None
    ) -> pd.DataFrame:
        """Return the interval of any number that follows from the fitted law.

        Parameters
        ----------
        function : callable
            From the law of the contact, without the rig, to a number or to m of them, such as a
            stiffness at a load or the penetration at the peak of a joint.
        level : float, optional
            Of the interval, between 0 and 1; by default that of the fit.

        Returns
        -------
        pandas.DataFrame
            A row for each number: value, standard_error, low and high, by the delta method.

        Raises
        ------
        InputError
            If the coefficients have no covariance.

        Examples
        --------
        >>> import cylcontact as cc
        >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
        >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
        >>> load, noise = np.geomspace(10.0, 1000.0, 9), 1 + 0.01 * np.cos(np.arange(9))
        >>> depth = cc.laws.Explicit().penetration(load, pair) * noise
        >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": 1e3 * depth})
        >>> result = cc.fit(data, "explicit", pair)
        >>> print(result.interval(lambda law: 1e3 * law.penetration(500.0, pair)).round(3))
           value  standard_error    low   high
        0  4.993           0.016  4.954  5.031
        """

        def of_contact(law: ContactLaw) -> ArrayLike:
            return function(law.base if isinstance(law, RigCompliance) else law)

        value, variance, reach = self.optimum.propagated(of_contact, self._level(level))
        error = np.sqrt(variance)
        columns = {"value": value, "standard_error": error}
        return pd.DataFrame(
            {**columns, "low": value - reach * error, "high": value + reach * error}
        )

    def design(
        self,
        candidates: ArrayLike,
        add: int = 5,
        *,
        dR: ArrayLike | None = None,
        parameter: str | None = None,
        level: float | None = None,
    ) -> Design:
        """Return which further readings would narrow the intervals most.

        Parameters
        ----------
        candidates : array_like
            Loads in N/mm at which readings can be taken.
        add : int
            How many readings are to be added, as one new series.
        dR : array_like, optional
            Clearances in mm at which they can be taken; by default that of the first reading.
        parameter : str, optional
            The parameter whose interval counts; by default all together.
        level : float, optional
            Of the intervals, between 0 and 1; by default that of the fit.

        Raises
        ------
        InputError
            If the coefficients have no covariance, or the law is undefined at a candidate.

        Examples
        --------
        A modulus is known best from readings at large loads:

        >>> import cylcontact as cc
        >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
        >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
        >>> load, noise = np.geomspace(10.0, 200.0, 9), 0.01 * np.cos(np.arange(9))
        >>> depth = 1e3 * cc.laws.Explicit().penetration(load, pair) + noise
        >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": depth})
        >>> result = cc.fit(data, "explicit", pair, noise="constant")
        >>> result.design([10.0, 50.0, 200.0], add=2, parameter="stiffness_factor").readings
           load_N_per_mm  dR_mm  number
        0          200.0   0.03       2
        """
        loads = np.atleast_1d(as_floats(candidates))
        clearances = None if dR is None else np.atleast_1d(as_floats(dR))
        return design(self.optimum, loads, clearances, add, parameter, self._level(level))

    @property
    def correlation(self) -> pd.DataFrame:
        """Correlations of the free coefficients."""
        return pd.DataFrame(self.uncertainty.correlation)

    @property
    def aic(self) -> float:
        """Akaike's information criterion, 2k − 2·ln L, k with the deviations of the noise."""
        return 2 * self._of_uncertainty("estimated") - 2 * self._of_uncertainty("log_likelihood")

    @property
    def bic(self) -> float:
        """The Bayesian information criterion, k·ln N − 2·ln L."""
        k, N = self._of_uncertainty("estimated"), self.uncertainty.rows
        return float(k * np.log(N) - 2 * self._of_uncertainty("log_likelihood"))

    @property
    def r_squared(self) -> float:
        """Share of the variance of the readings that the law describes."""
        return self._of_uncertainty("r_squared")

    def _level(self, level: float | None) -> float:
        """Return a level that was asked for, or that of the fit."""
        level = self.level if level is None else level
        if not 0 < level < 1:
            rule, remedy = "must lie between 0 and 1", "0.95 is common"
            raise InputError(f"fit result {self.name!r}", "level", level, rule, remedy)
        return level

    @property
    def level(self) -> float:
        """The level of the intervals."""
        return self.uncertainty.level

    def _of_uncertainty(self, name: str) -> float:
        value = getattr(self.uncertainty, name)
        if value is None:
            rule = (
                "is not there, as the data follow the law exactly or an older version fitted them"
            )
            raise InputError(f"fit result {self.name!r}", name, None, rule, "fit the data again")
        return float(value)

    # --- pictures -----------------------------------------------------------------------------

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the data, the fitted law and the band of a new reading; return the axes.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a figure of its own.
        """
        from cylcontact.fitting import pictures

        return pictures.plot(self.optimum, self.law, self.level, ax)

    def plot_residuals(self, ax: Axes | None = None) -> Axes:
        """Draw the residuals over the load; `ax` as for `plot`."""
        from cylcontact.fitting import pictures

        data, outliers = self.optimum.fit.data, self.uncertainty.outliers
        return pictures.plot_residuals(data, self.residuals, outliers, ax)

    def _draw_profile(self, name: str, axes: Axes) -> None:
        from cylcontact.plots.style import QUIET

        ends = self.uncertainty.estimates[name].profile
        assert ends is not None
        values, root, limit = self.optimum.profile(name, ends, self.level)
        axes.plot(values, root, marker="", linestyle="-")
        axes.axhline(limit, color=QUIET, linestyle=":", marker="")
        for end in (ends.low, ends.high):
            axes.axvline(end, color=QUIET, linestyle="--", marker="", linewidth=0.8)
        axes.set_ylabel("rise of the objective (std. dev.)")

    def drawing(self) -> Drawing:
        """Return a figure of the data with the law and its band, the residuals beneath.

        Its table is that of the residuals, its headline the free coefficients.
        """
        from cylcontact.fitting import pictures
        from cylcontact.plots.figure import Drawing

        figure = pictures.two_panels(96.0, 2.4, self.plot, self.plot_residuals)
        values = ", ".join(f"{name} = {value:.4g}" for name, value in self.free.items())
        residuals = self.residuals
        caption = (
            f"{brief(self.name)}: {len(residuals)} measurements, the {brief(self.law)} law fitted "
            f"to them ({values}), and the band of {100 * self.level:g} % of new readings; beneath, "
            "measured less fitted in standard deviations."
        )
        return Drawing(figure, residuals, self.free, caption)

    def _repr_html_(self) -> str:
        from cylcontact.plots.style import figure_style

        try:
            with figure_style():
                return super()._repr_html_() + self.drawing()._repr_html_()
        except InputError:  # the result was read from a file, and the law is a user's own
            return super()._repr_html_()

    # --- in words -----------------------------------------------------------------------------

    @property
    def free(self) -> dict[str, float]:
        """The coefficients that were searched."""
        return {name: self.coefficients[name] for name in self.uncertainty.estimates}

    @property
    def objective_unit(self) -> str:
        """The unit of the objective, empty if it is relative."""
        return "std. dev." if self.uncertainty.sigma_known else super().objective_unit

    def _verdict(self, name: str) -> str:
        estimate = self.uncertainty.estimates.get(name)
        return "fixed" if estimate is None else estimate.verdict

    def _error(self, name: str) -> float | None:
        estimate = self.uncertainty.estimates.get(name)
        return None if estimate is None else estimate.standard_error

    def _ends(self, name: str) -> Interval | None:
        estimate = self.uncertainty.estimates.get(name)
        return None if estimate is None else estimate.profile

    @property
    def headline(self) -> str:
        """What was fitted to what."""
        return (
            f"{brief(self.name)}: {brief(self.law)} law, {self.contact} contact, fitted to "
            f"{self.counts.samples:,} measurements by the {self.objective_words}"
        )

    @property
    def status(self) -> str:
        """In a line whether the fit can be taken as it is."""
        uncertainty, verdicts = self.uncertainty, [self.identification(name) for name in self.free]
        poor = verdicts.count("poorly") + verdicts.count("not")
        parts = [
            f"{self.basins()[0][1]} of {len(self.runs)} runs agree",
            f"{verdicts.count('at a bound') or 'none'} at a bound",
            f"{poor or 'none'} ill determined",
        ]
        if uncertainty.r_squared is not None:
            parts.append(f"R² = {uncertainty.r_squared:.5f}")
        if uncertainty.log_likelihood is not None:
            parts.append(f"AIC = {self.aic:.1f}, BIC = {self.bic:.1f}")
        return " · ".join(parts)

    @property
    def warnings(self) -> list[str]:
        """What makes the result doubtful, with the remedy.

        Tests of the noise that fail, with the option that allows for it, parameters that are at a
        bound or not determined, and fewer than half of the runs at the best.
        """
        disagreement = self._on_disagreement((), "--fix NAME=VALUE")
        sentences = map(advice, [*noise_warnings(self.uncertainty), *disagreement])
        return [sentence.replace("runs=", "starts=") for sentence in sentences]

    @property
    def verdicts(self) -> list[str]:
        """Sentences on the fit, most important first.

        They state how large the noise is, which parameters are determined, which are correlated,
        which rows are duplicates, what the published constants give, and how many runs agree.
        """
        sentences = [
            *noise_verdicts(self.uncertainty),
            self._on_published(),
            *self._on_runs(),
        ]
        return [advice(sentence) for sentence in sentences if sentence]

    def _on_published(self) -> str:
        if self.published is None:
            return ""
        return (
            f"on these data the law has an objective of {self.published.objective:.4g} with its "
            f"published constants, and {self.objective.value:.4g} fitted"
        )

    def __str__(self) -> str:
        return "\n\n".join([super().__str__(), *self._series_table()])

    def _series_table(self) -> list[str]:
        series = self.uncertainty.noise.series if self.uncertainty.noise else []
        if len(series) < 2:
            return []
        names = {
            "offset": ("offset, µm", 1e3),
            "gain": ("gain, %", 100.0),
            "drift": ("drift, µm", 1e3),
        }
        shown = list(series[0].effects)
        rows = [
            (one.name, str(one.rows), *(f"{names[k][1] * one.effects[k]:.3g}" for k in shown))
            for one in series
        ]
        return [str(Table(("series", "readings", *(names[k][0] for k in shown)), rows))]

    def _table(self) -> tuple[tuple[str, ...], Rows]:
        published, level = self.published, f"{100 * self.level:g} % interval"
        rows: Rows = []
        # The free ones first: the others are the law's own constants.
        for name in sorted(self.coefficients, key=lambda name: name not in self.free):
            error, ends = or_dash(self._error(name), ".2g", ""), self._ends(name)
            interval = "" if ends is None else f"{ends.low:.5g} … {ends.high:.5g}{ends.cut}"
            paper = f"{published.coefficients[name]:.5g}" if published else ""
            value, unit = f"{self.coefficients[name]:.5g}", self.units.get(name, "")
            rows.append((name, value, unit, error, interval, paper, self.identification(name)))
        paper = f"{published.objective:.5g}" if published else ""
        value = f"{self.objective.value:.5g}"
        rows.append((self.objective_words, value, self.objective_unit, "", "", paper, ""))
        if min(self.settings["measurements"]["numbers"]["penetration"]) > 0:
            # Of readings about zero a relative difference says nothing.
            worst = self.max_abs_diff_percent
            fitted, paper = or_dash(worst.fitted, ".4g"), or_dash(worst.published)
            rows.append(("largest difference", fitted, "%", "", "", paper, ""))
        columns = ("", "fitted", "unit", "std. error", level, "published", "determined")
        if published:
            return columns, rows
        return (*columns[:5], columns[6]), [(*row[:5], row[6]) for row in rows]


# --- pieces -----------------------------------------------------------------------------------


def _of_this_format(data: dict[str, Any], source: str) -> dict[str, Any]:
    """Return the contents of a result file without their version; rewrite those of the first."""
    version = data.get("format", 1)
    if version not in (1, _FORMAT):
        rule = f"is not a version that this cylcontact reads, 1 or {_FORMAT}"
        remedy = "read it with the cylcontact that wrote it, or redo the fit"
        raise InputError(source, "format", version, rule, remedy)
    contents = {key: value for key, value in data.items() if key != "format"}
    settings: Any = contents.get("settings")
    campaign: Any = settings.get("campaign") if isinstance(settings, dict) else None
    if not isinstance(campaign, dict) or not isinstance(campaign.get("parameters"), dict):
        return contents
    tables = campaign["parameters"]
    former = ("parameters", "optimizer", *(["genetic"] if "measurements" in settings else []))
    new = {key: value for key, value in campaign.items() if key not in former} | {
        "bounds": {k: [t["low"], t["high"]] for k, t in tables.items() if not t.get("fixed")},
        "fixed": {k: t["value"] for k, t in tables.items() if t.get("fixed")},
        "ties": campaign.get("ties") or {},
    }
    return {**contents, "settings": {**settings, "campaign": new}}


def _without_gone(data: dict[str, Any]) -> dict[str, Any]:
    """Return the contents of a fit to readings without the keys that are gone."""
    data = {key: value for key, value in data.items() if key not in _FORMER}
    settings, uncertainty = data["settings"], data.get("uncertainty")
    if isinstance(uncertainty, dict) and uncertainty.get("loss_scale") is None:
        gone = ("loss_scale", "runs_test_p")
        kept = {key: value for key, value in uncertainty.items() if key not in gone}
        data |= {"uncertainty": kept}
    campaign = settings.get("campaign")
    if isinstance(campaign, dict) and campaign.get("loss") in (None, "linear"):
        kept = {key: v for key, v in campaign.items() if key not in ("loss", "loss_scale")}
        data |= {"settings": {**settings, "campaign": kept}}
    return data


def _pair_of(data: Measurements) -> CylinderPair:
    """Return the pair of rows of one pair, without a length if they have several."""
    pair, lengths = data.take(np.array([0])).pair, data.columns.get("length")
    return pair if lengths is None or np.ptp(lengths) == 0 else replace(pair, length=None)


def require_same_inputs(path: Path, campaign: CampaignBase) -> None:
    """Refuse to replace a result of other inputs than those of a campaign."""
    remedy = "write elsewhere with -o, or add --force to replace it"
    if not path.exists():
        return
    try:
        before = FitResult.read(path).settings
    except InputError as error:
        rule = "is in the place of the result and cannot be read as one"
        raise InputError(str(path), "", None, rule, remedy) from error
    now = json.loads(json.dumps(campaign.settings))
    changed = _differences(before, now)
    if changed:
        more = f", and {len(changed) - 2} more" if len(changed) > 2 else ""
        named = ", ".join(changed[:2]) + more
        rule = f"holds a result that came from other inputs ({named})"
        raise InputError(str(path), "", None, rule, remedy)


def _differences(before: Any, now: Any, key: str = "") -> list[str]:
    if before == now:
        return []
    if isinstance(before, dict) and isinstance(now, dict):
        names = [*before, *(name for name in now if name not in before)]
        pairs = ((f"{key}.{n}" if key else n, before.get(n), now.get(n)) for n in names)
        return [text for name, old, new in pairs for text in _differences(old, new, name)]
    old, new = (short(value, 40) or "nothing" for value in (before, now))
    return [f"{key} differs" if old == new else f"{key}: {old} there, {new} now"]
