"""What runs of the slider-crank, ours and in Exudyn, have in common: statistics and energy."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import cumulative_trapezoid

from benchmarks.mechanism import SPEC
from cylcontact.files.spec import read_toml
from cylcontact.mechanism import SliderCrank, mechanism_from


class Statistics(NamedTuple):
    """Share of time in contact, mean penetration there (µm), energy lost per revolution (J)."""

    contact: float
    depth: float
    loss: float


def slider_crank(restitution: float, friction: float) -> SliderCrank:
    """Return the mechanism."""
    data = read_toml(SPEC)
    data["joint"]["dissipation"]["factor"] = "hunt-crossley"
    return mechanism_from(data, str(SPEC), restitution=restitution, friction=friction)


def stored_energy(mechanism: SliderCrank, penetration: np.ndarray) -> np.ndarray:
    """Return the elastic energy in J at penetrations in m."""
    contact = mechanism.joint
    delta = np.linspace(0, 1.01 * 1e3 * max(penetration.max(), 1e-6), 4001)  # mm
    force = np.nan_to_num(contact.law.load(delta, contact.pair)) * contact.pair.length
    energy = 1e-3 * cumulative_trapezoid(force, delta, initial=0.0)
    return np.interp(np.maximum(penetration, 0) * 1e3, delta, energy)


def statistics(mechanism: SliderCrank, run, first: int, revolutions: int) -> Statistics:
    """Return the statistics of a run of ours or of Exudyn's; the loss is what the drive puts in."""
    grid = np.linspace(first, revolutions, 400_000 * (revolutions - first)) * mechanism.period
    depth = np.interp(grid, run.time, run.penetration)
    stored = run.kinetic_energy + stored_energy(mechanism, run.penetration)
    gain = np.diff(np.interp(grid[[0, -1]], run.time, run.drive_work - stored))[0]
    return Statistics(
        float((depth > 0).mean()),
        float(1e6 * depth[depth > 0].mean()),
        float(gain / (revolutions - first)),
    )


def imbalance(mechanism: SliderCrank, run) -> float:
    """Return the largest error of the balance of energy of a run with our joint, in J."""
    stored = run.kinetic_energy + stored_energy(mechanism, run.penetration) + run.dissipated
    return float(np.abs(stored - stored[0] - run.drive_work).max())
