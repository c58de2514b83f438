"""All laws against conformal contact over the whole domain, in the universal variables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter

from cylcontact.laws.explicit import CALIBRATED
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.maps import signed
from cylcontact.plots.style import COLOURS, LINE_STYLES
from cylcontact.reports.bench import Bench

from .universal import (
    EXTERNAL_PHI,
    FORMULA,
    PHI_MAX,
    PHI_MIN,
    Curve,
    dimensionless_curves,
    enhanced_curves,
    error_table,
    external_curve,
)

REFITS = {"enhanced fit conformal": "conformal", "enhanced fit internal": "internal"}
CAPTION = (
    "Contact laws against Persson's conformal solution, internal contact, in φ = f/(E* ΔR) and "
    "δ/ΔR (-). (a) Penetration. (b) Error (%) of the load at given penetration; the axis is linear "
    "between -0.1 and 0.1 % and logarithmic beyond. Persson's datum is matched to Johnson's law at "
    "small loads, our choice. Explicit: {constants}, calibrated here; its "
    "one-line formula gives the penetration from the load and is inverted numerically for (b). "
    "Johnson's law ends at φ = 4π/e² (Eq 8), where its penetration is about half of Persson's. "
    "Winkler: the depth of the foundation is chosen so that it is right for large loads. The "
    "enhanced law (Eqs 5-6) is not dimensionless and holds in mm, N and MPa only: it is drawn for "
    "one steel, E = 207 GPa, ν = 0.3 (our choice), at ΔR = 0.01, 0.05 and 0.5 mm from 1 to 10 000 "
    "N/mm, with the published coefficients and with those of the fit 'conformal' (to Persson, 10 "
    "to 1000 N/mm, 0.0075 to 2 mm). Outside the loads and clearances of its calibration it is "
    "extrapolated: the published coefficients were made for ΔR above 0.05 mm. The table lists "
    "every law's largest and RMS error by decade of φ, the fit 'internal' (to Johnson) and the "
    "explicit law for external contact, judged by Johnson's law, among them."
)
LABELS = {
    "explicit": "explicit (3 constants)",
    FORMULA: "explicit, one-line penetration",
    "johnson": "Johnson (Eq 1)",
    "liu": "Liu et al.",
    "winkler": "Winkler",
    "enhanced": "enhanced, published",
    "enhanced fit conformal": "enhanced, refit",
}
# The enhanced law's two sets of coefficients differ from the other laws in colour and marks.
ENHANCED: dict[str, dict[str, Any]] = {
    "enhanced": {"color": "#56B4E9", "markerfacecolor": "#56B4E9"},
    "enhanced fit conformal": {"color": "#8C510A", "markerfacecolor": "white"},
}
THIN = {"linestyle": "-", "linewidth": 0.9}
MARKS = ("o", "s", "^")  # by clearance
LINEAR = 0.1  # percent, within which the axis of errors is linear
TICKS = (-100, -10, -1, -0.1, 0, 0.1, 1, 10, 100, 1000)


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
    caption = CAPTION.format(
        constants=", ".join(f"{name} = {value:g}" for name, value in constants)
    )
    drawn = [curve for curve in enhanced if "internal" not in curve.law]
    return Drawing(_draw_panels(laws, drawn), table, _headline(table), caption)


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


def _draw_panels(laws: Sequence[Curve], enhanced: Sequence[Curve]) -> Figure:
    """Draw δ/ΔR and the error of the load against φ = f/(E*·ΔR)."""
    figure = new_figure("full", 112.0)
    left, right = figure.subplots(1, 2, width_ratios=(4, 6))
    left.plot(
        laws[0].phi, laws[0].reference_d, color="0.8", linewidth=4.0, marker="", label="Persson"
    )
    right.axhline(0, color="0.8", linewidth=4.0, marker="", zorder=0)
    for number, curve in enumerate(laws):
        style = {"color": COLOURS[number], "linestyle": LINE_STYLES[number], "zorder": 3}
        _draw_curve(left, right, curve, style)
    for number, curve in enumerate(enhanced):
        marker = MARKS[number % len(MARKS)]
        _draw_curve(left, right, curve, ENHANCED[curve.law] | THIN | {"marker": marker})
    for axes in (left, right):
        axes.set(xscale="log", xlim=(PHI_MIN, PHI_MAX))
        axes.set_xlabel(r"load $\varphi = f/(E^*\Delta R)$ (-)")
        axes.xaxis.set_minor_locator(LogLocator(subs=(1.0,), numticks=20))
        axes.xaxis.set_minor_formatter(NullFormatter())
    left.set(yscale="log", ylabel=r"penetration $\delta/\Delta R$ (-)", ylim=(2e-6, 100))
    right.set_yscale("symlog", linthresh=LINEAR, linscale=0.6)
    right.set(ylim=(-130, 400), ylabel="error of the load (%)")
    right.yaxis.set_major_locator(FixedLocator(TICKS))
    right.yaxis.set_major_formatter(FuncFormatter(lambda value, _: signed(value)))
    panel_title(left, 0, "penetration")
    panel_title(right, 1, "error of the load at given penetration")
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _draw_curve(left: Axes, right: Axes, curve: Curve, style: dict[str, Any]) -> None:
    """Draw a law in both panels."""
    every = max(1, curve.phi.size // 4)
    marked = {"markevery": (every // 2, every)} if "marker" in style else {"marker": ""}
    label = LABELS[curve.law]
    if curve.pair != "any":
        label += ", " + curve.pair.split("; ")[-1].replace("dR", r"$\Delta R$")
    left.plot(curve.phi, curve.d, label=label, **style, **marked)
    right.plot(curve.phi, curve.load_error, **style, **marked)
