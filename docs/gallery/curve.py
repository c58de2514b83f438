"""The curve of conformal contact.

Conformal contact is computed from a table, one curve for each pair and housing. The script
compares its load with the exact series, at 20,000 loads for four pairs.
"""

import matplotlib.pyplot as plt
import numpy as np

import cylcontact as cc

steel, bronze = cc.Material.named("high-strength steel"), cc.Material.named("bronze")
pulled = cc.laws.Sector(60, "pulled")
cases = {
    "steel in steel": (steel, "johnson"),
    "steel in bronze": (bronze, "johnson"),
    "a ring of 2 R": (bronze, cc.laws.Housing(20.0)),
    "an eye of 1.3 R, pulled": (bronze, cc.laws.Housing(13.0, pulled)),
}
phi, largest = np.geomspace(1e-12, 1e6, 20000), 0.0
figure, axes = plt.subplots(figsize=(5.0, 2.81), layout="constrained")
for name, (hole, datum) in cases.items():
    pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.95, pin=steel, hole=hole)
    curve = cc.laws.Conformal(datum).curve(pair)
    error = np.abs(curve.load(curve.bodies.penetration(phi)) / phi - 1)
    at, most = phi.reshape(200, 100)[:, 0], error.reshape(200, 100).max(axis=1)
    axes.loglog(at, np.maximum(most, 1e-16), label=name)
    largest = max(largest, error.max())
axes.set(xlabel="φ = f/(E*·ΔR)", ylabel="largest error of the load", ylim=(1e-16, 1e-9))
axes.legend(loc="upper left")
figure.savefig("curve.png", dpi=144)
print(f"largest error of the load: {largest:.0e}")
