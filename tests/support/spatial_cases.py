"""Spatial joints and random motions in all kinds of contact."""

from functools import cache
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from cylcontact.files.spec import read_toml
from cylcontact.mechanism import SpatialJoint, SpatialState
from tests.support.spec_files import changed

EXAMPLE = read_toml(Path(__file__).resolve().parents[2] / "datasets/spatial_joint.toml")


def joint_for(**changes):
    """Return the example's joint with changes."""
    return SpatialJoint.from_data(changed(EXAMPLE, changes))


def body(position=(0.0, 0.0, 0.0), rotation=None, velocity=(0.0, 0.0, 0.0), spin=(0.0, 0.0, 0.0)):
    """Return the thirteen numbers of a body."""
    rotation = Rotation.identity() if rotation is None else rotation
    return np.concatenate([position, rotation.as_quat(scalar_first=True), velocity, spin])


FIXED = body()


def motions(joint, rows, seed=0):
    """Return impact rates and motions of a pin: free, on one rim, two rims or all its length.

    Some faces are touched too if there are any, and some states know no contact yet.
    """
    sizes = joint.planar.in_mm, joint.planar.radial, joint.spec.length / 2
    return tuple(part.copy() for part in _motions(rows, seed, *sizes))


@cache
def _motions(rows, seed, mm, radial, half):
    rng = np.random.default_rng(seed)
    pins, rates = np.empty((rows, 13)), np.zeros((rows, 4))
    for pin, rate in zip(pins, rates, strict=True):
        heading, towards = rng.uniform(0, 2 * np.pi, 2)
        share = rng.choice([0.0, 1e-6, *rng.uniform(0.01, 1.0, 4), rng.uniform(0.97, 1.02)])
        depth = rng.choice([-0.1, *10 ** rng.uniform(-2.5, -0.7, 5)])
        # |e| at the deeper rim is `reach`, and that of its part from the tilt `leaning`.
        reach, leaning = radial * (1 + depth), radial * share
        leaning = min(leaning, reach)
        beside = leaning * abs(np.sin(towards - heading))
        away = np.sqrt(reach**2 - leaning**2 + beside**2) - beside
        axial = rng.uniform(-0.11, 0.11)
        position = [away * np.cos(towards), away * np.sin(towards), axial]
        tilt = leaning / half
        turn = Rotation.from_rotvec([tilt * np.cos(heading), tilt * np.sin(heading), 0.0])
        turn = turn * Rotation.from_rotvec([0, 0, rng.uniform(0, 6)])
        velocity, spin = rng.normal(0, 50, 3), rng.normal(0, 5, 3)
        pin[:] = body(np.array(position) / mm, turn, velocity / mm, spin)
        rate[:] = np.where(rng.random(4) < 0.3, 0.0, rng.uniform(1, 100, 4) / mm)
    return rates, pins


def run_library(joint, rates, bearing, pins):
    """Return the 25 numbers of each wrench and the 4 accepted impact rates."""
    state = SpatialState(rates)
    w = joint.evaluate(state, bearing, pins)
    parts = [part.reshape(len(pins), -1) for part in w]
    return np.hstack([*parts, joint.accept(state, bearing, pins).impact_rate])
