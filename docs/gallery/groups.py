"""Readings of several specimens.

Nine specimens, each with an offset and a gain. The left fit takes all readings as
independent, the right one allows for the specimens.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

import cylcontact as cc

table = Path(__file__).parents[2] / "datasets/examples/specimens.csv"
pair = cc.CylinderPair.internal(
    R_i=10.0, R_j=9.97, material=cc.Material.named("high-strength steel"), length=20.0
)
figure, panels = plt.subplots(1, 2, figsize=(6.4, 4.0), sharey=True, layout="constrained")
widths = {}
for axes, options in zip(panels, ({}, {"group": "specimen"}), strict=True):
    result = cc.fit(table, "explicit", pair, **options)
    result.plot(ax=axes)
    axes.legend(loc="lower right", fontsize="small", ncols=2 if options else 1)
    axes.set_ylim(bottom=0.04)
    axes.set_title("readings taken as independent" if not options else "with nine specimens")
    interval = result.estimates["stiffness_factor"]
    widths[axes.get_title()] = {"low": interval.low, "high": interval.high}
figure.savefig("groups.png", dpi=112)
print(pd.DataFrame(widths).T.round(4))
