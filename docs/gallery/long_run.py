"""The mean of a long run.

Forty revolutions of a slider-crank, and the mean of their largest forces. Its interval allows for
revolutions that depend on each other.
"""

from pathlib import Path

import matplotlib.pyplot as plt

from cylcontact.mechanism import long_run, read_mechanism

file = Path(__file__).parents[2] / "datasets/slider_crank.toml"
crank = read_mechanism(file, law="explicit", clearance=0.5, restitution=1.0)
statistics = long_run(crank, revolutions=40)
quantity = "max_force_N"
each = statistics.by_revolution[quantity]
mean, half_width = statistics.interval().loc[quantity, ["mean", "half_width"]]
figure, axes = plt.subplots(figsize=(5.0, 3.4), layout="constrained")
axes.plot(each.index, each, ".", label="one revolution")
axes.axhline(mean, color="black", linewidth=0.8, label="mean")
axes.axhspan(mean - half_width, mean + half_width, alpha=0.2, label="95 % interval of the mean")
axes.set(xlabel="revolution", ylabel="largest force (N)")
axes.set_ylim(bottom=each.min() - 12000)
axes.legend(loc="lower right")
figure.savefig("long_run.png", dpi=144)
