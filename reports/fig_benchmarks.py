"""The workbench against what one would use instead, from datasets/benchmarks.json."""

from __future__ import annotations

import json
from collections.abc import Hashable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.errors import InputError
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import ACCENT, QUIET
from cylcontact.reports.bench import Bench

CAPTION = (
    "Time that others take, in units of the workbench's on the same task with the same answer "
    "(-, logarithmic). Markers: median of the rounds; bars: their quartiles. Computed, marked by "
    "open circles: the evaluations that the optimiser needed on a small grid times the measured "
    "cost of one on this grid. The power and the logarithm do less than the workbench: they are "
    "limits. Measured by `make bench`; docs/speed.md has the numbers, the machine and the versions."
)
MM_PER_LINE = 3.4
COLUMNS = ["benchmark", "case", "side", "ratio", "ratio_low", "ratio_high", "note"]


class Group(NamedTuple):
    """A benchmark, and words in the names of the cases and of our side."""

    benchmark: str
    case: str
    ours: str


GROUPS = {
    "Johnson's load, 1,000,000 values at once": Group("law", "array, 1,000,000", "Johnson"),
    "Johnson's load, compiled, one value": Group("law", "compiled", "Johnson"),
    "Johnson's load, called from Python": Group("law", "called", "Johnson"),
    "Sampling 100,000,000 to moments": Group("sampling", "100,000,000", "threads"),
    "Genetic search, 120 candidates": Group("search", "120 candidates", "genetic"),
    "Calibration to 0.1 %, 1,001,925 samples": Group("calibration", "1,001,925", "cylcontact"),
    "Slider-crank, one revolution": Group("mechanism", "accuracy", "1e-08"),
}


def draw(bench: Bench) -> Drawing:
    table = ratios_of(bench.input("datasets/benchmarks.json"))
    ratios = table[["group", "side", "ratio"]].to_numpy()
    headline = {f"{group}: {side}": ratio for group, side, ratio in ratios}
    return Drawing(ratio_panel(table), table, headline, CAPTION + left_out(table))


def ratios_of(results: Path) -> pd.DataFrame:
    """Return the ratios of the other sides to ours, without the benchmarks that were skipped."""
    try:
        data = json.loads(results.read_text(encoding="utf-8"))
        rows, skipped = pd.DataFrame(data["rows"], columns=COLUMNS), data["skipped"]
    except (OSError, ValueError, KeyError) as error:
        raise InputError(
            str(results), "", None, "cannot be read", "make bench writes it"
        ) from error
    parts = []
    for name, group in GROUPS.items():
        if group.benchmark in skipped:
            continue
        sides = rows[
            (rows["benchmark"] == group.benchmark)
            & rows["case"].str.contains(group.case, regex=False)
        ]
        ours = sides[
            sides["side"].str.contains(group.ours) & sides["side"].str.contains("cylcontact")
        ]
        if ours.empty:
            raise InputError(str(results), "rows", name, "is not in the file", "redo make bench")
        others = sides[~sides["side"].str.startswith("cylcontact")]
        ratios = others[["ratio", "ratio_low", "ratio_high"]] / float(ours["ratio"].iloc[0])
        computed = others["note"].str.startswith("computed")
        parts.append(ratios.assign(group=name, side=others["side"], computed=computed))
    table = pd.concat(parts, ignore_index=True)
    return table[["group", "side", "ratio", "ratio_low", "ratio_high", "computed"]]


def ratio_panel(table: pd.DataFrame) -> Figure:
    """Draw the ratios, a line for each side, group below group."""
    lines = len(table) + table["group"].nunique()
    figure = new_figure("full", MM_PER_LINE * lines + 14)
    axes = figure.subplots()
    places, labels, place = [], [], 0
    for name, group in table.groupby("group", sort=False):
        axes.text(
            -0.01,
            place,
            str(name),
            transform=axes.get_yaxis_transform(),
            ha="right",
            va="center",
            weight="bold",
            fontsize=rcParams["ytick.labelsize"],
        )
        for row in group.to_dict("records"):
            place += 1
            _draw_line(axes, place, row)
            places.append(place)
            labels.append(row["side"])
        place += 1
    axes.axvline(1.0, color="black", linewidth=0.8)
    axes.set(xscale="log", ylim=(place, -1), xlabel="time, in units of cylcontact's (-)")
    axes.set_yticks(places, labels)
    axes.tick_params(axis="y", length=0, right=False)
    low, high = float(table["ratio_low"].min()), float(table["ratio_high"].max())
    axes.set_xlim(10 ** np.floor(np.log10(low) - 0.3), 10 ** np.ceil(np.log10(high) + 0.6))
    return figure


def _draw_line(axes: Axes, place: int, row: dict[Hashable, Any]) -> None:
    """Draw one side's ratio, its range and its number."""
    colour = QUIET if row["ratio"] < 1 else ACCENT
    axes.plot([row["ratio_low"], row["ratio_high"]], [place, place], "-", color=colour, marker="")
    face = "white" if row["computed"] else colour
    axes.plot(row["ratio"], place, "o", color=colour, markerfacecolor=face)
    # The number is on the side away from the line at 1.
    shorter = row["ratio"] < 1
    axes.annotate(
        _short(row["ratio"]),
        (row["ratio_low"] if shorter else row["ratio_high"], place),
        xytext=(-5 if shorter else 5, 0),
        textcoords="offset points",
        ha="right" if shorter else "left",
        va="center",
        fontsize=rcParams["ytick.labelsize"],
    )


def _short(ratio: float) -> str:
    """Return a ratio to two digits, without an exponent."""
    return f"{float(f'{ratio:.2g}'):,.10g}"


def left_out(table: pd.DataFrame) -> str:
    """Return a sentence for the caption on the groups that a table lacks, if there are any."""
    groups = [name for name in GROUPS if name not in set(table["group"])]
    return f" Not measured (docs/speed.md says why): {'; '.join(groups)}." if groups else ""
