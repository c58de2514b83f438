"""How fast the package is beside other software, for the same task and answer."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cylcontact.files.reading import unmarked
from cylcontact.plots.figure import Drawing, figure_of_lines, plain_log, round_ticks
from cylcontact.plots.style import ACCENT, QUIET, small_text
from cylcontact.reports.bench import Bench
from cylcontact.support.errors import InputError

CAPTION = (
    "Time that other software takes, in units of the time that cylcontact takes for the same task "
    "and answer (-). Squares do only part of the task: they are limits. Open circles are "
    "computed: evaluations needed on a small grid times the measured cost of one. Bars: quartiles "
    "of the rounds, most of them narrower than the marks."
)
METHOD = (
    "Marks are the median of the rounds, with their quartiles. The power, the logarithm and the "
    "objective alone do less than cylcontact. Candidates and samples are those of one call. The "
    "calibrations end within 0.1 % of the best objective; searches that did not are left out. "
    "Measured by `make bench`; docs/speed.md has the numbers, the machine and the versions."
)
# Labels longer than this have two lines.
LONGEST = 36
COLUMNS = ["benchmark", "case", "side", "ratio", "ratio_low", "ratio_high", "note"]


MEASURED, COMPUTED, FASTER = "slower, measured", "slower, computed", "faster, part of the task"
MARKS: dict[str, dict[str, Any]] = {
    MEASURED: {"marker": "o", "color": ACCENT, "markerfacecolor": ACCENT},
    COMPUTED: {"marker": "o", "color": ACCENT},
    FASTER: {"marker": "s", "color": QUIET, "markerfacecolor": QUIET},
}


class Group(NamedTuple):
    """A benchmark, and words in the names of the cases and of our side."""

    benchmark: str
    case: str
    ours: str


GROUPS = {
    "Johnson's load, 1,000,000 values at once": Group("law", "array, 1,000,000", "Johnson"),
    "Johnson's load, compiled, one value": Group("law", "compiled", "Johnson"),
    "Johnson's load, called from Python": Group("law", "called", "Johnson"),
    "Sampling 10,000,000 to moments": Group("sampling", "10,000,000", "threads"),
    "Genetic search, 120 candidates": Group("search", "120 candidates", "genetic"),
    "Calibration to 0.1 %, 1,001,925 samples": Group("calibration", "1,001,925", "cylcontact"),
    "Slider-crank, one revolution": Group("mechanism", "accuracy", "1e-08"),
}


def draw(bench: Bench) -> Drawing:
    table = ratios_of(bench.input("datasets/benchmarks.json"))
    ratios = table[["group", "side", "ratio"]].to_numpy()
    headline = {f"{group}: {side}": ratio for group, side, ratio in ratios}
    return Drawing(ratio_panel(table), table, headline, CAPTION, METHOD + left_out(table))


def ratios_of(results: Path) -> pd.DataFrame:
    """Return the ratios of the other sides to ours, without the benchmarks that were skipped."""
    try:
        data = dict(json.loads(results.read_text(encoding="utf-8")))
        data = unmarked(data, str(results))
        rows, skipped = pd.DataFrame(data["rows"], columns=COLUMNS), data["skipped"]
    except InputError:
        raise
    except (OSError, ValueError, KeyError, TypeError) as error:
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
        peers = ~sides["side"].str.startswith("cylcontact")
        others = sides[peers & ~sides["note"].str.contains("not arrived")]
        ratios = others[["ratio", "ratio_low", "ratio_high"]] / float(ours["ratio"].iloc[0])
        computed = others["note"].str.startswith("computed")
        parts.append(ratios.assign(group=name, side=others["side"], computed=computed))
    table = pd.concat(parts, ignore_index=True)
    return table[["group", "side", "ratio", "ratio_low", "ratio_high", "computed"]]


def ratio_panel(table: pd.DataFrame) -> Figure:
    """Draw the ratios, a line for each side, group below group."""
    table = table.assign(label=table["side"].map(lambda side: fill(side, LONGEST)))
    lines = int((table["label"].str.count("\n") + 1).sum()) + table["group"].nunique()
    figure = figure_of_lines("full", lines + 5)
    axes = figure.subplots()
    top, places = 0.0, []
    for name, group in table.groupby("group", sort=False):
        axes.axhspan(top, top + 1, color="0.92", linewidth=0)
        axes.text(
            0.01,
            top + 0.5,
            str(name),
            transform=axes.get_yaxis_transform(),
            verticalalignment="center",
            fontsize=small_text(),
        )
        places += _draw_group(axes, top + 1, group)
        top = axes.dataLim.y1
    axes.set_yticks(places, table["label"])
    axes.tick_params(axis="y", length=0, right=False)
    axes.tick_params(axis="x", which="both", direction="out", top=False)
    low, high = float(table["ratio_low"].min()), float(table["ratio_high"].max())
    plain_log(axes, "x", round_ticks(low / 10, 10 * high))
    axes.set(xlim=(low / 10, 10 * high), ylim=(top, 0), xlabel="time in units of cylcontact's (-)")
    marks = [
        Line2D([], [], linestyle="none", label=label, **style) for label, style in MARKS.items()
    ]
    figure.legend(handles=marks, loc="outside lower center", ncols=3)
    return figure


def _draw_group(axes: Axes, top: float, group: pd.DataFrame) -> list[float]:
    """Draw the sides of a group, each as high as its label has lines; return their places."""
    lines = group["label"].str.count("\n") + 1
    places = [float(place) for place in top + lines.cumsum() - lines / 2]
    axes.vlines(1.0, top, top + lines.sum(), color="black", linewidth=0.8)
    for place, row in zip(places, group.to_dict("records"), strict=True):
        shorter = row["ratio"] < 1
        style = MARKS[FASTER if shorter else COMPUTED if row["computed"] else MEASURED]
        ends = [row["ratio_low"], row["ratio_high"]]
        axes.plot(ends, [place, place], linestyle="-", color=style["color"], marker="")
        axes.plot(row["ratio"], place, **style)
        # The number is on the side away from the line at 1.
        axes.annotate(
            _short(row["ratio"]),
            (ends[0] if shorter else ends[1], place),
            xytext=(-5 if shorter else 5, 0),
            textcoords="offset points",
            ha="right" if shorter else "left",
            va="center_baseline",
            fontsize=small_text(),
        )
    return places


def _short(ratio: float) -> str:
    """Return a ratio to two digits, without an exponent."""
    return f"{float(f'{ratio:.2g}'):,.10g}"


def left_out(table: pd.DataFrame) -> str:
    """Return a sentence on the groups that a table lacks, if there are any."""
    groups = [name for name in GROUPS if name not in set(table["group"])]
    return f" Not measured (docs/speed.md says why): {'; '.join(groups)}." if groups else ""
