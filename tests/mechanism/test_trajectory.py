"""Trajectories: what they hold, their statistics, files, and runs taken up again."""

import json
from dataclasses import fields

import numpy as np
import pandas as pd
import pytest

from cylcontact import InputError, laws, limits
from cylcontact.mechanism import Interrupted, Trajectory, read_mechanism, simulate
from cylcontact.mechanism.linkage import assemble
from tests.support.mechanism_cases import ROOT, slider_crank, yields_at
from tests.support.programs import require_package


@pytest.fixture(scope="module")
def run():
    return simulate(slider_crank(), revolutions=3)


def same(one, other):
    """Whether two runs are equal to the bit, but for the seconds that they took."""
    counts = [run.rows.counts[:, :2] for run in (one, other)]
    columns = [f.name for f in fields(one.rows) if f.name != "counts"]
    return np.array_equal(*counts) and all(
        np.array_equal(getattr(one.rows, name), getattr(other.rows, name)) for name in columns
    )


def test_it_starts_centred_and_ends_after_whole_revolutions(run):
    q, v = assemble(run.mechanism)
    assert run.coordinates[0].ravel() == pytest.approx(q, abs=1e-15)
    assert run.velocities[0].ravel() == pytest.approx(v, abs=1e-12)
    assert run.penetration[0] == -run.mechanism.clearance.contact.radial * 1e-3
    assert run.time[-1] == 3 * run.mechanism.period
    assert (np.diff(run.time) >= 0).all()


def test_points_of_bodies_are_where_the_joints_hold_them(run):
    rod, slider = 1, 2
    pin, pin_rate = run.point(rod, (-0.06, 0.0))
    crank, crank_rate = run.point(0, (0.025, 0.0))
    assert pin == pytest.approx(crank, abs=1e-12)
    assert pin_rate == pytest.approx(crank_rate, abs=1e-9)
    eye, eye_rate = run.point(rod, (0.06, 0.0))
    wrist, wrist_rate = run.point(slider, (0.0, 0.0))
    assert run.eccentricity == pytest.approx(eye - wrist, abs=1e-12)
    assert run.eccentricity_rate == pytest.approx(eye_rate - wrist_rate, abs=1e-9)
    ground, still = run.point(-1, (1.0, 2.0))
    assert (ground == [1.0, 2.0]).all()
    assert not still.any()


def test_the_statistics_are_those_of_the_steps(run):
    table = run.statistics().by_revolution
    T = run.mechanism.period
    assert table["impacts"].sum() == len(run.contacts)
    inside = (run.contacts["release_s"].fillna(run.time[-1]) - run.contacts["onset_s"]).sum()
    assert table["contact_fraction"].sum() * T == pytest.approx(inside, rel=1e-12)
    assert table["max_penetration_um"].max() == run.penetration.max() * 1e6
    # The peak lies between two steps; with steps of 1 µs it is a step.
    fine = simulate(slider_crank(spec={"integration.max_step": 1e-6}), revolutions=1)
    assert table["max_force_N"].max() == pytest.approx(fine.normal_force.max(), rel=2e-3)
    assert table["max_force_N"].max() > run.normal_force.max()
    assert table["drive_work_J"].sum() == pytest.approx(run.drive_work[-1], rel=1e-12)
    assert table["steps"].sum() == np.count_nonzero(np.diff(run.time))
    # The percentiles, on an even grid of times.
    time = np.linspace(fine.time[0], T, 400_001)
    force = np.interp(time, fine.time, fine.normal_force)
    fraction = np.searchsorted(fine.time, time)
    force = force[fine.in_contact[np.minimum(fraction, fine.time.size - 1)]]
    for percent in (50, 95, 99):
        wanted = np.percentile(force, percent)
        assert table.loc[0, f"force_p{percent}_N"] == pytest.approx(wanted, rel=0.01)


def test_the_largest_elastic_load_is_set_against_first_yield(run):
    """The load from the law in Python; 100 MPa are passed, 1000 MPa are not."""
    pair = run.mechanism.clearance.contact.pair
    load = float(laws.Enhanced().load(run.penetration.max() * 1e3, pair))
    assert run.max_elastic_load == pytest.approx(load, rel=1e-9, abs=0)
    assert 0 < load < run.normal_force.max() / 10.0  # which has damping as well
    for yield_stress, passed in ((100.0, True), (1000.0, False)):
        other = simulate(slider_crank(spec=yields_at(yield_stress)), revolutions=3)
        at = float(limits.yield_load(pair, yield_stress=yield_stress))
        assert f"{load:,.0f} N/mm, {100 * load / at:.3g} % of first yield" in str(other)
        assert [text.startswith("the largest load") for text in other.warnings] == [True] * passed
        assert same(run, other)
    assert run.warnings == ()


def test_a_saved_run_comes_back_whole(run, tmp_path):
    path = tmp_path / "new" / "run.parquet"
    run.save(path)
    again = Trajectory.load(path)
    assert same(run, again)
    assert again.settings == run.settings
    assert again.mechanism == run.mechanism
    assert again.joint.contact.pair == run.joint.contact.pair
    assert np.array_equal(again.normal_force, run.normal_force)
    about = json.loads(
        require_package("pyarrow.parquet").read_schema(path).metadata[b"cylcontact.trajectory"]
    )
    assert set(about["provenance"]) >= {"cylcontact", "git_commit", "spec_hashes", "libraries"}
    assert tuple(about["assumptions"]) == run.mechanism.assumptions


def test_an_interrupted_run_keeps_its_complete_revolutions(run):
    def stop_after_two(_, done, __):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as caught:
        simulate(slider_crank(), revolutions=3, progress=stop_after_two)
    kept = caught.value.trajectory
    assert kept.revolutions == 2
    assert same(run, simulate(slider_crank(), revolutions=3, resume=kept))


def test_a_law_of_ones_own_can_be_used_and_its_run_is_saved_but_not_read_back(tmp_path):
    own = laws.PowerLaw(n=1.3, K_star=1.1)
    mechanism = read_mechanism(ROOT / "datasets/slider_crank.toml", law=own)
    run = simulate(mechanism, revolutions=1)
    load = own.load(np.maximum(run.penetration, 0) * 1e3, mechanism.clearance.contact.pair)
    assert run.normal_force.max() == pytest.approx((load * 10.0 * run.in_contact).max(), rel=0.2)
    run.save(tmp_path / "own.parquet")
    with pytest.raises(InputError, match=r"law = 'PowerLaw\(.*is neither a law"):
        Trajectory.load(tmp_path / "own.parquet")


def test_files_that_hold_no_trajectory_are_told(tmp_path):
    (tmp_path / "text.parquet").write_bytes(b"hello")
    require_package("pyarrow")
    pd.DataFrame({"x": [1.0]}).to_parquet(tmp_path / "other.parquet")
    rules = {"none": "cannot be read", "text": "cannot be read", "other": "holds no trajectory"}
    for name, rule in rules.items():
        with pytest.raises(InputError, match=rule):
            Trajectory.load(tmp_path / f"{name}.parquet")
