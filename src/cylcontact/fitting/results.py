"""Fit results: coefficients, their quality in words, and everything needed to redo the fit."""

from __future__ import annotations

import json
from abc import abstractmethod
from collections.abc import Sequence
from html import escape
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from cylcontact.bodies.pair import Contact
from cylcontact.files.reading import read_text
from cylcontact.files.spec import Spec, parse_spec, require_other_kind
from cylcontact.files.writing import replacing
from cylcontact.fitting.campaign import CampaignBase
from cylcontact.fitting.law_models import fitted_law, units_of
from cylcontact.fitting.records import (
    FAIRLY,
    SAME_BASIN,
    TOLERANCE,
    WELL,
    Ends,
    MaxDifference,
    ObjectiveValue,
    Profile,
    Published,
    RunRecord,
    SampleCounts,
    same_basin,
)
from cylcontact.fitting.tables import campaign_of
from cylcontact.laws.law import ContactLaw
from cylcontact.support.errors import InputError, short
from cylcontact.support.plain_text import WIDTH, advice, as_label, brief, item
from cylcontact.support.text_tables import Table

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

# A coefficient this close to a bound, relative to the search interval, is at the bound.
_AT_BOUND = 1e-6
# The version of result files, and what only the files of the version before have.
_FORMAT = 2
_FORMER = ("kind", "bound", "profiles")
# What an objective is, and the units of those that have one, if they are not in deviations.
_OBJECTIVE_WORDS = {
    "rms-log-penetration": "relative scatter of the penetration",
    "rms-penetration": "scatter of the penetration",
    "rms-standardised": "scatter in standard deviations",
    "rms-difference-percent": "scatter of the penetration in percent",
    "max-difference-percent": "largest difference of the penetration in percent",
    "rms-relative-force": "relative scatter of the load",
    "max-relative-force-percent": "largest difference of the load in percent",
}
_OBJECTIVE_UNITS = {"rms-penetration": "mm", "rms-standardised": "std. dev."}

Rows = list[tuple[str, ...]]


def label_of(name: str, unit: str) -> str:
    """Return a name with its unit, if it has one."""
    return ", ".join(filter(None, (name, unit)))


def or_dash(value: float | None, style: str = ".5g", none: str = "-") -> str:
    """Return a number, or a dash for None."""
    return none if value is None else format(value, style)


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
        from cylcontact.fitting.data_fit import DataFit  # it imports this module

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
        return _OBJECTIVE_UNITS.get(self.objective.name, "")

    @property
    def objective_words(self) -> str:
        """What the objective is."""
        return _OBJECTIVE_WORDS.get(self.objective.name, self.objective.name)

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
        import pandas as pd

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
            f"{self.reference}, minimising the {self.objective_words} on {self.counts.samples:,} "
            f"samples ({self.counts.masked:,} outside the reference's domain)"
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
