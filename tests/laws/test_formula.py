"""A law's formula: what it reads of a function, and what comes out of it."""

# ruff: noqa: ARG001

import math
from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.integrate import quad

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.laws.formula import FUNCTIONS, Formula, lines_of, needed
from tests.support.strategies import ROUNDING

STEEL = Material("steel", E=207e3, nu=0.3)
BRONZE = Material("bronze", E=110e3, nu=0.34)
PAIR = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=12.0)
ROLLERS = CylinderPair.external(R_i=10.0, R_j=25.0, material=STEEL, length=12.0)
TWO = 2.0


def half(x):
    """Return x/2."""
    return x / TWO


def split(x, pair):
    """Return two numbers."""
    y = half(x)
    return y, y * pair.dR


def mine(penetration, pair, K=0.4, n=1.2):
    """Helpers, choices, loops, numbers of the module, a chained condition."""
    first, second = split(penetration, pair)
    grown = 1
    for j in range(3):
        grown = grown * (1 + K / (j + 1))
    shallow = (0 < penetration < 1e-3) & (pair.R > 0)
    root = np.where(shallow, np.sqrt(first), second ** (1 / n))
    root += half(math.pi) * grown * first
    return pair.E_star * (root * np.maximum(first, -1) + np.log1p(second))


FORMULAS = {
    **{law.name: (law.formula, law().numbers_at(PAIR)) for law in laws.LAW_TYPES[:9]},
    "mine": (Formula(mine), None),
}


def numbers_of(formula, numbers):
    if numbers is not None:
        return numbers
    asked = {name: getattr(PAIR, name) for name in formula.arguments}
    values = formula.of_pair(**asked, **formula.constants)
    return dict(zip(formula.numbers, values, strict=True))


@pytest.mark.parametrize("name", FORMULAS)
def test_load_and_stiffness_are_those_of_the_steps_at_forty_digits(name):
    formula, given = FORMULAS[name]
    numbers = numbers_of(formula, given)
    scope = {each: getattr(mp, each, None) for each in (*FUNCTIONS, "pi", "nan", "inf")}
    scope |= {"max": max, "range": range} | {key: mpf(float(x)) for key, x in numbers.items()}
    code = compile("\n".join(lines_of(needed(formula.scalar_steps, "f"))), name, "exec")

    def load(depth):
        values = {**scope, "penetration": depth}
        exec(code, values)
        return values["f"]

    end = min(0.01, 0.99 * float(numbers.get("last", np.inf)))
    for depth in np.geomspace(1e-7, end, 12):
        with mp.workdps(40):
            exact, slope = load(mpf(depth)), mp.diff(load, mpf(depth), h=mpf(depth) * 1e-12)
        assert formula.load(depth, **numbers) == pytest.approx(float(exact), rel=1e-14)
        assert formula.stiffness(depth, **numbers) == pytest.approx(float(slope), rel=1e-12)


@pytest.mark.parametrize("end", [1e-25, 1e-40])
def test_a_load_by_hand_in_arrays_is_that_of_the_formula(end):
    law, pair = (
        laws.Johnson(),
        CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, material_j=BRONZE),
    )
    formula, numbers = law.formula, law.numbers_at(pair)
    depth = np.geomspace(end, min(0.9 * numbers.get("last", np.inf), 1e3), 3001)
    expected = replace(formula, in_arrays=None).load(depth, **numbers)
    np.testing.assert_allclose(formula.load(depth, **numbers), expected, rtol=40 * ROUNDING)


def test_a_function_of_ones_own_is_read_as_it_runs():
    formula = Formula(mine)
    delta = np.geomspace(1e-6, 1e-2, 50)
    numbers = numbers_of(formula, None)
    expected = [mine(depth, PAIR) for depth in delta]
    np.testing.assert_allclose(formula.load(delta, **numbers), expected, rtol=8 * ROUNDING)
    assert formula.arguments == ("E_star", "dR", "R_i", "R_j")
    assert formula.constants == {"K": 0.4, "n": 1.2}
    # The loop does not depend on the penetration, and is done once for a pair.
    assert any(step.body for step in formula.at_pair)
    assert not any(step.body for step in formula.at_depth)


def through_scipy(penetration, pair, K=1.0):
    return K * np.cumsum(penetration)


def with_an_if(penetration, pair, K=1.0):
    if K > 1:
        penetration = 2 * penetration
    return K * penetration


def of_a_hidden_number(penetration, pair, K=1.0):
    return K * penetration * STEEL.name


def that_calls_itself(penetration, pair, K=1.0):
    return that_calls_itself(penetration, pair, K)


def without_a_return(penetration, pair, K=1.0):
    f = K * penetration  # noqa: F841


def that_loops_with_the_penetration(penetration, pair, K=1.0):
    f = 0
    for _ in range(3):
        f = f + K * penetration
    return f


REFUSED = {
    through_scipy: ("np.cumsum(penetration)", "is not known in other languages"),
    with_an_if: ("if K > 1", "no assignment and no loop"),
    of_a_hidden_number: ("STEEL.name", "is not a number"),
    that_calls_itself: ("that_calls_itself(penetration, pair, K)", "calls itself"),
    without_a_return: ("f = K * penetration", "does not end by returning its load"),
    that_loops_with_the_penetration: ("", "changes in a loop with the penetration"),
}


@pytest.mark.parametrize("function", REFUSED, ids=lambda function: function.__name__)
def test_what_cannot_be_translated_is_named_with_its_line(function):
    expression, rule = REFUSED[function]
    with pytest.raises(InputError) as caught:
        list(Formula(function).steps)
    said = str(caught.value)
    assert rule in said
    assert expression in said
    if expression:
        first = function.__code__.co_firstlineno
        line = int(said.split(": line ")[1].split(maxsplit=1)[0])
        assert first < line <= first + 4
        assert __file__ in said


# --- a cylinder on a plane -----------------------------------------------------------------------


ON_PLANE = CylinderPair.external(R_i=10.0, R_j=np.inf, material=STEEL, material_j=BRONZE)
HALF_WIDTH = np.sqrt(4 * 100.0 * 10.0 / (np.pi * ON_PLANE.E_star))  # Hertz's, under 100 N/mm


def hertz(function):
    """Average a function of the distance from the middle over Hertz's pressure."""
    weight = lambda t: 4 / np.pi * np.sqrt(1 - t * t)  # noqa: E731
    return quad(lambda t: weight(t) * function(t * HALF_WIDTH), 0, 1, limit=200)[0]


def of_roller(E, nu, R):
    """The approach of a roller's centre to its contact (Johnson, half of a diameter)."""
    return 100.0 * (1 - nu**2) / (np.pi * E) * (2 * np.log(4 * R / HALF_WIDTH) - 1)


@pytest.mark.parametrize("depth", [20.0, 500.0])
def test_the_half_plane_is_flamants_integral_over_hertzs_pressure(depth):
    """u_z of a line load: −(1 + ν)f/(πE)·[2(1 − ν)·ln r − z²/r²], surface less the point below."""
    E, nu = 110e3, 0.34

    def flamant(x, z):
        r2 = x * x + z * z
        return -(1 + nu) / (np.pi * E) * ((1 - nu) * np.log(r2) - z * z / r2)

    plane = 100.0 * hertz(lambda x: flamant(x, 0.0) - flamant(x, depth))
    expected = plane + of_roller(207e3, 0.3, 10.0)
    # The closed form takes the width for small beside the depth.
    actual = laws.Johnson(datum=depth).penetration(100.0, ON_PLANE)
    assert actual == pytest.approx(expected, rel=1e-4)
    assert laws.Johnson(datum=depth).load(actual, ON_PLANE) == pytest.approx(100.0, rel=1e-13)


@pytest.mark.parametrize(
    ("law", "pair", "words"),
    [
        (laws.Johnson(), ON_PLANE, "datum.*is missing: the pair is a cylinder on a plane"),
        (laws.Johnson(datum=5.0), ROLLERS, "datum = 5.0: is for a cylinder on a plane"),
        (laws.Explicit(), ON_PLANE, "is a plane"),
        (laws.Enhanced(), ON_PLANE, "is a plane"),
    ],
)
def test_a_plane_needs_a_datum_and_a_law_that_takes_one(law, pair, words):
    for ask in (law.load, law.penetration, law.stiffness):
        with pytest.raises(InputError, match=words):
            ask(1e-3, pair)


@pytest.mark.parametrize("datum", [0.0, -1.0, np.inf, "deep"])
def test_a_datum_is_a_length(datum):
    with pytest.raises(InputError, match="must be positive and finite"):
        laws.Johnson(datum=datum)
