"""Draw the sketches of the pages into docs/pictures: python docs/pictures.py [NAME...]."""

import sys
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Polygon, Rectangle

import cylcontact as cc
from cylcontact.fitting import Campaign, calibrate, read_result

FOLDER = Path(__file__).parent / "pictures"
HOLE, PIN, RED, EDGE = "0.86", "#cfe4f2", "#b3261e", {"edgecolor": "black", "linewidth": 0.8}
SIZE = 8.0  # inches: the width of a page of text


def panels(count, height=3.0, limit=2.4):
    """Return a figure and axes for sketches."""
    figure, axes = plt.subplots(1, count, figsize=(SIZE, height), layout="constrained")
    for panel in np.atleast_1d(axes):
        panel.set(xlim=(-limit, limit), ylim=(-limit, limit), aspect="equal")
        panel.axis("off")
    return figure, axes


def arrow(axes, start, end, color="black", style="-|>"):
    axes.add_patch(
        FancyArrowPatch(
            start, end, arrowstyle=style, color=color, mutation_scale=11, shrinkA=0, shrinkB=0
        )
    )


def label(axes, text, at, point=None, **options):
    """Write a text, with a thin line to what it names."""
    line = None if point is None else {"arrowstyle": "-", "linewidth": 0.7, "shrinkB": 0}
    middle = {"ha": "center", "va": "center"} | options
    axes.annotate(text, at if point is None else point, at, arrowprops=line, **middle)


def pair():
    """A pin in a hole without and with load, and two rollers."""
    figure, (free, loaded, rollers) = panels(3, 3.1)
    for axes, down in ((free, 0.0), (loaded, 0.42)):
        axes.add_patch(Rectangle((-2, -2), 4, 4, facecolor=HOLE, **EDGE))
        axes.add_patch(Circle((0, 0), 1.5, facecolor="white", **EDGE))
        axes.add_patch(Circle((0, -down), 1.2, facecolor=PIN, **EDGE))
    for radius, name, angle in ((1.5, "$R_i$", 0.35), (1.2, "$R_j$", 2.6)):
        end = radius * np.cos(angle), radius * np.sin(angle)
        arrow(free, (0, 0), end)
        label(free, name, (0.55 * end[0], 0.55 * end[1] + 0.25))
    label(free, "clearance $ΔR = R_i − R_j$", (0, -1.8), (0, -1.35))
    arrow(loaded, (0, 0.6), (0, -0.4), RED)
    label(loaded, "load $f$", (0.45, -0.7), color=RED)
    loaded.plot([0, 1.9], [0, 0], "k:", linewidth=0.8)
    loaded.plot([0, 1.9], [-0.42, -0.42], "k:", linewidth=0.8)
    arrow(loaded, (1.8, 0), (1.8, -0.42), style="<|-|>")
    label(loaded, "$ΔR + δ$", (2.15, 0.9), (1.8, -0.1))
    label(loaded, "the pin's centre moves by the\nclearance and the penetration $δ$", (0, -2.35))
    for x, radius, colour, name in ((-0.75, 1.3, HOLE, "$R_i$"), (1.35, 0.9, PIN, "$R_j$")):
        rollers.add_patch(Circle((x, 0), radius, facecolor=colour, **EDGE))
        arrow(rollers, (x, 0), (x, radius))
        label(rollers, name, (x + 0.3, radius / 2))
    arrow(rollers, (-2.7, 0), (-1.5, 0), RED)
    arrow(rollers, (2.9, 0), (1.8, 0), RED)
    label(rollers, "rollers: $ΔR = R_i + R_j$", (0, -1.8))
    for axes, title in zip((free, loaded, rollers), ("no load", "loaded", "external"), strict=True):
        axes.set_title(title)
    rollers.set_xlim(-2.9, 2.9)
    return figure


def eye(axes, half, sign, outer=1.9):
    """Draw a housing on a shank, sign -1 below and 1 above it, with its clamped rim; the pin."""
    width = outer * np.sin(np.radians(half))
    low = sign * outer * np.cos(np.radians(half))
    if half < 180:
        axes.add_patch(Rectangle((-width, low), 2 * width, sign * 1.2, facecolor=HOLE, **EDGE))
    axes.add_patch(Circle((0, 0), outer, facecolor=HOLE, **EDGE))
    axes.add_patch(Circle((0, 0), 1.0, facecolor="white", **EDGE))
    axes.add_patch(Circle((0, 0.1), 0.9, facecolor=PIN, **EDGE))
    middle = 90 * sign
    angles = {"theta1": middle - half, "theta2": middle + half}
    axes.add_patch(Arc((0, 0), 2 * outer, 2 * outer, **angles, linewidth=4))
    arrow(axes, (0, -0.5), (0, 0.75), RED)


def housing():
    """The words for a housing: rim, eye, shank, sector."""
    figure, axes = panels(4, 2.9, 2.9)
    ring, pushed, pulled, lug = axes
    eye(ring, 180, 1)
    ring.add_patch(Circle((0, 0), 2.5, facecolor="none", hatch="///", edgecolor="0.7", zorder=0))
    label(ring, "rim, clamped\nall round", (-0.9, -3.2), (-0.7, -1.77))
    label(ring, "frame", (1.7, 2.3), (1.2, 1.95))
    arrow(ring, (0, 0), (1.35, -1.35))
    label(ring, "$R_o$", (0.75, -1.15))
    eye(pushed, 30, 1)
    label(pushed, "shank", (1.7, 2.3), (0.8, 2.3))
    label(pushed, "load", (1.6, -2.4), (0, -0.3), color=RED)
    eye(pulled, 30, -1)
    label(pulled, "eye", (1.7, 1.9), (1.2, 1.2))
    label(pulled, "shank", (1.7, -2.4), (0.8, -2.4))
    for angle in (-60, -120):
        end = np.radians(angle)
        pulled.plot([0, 1.9 * np.cos(end)], [0, 1.9 * np.sin(end)], "k:", linewidth=0.8)
    label(pulled, "60°", (0, -1.35))
    eye(lug, 55, -1)
    lug.patches[0].remove()
    lug.add_patch(Rectangle((-1.9, -2.8), 3.8, 2.8, facecolor=HOLE, zorder=0, **EDGE))
    label(lug, "lug: the shank is\nas wide as the eye", (0, -3.35))
    titles = ("--clamp rim", "--clamp pushed:60", "--clamp pulled:60", "--clamp lug")
    words = ("a ring in a frame", "an eye, pushed", "an eye, pulled", "a lug, pulled")
    for panel, title, text in zip(axes, titles, words, strict=True):
        panel.set_title(f"{text}\n{title}", fontsize=10)
        panel.set_ylim(-3.8, 2.7)
    return figure


def datum():
    """The same joint with penetrations from three reference points."""
    figure, (sketch, curve) = plt.subplots(
        1, 2, figsize=(SIZE, 3.2), layout="constrained", width_ratios=(2, 3)
    )
    sketch.set(xlim=(-2.6, 3.4), ylim=(-3.3, 2.6), aspect="equal")
    sketch.axis("off")
    eye(sketch, 30, -1)
    sketch.plot(0, 0.1, "k.", markersize=7)
    label(sketch, "pin's centre", (2.6, 1.9), (0.03, 0.13))
    sketch.plot(0, -1.9, "k.", markersize=7)
    label(sketch, "clamped rim", (2.6, -2.5), (0.05, -1.93))
    sketch.plot([0, -2.3], [0.1, 0.1], "k:", linewidth=0.8)
    sketch.plot([0, -2.3], [-1.9, -1.9], "k:", linewidth=0.8)
    arrow(sketch, (-2.2, 0.1), (-2.2, -1.9), style="<|-|>")
    sketch.set_title("penetration: how far these two move\napart, less the clearance", fontsize=10)
    steel, bronze = cc.Material.named("high-strength steel"), cc.Material.named("bronze")
    joint = cc.CylinderPair.internal(R_i=10.0, R_j=9.95, pin=steel, hole=bronze)
    pulled = cc.laws.Sector(60, "pulled")
    datums = {
        "rim of an eye, R_o = 20 mm, pulled": cc.laws.Housing(20.0, pulled),
        "rim of a plate, R_o = 100 mm": cc.laws.Housing(100.0),
        "Johnson's convention": "johnson",
        "rim of a ring, R_o = 20 mm": cc.laws.Housing(20.0),
    }
    load = np.linspace(0, 1000, 101)[1:]
    for name, place in datums.items():
        curve.plot(load, 1e3 * cc.laws.Conformal(place).penetration(load, joint), label=name)
    curve.set(xlabel="load (N/mm)", ylabel="penetration (µm)", title="one pin, four datums")
    curve.legend(fontsize=9)
    return figure


def tilt():
    """A pin that tilts in its bush, from the side."""
    figure, axes = panels(1, 3.4)
    axes.set(xlim=(-4.6, 4.6), ylim=(-2.0, 2.2))
    for low in (-1.5, 0.75):
        axes.add_patch(Rectangle((-2.5, low), 5, 0.75, facecolor=HOLE, **EDGE))
    lean = np.radians(6)
    turn = np.array([[np.cos(lean), -np.sin(lean)], [np.sin(lean), np.cos(lean)]])
    for x, y in ((3.6, 0.46), (0.22, 1.0)):
        corners = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
        if x < 1:
            corners += [3.1, 0]
        axes.add_patch(Polygon(corners @ turn.T, facecolor=PIN, **EDGE))
    axes.plot([-4, 4], [0, 0], "k-.", linewidth=0.6)
    ends = turn @ np.array([[-4, 4], [0, 0]])
    axes.plot(*ends, "k-.", linewidth=0.6)
    label(axes, "tilt", (-4.2, -0.22))
    label(axes, "rim B of the hole", (-3.6, -1.7), (-2.5, -0.75))
    label(axes, "rim A of the hole", (0.6, 1.9), (2.5, 0.75))
    label(axes, "thrust face A", (3.7, -1.75), (2.5, -1.2))
    label(axes, "axial play", (2.5, 2.0), (2.61, 1.05))
    label(axes, "bush", (0, -1.15))
    label(axes, "pin", (0, 0.25))
    label(axes, "collar of the pin", (4.1, 1.6), (3.1, 1.1))
    return figure


def choice():
    """Which law for which contact."""
    figure, axes = panels(1, 3.6)
    axes.set(xlim=(0, 10), ylim=(0, 4.4), aspect="auto")
    boxes = {
        "contact?": (1.1, 2.3, "white"),
        "pin in a hole": (3.3, 3.3, HOLE),
        "rollers, or a\nroller on a plane": (3.3, 0.9, HOLE),
        "you know the housing,\nor two materials": (6.2, 3.9, HOLE),
        "one material, large plate": (6.2, 2.85, HOLE),
        "your code takes\nonly K·δⁿ": (6.2, 1.8, HOLE),
        "conformal": (9.0, 3.9, PIN),
        "explicit": (9.0, 2.85, PIN),
        "power-clearance": (9.0, 1.8, PIN),
        "johnson": (9.0, 0.7, PIN),
    }
    for text, (x, y, colour) in boxes.items():
        box = {"boxstyle": "round,pad=0.35", "facecolor": colour, "linewidth": 0.8}
        family = "monospace" if colour == PIN else None
        axes.text(x, y, text, ha="center", va="center", bbox=box, family=family, fontsize=10)
    lines = [
        ((1.75, 2.4), (2.4, 3.2)), ((1.75, 2.2), (2.1, 1.1)), ((4.2, 3.4), (4.6, 3.8)),
        ((4.2, 3.2), (4.75, 2.95)), ((4.0, 3.0), (5.2, 2.1)), ((7.75, 3.9), (8.25, 3.9)),
        ((7.7, 2.85), (8.35, 2.85)), ((7.1, 1.8), (7.95, 1.8)), ((4.5, 1.1), (5.25, 1.5)),
        ((4.5, 0.75), (8.35, 0.7)),
    ]  # fmt: skip
    for start, end in lines:
        arrow(axes, start, end)
    return figure


def reading_a_map():
    """A map of two laws, and how to read it."""
    figure, axes = plt.subplots(figsize=(SIZE, 4.4), layout="constrained")
    gunmetal = cc.Material("gunmetal", E=110e3, nu=0.34, yield_stress=220)
    cc.plots.plot_map(cc.laws.Enhanced(), cc.laws.Persson(), gunmetal, load=(10, 5000), ax=axes)
    notes = {
        "1  your joint: ΔR = 0.05 mm, 300 N/mm": ((0.05, 300), (0.011, 29)),
        "2  its colour: the difference\n    of the two laws, in percent": (
            None,
            (0.011, 14),
        ),
        "3  above this line the joint yields": ((0.3, 1800), (0.12, 20)),
    }
    for text, (point, at) in notes.items():
        arrows = None if point is None else {"arrowstyle": "->", "linewidth": 1.1}
        box = {"boxstyle": "round,pad=0.25", "facecolor": "white", "linewidth": 0.6}
        axes.annotate(text, point or at, at, arrowprops=arrows, bbox=box, fontsize=9)
    axes.plot(0.05, 300, "o", color=RED, markersize=8)
    return figure


def slider_crank():
    """The slider-crank with the clearance enlarged."""
    figure, axes = panels(1, 2.9)
    axes.set(xlim=(-1.6, 8.2), ylim=(-1.3, 2.5))
    pivot, crank_pin, slider = np.array([0, 0]), np.array([0.75, 1.0]), np.array([4.6, 0.0])
    axes.plot([-1.4, 7.9], [-0.55, -0.55], color="0.5", linewidth=0.8)
    axes.add_patch(Rectangle((3.9, -0.52), 1.4, 1.04, facecolor=HOLE, **EDGE))
    for start, end in ((pivot, crank_pin), (crank_pin, slider)):
        axes.plot(*zip(start, end, strict=True), color="#0072b2", linewidth=5, zorder=2)
        axes.plot(*start, "o", color="white", markeredgecolor="black", zorder=3)
    axes.add_patch(Circle(slider, 0.2, facecolor="white", zorder=3, **EDGE))
    axes.add_patch(Circle(slider, 0.14, facecolor=PIN, zorder=4, **EDGE))
    centre = np.array([7.0, 0.85])
    pin_at = centre + np.array([0.12, -0.09])
    axes.add_patch(Circle(centre, 1.05, facecolor=HOLE, **EDGE))
    axes.add_patch(Circle(centre, 0.8, facecolor="white", **EDGE))
    axes.add_patch(Circle(pin_at, 0.66, facecolor=PIN, **EDGE))
    axes.plot([slider[0] + 0.1, centre[0] - 0.6], [0.15, 1.5], "k:", linewidth=0.8)
    axes.plot([slider[0] + 0.1, centre[0] - 0.6], [-0.15, -0.05], "k:", linewidth=0.8)
    arrow(axes, pin_at, centre, RED)
    label(axes, "eccentricity", (7.0, 2.25), centre, color=RED)
    label(axes, "crank", (-0.3, 0.75))
    label(axes, "rod", (2.7, 0.85))
    label(axes, "slider", (4.6, -0.95))
    label(axes, "bearing of the rod and\npin of the slider, enlarged", (6.9, -0.95))
    axes.plot(*pivot, "o", color="white", markeredgecolor="black", zorder=3)
    axes.add_patch(Arc(pivot, 0.9, 0.9, theta1=70, theta2=200))
    return figure


def one_curve():
    """Johnson's law of four pairs, in mm and N/mm and in dimensionless numbers."""
    figure, (many, one) = plt.subplots(1, 2, figsize=(SIZE, 3.2), layout="constrained")
    steel, bronze = cc.Material.named("high-strength steel"), cc.Material.named("bronze")
    exact, johnson = cc.laws.Persson(), cc.laws.Johnson()
    phi = np.geomspace(1e-4, 10, 200)
    for material in (steel, bronze):
        for dR in (0.02, 0.2):
            body = cc.CylinderPair.from_dR("internal", dR, material)
            load = phi * body.E_star * dR
            name = f"{material.name}, ΔR = {dR:g} mm"
            for axes, x, y in ((many, load, 1e3), (one, phi, 1 / dR)):
                axes.loglog(x, y * exact.penetration(load, body), label=name)
                axes.loglog(x, y * johnson.penetration(load, body), "k:", linewidth=1)
    many.set(xlabel="load (N/mm)", ylabel="penetration (µm)", title="four pairs")
    many.set(xlim=(1, 1e4), ylim=(0.01, 300))
    one.set(xlabel="φ = f/(E*·ΔR)", ylabel="d = δ/ΔR", title="the same, dimensionless")
    many.legend(fontsize=8)
    one.text(2e-4, 1, "lines: Persson's law\ndotted: Johnson's law", fontsize=9)
    return figure


def geometry():
    """The arc of contact with its pressure, and the pressure of three loads beside Hertz's."""
    figure, (sketch, plot) = plt.subplots(
        1, 2, figsize=(SIZE, 3.3), layout="constrained", width_ratios=(1, 1.25)
    )
    half, R, down = 50.0, 1.6, 0.3
    sketch.set(xlim=(-2.5, 2.5), ylim=(-2.75, 2.25), aspect="equal")
    sketch.axis("off")
    sketch.add_patch(Rectangle((-2.4, -2.7), 4.8, 4.8, facecolor=HOLE, **EDGE))
    sketch.add_patch(Circle((0, 0), R, facecolor="white", **EDGE))
    sketch.add_patch(Circle((0, -down), R - down, facecolor=PIN, **EDGE))
    angle = np.radians(np.linspace(-half, half, 61))
    rise = 0.75 * np.sqrt(1 - (np.degrees(angle) / half) ** 2)
    around = np.array([np.sin(angle), -np.cos(angle)])
    edge = np.hstack([R * around, ((R + rise) * around)[:, ::-1]])
    sketch.add_patch(Polygon(edge.T, facecolor=RED, alpha=0.25))
    sketch.plot(*((R + rise) * around), color=RED, linewidth=1.2)
    label(sketch, "$p(θ)$", (0.55, -2.45), color=RED)
    arrow(sketch, (0, 1.0), (0, 0.1), RED)
    label(sketch, "load $f$", (0.55, 0.75), color=RED)
    for side in (-half, 0, half):
        tip = R * np.sin(np.radians(side)), -R * np.cos(np.radians(side))
        sketch.plot([0, tip[0]], [0, tip[1]], "k:", linewidth=0.9)
    sketch.add_patch(Arc((0, 0), 1.3, 1.3, theta1=-90, theta2=-90 + half))
    label(sketch, "$ε$", (0.32, -0.8))
    label(sketch, "pin ($j$)", (-0.7, 0.2))
    label(sketch, "hole ($i$)", (-1.7, 1.8))
    sketch.set_title("contact from $−ε$ to $ε$", fontsize=10)
    steel = cc.Material("steel", E=200e3, nu=0.3)
    joint = cc.CylinderPair.internal(R_i=10.0, R_j=9.95, material=steel)
    for load, colour in ((300, "C0"), (2000, "C1"), (9000, "C2")):
        end = float(cc.laws.Conformal().contact_angle(load, joint))
        theta = np.linspace(-end, end, 401)
        of_law = cc.laws.conformal.pressure(np.radians(theta), load, joint)
        plot.plot(theta, of_law, color=colour, label=f"{load:,} N/mm")
        width = float(cc.limits.hertz_half_width(load, joint))
        peak = 2 * load / (np.pi * width)
        place = np.linspace(-width, width, 401)
        flat = np.degrees(place / 10.0)
        plot.plot(flat, peak * np.sqrt(1 - (place / width) ** 2), ":", color=colour)
    plot.set(xlabel="θ (degrees)", ylabel="pressure (MPa)", title="lines: Persson, dotted: Hertz")
    plot.title.set_fontsize(10)
    plot.legend(fontsize=9)
    return figure


def one_clearance():
    """Johnson's penetrations at three clearances with the best line of each, and a 1 % interval."""
    figure, (lines, valley) = plt.subplots(1, 2, figsize=(SIZE, 3.2), layout="constrained")
    load = np.geomspace(10, 1000, 12)
    for dR, colour in ((0.05, "C0"), (0.5, "C1"), (5.0, "C2")):
        s, j = [], []
        for E in np.geomspace(20.7e3, 1000e3, 6):
            body = cc.CylinderPair.from_dR("internal", dR, cc.Material("sampled", E, 0.3))
            s.append(np.log(load / body.E_star))
            j.append(np.log(cc.laws.Johnson().penetration(load, body)))
        s, j = np.concatenate(s), np.concatenate(j)
        s, j = s[np.isfinite(j)], j[np.isfinite(j)]
        slope, middle = np.polyfit(s, j, 1)
        lines.plot(s, j, ".", color=colour, markersize=3)
        ends = np.array([s.min(), s.max()])
        lines.plot(ends, slope * ends + middle, color=colour, label=f"ΔR = {dR:g} mm")
    lines.set(xlabel="s = ln(f/E*)", ylabel="j = ln δ (Johnson)", title="best line at each ΔR")
    lines.legend(fontsize=8)
    fitting = Path(__file__).parents[1] / "fitting"
    result = read_result(fitting / "results/external-E1000.json")
    n, least = result.estimates["n"], result.objective.value
    values = np.linspace(n.value - 0.008, n.value + 0.008, 17)
    refitted = [
        calibrate(Campaign.read(fitting / "external-E1000.toml", runs=1, fixed={"n": value}))
        for value in values
    ]
    valley.plot(values, [each.objective.value / least for each in refitted])
    valley.axhline(1.01, color="0.5", linestyle=":")
    valley.axvspan(n.low, n.high, alpha=0.2)
    valley.plot(n.value, 1.0, "ko")
    valley.set(
        xlabel="n of the rollers",
        ylabel="objective / optimum",
        title="others refitted: 1 % interval",
    )
    return figure


def what_limits():
    """Errors of the enhanced law, published and refitted, and the bound of its form."""
    names = "internal", "internal-E1000", "practical", "conformal", "external", "external-E1000"
    folder = Path(__file__).parents[1] / "fitting/results"
    results = [read_result(folder / f"{name}.json") for name in names]
    bars = {
        "published coefficients": [result.published.objective for result in results],
        "fitted": [result.objective.value for result in results],
        "lower bound of this form": [result.bound for result in results],
    }
    figure, axes = plt.subplots(figsize=(SIZE, 3.0), layout="constrained")
    for k, (name, heights) in enumerate(bars.items()):
        axes.bar(np.arange(len(names)) + 0.27 * (k - 1), heights, 0.25, label=name)
    axes.set_xticks(range(len(names)), names)
    axes.set(ylabel="error, rms of ln(δ/δ_reference)")
    axes.legend()
    return figure


def coverage():
    """How often 95 % intervals contain the true offset, with the right options and without."""
    rows = pd.read_csv(Path(__file__).parents[1] / "datasets/coverage.csv", keep_default_na=False)
    rows = rows[rows["parameter"] == "offset"]
    kinds = list(dict.fromkeys(rows["kind"]))
    right = ~rows["kind"].duplicated()
    figure, axes = plt.subplots(figsize=(SIZE, 3.0), layout="constrained")
    for part, mark, name in ((rows[right], "o", "options that describe the errors"),
                             (rows[~right], "x", "one of them left out")):  # fmt: skip
        axes.plot(part["coverage_percent"], part["kind"].map(kinds.index), mark, label=name)
    axes.axvspan(90, 99, alpha=0.2)
    axes.set_yticks(range(len(kinds)), kinds)
    axes.invert_yaxis()
    axes.set(xlabel="95 % intervals that contain the true offset (%)", xlim=(0, 101))
    axes.legend(loc="upper left")
    return figure


PICTURES = {
    function.__name__: function
    for function in (
        pair, housing, datum, tilt, choice, reading_a_map, slider_crank, one_curve, geometry,
        one_clearance, what_limits, coverage,
    )
}  # fmt: skip

if __name__ == "__main__":
    mpl.use("agg")
    FOLDER.mkdir(exist_ok=True)
    for name in sys.argv[1:] or PICTURES:
        figure = PICTURES[name]()
        figure.savefig(FOLDER / f"{name}.png", dpi=110)
        plt.close(figure)
