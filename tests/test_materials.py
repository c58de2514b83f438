import numpy as np
import pytest
from hypothesis import given
from mpmath import mp

from cylcontact import InputError, Material
from cylcontact.materials import material_in_MPa
from tests.strategies import ROUNDING, moduli, ratios


@given(moduli, ratios)
def test_plane_strain_modulus_is_E_over_one_minus_nu_squared(E, nu):
    with mp.workdps(40):
        exact = mp.mpf(E) / (1 - mp.mpf(nu) ** 2)
        error = abs(mp.mpf(float(Material("any", E, nu).plane_strain_modulus)) / exact - 1)
    assert error < 4 * ROUNDING


def test_arrays_of_moduli_and_ratios_broadcast():
    family = Material("family", E=[[1e5], [2e5]], nu=[0.0, 0.3, 0.5])
    expected = np.array([[1e5], [2e5]]) / (1 - np.array([0.0, 0.09, 0.25]))
    np.testing.assert_allclose(family.plane_strain_modulus, expected, rtol=4 * ROUNDING)


@pytest.mark.parametrize("nu", [0.0, 0.5])
def test_poissons_ratio_may_take_both_ends_of_its_range(nu):
    assert material_in_MPa("end", 1.0, nu).plane_strain_modulus == 1 / (1 - nu**2)


@pytest.mark.parametrize(
    ("text", "E"),
    [("200 MPa", 200.0), (" 0.2GPa ", 200.0), ("207 GPa", 207e3), ("2e8 Pa", 200.0), ("2e5", 2e5)],
)
def test_a_modulus_may_come_with_its_unit(text, E):
    material = Material("any", text, 0.3)
    assert material.E == pytest.approx(E, rel=4 * ROUNDING)
    assert material == material_in_MPa("any", material.E, 0.3)


@pytest.mark.parametrize("text", ["0 GPa", "-2"])
def test_a_text_may_be_no_modulus_either(text):
    with pytest.raises(InputError, match="must be positive and finite; give it in MPa"):
        Material("any", text, 0.3)


def test_the_softest_bare_modulus_is_1000_mpa():
    assert Material("any", 1000, 0.3).E == 1000
    with pytest.raises(InputError, match="a bare number is in MPa"):
        Material("any", np.nextafter(1000, 0), 0.3)


def test_yield_stress_is_optional(steel):
    assert Material("unknown", E=207e3, nu=0.3).yield_stress is None
    assert steel.yield_stress == 250.0


@pytest.mark.parametrize(
    ("other", "equal"),
    [
        (Material("m", np.array([1e5, 2e5]), 0.3), True),
        (Material("m", [1e5, 2e5], 0.3), True),
        (Material("m", [1e5, 2e5], 0.31), False),
        (Material("m", [1e5, 3e5], 0.3), False),
        (Material("n", [1e5, 2e5], 0.3), False),
        (Material("m", [1e5, 2e5], 0.3, yield_stress=100.0), False),
        (Material("m", 1e5, 0.3), False),
        ("m", False),
    ],
)
def test_materials_are_equal_when_all_their_values_are(other, equal):
    assert (Material("m", np.array([1e5, 2e5]), 0.3) == other) is equal


def test_a_material_cannot_be_changed_and_has_no_hash_because_it_may_hold_arrays(steel):
    with pytest.raises(AttributeError, match="cannot assign to field 'E'"):
        steel.E = 1.0
    with pytest.raises(TypeError, match="unhashable"):
        hash(steel)
