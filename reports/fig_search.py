"""The coefficients that every run of the genetic search ends at, before the local polish."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes

from cylcontact.bodies.pair import CONTACTS
from cylcontact.fitting.results import LawFit
from cylcontact.plots.figure import (
    Drawing,
    StyledFigure,
    legend_below,
    new_figure,
    panel_title,
    plain_log,
)
from cylcontact.plots.style import COLOURS, MARKERS
from cylcontact.reports.bench import Bench
from cylcontact.reports.fit_figures import runs_table

CAPTION = (
    "Distance (%, absolute) of every coefficient of Eq 6 from the best polished one of its "
    "campaign, for each run of the genetic search before the local polish; distances below 0.001 "
    "% are drawn on the lower edge. Synthetic: fitted to the published law itself. Recovered and "
    "refit: to Johnson's law, with two coefficients free and with all."
)
METHOD = (
    "In the campaigns 'recovered' the other coefficients are fixed or tied. The symbols of (a) "
    "are the package's {symbols}. Marks are spread sideways only to separate them. Populations, "
    "generations and bounds are ours."
)
SYMBOLS = {
    "Y_log_scale": r"$Y_\mathrm{scale}$",
    "Y_log_exponent": r"$Y_\mathrm{exp}$",
    "Y_slope": r"$Y_\mathrm{slope}$",
    "Y_offset": r"$Y_\mathrm{offset}$",
    "n_exponent": r"$n_\mathrm{exp}$",
}
# The campaigns of a contact, and what the legend calls them.
CAMPAIGNS = {"synthetic-{}": "synthetic", "recovered-{}": "recovered", "{}": "refit"}
FLOOR = 1e-3  # percent
# Distance of the campaigns of one coefficient, and the width over which their runs are spread.
APART, SPREAD = 0.29, 0.16


def draw(bench: Bench) -> Drawing:
    table = pd.concat(
        [
            searches(bench.result(campaign.format(contact))).assign(kind=kind)
            for contact in CONTACTS
            for campaign, kind in CAMPAIGNS.items()
        ],
        ignore_index=True,
    )
    headline: dict[str, float] = {}
    for campaign, rows in table.groupby("campaign", sort=False):
        headline |= {
            f"{campaign}: runs": float(rows["run"].nunique()),
            f"{campaign}: median distance, %": float(rows["away_percent"].median()),
            f"{campaign}: largest distance, %": float(rows["away_percent"].max()),
        }
    method = METHOD.format(symbols=", ".join(f"{name}" for name in SYMBOLS))
    return Drawing(_draw_panels(table), table, headline, CAPTION, method)


def searches(result: LawFit) -> pd.DataFrame:
    """Return the coefficients that the search of each run reached before the polish."""
    runs = runs_table(result).drop(columns="seconds")
    names = [f"{name}_searched" for name in result.profiles]
    others = [column for column in runs if column not in names]
    table = runs.melt(others, names, "coefficient", "value")
    table["coefficient"] = table["coefficient"].str.removesuffix("_searched")
    best = table["coefficient"].map(result.coefficients)
    table["away_percent"] = 100 * (table["value"] / best - 1).abs()
    return table.assign(campaign=result.name, contact=result.contact)


def _draw_panels(table: pd.DataFrame) -> StyledFigure:
    """Draw a panel for each contact, as wide as it has coefficients."""
    figure = new_figure("full", 80.0)
    of_contact = {contact: table[table["contact"] == contact] for contact in CONTACTS}
    widths = [rows["coefficient"].nunique() for rows in of_contact.values()]
    panels = figure.subplots(1, 2, sharey=True, width_ratios=widths)
    for number, (axes, (contact, rows)) in enumerate(zip(panels, of_contact.items(), strict=True)):
        _draw_runs(axes, rows)
        panel_title(axes, number, f"{contact} contact")
    panels[0].set_ylabel("distance from the best polished value (%)")
    legend_below(panels[0], 3)
    return figure


def _draw_runs(axes: Axes, table: pd.DataFrame) -> None:
    """Draw each run's distances, the campaigns side by side at every coefficient."""
    names = list(dict.fromkeys(table["coefficient"]))
    for number, (kind, rows) in enumerate(table.groupby("kind", sort=False)):
        runs = rows["run"].rank(method="dense")
        beside = APART * (number - 1) + SPREAD * (runs / runs.max() - 0.5)
        axes.plot(
            rows["coefficient"].map(names.index) + beside,
            rows["away_percent"].clip(lower=FLOOR),
            color=COLOURS[number],
            marker=MARKERS[number],
            linestyle="none",
            label=str(kind),
            clip_on=False,
            zorder=3,
        )
    plain_log(axes, "y", (1e-3, 1e-2, 0.1, 1, 10, 100, 1000))
    axes.set(ylim=(FLOOR, 5e3), xlim=(-0.55, len(names) - 0.45))
    axes.set_xticks(range(len(names)), [SYMBOLS.get(name, f"${name}$") for name in names])
    axes.tick_params(axis="x", length=0)
    axes.grid(axis="y", linewidth=0.4, color="0.9")
