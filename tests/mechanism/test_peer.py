"""The mechanism against Exudyn, with its own contact and with our joint in it."""

import numpy as np
import pytest

from benchmarks.exudyn_peer import SPEC, imbalance, joint_of, simulate_in_exudyn, slider_crank
from benchmarks.mechanism import CONTACTS, ELASTIC, END, onsets_of
from cylcontact.mechanism import read_mechanism, simulate

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def mechanism():
    return read_mechanism(SPEC, **ELASTIC, revolutions=1)


@pytest.fixture(scope="module")
def ours(mechanism):
    return simulate(mechanism.changed(tolerance=1e-11))


@pytest.fixture(scope="module")
def theirs(mechanism):
    steps = (2e-6, 1e-6, 2.5e-7, 1.25e-7)
    return {step: simulate_in_exudyn(mechanism, END, step) for step in steps}


def peaks_of(run):
    """The deepest penetration of each of the first contacts, in m."""
    touching = np.concatenate([[False], run.penetration > 0, [False]])
    edges = np.flatnonzero(np.diff(touching.astype(int)))
    pairs = edges.reshape(-1, 2)[:CONTACTS]
    return np.array([run.penetration[first:last].max() for first, last in pairs])


def test_the_first_contacts_begin_when_ours_do(ours, theirs):
    off = {step: np.abs(onsets_of(run) - onsets_of(ours)) for step, run in theirs.items()}
    assert off[1.25e-7].max() < 3e-9
    # Of second order or better: an eighth of the step leaves less than a sixteenth of the error.
    assert off[1.25e-7].max() < off[1e-6].max() / 16 < off[2e-6].max() / 32


def test_the_first_contacts_are_as_deep_as_ours(ours, theirs):
    exact = ours.contacts["max_penetration_m"].to_numpy()[:CONTACTS]
    off = {step: np.abs(peaks_of(run) / exact - 1) for step, run in theirs.items()}
    assert off[1.25e-7].max() < 5e-5
    assert off[1.25e-7].max() < off[1e-6].max() / 16


# --- our joint, exported, inside Exudyn ---


def test_without_dissipation_our_joint_is_exudyns_own_contact(mechanism, theirs):
    run = simulate_in_exudyn(mechanism, END, 1e-6, joint_of(mechanism))
    own = theirs[1e-6]
    assert (run.penetration > 0).sum() > 100
    np.testing.assert_allclose(run.penetration, own.penetration, rtol=0, atol=1e-11)
    np.testing.assert_allclose(run.kinetic_energy, own.kinetic_energy, rtol=1e-9)
    assert np.array_equal(run.dissipated, np.zeros(run.time.size))


@pytest.fixture(scope="module")
def sliding():
    """Restitution 0.9 and friction 0.1: the mechanism, our run and those with our joint."""
    mechanism = slider_crank(0.9, 0.1)
    ours = simulate(mechanism.changed(tolerance=1e-11), revolutions=1)
    joint = joint_of(mechanism)
    runs = {s: simulate_in_exudyn(mechanism, END, s, joint) for s in (1e-6, 2.5e-7)}
    return mechanism, ours, runs


def test_with_friction_and_damping_the_first_contacts_are_ours(sliding):
    _, ours, runs = sliding
    exact = ours.contacts["max_penetration_m"].to_numpy()[: CONTACTS - 1]
    onset = {step: np.abs(onsets_of(run) - onsets_of(ours)).max() for step, run in runs.items()}
    depth = {step: np.abs(peaks_of(run)[:-1] / exact - 1).max() for step, run in runs.items()}
    assert onset[2.5e-7] < 3e-7
    assert depth[2.5e-7] < 2e-3
    # δ̇⁽⁻⁾ is that of the end of a step, so the convergence is of first order.
    assert onset[2.5e-7] < onset[1e-6] / 1.5


def test_what_our_joint_dissipates_in_exudyn_balances_and_is_ours(sliding):
    mechanism, ours, runs = sliding
    run = runs[2.5e-7]
    assert (np.diff(run.dissipated) >= 0).all()
    assert imbalance(mechanism, run) < 2e-4 < 1e-3 * run.dissipated[-1]
    lost = ours.normal_dissipation + ours.friction_dissipation
    at = ours.contacts["release_s"][2] + 1e-5  # after the third contact, in flight
    there, here = np.interp(at, run.time, run.dissipated), np.interp(at, ours.time, lost)
    assert there == pytest.approx(here, rel=2e-3)
