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
# # The mechanism
#
# You get the motion of a slider-crank whose joint between rod and slider has a clearance, and you
# see which of its results can be reproduced. The joint is a journal in a bearing. The journal can
# fly, impact and roll, and the contact law determines how.
#
# The masses and inertias are **assumed**, since the paper's table of them is missing. Speed, radii,
# length, material, friction and restitution are the paper's.
#
# The first simulation after an installation compiles the equations. This takes some twenty seconds,
# once.

# %%
import pandas as pd

import cylcontact as cc

spec = "../datasets/slider_crank.toml"

# %% [markdown]
# ## In five lines
#
# Ten revolutions with the enhanced law at a clearance of 0.5 mm. The picture shows the path of the
# journal's centre and the force in the joint.

# %%
settings = {"law": "enhanced", "clearance": 0.5, "friction": 0.1, "restitution": 0.9}
mechanism = cc.mechanism.read_mechanism(spec, revolutions=10, **settings)
with cc.reports.notebook.live_progress() as progress:
    run = cc.mechanism.simulate(mechanism, progress=progress)
run

# %% [markdown]
# The result carries its assumptions.

# %%
for assumption in run.assumptions:
    print(assumption)

# %% [markdown]
# The energies balance: the work of the drive is stored or dissipated in the contact.

# %%
print(
    f"drive work {run.drive_work[-1]:.3f} J, lost in impacts {run.normal_dissipation[-1]:.3f} J, "
    f"in friction {run.friction_dissipation[-1]:.3f} J"
)
print(f"largest error of the balance {abs(run.energy_error).max():.1e} J")

# %% [markdown]
# ## Does the law matter?
#
# Here the journal stays in contact after the first revolutions. The laws then give nearly the same
# motion and drive work, and different penetrations. The numbers are means over the revolutions,
# without the first two.

# %%
names = ["contact_fraction", "impacts", "mean_penetration_um", "max_penetration_um", "drive_work_J"]


def means(**changes):
    """Return the mean statistics of a run with some settings changed."""
    changed = cc.mechanism.read_mechanism(spec, revolutions=10, **settings | changes)
    return cc.mechanism.simulate(changed).statistics(first=2).mean[names]


pd.DataFrame({law: means(law=law) for law in ("johnson", "enhanced", "explicit")}).round(3)

# %% [markdown]
# Friction and dissipation matter far more than the law. Without them the journal flies.

# %%
pd.DataFrame(
    {
        f"friction {friction}, restitution {restitution}": means(
            friction=friction, restitution=restitution
        )
        for friction in (0.1, 0.0)
        for restitution in (0.9, 1.0)
    }
).round(3)

# %% [markdown]
# ## When the law ends
#
# At 0.02 mm Johnson's law reaches the end of its domain, and the simulation stops with a message.
# On request it continues along the tangent from nine tenths of that depth, and records this.

# %%
tight = settings | {"clearance": 0.02, "restitution": 1.0}
ending = cc.mechanism.read_mechanism(spec, revolutions=4, **tight | {"law": "johnson"})
try:
    cc.mechanism.simulate(ending)
except cc.InputError as stopped:
    print(stopped.rule)

# %%
continued = cc.mechanism.simulate(ending, beyond="tangent")
print(continued.statistics().continuation)

# %% [markdown]
# The explicit law has no end, so nothing has to be continued.

# %%
endless = cc.mechanism.read_mechanism(spec, revolutions=4, **tight | {"law": "explicit"})
print(repr(cc.mechanism.simulate(endless)))

# %% [markdown]
# ## What can be reproduced
#
# Without friction and dissipation the motion is sensitive. Two runs whose tolerances differ by a
# factor of ten separate after some revolutions. Beyond that point only statistics can be compared.

# %%
free = settings | {"friction": 0.0, "restitution": 1.0}
flying = cc.mechanism.read_mechanism(spec, revolutions=5, **free)
runs = [cc.mechanism.simulate(flying, tolerance=tolerance) for tolerance in (1e-8, 1e-9)]
print(f"the two separate after {cc.mechanism.horizon(*runs):.1f} revolutions")

# %% [markdown]
# The journal crosses the clearance freely between impacts. This is the last revolution.

# %%
runs[-1].plot(revolutions=1)
