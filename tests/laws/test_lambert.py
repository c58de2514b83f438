import numpy as np
import pytest
from mpmath import mp

from cylcontact.laws.lambert import branch_distance
from tests.support.strategies import ROUNDING

DENSE = np.concatenate(
    [
        10.0 ** -np.linspace(0.001, 300, 2001),
        1 - 10.0 ** -np.linspace(1, 16, 1001),
        1 - np.arange(1, 65) * 2.0**-53,  # the last 64 numbers below 1
        np.arange(1, 20) * 5e-324,  # the first subnormals
    ]
)


def exact(p):
    """w at 40 digits, from mpmath's own Lambert function."""
    return -1 - mp.lambertw(-mp.mpf(float(p)) / mp.e, -1).real


def worst_error(ps):
    """The largest error of w, in roundings of 1 + w."""
    with mp.workdps(40):
        errors = [
            abs(mp.mpf(float(w)) - exact(p)) / (1 + exact(p))
            for p, w in zip(ps, branch_distance(ps), strict=True)
        ]
        return float(max(errors)) / ROUNDING


def test_w_is_exact_to_two_units_in_the_last_place_of_one_plus_w():
    assert worst_error(DENSE) < 4


@pytest.mark.parametrize(("p", "w"), [(1.0, 0.0), (0.0, np.inf), (-0.0, np.inf)])
def test_the_ends_are_exact(p, w):
    assert branch_distance(np.array(p)) == w


@pytest.mark.parametrize("view", [lambda p: p.reshape(3, -1)[:, ::2].T, lambda p: p[:0]])
def test_any_layout_of_the_array_gives_each_element_its_own_number(view):
    p = view(np.linspace(0, 1, 9 * 2340))
    one_by_one = np.array([branch_distance(value) for value in p.ravel()]).reshape(p.shape)
    assert np.array_equal(branch_distance(p), one_by_one)
