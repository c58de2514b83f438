import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from mpmath import mp

from cylcontact import CylinderPair, Material
from tests.support.strategies import ROUNDING, gaps, materials

STEEL, BRASS = Material("steel", 207e3, 0.3), Material("brass", 100e3, 0.34)


# --- derived numbers ----------------------------------------------------------------------------


@given(materials, materials)
def test_compliances_add_in_any_order_with_nu_in_plane_strain_alone(one, other):
    pair = CylinderPair.external(1.0, 2.0, one, material_j=other)
    with mp.workdps(40):
        compliance = sum((1 - mp.mpf(m.nu) ** 2) / mp.mpf(m.E) for m in (one, other))
        error = abs(mp.mpf(float(pair.E_star)) * compliance - 1)
    assert error < 6 * ROUNDING
    assert CylinderPair.external(2.0, 1.0, other, material_j=one).E_star == pair.E_star
    sheet = replace(pair, plane="stress")
    assert 1 / sheet.E_star == pytest.approx(1 / one.E + 1 / other.E, rel=4 * ROUNDING)


@pytest.mark.parametrize("plane", ["strain", "stress"])
@given(materials, materials)
def test_dundurs_parameters_are_those_of_shear_modulus_and_kappa(plane, one, other):
    """Dundurs (1969) with body 1 the hole, from μ and κ; a swap of the bodies changes the sign."""
    pair = CylinderPair.from_dR("internal", 1.0, one, material_j=other, plane=plane)
    (mu_i, mu_j), (k_i, k_j) = ((m.E / (2 * (1 + m.nu)) for m in (one, other)), pair.kolosov)
    total = mu_j * (k_i + 1) + mu_i * (k_j + 1)
    alpha = (mu_i * (k_j + 1) - mu_j * (k_i + 1)) / total
    beta = (mu_i * (k_j - 1) - mu_j * (k_i - 1)) / total
    assert pair.alpha == pytest.approx(alpha, abs=8 * ROUNDING)
    assert pair.beta == pytest.approx(beta, abs=8 * ROUNDING)
    (w_i, w_j), swapped = pair.shares, CylinderPair.from_dR("internal", 1.0, other, material_j=one)
    assert w_i + w_j == pytest.approx(1)
    assert -w_i / 2 - ROUNDING <= pair.beta <= w_j / 2 + ROUNDING
    if plane == "strain":
        assert swapped.beta == -pair.beta


@pytest.mark.parametrize("contact", ["internal", "external"])
@given(gaps, gaps)
def test_from_dR_finds_the_radius_that_gives_its_dR(contact, one, other):
    assume(one != other)
    R_i, R_j = max(one, other), min(one, other)
    dR = R_i - R_j if contact == "internal" else R_i + R_j
    pair = CylinderPair.from_dR(contact, dR, Material("any", 1e5, 0.3), R_i=R_i)
    assert (pair.contact, pair.dR, pair.R_i) == (contact, dR, R_i)
    # ΔR has been rounded, and R_j may be the small one of two large numbers.
    assert pair.R_j == pytest.approx(R_j, rel=0, abs=2 * ROUNDING * dR)
    bare = CylinderPair.from_dR(contact, dR, pair.material_i, length=3.0)
    assert (bare.R_i, bare.R_j, bare.length) == (None, None, 3.0)


def test_neither_a_pair_nor_what_is_derived_from_it_can_be_changed():
    gaps = np.array([0.5, 1.0])
    pair = CylinderPair.from_dR("internal", gaps, Material("any", [2e5, 1e5], 0.3))
    gaps[:] = -1.0
    np.testing.assert_array_equal(pair.dR, [0.5, 1.0])
    for values in (pair.dR, pair.E_star, pair.beta, *pair.shares):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 2.0
    assert replace(pair, material_j=STEEL).E_star.tolist() != pair.E_star.tolist()


# --- which pair it is ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "equal"),
    [
        ({}, True),
        ({"R_i": np.array([10, 20]), "R_j": np.array([9, 18])}, True),
        ({"R_j": [9.0, 18.5]}, False),
        ({"plane": "stress"}, False),
        ({"material_j": Material("steel", 207e3, 0.31)}, False),
    ],
)
def test_pairs_are_equal_when_all_their_values_are(change, equal):
    values = {"R_i": [10.0, 20.0], "R_j": [9.0, 18.0], "material": STEEL}
    pair, other = CylinderPair.internal(**values), CylinderPair.internal(**values | change)
    assert (pair == other) is equal
    assert pickle.loads(pickle.dumps(other)) == replace(other) == other
    bare, outside = (CylinderPair.from_dR(c, [1.0, 2.0], STEEL) for c in ("internal", "external"))
    assert bare not in (pair, other, outside)
