"""Stiffness from an ISO fit.

A drawing gives a fit, and its limits leave a band of stiffness. The bands of three fits, from the
tightest to the loosest pair.
"""

import matplotlib.pyplot as plt
import numpy as np

import cylcontact as cc

steel, bronze = cc.Material.named("high-strength steel"), cc.Material.named("bronze")
law, load = cc.laws.Conformal(), np.geomspace(10, 2000, 80)
figure, axes = plt.subplots(figsize=(5.0, 2.81), layout="constrained")
for fit in ("20H7/g6", "20H7/f7", "20H8/d9"):
    pair = cc.CylinderPair.from_iso(fit, pin=steel, hole=bronze, length=20.0)
    depth = law.penetration(load[:, None], pair)
    loosest, middle, tightest = np.sort(1e-3 * law.stiffness(depth, pair), axis=1).T
    (line,) = axes.plot(load, middle, label=fit)
    axes.fill_between(load, loosest, tightest, color=line.get_color(), alpha=0.2)
axes.set(xscale="log", xlabel="load (N/mm)", ylabel="stiffness (kN/mm per mm)")
axes.legend()
figure.savefig("fit_20H7_g6.png", dpi=144)
