"""Mechanisms for tests: the shipped specs, changed where a test needs it."""

import math
import tomllib
from itertools import product
from pathlib import Path

import numpy as np

from cylcontact.mechanism import contact, dop853, mechanism_from
from tests.spec_files import changed

ROOT = Path(__file__).resolve().parents[1]
SLIDER_CRANK = tomllib.loads((ROOT / "datasets/slider_crank.toml").read_text(encoding="utf-8"))
FOUR_BAR = tomllib.loads((ROOT / "datasets/four_bar.toml").read_text(encoding="utf-8"))
LAWS = ("lankarani-nikravesh", "johnson", "enhanced")
# The paper's: laws, clearances in mm, restitutions, friction coefficients.
CASES = list(product(LAWS, (0.5, 0.02), (1.0, 0.9), (0.0, 0.1)))


def slider_crank(law="enhanced", clearance=0.5, restitution=0.9, friction=0.1, spec=None):
    """Return the slider-crank for one of the paper's cases, or with changes to its spec."""
    data = changed(SLIDER_CRANK, spec or {})
    return mechanism_from(
        data, "slider-crank", law=law, clearance=clearance, restitution=restitution,
        friction=friction,
    )  # fmt: skip


# Every length, mass and angle out of the ordinary: an offset, inclined slide, centres of mass off
# the lines, gravity, an angle at the start.
ODD = {
    "gravity": [1.5, -9.81],
    "ground.points.pivot": [0.01, -0.02],
    "ground.points.slide": [0.03, 0.01],
    "bodies.crank.points": {"pivot": [-0.02, 0.003], "pin": [0.025, 0.01]},
    "bodies.rod.points": {"pin": [-0.05, -0.004], "eye": [0.07, 0.006]},
    "bodies.slider.points": {"pin": [0.004, -0.003]},
    "bodies.slider.guess": [0.16, 0.05, 20.0],
    "joints.slide.direction": 15.0,
    "joints.slide.angle": 20.0,
    "joints.drive.angle": 40.0,
}


class Equations:
    """The compiled right-hand side of a mechanism, called from Python in either mode."""

    def __init__(self, system):
        self.model, self.p = system.model, system.block.copy()
        m = self.p[int(self.p[contact.MODEL_START]) :]
        self.blocks = self.p, contact.law_of(self.p), m
        self.size = system.start.size - 5
        self.space = dop853.workspace(self.model, self.size, m)

    def rates(self, t, y):
        """Return the rates of coordinates and ledgers."""
        turn = dop853.crank(self.model, t, self.blocks[2])
        y = np.ascontiguousarray(y[: self.size], dtype=float)
        dop853.evaluate(self.model, t, *turn, y, 0, self.blocks, self.space)
        return self.space[0][0].copy()

    def gap(self, t, y):
        """Return δ in m and δ̇ in m/s."""
        turn = dop853.crank(self.model, t, self.blocks[2])
        y = np.ascontiguousarray(y[: self.size], dtype=float)
        e_x, e_y, u_x, u_y, *_ = dop853.motion(self.model, *turn, y, self.blocks[2], self.space[2])
        distance = math.hypot(e_x, e_y)
        rate = (e_x * u_x + e_y * u_y) / distance if distance > 0 else 0.0
        return distance - self.p[contact.CLEARANCE], rate
