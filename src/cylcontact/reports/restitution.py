"""The restitution that is wanted against the one that a hysteresis factor gives."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.arrays import FloatArray
from cylcontact.dissipation import achieved_restitution, hysteresis_factor
from cylcontact.plots.figure import new_figure, panel_title
from cylcontact.plots.style import QUIET

# The wanted restitutions of the table, and those that the lines are drawn through.
WANTED: FloatArray = np.arange(1, 11) / 10
LINE: FloatArray = np.arange(5, 101) / 100
MARKED = (5, 10)  # where WANTED stands in LINE: the first one, and the step to the next

# What the legend calls a factor.
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


def restitution_table(names: Sequence[str], wanted: FloatArray = WANTED) -> pd.DataFrame:
    """Tabulate wanted against achieved restitution.

    Parameters
    ----------
    names : sequence of str
        Hysteresis factors, by the names of `cylcontact.dissipation.FACTORS`.
    wanted : array of float, optional
        Wanted coefficients of restitution.

    Returns
    -------
    pandas.DataFrame
        Columns factor, wanted_restitution, chi, achieved_restitution and error (achieved less
        wanted), all dimensionless.

    Examples
    --------
    >>> table = restitution_table(["lankarani-nikravesh", "exact"], np.array([0.5, 0.9]))
    >>> print(table["achieved_restitution"].round(4).tolist())
    [0.7252, 0.9132, 0.5, 0.9]
    """
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
                    # Rounding noise would differ from machine to machine; + 0.0 ends −0.0.
                    "error": np.round(achieved - wanted, 12) + 0.0,
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def restitution_panels(groups: Sequence[tuple[str, Sequence[str]]]) -> Figure:
    """Draw achieved against wanted restitution, and below it the error, a column per group.

    Parameters
    ----------
    groups : sequence of (str, sequence of str)
        A title and the factors of each column, at most five of them.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> figure = restitution_panels([("early", ["hunt-crossley"]), ("late", ["hu-guo"])])
    >>> len(figure.axes)
    4
    """
    figure = new_figure("full", 118.0)
    grid = figure.subplots(2, len(groups), sharex="col", height_ratios=(5, 3), squeeze=False)
    for number, (title, names) in enumerate(groups):
        upper, lower = grid[:, number]
        _draw_lines(upper, names, "achieved_restitution", LINE)
        _draw_lines(lower, names, "error", np.zeros_like(LINE))
        panel_title(upper, number, title)
        panel_title(lower, number + len(groups), f"error of ({'abcdefgh'[number]})")
        upper.legend(loc="lower right")
        upper.set(ylim=(0, 1.02))
        lower.axvline(0.9, color=QUIET, linewidth=0.6, linestyle=":", marker="", zorder=0)
        lower.set(xlabel="wanted restitution (-)", xlim=(0, 1.02))
    grid[0, 0].set_ylabel("achieved restitution (-)")
    grid[1, 0].set_ylabel("achieved less wanted (-)")
    return figure


def _draw_lines(axes: Axes, names: Sequence[str], column: str, exact: FloatArray) -> None:
    """Draw one column of the table, a line per factor, over a broad line for the exact factor."""
    axes.plot(
        LINE, exact, "-", marker="", color="0.8", linewidth=3.0, label="wanted (exact factor)"
    )
    for name in names:
        table = restitution_table([name], LINE)
        axes.plot(LINE, table[column].to_numpy(), label=LABELS[name], markevery=MARKED)
