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


def material(name, value):
    return Material(**{"name": "clay", "E": 1e3, "nu": 0.3} | {name: value})


def from_dR(contact, dR, **kwargs):
    return CylinderPair.from_dR(contact, dR, STEEL, **kwargs)


# What is said, source: key = value: rule; remedy; what is done with the value, and the values.
BAD_INPUT = {
    "Material 'clay': E = {!r}: Young's modulus must be positive and finite; "
    "give it in MPa, e.g. 207e3 for steel": (
        lambda E: material("E", E),
        (*NO_NUMBERS, [1e3, -1e3]),
    ),
    "Material 'clay': E = {!r}: a bare number is in MPa; did you mean \"207 GPa\"? "
    'For a material as soft as that write "207 MPa"': (
        lambda E: material("E", E),
        (207, 207.0, "207"),
    ),
    "Material 'clay': E = {!r}: a bare number is in MPa; did you mean \"3.5 GPa\"? "
    'For a material as soft as that write "3.5 MPa", one Material each': (
        lambda E: material("E", E),
        ([207e3, 3.5],),
    ),
    "Material 'clay': E = {!r}: is beyond any material, diamond has 1.2e6 MPa; "
    'did you mean "207 GPa"? Give it in MPa': (
        lambda E: material("E", E),
        (207e9, "207e9", [2e5, 207e9]),
    ),
    "Material 'clay': E = {!r}: is beyond any material, diamond has 1.2e6 MPa; mind the unit": (
        lambda E: material("E", E),
        ("207000 GPa",),
    ),
    "Material 'plate': E = {!r}: a bare number is in MPa; did you mean \"207 GPa\"? "
    'For a material as soft as that write "207 MPa"': (
        lambda E: Setup(hole_radius=10.0, outer_ratio=5.0, E=E, nu=0.3),
        (207.0,),
    ),
    "Material 'pin': E = {!r}: is beyond any material, diamond has 1.2e6 MPa; "
    'did you mean "70 GPa"? Give it in MPa': (
        lambda E: Setup(hole_radius=10.0, outer_ratio=5.0, E=207e3, nu=0.3, pin_E=E),
        (70e9,),
    ),
    "Material 'clay': E = {!r}: must be a number with a unit; "
    'write e.g. "207 GPa" or "200 MPa"': (
        lambda E: material("E", E),
        ("hard", "207 psi", "GPa", ""),
    ),
    "Material 'clay': nu = {!r}: Poisson's ratio must lie in [0, 0.5]; give e.g. 0.3 for steel": (
        lambda nu: material("nu", nu),
        (-1e-9, 0.5000001, np.nan, [0.3, 0.6]),
    ),
    "Material 'clay': yield_stress = {!r}: yield stress must be positive and finite; "
    "give it in MPa, or leave it out": (
        lambda stress: material("yield_stress", stress),
        NO_NUMBERS,
    ),
    "CylinderPair: contact = {!r}: must be 'internal' or 'external'; "
    "internal is a pin in a hole, external two rollers": (
        [lambda contact: CylinderPair(contact, 0.5, STEEL, STEEL),
         lambda contact: from_dR(contact, 0.5, R_i=10.0)],
        ("inside",),
    ),
    "CylinderPair: dR = {!r}: must be positive and finite; give it in mm": (
        [lambda dR: from_dR("internal", dR), lambda dR: from_dR("internal", dR, R_i=10.0)],
        (*NO_NUMBERS, [0.5, 0.0]),
    ),
    "CylinderPair: R_i = {!r}: must be positive and finite; give it in mm": (
        [lambda R_i: from_dR("internal", 0.5, R_i=R_i),
         lambda R_i: CylinderPair.internal(R_i, -11.0, STEEL),
         lambda R_i: CylinderPair.external(R_i, 1.0, STEEL)],
        (-10.0, np.inf),
    ),
    "CylinderPair: R_j = {!r}: must be positive and finite; give it in mm": (
        lambda R_j: CylinderPair.internal(10.0, R_j, STEEL),
        (0.0, np.nan, np.inf),
    ),
    "CylinderPair: R_j = {!r}: must be positive and finite; give it in mm, or inf alone for a "
    "plane": (
        lambda R_j: CylinderPair.external(1.0, R_j, STEEL),
        (0.0, np.nan, -np.inf, [5.0, np.inf]),
    ),
    "CylinderPair: length = {!r}: must be positive and finite; give it in mm": (
        lambda length: CylinderPair.internal(10.0, 9.5, STEEL, length=length),
        (0.0,),
    ),
    "CylinderPair.internal: R_j = {!r}: the pin must be smaller than the hole (R_i = 9.5); "
    "give R_i, the radius of the hole, the larger value; both are radii, not diameters": (
        lambda R_j: CylinderPair.internal(9.5, R_j, STEEL),
        (10.0, 9.5),
    ),
    "CylinderPair.internal: R_j = {!r}: the pin must be smaller than the hole "
    "(R_i = [10.0, 9.0]); give R_i, the radius of the hole, the larger value; both are radii, not "
    "diameters": (
        lambda R_j: CylinderPair.internal([10.0, 9.0], R_j, STEEL),
        (9.5,),
    ),
    "CylinderPair.internal: material: is missing; give material, or pin and hole": (
        lambda _: CylinderPair.internal(10.0, 9.5),
        (None,),
    ),
    "CylinderPair.from_dR: hole: is missing beside pin; give both, or material for both bodies": (
        lambda _: CylinderPair.from_dR("internal", 0.5, pin=BRASS),
        (None,),
    ),
    "CylinderPair.internal: material_j: is given beside pin or hole; leave it out, or those": (
        lambda _: CylinderPair.internal(10.0, 9.5, material_j=STEEL, pin=BRASS, hole=STEEL),
        (None,),
    ),
    "CylinderPair.from_dR: contact = {!r}: has no pin and no hole; give material and material_j": (
        lambda contact: CylinderPair.from_dR(contact, 20.0, pin=BRASS, hole=STEEL),
        ("external",),
    ),
    "CylinderPair.from_dR: dR = {!r}: leaves the pin a radius that is not positive (R_i = 10.0); "
    "internal contact needs dR < R_i, external contact dR > R_i": (
        lambda dR: from_dR("internal", dR, R_i=10.0),
        (10.0, 11.0),
    ),
    "CylinderPair.from_dR: dR = {!r}: leaves roller j a radius that is not positive (R_i = 10.0); "
    "internal contact needs dR < R_i, external contact dR > R_i": (
        lambda dR: from_dR("external", dR, R_i=10.0),
        (10.0, 9.0),
    ),
    "CylinderPair: dR = {!r}: leaves the pin a radius that is not positive (R_i = 10.0); "
    "internal contact needs dR < R_i, external contact dR > R_i": (
        lambda dR: CylinderPair("internal", dR, STEEL, STEEL, R_i=10.0),
        (10.0, 11.0),
    ),
    "CylinderPair: dR = {!r}: leaves roller i a radius that is not positive (R_j = 10.0); "
    "internal contact needs dR < R_i, external contact dR > R_j": (
        lambda dR: CylinderPair("external", dR, STEEL, STEEL, R_j=10.0),
        (10.0, 9.0),
    ),
    "CylinderPair: R_i, R_j: the effective radius needs both radii and this pair knows only ΔR; "
    "build it with CylinderPair.internal or .external, or pass R_i to from_dR": (
        lambda _: BARE.R,
        (None,),
    ),
    "CylinderPair: R_i, R_j: Johnson's law for different materials needs both radii and this pair "
    "knows only ΔR; build it with CylinderPair.internal or .external, or pass R_i to from_dR": (
        lambda _: laws.Johnson().load(1e-3, MIXED),
        (None,),
    ),
    "CylinderPair: length: the lankarani-nikravesh law needs the axial "
    "length and this pair has none; pass length= in mm when the pair is built": (
        lambda _: laws.LankaraniNikravesh().load(1e-3, OUTSIDE),
        (None,),
    ),
    "Enhanced: coefficients = {!r}: the names must be those of one contact; internal: a, b, "
    "Y_log_scale, Y_log_exponent, Y_slope, Y_offset, n_exponent; external: a, b, n": (
        lambda names: laws.Enhanced(dict.fromkeys(names, 1.0)),
        ([], ["a", "b"], ["a", "b", "m"], ["K"]),
    ),
    "Enhanced: b = {!r}: a coefficient must be a finite number; "
    "give the value that a fit or the paper gives": (
        lambda b: laws.Enhanced({"a": 1.0, "b": b, "n": 1.1}),
        (np.nan, -np.inf, "0.85", None),
    ),
    "Enhanced: coefficients: they are for external contact and the pair is internal; "
    "use coefficients fitted for the pair's contact": (
        lambda _: laws.Enhanced(laws.PUBLISHED["external"]).load(1.0, BARE),
        (None,),
    ),
    "PowerLaw: K, K_star, C = {!r}: exactly one of them must be given, positive and finite; "
    "use K for one pair, K_star or C for a law that scales to others": (
        lambda factors: laws.PowerLaw(1.1, *factors),
        (
            *((None, None, None), (1.0, 1.0, None), (1.0, None, 1.0), (0.0, None, None)),
            *((None, -1.0, None), (None, None, np.nan), (np.inf, None, None)),
        ),
    ),
    "PowerLaw: n = {!r}: must be positive and finite; give the exponent of the penetration": (
        lambda n: laws.PowerLaw(n=n, K=1.0),
        NO_NUMBERS,
    ),
    "LankaraniNikravesh: n = {!r}: must be positive and finite; metals have n = 1.5": (
        lambda n: laws.LankaraniNikravesh(n=n),
        NO_NUMBERS,
    ),
    "reference law: name = {!r}: is not a law that a grid can sample; "
    f"choose among {', '.join(laws.REFERENCES)}": (laws.reference_law, ("hertz",)),
    "yield limit: yield_stress: is not known for both materials; "
    "give the materials a yield_stress in MPa, or pass one": (
        [lambda _: limits.yield_load(MIXED),
         lambda _: limits.yield_load(CylinderPair.external(1.0, 1.0, BRASS))],
        (None,),
    ),
    "yield limit: yield_stress = {!r}: must be positive and finite; give it in MPa": (
        lambda stress: limits.yield_load(OUTSIDE, yield_stress=stress),
        NO_NUMBERS,
    ),
    "yield limit: criterion = {!r}: must be 'von Mises', 'Tresca' or, for the load alone, 'Hertz'; "
    "'Hertz' is the paper's estimate of the load": (
        [lambda criterion: limits.yield_load(OUTSIDE, criterion),
         lambda criterion: limits.first_yield(OUTSIDE, criterion)],
        ("mises",),
    ),
    "elastic_limit_clearance: pair.contact = 'external': must be internal; "
    "external contact has no clearance": (
        lambda _: limits.elastic_limit_clearance(10.0, OUTSIDE),
        ("external",),
    ),
    "elastic_limit_clearance: pair.material_j = 'brass': must be as stiff as material_i, or "
    "Johnson's limit is not that of Eq 8; give a pair of one material": (
        lambda _: limits.elastic_limit_clearance(10.0, MIXED),
        ("brass",),
    ),
    "elastic_limit_clearance: R_i = {!r}: must be positive and finite; give it in mm": (
        lambda R_i: limits.elastic_limit_clearance(R_i, BARE),
        (0.0, -10.0, np.nan),
    ),
}  # fmt: skip
CASES = [
    (said, act, value)
    for said, (acts, values) in BAD_INPUT.items()
    for act in (acts if isinstance(acts, list) else [acts])
    for value in values
]


@pytest.mark.parametrize(
    ("said", "act", "value"), CASES, ids=[f"{said[:40]}, {value}" for said, _, value in CASES]
)
def test_bad_input_is_told_by_source_key_value_rule_and_remedy(said, act, value):
    with pytest.raises(InputError) as caught:
        act(value)
    error = caught.value
    source, key, words = said.split(": ", 2)
    rule, remedy = words.split("; ", 1)
    assert (error.source, error.key, error.rule, error.remedy) == (
        *(source, key.partition(" = ")[0], rule, remedy),
    )
    assert repr(error.value) == repr(value)  # so that NaN equals itself
    assert str(error) == (said.format(value) if value is not None else said.replace(" = {!r}", ""))


@pytest.mark.parametrize("value", ["much", ["1 N"], [[1.0], [1.0, 2.0]], 1j, {}])
def test_what_is_no_number_is_refused_by_laws(value):
    for act in (laws.Johnson().load, laws.Johnson().penetration, laws.Johnson().stiffness):
        with pytest.raises(InputError) as caught:
            act(value, BARE)
        assert str(caught.value) == f"{value!r}: must be a number or an array of them; give numbers"


# --- the message itself -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (("f.toml", "seed", 3, "rule", "remedy"), "f.toml: seed = 3: rule; remedy"),
        (("f.toml", "seed", "3", "rule", "remedy"), "f.toml: seed = '3': rule; remedy"),
        (("f.toml", "seed", None, "rule", "remedy"), "f.toml: seed: rule; remedy"),
        (("f.toml", "", None, "rule", "remedy"), "f.toml: rule; remedy"),
        (("f.toml", "", 3, "rule", "remedy"), "f.toml: 3: rule; remedy"),
        (("", "--jobs", 0, "rule", "remedy"), "--jobs = 0: rule; remedy"),
    ],
)
def test_parts_that_are_missing_leave_no_trace(parts, message):
    assert str(InputError(*parts)) == message


@pytest.mark.parametrize("number", [np.float64(-3.0), np.float32(-3.0)])
def test_a_numpy_number_is_shown_as_a_number(number):
    assert str(InputError("s", "E", number, "rule", "remedy")) == "s: E = -3.0: rule; remedy"


@pytest.mark.parametrize("value", [np.arange(1e3).reshape(100, 10), "word " * 100, ["\n"] * 100])
def test_a_long_value_is_cut_and_stays_on_one_line(value):
    message = str(InputError("s", "E", value, "rule", "remedy"))
    assert message.isprintable()
    assert len(message) == len("s: E = : rule; remedy") + 80
    assert message.endswith("…: rule; remedy")


def test_an_array_of_radii_stays_on_one_line_too():
    with pytest.raises(InputError) as caught:
        CylinderPair.internal(np.arange(1.0, 100.0), 50.0, STEEL)
    assert str(caught.value).isprintable()


def test_it_is_a_value_error():
    assert issubclass(InputError, ValueError)


@pytest.mark.parametrize("send", [copy.copy, lambda error: pickle.loads(pickle.dumps(error))])
def test_an_error_survives_the_way_from_a_worker_process(send):
    error = InputError("f.toml", "axes.E", [1, 2], "rule", "remedy")
    back = send(error)
    assert type(back) is InputError
    assert str(back) == str(error)
    assert vars(back) == vars(error)
