"""Every public function that takes a pair: a pair alone, an array of pairs, in both planes."""

import inspect

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws, limits

PLANES, CONTACTS = ("strain", "stress"), ("internal", "external")
LOADS = np.array([20.0, 300.0, 150.0])
DEPTHS = np.array([1e-4, 2e-3, 5e-4])
# The three joints of an array: radii, and E and ν of body i.
R_I, R_J = np.array([10.0, 12.0, 10.0]), np.array([9.9, 11.99, 9.5])
MODULI, RATIOS = np.array([200e3, 70e3, 110e3]), np.array([0.29, 0.33, 0.34])
STEEL = Material("steel", 207e3, 0.3, yield_stress=250.0, thermal_expansion=12e-6)


def material(E, nu):
    return Material("any", E, nu, yield_stress=200.0, thermal_expansion=2e-5)


def joints(contact, plane, *, alike):
    """The array of three pairs and each of them, of one material (`alike`) or of three."""
    build = getattr(CylinderPair, contact)
    E, nu = (np.full(3, STEEL.E), np.full(3, STEEL.nu)) if alike else (MODULI, RATIOS)
    whole = STEEL if alike else material(E, nu)
    each = [STEEL if alike else material(E[k], nu[k]) for k in range(3)]
    rows = [build(R_I[k], R_J[k], each[k], 10.0, STEEL, plane=plane) for k in range(3)]
    return build(R_I, R_J, whole, 10.0, STEEL, plane=plane), rows


def values(result):
    """The numbers and words of a result, as arrays."""
    if isinstance(result, CylinderPair):
        return [result.dR, result.R_i, result.R_j]
    if isinstance(result, tuple) and not hasattr(result, "_fields"):
        return [number for each in result for number in values(each)]
    if isinstance(result, limits.FirstYield):
        return [result.load, result.body, result.depth, result.angle]
    return list(result) if isinstance(result, laws.conformal.ContactState) else [result]


def answer(ask, *arguments):
    """The values of an answer, or the rule by which it is refused, without the numbers in it."""
    try:
        return values(ask(*arguments))
    except InputError as error:
        return error.rule.partition(" (")[0]


def assert_rows(ask, pair, rows, *numbers):
    """An array of pairs gives each what it gives alone, or all are refused with one message."""
    together = answer(ask, pair, *numbers)
    for k, row in enumerate(rows):
        of_row = answer(ask, row, *(x[k] for x in numbers))
        if isinstance(together, str):
            assert of_row == together
            continue
        for array, alone in zip(together, of_row, strict=True):
            assert np.shape(alone) == ()
            found = np.broadcast_to(array, (3,))[k]
            if isinstance(alone, np.floating | float):
                np.testing.assert_allclose(found, alone, rtol=2e-9, equal_nan=True)
            else:
                assert found == alone


@pytest.mark.parametrize("alike", [True, False], ids=["one material", "three"])
@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("contact", CONTACTS)
@pytest.mark.parametrize("name", laws.LAWS)
def test_laws(name, contact, plane, alike):
    pair, rows = joints(contact, plane, alike=alike)
    law = laws.LAWS[name]()
    for ask in ("max_load", "max_penetration"):
        assert_rows(getattr(law, ask), pair, rows)
    for ask in ("load", "stiffness", "energy"):
        if hasattr(law, ask):
            assert_rows(lambda p, x, ask=ask: getattr(law, ask)(x, p), pair, rows, DEPTHS)
    for ask in ("penetration", "contact_angle", "peak_pressure", "state"):
        if hasattr(law, ask):
            assert_rows(lambda p, x, ask=ask: getattr(law, ask)(x, p), pair, rows, LOADS)


@pytest.mark.parametrize(
    ("clamp", "plane"), [("rim", "stress"), (laws.Sector(60, "pulled"), "strain")], ids=str
)
def test_conformal_contact_and_first_yield_in_a_housing(clamp, plane):
    pair, rows = joints("internal", plane, alike=False)
    housing = laws.Housing(20.0, clamp)
    law = laws.Conformal(housing)
    assert_rows(lambda p, x: law.state(x, p), pair, rows, LOADS)
    assert_rows(lambda p: limits.first_yield(p, housing=housing), pair, rows)
    assert_rows(lambda p: limits.at_temperature(p, 60.0, 40.0, housing=housing), pair, rows)
    strengths = np.array([100.0, 300.0, 250.0])
    assert_rows(lambda p, s: limits.yield_load(p, "Tresca", s, housing), pair, rows, strengths)


@pytest.mark.parametrize(
    ("clamp", "plane"),
    [("rim", "stress"), pytest.param(laws.Sector(60, "pulled"), "strain", marks=pytest.mark.slow)],
)
def test_rings_at_rest_around_arrays_of_pins_each_with_its_interference(clamp, plane):
    pair, rows = joints("internal", plane, alike=False)
    eye = laws.Housing(20.0, clamp, [(STEEL, 14.0)], seat="sliding")

    def rest(p, interference):
        materials, radii = [p.material_i, STEEL], [p.R_i, 14.0, 20.0]
        return limits.at_rest(materials, radii, interference=interference)

    fits = np.array([0.01, 0.006, 0.012])
    assert_rows(lambda p, i: limits.first_yields(p, eye, rest(p, i)), pair, rows, fits)
    assert_rows(lambda p, i: limits.seat_opens(p, eye, rest(p, i)), pair, rows, fits)
    assert_rows(lambda p, x: laws.Conformal(eye).state(x, p), pair, rows, LOADS)


# How each function of `limits` is asked about a pair; the first argument is the pair.
OF_LIMITS = {
    "at_temperature": lambda p: limits.at_temperature(p, 60.0, 40.0),
    "elastic_limit_clearance": lambda p: limits.elastic_limit_clearance(p.R_i, p),
    "first_yield": limits.first_yield,
    "hertz_half_width": lambda p, f: limits.hertz_half_width(f, p),
    "hertz_pressure": lambda p, f: limits.hertz_pressure(0.01, f, p),
    "hertz_stress": lambda p, f: limits.hertz_stress(f, p),
    "johnson_limit_load": limits.johnson_limit_load,
    "stress_at_johnson_limit": limits.stress_at_johnson_limit,
}
WITHOUT_A_PAIR = {"AtRest", "FirstYield", "at_rest", "loose_temperatures"}


def test_no_function_of_limits_is_left_out():
    elsewhere = {"yield_load", "yield_warning", "first_yields", "seat_opens"}
    assert {*OF_LIMITS} | elsewhere | WITHOUT_A_PAIR == {*limits.__all__}


@pytest.mark.parametrize("alike", [True, False], ids=["one material", "three"])
@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("contact", CONTACTS)
@pytest.mark.parametrize("name", OF_LIMITS)
def test_limits(name, contact, plane, alike):
    pair, rows = joints(contact, plane, alike=alike)
    ask = OF_LIMITS[name]
    takes_load = len(inspect.signature(ask).parameters) == 2 and name.startswith("hertz")
    assert_rows(ask, pair, rows, *([LOADS] if takes_load else []))


@pytest.mark.parametrize("criterion", ["von Mises", "Tresca", "Hertz"])
@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("contact", CONTACTS)
def test_first_yield_by_each_criterion_and_with_strengths_of_their_own(contact, plane, criterion):
    pair, rows = joints(contact, plane, alike=False)
    strengths = np.array([100.0, 300.0, 250.0])
    assert_rows(lambda p, s: limits.yield_load(p, criterion, s), pair, rows, strengths)


@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("contact", CONTACTS)
def test_a_warning_is_that_of_the_joint_that_is_loaded_most(contact, plane):
    pair, rows = joints(contact, plane, alike=False)
    ends = limits.yield_load(pair)
    assert limits.yield_warning(0.99 * ends, pair) is None
    sentence = limits.yield_warning([1.0, 1.2, 1.5] * ends, pair)
    alone = limits.yield_warning(1.5 * ends[2], rows[2])
    assert sentence.partition(" N/mm")[2] == alone.partition(" N/mm")[2]


OF_BODIES = ("E_star", "R", "alpha", "beta", "moduli", "shares", "kolosov")


@pytest.mark.parametrize("alike", [True, False], ids=["one material", "three"])
@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("contact", CONTACTS)
@pytest.mark.parametrize("name", OF_BODIES)
def test_bodies(name, contact, plane, alike):
    pair, rows = joints(contact, plane, alike=alike)
    for k, row in enumerate(rows):
        together, alone = getattr(pair, name), getattr(row, name)
        if not isinstance(together, tuple):  # of one body for each
            together, alone = (together,), (alone,)
        for array, one in zip(together, alone, strict=True):
            found = np.broadcast_to(array, (3,))[k]
            np.testing.assert_allclose(found, one, rtol=1e-13, atol=1e-16)


@pytest.mark.parametrize("plane", PLANES)
def test_dundurs_and_fits_build_arrays_of_pairs(plane):
    alpha, beta = np.array([-0.3, 0.1, 0.6]), np.array([-0.1, 0.0, 0.2])
    pair = CylinderPair.from_dundurs(alpha, beta)
    for k in range(3):
        one = CylinderPair.from_dundurs(alpha[k], beta[k])
        assert (one.alpha, one.beta) == (pair.alpha[k], pair.beta[k])
    band = CylinderPair.from_iso("20H7/g6", STEEL, plane=plane)
    loads = limits.yield_load(band)
    for k, share in enumerate((0.0, 0.5, 1.0)):
        one = CylinderPair.from_iso("20H7/g6", STEEL, plane=plane, share=share)
        assert loads[k] == pytest.approx(float(limits.yield_load(one)), rel=1e-9)
