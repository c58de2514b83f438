"""Fit results: coefficients with intervals, sentences on the fit, and what is needed to redo it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from cylcontact.bodies.pair import Contact
from cylcontact.files.reading import read_text
from cylcontact.files.spec import Spec, parse_spec, require_other_kind
from cylcontact.files.writing import replacing
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.law_models import fitted_law
from cylcontact.fitting.records import (
    TOLERANCE,
    Estimate,
    MaxDifference,
    ObjectiveValue,
    Profile,
    Published,
    RunRecord,
    SampleCounts,
    SearchRecord,
    same_basin,
)
from cylcontact.laws.law import ContactLaw
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import WIDTH, advice, as_label, brief, item
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

# The version of result files.
_FORMAT = 3
_OBJECTIVE_WORDS = {
    "rms-log-penetration": "relative scatter of the penetration",
    "rms-difference-percent": "scatter of the penetration in percent",
    "max-difference-percent": "largest difference of the penetration in percent",
    "rms-relative-force": "relative scatter of the load",
    "max-relative-force-percent": "largest difference of the load in percent",
}

# What a law was fitted to, by the kind of a result.
_KINDS = {"law": "a law", "readings": "readings"}

# A longer tie stands in the campaign only.
_LONGEST_TIE = 24

Rows = list[tuple[str, ...]]


def or_blank(value: float | None, style: str = ".5g") -> str:
    """Return a number, or nothing for None."""
    return "" if value is None else format(value, style)


class FitResult(Spec):
    """What a fit gives: a `LawFit` of a law to a law, or a `DataFit` to readings.

    `print(result)` gives the report, and a notebook shows it. `to_law` returns the fitted law.
    """

    kind: str  # "law" or "readings": what the law was fitted to
    name: str
    law: str
    contact: Contact
    # Which form of the law has these coefficients; empty for a law of one form.
    formula: str
    reference: str  # a law, or "measurements"
    estimates: dict[str, Estimate]
    objective: ObjectiveValue
    published: Published | None
    max_abs_diff_percent: MaxDifference
    runs: Sequence[RunRecord]
    counts: SampleCounts
    # What makes the result doubtful, with the remedy; then the rest, most important first.
    warnings: list[str]
    notes: list[str]
    # The campaign and the grid, or the data, as run; then versions and hashes.
    settings: dict[str, Any]
    provenance: dict[str, Any]

    # The objective below which the law follows the samples exactly.
    round_off: ClassVar[float]
    # The headings of the interval and the verdict.
    _interval_heading: ClassVar[str] = "within 1 %"

    @classmethod
    def read(cls, path: Path | str) -> Self:
        """Read a result file of this kind; `read_result` reads both kinds.

        Raises
        ------
        InputError
            If the file cannot be read, is no such result, is of another format, or is inconsistent.
        """
        source, data = str(path), contents_of(path)
        kind = cls.model_fields["kind"].default
        if data.get("kind") != kind:
            rule, remedy = f"is not a fit to {_KINDS[kind]}", f"name a fit to {_KINDS[kind]}"
            raise InputError(source, "", None, rule, remedy)
        result = parse_spec(cls, data, source)
        result.require_consistent(source)
        return result

    def save(self, path: Path | str) -> None:
        """Write the result as JSON, or the coefficients alone to a .csv or .tex.

        The file appears complete or not at all.
        """
        with replacing(path) as temporary:
            self.write(temporary)

    def to_json(self) -> str:
        """Return the result as JSON, as `save` writes it."""
        contents = {"format": _FORMAT, **self.model_dump()}
        return json.dumps(contents, indent=1, ensure_ascii=False, allow_nan=False)

    def write(self, path: Path | str) -> None:
        """Write what `save` does to a file that is not yet in its place."""
        suffix = Path(path).suffix.lower()
        if suffix == ".csv":
            text = self.to_frame().to_csv(index_label="coefficient", lineterminator="\n")
        else:
            text = (self.to_latex() if suffix == ".tex" else self.to_json()) + "\n"
        try:
            Path(path).write_text(text, encoding="utf-8", newline="")
        except UnicodeEncodeError as error:
            source = f"fit result {self.name!r}"
            raise InputError(source, "", None, "is not text in UTF-8", "rename it") from error

    def require_consistent(self, source: str) -> None:
        """Raise `InputError` unless the coefficients are those of the campaign and its law."""
        model = Campaign.of_settings(self.name, self.settings, source).model
        names = model.names
        if self.formula != model.formula:
            rule = f"is not the form of the law in this version, {model.formula!r}"
            raise InputError(source, "formula", self.formula, rule, "redo the fit")
        sets = {"estimates": {*self.estimates}}
        if self.published is not None:
            sets["published.coefficients"] = {*self.published.coefficients}
        for key, coefficients in sets.items():
            if coefficients != {*names}:
                rule = f"must be the coefficients of its campaign: {', '.join(names)}"
                raise InputError(source, key, sorted(coefficients), rule, "redo the fit")
        if not self.runs:
            raise InputError(source, "runs", [], "must hold at least one run", "redo the fit")

    @property
    def coefficients(self) -> dict[str, float]:
        """The values of all coefficients, by name."""
        return {name: estimate.value for name, estimate in self.estimates.items()}

    @property
    def free(self) -> dict[str, float]:
        """The values of the coefficients that were searched, by name."""
        campaign = self.settings["campaign"]
        others = {*campaign["fixed"], *campaign.get("ties", ())} - {*campaign.get("uncertain", ())}
        return {name: value for name, value in self.coefficients.items() if name not in others}

    def to_law(self, source: str = "") -> ContactLaw:
        """Return the fitted law of the contact, without the offset and compliance of the rig.

        Parameters
        ----------
        source : str, optional
            The result's file, for errors; by default its name.

        Raises
        ------
        InputError
            If the law is your own Python function.
        """
        housing = self.settings["campaign"].get("housing")
        return fitted_law(self.law, self.contact, self.coefficients, housing, source or self.name)

    def repeatable(self) -> dict[str, Any]:
        """Return what the same seed reproduces: everything except times and provenance."""
        data = self.model_dump(exclude={"provenance"})
        for run in data["runs"]:
            del run["seconds"]
        return data

    # --- the report ---------------------------------------------------------------------------

    @property
    def headline(self) -> str:
        """What was fitted to what."""
        fitted, masked = self.counts.samples, self.counts.masked
        to = f"fitted to {fitted:,} measurements"
        if self.reference != "measurements":
            words = _OBJECTIVE_WORDS[self.objective.name]
            to = f"fitted to {self.reference}, minimising the {words} on {fitted:,} samples "
            to += f"({masked:,} outside the reference's domain)"
        return f"{brief(self.name)}: {brief(self.law)} law, {self.contact} contact, {to}"

    @property
    def status(self) -> str:
        """One line on whether the fit can be trusted; empty for a fit to a law."""
        return ""

    @property
    def read_lines(self) -> list[str]:
        """Lines that say what was read of a table; empty for a fit to a law."""
        return []

    @property
    def table(self) -> TextTable:
        """The coefficients, the objective and the largest difference."""
        interval, at_published = self._interval_heading, "penalty at published"
        paper = self.published.coefficients if self.published else {}
        # The searched ones first: the others are often the law's own constants.
        order = sorted(self.estimates.items(), key=lambda item: item[0] not in self.free)
        paper = {
            name: self._in_its_unit(estimate.model_copy(update={"value": paper[name]})).value
            for name, estimate in order
            if name in paper
        }
        order = [(name, self._in_its_unit(estimate)) for name, estimate in order]
        rows = [
            {
                "": name,
                "fitted": f"{estimate.value:.5g}",
                "unit": estimate.unit,
                "std. error": or_blank(estimate.standard_error, ".2g"),
                interval: estimate.interval,
                "published": or_blank(paper.get(name)),
                at_published: or_blank(estimate.penalty, "+.1%"),
                "verdict": "tied" if len(estimate.verdict) > _LONGEST_TIE else estimate.verdict,
            }
            for name, estimate in order
        ]
        heads, worst = [*rows[0]], self.max_abs_diff_percent
        if self.objective.name in _OBJECTIVE_WORDS:
            objective = {
                "": _OBJECTIVE_WORDS[self.objective.name],
                "fitted": f"{self.objective.value:.5g}",
                "unit": self.objective.unit,
                "published": or_blank(self.published.objective if self.published else None),
            }
            rows.append(objective)
        if worst.fitted is not None:
            largest = {"": "largest difference", "fitted": f"{worst.fitted:.4g}", "unit": "%"}
            rows.append(largest | {"published": or_blank(worst.published)})
        used = [head for head in heads if any(row.get(head) for row in rows)]
        return TextTable(used, [[row.get(head, "") for head in used] for row in rows])

    def to_latex(self) -> str:
        """Return the coefficients as a LaTeX table for booktabs, as `print` shows them."""
        marks = {
            "%": r"\%",
            "_": r"\_",
            "…": r"\dots{}",
            "±": r"$\pm$",
            "µ": r"$\mu$",
            "^": r"\^{}",
        }

        def plain(cell: str) -> str:
            return "".join(marks.get(letter, letter) for letter in cell)

        table = self.table
        rows = [" & ".join(map(plain, row)) + r" \\" for row in table.rows]
        head = " & ".join(map(plain, table.columns)) + r" \\"
        form = "l" + "r" * (len(table.columns) - 1)
        lines = [rf"\begin{{tabular}}{{{form}}}", r"\toprule", head, r"\midrule", *rows]
        return "\n".join([*lines, r"\bottomrule", r"\end{tabular}"])

    def _in_its_unit(self, estimate: Estimate) -> Estimate:
        """Return a coefficient in the unit that the report states it in."""
        return estimate

    def to_frame(self) -> pd.DataFrame:
        """Return the coefficients as a table.

        Returns
        -------
        pandas.DataFrame
            A row for each coefficient: value, unit, standard_error, low, high (the ends of the
            interval; NaN for one that was not searched), and verdict.
        """
        import pandas as pd

        columns = ["value", "unit", "standard_error", "low", "high", "verdict"]
        rows = {name: each.model_dump() for name, each in self.estimates.items()}
        frame = pd.DataFrame.from_dict(rows, orient="index", columns=columns)
        return frame.astype(dict.fromkeys(("standard_error", "low", "high"), float))

    def plot_profile(self, name: str, ax: Axes | None = None) -> Axes:
        """Draw how much worse the fit gets when a coefficient moves and all others follow.

        Parameters
        ----------
        name : str
            A coefficient that was searched.
        ax : matplotlib.axes.Axes, optional
            Axes to draw into; by default a new figure.
        """
        from cylcontact.plots.arguments import axes_for
        from cylcontact.plots.style import ACCENT, QUIET

        estimate = self.estimates.get(name)
        if estimate is None or estimate.low is None or estimate.high is None:
            known = [each for each, e in self.estimates.items() if e.low is not None]
            rule = "has no profile: it was not searched, or the data do not determine it"
            remedy = f"choose {', '.join(known)}" if known else "free it"
            raise InputError(f"fit result {self.name!r}", "name", name, rule, remedy)
        values, heights, limit, words = self._profile(name)
        with axes_for(ax, "plot_profile", "column", 60.0) as axes:
            axes.plot(values, heights, marker="", linestyle="-")
            axes.axhline(limit, color=QUIET, linestyle=":", marker="")
            for end in (estimate.low, estimate.high):
                axes.axvline(end, color=QUIET, linestyle="--", marker="", linewidth=0.8)
            axes.axvline(estimate.value, color=ACCENT, linestyle="--", marker="")
            unit = f" ({estimate.unit})" if estimate.unit else ""
            axes.set(xlabel=as_label(name) + unit, ylabel=words)
        return axes

    def summary(self) -> str:
        """Return the report as text, as `print` shows it."""
        return str(self)

    def _profile(self, name: str) -> tuple[Sequence[float], Sequence[float], float, str]:
        """Return values of a coefficient, the heights of its profile, the limit, and its label."""
        raise NotImplementedError

    def __str__(self) -> str:
        lines = [item(line, "") for line in self.read_lines]
        lines += [fill(self.headline, WIDTH), *filter(None, [self.status])]
        lines += [item(sentence, "! ") for sentence in self.warnings]
        return "\n".join([*lines, "", str(self.table), *map(item, self.notes)])

    def __repr__(self) -> str:
        return (
            f"{type(self).__name__}({self.name!r}, {self.objective.name} = "
            f"{self.objective.value:.6g}, coefficients={self.coefficients})"
        )

    def _repr_html_(self) -> str:
        style = "border-left: 4px solid #D55E00; padding-left: 0.5em"
        plain = [*self.read_lines, self.headline, *filter(None, [self.status])]
        paragraphs = [f"<p>{escape(advice(line))}</p>" for line in plain]
        paragraphs += [f'<p style="{style}">{escape(advice(each))}</p>' for each in self.warnings]
        items = "".join(f"<li>{escape(advice(note))}</li>" for note in self.notes)
        return f"{''.join(paragraphs)}{self.table._repr_html_()}<ul>{items}</ul>"


class LawFit(FitResult):
    """A law fitted to a law; `calibrate` has an example."""

    kind: Literal["law"] = "law"
    runs: list[SearchRecord]
    # The lower bound of the objective for power laws, with K* and n of each clearance.
    bound: float | None
    profiles: dict[str, Profile]

    round_off: ClassVar[float] = 1e-6  # moments have half of the digits

    def _profile(self, name: str) -> tuple[Sequence[float], Sequence[float], float, str]:
        profile, limit = self.profiles[name], (1 + TOLERANCE) * self.objective.value
        return profile.values, profile.objective, limit, f"best {as_label(self.objective.name)}"


def contents_of(path: Path | str) -> dict[str, Any]:
    """Return the contents of a result file without its format, which must be the present one."""
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
    version = data.pop("format", 1)
    if version != _FORMAT:
        rule = f"is not version {_FORMAT}, which this cylcontact reads"
        remedy = "read it with the version that wrote it, or redo the fit"
        raise InputError(source, "format", version, rule, remedy)
    if data.get("kind") not in _KINDS:
        rule, remedy = f"must be {' or '.join(_KINDS)}", "redo the fit"
        raise InputError(source, "kind", data.get("kind"), rule, remedy)
    return data


# --- the runs -----------------------------------------------------------------------------------


def basins(runs: Sequence[RunRecord], round_off: float) -> list[tuple[float, int]]:
    """Return the distinct objectives of runs, best first, and the runs at each."""
    counts: list[tuple[float, int]] = []
    for record in sorted(runs, key=lambda record: record.objective):
        if counts and same_basin(record, counts[-1][0], round_off):
            counts[-1] = (counts[-1][0], counts[-1][1] + 1)
        else:
            counts.append((record.objective, 1))
    return counts


def on_runs(
    runs: Sequence[RunRecord], round_off: float, poor: Sequence[str], how: str, word: str = "runs"
) -> tuple[list[str], list[str]]:
    """Return the warning if less than half of the runs agree, and the notes on them."""
    (_, agreeing), *others = basins(runs, round_off)
    notes = [f"{agreeing} of {len(runs)} {word} reached the best objective within 0.1 %"]
    if others:
        objectives = ", ".join(f"{objective:.4g} ({count})" for objective, count in others)
        notes.append(f"the others ended in other basins, at ({word}): {objectives}")
    if 2 * agreeing >= len(runs):
        return [], notes
    warning = (
        f"only {agreeing} of {len(runs)} {word} reached the best objective within 0.1 %, so a "
        f"lower one may have been missed: make more {word} (--runs {4 * len(runs)}), or hold "
        f"{' or '.join(poor) or 'a coefficient'} at a value ({how})"
    )
    return [warning], notes
