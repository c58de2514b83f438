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
import cylcontact as cc
import pandas as pd

table = "../datasets/examples/rig.csv"

# %% [markdown]
# ## The table
#
# As a rig writes it: semicolons, decimal commas, units in brackets. Nothing has to be converted.
# These numbers are **synthetic**; the script beside the table has the values to find.

# %%
with open(table, encoding="utf-8") as lines:
    print("".join(lines.readlines()[:9]))

# %% [markdown]
# What the table does not say: the two bodies. Without a number of your own, take a material by name.

# %%
bronze, steel = cc.Material.named("bronze"), cc.Material.named("low-carbon steel")
pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.98, material=bronze, length=20.0, material_j=steel)

# %% [markdown]
# ## First fit
#
# `F [N]` and `t [s]` are recognised; that `s [µm]` is the penetration has to be said. The law is
# the explicit one. By default two numbers are fitted: the offset of the readings, since no rig is
# zeroed perfectly, and a factor of the load, which is 1 if the law and the moduli are right.

# %%
columns = {"penetration": "s [µm]"}
first = cc.fit(table, "explicit", pair, columns=columns)
print(first)

# %% [markdown]
# A stiffness of 0.6 and an interval of ±3 %: precise, and wrong. The lines that begin with `!` say
# so: the readings drift. The residuals show more, a bend and one reading far from its neighbours.

# %%
first.plot_residuals();

# %% [markdown]
# ## Follow the report
#
# Allow for the drift. And a rig gives way under its load: its compliance is free as well.

# %%
second = cc.fit(table, "explicit", pair, columns=columns, drift=True, free=["compliance"])
print(second)

# %% [markdown]
# Line 24 is 17 standard deviations away, so far that it decides about the stiffness and the
# compliance. The report gives both fits, and leaves the row in: whether a reading is wrong is for
# you to say. Here the one before, at the load above, is as large, so this one is left out. (In the
# file, a `#` at the start of the line does the same.)

# %%
rows = pd.read_csv(table, sep=";", decimal=",", comment="#")
line_of_first_row = 4
third = cc.fit(
    rows.drop(index=24 - line_of_first_row),
    "explicit",
    pair,
    columns=columns,
    drift=True,
    free=["compliance"],
    name="rig without line 24",
)
third

# %% [markdown]
# No warning is left. The factor is 1 within its error, as it should be for the law that made the
# data; the compliance is 4·10⁻⁶ mm per N/mm, that of the script. The two rise together (the report
# says so), because a stiffer contact and a softer rig read nearly alike. The picture shows readings
# as they are: what drifts over them is in the band.

# %%
third.plot();

# %% [markdown]
# ## What the data determine
#
# How much worse the fit gets along the factor, all others refitted; the dashed lines are the ends of
# the interval.

# %%
third.plot_profile("stiffness_factor");

# %% [markdown]
# By hand: move a coefficient, and see the curve beside the best one, and whether the data rule it
# out. Here the others do not follow.

# %%
cc.reports.fit_explorer.explore_fit(third)

# %% [markdown]
# ## Use the law
#
# `to_law` is the law of the contact, without the offset and the compliance of the rig. What a
# reading will be, with its band, is `predict`.

# %%
law = third.to_law()
print(f"{1e3 * law.penetration(500.0, pair):.3f} µm at 500 N/mm")
third.predict([100.0, 500.0, 2000.0]).round(6)

# %% [markdown]
# For a multibody code, a C function of load and stiffness with the fitted constants; `cylcontact
# export` writes Fortran, MATLAB and others as well.

# %%
source = cc.export.export(law, "internal", "c", origin="fitted to rig.csv")
print("\n".join(source.splitlines()[:24]))

# %% [markdown]
# At last the law, against the published one: the same shape, a factor of the load between them.

# %%
third.plot_residuals();
