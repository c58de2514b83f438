"""Compiled scalar laws: tables, use inside compiled code, refusals; see also test_every_law.py."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cylcontact import CylinderPair, Material, laws
from cylcontact.laws.kernels import TABLE, kernel, kernel_load
from cylcontact.laws.tabulated import TABLE_ERROR

STEEL = Material("steel", E=207e3, nu=0.3)
PAIRS = {
    "wide": CylinderPair.internal(R_i=10.0, R_j=9.5, material=STEEL, length=10.0),
    "tight": CylinderPair.internal(R_i=10.0, R_j=9.98, material=STEEL, length=10.0),
}


def loads(made, deltas):
    return np.array([kernel_load(made.kind, made.parameters, delta) for delta in deltas])


# --- tables -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class TwoSprings:
    """A law of one's own: soft at first, stiffer from a tenth of ΔR on, with a kink there."""

    first: float = 1e4
    second: float = 5e4
    name = "two springs"

    def load(self, penetration, pair):
        delta = np.asarray(penetration, dtype=float)
        kink = pair.dR / 10
        return self.first * delta + (self.second - self.first) * np.maximum(delta - kink, 0)

    def stiffness(self, penetration, pair):
        return np.where(np.asarray(penetration) < pair.dR / 10, self.first, self.second)

    def max_penetration(self, pair):
        return np.float64(2 * pair.dR)


@dataclass(frozen=True)
class Overridden(laws.Johnson):
    """Johnson's law with another load: no longer the formula that the kernel knows."""

    def load(self, penetration, pair):
        return 2 * super().load(penetration, pair)

    def stiffness(self, penetration, pair):
        return 2 * super().stiffness(penetration, pair)


@given(part=st.floats(1e-12, 1.999))
def test_a_law_of_ones_own_is_tabulated_to_its_end(part):
    law, pair = TwoSprings(), PAIRS["wide"]
    made = TWO_SPRINGS
    delta = part * pair.dR
    assert made.max_penetration == 2 * pair.dR
    actual = kernel_load(made.kind, made.parameters, delta)
    assert actual == pytest.approx(float(law.load(delta, pair)), rel=TABLE_ERROR)


TWO_SPRINGS = kernel(TwoSprings(), PAIRS["wide"])


def test_a_subclass_with_a_load_of_its_own_is_tabulated_up_to_its_vertical_tangent():
    law, pair = Overridden(), PAIRS["tight"]
    made = kernel(law, pair)
    assert made.kind == TABLE
    end = float(law.max_penetration(pair))
    assert made.max_penetration == end
    deltas = end * np.array([1e-20, 1e-3, 0.5, 0.99, 1 - 1e-6, 1 - 1e-11])
    np.testing.assert_allclose(loads(made, deltas), law.load(deltas, pair), rtol=TABLE_ERROR)
    assert np.isnan(kernel_load(made.kind, made.parameters, end * (1 + 1e-9)))
