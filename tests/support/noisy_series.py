"""Readings of a rig made from a known law: series with errors of their own, and scatter."""

from dataclasses import replace

import numpy as np
import pandas as pd

from cylcontact import CylinderPair, laws
from cylcontact.fitting.campaign import read_table
from cylcontact.fitting.noise import NoiseModel
from cylcontact.fitting.readings import Optimum, plain_fit
from tests.support.measured_files import STEEL, with_columns

PAIR = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)
LAW = laws.Explicit()
OFFSET = 2e-4  # mm


def readings(
    seed,
    series=8,
    rows=12,
    *,
    constant=5e-5,
    proportional=0.0,
    offset=0.0,
    gain=0.0,
    drift=0.0,
    load_error=0.0,
    compliance=0.0,
    zero=OFFSET,
    shuffled=False,
):
    """A table of loads and penetrations with these deviations in mm, or relative."""
    rng = np.random.default_rng(seed)
    parts = []
    for number in range(series):
        load = np.geomspace(10.0, 1500.0, rows)
        if shuffled:
            load = rng.permutation(load)
        true = load * (1 + load_error * rng.normal(size=rows))
        depth = LAW.penetration(true, PAIR) + compliance * true
        own = offset * rng.normal() + gain * rng.normal() * depth
        own = own + drift * rng.normal() * np.linspace(0.0, 1.0, rows)
        scatter = constant * rng.normal(size=rows) + proportional * depth * rng.normal(size=rows)
        reading = 1e3 * (depth + zero + own + scatter)
        columns = {"load_N_per_mm": load, "penetration_um": reading, "group": f"s{number}"}
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)


def refitted(campaign, frame):
    """The optimum of a campaign for the readings of another table."""
    data = with_columns(
        campaign.data,
        load=frame["load_N_per_mm"].to_numpy(),
        penetration=1e-3 * frame["penetration_um"].to_numpy(),
    )
    fit = plain_fit(replace(campaign, data=data))
    point, _ = fit.minimise(np.array([1.0, OFFSET]))
    if isinstance(campaign.noise, NoiseModel):
        fit = fit.estimating(campaign.noise, point)
        point, _ = fit.minimise(point)
    return Optimum(fit, point)


def campaign_of(data, law, pair, *, fixed=None, bounds=None, **settings):
    """The campaign that `cylcontact.fit` runs."""
    return read_table(data, law, pair, fixed=fixed, bounds=bounds, **settings).campaign(law)
