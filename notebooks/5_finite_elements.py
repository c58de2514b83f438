# ---
# jupyter:
#   jupytext:
#     formats: ipynb,py:percent
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: cylcontact
#     language: python
#     name: cylcontact
# ---

# %% [markdown]
# # Finite elements
#
# You get the contact of a pin in a hole by finite elements, and you see what the solution shows
# about the laws, and what it cannot show.
#
# Two-dimensional bodies have no absolute approach. The penetration has an additive constant, which
# depends on the plate's outer radius and on the way the load acts. Here the outer radius is
# **fitted** to Johnson's law outside the conformal range (`outer_ratio_like_johnson`). The
# agreement there is therefore partly by construction. The dependence of the penetration on load and
# clearance is then computed, not tuned.

# %%
import pandas as pd

import cylcontact as cc

steel = cc.Material("steel", E=207e3, nu=0.3)
R_i = 2.245  # mm, the hole's radius, the paper's

# %% [markdown]
# ## Solve one clearance
#
# The model is half of the plane problem, without friction. Its quadrilaterals are smaller towards
# the contact. One factorisation serves all loads of a clearance. The mesh is coarse here. That of
# the tables is finer.

# %%
setup = cc.datasets.finite_element.Setup(
    hole_radius=R_i, outer_ratio=3.3, E=207e3, nu=0.3, cells=12
)
dR, loads = 0.05, [20.0, 100.0, 400.0]
solutions = cc.datasets.finite_element.solve(setup, dR, loads)
pair = cc.CylinderPair.from_dR("internal", dR, steel, R_i=R_i)
pd.DataFrame(
    {
        "load (N/mm)": loads,
        "finite elements (µm)": [1e3 * s.penetration for s in solutions],
        "Johnson (µm)": 1e3 * cc.laws.Johnson().penetration(loads, pair),
        "Persson (µm)": 1e3 * cc.laws.Persson().penetration(loads, pair),
        "half-width (mm)": [s.half_width for s in solutions],
        "Hertz (mm)": cc.limits.hertz_half_width(loads, pair),
    }
).round(4)

# %% [markdown]
# ## Pressure
#
# The pressure does not depend on that constant. Hertz's ellipse fits while the contact is narrow.
# At the largest load the contact conforms. Hertz's pressure is then too low in the middle, and
# reaches too far.

# %%
with cc.plots.figure_style():
    figure = cc.plots.new_figure("middle", 80.0)
    axes = figure.subplots()
    for number, s in enumerate(solutions):
        near = s.arc < 1.3 * s.half_width
        arc, colour = s.arc[near], f"C{number}"
        label = f"{s.load:g} N/mm"
        axes.plot(arc, s.pressure[near], ".", color=colour, markersize=5, label=label)
        fine = [arc[-1] * k / 200 for k in range(201)]
        hertz = cc.limits.hertz_pressure(fine, s.load, pair)
        axes.plot(fine, hertz, "-", color=colour, marker="")
    axes.set(xlabel="distance from the middle (mm)", ylabel="pressure (MPa)")
    axes.set_title("points: finite elements, lines: Hertz")
    figure.legend(loc="outside lower center", ncols=3)
figure

# %%
pd.Series(
    {s.load: s.peak_pressure / cc.limits.hertz_stress(s.load, pair) for s in solutions},
    name="peak over Hertz's",
).rename_axis("load (N/mm)").astype(float).round(3).to_frame()

# %% [markdown]
# ## The laws over clearance
#
# This is the committed table, made by
# `cylcontact finite-element datasets/finite_element/recommended.toml`.

# %%
table = cc.datasets.finite_element.read_table("../datasets/finite_element/recommended-embedded.csv")
for key, value in table.header.items():
    print(f"{key}: {value}")

# %% [markdown]
# The differences of the laws are in percent of the finite elements' penetration. Johnson's law is
# low where the contact conforms, at small clearances and large loads. Persson's solution follows
# the finite elements there. The enhanced law is high or low by more than both.

# %%
rows = table.rows
pairs = cc.CylinderPair.from_dR("internal", rows["dR_mm"], steel, R_i=R_i)
compared = rows[["dR_mm", "load_N_per_mm"]].copy()
for law in (cc.laws.Johnson(), cc.laws.Persson(), cc.laws.Enhanced()):
    delta = law.penetration(rows["load_N_per_mm"], pairs)
    compared[law.name] = 100 * (delta / rows["penetration_mm"] - 1)
difference = compared.pivot_table(
    index="dR_mm", columns="load_N_per_mm", values=["johnson", "persson", "enhanced"]
)
difference.abs().max().unstack().round(2)

# %%
with cc.plots.figure_style():
    figure = cc.plots.new_figure("full", 75.0)
    panels = figure.subplots(1, 3, sharey=True)
    for axes, name in zip(panels, ("johnson", "persson", "enhanced"), strict=True):
        for load, column in difference[name].items():
            label = f"{load:g} N/mm" if name == "johnson" else None
            axes.semilogx(column.index, column, label=label)
        axes.axhline(0.0, color="0.5", linewidth=0.6, linestyle="-", marker="")
        axes.set(title=name, xlabel="radial clearance ΔR (mm)")
    panels[0].set_ylabel("difference from finite elements (%)")
    figure.legend(loc="outside lower center", ncols=3)
figure
