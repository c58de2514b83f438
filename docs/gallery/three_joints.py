"""A clevis, a cam roller and a polymer bush.

Sketches of three joints to one scale, each above its penetration up to first yield. [The
page](../how-to/three-joints.md) asks the same of the command line.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Circle, Rectangle

import cylcontact as cc

hard, mild = cc.Material.named("high-strength steel"), cc.Material.named("low-carbon steel")
peek = cc.Material("PEEK at 80 °C", 3.3e3, 0.38, 70.0, 50e-6)
lug = cc.laws.Housing(R_o=40.0, clamp=cc.laws.Sector.lug())
frame = cc.laws.Housing(R_o=13.0)
clevis = cc.CylinderPair.internal(20.0098, 19.9813, pin=hard, hole=mild, plane="stress")
cold = cc.CylinderPair.internal(10.0, 9.9, pin=mild, hole=peek)
roller = cc.CylinderPair.external(20.0, np.inf, hard)
hot = cc.limits.at_temperature(cold, 80, 80, housing=frame, rim=mild)
joints = {
    "clevis": (clevis, lug, cc.laws.Conformal(lug), 2000.0,
               [(Rectangle((-40, -90), 80, 90), 0.85), (Circle((0, 0), 40), 0.85),
                (Circle((0, 0), 20), 0.5)]),
    "cam roller": (roller, None, cc.laws.Johnson(datum=30.0), 312.5,
                   [(Rectangle((-50, -60), 100, 40), 0.85), (Circle((0, 0), 20), 0.5)]),
    "polymer bush at 80 °C": (hot, frame, cc.laws.Conformal(frame), 100.0,
                              [(Rectangle((-20, -20), 40, 40), 0.85), (Circle((0, 0), 13), 0.7),
                               (Circle((0, 0), 9.9), 0.5)]),
}  # fmt: skip
figure, axes = plt.subplots(2, 3, figsize=(7.2, 4.05), layout="constrained")
for (sketch, curve), name in zip(axes.T, joints, strict=True):
    pair, housing, law, work, shapes = joints[name]
    for shape, grey in shapes:
        sketch.add_patch(shape).set(facecolor=str(grey), edgecolor="black")
    sketch.arrow(0, 0, 0, 50 if housing is lug else -12, color="red", width=1.5)
    sketch.plot([44, 64], [-85, -85], "k|-")
    sketch.text(54, -82, "20 mm", ha="center", va="bottom", fontsize=8)
    sketch.set(aspect="equal", title=name, xlim=(-65, 65), ylim=(-92, 65))
    sketch.axis("off")
    load = np.linspace(0, cc.limits.first_yield(pair, housing=housing).load, 60)[1:]
    curve.plot(load, 1e3 * law.penetration(load, pair))
    curve.plot(work, 1e3 * law.penetration(work, pair), "ro")
    curve.set(xlabel="load up to first yield (N/mm)", ylabel="penetration (µm)")
figure.savefig("three_joints.png", dpi=100)
