"""Slider-cranks for tests: the shipped spec, changed where a test needs it."""

import math
import tomllib
from itertools import product
from pathlib import Path

import numba
import numpy as np

from cylcontact.mechanism import mechanism_from
from cylcontact.mechanism import slider_crank as equations
from tests.support.spec_files import changed

ROOT = Path(__file__).resolve().parents[2]
SPEC = ROOT / "datasets/slider_crank.toml"
SLIDER_CRANK = tomllib.loads(SPEC.read_text(encoding="utf-8"))
LAWS = ("lankarani-nikravesh", "johnson", "enhanced")
# The paper's: laws, clearances in mm, restitutions, friction coefficients.
CASES = list(product(LAWS, (0.5, 0.02), (1.0, 0.9), (0.0, 0.1)))
# Every number out of the ordinary: an offset, centres of mass, gravity, an angle at the start.
ODD = {
    "offset": 12.0,
    "angle": 40.0,
    "gravity": [1.5, -9.81],
    "crank.centre": 0.3,
    "rod.centre": 0.42,
}


def slider_crank(law="enhanced", clearance=0.5, restitution=0.9, friction=0.1, spec=None, **more):
    """Return the slider-crank for one of the paper's cases, or with changes to its spec."""
    return mechanism_from(
        changed(SLIDER_CRANK, spec or {}), "slider-crank", law=law, clearance=clearance,
        restitution=restitution, friction=friction, **more,
    )  # fmt: skip


def yields_at(stress):
    """Return the change of the spec that gives pin and bearing a yield stress in MPa."""
    return {f"joint.{body}.yield_stress": stress for body in ("bearing", "pin")}


@numba.njit(error_model="numpy")
def _rates(t, y, out, joint, law, crank):
    equations.derivatives(equations.crank_turn(t, crank), y, out, joint, law, crank)


class Equations:
    """The compiled right-hand side of a slider-crank, called from Python in either mode."""

    def __init__(self, mechanism, beyond="tangent"):
        self.joint = mechanism.joint.record(beyond)
        self.law, self.crank = mechanism.joint.kernel.parameters, mechanism.record

    def rates(self, t, y):
        """Return the rates of coordinates and ledgers."""
        out = np.zeros(equations.RATES)
        _rates(t, np.ascontiguousarray(y, dtype=float), out, self.joint, self.law, self.crank)
        return out

    def gap(self, y):
        """Return δ in m and δ̇ in m/s."""
        distance = math.hypot(y[0], y[1])
        rate = (y[0] * y[2] + y[1] * y[3]) / distance if distance > 0 else 0.0
        return distance - self.joint["clearance"], rate
