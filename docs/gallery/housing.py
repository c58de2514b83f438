"""One joint in several housings.

A steel pin in a bronze hole under 1000 N/mm, in housings of increasing outer radius. A thin eye
that is pulled gives way several times as much as a ring in a frame.
"""

import matplotlib.pyplot as plt
import numpy as np

import cylcontact as cc

steel, bronze = cc.Material.named("high-strength steel"), cc.Material.named("bronze")
pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.95, pin=steel, hole=bronze)
outer = np.geomspace(14, 100, 20)
clamps = {
    "clamped all round": "rim",
    "eye, pushed": cc.laws.Sector(60, "pushed"),
    "eye, pulled": cc.laws.Sector(60, "pulled"),
}
figure, axes = plt.subplots(figsize=(5.0, 2.81), layout="constrained")
for label, clamp in clamps.items():
    laws = [cc.laws.Conformal(cc.laws.Housing(R_o, clamp)) for R_o in outer]
    axes.plot(outer, [1e3 * law.penetration(1000.0, pair) for law in laws], label=label)
johnson = 1e3 * cc.laws.Johnson().penetration(1000.0, pair)
axes.axhline(johnson, color="black", linestyle=":", label="Johnson")
axes.set(xscale="log", yscale="log")
axes.set_xticks([15, 20, 30, 50, 100], ["15", "20", "30", "50", "100"])
axes.set_yticks([10, 20, 50, 100], ["10", "20", "50", "100"])
axes.minorticks_off()
axes.set(xlabel="outer radius (mm)", ylabel="penetration at 1000 N/mm (µm)")
axes.legend()
figure.savefig("housing.png", dpi=144)
