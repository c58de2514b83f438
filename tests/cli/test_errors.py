"""Every message of the contact mechanics, executed."""

import copy
import pickle

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws, limits
from cylcontact.datasets.finite_element import Setup

STEEL = Material("steel", E=207e3, nu=0.3, yield_stress=250.0)
BRASS = Material("brass", E=100e3, nu=0.34)
BARE = CylinderPair.from_dR("internal", 0.5, STEEL)
MIXED = CylinderPair.from_dR("internal", 0.5, STEEL, material_j=BRASS)
OUTSIDE = CylinderPair.external(10.0, 9.5, STEEL)

NO_NUMBERS = (0.0, -1.0, np.inf, np.nan)
MUST = "must be positive and finite"
PAIRS = "CylinderPair"


def material(name):
    return lambda value: Material(**{"name": "clay", "E": 1e3, "nu": 0.3} | {name: value})


def setup(name):
    good = {"hole_radius": 10.0, "outer_ratio": 5.0, "E": 207e3, "nu": 0.3}
    return lambda value: Setup(**good | {name: value})


def from_dR(contact, **known):
    return lambda dR: CylinderPair.from_dR(contact, dR, STEEL, **known)


def ask(act):
    """What takes no value."""
    return lambda _: act()


def internal(*radii, **materials):
    return ask(lambda: CylinderPair.internal(*radii, **materials))


# The source and the key; what the message says besides; what is done with a value; the values.
BAD_INPUT = [
    ("Material 'clay'", "E", f"Young's modulus {MUST}", material("E"), (*NO_NUMBERS, [1e3, -1e3])),
    ("Material 'clay'", "E", 'did you mean "207 GPa"', material("E"), (207, "207", 207e9, "207e9")),
    ("Material 'clay'", "E", 'did you mean "3.5 GPa"', material("E"), ([207e3, 3.5],)),
    ("Material 'clay'", "E", "is beyond any material", material("E"), ("207000 GPa", [2e5, 207e9])),
    ("Material 'clay'", "E", "a number with a unit", material("E"), ("hard", "207 psi", "GPa", "")),
    ("Material 'plate'", "E", 'did you mean "207 GPa"', setup("E"), (207.0,)),
    ("Material 'pin'", "E", 'did you mean "70 GPa"', setup("pin_E"), (70e9,)),
    ("Material 'clay'", "nu", "must lie in [0, 0.5]", material("nu"), (-1e-9, np.nan, [0.3, 0.6])),
    ("Material 'clay'", "yield_stress", MUST, material("yield_stress"), NO_NUMBERS),
    (PAIRS, "contact", "must be 'internal' or 'external'",
     lambda contact: CylinderPair(contact, 0.5, STEEL, STEEL), ("inside",)),
    (PAIRS, "contact", "internal is a pin in a hole",
     lambda contact: CylinderPair.from_dR(contact, 0.5, STEEL, R_i=10.0), ("inside",)),
    (PAIRS, "dR", MUST, from_dR("internal"), (*NO_NUMBERS, [0.5, 0.0])),
    (PAIRS, "dR", MUST, from_dR("internal", R_i=10.0), NO_NUMBERS),
    (PAIRS, "R_i", MUST, lambda R_i: CylinderPair.internal(R_i, -11.0, STEEL), (-10.0, np.inf)),
    (PAIRS, "R_j", MUST, lambda R_j: CylinderPair.internal(10.0, R_j, STEEL), (0.0, np.inf)),
    (PAIRS, "R_j", "or inf alone for a plane",
     lambda R_j: CylinderPair.external(1.0, R_j, STEEL), (0.0, np.nan, -np.inf, [5.0, np.inf])),
    (PAIRS, "length", MUST, lambda L: CylinderPair.internal(10.0, 9.5, STEEL, length=L), (0.0,)),
    (f"{PAIRS}.internal", "R_j", "both are radii, not diameters",
     lambda R_j: CylinderPair.internal([9.5, 9.0], R_j, STEEL), (10.0, 9.5)),
    (f"{PAIRS}.internal", "material", "or pin and hole", internal(10.0, 9.5), (None,)),
    (f"{PAIRS}.internal", "hole", "give both", internal(10.0, 9.5, pin=BRASS), (None,)),
    (f"{PAIRS}.internal", "material_j", "is given beside pin or hole",
     internal(10.0, 9.5, material_j=STEEL, pin=BRASS, hole=STEEL), (None,)),
    (f"{PAIRS}.from_dR", "contact", "has no pin and no hole",
     lambda contact: CylinderPair.from_dR(contact, 20.0, pin=BRASS, hole=STEEL), ("external",)),
    (f"{PAIRS}.from_dR", "dR", "leaves the pin a radius that is not positive (R_i = 10.0)",
     from_dR("internal", R_i=10.0), (10.0, 11.0)),
    (f"{PAIRS}.from_dR", "dR", "leaves roller j a radius that is not positive (R_i = 10.0)",
     from_dR("external", R_i=10.0), (10.0, 9.0)),
    (PAIRS, "dR", "leaves the pin a radius that is not positive (R_i = 10.0)",
     lambda dR: CylinderPair("internal", dR, STEEL, STEEL, R_i=10.0), (10.0, 11.0)),
    (PAIRS, "dR", "leaves roller i a radius that is not positive (R_j = 10.0)",
     lambda dR: CylinderPair("external", dR, STEEL, STEEL, R_j=10.0), (10.0, 9.0)),
    (PAIRS, "R_i, R_j", "the effective radius needs both radii", ask(lambda: BARE.R), (None,)),
    ("Enhanced", "coefficients", "must be those of one contact",
     lambda names: laws.Enhanced(dict.fromkeys(names, 1.0)), ([], ["a", "b"], ["a", "b", "m"])),
    ("Enhanced", "b", "must be a finite number",
     lambda b: laws.Enhanced({"a": 1.0, "b": b, "n": 1.1}), (np.nan, -np.inf, "0.85", None)),
    ("PowerLaw", "K, K_star, C", "exactly one of them", lambda given: laws.PowerLaw(1.1, *given),
     ((None, None, None), (1.0, 1.0, None), (1.0, None, 1.0), (0.0, None, None),
      (None, -1.0, None), (None, None, np.nan), (np.inf, None, None))),
    ("PowerLaw", "n", MUST, lambda n: laws.PowerLaw(n=n, K=1.0), NO_NUMBERS),
    ("LankaraniNikravesh", "n", MUST, lambda n: laws.LankaraniNikravesh(n=n), NO_NUMBERS),
    ("reference law", "name", "choose among", laws.reference_law, ("hertz",)),
    ("yield limit", "yield_stress", "is not known for both", ask(lambda: limits.yield_load(MIXED)),
     (None,)),
    ("yield limit", "yield_stress", MUST,
     lambda stress: limits.yield_load(OUTSIDE, yield_stress=stress), NO_NUMBERS),
    ("yield limit", "criterion", "must be 'von Mises', 'Tresca' or",
     lambda criterion: limits.yield_load(OUTSIDE, criterion), ("mises",)),
    ("yield limit", "criterion", "must be 'von Mises', 'Tresca' or",
     lambda criterion: limits.first_yield(OUTSIDE, criterion), ("mises",)),
    ("elastic_limit_clearance", "pair.contact", "must be internal",
     ask(lambda: limits.elastic_limit_clearance(10.0, OUTSIDE)), ("external",)),
    ("elastic_limit_clearance", "pair.material_j", "must be as stiff as material_i",
     ask(lambda: limits.elastic_limit_clearance(10.0, MIXED)), ("brass",)),
    ("elastic_limit_clearance", "R_i", MUST,
     lambda R_i: limits.elastic_limit_clearance(R_i, BARE), (0.0, -10.0, np.nan)),
]  # fmt: skip


@pytest.mark.parametrize(("source", "key", "words", "act", "values"), BAD_INPUT)
def test_bad_input_is_told_by_source_key_value_rule_and_remedy(source, key, words, act, values):
    for value in values:
        with pytest.raises(InputError) as caught:
            act(value)
        error = caught.value
        assert (error.source, error.key) == (source, key)
        assert repr(error.value) == repr(value)  # so that NaN equals itself
        assert words in str(error)
        assert error.rule
        assert error.remedy
        assert len(str(error).splitlines()) == 1


@pytest.mark.parametrize("value", ["much", ["1 N"], [[1.0], [1.0, 2.0]], 1j, {}])
def test_what_is_no_number_is_refused_by_laws(value):
    for act in (laws.Johnson().load, laws.Johnson().penetration, laws.Johnson().stiffness):
        with pytest.raises(InputError) as caught:
            act(value, BARE)
        assert str(caught.value) == f"{value!r}: must be a number or an array of them; give numbers"


# --- the message itself -----------------------------------------------------------------------


@pytest.mark.parametrize("value", [np.arange(1e3).reshape(100, 10), "word " * 100, ["\n"] * 100])
def test_a_long_value_is_cut_and_stays_on_one_line(value):
    message = str(InputError("s", "E", value, "rule", "remedy"))
    assert message.isprintable()
    assert len(message) == len("s: E = : rule; remedy") + 80
    assert message.endswith("…: rule; remedy")


@pytest.mark.parametrize("send", [copy.copy, lambda error: pickle.loads(pickle.dumps(error))])
def test_an_error_survives_the_way_from_a_worker_process(send):
    error = InputError("f.toml", "axes.E", [1, 2], "rule", "remedy")
    back = send(error)
    assert vars(back) == vars(error)
