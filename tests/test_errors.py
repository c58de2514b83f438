"""Every message of the contact mechanics, executed."""

import copy
import pickle

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws, limits

STEEL = Material("steel", E=207e3, nu=0.3, yield_stress=250.0)
BRASS = Material("brass", E=100e3, nu=0.34)
BARE = CylinderPair.from_dR("internal", 0.5, STEEL)
MIXED = CylinderPair.from_dR("internal", 0.5, STEEL, material_j=BRASS)
OUTSIDE = CylinderPair.external(10.0, 9.5, STEEL)

MODULUS = ("Young's modulus must be positive and finite", "give it in MPa, e.g. 207e3 for steel")
RATIO = ("Poisson's ratio must lie in [0, 0.5]", "give e.g. 0.3 for steel")
YIELD = ("yield stress must be positive and finite", "give it in MPa, or leave it out")
LENGTH = ("must be positive and finite", "give it in mm")
CONTACT = (
    "must be 'internal' or 'external'",
    "internal is a pin in a hole, external two rollers",
)
NO_ROOM = "internal contact needs dR < R_i, external contact dR > R_i"
NEEDS_RADII = "build it with CylinderPair.internal or .external, or pass R_i to from_dR"
NAMES = (
    "the names must be those of one contact",
    "internal: a, b, Y_log_scale, Y_log_exponent, Y_slope, Y_offset, n_exponent; external: a, b, n",
)
COEFFICIENT = (
    "a coefficient must be a finite number",
    "give the value that a fit or the paper gives",
)
FACTOR = (
    "exactly one of them must be given, positive and finite",
    "use K for one pair, K_star or C for a law that scales to others",
)
NO_YIELD = (
    "is not known for both materials",
    "give the materials a yield_stress in MPa, or pass one",
)


def material(**change):
    return lambda: Material(**{"name": "clay", "E": 1e3, "nu": 0.3} | change)


def from_dR(*args, **kwargs):
    return lambda: CylinderPair.from_dR(*args, STEEL, **kwargs)


def internal(R_i, R_j, **kwargs):
    return lambda: CylinderPair.internal(R_i, R_j, STEEL, **kwargs)


def external(R_i, R_j):
    return lambda: CylinderPair.external(R_i, R_j, STEEL)


def enhanced(**values):
    return lambda: laws.Enhanced(values)


def no_fit(R_i):
    return (
        f"the pin must be smaller than the hole (R_i = {R_i})",
        "give R_i, the radius of the hole, the larger value",
    )


# What is done; source, key and value of the error; its rule and remedy.
BAD_INPUT = [
    *[
        (material(E=E), "Material 'clay'", "E", E, *MODULUS)
        for E in (0.0, -1.0, np.inf, np.nan, [1e3, -1e3])
    ],
    *[
        (material(nu=nu), "Material 'clay'", "nu", nu, *RATIO)
        for nu in (-1e-9, 0.5000001, np.nan, [0.3, 0.6])
    ],
    *[
        (material(yield_stress=stress), "Material 'clay'", "yield_stress", stress, *YIELD)
        for stress in (0.0, -250.0, np.inf, np.nan)
    ],
    (
        lambda: CylinderPair("inside", 0.5, STEEL, STEEL),
        *("CylinderPair", "contact", "inside"),
        *CONTACT,
    ),
    (from_dR("inside", 0.5, R_i=10.0), "CylinderPair", "contact", "inside", *CONTACT),
    *[
        (from_dR("internal", dR), "CylinderPair", "dR", dR, *LENGTH)
        for dR in (0.0, -0.5, np.inf, np.nan, [0.5, 0.0])
    ],
    (from_dR("internal", np.nan, R_i=10.0), "CylinderPair", "dR", np.nan, *LENGTH),
    (from_dR("internal", 0.5, R_i=-10.0), "CylinderPair", "R_i", -10.0, *LENGTH),
    (internal(-10.0, -11.0), "CylinderPair", "R_i", -10.0, *LENGTH),
    (internal(10.0, 0.0), "CylinderPair", "R_j", 0.0, *LENGTH),
    (external(np.inf, 1.0), "CylinderPair", "R_i", np.inf, *LENGTH),
    (external(1.0, np.nan), "CylinderPair", "R_j", np.nan, *LENGTH),
    (internal(10.0, 9.5, length=0.0), "CylinderPair", "length", 0.0, *LENGTH),
    (internal(9.5, 10.0), "CylinderPair.internal", "R_j", 10.0, *no_fit("9.5")),
    (internal(9.5, 9.5), "CylinderPair.internal", "R_j", 9.5, *no_fit("9.5")),
    (
        internal([10.0, 9.0], 9.5),
        *("CylinderPair.internal", "R_j", 9.5),
        *no_fit("[10.0, 9.0]"),
    ),
    *[
        (
            from_dR(contact, dR, R_i=10.0),
            *("CylinderPair.from_dR", "dR", dR),
            "leaves body j a radius that is not positive (R_i = 10.0)",
            NO_ROOM,
        )
        for contact, dR in (("internal", 10.0), ("internal", 11.0), ("external", 9.0))
    ],
    (
        lambda: BARE.R,
        *("CylinderPair", "R_i, R_j", None),
        "the effective radius needs both radii and this pair knows only ΔR",
        NEEDS_RADII,
    ),
    (
        lambda: laws.Johnson().load(1e-3, MIXED),
        *("CylinderPair", "R_i, R_j", None),
        "Johnson's law for different materials needs both radii and this pair knows only ΔR",
        NEEDS_RADII,
    ),
    (
        lambda: laws.LankaraniNikravesh().load(1e-3, OUTSIDE),
        *("CylinderPair", "length", None),
        "the law of Lankarani and Nikravesh per unit length needs the axial length and this pair "
        "has none",
        "pass length= in mm when the pair is built",
    ),
    *[
        (enhanced(**values), "Enhanced", "coefficients", sorted(values), *NAMES)
        for values in ({}, {"a": 1.0, "b": 1.0}, {"a": 1.0, "b": 1.0, "m": 1.0}, {"K": 1.0})
    ],
    *[
        (enhanced(a=1.0, b=value, n=1.1), "Enhanced", "b", value, *COEFFICIENT)
        for value in (np.nan, -np.inf, "0.85", None)
    ],
    *[
        (
            lambda fitted=fitted, pair=pair: laws.Enhanced(laws.PUBLISHED[fitted]).load(1.0, pair),
            *("Enhanced", "coefficients", None),
            f"they are for {fitted} contact and the pair is {pair.contact}",
            "use coefficients fitted for the pair's contact",
        )
        for fitted, pair in (("external", BARE), ("internal", OUTSIDE))
    ],
    *[
        (
            lambda factors=factors: laws.PowerLaw(1.1, *factors),
            *("PowerLaw", "K, K_star, C", factors),
            *FACTOR,
        )
        for factors in (
            (None, None, None),
            (1.0, 1.0, None),
            (1.0, None, 1.0),
            (0.0, None, None),
            (None, -1.0, None),
            (None, None, np.nan),
            (np.inf, None, None),
        )
    ],
    *[
        (
            lambda n=n: laws.PowerLaw(n=n, K=1.0),
            *("PowerLaw", "n", n, "must be positive and finite", "contact has n ≥ 1"),
        )
        for n in (0.0, -1.0, np.inf, np.nan)
    ],
    *[
        (
            lambda n=n: laws.LankaraniNikravesh(n=n),
            *("LankaraniNikravesh", "n", n, "must be positive and finite", "metals have n = 1.5"),
        )
        for n in (0.0, -1.5, np.inf, np.nan)
    ],
    (
        lambda: laws.reference_law("hertz"),
        *(
            "reference law",
            "name",
            "hertz",
            "is not a law that a grid can sample",
            f"choose among {', '.join(laws.REFERENCES)}",
        ),
    ),
    *[
        (
            lambda pair=pair: limits.yield_load(pair),
            *("yield limit", "yield_stress", None),
            *NO_YIELD,
        )
        for pair in (MIXED, CylinderPair.external(1.0, 1.0, BRASS))
    ],
    *[
        (
            lambda stress=stress: limits.yield_load(OUTSIDE, stress),
            *("yield limit", "yield_stress", stress),
            *("must be positive and finite", "give it in MPa"),
        )
        for stress in (0.0, -250.0, np.inf, np.nan)
    ],
    (
        lambda: limits.elastic_limit_clearance(10.0, OUTSIDE),
        *("elastic_limit_clearance", "pair.contact", "external"),
        *("must be internal", "external contact has no clearance"),
    ),
    (
        lambda: limits.elastic_limit_clearance(10.0, MIXED),
        *("elastic_limit_clearance", "pair.material_j", "brass"),
        "must be as stiff as material_i, or Johnson's limit is not that of Eq 8",
        "give a pair of one material",
    ),
    *[
        (
            lambda R_i=R_i: limits.elastic_limit_clearance(R_i, BARE),
            *("elastic_limit_clearance", "R_i", R_i),
            *LENGTH,
        )
        for R_i in (0.0, -10.0, np.nan)
    ],
]


@pytest.mark.parametrize(
    ("act", "source", "key", "value", "rule", "remedy"),
    BAD_INPUT,
    ids=[f"{source}: {key} = {value}" for _, source, key, value, *_ in BAD_INPUT],
)
def test_bad_input_is_told_by_source_key_value_rule_and_remedy(
    act, source, key, value, rule, remedy
):
    with pytest.raises(InputError) as caught:
        act()
    error = caught.value
    assert (error.source, error.key, error.rule, error.remedy) == (source, key, rule, remedy)
    assert repr(error.value) == repr(value)  # so that NaN equals itself
    visible = f"{key} = {value!r}" if value is not None else key
    assert str(error) == f"{source}: {visible}: {rule}; {remedy}"


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
