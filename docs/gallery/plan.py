"""Which loads to measure next.

The script finds the five loads at which further readings narrow the interval of the stiffness
most. The line shows how much one reading at each load would help.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import cylcontact as cc

table = Path(__file__).parents[2] / "datasets/examples/specimens.csv"
pair = cc.CylinderPair.internal(
    R_i=10.0, R_j=9.97, material=cc.Material.named("high-strength steel"), length=20.0
)
result = cc.fit(table, "explicit", pair, group="specimen")
plan = result.plan(np.geomspace(5, 1500, 40), add=5, parameter="stiffness_factor")
figure, axes = plt.subplots(figsize=(5.0, 3.8), layout="constrained")
plan.plot(ax=axes)
axes.legend(loc="upper left")
figure.savefig("plan.png", dpi=144)
print(plan.readings.to_string(index=False))
