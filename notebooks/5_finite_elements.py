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
# A pin in a hole, solved by finite elements in the plane: what the solution shows about the laws,
# and what it cannot show. Two-dimensional bodies have no absolute approach: the penetration has an
# additive constant that depends on the plate's outer radius and on the way the load acts. Here the
# outer radius is **fitted** to Johnson's law outside the conformal range
# (`outer_ratio_like_johnson`), so that their agreement there is partly by construction. The
# dependence of the penetration on load and clearance is then computed, not tuned.

# %%
import numpy as np
import pandas as pd

from cylcontact import CylinderPair, Material, laws, limits
from cylcontact.datasets.finite_element import Setup, read_table, solve
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import COLOURS, MARKERS, figure_style
from cylcontact.reports.notebook import open_bench

bench = open_bench()
steel = Material("steel", E=207e3, nu=0.3)
R_i = 2.245  # mm, the hole's radius, the paper's

# %% [markdown]
# ## Solve one clearance
#
# Half of the plane problem, structured quads graded towards the contact, no friction. One
# factorisation serves all loads of a clearance. The mesh is coarse here; the tables' is finer.

# %%
setup = Setup(hole_radius=R_i, outer_ratio=3.3, E=207e3, nu=0.3, cells=12)
dR, loads = 0.05, [20.0, 100.0, 400.0]
solutions = solve(setup, dR, loads)
pair = CylinderPair.from_dR("internal", dR, steel, R_i=R_i)
pd.DataFrame(
    {
        "load (N/mm)": loads,
        "finite elements (µm)": [1e3 * s.penetration for s in solutions],
        "Johnson (µm)": 1e3 * laws.Johnson().penetration(loads, pair),
        "Persson (µm)": 1e3 * laws.Persson().penetration(loads, pair),
        "half-width (mm)": [s.half_width for s in solutions],
        "Hertz (mm)": limits.hertz_half_width(loads, pair),
    }
).round(4)

# %% [markdown]
# ## Pressure
#
# The pressure does not depend on that constant. Hertz's ellipse fits while the contact is narrow;
# at the largest load the contact conforms and Hertz's pressure is off.


# %%
def pressures():
    """Draw the contact pressure of every load beside Hertz's."""
    rows = []
    with figure_style():
        figure = new_figure("middle", 74.0)
        axes = figure.subplots()
        looks = zip(solutions, COLOURS, MARKERS, strict=False)
        for solution, colour, marker in looks:
            near = solution.arc < 1.3 * solution.half_width
            arc, pressure = solution.arc[near], solution.pressure[near]
            style = {"color": colour, "linestyle": "", "marker": marker, "markersize": 2.5}
            axes.plot(arc, pressure, label=f"{solution.load:g} N/mm", **style)
            fine = np.linspace(0.0, arc[-1], 401)
            hertz = limits.hertz_pressure(fine, solution.load, pair)
            axes.plot(fine, hertz, "-", color=colour, marker="", linewidth=0.8)
            rows.append(pd.DataFrame({"load": solution.load, "arc_mm": arc, "MPa": pressure}))
        axes.set(xlabel="distance from the middle (mm)", ylabel="pressure (MPa)")
        axes.legend(title="points: finite elements, lines: Hertz")
    away = {
        f"peak over Hertz's at {s.load:g} N/mm": float(
            s.peak_pressure / limits.hertz_stress(s.load, pair)
        )
        for s in solutions
    }
    return Drawing(figure, pd.concat(rows), away, "Contact pressure at 0.05 mm clearance.")


drawn = pressures()
drawn

# %%
pd.Series(drawn.headline).round(3).to_frame("ratio")

# %% [markdown]
# ## The laws over clearance
#
# The committed table, made by `cylcontact finite-element datasets/finite_element/recommended.toml`,
# and the laws' differences from it.

# %%
table = read_table(bench.root / "datasets" / "finite_element" / "recommended-embedded.csv")
for key, value in table.header.items():
    print(f"{key}: {value}")

# %%
rows = table.rows
pairs = CylinderPair.from_dR("internal", rows["dR_mm"].to_numpy(), steel, R_i=R_i)
compared = rows[["dR_mm", "load_N_per_mm"]].copy()
for law in (laws.Johnson(), laws.Persson(), laws.Enhanced()):
    delta = law.penetration(rows["load_N_per_mm"].to_numpy(), pairs)
    compared[law.name] = 100 * (delta / rows["penetration_mm"].to_numpy() - 1)
difference = compared.pivot_table(
    index="dR_mm", columns="load_N_per_mm", values=["johnson", "persson", "enhanced"]
)
difference.round(2)

# %% [markdown]
# In percent of the finite elements' penetration. Johnson's law is low where the contact conforms,
# at small clearances and large loads, and Persson's solution follows the finite elements there. The
# enhanced law is high or low by more than both.

# %%
np.abs(difference).max().unstack().round(2)
