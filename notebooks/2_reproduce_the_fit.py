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
# # Reproduce the fit
#
# You get the seven coefficients of the enhanced law for internal contact, fitted anew, beside the
# published ones. The first fit recovers the published coefficients. The second one searches all
# seven over the paper's ranges of E, ν, ΔR and load.

# %%
import cylcontact as cc

# %% [markdown]
# ## The published coefficients come back
#
# Their digits are linked: 0.965 and 0.0965; 1.51, −0.151, 0.0151 and 1.151. So two numbers are
# searched, and the others are tied to them.

# %%
linked = cc.fitting.read_campaign("../fitting/recovered-internal.toml")
linked

# %%
print(cc.fitting.compare([cc.fitting.calibrate(linked, jobs=2)]))

# %% [markdown]
# ## All coefficients free
#
# A genetic search finds the region of the optimum, and a local search refines it. The grid has some
# 340 000 samples. Six sums per clearance replace them exactly, so one evaluation takes
# microseconds. To save time, two runs are made here instead of the sixteen of
# `fitting/internal.toml`.

# %%
campaign = cc.fitting.read_campaign("../fitting/internal.toml", runs=2)
with cc.reports.notebook.live_progress() as progress:
    result = cc.fitting.calibrate(campaign, jobs=2, progress=progress)
result

# %% [markdown]
# With all coefficients free, the published ones are not the optimum on this grid. The bound is the
# objective of the best factor and exponent at every single clearance. No law of this form can do
# better.
#
# ## The committed result
#
# It has all sixteen runs. The last column is the difference of the coefficients found here from
# the committed ones.

# %%
committed = cc.fitting.FitResult.read("../fitting/results/internal.json")
table = committed.to_frame()[["unit", "value"]].rename(columns={"value": "committed"})
table["here"] = result.to_frame()["value"]
table["difference (%)"] = 100 * (table["here"] / table["committed"] - 1)
table.round(6)

# %% [markdown]
# Not every run ends at the same place, since there is more than one basin. This is why a campaign
# has several runs.

# %%
cc.reports.fit_figures.runs_drawing(committed)

# %% [markdown]
# ## How sharply is a coefficient known?
#
# The profile is the best objective with b fixed at a value and the other six coefficients
# optimised. A flat profile means that the data hardly determine b.

# %%
committed.plot_profile("b").figure
