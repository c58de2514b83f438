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
# You get the penetration and the stiffness of a pin in a hole under a load, the loads up to which
# they are valid, and a map of where a law can be trusted.
#
# Lengths are in mm, forces in N and stresses in MPa. A load is per unit of axial length, in N/mm.

# %%
import pandas as pd

import cylcontact as cc

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
law

# %% [markdown]
# All functions take arrays, which broadcast. Here are five loads and three clearances. Outside its
# domain a law returns NaN. Johnson's law ends inside this table.

# %%
loads = [10.0, 100.0, 300.0, 1000.0, 3000.0]
clearances = [0.005, 0.05, 0.5]
pairs = cc.CylinderPair.from_dR("internal", [[dR] for dR in clearances], steel, R_i=10.0)
pd.DataFrame(
    1e3 * cc.laws.Johnson().penetration(loads, pairs),
    index=pd.Index(clearances, name="ΔR (mm)"),
    columns=pd.Index(loads, name="δ (µm) at f (N/mm)"),
).round(3)

# %% [markdown]
# ## Limits
#
# Two loads limit an elastic law. At one of them either body first yields, by von Mises. At the
# other one Johnson's law ends. The yield stress here is our assumption.

# %%
cc.plots.plot_limits(steel).figure

# %% [markdown]
# Johnson's largest load is the end of its algebra, not of its accuracy. Well before it, the
# penetration is too small against Persson's solution for conformal contact. The table has the loads
# in N/mm at which it is too small by a given percentage. Its columns are clearances in mm.

# %%
cc.reports.laws_table.departures(steel).round(2)

# %% [markdown]
# ## Which law when
#
# The table compares the penetration of every law with Persson's, in percent. Its columns are values
# of the load number φ = f/(E*·ΔR). `explicit` follows conformal contact everywhere, without
# iteration. The page `docs/how-to/choose-a-law.md` helps to choose.

# %%
cc.reports.laws_table.deviations(pair).round(2)

# %% [markdown]
# ## With dissipation
#
# An impact at 100 mm/s should rebound with nine tenths of its speed. The published factor gives a
# little more. The exact one gives this value for every elastic law.

# %%
factors = {
    "Lankarani and Nikravesh": cc.dissipation.FACTORS["lankarani-nikravesh"](0.9),
    "exact": cc.dissipation.exact_factor(0.9),
}
pd.DataFrame(
    {
        name: {
            "χ": chi,
            "restitution achieved": cc.dissipation.achieved_restitution(chi),
            "load on the way in, at 50 mm/s (N/mm)": cc.dissipation.dissipative_load(
                law.load(delta, pair), 50.0, 100.0, chi
            ),
        }
        for name, chi in factors.items()
    },
    dtype=float,
).round(4)

# %% [markdown]
# ## A map
#
# The map shows where the published enhanced law can be trusted for low-carbon steel. The contours
# are its difference from Johnson's law.

# %%
cc.plots.plot_map("enhanced", "johnson", cc.Material.named("low-carbon steel")).figure
