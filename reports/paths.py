"""Figs 18 and 19: where the pin's centre is in the hole, at two clearances.

The paper draws the paths, which are chaotic and cross each other many times. Here is how much of
the time the centre is how far out, which a reader can compare.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cylcontact.mechanism import Case, Trajectory
from cylcontact.plots.figure import Drawing, legend_below, new_figure, panel_title
from cylcontact.plots.style import COLOURS, LINE_STYLES, QUIET
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import as_floats

from .paper import FRICTIONS, RESTITUTIONS
from .slider_crank import CASES, LAW_NAMES, assumed, horizons, law_ends, mechanism, simulated

# The first revolution that counts, from 0, by when the runs that settle have settled, and how many.
FIRST, COUNTED = 3, 10
NUMBERS = {
    "contact_fraction": "share of time in contact, -",
    "impacts": "impacts per revolution, -",
    "max_penetration_um": "largest penetration, um",
}
CAPTION = (
    "Share of the time in which the pin's centre is closer to the hole's than a distance, relative "
    "to the radial clearance c of {clearance:g} mm, for four laws and four pairs of restitution "
    "c_e and friction coefficient c_f, over {counted} revolutions. Right of the dotted line the "
    "pin touches the hole. The mechanism's data are assumed."
)
METHOD = (
    "Revolutions {first} to {last} of the slider-crank. The restitution c_e acts through the "
    "factor of Lankarani and Nikravesh. In {always} of the {cases} cases the pin stays in contact "
    "throughout. {whirls}{horizons} Beyond that a path is one of many, and only its statistics are "
    "of use. Which revolutions the paper draws is not said. {ends} {assumed}"
)
SHARES = np.linspace(0.0, 1.0, 201)


def distance_drawing(bench: Bench, clearance: float) -> Drawing:
    """Draw the distribution of the centre's distance, for all laws, restitutions and frictions."""
    drawn = [case for case in CASES if case.clearance == clearance]
    runs = {case: simulated(bench, case, FIRST + COUNTED) for case in drawn}
    means = {case: run.statistics(FIRST).mean for case, run in runs.items()}
    headline = {
        f"{case.law}, c_e = {case.restitution:g}, c_f = {case.friction:g}: {text}": mean[column]
        for case, mean in means.items()
        for column, text in NUMBERS.items()
    }
    deep = {
        case: runs[case] for case in drawn if means[case]["max_penetration_um"] > 1e3 * clearance
    }
    method = METHOD.format(
        first=FIRST + 1,
        last=FIRST + COUNTED,
        always=sum(mean["contact_fraction"] == 1.0 for mean in means.values()),
        cases=len(drawn),
        whirls=_whirls(deep),
        horizons=horizons(bench, clearance),
        ends=law_ends(list(runs.values())),
        assumed=assumed(mechanism(bench)),
    )
    table = pd.concat([distances(case, run) for case, run in runs.items()], ignore_index=True)
    caption = CAPTION.format(clearance=clearance, counted=COUNTED)
    return Drawing(_draw_panels(table, clearance), table, headline, caption, method)


def distances(case: Case, run: Trajectory) -> pd.DataFrame:
    """Return the distance that the pin's centre stays within for each share of the time."""
    rows = run.revolution >= FIRST
    distance = np.hypot(*run.eccentricity[rows].T)
    # A distance between two rows of the run counts for the time between them.
    middle, spent = (distance[1:] + distance[:-1]) / 2, np.diff(run.time[rows])
    order = np.argsort(middle)
    share = np.cumsum(spent[order]) / spent.sum()
    return pd.DataFrame(
        {
            "law": case.law,
            "clearance_mm": case.clearance,
            "restitution": case.restitution,
            "friction": case.friction,
            "share": SHARES,
            "distance_um": 1e6 * np.interp(SHARES, share, middle[order]),
        }
    )


def _whirls(deep: Mapping[Case, Trajectory]) -> str:
    """Return a sentence on the runs whose penetration exceeds the clearance, or nothing."""
    if not deep:
        return ""
    turns = " and ".join(
        f"{_turns(run):.2g} turns with the {LAW_NAMES[str(case.law)]} law at "
        f"c_e = {case.restitution:g} and c_f = {case.friction:g}"
        for case, run in deep.items()
    )
    return (
        "Where the penetration exceeds the clearance, the pin's centre whirls about the hole's "
        f"and its inertia presses it outwards: {turns} per revolution of the crank, both "
        "senses counted. "
    )


def _turns(run: Trajectory) -> float:
    """Return the turns of the pin's centre about the hole's per revolution, without sign."""
    rows = run.revolution >= FIRST
    angle = np.unwrap(np.arctan2(*run.eccentricity[rows].T[::-1]))
    return float(np.abs(np.diff(angle)).sum() / (2 * np.pi) / np.ptp(run.revolution[rows]))


def _draw_panels(table: pd.DataFrame, clearance: float) -> Figure:
    """Draw a panel for each pair of losses and a line for each law."""
    figure = new_figure("full", 62.0)
    losses = [(ce, cf) for ce in RESTITUTIONS for cf in FRICTIONS]
    panels = figure.subplots(1, len(losses), sharex=True, sharey=True)
    for number, (axes, (ce, cf)) in enumerate(zip(panels, losses, strict=True)):
        rows = table[(table["restitution"] == ce) & (table["friction"] == cf)]
        axes.axvline(1.0, color=QUIET, linewidth=0.8, linestyle=":", marker="")
        for line, (law, name) in enumerate(LAW_NAMES.items()):
            chosen = rows[rows["law"] == law]
            distance = as_floats(1e-3 * chosen["distance_um"] / clearance)
            style = {"color": COLOURS[line], "linestyle": LINE_STYLES[line], "marker": ""}
            axes.plot(distance, chosen["share"], label=name, **style)
        axes.set_xlabel("distance / $c$ (-)")
        panel_title(axes, number, f"$c_e$ = {ce:g}, $c_f$ = {cf:g}")
    panels[0].set(ylabel="share of the time (-)", ylim=(0, 1))
    panels[0].set_xlim(0, None)
    legend_below(panels[0], 4)
    return figure


FIGURES: dict[str, Callable[[Bench], Drawing]] = {
    "fig18": partial(distance_drawing, clearance=0.5),
    "fig19": partial(distance_drawing, clearance=0.02),
}
