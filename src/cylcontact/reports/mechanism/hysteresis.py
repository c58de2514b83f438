"""Force against penetration over an impact, with its hysteresis: Fig 17."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.arrays import FloatArray
from cylcontact.laws import LAWS
from cylcontact.mechanism import Case, Trajectory
from cylcontact.pair import CylinderPair
from cylcontact.plots.figure import new_figure, panel_title
from cylcontact.plots.style import COLOURS, LINE_STYLES, MARKERS
from cylcontact.reports.mechanism.runs import LAW_NAMES

# Penetrations over which laws are compared: two decades, up to the deepest that is met.
DECADES, POINTS = 2.0, 801


def law_look(law: str) -> dict[str, Any]:
    """Return the colour, line style and marker of a law.

    Examples
    --------
    >>> law_look("johnson")["linestyle"]
    '--'
    """
    number = list(LAW_NAMES).index(law)
    return {
        "color": COLOURS[number],
        "linestyle": LINE_STYLES[number],
        "marker": MARKERS[number],
    }


def impact_table(runs: Mapping[Case, Trajectory]) -> pd.DataFrame:
    """Return force and penetration over the first contact of every run.

    The runs of one clearance are alike until then, so that all laws meet the same impact.

    Parameters
    ----------
    runs : mapping of Case to Trajectory
        Their first contact is complete.

    Returns
    -------
    pandas.DataFrame
        Columns law, clearance_mm, time_us since the onset, penetration_um, force_N and
        elastic_force_N (the same without dissipation).
    """
    return pd.concat([_impact(case, run) for case, run in runs.items()], ignore_index=True)


def _impact(case: Case, run: Trajectory) -> pd.DataFrame:
    """Return one law's impact."""
    onset, release = run.contacts[["onset_s", "release_s"]].to_numpy(dtype=float)[0]
    rows = run.in_contact & (run.time >= onset) & (run.time <= release)
    pair = run.mechanism.clearance.pair
    assert pair is not None
    # At the ends of a contact the root leaves a rounding error of either sign.
    depth = np.maximum(run.penetration[rows], 0.0)
    return pd.DataFrame(
        {
            "law": case.law,
            "clearance_mm": case.clearance,
            "time_us": (run.time[rows] - onset) * 1e6,
            "penetration_um": depth * 1e6,
            "force_N": run.normal_force[rows],
            "elastic_force_N": total_force(case.law, depth * 1e3, pair),
        }
    )


def total_force(law: str, penetration: FloatArray, pair: CylinderPair) -> FloatArray:
    """Return a law's elastic force in N at penetrations in mm, over the pair's whole length."""
    return LAWS[law]().load(penetration, pair) * pair.contact_length("a force")


def force_ratio(one: str, other: str, pair: CylinderPair, deepest: float) -> pd.DataFrame:
    """Compare the forces of two laws at equal penetration.

    Parameters
    ----------
    one, other : str
        Laws.
    pair : CylinderPair
        The joint.
    deepest : float
        The largest penetration in mm; the smallest is `DECADES` below it.

    Returns
    -------
    pandas.DataFrame
        Columns penetration_mm and ratio, that of `one` over `other`; NaN beyond a law's domain.

    Examples
    --------
    >>> from cylcontact import Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel, length=10.0)
    >>> ratio = force_ratio("lankarani-nikravesh", "johnson", pair, 0.05)["ratio"]
    >>> print(ratio.max().round(3))
    0.536
    """
    penetration = np.geomspace(deepest * 10**-DECADES, deepest, POINTS)
    ratio = total_force(one, penetration, pair) / total_force(other, penetration, pair)
    return pd.DataFrame({"penetration_mm": penetration, "ratio": ratio})


def crossings(table: pd.DataFrame) -> list[float]:
    """Return the penetrations in mm at which the ratio of `force_ratio` passes 1.

    Examples
    --------
    >>> crossings(pd.DataFrame({"penetration_mm": [1.0, 2.0, 3.0], "ratio": [0.5, 1.5, 2.0]}))
    [1.5]
    """
    x, excess = table["penetration_mm"].to_numpy(), table["ratio"].to_numpy() - 1
    at = np.flatnonzero(excess[:-1] * excess[1:] < 0)
    share = excess[at] / (excess[at] - excess[at + 1])
    return [float(value) for value in x[at] + share * (x[at + 1] - x[at])]


def impact_panels(table: pd.DataFrame, clearances: Sequence[float]) -> Figure:
    """Draw force against penetration, a panel for each clearance and a loop for each law.

    Parameters
    ----------
    table : pandas.DataFrame
        Of `impact_table`.
    clearances : sequence of float
        In mm.
    """
    figure = new_figure("full", 74.0)
    panels = figure.subplots(1, len(clearances), squeeze=False)[0]
    for number, (axes, clearance) in enumerate(zip(panels, clearances, strict=True)):
        chosen = table[table["clearance_mm"] == clearance]
        for law, loop in chosen.groupby("law", sort=False):
            _draw_loop(axes, str(law), loop)
        axes.set(xlabel="penetration δ (µm)", xlim=(0, None), ylim=(0, None))
        panel_title(axes, number, f"radial clearance {clearance:g} mm")
    panels[0].set_ylabel("contact force (kN)")
    panels[0].legend(loc="upper left")
    return figure


def _draw_loop(axes: Axes, law: str, loop: pd.DataFrame) -> None:
    """Draw a loop with its markers along the penetration, and the elastic curve inside it."""
    depth, force = loop["penetration_um"].to_numpy(), loop["force_N"].to_numpy() / 1e3
    look = law_look(law)
    marked = np.searchsorted(depth[: depth.argmax()], np.arange(0.25, 1, 0.25) * depth.max())
    axes.plot(depth, force, label=LAW_NAMES[law], markevery=marked.tolist(), **look)
    order = np.argsort(depth)
    thin = look | {"marker": "", "linewidth": 0.5, "linestyle": "-"}
    axes.plot(depth[order], loop["elastic_force_N"].to_numpy()[order] / 1e3, **thin)
