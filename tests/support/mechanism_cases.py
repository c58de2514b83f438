"""Mechanisms for tests: the shipped specs, changed where a test needs it."""

import math
import tomllib
from itertools import product
from pathlib import Path

import numba
import numpy as np

from cylcontact.mechanism import Settings, dop853, mechanism_from
from cylcontact.mechanism.run import Run
from tests.support.spec_files import changed

ROOT = Path(__file__).resolve().parents[2]
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
    "joint.slide.direction": 15.0,
    "joint.slide.angle": 20.0,
    "joint.drive.angle": 40.0,
}


# The wrist pin's bearing in the slider.
TURNED = {"joint.wrist-pin.between": ["slider.pin", "rod.eye"]}


def yields_at(stress):
    """Return the change of the spec that gives pin and bearing a yield stress in MPa."""
    return {f"joint.wrist-pin.{body}.yield_stress": stress for body in ("bearing", "pin")}


# A second clearance, as that of the wrist pin.
CLEARANCE = {
    key: value
    for key, value in next(j for j in SLIDER_CRANK["joint"] if "law" in j).items()
    if key not in ("name", "between")
}


def with_clearance(spec, name, **changes):
    """Return a spec with the clearance of the wrist pin at another joint as well."""
    return changed(
        spec, {f"joint.{name}.{key}": value for key, value in (CLEARANCE | changes).items()}
    )


@numba.njit(error_model="numpy")
def _rates_at(t, y, model):
    dop853.rates_at(t, dop853.clock(t, model.crank), y, 0, model)


@numba.njit(error_model="numpy")
def _motion(t, y, joint, crank, pin, linkage):
    return dop853.motion(dop853.clock(t, crank), y, joint, crank, pin, linkage)


class Equations:
    """The compiled right-hand side of a mechanism, called from Python in either mode."""

    def __init__(self, mechanism, method="minimal", beyond="stop"):
        self.run = Run.start(mechanism, Settings(method, 1e-8, 1e-4, beyond))
        self.size = self.run.scale.size
        self.space = np.zeros((dop853.STAGES + 1, self.run.state.values.size))

    @property
    def joint(self):
        """The one joint with clearance, a record."""
        return self.run.model.joints[0]

    def rates(self, t, y):
        """Return the rates of coordinates and ledgers."""
        run, y = self.run, np.ascontiguousarray(y[: self.size], dtype=float)
        model = run.model._replace(rates=self.space, stage=y)
        _rates_at(t, y, model)
        return self.space[0].copy()

    def gap(self, t, y):
        """Return δ in m and δ̇ in m/s."""
        run, y = self.run, np.ascontiguousarray(y[: self.size], dtype=float)
        m = run.model
        e_x, e_y, u_x, u_y, *_ = _motion(t, y, self.joint, m.crank, m.pin, m.linkage)
        distance = math.hypot(e_x, e_y)
        rate = (e_x * u_x + e_y * u_y) / distance if distance > 0 else 0.0
        return distance - self.joint["clearance"], rate
