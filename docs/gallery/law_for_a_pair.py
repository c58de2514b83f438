"""A law for a pair.

Four laws of one steel pin in a bronze hole, against the load. The right picture shows their
difference from conformal contact, with first yield.
"""

import matplotlib.pyplot as plt

import cylcontact as cc

steel, bronze = cc.Material.named("high-strength steel"), cc.Material.named("bronze")
pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.95, pin=steel, hole=bronze)
exact = cc.laws.Conformal()
laws = [cc.laws.Johnson(), cc.laws.Enhanced(), cc.laws.Explicit(), exact]
figure, (left, right) = plt.subplots(1, 2, figsize=(6.4, 3.6), layout="constrained")
cc.plots.plot_laws(laws, pair, load=(10, 5000), ax=left)
cc.plots.plot_laws(laws, pair, load=(10, 5000), relative_to=exact, ax=right)
yields = cc.limits.yield_load(pair)
right.axvline(yields, color="black", linestyle=":", label="first yield")
right.legend(fontsize="small")
for axes in (left, right):
    axes.set_xticks([10, 100, 1000], ["10", "100", "1000"])
figure.savefig("law_for_a_pair.png", dpi=112)
print(f"first yield at {yields:,.0f} N/mm")
