"""Mechanisms for tests: the shipped specs, changed where a test needs it."""

import tomllib
from itertools import product
from pathlib import Path

from cylcontact.mechanism import mechanism_from
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
