"""Which law fits the readings?

Four laws are fitted to the same readings and ranked. The plot shows them with some of the
readings; the table says which of them the data can tell apart.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import cylcontact as cc

table = Path(__file__).parents[2] / "datasets/examples/pin-in-hole.csv"
choice = cc.choose(table, contact="internal", laws=["explicit", "johnson", "enhanced", "liu"])
figure, axes = plt.subplots(figsize=(5.0, 2.81), layout="constrained")
choice.plot(ax=axes)
figure.savefig("choose.png", dpi=144)
print(choice)
