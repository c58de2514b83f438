"""Ties: parameters set by arithmetic on others."""

import ast
import pickle

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.fitting import Campaign, calibrate, fit, read_result
from cylcontact.fitting.calibration import space_of
from cylcontact.fitting.ties import evaluate, require_valid
from tests.support.spec_files import DROP, write_bench

NAMES = ("a", "b", "n")
TIED = {"bounds.K_star": DROP, "ties": {"K_star": "2*n"}}


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("+a - -b", 7.0),
        ("2**a", 8.0),
        ("-a**2", -9.0),
        ("(a + b)*1e-1", 0.7),
        ("  a - b - 1 ", -2.0),
        ("log(a*b)/log(12)", 1.0),
    ],
)
def test_expressions_are_arithmetic(expression, value):
    require_valid({"n": expression}, NAMES, "campaign")
    assert evaluate(expression, {"a": 3.0, "b": 4.0}) == pytest.approx(value, rel=1e-15)
    arrays = {"a": np.full(5, 3.0), "b": np.full(5, 4.0)}
    assert np.all(evaluate(expression, arrays) == evaluate(expression, {"a": 3.0, "b": 4.0}))


numbers = st.floats(0.1, 10.0).map(lambda number: f"{number:.3f}")
expressions = st.recursive(
    st.one_of(numbers, st.sampled_from(["a", "b"])),
    lambda inner: st.tuples(inner, st.sampled_from("+-*/"), inner).map(
        lambda parts: f"({parts[0]} {parts[1]} {parts[2]})"
    ),
    max_leaves=6,
)


@settings(max_examples=40)
@given(expressions, st.floats(0.1, 10), st.floats(0.1, 10))
def test_expressions_agree_with_python(expression, a, b):
    tree = compile(ast.parse(expression, mode="eval"), "test", "eval")
    try:
        expected = eval(tree, {"__builtins__": {}}, {"a": a, "b": b})
    except ZeroDivisionError:
        assert not np.isfinite(evaluate(expression, {"a": a, "b": b}))
        return
    assert evaluate(expression, {"a": a, "b": b}) == expected


@pytest.mark.parametrize("expression", ["a/0", "a**a**a**a", "0**-1", "1e300*1e300"])
def test_arithmetic_without_a_value_is_not_a_number_or_infinite(expression):
    assert not np.isfinite(evaluate(expression, {"a": 30.0}))


NO_ARITHMETIC = (
    *(
        "",
        "a +",
        "exp(a)",
        "log()",
        "log(a, 2)",
        "log(a)(b)",
        "a.log(b)",
        "a.real",
        "a[0]",
        "a < b",
        "not a",
        "a // 2",
        "'a'",
        "True",
        "1e999",
    ),
    *("(a := 2)", "a; b", "a\0", "1or 2", "__import__('os').getcwd()", "9" * 5000),
)
ARITHMETIC = "may hold only numbers, names of parameters"


@pytest.mark.parametrize(
    ("ties", "key", "rule"),
    [
        ({"z": "a"}, "z", "is not a parameter of the law; its parameters: a, b, n"),
        ({"n": "x/10"}, "n", "names x, which is no parameter; use a, b"),
        ({"n": "n + 1"}, "n", "names n, which is tied itself; use a, b"),
        ({"b": "a", "n": "b"}, "n", "names b, which is tied itself; use a"),
        *(({"n": text}, "n", ARITHMETIC) for text in NO_ARITHMETIC),
    ],
)
def test_what_cannot_be_a_tie_is_refused(ties, key, rule):
    with pytest.raises(InputError) as refused:
        require_valid(ties, NAMES, "campaign.toml")
    message = str(refused.value)
    assert message.startswith(f"campaign.toml: ties.{key}")
    assert rule in message
    assert "\n" not in message


def test_a_tied_parameter_follows_the_others(tmp_path):
    space, _ = space_of(Campaign.read(write_bench(tmp_path, TIED)))
    assert [p.name for p in space.free] == ["n"]
    point = np.array([1.2])
    assert space.coefficients(point) == {"K_star": 2.4, "n": 1.2}
    assert space.value(point) == space.value_of({"K_star": 2.4, "n": 1.2})
    assert pickle.loads(pickle.dumps(space)).value(point) == space.value(point)


def test_a_fit_keeps_its_ties_and_says_so(tmp_path):
    result = calibrate(Campaign.read(write_bench(tmp_path, TIED)))
    assert all(run.coefficients["K_star"] == 2 * run.coefficients["n"] for run in result.runs)
    assert set(result.profiles) == {"n"}
    result.save(tmp_path / "result.json")
    again = read_result(tmp_path / "result.json")
    assert again == result
    assert again.estimates["K_star"].verdict == "= 2*n"


def test_a_law_fitted_to_measurements_may_have_ties():
    load = np.geomspace(10.0, 300.0, 8)
    pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    depth = laws.PowerLaw(n=1.1, K_star=2.2).penetration(load, pair)
    data = pd.DataFrame({"load_N_per_mm": load, "penetration_mm": depth})
    result = fit(data, "power", pair, ties={"K_star": "2*n"})
    assert result.coefficients == pytest.approx({"K_star": 2.2, "n": 1.1}, rel=1e-9)
    assert [*result.free] == ["n"]
