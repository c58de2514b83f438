"""Workers: the results of calls in order, errors as they are, and nobody left."""

import os
import signal
import sys

import joblib
import pytest

from cylcontact import InputError
from cylcontact.support.parallel import Cluster, call, run_calls
from tests.support.spec_files import assert_told

posix = pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")


def calls(function, *arguments):
    return [call(function, argument) for argument in arguments]


@pytest.mark.parametrize("jobs", [1, 2])
def test_results_come_in_the_order_of_the_calls_or_as_they_are_ready(jobs):
    assert list(run_calls(calls(abs, -1, -2, -3), jobs)) == [1, 2, 3]
    assert list(run_calls(calls(abs, -1, -2, -3), jobs, threads=True)) == [1, 2, 3]
    assert sorted(run_calls(calls(abs, -1, -2, -3), jobs, ordered=False)) == [1, 2, 3]
    assert list(run_calls([], jobs)) == []


def test_no_more_workers_are_started_than_there_are_calls(monkeypatch):
    asked = []

    class Recorded(joblib.Parallel):
        def __init__(self, n_jobs, **kwargs):
            asked.append(n_jobs)
            super().__init__(n_jobs=1, **kwargs)

    monkeypatch.setattr(joblib, "Parallel", Recorded)
    for jobs, count in ((5000, 3), (2, 3), (2, 0)):
        list(run_calls(calls(abs, *range(count)), jobs))
    assert asked == [3, 2]  # one worker is this process


@pytest.mark.parametrize("jobs", [1, 2])
def test_bad_input_found_by_a_worker_comes_back_whole(jobs):
    def refuse(value):
        raise InputError("file", "key", value, "rule", "remedy")

    with pytest.raises(InputError) as caught:
        list(run_calls(calls(refuse, 1, 1), jobs))
    assert_told(caught, "file", "key", 1, "rule", "remedy")


@posix
@pytest.mark.slow
def test_a_worker_ended_by_the_system_is_told_in_one_line():
    def end(_):
        os.kill(os.getpid(), signal.SIGKILL)

    with pytest.raises(InputError) as caught:
        list(run_calls(calls(end, 1, 2), 2))
    assert_told(caught, "workers", "jobs", 2, "probably because memory ran out", "--resume")
    assert list(run_calls(calls(abs, -1, -2), 2)) == [1, 2]


def test_workers_are_in_the_folder_of_their_parent(tmp_path, monkeypatch):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        monkeypatch.chdir(tmp_path / name)
        assert list(run_calls([call(os.getcwd)] * 2, 2)) == [str(tmp_path / name)] * 2


def test_a_cluster_needs_its_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)  # what Python does for "not there"
    with pytest.raises(InputError) as caught:
        Cluster("tcp://127.0.0.1:8786")
    remedy = "pip install 'cylcontact[distributed]'"
    assert_told(
        caught, "--scheduler", "", "tcp://127.0.0.1:8786", "needs the extra 'distributed'", remedy
    )
