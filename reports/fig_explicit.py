"""The laws for a pin in a hole against conformal contact, and what the housing adds."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Conformal, Housing, difference_percent
from cylcontact.laws.explicit import CALIBRATED
from cylcontact.plots.figure import Drawing, new_figure, plain_log
from cylcontact.plots.style import COLOURS
from cylcontact.reports.bench import Bench
from cylcontact.reports.laws_bounds import STEEL
from cylcontact.support.arrays import FloatArray

from .universal import (
    EXTERNAL_PHI,
    FORMULA,
    PER_DECADE,
    PHI_MAX,
    PHI_MIN,
    Curve,
    dimensionless_curves,
    enhanced_curves,
    external_curve,
)

REFITS = {"enhanced fit conformal": "conformal", "enhanced fit practical": "practical"}
# R_o/R_i of the housings: in narrower ones other harmonics than the datum's count.
CLAMPED = (10.0, 50.0)
R_I, DR = 10.0, 0.01  # mm; neither changes a number
PAIR = CylinderPair.from_dR("internal", DR, STEEL, R_i=R_I)
ROWS_PER_DECADE = 20
CAPTION = (
    "Error of the penetration at equal load (%), the largest within a quarter decade of φ = "
    "f/(E* ΔR) (-), steel pin in a steel hole, against conformal contact by Johnson's "
    "datum. Grey: what a housing clamped at 10 to 50 radii adds. The law of 2015: "
    "ΔR = 0.01, 0.05 and 0.5 mm."
)
METHOD = (
    "The reference is Persson's solution, with its datum matched to Johnson's law at small loads, "
    "our choice. Explicit: {constants}, calibrated here. Johnson's law ends at φ = 4π/e² (Eq 8), "
    "where its penetration is about half of Persson's. Winkler: the depth of the foundation is "
    "chosen so that it is right for large loads. The law of 2015 (Eqs 5-6) holds in mm, N and MPa "
    "only: it is evaluated for E = 207 GPa, ν = 0.3 (our choice) from 1 to 10 000 N/mm, and is "
    "extrapolated below ΔR = 0.05 mm. The housing is of the same steel, the pin under a body "
    "force; harmonics that matter in narrower housings are left out. The table also has the law of "
    "2015 refitted over 0.0075 to 2 mm, to Persson's law and to Johnson's, a formula for the "
    "penetration in one line, and the explicit law for rollers, against Johnson's."
)
# Label, colour and line style of the laws drawn.
LAWS = {
    "explicit": ("explicit", COLOURS[0], "-"),
    "johnson": ("Johnson", COLOURS[2], "--"),
    "enhanced": ("law of 2015,{}", COLOURS[1], "-"),
    "liu": ("Liu et al.", COLOURS[3], "-."),
    "winkler": ("Winkler", COLOURS[4], ":"),
}


def draw(bench: Bench) -> Drawing:
    laws, rollers = dimensionless_curves(), external_curve()
    enhanced = enhanced_curves({label: bench.result(name) for label, name in REFITS.items()})
    table = pd.concat(
        [
            *(_rows(curve, "internal", "persson") for curve in (*laws, *enhanced)),
            _rows(rollers, "external", "johnson"),
        ],
        ignore_index=True,
    )
    constants = asdict(CALIBRATED["internal"]).items()
    method = METHOD.format(constants=", ".join(f"{name} = {value:g}" for name, value in constants))
    phi = np.geomspace(PHI_MIN, PHI_MAX, 8 * ROWS_PER_DECADE)
    of = {"contact": "internal", "reference": "persson", "pair": "steel", "phi": phi}
    rows = [
        {"law": f"conformal, clamped at R_o/R_i = {ratio:g}"}
        | of
        | {"load_error_percent": lost_by_housing(ratio, phi)}
        | {"penetration_error_percent": added_by_housing(ratio, phi)}
        for ratio in CLAMPED
    ]
    housing = pd.concat(map(pd.DataFrame, rows))
    headline = _headline({curve.law: curve for curve in laws}, rollers, housing)
    table = pd.concat([table, housing], ignore_index=True)
    return Drawing(_draw_errors(table), table, headline, CAPTION, method)


def _rows(curve: Curve, contact: str, reference: str) -> pd.DataFrame:
    """Tabulate a curve, both ends included."""
    every = PER_DECADE // ROWS_PER_DECADE
    rows = np.union1d(np.arange(0, curve.phi.size, every), curve.phi.size - 1)
    return pd.DataFrame(
        {
            "law": curve.law,
            "contact": contact,
            "reference": reference,
            "pair": curve.pair,
            "phi": curve.phi[rows],
            "load_error_percent": curve.load_error[rows],
            "penetration_error_percent": curve.penetration_error[rows],
        }
    )


def added_by_housing(ratio: float, phi: ArrayLike) -> FloatArray:
    """Return what a steel housing clamped at R_o/R_i adds to the penetration, in percent."""
    load = np.asarray(phi) * PAIR.E_star * DR
    return difference_percent(Conformal(Housing(ratio * R_I)), Conformal(), load, PAIR)


def lost_by_housing(ratio: float, phi: ArrayLike) -> FloatArray:
    """Return what it adds to the load at equal penetration, in percent; negative, a loss."""
    load = np.asarray(phi) * PAIR.E_star * DR
    housed = Conformal(Housing(ratio * R_I)).load(Conformal().penetration(load, PAIR), PAIR)
    return 100 * (housed / load - 1)


def _headline(laws: dict[str, Curve], rollers: Curve, housing: pd.DataFrame) -> dict[str, float]:
    """Return the largest errors of the dimensionless laws, and what a housing adds."""

    def largest(errors: FloatArray) -> float:
        return float(np.nanmax(np.abs(errors)))

    span = f"{PHI_MIN:g} to {PHI_MAX:g}"
    external_span = f"{EXTERNAL_PHI[0]:g} to {EXTERNAL_PHI[1]:g}"
    explicit, formula = laws["explicit"], laws[FORMULA]
    added = housing["penetration_error_percent"]
    return {
        f"explicit, internal: largest error of the load, φ {span}, %": largest(explicit.load_error),
        f"explicit, external: largest error of the load, φ {external_span}, %": largest(
            rollers.load_error
        ),
        "explicit, internal: largest error of the penetration, %": largest(
            explicit.penetration_error
        ),
        "explicit formula: largest error of the penetration, %": largest(formula.penetration_error),
        **{
            f"{name}: largest error of the load, %": largest(laws[name].load_error)
            for name in ("johnson", "liu", "winkler")
        },
        "housing: least that it adds to the penetration, %": float(added.min()),
        "housing: most that it adds to the penetration, %": float(added.max()),
    }


def _draw_errors(table: pd.DataFrame) -> Figure:
    """Draw each law's largest error within a quarter decade of φ, and the band of the housings."""
    figure = new_figure("full", 72.0)
    axes = figure.subplots()
    inside = table[table["contact"] == "internal"]
    for law, (label, colour, line) in LAWS.items():
        for number, (pair, curve) in enumerate(inside[inside["law"] == law].groupby("pair")):
            error = curve.set_index("phi")["penetration_error_percent"].abs().dropna()
            axes.plot(
                error.index,
                error.rolling(ROWS_PER_DECADE // 2 + 1, center=True, min_periods=1).max(),
                color=colour,
                linestyle=line,
                marker="os^"[number] if law == "enhanced" else "",
                markevery=(3, 12),
                label=label.format(str(pair).rpartition("=")[2]),
            )
    low, high = (
        rows["penetration_error_percent"].to_numpy()
        for _, rows in inside[inside["law"].str.startswith("conformal, ")].groupby("law")
    )
    phi = np.geomspace(PHI_MIN, PHI_MAX, low.size)
    axes.fill_between(phi, low, high, color="0.85", zorder=0, label="what the housing adds")
    axes.set(xscale="log", xlim=(PHI_MIN, PHI_MAX))
    plain_log(axes, "y", (0.01, 0.1, 1, 10, 100))
    axes.set(ylim=(0.005, 300), xlabel=r"load $\varphi = f/(E^*\Delta R)$ (-)")
    axes.set_ylabel("error of the penetration (%)")
    figure.legend(loc="outside lower center", ncols=3)
    return figure
