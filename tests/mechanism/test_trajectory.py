"""Trajectories: what they hold, their statistics, files, and runs taken up again."""

import json
from dataclasses import fields

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws, limits
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


def test_means_and_scatter_are_over_the_revolutions_asked_for(run):
    late = run.statistics(first=1)
    works = late.by_revolution["drive_work_J"]
    assert list(late.by_revolution.index) == [1, 2]
    assert late.mean["drive_work_J"] == pytest.approx(works.mean())
    assert late.scatter["drive_work_J"] == pytest.approx(abs(works[1] - works[2]) / np.sqrt(2))
    assert "revolutions 2 to 3, the first 1 left out" in repr(late)
    assert "<table" in late._repr_html_()
    with pytest.raises(InputError, match="first = 3: leaves none of 3 revolutions"):
        run.statistics(first=3)


def test_a_revolution_without_flight_has_no_step_in_flight():
    late = simulate(slider_crank(clearance=0.02), revolutions=2).statistics(first=1)
    assert late.mean["contact_fraction"] == 1.0
    assert np.isnan(late.mean["mean_step_flight_us"])


@pytest.mark.slow
def test_the_largest_elastic_load_is_set_against_first_yield(run):
    """The load from the law in Python; 500 MPa are passed, 1000 MPa are not."""
    steel = Material("steel", 207e3, 0.3)
    pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel)
    load = float(laws.Enhanced().load(run.penetration.max() * 1e3, pair))
    assert run.max_elastic_load == pytest.approx(load, rel=1e-9, abs=0)
    assert 0 < load < run.normal_force.max() / 10.0  # which has damping as well
    for yield_stress, passed in ((100.0, True), (1000.0, False)):
        spec = yields_at(yield_stress)
        other = simulate(slider_crank(spec=spec), revolutions=3)
        at = float(limits.yield_load(pair, yield_stress=yield_stress))
        row = f"max elastic load: {load:,.0f} N/mm, {100 * load / at:.3g} % of first yield"
        assert str(other).splitlines()[-1].strip() == f"{row} (von Mises)"
        assert "max elastic load" in other._repr_html_()
        assert (load > at) == passed
        assert [text.startswith("the largest load") for text in other.warnings] == [True] * passed
        assert same(run, other)
    assert "yield" not in run.statistics().to_text()
    assert run.warnings == ()


def test_an_ideal_joint_has_no_elastic_load():
    ideal = simulate(slider_crank(clearance=0.0, spec=yields_at(1.0)), revolutions=1)
    assert ideal.joints == {}
    assert ideal.warnings == ()
    assert "elastic load" not in repr(ideal)
    with pytest.raises(InputError, match="0 joints have a clearance"):
        _ = ideal.penetration


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


@pytest.mark.parametrize("method", ["minimal", "multiplier"])
def test_a_run_taken_up_equals_one_never_interrupted(method, tmp_path):
    """In the sensitive case, where the least difference would grow."""
    mechanism = slider_crank("johnson", 0.5, 1.0, 0.0)
    whole = simulate(mechanism, method, revolutions=4)
    simulate(mechanism, method, revolutions=1).save(tmp_path / "part.parquet")
    part = Trajectory.load(tmp_path / "part.parquet")
    assert same(whole, simulate(mechanism, revolutions=4, resume=part))


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
    pa = require_package("pyarrow")
    pa.parquet.write_table(pa.table({"x": [1.0]}), tmp_path / "other.parquet")
    rules = {"none": "cannot be read", "text": "cannot be read", "other": "holds no trajectory"}
    for name, rule in rules.items():
        with pytest.raises(InputError, match=rule):
            Trajectory.load(tmp_path / f"{name}.parquet")


def test_the_same_run_gives_the_same_bytes(run, tmp_path):
    files = [tmp_path / name for name in ("one.parquet", "other.parquet", "again.parquet")]
    run.save(files[0])
    simulate(slider_crank(), revolutions=3).save(files[1])
    Trajectory.load(files[0]).save(files[2])
    assert len({file.read_bytes() for file in files}) == 1
