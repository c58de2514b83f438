"""A law's formula: what it reads of a function, and what comes out of it."""

# ruff: noqa: ARG001

import math

import numpy as np
import pytest
from mpmath import mp, mpf

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.laws.formula import FUNCTIONS, Formula, lines_of, needed
from cylcontact.laws.law import Law
from tests.strategies import ROUNDING

STEEL = Material("steel", E=207e3, nu=0.3)
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
    **{law.name: (law.formula, law().numbers_at(PAIR)) for law in laws.LAW_TYPES[:10]},
    "explicit-pair": (laws.ExplicitPair.formula, laws.ExplicitPair().numbers_at(PAIR)),
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


def with_text(penetration, pair, K=1.0):
    return K * penetration * "1"


def of_a_hidden_number(penetration, pair, K=1.0):
    return K * penetration * STEEL.name


def of_the_length(penetration, pair, K=1.0):
    return K * penetration * pair.material_i.E


def that_calls_itself(penetration, pair, K=1.0):
    return that_calls_itself(penetration, pair, K)


def without_a_return(penetration, pair, K=1.0):
    f = K * penetration  # noqa: F841


def that_loops_with_the_penetration(penetration, pair, K=1.0):
    f = 0
    for _ in range(3):
        f = f + K * penetration
    return f


def over_no_numbers(penetration, pair, K=1.0):
    for _ in (1, 2):
        K = 2 * K
    return K * penetration


REFUSED = {
    through_scipy: ("np.cumsum(penetration)", "is not known in other languages"),
    with_an_if: ("if K > 1", "no assignment and no loop"),
    with_text: ("'1'", "cannot be written in another language"),
    of_a_hidden_number: ("STEEL.name", "is not a number"),
    of_the_length: ("pair.material_i.E", "is not a number"),
    that_calls_itself: ("that_calls_itself(penetration, pair, K)", "calls itself"),
    without_a_return: ("f = K * penetration", "does not end by returning its load"),
    that_loops_with_the_penetration: ("", "changes in a loop with the penetration"),
    over_no_numbers: ("(1, 2)", "is not a range of whole numbers"),
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


def test_names_that_differ_in_case_alone_get_names_that_do_not():
    """Fortran does not tell K from k, and f and k are the results."""

    def load(penetration, pair, K=1.0):
        k = K * penetration
        F = k * pair.dR
        return F * pair.E_star

    formula = Formula(load)
    names = [step.name.lower() for step in formula.steps]
    assert len({*names, "k", "penetration", "e_star", "dr"}) == len(names) + 3
    numbers = formula.of_pair(E_star=10.0, dR=0.5, K=3.0)
    at = dict(zip(formula.numbers, numbers, strict=True))
    assert (formula.load(2.0, **at), formula.stiffness(2.0, **at)) == (30.0, 15.0)


# --- laws that prove the form --------------------------------------------------------------------


def test_palmgren_and_iso_16281_are_the_printed_formulas():
    for length, force in ((10.0, 1000.0), (25.0, 80.0)):
        pair = CylinderPair.external(R_i=5.0, R_j=20.0, material=STEEL, length=length)
        one = laws.Palmgren().penetration(force / length, pair)
        assert one == pytest.approx(3.84e-5 * force**0.9 / length**0.8, rel=1e-14)
        both = 2 * laws.Iso16281().penetration(force / length, pair)
        assert 35948 * length ** (8 / 9) * both ** (10 / 9) == pytest.approx(force, rel=1e-13)
    pair = CylinderPair.external(R_i=5.0, R_j=20.0, material=STEEL, length=10.0)
    both, one = (law().penetration(100.0, pair) for law in (laws.Iso16281, laws.Palmgren))
    assert 2 * both / one == pytest.approx(2.07, abs=0.005)


@pytest.mark.parametrize("law", [laws.Palmgren, laws.Iso16281])
def test_bearing_laws_are_for_steel_of_a_known_length(law):
    bronze = Material("bronze", E=110e3, nu=0.34)
    for pair, words in (
        (CylinderPair.external(R_i=5.0, R_j=9.0, material=bronze, length=9.0), "is no steel"),
        (CylinderPair.external(R_i=5.0, R_j=9.0, material=STEEL), "needs the axial length"),
    ):
        with pytest.raises(InputError, match=words):
            law().load(1e-3, pair)


def test_every_law_states_its_equation_for_exported_files():
    for kind in laws.LAW_TYPES:
        if issubclass(kind, Law):
            assert kind.formula.equation
