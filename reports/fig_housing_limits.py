"""What the housing does to the stiffness of one joint, and to the load at which it first yields."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from cylcontact.laws import Conformal, Housing
from cylcontact.limits import first_yield, yield_load
from cylcontact.plots.figure import Drawing, legend_below, new_figure, panel_title, plain_log
from cylcontact.plots.style import COLOURS, QUIET
from cylcontact.reports.bench import Bench

from .fig_housing import CLAMPS, HOLE, LOAD, NAMED, PIN, R_I, RATIOS, joint, smooth
from .joints import origins_of

CAPTION = (
    "Thin eyes are soft and weak: the joint of the figure of penetrations in housings of R_o/R_i "
    "(-), with the rim or a sector clamped. (a) Tangent stiffness over that by Johnson's datum "
    "(-). (b) First yield by von Mises over that of an infinite plate (-); circles: the bore "
    "yields beside the contact, by bending and hoop tension."
)
METHOD = (
    "R_i = 10 mm, R_j = 9.95 mm, plane strain, no friction; stiffness at 1000 N/mm. Stresses of "
    "the ring under the pressure of the series, in harmonics, away from the ends of a clamp, which "
    "are singular. The joint is our choice, yield stresses are assumed. Material values that are "
    "not the paper's: {origins}."
)
# Degrees from the load, from where first yield is beside the contact.
_BESIDE = 10.0


def draw(bench: Bench) -> Drawing:
    pair = joint(bench)
    plate, plain = yield_load(pair), Conformal()
    stiffness = plain.stiffness(plain.penetration(LOAD, pair), pair)
    table = pd.DataFrame({"ratio": RATIOS})
    headline = {"first yield of the plate, N/mm": float(plate)}
    for name, (words, clamp) in CLAMPS.items():
        rows = []
        for ratio in RATIOS:
            law = Conformal(Housing(R_I * ratio, clamp=clamp))
            own = law.stiffness(law.penetration(LOAD, pair), pair)
            first = first_yield(pair, housing=Housing(R_I * ratio, clamp=clamp))
            rows.append(tuple(map(float, (own / stiffness, first.load / plate, first.angle))))
            if ratio in NAMED:
                where = f"{words}, R_o/R_i = {ratio:g}"
                headline[f"{where}: stiffness ratio"] = rows[-1][0]
                headline[f"{where}: first yield, N/mm"] = float(first.load)
                headline[f"{where}: degrees from the load"] = rows[-1][2]
        for what, values in zip(
            ("stiffness_ratio", "yield_ratio", "angle_deg"), zip(*rows, strict=True), strict=True
        ):
            table[f"{name}_{what}"] = values
    method = METHOD.format(origins=origins_of(bench, [(PIN, HOLE)]))
    return Drawing(_draw(table), table, headline, CAPTION, method)


def _draw(table: pd.DataFrame) -> Figure:
    """Draw both ratios over the housing, a line per clamp."""
    figure = new_figure("full", 80.0)
    panels = figure.subplots(1, 2).flat
    labels = {"stiffness_ratio": "stiffness ratio (-)", "yield_ratio": "yield load ratio (-)"}
    for number, (axes, (what, label)) in enumerate(zip(panels, labels.items(), strict=True)):
        for k, (name, (words, _)) in enumerate(CLAMPS.items()):
            line = {"color": COLOURS[k], "linestyle": "-"}
            axes.plot(*smooth(table[f"{name}_{what}"]), marker="", label=words, **line)
            if what == "yield_ratio":
                beside = table[table[f"{name}_angle_deg"] > _BESIDE]
                line |= {"linestyle": "", "marker": "o", "markerfacecolor": "none"}
                axes.plot(beside["ratio"], beside[f"{name}_{what}"], **line)
        axes.axhline(1, color=QUIET, linestyle=":", marker="", zorder=1)
        axes.set(xscale="log", yscale="log", xlim=(1.25, 20.8), xlabel=r"housing $R_o/R_i$ (-)")
        plain_log(axes, "x", (1.3, 2, 3, 5, 10, 20))
        plain_log(axes, "y", (0.1, 0.2, 0.5, 1.0, 2.0))
        axes.set_ylabel(label)
        panel_title(axes, number, "stiffness" if number == 0 else "first yield")
    legend_below(axes, 5, title="clamped")
    return figure
