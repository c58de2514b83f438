"""Results side by side, and a result compared with its fit redone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cylcontact.datasets.grid import Grid
from cylcontact.fitting.calibration import calibrate, space_of
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.measure import fit_table
from cylcontact.fitting.readings import fit_with_noise
from cylcontact.fitting.results import FitResult, LawFit, Rows, or_blank
from cylcontact.fitting.space import Space
from cylcontact.fitting.stored import read_result
from cylcontact.support.parallel import Workers
from cylcontact.support.plain_text import brief, item
from cylcontact.support.progress import Progress
from cylcontact.support.text_tables import TextTable

# The axes of grids, with symbols and units.
_AXES = {"E": ("E", " GPa"), "nu": ("ν", ""), "dR": ("ΔR", " mm"), "load": ("load", " N/mm")}


def compare(results: Sequence[FitResult]) -> str:
    """Return results side by side: a table for those of one kind, then their warnings and notes.

    Parameters
    ----------
    results : sequence of FitResult
        In the order of the columns.

    Returns
    -------
    str
        Results of one kind are of the same law and contact, with the same coefficients fixed and
        tied. A table has a column for the published coefficients and one for each result, and the
        samples of each beneath. That of a single result gives its difference from the published.
    """
    parts = [_side_by_side(group) for group in _by_kind(results)]
    for result in results:
        sentences = [*result.warnings, *result.notes]
        parts.append("\n".join([f"{brief(result.name)}:", *map(item, sentences)]))
    return "\n\n".join(parts)


def compared(results: Sequence[FitResult]) -> list[dict[str, Any]]:
    """Return the numbers that `compare` prints, kind by kind of results, as plain data."""
    return [_numbers_of(group) for group in _by_kind(results)]


def _numbers_of(results: list[FitResult]) -> dict[str, Any]:
    first, published = results[0], next((r.published for r in results if r.published), None)
    common = _on_common_samples(results)
    kind: dict[str, Any] = {"law": first.law, "contact": first.contact, "published": None}
    if published:
        kind["published"] = {
            "coefficients": published.coefficients,
            "objective_on_samples_of": [(name, values[0]) for name, values in common],
        }
    kind["results"] = [
        {
            "name": result.name,
            "coefficients": {
                name: each.model_dump(include={"value", "unit", "standard_error", "verdict"})
                for name, each in result.estimates.items()
            },
            "objective": result.objective.model_dump(include={"name", "unit", "value"}),
            "published_objective": result.published.objective if result.published else None,
            "objective_on_samples_of": [(name, values[at]) for name, values in common],
            "lower_bound": getattr(result, "bound", None),
            "largest_difference_percent": result.max_abs_diff_percent.model_dump(),
            "samples": result.counts.samples,
            "masked": result.counts.masked,
            "warnings": list(result.warnings),
            "notes": list(result.notes),
        }
        for at, result in enumerate(results, 1)
    ]
    return kind


def _by_kind(results: Iterable[FitResult]) -> list[list[FitResult]]:
    groups: dict[tuple[str, ...], list[FitResult]] = {}
    for result in results:
        groups.setdefault((result.law, result.contact, *_labels(result)), []).append(result)
    return list(groups.values())


def _labels(result: FitResult) -> list[str]:
    """Return the label of each coefficient: its name and unit, its tie, whether it was fixed."""
    labels = []
    for name, estimate in result.estimates.items():
        said = {"fixed": " (fixed)"}.get(estimate.verdict, "")
        said = f" {estimate.verdict}" if estimate.verdict.startswith("=") else said
        labels.append(", ".join(filter(None, (name + said, estimate.unit))))
    return labels


def _side_by_side(results: list[FitResult]) -> str:
    first, published = results[0], next((r.published for r in results if r.published), None)
    rows: Rows = []
    for label, name in zip(_labels(first), first.estimates, strict=True):
        paper = f"{published.coefficients[name]:g}" if published else "-"
        rows.append((label, paper, *(_with_error(r, name) for r in results)))
    rows += [
        (f"objective on the samples of {brief(name)}", *(or_blank(each, ".5g") for each in values))
        for name, values in _on_common_samples(results)
    ]
    rows += [(label, "", *cells) for label, cells in _numbers(results)]
    rows = [(*row[:2], *(cell or "-" for cell in row[2:])) for row in rows]
    columns = [f"{first.law}, {first.contact}", "published", *(r.name for r in results)]
    if len(results) == 1 and published:
        columns.append("difference, %")
        values = zip(first.coefficients.values(), published.coefficients.values(), strict=True)
        differences = [f"{100 * (x / y - 1):+.1f}" if y else "" for x, y in values]
        differences += ["", f"{100 * (first.objective.value / published.objective - 1):+.1f}"]
        differences += [""] * (len(rows) - len(differences))
        rows = [(*row, cell) for row, cell in zip(rows, differences, strict=True)]
    return "\n".join([str(TextTable(columns, rows)), *map(_samples, results)])


def _on_common_samples(results: Sequence[FitResult]) -> list[tuple[str, list[float | None]]]:
    """Return the objectives of the published and of all fitted coefficients, by whose samples."""
    rows: list[tuple[str, list[float | None]]] = []
    for result in results if len(results) > 1 else ():
        if not isinstance(result, LawFit):
            continue
        campaign = Campaign.of_settings(result.name, result.settings, result.name)
        space, _ = space_of(campaign)
        every = [result.published, *results]
        values = [space.value_of(e.coefficients) if e else None for e in every]
        rows.append((result.name, values))
    return rows


def _numbers(results: Sequence[FitResult]) -> Iterable[tuple[str, list[str]]]:
    """Yield the label and the cells of each row beneath the coefficients."""
    objectives = [result.objective for result in results]
    published = [result.published for result in results]
    largest = [result.max_abs_diff_percent for result in results]
    yield "objective", [", ".join(filter(None, (o.name, o.unit))) for o in objectives]
    if len(results) == 1 or not isinstance(results[0], LawFit):  # or _on_common_samples has them
        yield "  fitted", [f"{o.value:.5g}" for o in objectives]
        yield "  published", [or_blank(p.objective if p else None) for p in published]
    yield "  lower bound", [or_blank(getattr(result, "bound", None)) for result in results]
    yield "largest difference, %", [or_blank(each.fitted, ".4g") for each in largest]
    yield "  published", [or_blank(each.published) for each in largest]
    yield "samples", [f"{result.counts.samples:,d}" for result in results]
    yield "  masked", [f"{result.counts.masked:,d}" for result in results]


def _with_error(result: FitResult, name: str) -> str:
    estimate = result.estimates[name]
    error = f" ± {estimate.standard_error:.2g}" if estimate.standard_error else ""
    return f"{estimate.value:.5g}{error}"


def _samples(result: FitResult) -> str:
    if result.reference == "measurements":
        return f"{brief(result.name)}: {result.counts.samples:,} measurements"
    axes = result.settings["dataset"]["axes"]
    texts = [_axis(*words, axes[name]) for name, words in _AXES.items() if name in axes]
    return f"{brief(result.name)}: samples at {', '.join(texts)}"


def _axis(symbol: str, unit: str, axis: Mapping[str, Any]) -> str:
    values = axis.get("values")
    if values is None:
        low, high, count = axis["min"], axis["max"], f" ({axis['points']} {axis['spacing']})"
    else:
        low, high, count = values[0], values[-1], f" ({len(values)})" if len(values) > 1 else ""
    span = f"{low:g}" if low == high else f"{low:g}…{high:g}"
    return f"{symbol} {span}{unit}{count}"


# On another processor a fit may end in a neighbouring kink of Y, less than 0.1 % away.
_OBJECTIVE_TOLERANCE = 1e-3
# Without a search the numbers are the same to round-off.
_EXACT_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Check:
    """A number of a committed result and its fresh value; below `exact` both are round-off."""

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

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers of the line, for JSON."""
        numbers = {"what": self.what, "committed": self.committed, "fresh": self.fresh}
        allowed = {"deviation": self.deviation, "allowed": self.tolerance}
        return numbers | allowed | {"holds": self.holds}

    def __str__(self) -> str:
        verdict = "holds" if self.holds else "DOES NOT HOLD"
        return (
            f"{self.what}: committed {self.committed:.10g}, fresh {self.fresh:.10g}, "
            f"deviation {self.deviation:.1e}, allowed {self.tolerance:.0e}: {verdict}"
        )


def verify(path: Path, jobs: Workers, progress: Progress) -> list[Check]:
    """Redo a fit with the settings in a result file and compare."""
    committed = read_result(path)
    campaign = Campaign.of_settings(committed.name, committed.settings, str(path))
    fresh: FitResult
    space: Space
    if isinstance(campaign.data, Grid):
        space, fresh = space_of(campaign, jobs)[0], calibrate(campaign, jobs, progress)
    else:
        space, fresh = fit_with_noise(campaign), fit_table(campaign, jobs, progress)
    of_coefficients = Check(
        "objective of the coefficients",
        committed.objective.value,
        space.value_of(committed.coefficients),
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
    bound = getattr(committed, "bound", None)
    if bound is not None:
        fresh_bound = getattr(fresh, "bound", None) or 0.0
        checks.append(Check("lower bound", bound, fresh_bound, _EXACT_TOLERANCE, exact))
    if committed.published and fresh.published:
        published = committed.published.objective, fresh.published.objective
        checks.append(Check("published objective", *published, _EXACT_TOLERANCE, exact))
    return checks
