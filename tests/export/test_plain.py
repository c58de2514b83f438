"""The translator of plain functions: its rules, in three languages, and what it refuses."""

import ctypes
import math
import re
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest

from cylcontact import InputError
from cylcontact.export.notation import C, Fortran, Matlab, MatlabArrays
from cylcontact.export.plain import Constant, Program
from tests.support.export_runners import C_FLAGS, FORTRAN_FLAGS, compile_with, run_program

LEVEL, WEIGHTS = 2.5, np.array([0.5, 0.25, 0.125])
SUMS = np.dtype([("total", np.float64), ("parts", np.float64, 3), ("count", np.int64)])
Sums = Annotated[Any, SUMS]


class Split(NamedTuple):
    """A sign and a size."""

    sign: float
    size: float


def split(x: float) -> Split:
    """Return x as its sign and its size."""
    return Split(1 if x > 0 else -1, abs(x))


def add(x: float, sums: Sums) -> None:
    """Add weighted powers of x to the sums."""
    for k in range(3):
        sums.parts[k] += WEIGHTS[k] * x ** (k + 1)
        sums.total += sums.parts[k]
    for k in range(4, 0, -2):
        sums.count += 7 * k // 3 - k % 3


def evaluate(x: float, y: float, sums: Sums, law: Any) -> float:
    """Return a number that takes every rule; ΔR and δ² are Greek for ASCII."""
    sums.total = 0
    sums.count = 0
    for k in range(3):
        sums.parts[k] = 0
    add(x, sums)
    part = split(y)
    a, b = part.sign * part.size, -(x**2) / 3

    # Halve until the level is reached.
    turns = 0
    while abs(a) > LEVEL and not b > 0:
        a *= 0.5
        turns = turns + 1
        if turns == 40:
            break
    scale = law.scale if turns < 2 or (x < 0 and y < 0) else math.log1p(abs(b))
    return max(x, law.least) + min(a, 9) + scale * (b - a * (x - y)) + sums.total + sums.count


def of_arrays(x: float, y: float) -> float:
    """Return a number for arrays, elementwise."""
    z = np.where((x > 0) & (y > x), x * y, -(x**2.0))
    return np.exp(z / (1 + np.abs(y))) - np.maximum(x, 0.5) + np.copysign(1.0, x)


class Law(NamedTuple):
    """Constants."""

    scale: float
    least: float


LAW = Law(1.75, -0.5)
CONSTANTS = {
    "law": {"scale": Constant(float, 1.75, "Δ"), "least": Constant(float, -0.5)},
    "joint": {},
}
X, Y = np.meshgrid([-3.0, -0.5, 0.0, 0.25, 7.0, math.nan], [-90.0, -1.0, 0.0, 2.0, 11.0, math.nan])
X, Y = X.ravel(), Y.ravel()


def wanted():
    return [
        evaluate(x, y, np.zeros(1, SUMS).view(np.recarray)[0], LAW)
        for x, y in zip(X, Y, strict=True)
    ]


def translated(language):
    program = Program(CONSTANTS)
    program.read(evaluate)
    return language(program, {"evaluate": "evaluate"}, scratch="sums").parts()


def run_library(library):
    function = ctypes.CDLL(str(library)).evaluate
    function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double] * 2
    return [function(x, y) for x, y in zip(X, Y, strict=True)]


def test_c_computes_the_same(tmp_path):
    parts = translated(C)
    text = "\n".join(parts[name] for name in ("types", "constants", "helpers"))
    head = "#include <math.h>\n#include <stdbool.h>\ndouble evaluate(double x, double y);\n"
    (tmp_path / "f.c").write_text(f"{head}{text}\n{parts['program']}\n", encoding="ascii")
    compile_with("gcc", *C_FLAGS, tmp_path / "f.c", "-o", tmp_path / "f.so", "-lm")
    np.testing.assert_allclose(run_library(tmp_path / "f.so"), wanted(), rtol=1e-13)
    assert "// Halve until the level is reached.\n" in parts["program"]
    assert "dR and delta^2 are Greek" in parts["program"]


def test_fortran_computes_the_same(tmp_path):
    parts = translated(Fortran)
    program = (
        parts["program"]
        .replace(
            "function evaluate(x, y) result(answer)",
            "function evaluate(x, y) result(answer) bind(c)",
        )
        .replace("real(wp), intent(in) :: x, y", "real(wp), value :: x, y")
    )
    text = f"""module m
use, intrinsic :: iso_fortran_env, only: wp => real64
implicit none
private
public :: evaluate
{parts["types"]}
{parts["constants"]}
contains
{program}
{parts["helpers"]}
end module m
"""
    (tmp_path / "f.f90").write_text(text, encoding="ascii")
    flags = (*FORTRAN_FLAGS, "-Wno-c-binding-type", f"-J{tmp_path}")
    compile_with("gfortran", *flags, tmp_path / "f.f90", "-o", tmp_path / "f.so")
    np.testing.assert_allclose(run_library(tmp_path / "f.so"), wanted(), rtol=1e-13)


def octave(folder, parts, program, call):
    numbers = [program.number_of(*each) for each in program.program.numbers.items()]
    text = "\n".join(["1;", parts["constants"], *numbers, parts["program"], parts["helpers"]])
    X.tofile(folder / "x"), Y.tofile(folder / "y")
    read = "\n".join(
        f"id = fopen('{folder}/{n}', 'r'); {n} = fread(id, Inf, 'double'); fclose(id);"
        for n in "xy"
    )
    write = f"id = fopen('{folder}/z', 'w'); fwrite(id, z, 'double'); fclose(id);"
    (folder / "run.m").write_text(f"{text}\n{read}\n{call}\n{write}\n", encoding="ascii")
    run_program("octave-cli", "--no-gui", "--norc", "--quiet", folder / "run.m")
    return np.fromfile(folder / "z")


def test_matlab_computes_the_same(tmp_path):
    program = Program(CONSTANTS)
    program.read(evaluate)
    language = Matlab(program, {"evaluate": "evaluate"}, scratch="sums")
    call = "z = arrayfun(@(a, b) evaluate(a, b, law), x, y);"
    answers = octave(tmp_path, language.parts(), language, call)
    np.testing.assert_allclose(answers, wanted(), rtol=1e-13)


def test_matlab_computes_arrays(tmp_path):
    program = Program({})
    program.read(of_arrays)
    language = MatlabArrays(program)
    answers = octave(tmp_path, language.parts(), language, "z = of_arrays(x, y);")
    np.testing.assert_allclose(answers, of_arrays(X, Y), rtol=1e-13)


def f_names(x, dR):
    X = x * dR
    return X - x


def f_unpacks(x):
    sign, size = split(x)
    return sign * size


def f_chains(x):
    return 1 if 0 < x < 1 else 0


def f_unknown(x):
    return math.gamma(x)


def f_keyword(x):
    return split(x=x)


def f_items(x):
    total = 0
    for part in (x, 2 * x):
        total += part
    return total


def f_text(x):
    return x if x > 0 else "none"


def f_swaps(x, y):
    x, y = y, x
    return x - y


def f_slice(x: Annotated[Any, 3]):
    return add(x[1:], x)


def f_floor(x):
    return x // 2


def f_step(x, n: int):
    for k in range(0, 9, n):
        x += k
    return x


def f_list(x):
    return sum([x, x])


def f_law(x, law):
    return law.factor * x


def f_lines(x):
    # fmt: off
    return (
        x +
        {1: 2}[1]
    )
    # fmt: on


REFUSED = {
    f_names: ("x, X", "differ by case alone"),
    f_unpacks: ("sign, size = split(x)", "NamedTuple"),
    f_chains: ("0 < x < 1", "join two with `and`"),
    f_unknown: ("math.gamma(x)", "other languages"),
    f_keyword: ("split(x=x)", "plain arguments"),
    f_items: ("for part in (x, 2 * x):", "range"),
    f_text: ("'none'", "not a number"),
    f_swaps: ("x, y = (y, x)", "one assignment after the other"),
    f_slice: ("1:", "not in the rules"),
    f_floor: ("x // 2", "whole numbers"),
    f_step: ("for k in range(0, 9, n):", "literal"),
    f_list: ("[x, x]", "not in the rules"),
    f_law: ("law.factor", "law"),
    f_lines: ("{1: 2}", "not in the rules"),
}  # fmt: skip


@pytest.mark.parametrize("function", REFUSED, ids=lambda function: function.__name__)
def test_what_has_no_counterpart_is_refused_with_expression_and_line(function):
    expression, words = REFUSED[function]
    with pytest.raises(InputError) as caught:
        Program(CONSTANTS).read(function)
    text = str(caught.value)
    assert expression in text
    assert words in text
    line = int(text.partition("line ")[2].partition(":")[0])
    lines = Path(__file__).read_text(encoding="utf-8").splitlines()
    assert re.split("[(,]", expression.strip("'"))[0] in lines[line - 1]


def test_a_constant_has_one_value():
    program = Program({})
    program.read_text("def f(x):\n    return LEVEL * x", {"LEVEL": 1.0})
    with pytest.raises(InputError, match="two values"):
        program.read_text("def g(x):\n    return LEVEL * x", {"LEVEL": 2.0})
