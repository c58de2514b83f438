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
# # Quick start
#
# A pin in a hole: how deep is the penetration under a load, how stiff is the contact, and up to
# which load are the answers valid? Five minutes, no files to write.
#
# Lengths are in mm, forces in N, stresses in MPa; a load is per unit of axial length, in N/mm.

# %%
import numpy as np
import pandas as pd

import cylcontact as cc
from cylcontact.reports import build, laws_table
from cylcontact.reports.notebook import open_bench

bench = open_bench()

# %% [markdown]
# ## The law in ten lines

# %%
steel = cc.Material("steel", E=200e3, nu=0.3, yield_stress=250)
pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.95, material=steel, length=10.0)
law = cc.laws.Explicit()
delta = law.penetration(100.0, pair)
print(f"penetration  {1e3 * delta:.3f} µm")
print(f"load         {law.load(delta, pair):.3f} N/mm")
print(f"stiffness    {law.stiffness(delta, pair):.0f} N/mm²")

# %% [markdown]
# Materials, pairs and laws display their values.

# %%
pair

# %%
cc.laws.Enhanced()

# %% [markdown]
# All functions take arrays and broadcast: here five loads and three clearances. Outside its domain
# a law returns NaN. Johnson's law ends inside this table.

# %%
loads = np.array([10.0, 100.0, 300.0, 1000.0, 3000.0])
clearances = np.array([0.005, 0.05, 0.5])
pairs = cc.CylinderPair.from_dR("internal", clearances[:, None], steel, R_i=10.0)
pd.DataFrame(
    1e3 * cc.laws.Johnson().penetration(loads, pairs),
    index=pd.Index(clearances, name="ΔR (mm)"),
    columns=pd.Index(loads, name="δ (µm) at f (N/mm)"),
).round(3)

# %% [markdown]
# ## Limits
#
# Two loads limit an elastic law: the one at which either body first yields, by von Mises, and the
# one at which Johnson's law ends. The yield stress here is our assumption.

# %%
pd.DataFrame(
    {
        "first yield (N/mm)": cc.limits.yield_load(pairs).ravel(),
        "Johnson's largest load (N/mm)": cc.limits.johnson_limit_load(pairs).ravel(),
    },
    index=pd.Index(clearances, name="ΔR (mm)"),
).round(1)

# %% [markdown]
# Johnson's largest load is the end of its algebra, not of its accuracy. Well before it, the
# penetration is too small against Persson's solution for conformal contact. The table has the loads
# (N/mm, for a pin and a hole of this steel, by clearance in mm) for given percentages.

# %%
laws_table.departures(steel).round(1)

# %% [markdown]
# ## Which law when
#
# All laws at the same load, and their penetration against Persson's in percent over the whole
# range of the load number φ = f/(E*·ΔR). `explicit` follows conformal contact everywhere,
# without iteration; `docs/laws.md` has the full chooser.

# %%
laws_table.comparison(pair, 100.0).set_index("law")

# %%
laws_table.deviations(pair).round(2)

# %% [markdown]
# ## A map
#
# Where the published enhanced law can be trusted for low-carbon steel: the recipe of Fig 12, drawn
# here. `cylcontact figure fig12` writes it as PNG and PDF with the CSV of its numbers.

# %%
fig12 = build.draw("fig12", bench)
fig12

# %%
pd.Series(fig12.headline, name="Fig 12").round(2).to_frame()

# %% [markdown]
# ## With dissipation
#
# An impact at 100 mm/s that should rebound with nine tenths of its speed. The published factor
# gives a little more; the exact one gives this value for every elastic law.

# %%
published = cc.dissipation.FACTORS["lankarani-nikravesh"](0.9)
exact = cc.dissipation.exact_factor(0.9)
pd.DataFrame(
    {
        "χ": [float(published), float(exact)],
        "restitution achieved": [
            float(cc.dissipation.achieved_restitution(chi)) for chi in (published, exact)
        ],
        "load on the way in, 50 mm/s (N/mm)": [
            float(cc.dissipation.dissipative_load(law.load(delta, pair), 50.0, 100.0, chi))
            for chi in (published, exact)
        ],
    },
    index=["Lankarani and Nikravesh", "exact"],
).round(4)
