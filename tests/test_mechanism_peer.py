"""The mechanism against Exudyn: as its step shrinks, its contacts become ours."""

import numpy as np
import pytest

from benchmarks.exudyn_peer import simulate_in_exudyn
from benchmarks.mechanism import CONTACTS, ELASTIC, END, SPEC, onsets_of
from cylcontact.mechanism import read_mechanism, simulate


@pytest.fixture(scope="module")
def mechanism():
    return read_mechanism(SPEC, **ELASTIC, revolutions=1)


@pytest.fixture(scope="module")
def ours(mechanism):
    return simulate(mechanism, tolerance=1e-11)


@pytest.fixture(scope="module")
def theirs(mechanism, ours):
    steps = (2e-6, 1e-6, 2.5e-7, 1.25e-7)
    return {step: simulate_in_exudyn(mechanism, ours, END, step) for step in steps}


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


def test_there_is_no_contact_between_them(ours, theirs):
    release = ours.contacts["release_s"].to_numpy()[: CONTACTS - 1]
    onset = ours.contacts["onset_s"].to_numpy()[1:CONTACTS]
    run = theirs[1.25e-7]
    for first, last in zip(release, onset, strict=True):
        between = (run.time > first + 5e-7) & (run.time < last - 5e-7)
        assert between.sum() > 100
        assert run.penetration[between].max() < 0
