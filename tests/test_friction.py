import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cylcontact import InputError
from cylcontact.impact import dynamic_correction, friction_load
from tests.strategies import ROUNDING, powers_of_ten

V0, V1 = 1.0, 5.0

normal_loads = st.floats(0.0, 1e9)
velocities = st.one_of(st.floats(-1e6, 1e6), st.floats(-2 * V1, 2 * V1))
coefficients = st.floats(0.0, 10.0)
bounds = st.tuples(st.one_of(st.just(0.0), powers_of_ten(-9, 3)), powers_of_ten(-9, 3)).map(
    lambda pair: (pair[0], pair[0] + pair[1])
)
planes = st.tuples(st.floats(-1e5, 1e5), st.floats(-1e5, 1e5)).map(np.array)
angles = st.floats(0.0, 2 * np.pi)


# --- the correction, Eq 15 --------------------------------------------------------------------


def test_the_correction_is_eq_15():
    speeds = [0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 7.0, np.inf]
    expected = [0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0]
    assert dynamic_correction(speeds, V0, V1).tolist() == expected


def test_a_first_speed_of_zero_leaves_nothing_out():
    assert dynamic_correction([0.0, 1.0, 2.0, 4.0], 0.0, 4.0).tolist() == [0.0, 0.25, 0.5, 1.0]


@given(velocities, bounds)
def test_the_correction_lies_between_zero_and_one_and_does_not_see_the_direction(speed, bounds):
    c_d = dynamic_correction(speed, *bounds)
    assert 0 <= c_d <= 1
    assert c_d == dynamic_correction(-speed, *bounds)


@given(st.floats(0, 1e6), st.floats(0, 1e6), bounds)
def test_the_correction_never_falls_with_speed(speed, gain, bounds):
    assert dynamic_correction(speed, *bounds) <= dynamic_correction(speed + gain, *bounds)


@given(bounds)
def test_it_meets_both_ends_exactly(bounds):
    assert dynamic_correction(bounds, *bounds).tolist() == [0.0, 1.0]


def test_no_speed_overflows():
    assert dynamic_correction(1e308, 0.0, 1e-308) == 1.0


# --- the friction, Eq 14 ----------------------------------------------------------------------


def test_the_friction_is_eq_14():
    """50 N, c_f = 0.1: 5 N in full sliding, a quarter of that at v0 + (v1 − v0)/4."""
    velocities = [-20.0, -2.0, -1.0, 1.0, 2.0, 20.0]
    expected = [5.0, 1.25, 0.0, 0.0, -1.25, -5.0]
    assert friction_load(50.0, velocities, 0.1, V0, V1).tolist() == expected


@pytest.mark.parametrize("velocity", [0.0, -0.0])
@pytest.mark.parametrize("v0", [0.0, V0])
def test_what_does_not_slide_has_no_friction_and_no_negative_zero(velocity, v0):
    load = friction_load(50.0, velocity, 0.1, v0, V1)
    assert load == 0.0
    assert not np.signbit(load)


@given(normal_loads, velocities, coefficients, bounds)
def test_friction_never_drives(normal_load, velocity, coefficient, bounds):
    assert friction_load(normal_load, velocity, coefficient, *bounds) * velocity <= 0


@given(normal_loads, velocities, coefficients, bounds)
def test_friction_never_exceeds_coulombs(normal_load, velocity, coefficient, bounds):
    load = abs(friction_load(normal_load, velocity, coefficient, *bounds))
    assert load <= coefficient * normal_load
    if abs(velocity) >= bounds[1]:
        assert load == coefficient * normal_load


@given(normal_loads, velocities, coefficients, bounds)
def test_friction_turns_round_with_the_velocity(normal_load, velocity, coefficient, bounds):
    forth = friction_load(normal_load, velocity, coefficient, *bounds)
    assert friction_load(normal_load, -velocity, coefficient, *bounds) == -forth


@given(planes, planes, angles, normal_loads, coefficients)
def test_on_two_bodies_in_the_plane_it_dissipates(v_i, v_j, angle, normal_load, coefficient):
    """f_i·v_i + f_j·v_j ≤ 0 with Eq 13's f_i = f_t·t and f_j = −f_i, either way t points."""
    tangent = np.array([np.cos(angle), np.sin(angle)])
    forces = [
        friction_load(normal_load, (v_i - v_j) @ t, coefficient, V0, V1) * t
        for t in (tangent, -tangent)
    ]
    np.testing.assert_array_equal(*forces)
    power = forces[0] @ v_i - forces[0] @ v_j
    rounding = 8 * ROUNDING * np.abs(forces[0]).sum() * (np.abs(v_i) + np.abs(v_j)).sum()
    assert power <= rounding


@pytest.mark.parametrize("normal_load", [-1.0, -1e-300, -np.inf, np.nan])
@pytest.mark.parametrize("velocity", [0.0, 20.0])
def test_bodies_that_do_not_touch_have_no_answer(normal_load, velocity):
    assert np.isnan(friction_load(normal_load, velocity, 0.1, V0, V1))


def test_an_unknown_velocity_has_no_answer():
    assert np.isnan(friction_load(50.0, np.nan, 0.1, V0, V1))


def test_arrays_broadcast_and_single_numbers_give_numpy_scalars():
    assert friction_load(np.ones((4, 1)), np.ones(3), 0.1, V0, V1).shape == (4, 3)
    assert friction_load(1.0, 1.0, np.full((2, 1), 0.1), V0, V1).shape == (2, 1)
    single = [friction_load(1.0, 1.0, 0.1, V0, V1), dynamic_correction(1.0, V0, V1)]
    assert {type(value) for value in single} == {np.float64}


# --- bad input --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("v0", "v1"),
    [(-1.0, 5.0), (5.0, 5.0), (5.0, 1.0), (0.0, 0.0), (np.nan, 5.0), (1.0, np.nan), (1.0, np.inf)],
)
@pytest.mark.parametrize(
    "act",
    [
        lambda v0, v1: dynamic_correction(1.0, v0, v1),
        lambda v0, v1: friction_load(1.0, 1.0, 0.1, v0, v1),
    ],
)
def test_speeds_out_of_order_are_refused(act, v0, v1):
    with pytest.raises(InputError) as caught:
        act(v0, v1)
    assert str(caught.value) == (
        f"friction: v0, v1 = {(v0, v1)!r}: must be finite, with 0 ≤ v0 < v1; "
        "give two speeds in mm/s, the smaller one first"
    )


@pytest.mark.parametrize("coefficient", [-0.1, np.nan, np.inf, [0.1, -0.1]])
def test_a_coefficient_that_is_negative_or_not_finite_is_refused(coefficient):
    with pytest.raises(InputError) as caught:
        friction_load(1.0, 1.0, coefficient, V0, V1)
    assert str(caught.value) == (
        f"friction: coefficient = {coefficient!r}: must be finite and not negative; "
        "give e.g. 0.1, or 0 for no friction"
    )
