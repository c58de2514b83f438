"""Fits of ISO 286 against the standard's own formulas, and joints that take a fit."""

from itertools import pairwise

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material
from cylcontact.bodies.iso286 import IsoFit, diameters
from cylcontact.files.spec import read_toml
from cylcontact.joint import joint_from
from tests.support.spec_files import DROP, changed

STEEL, BRONZE = Material("steel", 207e3, 0.3), Material("bronze", 110e3, 0.34)
ENDS = (6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)
SIZES = list(pairwise((3, *ENDS)))
OF_c = (40, 50, 65, 80, 100, 120, 140, 160, 180, 200, 225, 250, 280, 315, 355, 400, 450, 500)


def upper(code):
    """The deviation nearest to zero of a pin, µm."""
    low, high = IsoFit.read(f"{code[0]}H7/{code[1]}").pin
    return 1e3 * min(low, high, key=abs)


@pytest.mark.parametrize(
    ("code", "low", "high"),
    [("20H7/g6", 3.5, 20.5), ("10H7/f7", 6.5, 21.5), ("20H7/h6", 0, 17), ("20H7/k6", -7.5, 9.5),
     ("20JS7/h6", -5.25, 11.75), ("500H11/c11", 240, 640), ("60H8/e8", 30, 76), ("3H7/g6", 1, 9),
     ("20F8/h7", 10, 37), ("40E9/h9", 25, 87), ("60D10/h9", 50, 147), ("25C11/h11", 55, 185)],
)  # fmt: skip
def test_the_radial_clearance_is_that_of_the_standard(code, low, high):
    assert [1e3 * value for value in IsoFit.read(code).clearance] == pytest.approx([low, high])


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_grades_follow_from_the_tolerance_unit(size):
    """i = 0.45·D^(1/3) + 0.001·D at the geometric mean of the sizes, and IT5 to IT11 are 7 to 100i.

    The standard rounds it, coarsely at small sizes and with exceptions of its own.
    """
    D = np.sqrt(np.prod(size))
    unit = 0.45 * np.cbrt(D) + 0.001 * D
    for grade, factor in zip(range(5, 12), (7, 10, 16, 25, 40, 64, 100), strict=True):
        low, high = IsoFit.read(f"{size[1]}H{grade}/h6").hole
        assert low == 0
        assert 1e3 * high == pytest.approx(factor * unit, rel=0.04, abs=0.75)


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_deviations_follow_from_the_formulas_of_the_standard(size):
    D = np.sqrt(np.prod(size))
    formulas = {
        "d": -16 * D**0.44, "e": -11 * D**0.41, "f": -5.5 * D**0.41, "g": -2.5 * D**0.34, "h": 0,
        "k": 0.6 * np.cbrt(D), "n": 5 * D**0.34,
    }  # fmt: skip
    for letter, value in formulas.items():
        assert upper((size[1], f"{letter}6")) == pytest.approx(value, rel=0.045, abs=1.0), letter
    (_, IT7), (_, IT6) = (IsoFit.read(f"{size[1]}H{grade}/h6").hole for grade in (7, 6))
    # m is their difference as rounded before, so 1 µm of rounding for each.
    assert upper((size[1], "m6")) == pytest.approx(1e3 * (IT7 - IT6), abs=2.01)


# Steps of u, and of r and s above 50 mm; the formulas of p, r, s and u.
OF_u = (18, 24, 30, *OF_c)


@pytest.mark.parametrize(("over", "to"), [*SIZES[:3], *pairwise(OF_u)])
def test_press_fits_follow_from_the_formulas_of_the_standard(over, to):
    """p = IT7 + 0 to 5; s = IT8 + 1 to 4, above 50 mm IT7 + 0.4·D; r = √(p·s); u = IT7 + D.

    The standard rounds r and u; below 18 mm its u is up to 7 µm above its formula.
    """
    D = np.sqrt(over * to)
    wide = next(ends for ends in SIZES if to <= ends[1])  # p, and s up to 50 mm, have wide steps
    assert D <= wide[1]
    p, r, s, u = (1e3 * (diameters(f"{to}{letter}6")[0] - to) for letter in "prsu")
    IT7, IT8 = (1e3 * (diameters(f"{to}H{grade}")[1] - to) for grade in (7, 8))
    assert -0.01 <= p - IT7 <= 5.01
    if to <= 50:
        assert 0.99 <= s - IT8 <= 4.01
    else:
        assert s == pytest.approx(IT7 + 0.4 * D, abs=2.5)
    assert r == pytest.approx(np.sqrt(p * s), abs=1.2)
    if over >= 18:
        assert u == pytest.approx(IT7 + D, rel=0.012, abs=1.0)
    else:
        assert 0 < u - IT7 - D < 7


def test_press_fits_have_the_numbers_of_a_published_table():
    """K. L. Narayana et al., Machine Drawing, Tables 15.2 and 15.3, columns p, r, s, u."""
    printed = {
        6: (12, 15, 19, 23), 10: (15, 19, 23, 28), 18: (18, 23, 28, 33), 24: (22, 28, 35, 41),
        30: (22, 28, 35, 48), 50: (26, 34, 43, 70), 65: (32, 41, 53, 87), 120: (37, 54, 79, 144),
        160: (43, 65, 100, 190), 200: (50, 77, 122, 236), 280: (56, 94, 158, 315),
        400: (62, 114, 208, 435), 500: (68, 132, 252, 540),
    }  # fmt: skip
    for size, values in printed.items():
        for letter, value in zip("prsu", values, strict=True):
            low, high = diameters(f"{size}{letter}7")
            assert 1e3 * (low - size) == pytest.approx(value)
            assert high - low == pytest.approx(np.diff(diameters(f"{size}H7"))[0])
    assert IsoFit.read("20H7/p6").kind == "interference"


@pytest.mark.parametrize(
    ("code", "rule"),
    [("20", "not a class"), ("20H7/g6", "not a class"), ("2H7", "outside ISO 286"),
     ("26t6", "a pin t"), ("20P7", "a hole P"), ("20s12", "grade 12"), ("20j8", "has a pin j8")],
)  # fmt: skip
def test_a_class_that_the_tables_lack_is_refused(code, rule):
    with pytest.raises(InputError, match=rule):
        diameters(code)


@pytest.mark.parametrize(("over", "to"), list(pairwise(OF_c)))
def test_c_has_steps_of_its_own(over, to):
    assert -upper((to, "c9")) == pytest.approx(95 + 0.8 * np.sqrt(over * to), rel=0.03)


def test_k_above_grade_7_begins_at_zero_and_j_has_few_grades():
    assert IsoFit.read("20H7/k8").pin == (0, 0.033)
    assert IsoFit.read("20H7/j6").pin == pytest.approx((-0.004, 0.009))


def test_a_fit_is_a_pair_from_the_tightest_to_the_loosest():
    pair = CylinderPair.from_iso("20H7/g6", pin=STEEL, hole=BRONZE, length=15.0)
    assert 2 * pair.R_i == pytest.approx([20, 20.0105, 20.021])
    assert 2 * pair.R_j == pytest.approx([19.993, 19.9865, 19.98])
    assert (pair.material_i, pair.material_j, pair.length) == (BRONZE, STEEL, 15.0)
    # Zero clearance is a limit: laws have a value beside it.
    assert CylinderPair.from_iso("20H7/h6", STEEL).dR[0] == pytest.approx(1e-6)


JOINT = changed(
    read_toml("datasets/joint.toml"), {"bearing.R": DROP, "pin.R": DROP, "iso": "20H7/g6"}
)


def test_a_joint_of_a_fit_is_that_of_the_middle_of_its_band():
    joint = joint_from(JOINT)
    assert joint.radial == pytest.approx(0.012)
    by_hand = changed(JOINT, {"iso": DROP, "bearing.R": 10.00525, "pin.R": 9.99325})
    assert joint.first_yield == pytest.approx(joint_from(by_hand).first_yield)


def test_half_a_micrometre_is_printed():
    assert "±" not in str(IsoFit.read("10JS7/js6"))
    assert "-0.0075 +0.0075" in str(IsoFit.read("10JS7/js6"))
