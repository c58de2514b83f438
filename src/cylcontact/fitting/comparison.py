"""Results side by side, and a result compared with its fit redone."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cylcontact.fitting.calibration import calibrate, space_of
from cylcontact.fitting.data_fit import DataFit
from cylcontact.fitting.results import FitResult, LawFit, Rows, label_of
from cylcontact.fitting.space import Space
from cylcontact.fitting.tables import TableCampaign, campaign_of, fit_table
from cylcontact.support.parallel import Workers
from cylcontact.support.plain_text import brief, item
from cylcontact.support.progress import Progress
from cylcontact.support.text_tables import Table

# The rows below the coefficients where results are compared, with their labels in text, their
# formats and numbers. Those of the published coefficients are computed on the data of each fit.
NUMBERS: dict[str, tuple[str, str, Callable[[FitResult], float | None]]] = {
    "objective": ("  fitted", ".5g", lambda r: r.objective.value),
    "published objective": (
        *("  published", ".5g"),
        lambda r: r.published.objective if r.published else None,
    ),
    "lower bound": ("  lower bound", ".5g", lambda r: getattr(r, "bound", None)),
    "largest difference, %": (
        "largest difference, %",
        ".4g",
        lambda r: r.max_abs_diff_percent.fitted,
    ),
    "published largest difference, %": (
        *("  published", ".5g"),
        lambda r: r.max_abs_diff_percent.published,
    ),
    "samples": ("samples", ",d", lambda r: r.counts.samples),
    "masked": ("  masked", ",d", lambda r: r.counts.masked),
}

# The axes of grids, with symbols and units.
_AXES = {
    **{"E": ("E", " GPa"), "nu": ("ν", ""), "dR": ("ΔR", " mm"), "load": ("load", " N/mm")},
}


def compare(results: Sequence[FitResult]) -> str:
    """Return results side by side: a table for those of one kind, then the verdicts.

    Parameters
    ----------
    results : sequence of FitResult
        In the order of the columns.

    Returns
    -------
    Report
        Results of one kind are of the same law, contact and search (`by_search`). A table has a
        column for the published coefficients and one for each result, and the samples of each
        beneath. That of a single result gives its difference from the published coefficients.
    """
    parts: list[str] = [_side_by_side_text(group) for group in by_search(results)]
    for result in results:
        parts.append("\n".join([f"{brief(result.name)}:", *map(item, result.verdicts)]))
    return "\n\n".join(parts)


def by_search(results: Iterable[FitResult]) -> list[list[FitResult]]:
    """Return the results in groups of the same law, contact, fixed and tied coefficients."""
    groups: dict[tuple[str, ...], list[FitResult]] = {}
    for result in results:
        kind = (result.law, result.contact, *labels(result).values())
        groups.setdefault(kind, []).append(result)
    return list(groups.values())


def labels(result: FitResult) -> dict[str, str]:
    """Return the label of each coefficient in tables: its name, its tie, whether it was fixed."""
    of_ties = {name: f"{name} = {expression}" for name, expression in result.ties.items()}
    of_fixed = {name: f"{name} (fixed)" for name in result.fixed}
    return {name: (of_ties | of_fixed).get(name, name) for name in result.coefficients}


def side_by_side(results: Sequence[FitResult]) -> dict[str, list[str | None]]:
    """Return results of one law and contact side by side, for the renderings of such a table."""
    # Some results of a group may be of data for which nothing was published.
    published = next((r.published.coefficients for r in results if r.published), None)
    coefficients = [_coefficients(result) for result in results]
    rows: dict[str, list[str | None]] = {
        label: [
            f"{published[name]:g}" if published else None,
            *(texts[name] for texts in coefficients),
        ]
        for name, label in labels(results[0]).items()
    }
    for row, (_, form, number) in NUMBERS.items():
        values = map(number, results)
        rows[row] = ["", *(None if v is None else format(v, form) for v in values)]
    if len(results) == 1:
        _add_differences(rows, results[0])
    return rows


def _coefficients(result: FitResult) -> dict[str, str]:
    """Return the coefficients as texts, with standard errors where there are any."""
    errors = result.to_frame()["standard_error"]
    return {
        name: f"{value:.5g} ± {errors[name]:.2g}" if errors[name] > 0 else f"{value:.5g}"
        for name, value in result.coefficients.items()
    }


def _add_differences(rows: dict[str, list[str | None]], result: FitResult) -> None:
    """Move the numbers of the published coefficients to their column, and add the differences."""
    for row in ("objective", "largest difference, %"):
        rows[row][0] = rows.pop(f"published {row}")[1]
    differences = {}
    if result.published is not None:
        published = result.published.coefficients | {"objective": result.published.objective}
        fitted = result.coefficients | {"objective": result.objective.value}
        differences = {
            label: f"{100 * (fitted[name] / published[name] - 1):+.1f}"
            for name, label in (labels(result) | {"objective": "objective"}).items()
            if published[name] and name not in result.fixed
        }
    for row, cells in rows.items():
        cells.append(differences.get(row, ""))


def _side_by_side_text(results: list[FitResult]) -> str:
    first = results[0]
    of_coefficients = labels(first)
    of_units = {
        name: ", ".join(filter(None, (label, first.units.get(name))))
        for name, label in of_coefficients.items()
    }
    names = {row: label for row, (label, *_) in NUMBERS.items()}
    names |= {label: of_units[name] for name, label in of_coefficients.items()}
    columns = [f"{first.law}, {first.contact}", "published", *(r.name for r in results)]
    if len(results) == 1:
        names["objective"] = label_of(first.objective.name, first.objective_unit)
        columns.append("difference, %")
    rows: Rows = [
        (names.get(row, row), *("-" if c is None else c for c in cells))
        for row, cells in side_by_side(results).items()
    ]
    if len(results) > 1:
        objectives = (
            "objective",
            "",
            *(label_of(r.objective.name, r.objective_unit) for r in results),
        )
        rows.insert(len(first.coefficients), objectives)
    return "\n".join([str(Table(columns, rows)), *map(_samples_text, results)])


def _samples_text(result: FitResult) -> str:
    if isinstance(result, DataFit):
        return f"{brief(result.name)}: {result.counts.samples:,} measurements"
    axes = result.settings["dataset"]["axes"]
    texts = [_axis_text(*words, axes[name]) for name, words in _AXES.items() if name in axes]
    return f"{brief(result.name)}: samples at {', '.join(texts)}"


def _axis_text(symbol: str, unit: str, axis: Mapping[str, Any]) -> str:
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

    def __str__(self) -> str:
        verdict = "holds" if self.holds else "DOES NOT HOLD"
        return (
            f"{self.what}: committed {self.committed:.10g}, fresh {self.fresh:.10g}, "
            f"deviation {self.deviation:.1e}, allowed {self.tolerance:.0e}: {verdict}"
        )


def verify(path: Path, jobs: Workers, progress: Progress) -> list[Check]:
    """Redo a fit with the settings in a result file and compare."""
    committed = FitResult.read(path)
    campaign = campaign_of(committed.name, committed.settings, str(path))
    fresh: FitResult
    space: Space
    if isinstance(campaign, TableCampaign):
        space, fresh = campaign.fit(), fit_table(campaign, jobs, progress)
    else:
        space, fresh = space_of(campaign, jobs)[0], calibrate(campaign, jobs, progress)
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
    if isinstance(committed, LawFit) and isinstance(fresh, LawFit) and committed.bound is not None:
        checks.append(
            Check("lower bound", committed.bound, fresh.bound or 0.0, _EXACT_TOLERANCE, exact)
        )
    if committed.published and fresh.published:
        published = committed.published.objective, fresh.published.objective
        checks.append(Check("published objective", *published, _EXACT_TOLERANCE, exact))
    return checks
