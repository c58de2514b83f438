"""A map for your material.

The map shows where the published law agrees with conformal contact, against clearance and load.
Your material needs a modulus, a Poisson's ratio and, for the line of first yield, a yield stress.
"""

import matplotlib.pyplot as plt

import cylcontact as cc

gunmetal = cc.Material("gunmetal", E=110e3, nu=0.34, yield_stress=220)
figure, axes = plt.subplots(figsize=(5.0, 3.4), layout="constrained")
cc.plots.plot_map(cc.laws.Enhanced(), cc.laws.Persson(), gunmetal, load=(10, 5000), ax=axes)
figure.savefig("map.png", dpi=144)
