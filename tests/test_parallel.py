"""Workers: as many as there is work for, deaf to signals, and told of when the system ends one."""

import os
import signal
import threading
import time
from contextlib import closing
from functools import partial

import joblib
import pytest

from cylcontact import InputError
from cylcontact.parallel import call, run_calls
from cylcontact.parallel.calls import RESUME
from cylcontact.parallel.local import SETTLING
from tests.spec_files import assert_told

posix = pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")


def calls(function, *arguments):
    return [call(function, argument) for argument in arguments]


@pytest.mark.parametrize("jobs", [1, 2])
def test_results_come_in_the_order_of_the_calls(jobs):
    assert list(run_calls(calls(abs, -1, -2, -3), jobs)) == [1, 2, 3]


def test_results_may_come_as_they_are_ready():
    assert sorted(run_calls(calls(abs, -1, -2, -3), 2, ordered=False)) == [1, 2, 3]


@pytest.mark.parametrize("jobs", [1, 2])
def test_no_calls_need_no_workers(jobs):
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
    list(run_calls(calls(abs, *range(5000)), 5000, threads=True))
    assert asked == [3, 2, 1, os.cpu_count()]


@posix
def test_workers_never_see_what_ends_this_process_and_it_does():
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    masks = list(run_calls(calls(partial(signal.pthread_sigmask, signal.SIG_BLOCK), [], []), 2))
    assert all({signal.SIGINT, signal.SIGTERM, signal.SIGHUP} <= mask for mask in masks)
    assert signal.pthread_sigmask(signal.SIG_BLOCK, []) == before


@posix
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
@pytest.mark.slow
def test_a_signal_while_workers_start_takes_effect_at_once_after(monkeypatch, name):
    number = getattr(signal, name)

    class Interrupted(joblib.Parallel):
        def __call__(self, iterable):
            os.kill(os.getpid(), number)
            return super().__call__(iterable)

    monkeypatch.setattr(joblib, "Parallel", Interrupted)
    results = run_calls(calls(time.sleep, 60, 60), 2)
    before = signal.signal(number, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            next(results)
    finally:
        signal.signal(number, before)


def test_another_thread_may_start_workers():
    actual = []
    thread = threading.Thread(target=lambda: actual.extend(run_calls(calls(abs, -1, -2), 2)))
    thread.start()
    thread.join()
    assert actual == [1, 2]


@pytest.mark.parametrize("jobs", [1, 2])
def test_bad_input_found_by_a_worker_comes_back_whole(jobs):
    def refuse(value):
        raise InputError("file", "key", value, "rule", "remedy")

    with pytest.raises(InputError) as caught:
        list(run_calls(calls(refuse, 1), jobs))
    assert_told(caught, "file", "key", 1, "rule", "remedy")


@posix
@pytest.mark.slow
def test_a_worker_ended_by_the_system_is_told_in_one_line():
    def end(_):
        os.kill(os.getpid(), signal.SIGKILL)

    with pytest.raises(InputError) as caught:
        list(run_calls(calls(end, 1, 2), 2))
    assert_told(caught, "workers", "jobs", 2, "probably because memory ran out", RESUME)
    assert list(run_calls(calls(abs, -1, -2), 2)) == [1, 2]


def test_closing_early_ends_calls_under_way_without_a_warning():
    started = time.monotonic()
    with closing(run_calls(calls(time.sleep, 0, 60, 60), 2, ordered=False)) as results:
        next(results)
        time.sleep(SETTLING)
    assert time.monotonic() - started < 30


def test_workers_stand_where_their_parent_does(tmp_path, monkeypatch):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        monkeypatch.chdir(tmp_path / name)
        actual = list(run_calls([call(os.getcwd)] * 2, 2))
        assert actual == [str(tmp_path / name)] * 2
