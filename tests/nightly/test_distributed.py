"""Beyond one machine: a real Dask cluster gives the local result to the bit, or one clear line."""

import json
import os
from dataclasses import replace

import pytest

from cylcontact import InputError
from cylcontact.fitting import calibrate
from cylcontact.support import parallel
from cylcontact.support.parallel import Cluster, call, run_calls
from tests.support.dask_cluster import LoopbackCluster, kill
from tests.support.spec_files import assert_told

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name == "nt", reason="SIGKILL ends the processes"),
]
AGAIN = "start it again, with more memory if that ran out; a command with --resume continues"


@pytest.fixture(scope="module")
def loopback(tmp_path_factory):
    """A scheduler and two workers of two threads each."""
    with LoopbackCluster(tmp_path_factory.mktemp("dask"), threads=2) as started:
        yield started


@pytest.fixture
def short_lived(tmp_path):
    """The same with one thread each, for tests that kill them."""
    with LoopbackCluster(tmp_path) as started:
        yield started


def bits(result):
    """The result as it is saved, times and provenance aside."""
    return json.dumps(result.repeatable())


# --- the same result --------------------------------------------------------------------------


def test_one_process_two_and_a_cluster_agree_to_the_bit(loopback, small_campaign, small_result):
    assert bits(calibrate(small_campaign, 2)) == bits(small_result)
    assert bits(calibrate(small_campaign, Cluster(loopback.address))) == bits(small_result)


@pytest.mark.long
def test_a_worker_killed_on_the_way_changes_nothing(short_lived, small_campaign, small_result):
    def kill_one(stage, done, _):
        if (stage, done) == ("searching", 1):
            kill(short_lived.workers[0])

    actual = calibrate(small_campaign, Cluster(short_lived.address), kill_one)
    assert short_lived.workers[0].poll() is not None
    assert bits(actual) == bits(small_result)


# --- one clear line ---------------------------------------------------------------------------


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense", "ftp://x:1"])
def test_a_scheduler_that_is_not_there(address, monkeypatch):
    monkeypatch.setattr(parallel, "_CONNECTING", 1)
    with pytest.raises(InputError) as caught:
        list(run_calls([call(abs, -1)], Cluster(address)))
    remedy = "give the address that dask scheduler prints"
    assert_told(caught, "--scheduler", "", address, "cannot be reached (", remedy)


@pytest.mark.long
def test_a_cluster_without_workers(tmp_path, monkeypatch):
    monkeypatch.setattr(parallel, "_CONNECTING", 1)
    with LoopbackCluster(tmp_path, workers=0) as started, pytest.raises(InputError) as caught:
        list(run_calls([call(abs, -1)], Cluster(started.address)))
    remedy = f"each with: dask worker {started.address}"
    assert_told(caught, "--scheduler", "", started.address, "has no workers after 1 s", remedy)


@pytest.mark.long
def test_another_version_is_refused_before_any_work(tmp_path):
    """A package's version is what the first of its metadata on the path says."""
    metadata = tmp_path / "numpy-0.0.0.dist-info/METADATA"
    metadata.parent.mkdir()
    metadata.write_text("Name: numpy\nVersion: 0.0.0")
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    with LoopbackCluster(tmp_path, workers=0) as started:
        started.add_worker({"PYTHONPATH": path})
        with pytest.raises(InputError) as caught:
            list(run_calls([call(abs, -1)], Cluster(started.address)))
    remedy = "install the same on all machines"
    rule = "a worker has numpy 0.0.0, here"
    assert_told(caught, "--scheduler", "", started.address, rule, remedy)


@pytest.mark.long
def test_a_scheduler_lost_on_the_way_keeps_the_complete_runs(short_lived, small_campaign, tmp_path):
    kept = tmp_path / "kept.partial"

    def kill_scheduler(stage, done, _):
        if (stage, done) == ("searching", 1):
            kill(short_lived.scheduler)

    long = {"runs": 12, "generations": 300}
    genetic = small_campaign.spec.genetic.model_copy(update=long)
    campaign = replace(
        small_campaign, spec=small_campaign.spec.model_copy(update={"genetic": genetic})
    )
    with pytest.raises(InputError) as caught:
        calibrate(campaign, Cluster(short_lived.address), kill_scheduler, kept)
    assert caught.value.value == short_lived.address
    assert caught.value.rule.startswith("lost a call (")
    assert caught.value.remedy.startswith(AGAIN)
    assert len(kept.read_text().splitlines()) >= 2
    resumed = calibrate(campaign, 2, checkpoint=kept, resume=True)
    assert len(resumed.runs) == 12
