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
# You get the force–penetration curve of any pair and law, its difference from Johnson's law and
# from conformal contact, and its limits, while you move the controls.

# %%
import cylcontact as cc

# %% [markdown]
# ## The controls
#
# A material fills in its numbers. Change them for a material of your own, or give it by name:
# `explore_pair([cc.Material("mine", E=110e3, nu=0.34)])`. The pin, or the second roller, is of the
# same material unless you choose another. The yield stresses of the table are assumptions.

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
# A `Choice` is what the controls are set to. It gives the same numbers in a script.

# %%
choice = cc.reports.explore.Choice(bronze, "internal", 0.02, 200.0, cc.laws.Enhanced())
cc.reports.explore.curve(choice).iloc[::32].round(6)

# %% [markdown]
# The picture marks the chosen load. The grey band is within 10 % of the reference.

# %%
cc.reports.explore.view(choice)
