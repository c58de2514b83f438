"""The posterior of a fit, by emcee.

A sampler draws the stiffness and a clearance that is known to ±8 µm only from
`result.log_posterior`. The dashed lines are the profile intervals. They are a little wider, because
they allow for the scatter being estimated; the sampler takes it as found. The script needs
`pip install emcee`.
"""

import emcee
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import cylcontact as cc

steel = cc.Material("steel", E="207 GPa", nu=0.3)
pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.98, material=steel, length=20.0)
rng = np.random.default_rng(5)
loads = np.geomspace(10.0, 1500.0, 12)
depths = 1e3 * cc.laws.Explicit().penetration(loads, pair) * (1 + 0.01 * rng.normal(size=12))
table = pd.DataFrame({"load_N_per_mm": loads, "penetration_um": depths})
result = cc.fit(table, "explicit", pair, uncertain={"dR": "8 um"}, fixed={"offset": 0.0})
names = list(result.free)
centre = np.array([result.free[name] for name in names])
spread = np.array([result.estimates[name].standard_error for name in names])

sampler = emcee.EnsembleSampler(
    8, len(names), lambda values: result.log_posterior(dict(zip(names, values, strict=True)))
)
sampler.random_state = np.random.RandomState(5).get_state()
sampler.run_mcmc(centre + 0.1 * spread * rng.normal(size=(8, len(names))), 600)
draws = sampler.get_chain(discard=100, flat=True)

figure, panels = plt.subplots(1, 2, figsize=(7.2, 3.2), layout="constrained")
for axes, name, values in zip(panels, names, draws.T, strict=True):
    axes.hist(values, bins=40, color="0.8")
    interval = result.estimates[name]
    for end in (interval.low, interval.high):
        axes.axvline(end, color="C0", ls="--")
    axes.set(xlabel=name, yticks=[])
    low, high = np.quantile(values, [0.025, 0.975])
    print(f"{name}: 95 % of the draws in {low:.4g} to {high:.4g}")
    print(f"{name}: profile interval {interval.low:.4g} to {interval.high:.4g}")
figure.savefig("posterior.png", dpi=100)
