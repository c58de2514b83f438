"""A four-bar with two clearances: the forces in both joints."""

import tomllib
from pathlib import Path

import matplotlib.pyplot as plt

from cylcontact.mechanism import mechanism_from, simulate

file = Path(__file__).parents[2] / "datasets/four_bar.toml"
data = tomllib.loads(file.read_text(encoding="utf-8"))
worn = next(joint for joint in data["joint"] if "clearance" in joint)
data["joint"] = [worn | j if j["name"] == "crank-pin" else j for j in data["joint"]]
run = simulate(mechanism_from(data, str(file), revolutions=2))
figure, axes = plt.subplots(figsize=(8, 3.6), layout="constrained")
for name, motion in run.joints.items():
    axes.plot(1e3 * run.time, motion.normal_force, linewidth=0.8, label=name)
axes.set(xlabel="time (ms)", ylabel="normal force (N)")
axes.legend()
figure.savefig("two_clearances.png", dpi=80)
