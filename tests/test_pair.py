import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from mpmath import mp

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.pair import unusual_lengths
from tests.strategies import ROUNDING, gaps, materials, moduli, ratios


@given(moduli, ratios)
def test_E_star_of_equal_materials_is_E_over_two_one_minus_nu_squared(E, nu):
    pair = CylinderPair.from_dR("internal", 1.0, Material("any", E, nu))
    with mp.workdps(40):
        error = abs(mp.mpf(float(pair.E_star)) * 2 * (1 - mp.mpf(nu) ** 2) / mp.mpf(E) - 1)
    assert error < 6 * ROUNDING


@given(materials, materials)
def test_compliances_of_different_materials_add(one, other):
    pair = CylinderPair.from_dR("internal", 1.0, one, material_j=other)
    with mp.workdps(40):
        compliance = sum((1 - mp.mpf(m.nu) ** 2) / mp.mpf(m.E) for m in (one, other))
        error = abs(mp.mpf(float(pair.E_star)) * compliance - 1)
    assert error < 6 * ROUNDING


@given(materials, materials)
def test_E_star_does_not_depend_on_the_order_of_the_bodies(one, other):
    forward = CylinderPair.external(1.0, 2.0, one, material_j=other)
    backward = CylinderPair.external(2.0, 1.0, other, material_j=one)
    assert forward.E_star == backward.E_star


def test_dR_is_the_difference_of_the_radii_inside_and_their_sum_outside(steel):
    assert CylinderPair.internal(10.0, 9.5, steel).dR == 0.5
    assert CylinderPair.external(10.0, 9.5, steel).dR == 19.5


def test_a_plane_has_the_effective_radius_of_the_roller_and_no_finite_dR(steel):
    pair = CylinderPair.external([10.0, 20.0], np.inf, steel, 5.0, Material("brass", 1e5, 0.34))
    assert pair.is_flat
    assert np.isinf(pair.dR).all()
    assert pair.R.tolist() == [10.0, 20.0]
    assert CylinderPair.external(3.0, [np.inf, np.inf], steel).R.tolist() == [3.0, 3.0]
    assert pickle.loads(pickle.dumps(pair)) == pair == replace(pair)
    assert pair != CylinderPair.external([10.0, 20.0], 5.0, steel, 5.0, pair.material_j)
    assert "R_j=inf" in repr(pair)
    assert "R_j, roller j (mm)</th><td>inf" in pair._repr_html_()
    assert not unusual_lengths(pair)


@pytest.mark.parametrize(
    ("lengths", "key"),
    [
        ({"dR": 5.0, "R_i": 10.0, "R_j": np.inf}, "dR"),
        ({"dR": np.inf, "R_i": 10.0, "R_j": 5.0}, "dR"),
        ({"dR": np.inf, "R_i": 10.0}, "dR"),
        ({"dR": np.inf, "R_j": np.inf}, "dR"),
        ({"dR": np.inf, "R_i": np.inf, "R_j": np.inf}, "R_i"),
        ({"dR": [15.0, np.inf], "R_i": 10.0, "R_j": [5.0, np.inf]}, "dR"),
    ],
)
def test_a_plane_is_refused_unless_all_its_lengths_say_so(steel, lengths, key):
    with pytest.raises(InputError) as caught:
        CylinderPair("external", material_i=steel, material_j=steel, **lengths)
    assert caught.value.key == key
    with pytest.raises(InputError, match="must be positive and finite"):
        CylinderPair("internal", material_i=steel, material_j=steel, **lengths | {"dR": np.inf})


def test_E_star_is_computed_once_and_cannot_be_changed(pairs):
    family = Material("family", E=[1e5, 2e5, 3e5], nu=0.3)
    pair = CylinderPair.internal(10.0, 9.0, family)
    assert pair.E_star is pair.E_star
    with pytest.raises(ValueError, match="read-only"):
        pair.E_star[0] = 1.0
    assert replace(pair, material_j=pairs.material_j).E_star.tolist() != pair.E_star.tolist()


def test_R_is_the_product_of_the_radii_over_dR(steel):
    assert CylinderPair.internal(10.0, 9.5, steel).R == 190.0
    assert CylinderPair.external(10.0, 9.5, steel).R == 95.0 / 19.5


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


def test_from_dR_alone_knows_no_radii(steel):
    pair = CylinderPair.from_dR("external", 20.0, steel, length=3.0)
    assert (pair.R_i, pair.R_j, pair.length) == (None, None, 3.0)


def test_one_material_serves_both_bodies_unless_the_second_is_given(steel):
    brass = Material("brass", 100e3, 0.34)
    for build in (CylinderPair.internal, CylinderPair.external):
        alone, mixed = build(10.0, 9.0, steel), build(10.0, 9.0, steel, material_j=brass)
        assert (alone.material_i, alone.material_j) == (steel, steel)
        assert (mixed.material_i, mixed.material_j) == (steel, brass)


def test_pin_and_hole_are_other_names_of_the_materials(steel):
    brass = Material("brass", 100e3, 0.34)
    expected = CylinderPair.internal(10.0, 9.0, steel, 5.0, brass)
    assert CylinderPair.internal(10.0, 9.0, length=5.0, pin=brass, hole=steel) == expected
    of_dR = CylinderPair.from_dR("internal", 1.0, pin=brass, hole=steel, length=5.0, R_i=10.0)
    assert of_dR == expected


def test_arrays_of_radii_and_materials_broadcast(steel):
    family = Material("family", E=[1e5, 2e5, 3e5], nu=0.3)
    pair = CylinderPair.internal([[10.0], [20.0]], 9.0, steel, material_j=family)
    assert pair.dR.shape == pair.R.shape == (2, 1)
    assert pair.E_star.shape == (3,)
    np.testing.assert_array_equal(pair.R, [[90.0], [180.0 / 11.0]])


def test_single_numbers_give_numpy_scalars(pair):
    assert type(pair.E_star) is type(pair.R) is type(pair.dR) is np.float64


@pytest.mark.parametrize(
    ("change", "equal"),
    [
        ({}, True),
        ({"R_i": np.array([10, 20]), "R_j": np.array([9, 18])}, True),
        ({"R_j": [9.0, 18.5]}, False),
        ({"R_i": 30.0}, False),
        ({"length": 5.0}, False),
        ({"material_j": Material("steel", 207e3, 0.31)}, False),
    ],
)
def test_pairs_are_equal_when_all_their_values_are(change, equal):
    values = {"R_i": [10.0, 20.0], "R_j": [9.0, 18.0], "material": Material("steel", 207e3, 0.3)}
    assert (CylinderPair.internal(**values) == CylinderPair.internal(**values | change)) is equal


def test_radii_and_the_contact_are_part_of_what_makes_pairs_equal(steel):
    bare, outside = (CylinderPair.from_dR(c, [1.0, 2.0], steel) for c in ("internal", "external"))
    with_radii = CylinderPair.internal([10.0, 20.0], [9.0, 18.0], steel)
    assert with_radii != bare != with_radii
    assert bare != outside


def test_a_pair_survives_pickling(pairs):
    assert pickle.loads(pickle.dumps(pairs)) == pairs


def test_a_pair_cannot_be_changed_and_has_no_hash_because_it_may_hold_arrays(pair):
    with pytest.raises(TypeError, match="unhashable"):
        hash(pair)
    with pytest.raises(AttributeError, match="cannot assign to field 'dR'"):
        pair.dR = 1.0


# --- plane strain and plane stress --------------------------------------------------------------


@given(materials, materials)
def test_in_plane_stress_the_compliances_are_those_of_E(one, other):
    pair = CylinderPair.from_dR("internal", 1.0, one, material_j=other, plane="stress")
    assert 1 / pair.E_star == pytest.approx(1 / one.E + 1 / other.E, rel=4 * ROUNDING)


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


def test_a_soft_pin_has_positive_parameters(steel):
    pair = CylinderPair.from_dR("internal", 1.0, steel, material_j=Material("soft", 1e3, 0.3))
    assert pair.alpha > 0.9
    assert pair.beta > 0.2
    equal = CylinderPair.from_dR("internal", 1.0, steel)
    assert equal.alpha == equal.beta == 0


def test_the_plane_is_kept_and_shown_only_if_it_is_not_strain(steel):
    assert "plane" not in repr(CylinderPair.external(10.0, 9.0, steel))
    assert "plane" not in CylinderPair.external(10.0, 9.0, steel)._repr_html_()
    for pair in (
        CylinderPair.internal(10.0, 9.0, steel, plane="stress"),
        CylinderPair.external(10.0, 9.0, steel, plane="stress"),
        CylinderPair.from_dR("internal", 1.0, steel, plane="stress"),
    ):
        assert pair.plane == "stress"
        assert "length=None, plane='stress')" in repr(pair)
        assert "plane" in pair._repr_html_()
        assert pickle.loads(pickle.dumps(pair)) == pair


def test_an_unknown_plane_and_the_name_of_a_material_are_refused(steel):
    with pytest.raises(InputError, match=r"^CylinderPair: plane = 'bent': must be 'strain' or"):
        CylinderPair.internal(10.0, 9.0, steel, plane="bent")
    with pytest.raises(InputError, match=r"^CylinderPair: material_j = 'bronze': must be a Mater"):
        CylinderPair("internal", 0.1, steel, "bronze")


IN_ANY_PLANE = {"johnson", "persson", "conformal", "explicit", "winkler"} | {
    "parametric",
    "explicit-pair",
}


@pytest.mark.parametrize("name", laws.LAWS)
@pytest.mark.parametrize("method", ["load", "penetration", "stiffness", "max_load"])
def test_laws_that_are_stated_for_plane_strain_refuse_plane_stress(name, method, steel):
    law = laws.LAWS[name]()
    sheet = CylinderPair.internal(10.0, 9.5, steel, 10.0, plane="stress")
    arguments = (sheet,) if method == "max_load" else (1e-3, sheet)
    if name in IN_ANY_PLANE:
        # One material in plane stress is another in plane strain, with the same E*.
        same = Material("same", steel.E, 0.0)
        strain = CylinderPair.internal(10.0, 9.5, same, 10.0)
        found = getattr(law, method)(*arguments)
        assert found == getattr(law, method)(*arguments[:-1], strain)
    else:
        with pytest.raises(InputError, match="plane = 'stress': must be 'strain'"):
            getattr(law, method)(*arguments)


# --- no pair contradicts itself -----------------------------------------------------------------


@pytest.mark.parametrize("contact", ["internal", "external"])
@pytest.mark.parametrize("changes", [{"dR": 0.6}, {"R_i": 11.0}, {"R_j": 9.4}])
def test_radii_and_clearance_agree_also_after_a_change(contact, changes, steel):
    pair = getattr(CylinderPair, contact)(10.0, 9.5, steel)
    with pytest.raises(InputError, match=r"CylinderPair: dR = .* contradicts R_i = .* and R_j"):
        replace(pair, **changes)
    assert replace(pair, dR=float(pair.dR) * (1 + 1e-9)).dR != pair.dR
    with pytest.raises(InputError, match="contradicts"):  # one of many
        replace(pair, dR=np.array([pair.dR, 1.1 * pair.dR]))


def test_an_array_that_its_owner_changes_changes_no_pair():
    gaps, radii, moduli = np.array([0.5, 1.0]), [10.0, 20.0], np.array([2e5, 1e5])
    pair = CylinderPair.from_dR("internal", gaps, Material("any", moduli, 0.3), R_i=radii)
    gaps[:], radii[0], moduli[:] = -1.0, 0.0, -1.0
    np.testing.assert_array_equal(pair.dR, [0.5, 1.0])
    np.testing.assert_array_equal(pair.R_i, [10.0, 20.0])
    np.testing.assert_array_equal(pair.material_i.E, [2e5, 1e5])
    with pytest.raises(ValueError, match="read-only"):
        pair.dR[0] = 2.0


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (lambda m: CylinderPair.internal([10.0, 11.0, 12.0], [9.0, 9.5], m), ""),
        (lambda m: CylinderPair.external([10.0, 11.0, 12.0], [9.0, 9.5], m), ""),
        (lambda m: CylinderPair.from_dR("internal", [0.1, 0.2], m, R_i=[1.0, 2.0, 3.0]), ""),
        (lambda m: CylinderPair("internal", [0.1, 0.2], m, m, R_i=[1.0, 2.0, 3.0]), ""),
        (lambda m: CylinderPair.internal("10", 9.0, m), "R_i"),
        (lambda m: CylinderPair.internal(10.0, None, m), "R_j"),
        (lambda m: CylinderPair.internal(10.0, 9.0 + 1j, m), "R_j"),
        (lambda m: CylinderPair.internal([[10.0], [10.0, 11.0]], 9.0, m), "R_i"),
        (lambda m: CylinderPair.internal(10.0, 9.0, m, length="long"), "length"),
        (lambda m: CylinderPair.from_dR("internal", None, m), "dR"),
        (lambda _: Material("m", [207e3, 70e3], [0.3, 0.3, 0.3]), ""),
        (lambda _: Material("m", 207e3, "0.3"), "nu"),
        (lambda _: Material("m", 207e3, 0.3, "250"), "yield_stress"),
    ],
)
def test_what_is_no_number_and_lists_of_unlike_lengths_are_refused(steel, make, key):
    with pytest.raises(InputError) as caught:
        make(steel)
    assert caught.value.key == key
    assert len(str(caught.value).splitlines()) == 1
