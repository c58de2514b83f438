"""All laws against conformal contact over the whole domain, in the universal variables."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.laws.explicit import CALIBRATED
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_log
from cylcontact.plots.style import COLOURS, LINE_STYLES, MARKERS
from cylcontact.reports.bench import Bench

from .universal import (
    EXTERNAL_PHI,
    FORMULA,
    PHI_MAX,
    PHI_MIN,
    dimensionless_curves,
    enhanced_curves,
    error_table,
    external_curve,
)

REFITS = {"enhanced fit conformal": "conformal", "enhanced fit internal": "internal"}
CAPTION = (
    "Largest error (%) of the load at given penetration in each decade of φ = f/(E* ΔR) (-), "
    "against Persson's conformal solution, internal contact. (a) Laws with one dimensionless "
    "curve for all pairs. (b, c) The enhanced law, which is not dimensionless, for one steel and "
    "three clearances, with the published coefficients and refitted to Persson's solution."
)
METHOD = (
    "Persson's datum is matched to Johnson's law at small loads, our choice. Explicit: "
    "{constants}, calibrated here; its one-line formula gives the penetration from the load and is "
    "inverted numerically. Johnson's law ends at φ = 4π/e² (Eq 8), where its penetration is about "
    "half of Persson's. Winkler: the depth of the foundation is chosen so that it is right for "
    "large loads. The enhanced law (Eqs 5-6) holds in mm, N and MPa only: it is evaluated for E = "
    "207 GPa, ν = 0.3 (our choice), at ΔR = 0.01, 0.05 and 0.5 mm from 1 to 10 000 N/mm, with the "
    "published coefficients and with those of the fit 'conformal' (to Persson, 10 to 1000 N/mm, "
    "0.0075 to 2 mm). Outside the loads and clearances of its calibration it is extrapolated: the "
    "published coefficients were made for ΔR above 0.05 mm. Points are at the geometric middle of "
    "the part of a decade that a law covers. The table lists every law's largest and RMS error by "
    "decade of φ, the fit 'internal' (to Johnson) and the explicit law for external contact, "
    "judged by Johnson's law, among them."
)
LABELS = {
    "explicit": "explicit (3 constants)",
    FORMULA: "explicit, one-line penetration",
    "johnson": "Johnson",
    "liu": "Liu et al.",
    "winkler": "Winkler",
}
ENHANCED = {"enhanced": "enhanced, published", "enhanced fit conformal": "enhanced, refit"}


def draw(bench: Bench) -> Drawing:
    laws = dimensionless_curves()
    enhanced = enhanced_curves({label: bench.result(name) for label, name in REFITS.items()})
    table = pd.concat(
        [
            error_table([*laws, *enhanced], "internal", "persson"),
            error_table([external_curve()], "external", "johnson"),
        ],
        ignore_index=True,
    )
    constants = asdict(CALIBRATED["internal"]).items()
    method = METHOD.format(constants=", ".join(f"{name} = {value:g}" for name, value in constants))
    return Drawing(_draw_panels(table), table, _headline(table), CAPTION, method)


def _headline(table: pd.DataFrame) -> dict[str, float]:
    """Return the largest errors of the dimensionless laws."""
    whole = table[(table["range"] == "all") & (table["pair"] == "any")]
    largest = whole.set_index(["law", "contact", "error_of"])["largest_error_percent"]
    span = f"{PHI_MIN:g} to {PHI_MAX:g}"
    external_span = f"{EXTERNAL_PHI[0]:g} to {EXTERNAL_PHI[1]:g}"
    keys = {
        f"explicit, internal: largest error of the load, φ {span}, %": (
            "explicit", "internal", "load",
        ),
        f"explicit, external: largest error of the load, φ {external_span}, %": (
            "explicit", "external", "load",
        ),
        "explicit, internal: largest error of the penetration, %": (
            "explicit", "internal", "penetration",
        ),
        "explicit formula: largest error of the penetration, %": (
            FORMULA, "internal", "penetration",
        ),
    }  # fmt: skip
    for name in ("johnson", "liu", "winkler"):
        keys[f"{name}: largest error of the load, %"] = (name, "internal", "load")
    return {text: float(largest[key]) for text, key in keys.items()}


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw the largest errors of the load by decade of φ, the enhanced law's beside the others."""
    figure = new_figure("full", 84.0)
    panels = figure.subplots(1, 3, sharex=True, sharey=True)
    by_decade = table[
        (table["range"] != "all") & (table["error_of"] == "load") & (table["contact"] == "internal")
    ]
    for number, (law, label) in enumerate(LABELS.items()):
        _draw_curve(panels[0], by_decade[by_decade["law"] == law], number, label)
    for axes, law in zip(panels[1:], ENHANCED, strict=True):
        curves = by_decade[by_decade["law"] == law].groupby("pair", sort=False)
        for number, (pair, curve) in enumerate(curves):
            clearance = str(pair).split("; ")[-1].replace("dR", r"$\Delta R$")
            _draw_curve(axes, curve, number, clearance)
    titles = ("one curve for like materials", *ENHANCED.values())
    for number, (axes, title) in enumerate(zip(panels, titles, strict=True)):
        axes.set(xscale="log", xlim=(PHI_MIN, PHI_MAX))
        plain_log(axes, "y", (0.01, 0.1, 1, 10, 100))
        axes.set(ylim=(0.01, 400), xlabel=r"load $\varphi = f/(E^*\Delta R)$ (-)")
        panel_title(axes, number, title)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2))
    panels[0].set_ylabel("largest error of the load (%)")
    return figure


def _draw_curve(axes: Axes, curve: pd.DataFrame, number: int, label: str) -> None:
    """Draw the largest error of a law in each decade."""
    axes.plot(
        np.sqrt(curve["phi_from"] * curve["phi_to"]),
        curve["largest_error_percent"],
        color=COLOURS[number],
        linestyle=LINE_STYLES[number],
        marker=MARKERS[number],
        label=label,
    )
