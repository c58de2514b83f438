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
# # Calibrate your own data
#
# From a rig's table to a law in C: read the table, fit, look at the picture, follow what the report
# warns of, and export. Replace the path and the pair with yours.

# %%
import pandas as pd

import cylcontact as cc

table = "../datasets/examples/rig.csv"

# %% [markdown]
# ## The table
#
# As a rig writes it: semicolons, decimal commas, names with units in brackets, readings that are
# not zeroed. The fit reads the file as it is; pandas shows it here. The numbers are **synthetic**,
# and the script beside the table has the values to find.

# %%
rows = pd.read_csv(table, sep=";", decimal=",", comment="#")
rows.head(6)

# %% [markdown]
# What the table does not say is the pair. A material goes by its name, or by E and ν.

# %%
bronze, steel = cc.Material.named("bronze"), cc.Material.named("low-carbon steel")
pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.98, material=bronze, length=20.0, material_j=steel)

# %% [markdown]
# ## First fit
#
# The columns are recognised by their names and units (`columns=` names others). The law is the
# explicit one. Two numbers are fitted unless you say otherwise: the offset of the readings, and a
# factor of the load, which is 1 if the law and the moduli are right.

# %%
first = cc.fit(table, "explicit", pair)
first

# %% [markdown]
# A factor of 0.6, within ±3 %: precise, and wrong. The warnings say why: the readings drift.
#
# ## Follow the report
#
# Allow for the drift; and since every rig gives way under its load, free its compliance.

# %%
second = cc.fit(table, "explicit", pair, drift=True, free=["compliance"])
second

# %% [markdown]
# Line 24 of the file is 17 standard deviations away, and decides about the stiffness: the report
# has the fit without it as well. It stays in, since only you can say whether a reading is wrong.
# Here its neighbours in the file leave no doubt, so drop it. (A `#` at the start of the line in the
# file does the same.)

# %%
off = 24 - 4  # lines 1 and 2 are comments, and line 3 has the names
rows[off - 2 : off + 3]

# %%
settings = {"drift": True, "free": ["compliance"], "name": "rig"}
third = cc.fit(rows.drop(index=off), "explicit", pair, **settings)
third

# %% [markdown]
# No warning is left, and the factor is 1 within its error. The report adds that the factor rises
# together with the compliance, since a stiffer contact on a softer rig reads nearly the same. (The
# picture has the readings less the drift.)
#
# ## What the data determine
#
# How much worse the fit gets along the factor if all others follow; the vertical lines are the ends
# of its interval.

# %%
third.plot_profile("stiffness_factor").figure

# %% [markdown]
# And if the others do not follow: move the sliders. The points are the readings less the drift.
# Above the threshold the data rule the values out.

# %%
cc.reports.fit_explorer.explore_fit(third)

# %% [markdown]
# ## Use it
#
# The factor may be 1, so it is set to 1, as the report advises of two numbers that rise together.
# What remains to be found is the rig's compliance, now to 1 %: the script has 4·10⁻⁶ mm/(N/mm).

# %%
last = cc.fit(rows.drop(index=off), "explicit", pair, fixed={"stiffness_factor": 1.0}, **settings)
last

# %% [markdown]
# What the rig will read, with the band of a new reading and that of the curve:

# %%
last.predict([100.0, 500.0, 2000.0]).round(5)

# %% [markdown]
# `to_law` is the contact alone, without the offset and the compliance of the rig. For a multibody
# code it is a function of C; `cylcontact export` writes other languages.

# %%
law = last.to_law()
source = cc.export.export(law, "internal", "c", origin="fitted to rig.csv")
print("\n".join(source.splitlines()[:22]))

# %% [markdown]
# The law beside others for this pair, in percent of conformal contact. Which of them do the data
# support? That is the next notebook.

# %%
cc.plots.plot_laws(
    {"fitted": law, "Johnson": "johnson", "conformal contact": "conformal"},
    pair,
    load=(10.0, 2000.0),
    relative_to="conformal contact",
).figure
