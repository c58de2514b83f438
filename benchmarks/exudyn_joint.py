"""The paper's slider-crank with three contacts: `python -m benchmarks.exudyn_joint` (two minutes).

Exudyn with its own contact, Exudyn with our exported joint, and our mechanism: statistics over
three revolutions after the first, balance of energy, and processor time per revolution. All have
the enhanced law as a power law, a clearance of 0.5 mm and the dissipation of Hunt and Crossley.
"""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.integrate import cumulative_trapezoid

from benchmarks.exudyn_peer import joint_of, module_of, simulate_in_exudyn
from benchmarks.mechanism import SPEC
from cylcontact.mechanism import Mechanism, mechanism_from, simulate
from cylcontact.spec import read_toml

FIRST, REVOLUTIONS, STEPS = 1, 4, (1e-6, 2.5e-7)
# Restitution and friction.
CASES = ((1.0, 0.0), (0.9, 0.0), (0.9, 0.1))


class Statistics(NamedTuple):
    """Share of time in contact, mean penetration there (µm), energy lost per revolution (J)."""

    contact: float
    depth: float
    loss: float


def slider_crank(restitution: float, friction: float) -> Mechanism:
    """Return the mechanism."""
    data = read_toml(SPEC)
    for joint in data["joint"]:
        if "law" in joint:
            joint["dissipation"]["factor"] = "hunt-crossley"
    return mechanism_from(data, str(SPEC), restitution=restitution, friction=friction)


def stored_energy(mechanism: Mechanism, penetration: np.ndarray) -> np.ndarray:
    """Return the elastic energy in J at penetrations in m."""
    contact = mechanism.clearance.contact
    delta = np.linspace(0, 1.01 * 1e3 * max(penetration.max(), 1e-6), 4001)  # mm
    force = np.nan_to_num(contact.law.load(delta, contact.pair)) * contact.pair.length
    energy = 1e-3 * cumulative_trapezoid(force, delta, initial=0.0)
    return np.interp(np.maximum(penetration, 0) * 1e3, delta, energy)


def statistics(mechanism: Mechanism, run, first=FIRST, revolutions=REVOLUTIONS) -> Statistics:
    """Return the statistics of a run of ours or of Exudyn's; the loss is what the drive puts in."""
    grid = np.linspace(first, revolutions, 400_000 * (revolutions - first)) * mechanism.period
    depth = np.interp(grid, run.time, run.penetration)
    held = run.kinetic_energy + stored_energy(mechanism, run.penetration)
    gain = np.diff(np.interp(grid[[0, -1]], run.time, run.drive_work - held))[0]
    return Statistics(
        float((depth > 0).mean()),
        float(1e6 * depth[depth > 0].mean()),
        float(gain / (revolutions - first)),
    )


def imbalance(mechanism: Mechanism, run) -> float:
    """Return the largest error of the balance of energy of a run with our joint, in J."""
    held = run.kinetic_energy + stored_energy(mechanism, run.penetration) + run.dissipated
    return float(np.abs(held - held[0] - run.drive_work).max())


def table() -> pd.DataFrame:
    """Simulate all; return a row for each."""
    rows = []
    for restitution, friction in CASES:
        mechanism = slider_crank(restitution, friction)
        started = time.process_time()
        ours = simulate(mechanism, revolutions=REVOLUTIONS, tolerance=1e-8)
        seconds = time.process_time() - started
        case = restitution, friction
        balance = float(np.abs(ours.energy_error).max())
        rows.append((*case, "cylcontact", "", *statistics(mechanism, ours), balance, seconds))
        joint, end = module_of(joint_of(mechanism)), REVOLUTIONS * mechanism.period
        for step in STEPS:
            own = simulate_in_exudyn(mechanism, ours, end, step)
            with_joint = simulate_in_exudyn(mechanism, ours, end, step, joint)
            balance = imbalance(mechanism, with_joint)
            for who, run, error in (("Exudyn", own, np.nan), ("both", with_joint, balance)):
                numbers = (*statistics(mechanism, run), error, run.seconds)
                rows.append((*case, who, f"{1e6 * step:g}", *numbers))
    columns = ("e", "friction", "contact", "step (µs)", "in contact", "depth (µm)", "loss (J)")
    frame = pd.DataFrame(rows, columns=[*columns, "balance (J)", "CPU (s)"])
    frame["CPU (s)"] /= REVOLUTIONS
    return frame


if __name__ == "__main__":
    print(table().to_string(index=False, float_format="{:.3g}".format))
