"""Moments: exactly the sum of squares of the samples they stand for, however they are merged."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.datasets import Grid, Moments, concatenate, merge, reduce_grid
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.reference import OnMoments
from tests.support.strategies import powers_of_ten

JOHNSON = laws.Johnson()


def axis(values, least, most):
    """Strategy for the distinct, increasing values of an axis."""
    return st.lists(values, min_size=least, max_size=most, unique=True).map(sorted).map(np.array)


grids = st.builds(
    Grid,
    st.sampled_from(["internal", "external"]),
    st.just("johnson"),
    axis(powers_of_ten(0, 4), 1, 4),
    axis(st.floats(0.0, 0.5), 1, 3),
    axis(powers_of_ten(-2.3, 1.0).filter(lambda dR: 0.005 <= dR < 10.0), 1, 4),
    axis(powers_of_ten(-1, 3), 2, 8),
)
# Coefficients around the published ones of the enhanced law.
ENDS = {
    "internal": [(0.2, 1.5), (0.01, 0.5), (1.2, 2.0), (-0.4, -0.05), (-0.05, 0.05), (1.0, 1.3),
                 (-0.05, 0.05)],
    "external": [(0.2, 1.5), (0.1, 3.0), (1.0, 1.4)],
}  # fmt: skip


@pytest.mark.slow
@given(grid=grids, data=st.data())
def test_the_objective_is_that_of_the_samples_one_by_one(grid, data):
    candidate = data.draw(st.tuples(*(st.floats(*ends) for ends in ENDS[grid.contact])))
    model = MODELS["enhanced", grid.contact]
    switch = (0.34954,) if "Y_switch" in model.names else ()  # a printed number, never searched
    law = laws.Enhanced(dict(zip(model.names, (*candidate, *switch), strict=True)))
    squares, count = 0.0, 0
    for E, nu, dR, load in product(grid.E, grid.nu, grid.dR, grid.load):
        pair = CylinderPair.from_dR(grid.contact, float(dR), Material("", E * 1e3, nu))
        reference = JOHNSON.penetration(load, pair)
        if np.isfinite(reference):
            squares += np.log(law.penetration(load, pair) / reference) ** 2
            count += 1
    if count == 0:
        with pytest.raises(InputError):
            reduce_grid(grid)
        return
    moments, counts = reduce_grid(grid)
    assert counts.samples == moments.total == count
    assert counts.masked == grid.size - count
    value = OnMoments(model, model.parameters, moments).value(np.array(candidate))
    assert value == pytest.approx(np.sqrt(squares / count), rel=1e-10, abs=1e-13)


numbers = st.floats(-100.0, 100.0)
samples = st.lists(st.tuples(numbers, numbers), min_size=1, max_size=40).map(np.array)


def moments_of(points, dR=0.5):
    s, j = np.reshape(points, (-1, 2)).T
    return Moments.of_samples(dR, s, j)


def exact(points):
    """Return the five numbers of samples in rational arithmetic, as floats."""
    s, j = ([Fraction(float(value)) for value in column] for column in np.transpose(points))
    mean_s, mean_j = sum(s) / len(s), sum(j) / len(j)
    ds, dj = [value - mean_s for value in s], [value - mean_j for value in j]

    def dot(one, two):
        return float(sum(x * y for x, y in zip(one, two, strict=True)))

    return (float(mean_s), float(mean_j), dot(ds, ds), dot(ds, dj), dot(dj, dj))


def numbers_of(m):
    return tuple(float(value[0]) for value in (m.mean_s, m.mean_j, m.ss, m.sj, m.jj))


@given(points=samples, data=st.data())
def test_any_partition_merged_in_any_order_gives_the_whole(points, data):
    order = data.draw(st.permutations(range(len(points))))
    cuts = sorted(data.draw(st.lists(st.integers(0, len(points)), max_size=40)))
    parts = [moments_of(part) for part in np.split(points[list(order)], cuts)]
    merged = merge(data.draw(st.permutations(parts)))
    scale = max(1.0, np.abs(points).max()) * np.sqrt(len(points))
    assert merged.count == len(points)
    mean_s, mean_j, *sums = exact(points)
    actual = numbers_of(merged)
    assert actual[:2] == pytest.approx((mean_s, mean_j), abs=1e-13 * scale)
    assert actual[2:] == pytest.approx(sums, abs=1e-12 * scale**2)


def test_many_clearances_merge_each_with_its_own():
    first = concatenate([moments_of([[1.0, 2.0]], dR=0.1), moments_of(np.empty((0, 2)), dR=0.2)])
    second = concatenate([moments_of([[3.0, 6.0]], dR=0.1), moments_of([[5.0, 5.0]], dR=0.2)])
    merged = merge([first, second])
    assert merged.dR.tolist() == [0.1, 0.2]
    assert merged.count.tolist() == [2, 1]
    assert (merged.mean_s.tolist(), merged.mean_j.tolist()) == ([2, 5], [4, 5])
    assert (merged.ss.tolist(), merged.sj.tolist(), merged.jj.tolist()) == ([2, 0], [4, 0], [8, 0])
    assert (merged.slope.tolist(), merged.unexplained.tolist()) == ([2, 0], [0, 0])


@pytest.mark.parametrize("offset", [0.0, 1e2, 1e5])
def test_means_far_from_zero_cancel_nothing(offset):
    """The sums of products of uncentred samples would lose eight digits more."""
    rng = np.random.default_rng(2)
    s = rng.normal(size=300)
    points = np.column_stack([s + offset, 0.9 * s + 0.1 * rng.normal(size=300) - offset])
    expected = exact(points)
    allowed = max(1e-13, 1e-15 * offset)  # the means are only known to their last digit
    whole, parts = moments_of(points), merge(moments_of(p) for p in np.array_split(points, 17))
    assert numbers_of(whole) == pytest.approx(expected, rel=allowed, abs=allowed)
    assert numbers_of(parts) == pytest.approx(expected, rel=10 * allowed, abs=10 * allowed)


@given(points=samples.filter(lambda points: np.ptp(points[:, 0]) > 1e-3))
def test_slope_and_unexplained_are_those_of_the_least_squares_line(points):
    s, j = points.T
    line = np.polynomial.Polynomial.fit(s, j - j.mean(), deg=1)
    slope, left = line.deriv()(0.0), float(((j - j.mean() - line(s)) ** 2).sum())
    moments, spread = moments_of(points), np.ptp(j) + 1e-9
    assert moments.slope == pytest.approx(slope, rel=1e-9, abs=1e-9 * spread / np.ptp(s))
    assert moments.unexplained == pytest.approx(left, rel=1e-9, abs=1e-9 * spread**2)
