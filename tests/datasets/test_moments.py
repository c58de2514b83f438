"""Moments: exactly the sum of squares of the samples they stand for, however they are merged."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cylcontact.datasets import Moments, concatenate, merge

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
