"""Achieved against wanted restitution of each hysteresis factor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.impact import FACTORS, achieved_restitution, hysteresis_factor
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import QUIET
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

GROUPS = (
    (
        "published 1975 to 1990",
        ("hunt-crossley", "herbert-mcwhannell", "lee-wang", "lankarani-nikravesh"),
    ),
    ("published 2004 to 2015", ("gonthier", "zhiying-qishao", "flores", "hu-guo")),
)
CAPTION = (
    "Coefficient of restitution (-) that an isolated impact achieves against the wanted one, for "
    "the published hysteresis factors χ(e) in F = F_el(δ)(1 + χ δ̇/δ̇⁽⁻⁾), and its error. Grey: "
    "the exact factor; dotted: 0.9, the value of the paper's mechanism. The scales of (b) and (d) "
    "differ."
)
METHOD = (
    "The achieved restitution follows in closed form from χ alone, for every elastic law, mass and "
    "speed (derived here). Markers are the table's values, 0.1, 0.2, … 1; the factors are grouped "
    "by year of publication. The exact factor is the root χ of χ(1 + e) = ln[(1 + χ)/(1 − χe)], "
    "which achieves what is wanted."
)
# The wanted restitutions of the table, and those that the lines are drawn through.
WANTED: FloatArray = np.arange(1, 11) / 10
LINE: FloatArray = np.arange(5, 101) / 100
MARKED = (5, 10)  # the values of WANTED in LINE: the first one and the step to the next
LABELS = {
    "hunt-crossley": "Hunt–Crossley",
    "herbert-mcwhannell": "Herbert–McWhannell",
    "lee-wang": "Lee–Wang",
    "lankarani-nikravesh": "Lankarani–Nikravesh",
    "gonthier": "Gonthier et al.",
    "zhiying-qishao": "Zhiying–Qishao",
    "flores": "Flores et al.",
    "hu-guo": "Hu–Guo",
}


def draw(_bench: Bench) -> Drawing:
    table = _table(list(FACTORS), WANTED)
    rows = table.set_index(["factor", "wanted_restitution"])
    achieved, chi = rows["achieved_restitution"], rows["chi"]
    paper = "lankarani-nikravesh"
    headline = {
        f"{paper}, 0.9 wanted: achieved": float(achieved.loc[(paper, 0.9)]),
        # Its factor is largest at e = 0, where it is 3/4.
        f"{paper}: least that it can achieve": float(achieved_restitution(0.75)),
        "exact, 0.9 wanted: factor": float(chi.loc[("exact", 0.9)]),
    }
    for name, errors in table[table["factor"] != "exact"].groupby("factor", sort=False)["error"]:
        headline[f"{name}: largest error from 0.1 to 1"] = errors.abs().max()
    return Drawing(_draw_panels(), table, headline, CAPTION, METHOD)


def _table(names: Sequence[str], wanted: FloatArray) -> pd.DataFrame:
    """Tabulate wanted against achieved restitution."""
    parts = []
    for name in names:
        chi = hysteresis_factor(name)(wanted)
        achieved = achieved_restitution(chi)
        parts.append(
            pd.DataFrame(
                {
                    "factor": name,
                    "wanted_restitution": wanted,
                    "chi": chi,
                    "achieved_restitution": achieved,
                    # Round-off would differ from machine to machine; + 0.0 removes −0.0.
                    "error": np.round(achieved - wanted, 12) + 0.0,
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def _draw_panels() -> Figure:
    """Draw achieved against wanted restitution, and below it the error, a column per group."""
    figure = new_figure("full", 118.0)
    grid = figure.subplots(2, len(GROUPS), sharex="col", height_ratios=(5, 3))
    for number, (title, names) in enumerate(GROUPS):
        upper, lower = grid[:, number]
        _draw_lines(upper, names, "achieved_restitution", LINE)
        _draw_lines(lower, names, "error", np.zeros_like(LINE))
        panel_title(upper, 2 * number, title)
        panel_title(lower, 2 * number + 1, f"error of ({'ac'[number]})")
        upper.legend(loc="lower right")
        upper.set(ylim=(0, 1.02), ylabel="achieved restitution (-)")
        lower.axvline(0.9, color=QUIET, linewidth=0.6, linestyle=":", marker="", zorder=0)
        lower.set(xlabel="wanted restitution (-)", xlim=(0, 1.02), ylabel="achieved − wanted (-)")
    return figure


def _draw_lines(axes: Axes, names: Sequence[str], column: str, exact: FloatArray) -> None:
    """Draw one column of the table, a line per factor, over a broad line for the exact factor."""
    axes.plot(
        LINE, exact, "-", marker="", color="0.8", linewidth=3.0, label="wanted (exact factor)"
    )
    for name in names:
        table = _table([name], LINE)
        axes.plot(LINE, table[column].to_numpy(), label=LABELS[name], markevery=MARKED)
