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
# # Which law?
#
# You get all laws ranked on your data, whether the data can tell them apart, and predictions of the
# chosen one. Replace the table and the pair with yours.

# %%
import numpy as np
import pandas as pd

import cylcontact as cc

# %% [markdown]
# ## The data
#
# There are nine specimens with ten loads each. They are steel pins, 30 µm smaller in radius than
# their steel holes. The numbers are **synthetic**: the penetration is that of conformal contact,
# which is exact, not of the law that is chosen below. Each specimen has an offset, a gain and
# scatter of its own. For your data, name a table: `table = "mine.csv"`.

# %%
steel = cc.Material.named("high-strength steel")
pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
load_kN = np.array([0.5, 1, 2, 4, 7, 12, 18, 25, 32, 40])
exact_um = 1e3 * cc.laws.Conformal().penetration(1e3 * load_kN / pair.length, pair)
random = np.random.default_rng(20150103)
specimens = []
for number in range(1, 10):
    offset, gain = random.normal(0.0, 0.2), 1 + random.normal(0.0, 0.04)
    constant, proportional = random.normal(size=(2, load_kN.size))
    readings = offset + exact_um * (gain + 0.01 * proportional) + 0.03 * constant
    columns = {"specimen": f"S{number}", "load_kN": load_kN, "penetration_um": readings}
    specimens.append(pd.DataFrame(columns))
table = pd.concat(specimens, ignore_index=True).round(3)
table.pivot(index="load_kN", columns="specimen", values="penetration_um")

# %% [markdown]
# ## Errors first, law second
#
# The errors of the readings decide what the data can tell. A fit that takes ninety readings for
# independent warns that they are not.

# %%
cc.fit(table, "explicit", pair)

# %% [markdown]
# With the column of the specimens given, no warning is left. The report says how much they differ
# in the offset and in the gain.

# %%
fitted = cc.fit(table, "explicit", pair, group="specimen")
fitted

# %% [markdown]
# ## All laws, ranked
#
# Each law has the offset, a compliance and one stiffness free; constants of shape are held.
# The compliance allows for another datum: the points between which the penetration is taken, the
# housing and the rig. AICc weighs the fit against the number of its coefficients, and the
# cross-validated error is that of readings which the fit has not used. A law is called worse only
# where both agree.

# %%
choice = cc.choose(table, pair, group="specimen")
print(choice)

# %% [markdown]
# The forms of conformal contact cannot be told apart. With a compliance of their own the enhanced
# law, the power law and two laws for steel rollers follow the readings as well, so these data do
# not decide between the law and the datum. In a picture even laws that are clearly worse pass
# through the readings, so do not choose by eye.

# %%
choice.plot().figure

# %% [markdown]
# ## The datum known
#
# Here the readings are by the datum of the law. Said so, of the laws that were left those that are
# not of conformal contact fall behind.

# %%
known = cc.choose(table, pair, group="specimen", laws=choice.undecided, fixed={"compliance": 0.0})
print(known)

# %% [markdown]
# ## Which housing?
#
# A law needs the place that its penetration is counted from. In a joint that is the clamped rim of
# the housing. This is the penetration (µm) under 1000 N/mm, and the load of first yield (N/mm), for
# the same pair in a plate by Johnson's datum, in a ring pressed into a frame, and in an eye that is
# pulled by its shank. If you know the housing of your readings, say so: `housing={"R_o": 15.0}` in
# `cc.choose` and `cc.fit`.

# %%
eye = cc.laws.Housing(15.0, clamp=cc.laws.Sector(60, side="far"))
answers = {}
for name, housing in {"plate": None, "ring": cc.laws.Housing(15.0), "pulled eye": eye}.items():
    law = cc.laws.Conformal(housing or "johnson")
    limit = cc.limits.yield_load(pair, housing=housing)
    answers[name] = 1e3 * law.penetration(1000.0, pair), limit
pd.DataFrame(answers, index=["penetration, µm", "first yield, N/mm"]).round(1)

# %% [markdown]
# ## Does it matter?
#
# This is how much the laws that are left differ, over the loads of the data and ten times higher.

# %%
undecided = [name for name in known.undecided if name in cc.laws.LAWS]
cc.plots.plot_laws(undecided, pair, load=(10.0, 20000.0), relative_to=undecided[0]).figure

# %% [markdown]
# It is less than 1 %, and the specimens differ by more. So take the simplest.
#
# ## When the data cannot tell
#
# Here are four of the laws, on the table up to 4 kN, a tenth of the load. Now the data cannot rule
# out Johnson's law either. Take the law that is known to be right for the contact, or measure at
# higher loads.

# %%
low = table[table["load_kN"] <= 4]
names = ["explicit", "persson", "enhanced", "johnson"]
print(cc.choose(low, pair, group="specimen", laws=names))

# %% [markdown]
# ## Predict
#
# The chosen law has two bands at 95 %. One is that of the curve, which more specimens would narrow.
# The other is that of a reading of another specimen, which they would not.

# %%
best = known.fit()
prediction = best.predict([50.0, 200.0, 800.0, 2000.0])
curve = 1e3 * prediction[["curve_low_mm", "curve_high_mm"]].to_numpy()
prediction[["load_kN", "penetration_um", "low_um", "high_um"]].assign(
    curve_low_um=curve[:, 0], curve_high_um=curve[:, 1]
).round(3)

# %%
best.plot().figure
