"""A law fitted to readings.

Twelve readings of a rig, fitted by the explicit law. Below are the residuals in percent, with the
band that holds 95 % of new readings.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import cylcontact as cc

pair = cc.CylinderPair.internal(
    R_i=10.0, R_j=9.97, material=cc.Material("steel", E="207 GPa", nu=0.3), length=20.0
)
load = np.array([0.2, 0.5, 1, 2, 3, 5, 8, 12, 16, 20, 25, 30])  # kN
read = [0.206, 0.454, 0.803, 1.398, 1.952, 2.886, 4.228, 5.886, 7.024, 8.255, 9.939, 11.324]
result = cc.fit(pd.DataFrame({"load_kN": load, "penetration_um": read}), "explicit", pair)
figure, (above, below) = plt.subplots(
    2, 1, figsize=(5.0, 2.81), sharex=True, height_ratios=(2, 1), layout="constrained"
)
result.plot(ax=above)
above.set_xlabel("")
rows = result.residuals
loads, fitted = rows["load_N_per_mm"].to_numpy(), rows["fitted_mm"].to_numpy()
band = result.predict(loads)
low, high = (100 * (band[end].to_numpy() / fitted - 1) for end in ("low_mm", "high_mm"))
below.fill_between(loads, low, high, color="#f6e2d3")
below.plot(loads, 100 * rows["residual_mm"] / fitted, "o", color="black", markerfacecolor="white")
below.axhline(0.0, color="0.5", linewidth=0.8)
below.set(xlabel="load (N/mm)", ylabel="residual (%)")
below.margins(y=0.15)
figure.savefig("own_data.png", dpi=144)
print(result.predict([225.0]).round(5).to_string(index=False))
