"""Moments of whole rows of a logarithmic law: those of their samples, taken one by one."""

from dataclasses import fields

import numpy as np
import pytest

from cylcontact import CylinderPair, Material, laws
from cylcontact.datasets import Grid, Moments, merge, reduce_grid
from cylcontact.datasets.moments import logarithmic_moments
from cylcontact.datasets.sampling import blocks

LOGARITHMIC = [
    name for name in laws.REFERENCES if isinstance(laws.LAWS[name](), laws.LogarithmicLaw)
]


def pairs(count, dR=0.4):
    rng = np.random.default_rng(count)
    material = Material("rows", E=10 ** rng.uniform(4, 6, count), nu=rng.uniform(0.1, 0.5, count))
    return CylinderPair.from_dR("internal", dR, material)


def by_samples(law, pair, load):
    """Moments from the law's own penetrations."""
    E_star = np.broadcast_to(pair.E_star[:, None], (pair.E_star.size, load.size))
    material = Material("", 2 * E_star, 0.0)  # of the same E*
    delta = law.penetration(load, CylinderPair.from_dR("internal", pair.dR, material))
    return Moments.of_samples(pair.dR, np.log(load / E_star).ravel(), np.log(delta).ravel())


def assert_same(one, two):
    """Equal up to the rounding of sums of numbers of order ten."""
    scale = 1e-14 * float(two.count[0])
    for field in fields(Moments):
        a, b = getattr(one, field.name), getattr(two, field.name)
        assert a == pytest.approx(b, rel=1e-12, abs=0 if field.name == "count" else scale)


@pytest.mark.parametrize("name", LOGARITHMIC)
@pytest.mark.parametrize(("rows", "loads"), [(1, 1), (1, 40), (40, 1), (7, 90), (90, 7)])
def test_rows_give_the_moments_of_their_samples(name, rows, loads):
    law, pair, load = laws.LAWS[name](), pairs(rows), np.geomspace(0.1, 300.0, loads)
    assert_same(logarithmic_moments(law, pair, load, pair), by_samples(law, pair, load))


def test_grids_that_are_partly_masked_are_the_sum_of_their_samples():
    """Samples inside the domain go one way, rows that leave it the other."""
    E, dR = np.geomspace(20.0, 400.0, 9), np.array([0.005, 0.02])
    grid = Grid("internal", "johnson", E, np.array([0.2, 0.3]), dR, np.geomspace(1, 2000, 40))
    moments, counts = reduce_grid(grid)
    assert 0 < counts.masked < grid.size
    for place, gap in enumerate(grid.dR):
        sampled = [Moments.of_samples(gap, b.s, b.j) for b in blocks(grid, float(gap))]
        here = Moments(*(getattr(moments, f.name)[place : place + 1] for f in fields(Moments)))
        assert_same(here, merge(sampled))
    assert counts.samples == moments.total
    assert counts.samples + counts.masked == grid.size


def test_interpolated_moments_are_the_sums_in_long_double():
    """From Eq 1 itself, with nineteen digits where the machine has them."""
    law, pair, load = laws.Johnson(), pairs(150), np.geomspace(0.1, 300.0, 170)
    f, E_star = load.astype(np.longdouble), pair.E_star.astype(np.longdouble)[:, None]
    pi = np.longdouble("3.14159265358979323846264338")
    s = np.log(f) - np.log(E_star)
    j = s - np.log(pi) + np.log(np.log(4 * pi * np.longdouble(pair.dR) / f * E_star) - 1)
    s0, j0 = s - s.mean(), j - j.mean()
    sums = [s.mean(), j.mean(), (s0 * s0).sum(), (s0 * j0).sum(), (j0 * j0).sum()]
    m = logarithmic_moments(law, pair, load, pair)
    actual = [m.mean_s, m.mean_j, m.ss, m.sj, m.jj]
    assert np.concatenate(actual) == pytest.approx(np.array(sums, dtype=float), rel=2e-14)
    unexplained = sums[4] - sums[3] ** 2 / sums[2]
    assert m.unexplained == pytest.approx(float(unexplained), rel=1e-10)
