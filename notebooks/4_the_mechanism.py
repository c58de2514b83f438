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
# A slider-crank whose joint between rod and slider has a clearance: a journal in a bearing, free to
# fly, impact and roll. The contact law determines the motion in the joint.
#
# The masses and inertias are **assumed**, since the paper's table of them is missing; speed, radii,
# length, material, friction and restitution are the paper's.

# %%
import numpy as np
import pandas as pd

from cylcontact import InputError
from cylcontact.mechanism import read_mechanism, simulate
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import figure_style
from cylcontact.reports.notebook import live_progress, open_bench

bench = open_bench()
spec = bench.root / "datasets" / "slider_crank.toml"

# %% [markdown]
# ## In five lines
#
# Ten revolutions with the enhanced law, friction 0.1 and a restitution of 0.9, at 0.5 mm clearance.

# %%
mechanism = read_mechanism(
    spec, law="enhanced", clearance=0.5, friction=0.1, restitution=0.9, revolutions=10
)
with live_progress() as progress:
    run = simulate(mechanism, progress=progress)
run

# %% [markdown]
# The result carries its assumptions:

# %%
for assumption in run.assumptions[:6]:
    print(assumption)
print(f"... and {len(run.assumptions) - 6} more")

# %% [markdown]
# ## Motion in the joint
#
# The journal's centre in the bearing, and the force in the joint, over the last two revolutions.


# %%
def joint(run, revolutions=2):
    """Draw the path of the journal's centre and the joint's force at the end of a run."""
    last = run.revolution >= run.revolutions - revolutions
    table = pd.DataFrame(
        {
            "revolution": run.revolution[last],
            "x_mm": -1e3 * run.eccentricity[last, 0],
            "y_mm": -1e3 * run.eccentricity[last, 1],
            "normal_force_N": run.normal_force[last],
        }
    )
    with figure_style():
        figure = new_figure("full", 78.0)
        path, force = figure.subplots(1, 2, width_ratios=(1, 2))
        angle = np.linspace(0, 2 * np.pi, 181)
        c = 1e3 * run.mechanism.clearance.radial
        path.plot(c * np.cos(angle), c * np.sin(angle), color="0.6", linewidth=0.6, marker="")
        path.plot(table["x_mm"], table["y_mm"], linewidth=0.8, marker="")
        path.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
        force.plot(table["revolution"], table["normal_force_N"], linewidth=0.8, marker="")
        force.set(xlabel="revolution", ylabel="joint force (N)")
    largest = {"largest force, N": float(table["normal_force_N"].max())}
    caption = "Left: the journal's centre in the bearing; grey, the clearance. Right: the force."
    return Drawing(figure, table, largest, caption)


joint(run)

# %% [markdown]
# The energies balance: the work of the drive is stored or dissipated in the contact.

# %%
print(
    f"drive work {run.drive_work[-1]:.3f} J, lost in impacts {run.normal_dissipation[-1]:.3f} J, "
    f"in friction {run.friction_dissipation[-1]:.3f} J"
)
print(f"largest error of the balance {np.abs(run.energy_error).max():.1e} J")

# %% [markdown]
# ## Does the law matter?
#
# Here the journal stays in contact after the first revolutions, and three laws give nearly the same
# motion and drive work; their penetrations differ. Means over revolutions, without the first two.

# %%
names = ["contact_fraction", "impacts", "mean_penetration_um", "max_penetration_um", "drive_work_J"]


def means(first=2, **changes):
    """Return the mean statistics of a run with some things changed."""
    settings = {"law": "enhanced", "clearance": 0.5, "friction": 0.1, "restitution": 0.9}
    changed = read_mechanism(spec, revolutions=10, **settings | changes)
    return simulate(changed).statistics(first=first).mean[names]


pd.DataFrame({law: means(law=law) for law in ("johnson", "enhanced", "explicit")}).round(3)

# %% [markdown]
# Friction and dissipation matter far more than the law: without them the journal flies.

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
# ## What can be reproduced
#
# Without friction and dissipation the motion is sensitive: the same run with a tolerance ten times
# smaller diverges from the first one. Beyond that point only statistics can be compared.

# %%
free = {"law": "enhanced", "clearance": 0.5, "friction": 0.0, "restitution": 1.0}
runs = [
    simulate(read_mechanism(spec, revolutions=5, tolerance=tolerance, **free))
    for tolerance in (1e-8, 1e-9)
]
time = np.linspace(0, 5, 5001)
coarse, fine = (
    np.column_stack([np.interp(time, r.revolution, r.eccentricity[:, k]) for k in (0, 1)])
    for r in runs
)
apart = 1e3 * np.hypot(*(coarse - fine).T)
print(f"the two part by more than 0.01 mm after {time[np.argmax(apart > 0.01)]:.1f} revolutions")

# %% [markdown]
# ## When the law ends
#
# At 0.02 mm Johnson's law reaches the end of its domain, and the simulation stops with a
# message. On request it continues along the tangent, and the result records it.

# %%
tight = {"clearance": 0.02, "friction": 0.1, "restitution": 1.0, "revolutions": 4}
try:
    simulate(read_mechanism(spec, law="johnson", **tight))
except InputError as stopped:
    print(stopped)

# %%
continued = simulate(read_mechanism(spec, law="johnson", **tight), beyond="tangent")
print(continued.statistics().continuation)

# %% [markdown]
# The explicit law has no end, so nothing has to be continued.

# %%
simulate(read_mechanism(spec, law="explicit", **tight))
