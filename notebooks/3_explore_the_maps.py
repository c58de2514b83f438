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
# # Explore the maps
#
# You get the penetration of any pair by the laws that you choose, how far each is from conformal
# contact, first yield and the width of the contact, while you move the controls. `make explore`
# shows this page in a browser, without the code.

# %%
import cylcontact as cc

# %% [markdown]
# ## The controls
#
# A material fills in its numbers. Change them for a material of your own, or give it by name:
# `explore_pair([cc.Material("mine", E=110e3, nu=0.34)])`. The yield stresses of the table are
# assumptions. If you know the housing of your pin, choose how it is clamped: without it the
# penetration is by Johnson's datum. Choose several laws with the Ctrl key.

# %%
cc.reports.explore.explore_pair()

# %% [markdown]
# ## A map
#
# Over clearance and load: how far the enhanced law is from Johnson's for this bronze.

# %%
bronze = cc.Material("bronze", E=110e3, nu=0.34, yield_stress=220)
cc.plots.plot_map("enhanced", "johnson", bronze).figure

# %% [markdown]
# ## The same without controls
#
# A `Choice` is what the controls are set to: a pair, a load, laws, and the housing if it is known.
# It gives the same numbers in a script.

# %%
steel = cc.Material.named("low-carbon steel")
pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.95, material=bronze, material_j=steel)
eye = cc.laws.Housing(R_o=20.0, clamp=cc.laws.Sector(60, side="far"))
choice = cc.reports.explore.Choice(pair, 1000.0, ("explicit", "enhanced", "johnson"), eye)
cc.reports.explore.table(choice).round(3)

# %% [markdown]
# The picture marks the chosen load and first yield.

# %%
cc.reports.explore.view(choice)
