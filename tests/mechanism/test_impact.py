"""An isolated impact, run like any other contact, against the closed form of its restitution."""

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, dissipation
from cylcontact.laws import LAWS, Johnson, LankaraniNikravesh
from cylcontact.mechanism import LawDomainError, isolated_impact

STEEL = Material("steel", E=207e3, nu=0.3)
PAIRS = {dR: CylinderPair.internal(10.0, 10.0 - dR, STEEL, 10.0) for dR in (0.5, 0.02)}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("dR", "speed"), [(0.5, 1.0), (0.02, 0.2)])
@pytest.mark.parametrize("restitution", [0.5, 0.9, 1.0])
def test_every_law_gives_the_restitution_of_the_closed_form(law, dR, speed, restitution):
    chi = float(dissipation.exact_factor(restitution))
    impact = isolated_impact(LAWS[law](), PAIRS[dR], chi, 0.14, speed)
    assert impact.restitution == pytest.approx(restitution, abs=1e-6)
    lost = 0.5 * 0.14 * speed**2 * (1 - restitution**2)
    assert impact.dissipated == pytest.approx(lost, abs=1e-6 * 0.14 * speed**2)


@pytest.mark.parametrize("name", dissipation.FACTORS)
def test_every_factor_gives_the_restitution_that_it_achieves(name):
    chi = float(dissipation.hysteresis_factor(name)(0.7))
    impact = isolated_impact(LAWS["enhanced"](), PAIRS[0.5], chi, 0.14, 1.0)
    achieved = float(dissipation.achieved_restitution(chi))
    assert impact.restitution == pytest.approx(achieved, abs=1e-6)


def test_an_elastic_impact_of_a_power_law_has_the_textbook_depth_and_duration():
    """Hertz's: m·v²/2 = K·δⁿ⁺¹/(n + 1), and T = 2.9433·δ_max/v for n = 1.5."""
    pair, mass, speed = PAIRS[0.5], 0.14, 1.0
    impact = isolated_impact(LankaraniNikravesh(), pair, 0.0, mass, speed)
    K = float(LankaraniNikravesh().factor(pair)) * 10.0 * 1000**1.5  # N per m^1.5
    depth = (2.5 * mass * speed**2 / (2 * K)) ** 0.4
    assert impact.max_penetration == pytest.approx(depth, rel=1e-6)
    assert impact.duration == pytest.approx(2.943275 * depth / speed, rel=1e-6)


def test_an_impact_too_hard_for_its_law_is_told():
    with pytest.raises(LawDomainError, match=r"10\.83 µm and the limit is 10\.83 µm"):
        isolated_impact(Johnson(), PAIRS[0.02], 0.1, 10.0, 1.0)


@pytest.mark.parametrize(("mass", "speed", "key"), [(-1, 1, "mass"), (1, np.inf, "speed")])
def test_impossible_numbers_are_told(mass, speed, key):
    with pytest.raises(InputError, match=f"{key} = .*must be positive"):
        isolated_impact(Johnson(), PAIRS[0.5], 0.1, mass, speed)


def test_a_journal_that_the_damping_catches_is_told():
    with pytest.raises(InputError, match="does not come back in time"):
        isolated_impact(LAWS["enhanced"](), PAIRS[0.5], 1e4, 0.14, 1.0)
