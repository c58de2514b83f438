"""The fast laws for a pin and a hole of any two materials, against conformal contact."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Conformal, ContactLaw, ExplicitPair, Parametric
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_log
from cylcontact.plots.style import COLOURS, LINE_STYLES
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray, as_floats

from .joints import draw_plane, error_table

LAWS: tuple[ContactLaw, ...] = (Parametric(), ExplicitPair())
# Of both maps, in percent.
LEVELS = (0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1, 1.2)
EDGE = 0.999  # the largest |α|: a thousand times as stiff
COUNT = 25  # of values of β, and of α at each
PHI: FloatArray = np.geomspace(1e-6, 60.0, 33)
CAPTION = (
    "Largest error (%) of the load at equal penetration of two fast laws for a pin and a hole of "
    "any two materials, parametric and explicit-pair, against conformal contact. (a, b) Over 1e-6 "
    "≤ φ = f/(E* ΔR) ≤ 60, against Dundurs' α and β (-); all pairs lie inside the parallelogram. "
    "(c) Over those pairs, against φ."
)
METHOD = (
    "The law parametric takes a fixed number of Newton steps; explicit-pair is a formula in one "
    "line. Both have Johnson's datum, as the conformal solution has here. The pairs are all that "
    "are possible with Poisson's ratios from 0 to 0.5. The laws are calibrated here, on other "
    "values of α, β and φ."
)


def draw(_bench: Bench) -> Drawing:
    table = _table()
    return Drawing(_draw_panels(table), table, _headline(table), CAPTION, METHOD)


def possible_pairs() -> tuple[FloatArray, FloatArray]:
    """Return α and β of pairs over the whole parallelogram, shape (β, α)."""
    beta = np.linspace(-EDGE / 2, EDGE / 2, COUNT)[:, None]
    low, high = np.maximum(-EDGE, 4 * beta - 1), np.minimum(EDGE, 4 * beta + 1)
    alpha = low + (high - low) * np.linspace(0, 1, COUNT)
    return as_floats(alpha), as_floats(np.broadcast_to(beta, alpha.shape))


def _table() -> pd.DataFrame:
    """Tabulate the errors of the load of each law."""
    alpha, beta = possible_pairs()
    pair = CylinderPair.from_dundurs(alpha[..., None], beta[..., None])
    d = Conformal().penetration(PHI, pair)
    parts = []
    for law in LAWS:
        error = as_floats(100 * (law.load(d, pair) / PHI - 1))
        parts.append(error_table("law", law.name, alpha[..., None], beta[..., None], PHI, error))
    return pd.concat(parts, ignore_index=True)


def _headline(table: pd.DataFrame) -> dict[str, float]:
    """Return the largest error of each law."""
    largest = table["error_percent"].abs().groupby(table["law"]).max()
    return {f"{law}: largest error of the load, %": float(e) for law, e in largest.items()}


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw two maps over the pairs, and the largest errors against the load."""
    figure = new_figure("full", 68.0)
    *maps, over = figure.subplots(1, 3)
    table = table.assign(size=table["error_percent"].abs())
    for number, (axes, law) in enumerate(zip(maps, LAWS, strict=True)):
        own = table[table["law"] == law.name]
        drawn = _draw_map(axes, own)
        panel_title(axes, number, law.name)
        line = own.groupby("phi")["size"].max()
        style = LINE_STYLES[number]
        over.plot(line.index, line, style, color=COLOURS[number], marker="", label=law.name)
    bar = figure.colorbar(drawn, ax=maps, location="bottom", aspect=40)
    bar.set_label("largest error (%)")
    bar.set_ticks(LEVELS, labels=[f"{level:g}" for level in LEVELS])
    plain_log(over, "x", (1e-4, 1e-2, 1))
    plain_log(over, "y", (0.001, 0.01, 0.1, 1))
    over.set(
        xlim=(PHI[0], PHI[-1]),
        ylim=(1e-3, 3),
        xlabel=r"load $\varphi = f/(E^*\Delta R)$ (-)",
        ylabel="largest error (%)",
    )
    over.legend(loc="upper left", bbox_to_anchor=(0, 0.85))
    panel_title(over, 2, "any pair")
    return figure


def _draw_map(axes: Axes, table: pd.DataFrame) -> QuadContourSet:
    """Draw the largest error of a law over the pairs."""
    shape = COUNT, COUNT, PHI.size
    alpha, beta, size = (table[c].to_numpy().reshape(shape) for c in ("alpha", "beta", "size"))
    draw_plane(axes)
    axes.set(xlabel=r"Dundurs' $\alpha$ (-)", ylabel=r"Dundurs' $\beta$ (-)")
    norm = BoundaryNorm(LEVELS, 256, extend="min")
    return axes.contourf(
        alpha[..., 0],
        beta[..., 0],
        size.max(axis=-1),
        LEVELS,
        cmap="viridis",
        norm=norm,
        extend="min",
    )
