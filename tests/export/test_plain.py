"""The translator of plain functions: its rules, in three languages, and what it refuses."""

import ctypes
import math
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest

from cylcontact import InputError
from cylcontact.export.languages import C, Fortran, Matlab, MatlabArrays
from cylcontact.export.plain import Program
from tests.support.export_runners import C_FLAGS, FORTRAN_FLAGS, compile_with, run_octave_script

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


split_of_module = split


def add(x: float, sums: Sums) -> None:
    """Add weighted powers of x to the sums."""
    for k in range(3):
        sums.parts[k] += WEIGHTS[k] * x ** (k + 1)
        sums.total += sums.parts[k]
    for k in range(4, 0, -2):
        sums.count += 7 * k // 3 - k % 3 + abs(k - 3)


def evaluate(x: float, y: float, sums: Sums, law: Any, spare: float) -> float:  # noqa: ARG001
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
    last = 0
    while abs(a) > LEVEL and not b > 0:
        a *= 0.5
        last = 0.5 * last
        turns = turns + 1
        if turns == 40:
            break
    scale = law.scale if turns < 2 or (x < 0 and y < 0) else math.log1p(abs(b))
    return max(x, law.least) + min(a, 9) + scale * (b - a * (x - y)) + sums.total + sums.count


def of_arrays(x: float, y: float) -> float:
    """Return a number for arrays, elementwise."""
    z = np.where((x > 0) & (y > x), x * y, -(x**2.0))
    return np.exp(z / (1 + np.abs(y))) - np.maximum(x, 0.5) + np.copysign(1.0, x)


LAW = np.array([(1.75, -0.5, 7.0)], [(name, np.float64) for name in ("scale", "least", "unused")])
RECORDS = {"law": LAW.dtype}
X, Y = np.meshgrid([-3.0, -0.5, 0.0, 0.25, 7.0, math.nan], [-90.0, -1.0, 0.0, 2.0, 11.0, math.nan])
X, Y = X.ravel(), Y.ravel()


def wanted():
    return [
        evaluate(x, y, np.zeros(1, SUMS).view(np.recarray)[0], LAW.view(np.recarray)[0], 0.0)
        for x, y in zip(X, Y, strict=True)
    ]


def translated(language):
    program = Program(RECORDS)
    program.read(evaluate)
    return language(program, {SUMS: "Sums", LAW.dtype: "Law"})


def parts_of(language):
    law = language.constant("this_law", LAW.dtype, LAW[0], {"scale": "Δ"})
    return {**language.parts(), "law": law}


def run_library(library):
    function = ctypes.CDLL(str(library)).run
    function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double] * 2
    return [function(x, y) for x, y in zip(X, Y, strict=True)]


C_FILE = """#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
{types}
{numbers}
{law}
{helpers}
{program}
double run(double x, double y);
double run(double x, double y)
{{
    Sums sums;
    return evaluate(x, y, &sums, &this_law);
}}
"""
FORTRAN_FILE = """module m
use, intrinsic :: iso_fortran_env, only: wp => real64
implicit none
private
public :: run
{types}
{numbers}
{law}
contains
function run(x, y) result(z) bind(c)
real(wp), value :: x, y
real(wp) :: z
type(sums_type) :: sums
z = evaluate(x, y, sums, this_law)
end function run
{program}
{helpers}
end module m
"""


def test_c_computes_the_same(tmp_path):
    parts = parts_of(translated(C))
    (tmp_path / "f.c").write_text(C_FILE.format(**parts), encoding="ascii")
    compile_with("gcc", *C_FLAGS, tmp_path / "f.c", "-o", tmp_path / "f.so", "-lm")
    np.testing.assert_allclose(run_library(tmp_path / "f.so"), wanted(), rtol=1e-13)
    assert "// Halve until the level is reached.\n" in parts["program"]
    assert "dR and delta^2 are Greek" in parts["program"]
    assert ".scale = 1.75, // d\n" in parts["law"]
    assert "unused" not in parts["law"] + parts["types"]
    assert "spare" not in parts["program"]


def test_fortran_computes_the_same(tmp_path):
    text = FORTRAN_FILE.format(**parts_of(translated(Fortran)))
    (tmp_path / "f.f90").write_text(text, encoding="ascii")
    flags = (*FORTRAN_FLAGS, "-Wno-c-binding-type", f"-J{tmp_path}")
    compile_with("gfortran", *flags, tmp_path / "f.f90", "-o", tmp_path / "f.so")
    np.testing.assert_allclose(run_library(tmp_path / "f.so"), wanted(), rtol=1e-13)


def octave(folder, parts, call):
    names = ("numbers", "program", "helpers")
    text = "\n".join(["1;", parts.get("law", ""), *(parts[name] for name in names)])
    given = f"x = [{' '.join(map(repr, X.tolist()))}]; y = [{' '.join(map(repr, Y.tolist()))}];"
    script = f"{text}\n{given}\n{call}\nprintf('%.17g\\n', z);\n"
    return np.array(run_octave_script(script, folder).split(), float)


def test_matlab_computes_the_same_also_of_arrays(tmp_path):
    language = translated(Matlab)
    call = f"z = arrayfun(@(a, b) evaluate(a, b, {language.zeros(SUMS)}, this_law), x, y);"
    np.testing.assert_allclose(octave(tmp_path, parts_of(language), call), wanted(), rtol=1e-13)
    program = Program()
    program.read(of_arrays)
    answers = octave(tmp_path, MatlabArrays(program).parts(), "z = of_arrays(x, y);")
    np.testing.assert_allclose(answers, of_arrays(X, Y), rtol=1e-13)


# The body of a function that begins on line 7; the line that is refused, and why.
REFUSED = {
    "X = x * 2; return X - x": ("7: `x, X", "differ by case alone"),
    "sign, size = split(x); return sign * size": ("8: `sign, size = split(x)", "NamedTuple"),
    "return 1 if 0 < x < 1 else 0": ("8: `0 < x < 1", "join two with `and`"),
    "return math.gamma(x)": ("8: `math.gamma(x)", "other languages"),
    "return split(x=x)": ("8: `split(x=x)", "plain arguments"),
    "for part in (x, 2 * x): y += part": ("8: `for part in (x, 2 * x):", "range"),
    "return x if x > 0 else 'none'": ("8: `'none'", "not a number"),
    "x, y = y, x": ("8: `x, y = (y, x)", "one assignment after the other"),
    "return add(vector[1:], x)": ("8: `1:", "not in the rules"),
    "return x // 2": ("8: `x // 2", "whole numbers"),
    "for k in range(0, 9, n): x += k": ("8: `for k in range(0, 9, n):", "literal"),
    "return sum([x, x])": ("8: `[x, x]", "not in the rules"),
    "return law.factor * x": ("8: `law.factor", "is not a number of the record"),
    "law.least = change(law); return x": ("8: `law.least = change(law)", "use a variable"),
    "x = split(y); return x.size": ("8: `x = split(y)", "changes the type of x"),
    "\n    y = x +\\\n        {1: 2}[1]": ("10: `{1: 2}", "not in the rules"),
    "x = y = 1": ("8: `x = y = 1", "write two assignments"),
    "x + 1": ("8: `x + 1", "does nothing"),
    "while x > 0: x -= 1\n    else: x = 2": ("8: `while x > 0:", "is a loop with an else"),
    "return missing * x": ("8: `missing", "is not defined"),
    "return split * x": ("8: `split", "is neither a number nor a vector"),
    "return split() * x": ("8: `split()", "give all of x"),
    "f = x; return f": ("7: `f", "has a variable of its own name"),
}


def change(law: Annotated[Any, LAW.dtype]) -> float:
    """Return a number, and change a record."""
    law.scale = 1.0
    return law.scale


HINTS = {"n": int, "vector": Annotated[Any, 3]}


@pytest.mark.parametrize("body", REFUSED)
def test_what_has_no_counterpart_is_refused_with_expression_and_line(body):
    where, words = REFUSED[body]
    text = f"def f(x, y, n, vector, law):\n    {body}"
    with pytest.raises(InputError) as caught:
        Program(RECORDS).read_text(text, globals(), HINTS, "a/mine.py", 7)
    assert str(caught.value).startswith(f"f, mine.py, line {where}")
    assert words in str(caught.value)


def test_a_constant_has_one_value():
    program = Program()
    program.read_text("def f(x):\n    return LEVEL * x", {"LEVEL": 1.0})
    with pytest.raises(InputError, match="two values"):
        program.read_text("def g(x):\n    return LEVEL * x", {"LEVEL": 2.0})


def test_functions_have_names_of_their_own_and_plain_arguments():
    def split(x):
        return x

    program = Program()
    program.read(split_of_module)
    with pytest.raises(InputError, match="has the name of another function"):
        program.read(split)
    with pytest.raises(InputError, match="takes other than plain arguments"):
        program.read_text("def g(*x):\n    return 1.0", {})
