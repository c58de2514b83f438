"""Compiled scalar laws: the array laws' numbers, one at a time."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.laws.kernels import TABLE, branch_distance, kernel, kernel_load, kernel_stiffness
from cylcontact.laws.lambert import branch_distance as branch_distances
from cylcontact.laws.tabulated import DEEPEST, TABLE_ERROR, cubic, tabulate
from tests.strategies import ROUNDING, fractions

STEEL = Material("steel", E=207e3, nu=0.3)
BRONZE = Material("bronze", E=110e3, nu=0.34)
PAIRS = {
    "wide": CylinderPair.internal(R_i=10.0, R_j=9.5, material=STEEL, length=10.0),
    "tight": CylinderPair.internal(R_i=10.0, R_j=9.98, material=STEEL, length=10.0),
    "rollers": CylinderPair.external(R_i=10.0, R_j=25.0, material=STEEL, length=10.0),
}
MIXED = CylinderPair.internal(R_i=10.0, R_j=9.5, material=STEEL, material_j=BRONZE, length=10.0)
FOR_INTERNAL_ONLY = ("liu", "persson", "winkler")
CASES = [
    pytest.param(law(), pair, id=f"{name}-{which}")
    for name, law in laws.LAWS.items()
    for which, pair in PAIRS.items()
    if pair.contact == "internal" or name not in FOR_INTERNAL_ONLY
] + [
    pytest.param(laws.Johnson(), MIXED, id="johnson-mixed"),
    pytest.param(laws.Enhanced({"a": 0.4, "b": 1.05, "n": 1.09}), PAIRS["rollers"], id="refitted"),
    pytest.param(laws.PowerLaw(n=1.2, K=3e5), PAIRS["wide"], id="power"),
    pytest.param(laws.Explicit({"c": 1.4, "A": 0.36, "B": 3.0}), PAIRS["wide"], id="own-constants"),
    pytest.param(laws.Winkler(depth=0.3), PAIRS["tight"], id="winkler-stiff"),
]


def penetrations(law, pair):
    """Penetrations in mm from next to nothing to the end of the law, or far beyond ΔR."""
    end = min(float(law.max_penetration(pair)), 10 * float(pair.dR))
    close = 1 - 10.0 ** -np.arange(1.0, 9.0)
    return np.concatenate([np.geomspace(1e-25, 0.9, 700) * end, close * end])


def loads(made, deltas):
    return np.array([kernel_load(made.kind, made.parameters, delta) for delta in deltas])


def stiffnesses(made, deltas):
    return np.array([kernel_stiffness(made.kind, made.parameters, delta) for delta in deltas])


@pytest.mark.parametrize(("law", "pair"), CASES)
def test_load_is_that_of_the_array_law(law, pair):
    made, deltas = kernel(law, pair), penetrations(law, pair)
    allowed = TABLE_ERROR if made.kind == TABLE else 12 * ROUNDING
    np.testing.assert_allclose(loads(made, deltas), law.load(deltas, pair), rtol=allowed)


@pytest.mark.parametrize(("law", "pair"), CASES)
def test_stiffness_is_that_of_the_array_law(law, pair):
    made, deltas = kernel(law, pair), penetrations(law, pair)
    # Near the end of a logarithmic law, where it is infinite, the stiffness is as uncertain as
    # the penetration's own last digit makes it.
    end = float(law.max_penetration(pair))
    left = 1 - deltas / end if np.isfinite(end) else np.ones_like(deltas)
    allowed = 2e-7 if made.kind == TABLE else 20 * ROUNDING / left
    exact = law.stiffness(deltas, pair)
    assert np.all(np.abs(stiffnesses(made, deltas) - exact) <= allowed * exact)


@pytest.mark.parametrize(("law", "pair"), CASES)
def test_without_penetration_there_is_no_load(law, pair):
    made = kernel(law, pair)
    assert (loads(made, [0.0, -0.0, -1e-9, -np.inf]) == 0).all()
    assert (stiffnesses(made, [0.0, -1e-9]) == 0).all()


@pytest.mark.parametrize(("law", "pair"), CASES)
def test_beyond_the_largest_penetration_and_at_nan_there_is_no_number(law, pair):
    made = kernel(law, pair)
    beyond = [np.nan]
    if np.isfinite(made.max_penetration):
        beyond += [made.max_penetration * (1 + 1e-9), 10 * made.max_penetration]
    assert np.isnan(loads(made, beyond)).all()
    assert np.isnan(stiffnesses(made, beyond)).all()


@pytest.mark.parametrize("name", ["johnson", "hertz-cylinder", "goldsmith"])
def test_a_logarithmic_law_ends_at_its_largest_load(name):
    law, pair = laws.LAWS[name](), PAIRS["tight"]
    made = kernel(law, pair)
    end = made.max_penetration
    assert end == law.max_penetration(pair)
    assert kernel_load(made.kind, made.parameters, end) == pytest.approx(float(law.max_load(pair)))
    assert kernel_stiffness(made.kind, made.parameters, end) == np.inf


@given(fractions)
def test_scalar_branch_distance_is_the_one_of_arrays(p):
    inner = min(p, 1 - ROUNDING)
    w = branch_distances(np.array(inner))
    assert abs(branch_distance(inner) - w) <= 4 * ROUNDING * (1 + w)


def test_scalar_branch_distance_ends_where_that_of_arrays_ends():
    assert branch_distance(1.0) == 0
    assert np.isnan(branch_distance(1 + 2 * ROUNDING))
    assert np.isnan(branch_distance(np.nan))


# --- tables -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class TwoSprings:
    """A law of one's own: soft at first, stiffer from a tenth of ΔR on, with a kink there."""

    first: float = 1e4
    second: float = 5e4
    name = "two springs"

    def load(self, penetration, pair):
        delta = np.asarray(penetration, dtype=float)
        kink = pair.dR / 10
        return self.first * delta + (self.second - self.first) * np.maximum(delta - kink, 0)

    def stiffness(self, penetration, pair):
        return np.where(np.asarray(penetration) < pair.dR / 10, self.first, self.second)

    def max_penetration(self, pair):
        return np.float64(2 * pair.dR)


@dataclass(frozen=True)
class Overridden(laws.Johnson):
    """Johnson's law with another load: no longer the formula that the kernel knows."""

    def load(self, penetration, pair):
        return 2 * super().load(penetration, pair)

    def stiffness(self, penetration, pair):
        return 2 * super().stiffness(penetration, pair)


@given(part=st.floats(1e-12, 1.999))
def test_a_law_of_ones_own_is_tabulated_to_its_end(part):
    law, pair = TwoSprings(), PAIRS["wide"]
    made = TWO_SPRINGS
    delta = part * pair.dR
    assert made.max_penetration == 2 * pair.dR
    actual = kernel_load(made.kind, made.parameters, delta)
    assert actual == pytest.approx(float(law.load(delta, pair)), rel=TABLE_ERROR)


TWO_SPRINGS = kernel(TwoSprings(), PAIRS["wide"])


def test_a_subclass_with_a_load_of_its_own_is_tabulated_up_to_its_vertical_tangent():
    law, pair = Overridden(), PAIRS["tight"]
    made = kernel(law, pair)
    assert made.kind == TABLE
    end = float(law.max_penetration(pair))
    assert made.max_penetration == end
    deltas = end * np.array([1e-20, 1e-3, 0.5, 0.99, 1 - 1e-6, 1 - 1e-11])
    np.testing.assert_allclose(loads(made, deltas), law.load(deltas, pair), rtol=TABLE_ERROR)
    assert np.isnan(kernel_load(made.kind, made.parameters, end * (1 + 1e-9)))


def test_a_law_without_end_is_tabulated_far_beyond_any_contact():
    pair = PAIRS["tight"]
    made = kernel(laws.Persson(), pair)
    assert made.max_penetration == DEEPEST * pair.dR
    assert np.isnan(kernel_load(made.kind, made.parameters, 1.001 * made.max_penetration))


def test_below_the_table_the_law_goes_on_as_a_power():
    pair = PAIRS["tight"]
    made = kernel(laws.Winkler(), pair)
    tiny = 1e-34 * pair.dR
    exact = float(laws.Winkler().load(tiny, pair))
    assert kernel_load(made.kind, made.parameters, tiny) == pytest.approx(exact, rel=1e-9)


def test_the_cubic_is_any_cubic_of_the_same_values_and_slopes():
    p = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0])
    a, b, at = 0.2, 0.9, np.linspace(0.2, 0.9, 7)
    rise = (p(b) - p(a)) / (b - a)
    above, slope = cubic((at - a) / (b - a), b - a, rise, p.deriv()(a), p.deriv()(b))
    np.testing.assert_allclose(p(a) + above, p(at), rtol=1e-13)
    np.testing.assert_allclose(slope, p.deriv()(at), rtol=1e-12)


# --- inside compiled code, and refusals ---------------------------------------------------------


@njit
def work(kind, parameters, deltas):
    """The work done from each penetration to the next, by the trapezoidal rule."""
    done = 0.0
    for one, two in zip(deltas[:-1], deltas[1:]):  # noqa: B905, RUF007 - not known to numba
        mean = (kernel_load(kind, parameters, one) + kernel_load(kind, parameters, two)) / 2
        done += mean * (two - one)
    return done


def test_one_compiled_function_serves_every_kind_of_law():
    pair, deltas = PAIRS["wide"], np.linspace(0.0, 0.02, 5001)
    for name in ("johnson", "enhanced", "liu", "explicit", "persson"):
        law = laws.LAWS[name]()
        made = kernel(law, pair)
        expected = np.trapezoid(law.load(deltas, pair), deltas)
        assert work(made.kind, made.parameters, deltas) == pytest.approx(expected, rel=1e-9)
    assert len(work.signatures) == 1


def test_pairs_held_in_arrays_are_refused():
    pair = CylinderPair.from_dR("internal", np.array([0.1, 0.2]), STEEL)
    with pytest.raises(InputError, match=r"^kernel: pair = '2 pairs': must be a single one; make"):
        kernel(laws.Johnson(), pair)


def test_a_pair_outside_the_law_is_refused():
    pair = CylinderPair.from_dR("internal", 0.001, STEEL)
    with pytest.raises(InputError, match=r"pair\.dR = 0\.001: the enhanced law is undefined"):
        kernel(laws.Enhanced(), pair)


@dataclass(frozen=True)
class Hole(TwoSprings):
    """A law that is not defined throughout."""

    name = "law with a hole"

    def load(self, penetration, pair):
        actual = super().load(penetration, pair)
        return np.where(np.abs(penetration - 0.1 * pair.dR) < 0.05 * pair.dR, np.nan, actual)


@dataclass(frozen=True)
class Rough(TwoSprings):
    """A law whose stiffness is not the derivative of its load."""

    name = "rough law"

    def stiffness(self, penetration, pair):
        return 2 * super().stiffness(penetration, pair)


@pytest.mark.parametrize(
    ("law", "rule"),
    [
        (Hole(), r"^tabulate: law = 'law with a hole': its load or its stiffness is not a pos"),
        (Rough(), r"^tabulate: law = 'rough law': its load is not smooth: 200000 nodes"),
    ],
)
def test_laws_that_no_table_can_hold_are_refused(law, rule):
    with pytest.raises(InputError, match=rule):
        tabulate(law, PAIRS["wide"])
