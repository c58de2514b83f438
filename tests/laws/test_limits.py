import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp
from scipy.optimize import brentq

from cylcontact import CylinderPair, Material, limits
from tests.support.strategies import ROUNDING, gaps, loads, materials

ALUMINIUM = Material("aluminium", E=69e3, nu=0.33, yield_stress=276.0)
TITANIUM = Material("titanium", E=120e3, nu=0.34, yield_stress=830.0)

radii_pairs = st.builds(
    lambda contact, R_j, ratio, one, other: getattr(CylinderPair, contact)(
        ratio * R_j, R_j, one, material_j=other
    ),
    st.sampled_from(["internal", "external"]), gaps, st.floats(1.001, 100.0), materials, materials,
)  # fmt: skip


# --- Eq 7 and Fig 7: Hertz and yield ----------------------------------------------------------


@given(radii_pairs, loads)
def test_hertz_stress_is_the_peak_of_the_elliptic_pressure_that_carries_the_load(pair, load):
    """Half width b = 2√(fR/(πE*)); an ellipse of half axes b and p0 has the area π·b·p0/2 = f."""
    with mp.workdps(40):
        bodies = (pair.material_i, pair.material_j)
        E_star = 1 / sum((1 - mp.mpf(m.nu) ** 2) / mp.mpf(m.E) for m in bodies)
        R = mp.mpf(pair.R_i) * mp.mpf(pair.R_j) / mp.mpf(float(pair.dR))
        b = 2 * mp.sqrt(load * R / (mp.pi * E_star))
        p0 = 2 * load / (mp.pi * b)
        error = abs(mp.mpf(float(limits.hertz_stress(load, pair))) / p0 - 1)
    assert error < 6 * ROUNDING


def test_the_paper_s_yield_load_is_the_closed_form_of_fig_7():
    for dR in (0.001, 0.0075, 0.05, 0.5, 2.0):
        pair = CylinderPair.from_dR("internal", dR, ALUMINIUM, R_i=10.0)
        E_star = 69e3 / (2 * (1 - 0.33**2))
        expected = math.pi * 276.0**2 * 10.0 * (10.0 - dR) / (E_star * dR)
        assert limits.yield_load(pair, "Hertz") == pytest.approx(expected, rel=2e-15)
    # The weaker of two materials counts unless a yield stress is given.
    mixed = CylinderPair.internal(10.0, 9.9, TITANIUM, material_j=ALUMINIUM)
    own = limits.yield_load(mixed, "Hertz")
    assert own == limits.yield_load(mixed, "Hertz", 276.0)
    assert limits.yield_load(mixed, "Hertz", 552.0) == pytest.approx(4 * own, rel=1e-15)


# --- Eq 8, Figs 8 and 9: where Johnson's law ends ---------------------------------------------


def test_johnsons_limit_loads_are_those_of_the_paper():
    for material, dR, paper in ((ALUMINIUM, [0.0075, 0.01], [494, 658]), (TITANIUM, 0.0075, 865)):
        pair = CylinderPair.from_dR("internal", dR, material)
        assert limits.johnson_limit_load(pair).round().tolist() == paper


# --- where the two limits meet ----------------------------------------------------------------


# A pin that is as stiff as the hole, and as strong or stronger.
HARD = replace(ALUMINIUM, name="hard aluminium", yield_stress=500.0)


@pytest.mark.parametrize("pin", [ALUMINIUM, TITANIUM, HARD], ids=lambda m: m.name)
@pytest.mark.parametrize("R_i", [5.0, 10.0, 100.0])
def test_yield_and_johnsons_limit_meet_at_the_clearance_that_a_root_finder_finds(R_i, pin):
    hole = ALUMINIUM if pin == HARD else pin

    def excess(dR):
        pair = CylinderPair.from_dR("internal", dR, hole, R_i=R_i, material_j=pin)
        return math.log(limits.johnson_limit_load(pair) / limits.yield_load(pair, "Hertz"))

    root = brentq(excess, 1e-6 * R_i, 0.5 * R_i, xtol=1e-15 * R_i)
    pair = CylinderPair.from_dR("internal", 1.0, hole, R_i=2 * R_i, material_j=pin)
    clearance = limits.elastic_limit_clearance(R_i, pair)
    assert clearance == pytest.approx(root, rel=1e-12)
    assert excess(0.5 * clearance) < 0 < excess(2 * clearance)


# --- shapes -----------------------------------------------------------------------------------


def test_hertz_pressure_carries_the_load_and_ends_at_the_half_width(pair):
    load = np.array([1.0, 100.0, 1e4])
    half_width = limits.hertz_half_width(load, pair)
    x = np.linspace(-1, 1, 20001)[:, None] * half_width
    carried = np.trapezoid(limits.hertz_pressure(x, load, pair), x, axis=0)
    assert carried == pytest.approx(load, rel=1e-6)
    assert limits.hertz_pressure(1.0001 * half_width, load, pair) == pytest.approx(0.0)
    assert limits.hertz_pressure(0.0, load, pair) == pytest.approx(
        limits.hertz_stress(load, pair), rel=1e-15
    )
