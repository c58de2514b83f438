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
# You get a law in C from the table of a rig: the fit, a picture of the data with it, and the
# remedies for what the report warns of. Replace the path and the pair with yours.

# %%
import pandas as pd

import cylcontact as cc

table = "../datasets/examples/rig.csv"

# %% [markdown]
# ## The table
#
# A rig wrote it with semicolons, decimal commas and names with units in brackets. Its readings are
# not zeroed. The fit reads the file as it is, and pandas shows it here. The numbers are
# **synthetic**. The script beside the table has the values to find.

# %%
rows = pd.read_csv(table, sep=";", decimal=",", comment="#")
rows.head(6)

# %% [markdown]
# The table does not contain the pair. A material is given by its name, or by E and ν.

# %%
bronze, steel = cc.Material.named("bronze"), cc.Material.named("low-carbon steel")
pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.98, material=bronze, length=20.0, material_j=steel)

# %% [markdown]
# ## First fit
#
# The columns are recognised by their names and units (`columns=` names others). The law is the
# explicit one. By default two numbers are fitted. One is the offset of the readings. The other is a
# factor of the load, which is 1 if the law and the moduli are right.

# %%
first = cc.fit(table, "explicit", pair)
first

# %% [markdown]
# The factor is 0.6 within ±3 %, which is precise and wrong. The warning gives the reason: the
# readings drift.
#
# ## Follow the report
#
# Allow for the drift. Every rig gives way under its load, so free its compliance as well.

# %%
second = cc.fit(table, "explicit", pair, drift=True, free=["compliance"])
second

# %% [markdown]
# Line 24 of the file is 17 standard deviations away, and it alone shifts the stiffness. The report
# also gives the fit without it. The line is not left out automatically, since only you can know
# whether a reading is wrong. Here its neighbours in the file leave no doubt, so drop it. (A `#` at
# the start of the line in the file does the same.)

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
# The profile is how much worse the fit gets along the factor, with all other parameters fitted anew
# at each value. The vertical lines are the ends of its interval.

# %%
third.plot_profile("stiffness_factor").figure

# %% [markdown]
# ## Use it
#
# The factor may be 1, so it is set to 1, as the report advises for two numbers that rise together.
# The rig's compliance is then known to 1 %. The script that made the data has 4·10⁻⁶ mm/(N/mm).

# %%
last = cc.fit(rows.drop(index=off), "explicit", pair, fixed={"stiffness_factor": 1.0}, **settings)
last.to_frame().dropna()

# %% [markdown]
# The prediction is what the rig will read, with the band of a new reading and that of the curve.

# %%
last.predict([100.0, 500.0, 2000.0]).round(5)

# %% [markdown]
# `to_law` is the contact alone, without the offset and the compliance of the rig. For a multibody
# code it is a function of C here. `cylcontact export` writes other languages.

# %%
law = last.to_law()
print(cc.export.export(law, "internal", "c", origin="fitted to rig.csv"))

# %% [markdown]
# This is the law beside others for this pair, in percent of conformal contact. The next notebook
# shows which of them the data support.

# %%
cc.plots.plot_laws(
    {"fitted": law, "Johnson": "johnson", "conformal contact": "conformal"},
    pair,
    load=(10.0, 2000.0),
    relative_to="conformal contact",
).figure

# %% [markdown]
# ## The data and the fit
#
# The points are the readings less the drift. The band is that of a new reading.

# %%
last.plot().figure
