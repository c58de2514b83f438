"""Many joints of different materials at once against each by itself."""

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material
from cylcontact.laws import Conformal
from cylcontact.laws.conformal import law as law_module
from cylcontact.laws.conformal import many
from cylcontact.laws.conformal.arcs import Bodies
from cylcontact.laws.conformal.many import Many

STEEL = Material("steel", 207e3, 0.3)
JOHNSON = 2 * np.log(2) - 2


def random_joints(count, seed, plane):
    """w_i and β of joints with ratios of moduli from 1e-3 to 1e3 and ν from 0 to 0.499."""
    rng = np.random.default_rng(seed)
    ratio, nu = 10 ** rng.uniform(-3, 3, count), rng.uniform(0, 0.499, (2, count))
    nu[:, :6] = [[0, 0, 0.499, 0.499, 0, 0.3], [0, 0.499, 0, 0.499, 0.3, 0]]
    kappa, modulus = 3 - 4 * nu, np.stack([ratio, np.ones(count)]) / (1 - nu**2)
    if plane == "stress":
        kappa, modulus = (3 - nu) / (1 + nu), np.stack([ratio, np.ones(count)])
    w_i, w_j = modulus[::-1] / modulus.sum(axis=0)
    beta = w_j * (kappa[1] - 1) / (kappa[1] + 1) - w_i * (kappa[0] - 1) / (kappa[0] + 1)
    beta[6:9] = 0, 1e-7, -1e-7  # beside equal materials
    return w_i, beta, JOHNSON + w_j


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_many_joints_are_the_arcs_of_each(plane):
    """All answers by the load and by the penetration, from tiny to huge ones."""
    w_i, beta, C = random_joints(60, 3, plane)
    phi = 10 ** np.random.default_rng(4).uniform(-12, 6, w_i.size)
    joints = Many(w_i, beta, C)
    under = joints.state(phi, by_load=True)
    at = joints.state(under.other.copy(), by_load=False)  # another array: it is searched again
    np.testing.assert_allclose(at.other, phi, rtol=1e-9)
    for k in range(w_i.size):
        bodies, one = Bodies(np.float64(w_i[k]), float(beta[k]), np.float64(C[k])), phi[k]
        d = bodies.penetration(one)
        exact = d, bodies.stiffness(d), bodies.energy(d) / (one * d), bodies.angle(one)
        for state in (under, at):
            found = [row[k] for row in state]
            found[0] = d if state is at else found[0]
            np.testing.assert_allclose(found, [*exact, bodies.peak(one)], rtol=1e-9)


def pairs_of(count, seed=1):
    rng = np.random.default_rng(seed)
    E, nu = 10 ** rng.uniform(3.6, 5.8, (2, count)), rng.uniform(0, 0.499, (2, count))
    R = 10 ** rng.uniform(0, 2, count)
    dR = R * 10 ** rng.uniform(-5, -1, count)
    hole, pin = (Material("any", *both) for both in zip(E, nu, strict=True))
    pair = CylinderPair.internal(R_i=R, R_j=R - dR, hole=hole, pin=pin)
    return pair, pair.E_star * dR * 10 ** rng.uniform(-4, 2, count)


def one_of(pair, k):
    hole, pin = (Material("any", m.E[k], m.nu[k]) for m in (pair.material_i, pair.material_j))
    return CylinderPair.internal(R_i=pair.R_i[k], R_j=pair.R_j[k], hole=hole, pin=pin)


def test_a_row_is_the_same_joint_alone():
    """Which is answered by a curve: the way that is taken changes no number beyond 1e-9."""
    pair, load = pairs_of(25)
    law, state = Conformal(), Conformal().state(load, pair)
    for k in range(load.size):
        alone = law.state(load[k], one_of(pair, k))
        np.testing.assert_allclose([row[k] for row in state], alone, rtol=1e-9)


def test_the_state_is_what_the_methods_return():
    pair, load = pairs_of(200)
    load[:4] = 0.0, -1.0, np.nan, np.inf
    law = Conformal()
    state, delta = law.state(load, pair), law.penetration(load, pair)
    np.testing.assert_array_equal(state.penetration, delta)
    np.testing.assert_array_equal(state.peak_pressure, law.peak_pressure(load, pair))
    np.testing.assert_array_equal(state.contact_angle, law.contact_angle(load, pair))
    known = np.isfinite(delta)
    np.testing.assert_allclose(state.stiffness[known], law.stiffness(delta, pair)[known], rtol=1e-9)
    np.testing.assert_allclose(state.energy[known], law.energy(delta, pair)[known], rtol=1e-9)
    assert [row[0] for row in state] == [0.0] * 5  # at first touch
    assert np.isnan([row[1:3] for row in state]).all()
    np.testing.assert_allclose(law.load(delta, pair)[4:], load[4:], rtol=1e-9)


def test_blocks_and_threads_change_no_bit(monkeypatch):
    pair, load = pairs_of(40_000)
    whole = Conformal().penetration(load, pair)
    monkeypatch.setattr(law_module, "_ROWS", 777)
    np.testing.assert_array_equal(Conformal().penetration(load, pair), whole)


def test_equal_materials_that_share_a_curve_change_no_number_beyond_1e_9(monkeypatch):
    rng = np.random.default_rng(2)
    E, which = np.array([2e3, 7e4, 4e5]), rng.integers(0, 3, 30_000)
    hole = Material("one of three", E[which], 0.33)
    pair = CylinderPair.internal(10.0, 9.98, pin=STEEL, hole=hole)
    load = 10 ** rng.uniform(-3, 4, which.size)
    searched = Conformal().penetration(load, pair)
    monkeypatch.setattr(law_module, "_SHARED", 1000)
    shared = Conformal().penetration(load, pair)
    assert (shared != searched).any()  # another way
    np.testing.assert_allclose(shared, searched, rtol=1e-9)
    np.testing.assert_allclose(
        Conformal().stiffness(shared, pair), Conformal().state(load, pair).stiffness, rtol=1e-9
    )


def test_a_joint_that_is_not_found_is_left_to_the_arcs(monkeypatch):
    w_i, beta, C = (row[8:12] for row in random_joints(12, 3, "strain"))
    phi = np.array([1e-3, 1.0, 10.0, 100.0])
    found = Many(w_i, beta, C).state(phi, by_load=True)
    monkeypatch.setattr(many, "_solved", lambda *args: args[-1].fill(np.nan))
    left = Many(w_i, beta, C)
    np.testing.assert_allclose(left.state(phi, by_load=True), found, rtol=1e-9)
    at = left.state(found.other.copy(), by_load=False)
    np.testing.assert_allclose(at.other, phi, rtol=1e-9)


def test_a_datum_as_a_number_is_refused_where_the_penetration_would_decrease():
    pair, load = pairs_of(6)
    curves = (Conformal(0.0).curve(one_of(pair, k)) for k in range(6))
    least = [-float(curve.bodies.last.L) for curve in curves]
    law = Conformal(max(least) + 1e-6)
    assert (law.penetration(load, pair) > 0).all()
    with pytest.raises(InputError, match=f"datum = -1.33.*needs C > {max(least):.6g}"):
        Conformal(max(least) - 1e-6).penetration(load, pair)


def test_johnsons_datum_needs_no_such_check():
    """L is positive at the largest arc of every possible pair of materials."""
    w_i, part = np.meshgrid(np.linspace(1e-4, 1 - 1e-4, 41), np.linspace(0, 1, 41))
    beta = -w_i / 2 + part / 2
    joints = Many(w_i.ravel(), beta.ravel(), JOHNSON + 1 - w_i.ravel())
    joints.require_increasing()
