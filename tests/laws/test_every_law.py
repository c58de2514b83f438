"""What every law of the package must satisfy; a new one is tested by its entry in `LAWS`."""

from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.fitting.adapters import ScaledLaw
from cylcontact.fitting.law_models import MODELS
from cylcontact.laws.kernels import TABLE, kernel, kernel_energy
from cylcontact.laws.tabulated import TABLE_ERROR
from tests.support.strategies import NOT_TOUCHING, ROUNDING

STEEL = Material("steel", E=207e3, nu=0.3)
BRONZE = Material("bronze", E=110e3, nu=0.34)
PAIRS = {
    "wide": CylinderPair.internal(R_i=10.0, R_j=9.5, material=STEEL, length=10.0),
    "tight": CylinderPair.internal(R_i=10.0, R_j=9.98, material=STEEL, length=10.0),
    "rollers": CylinderPair.external(R_i=10.0, R_j=25.0, material=STEEL, length=10.0),
}
# Every law with a name at pairs that it is for, laws with coefficients of one's own, two materials.
OWN = {
    "refitted": (laws.Enhanced({"a": 0.4, "b": 1.05, "n": 1.09}), "rollers"),
    "power K": (laws.PowerLaw(n=1.2, K=3e5), "wide"),
    "power K_star": (laws.PowerLaw(n=0.9, K_star=0.3), "rollers"),
    "power C": (laws.PowerLaw(n=1.0848, C=0.58), "tight"),
    "power by clearance": (laws.PowerClearance(0.88, 0.72, 1.13, -0.02, 0.01, 0.001), "tight"),
    "own constants": (laws.Explicit({"c": 1.4, "A": 0.36, "B": 3.0}), "wide"),
    "scaled, a table when compiled": (ScaledLaw(laws.Johnson(), 1.7, 1.1), "tight"),
}
CASES = [
    pytest.param(make(), pair, id=f"{name}-{which}")
    for name, make in laws.LAWS.items()
    for which, pair in PAIRS.items()
    if pair.contact in laws.contacts_of(name)
] + [pytest.param(law, PAIRS[which], id=name) for name, (law, which) in OWN.items()]
BRONZE_IN_STEEL = CylinderPair.internal(R_i=10.0, R_j=9.5, material=STEEL, material_j=BRONZE)
CASES += [
    pytest.param(law, BRONZE_IN_STEEL, id=f"{law.name}-steel on bronze")
    for law in (laws.Johnson(), laws.Conformal(), laws.Conformal(laws.Housing(R_o=50.0)))
]
every_case = pytest.mark.parametrize(("law", "pair"), CASES)


def reach(law, pair):
    """The end of a law in mm, or ten times ΔR."""
    return min(float(law.max_penetration(pair)), 10 * float(pair.dR))


# --- the NumPy form -----------------------------------------------------------------------------


@every_case
def test_load_increases_from_zero_to_the_largest_and_back(law, pair):
    end = reach(law, pair)
    deltas = np.concatenate([[0.0], np.geomspace(1e-12, 1, 1000) * end])
    loads = law.load(deltas, pair)
    np.testing.assert_allclose(law.penetration(loads, pair), deltas, rtol=1e-12)
    assert loads[0] == 0
    assert (np.diff(loads) > 0).all()
    assert loads[-1] <= law.max_load(pair) * (1 + 1e-12)
    if end == law.max_penetration(pair):
        assert loads[-1] == pytest.approx(float(law.max_load(pair)), rel=1e-12)
        assert np.isnan(law.load(end * (1 + 1e-9), pair))
        assert np.isnan(law.penetration(law.max_load(pair) * (1 + 1e-9), pair))


@every_case
def test_stiffness_is_the_derivative_of_the_load(law, pair):
    delta = np.geomspace(1e-6, 0.9, 40) * reach(law, pair)
    step = 1e-5 * delta
    slope = (law.load(delta + step, pair) - law.load(delta - step, pair)) / (2 * step)
    assert law.stiffness(delta, pair) == pytest.approx(slope, rel=1e-7)


@every_case
def test_bodies_that_do_not_touch_have_no_load_and_no_stiffness(law, pair):
    for ask in (law.load, law.stiffness):
        np.testing.assert_array_equal(ask(NOT_TOUCHING, pair), [0, 0, 0, np.nan])
    assert np.isnan(law.penetration(NOT_TOUCHING, pair)).all()
    assert law.load(0.0, pair) == law.penetration(0.0, pair) == 0
    # A power below one has a vertical tangent.
    assert law.stiffness(0.0, pair) == (np.inf if getattr(law, "n", 1) < 1 else 0)


@every_case
def test_values_broadcast_against_pairs_numbers_stay_numbers_and_arrays_arrays(law, pair):
    gaps = np.array([[1.0], [1.5], [2.0]]) * pair.dR
    many = CylinderPair.from_dR(pair.contact, gaps, STEEL, pair.length, pair.R_i)
    second = CylinderPair.from_dR(pair.contact, gaps[1, 0], STEEL, pair.length, pair.R_i)
    values = [-1.0, 1e-6, 2e-6, np.nan]
    for ask in (law.load, law.penetration, law.stiffness):
        answers = ask(values, many)
        expected = [ask == law.penetration, False, False, True]
        np.testing.assert_array_equal(np.isnan(answers), [expected] * 3)
        np.testing.assert_allclose(answers[1], ask(values, second), rtol=1e-14)
        assert type(ask(np.array(1e-6), pair)) is np.float64
        for shape in ((0,), (1,), (2, 0)):
            assert ask(np.full(shape, 1e-6), pair).shape == shape
    for limit in (law.max_load, law.max_penetration):
        assert limit(many).shape == (3, 1)
        assert type(limit(pair)) is np.float64


@every_case
def test_masked_arrays_and_shapes_that_do_not_go_together_are_refused(law, pair):
    gaps = np.array([1.0, 1.5, 2.0]) * pair.dR
    many = CylinderPair.from_dR(pair.contact, gaps, STEEL, pair.length, pair.R_i)
    masked = np.ma.array([1e-6, 2e-6], mask=[True, False])
    for ask in (law.load, law.penetration, law.stiffness):
        with pytest.raises(InputError, match="is a masked array; give values"):
            ask(masked, pair)
        with pytest.raises(InputError, match=r"do not go together: \w+ \(2,\), dR \(3,\)"):
            ask([1e-6, 2e-6], many)


IN_ANY_PLANE = {"johnson", "persson", "conformal", "explicit"}


@pytest.mark.parametrize("name", laws.LAWS)
def test_a_law_says_what_it_needs(name):
    law = laws.LAWS[name]()
    needs = getattr(law, "needs", ())
    assert law.name == name
    known = {"R_i": 10.0, "length": 12.0} if needs else {}
    for contact, dR in (("internal", 0.05), ("external", 25.0)):
        pair = CylinderPair.from_dR(contact, dR, STEEL, **known)
        if contact in law.contacts:
            assert 0 < law.penetration(1.0, pair) < 1
        else:
            with pytest.raises(InputError, match="hole"):
                law.penetration(1.0, pair)
    if needs:
        with pytest.raises(InputError, match="needs"):
            law.penetration(1.0, CylinderPair.from_dR("internal", 0.05, STEEL))
    else:
        assert laws.reference_law(law.name) == law
    sheet = CylinderPair.internal(10.0, 9.5, STEEL, 10.0, plane="stress")
    if name in IN_ANY_PLANE:  # one material in plane stress is another in strain, of the same E*
        strain = CylinderPair.internal(10.0, 9.5, Material("same", STEEL.E, 0.0), 10.0)
        assert law.load(1e-3, sheet) == law.load(1e-3, strain)
        return
    for ask in (law.load, law.penetration, law.stiffness):
        with pytest.raises(InputError, match="plane = 'stress': must be 'strain'"):
            ask(1e-3, sheet)


ROLLERS = CylinderPair.external(R_i=10.0, R_j=9.0, material=STEEL, length=12.0)
HOLE = CylinderPair.internal(R_i=10.0, R_j=9.5, material=STEEL, length=12.0)
NO_RADII = CylinderPair.from_dR("internal", 0.5, STEEL, length=12.0)
NO_LENGTH = CylinderPair.from_dR("internal", 0.5, STEEL, R_i=10.0)
MIXED = CylinderPair.from_dR("internal", 0.5, STEEL, material_j=BRONZE)
RADII, LENGTH = "needs both radii", "needs the axial length"
REFUSED = [
    (laws.Enhanced(laws.PUBLISHED["internal"]), ROLLERS, "are for internal contact and the pair"),
    (laws.Enhanced(laws.PUBLISHED["external"]), HOLE, "are for external contact and the pair is"),
    (laws.Liu(), ROLLERS, "pin in a hole"),
    (laws.Conformal(), ROLLERS, "must be internal: the law is for a pin in a hole"),
    (laws.Persson(), ROLLERS, "pair.contact = 'external': must be internal"),
    (laws.Johnson(), MIXED, RADII),
    (laws.LAWS["goldsmith"](), NO_RADII, RADII),
    (laws.LAWS["dubowsky-freudenstein"](), NO_RADII, RADII),
    (laws.LAWS["dubowsky-freudenstein"](), NO_LENGTH, LENGTH),
    (laws.LankaraniNikravesh(), NO_RADII, RADII),
    (laws.LankaraniNikravesh(), NO_LENGTH, LENGTH),
]


@pytest.mark.parametrize(
    ("law", "pair", "words"), REFUSED, ids=[f"{law.name}, {words}" for law, _, words in REFUSED]
)
def test_a_pair_that_is_not_of_the_law_is_refused_whatever_is_asked(law, pair, words):
    of_pair = (partial(ask, pair) for ask in (law.max_load, law.max_penetration))
    of_value = (partial(ask, 1e-3, pair) for ask in (law.load, law.penetration, law.stiffness))
    for ask in (*of_pair, *of_value):
        with pytest.raises(InputError, match=words):
            ask()


# --- the compiled form --------------------------------------------------------------------------


@every_case
def test_the_compiled_law_is_the_array_law(law, pair):
    made = kernel(law, pair)
    end = reach(law, pair)
    close = 1 - 10.0 ** -np.arange(1.0, 9.0)
    deltas = np.concatenate([np.geomspace(1e-25, 0.9, 300) * end, close * end])
    actual = np.array([made.load(delta) for delta in deltas])
    allowed = TABLE_ERROR if made.kind == TABLE else 12 * ROUNDING
    np.testing.assert_allclose(actual, law.load(deltas, pair), rtol=allowed)
    # Near the end of a logarithmic law, where it is infinite, the stiffness is as uncertain as
    # the penetration's own last digit makes it.
    left = 1 - deltas / law.max_penetration(pair)
    allowed = np.where(left < 0.09, 1e-6, 2e-8) if made.kind == TABLE else 20 * ROUNDING / left
    actual = np.array([made.stiffness(delta) for delta in deltas])
    exact = law.stiffness(deltas, pair)
    assert np.all(np.abs(actual - exact) <= allowed * exact)


@every_case
def test_the_stored_energy_is_the_integral_of_the_load(law, pair):
    made = kernel(law, pair)
    for deepest in np.array([1e-9, 1e-3, 0.3, 0.9]) * reach(law, pair):
        wanted, _ = quad(
            lambda s: 2 * s * made.load(s * s), 0.0, deepest**0.5, epsabs=0, epsrel=1e-11, limit=200
        )
        actual = kernel_energy(made.kind, made.parameters, deepest)
        assert actual == pytest.approx(wanted, rel=1e-7 if made.kind == TABLE else 1e-9, abs=0)


@every_case
def test_the_compiled_law_is_zero_without_contact_and_nan_beyond_its_end(law, pair):
    made = kernel(law, pair)
    beyond = [np.nan]
    if np.isfinite(made.max_penetration):
        beyond += [made.max_penetration * (1 + 1e-9), 10 * made.max_penetration]
    for ask in (made.load, made.stiffness):
        assert [ask(delta) for delta in (0.0, -0.0, -1e-9, -np.inf)] == [0, 0, 0, 0]
        assert np.isnan([ask(delta) for delta in beyond]).all()


@dataclass(frozen=True)
class TwoSprings:
    """A law of one's own: soft at first, stiffer from a tenth of ΔR on, with a kink there."""

    name = "two springs"

    def load(self, penetration, pair):
        delta = np.asarray(penetration, dtype=float)
        return 1e4 * delta + 4e4 * np.maximum(delta - pair.dR / 10, 0)

    def stiffness(self, penetration, pair):
        return np.where(np.asarray(penetration) < pair.dR / 10, 1e4, 5e4)

    def max_penetration(self, pair):
        return np.float64(2 * pair.dR)


@dataclass(frozen=True)
class Doubled(laws.Johnson):
    """Johnson's law with another load: no longer the formula that the kernel knows."""

    def load(self, penetration, pair):
        return 2 * super().load(penetration, pair)

    def stiffness(self, penetration, pair):
        return 2 * super().stiffness(penetration, pair)


@pytest.mark.parametrize("law", [TwoSprings(), Doubled()], ids=lambda law: type(law).__name__)
def test_a_law_of_ones_own_is_tabulated_to_its_end(law):
    pair = PAIRS["tight"]
    made, end = kernel(law, pair), float(law.max_penetration(pair))
    assert (made.kind, made.max_penetration) == (TABLE, end)
    deltas = end * np.concatenate([np.geomspace(1e-20, 0.9, 500), 1 - 10.0 ** -np.arange(1, 12.0)])
    actual = [made.load(delta) for delta in deltas]
    np.testing.assert_allclose(actual, law.load(deltas, pair), rtol=TABLE_ERROR)
    assert np.isnan(made.load(end * (1 + 1e-9)))


# --- the fitted form ----------------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS.values(), ids=lambda model: f"{model.law}-{model.contact}")
def test_a_model_is_the_law_at_its_nominal_values_and_names_every_parameter(model):
    for parameter in model.parameters:
        assert parameter.low < parameter.high
        assert parameter.meaning
        assert parameter.nominal is None or parameter.low <= parameter.nominal <= parameter.high
    nominal = {p.name: p.nominal for p in model.parameters}
    if None in nominal.values():
        assert model.published is None
        return
    pair = PAIRS["wide" if model.contact == "internal" else "rollers"]
    law = laws.LAWS[model.law]()
    delta = np.geomspace(1e-6, 0.9, 20) * reach(law, pair)
    fitted = model.build(nominal)
    np.testing.assert_allclose(fitted.load(delta, pair), law.load(delta, pair), rtol=1e-12)


@given(data=st.data())
@pytest.mark.parametrize(
    "model",
    [model for model in MODELS.values() if model.power_form],
    ids=lambda model: f"{model.law}-{model.contact}",
)
def test_a_power_form_is_the_law_that_it_stands_for(model, data):
    """The K* and n of candidates give the load of the law that the candidate builds."""
    values = [data.draw(st.floats(p.low, p.high)) for p in model.parameters]
    dR = data.draw(st.floats(0.05, 9.0))
    K_star, n = model.power_form(np.array([values]), np.array([dR]))
    law = model.build(dict(zip(model.names, values, strict=True)))
    pair = CylinderPair.from_dR(model.contact, dR, STEEL)
    if K_star[0, 0] > 0 and n[0, 0] > 0:
        load = K_star[0, 0] * pair.E_star / dR * 1e-3 ** n[0, 0]
        assert law.load(1e-3, pair) == pytest.approx(load, rel=1e-12)
    else:
        assert np.isnan(law.load(1e-3, pair))
