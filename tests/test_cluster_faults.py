"""A cluster that misbehaves: the run ends right, or one line says what is missing."""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import contextmanager

import pytest

from cylcontact import InputError
from cylcontact.fitting import FitResult, calibrate, read_campaign
from cylcontact.parallel import Cluster, call, cluster, run_calls
from cylcontact.parallel.calls import RESUME
from cylcontact.tether import tethered
from tests.dask_cluster import LoopbackCluster, kill
from tests.killable import ROOT, wait_until
from tests.measured_files import USER_LAW, user_campaign
from tests.spec_files import assert_told, tree, write_bench

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(os.name == "nt", reason="SIGKILL ends the processes"),
]
DESERTED = "has had no scheduler or no workers for 2 s"
AGAIN = f"start it again; {RESUME}"
LONGER = {"genetic.runs": 12, "genetic.generations": 300}
FIT = ("fit", "fitting/small.toml", "--scheduler")
RESULT = "fitting/results/small.json"
SLEEPS = [call(time.sleep, 0.3) for _ in range(8)]


@pytest.fixture(scope="module")
def loopback(tmp_path_factory):
    """A scheduler and two workers, for tests that leave them alive."""
    with LoopbackCluster(tmp_path_factory.mktemp("dask")) as started:
        yield started


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A folder to work in, with a campaign of some seconds."""
    write_bench(tmp_path / "bench", LONGER)
    monkeypatch.chdir(tmp_path / "bench")
    return tmp_path / "bench"


@pytest.fixture(scope="module")
def longer(tmp_path_factory):
    """What the fit of that campaign gives on this machine."""
    campaign = read_campaign(write_bench(tmp_path_factory.mktemp("longer"), LONGER))
    return calibrate(campaign).repeatable()


def some_runs_are_complete(folder):
    kept = folder / f"{RESULT}.partial"
    return kept.exists() and kept.read_bytes().count(b"\n") > 2


@contextmanager
def meanwhile(condition, action):
    """Act once a condition holds, while the block runs."""
    thread = threading.Thread(target=lambda: (wait_until(condition), action()))
    thread.start()
    yield
    thread.join()


# --- what is no scheduler -----------------------------------------------------------------------

ANSWERS = {
    "says nothing": lambda _: None,
    "is an ssh server": lambda connection: connection.sendall(b"SSH-2.0-OpenSSH_9.2p1\r\n"),
    "is a web server": lambda connection: connection.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n"),
    "hangs up": socket.socket.close,
}


@contextmanager
def server(answer):
    """Accept connections, answer each, and keep it open; yield the address."""
    kept = []
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def serve():
            try:
                while True:
                    kept.append(listening.accept()[0])
                    answer(kept[-1])
            except OSError:  # the test has ended
                return

        threading.Thread(target=serve, daemon=True).start()
        yield f"tcp://127.0.0.1:{listening.getsockname()[1]}"
        listening.shutdown(socket.SHUT_RDWR)
    for connection in kept:
        connection.close()


@pytest.mark.parametrize("what", ANSWERS)
def test_what_is_no_scheduler_is_left_soon(bench, run, monkeypatch, what):
    monkeypatch.setattr(cluster, "CONNECTING", 1.0)
    before = tree(bench)
    with server(ANSWERS[what]) as address:
        begun = time.monotonic()
        code, _, errors = run(*FIT, address)
        assert time.monotonic() - begun < 20
    assert code == 2
    (line,) = errors.splitlines()
    assert line.startswith(f"cylcontact: --scheduler: '{address}': cannot be reached (")
    assert line.endswith("; start one with dask scheduler, and give the address that it prints")
    assert tree(bench) == before


def test_the_address_of_a_worker_is_no_schedulers(loopback):
    import distributed

    with distributed.Client(loopback.address, set_as_default=False) as client:
        client.wait_for_workers(1)
        (worker, *_) = client.scheduler_info()["workers"]
    with pytest.raises(InputError) as caught:
        list(run_calls([call(abs, -1)], Cluster(worker)))
    rule, remedy = "is the address of a worker, not of a scheduler", "start one with dask scheduler"
    assert_told(caught, "--scheduler", "", worker, rule, remedy)


# --- certificates -------------------------------------------------------------------------------

TLS = "DASK_DISTRIBUTED__COMM__TLS__"


def certificates(folder):
    """Return what makes Dask use new certificates: a CA's that is a server's and a client's too."""
    folder.mkdir()
    if shutil.which("openssl") is None:
        pytest.skip("openssl is not installed (Debian: apt install openssl)")
    key, certificate = folder / "key.pem", folder / "certificate.pem"
    subprocess.run(
        [
            *("openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "9"),
            *("-subj", "/CN=127.0.0.1", "-addext", "subjectAltName=IP:127.0.0.1"),
            *("-keyout", key, "-out", certificate),
        ],
        check=True,
        capture_output=True,
    )
    names = ("SCHEDULER", "WORKER", "CLIENT")
    return {
        f"{TLS}CA_FILE": str(certificate),
        **{f"{TLS}{name}__CERT": str(certificate) for name in names},
        **{f"{TLS}{name}__KEY": str(key) for name in names},
    }


def test_certificates_are_needed_and_checked(bench, longer):
    own, others = certificates(bench.parent / "own"), certificates(bench.parent / "others")
    seconds = {"DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "3s"}
    with LoopbackCluster(bench.parent, environment=own, host="tls://127.0.0.1") as started:
        for known in ({}, others):
            code, line = in_own_process(bench, known | seconds, *FIT, started.address)
            assert code == 2
            assert line.startswith(f"cylcontact: --scheduler: '{started.address}': cannot be rea")
            names = [f"{TLS}{name}" for name in ("CA_FILE", "CLIENT__CERT", "CLIENT__KEY")]
            assert f"; set {', '.join(names)}, and give" in line
        code, said = in_own_process(bench, own, *FIT, started.address)
    assert (code, said) == (0, "")
    assert FitResult.read(RESULT).repeatable() == longer


def in_own_process(folder, environment, *arguments):
    """Run a command with variables; return its exit code and its errors."""
    process = start(folder, *arguments, environment=environment)
    errors = process.communicate(timeout=120)[1]
    return process.returncode, errors


def start(folder, *arguments, environment=None):
    """Start a command that ends with the tests."""
    return subprocess.Popen(
        tethered([sys.executable, "-m", "cylcontact.cli", *arguments]),
        cwd=folder,
        env=os.environ | (environment or {}),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


# --- workers ------------------------------------------------------------------------------------


def test_new_workers_take_over_when_all_are_lost(tmp_path):
    with LoopbackCluster(tmp_path, workers=1) as started:
        results = run_calls(SLEEPS, Cluster(started.address), ordered=False)
        next(results)
        kill(started.workers[0])
        started.add_worker()
        assert len(list(results)) == len(SLEEPS) - 1


# Dask gives up a worker that it has not heard of for five minutes.
SOON = {"DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": "3s"}


@contextmanager
def stopped(*processes):
    """Stop processes: they are there, and do not answer."""
    for process in processes:
        process.send_signal(signal.SIGSTOP)
    try:
        yield
    finally:
        for process in processes:
            process.send_signal(signal.SIGCONT)


def test_the_calls_of_a_worker_that_does_not_answer_go_to_another(tmp_path):
    with LoopbackCluster(tmp_path, environment=SOON) as started:
        results = run_calls(SLEEPS, Cluster(started.address), ordered=False)
        next(results)
        with stopped(started.workers[0]):
            assert len(list(results)) == len(SLEEPS) - 1


def test_a_worker_that_does_not_answer_at_the_start(tmp_path, monkeypatch):
    with LoopbackCluster(tmp_path, environment=SOON) as started:
        list(run_calls(SLEEPS, Cluster(started.address)))  # both are there
        monkeypatch.setattr(cluster, "CONNECTING", 1.0)
        with stopped(started.workers[0]):
            assert list(run_calls([call(abs, -1)] * 4, Cluster(started.address))) == [1] * 4


@pytest.mark.parametrize("who", ["workers", "scheduler"])
def test_nobody_who_answers_is_told(tmp_path, monkeypatch, who):
    monkeypatch.setattr(cluster, "DESERTED", 2.0)
    with LoopbackCluster(tmp_path, workers=1, environment=SOON) as started:
        results = run_calls(SLEEPS, Cluster(started.address))
        next(results)
        monkeypatch.setattr(cluster, "CONNECTING", 1.0)  # and to take leave
        silent = started.workers if who == "workers" else [started.scheduler]
        with stopped(*silent), pytest.raises(InputError) as caught:
            list(results)
    assert_told(caught, "--scheduler", "", started.address, DESERTED, AGAIN)


def test_a_command_with_cases_keeps_them_when_the_workers_are_gone(tmp_path, run, monkeypatch):
    monkeypatch.setattr(cluster, "DESERTED", 8.0)
    monkeypatch.chdir(tmp_path)
    cases = ("simulate", f"{ROOT}/datasets/slider_crank.toml", "--study", "cases", "-o", "c.csv")
    cases += ("--revolutions", "40", "--law", "enhanced", "--friction", "0,0.01,0.1")
    cases += ("--restitution", "1,0.9")
    kept = tmp_path / "c.csv.partial"
    assert run(*cases[:2], "--revolutions", 1)[0] == 0  # compiles what the worker needs
    with (
        LoopbackCluster(tmp_path, workers=1) as started,
        meanwhile(
            lambda: kept.exists() and kept.read_bytes().count(b"\n") > 1,
            lambda: kill(started.workers[0]),
        ),
    ):
        code, _, errors = run(*cases, "--scheduler", started.address)
    assert code == 2
    deserted = DESERTED.replace("2 s", "8 s")
    assert errors == f"cylcontact: --scheduler: {started.address!r}: {deserted}; {AGAIN}\n"
    complete = kept.read_bytes().count(b"\n") - 1
    assert 1 <= complete < 6
    assert run(*cases, "--resume", "--jobs", 1)[0] == 0
    assert (tmp_path / "c.csv").read_text().count("complete") == 6


# --- the scheduler ------------------------------------------------------------------------------


def test_a_fit_resumes_on_a_scheduler_that_is_back(bench, run, longer):
    with LoopbackCluster(bench.parent) as started:
        with meanwhile(lambda: some_runs_are_complete(bench), lambda: kill(started.scheduler)):
            code, _, errors = run(*FIT, started.address)
        assert code == 2
        assert len(errors.splitlines()) == 1
        assert errors.startswith(f"cylcontact: --scheduler: {started.address!r}: was lost during")
        started.start_scheduler(port=started.address.rpartition(":")[2])
        started.add_worker()
        assert run(*FIT, started.address, "--resume")[0] == 0
    assert FitResult.read(RESULT).repeatable() == longer


def test_an_interrupted_fit_leaves_the_cluster_free_and_resumes(bench, loopback, longer):
    fit = start(bench, *FIT, loopback.address)
    wait_until(lambda: some_runs_are_complete(bench) or fit.poll() is not None)
    fit.send_signal(signal.SIGINT)
    said = fit.communicate(timeout=60)[1]
    assert fit.returncode == 130, said
    assert re.fullmatch(r"cylcontact: interrupted; \d+ complete runs are kept in .*\n", said)
    assert list(run_calls([call(abs, -1)], Cluster(loopback.address))) == [1]
    assert in_own_process(bench, {}, *FIT, loopback.address, "--resume") == (0, "")
    assert FitResult.read(RESULT).repeatable() == longer


def test_two_fits_on_one_cluster_do_not_meet(bench, loopback, longer):
    both = [start(bench, *FIT, loopback.address, "-o", f"{name}.json") for name in ("one", "other")]
    for fit, name in zip(both, ("one", "other"), strict=True):
        assert fit.communicate(timeout=120)[1] == ""
        assert FitResult.read(f"{name}.json").repeatable() == longer


# --- calls and their answers --------------------------------------------------------------------


class Unreadable(Exception):  # noqa: N818 - what makes it one is that two arguments are needed
    """Unpickled, it is made of its message alone, and fails."""

    def __init__(self, one, other):
        super().__init__(f"{one} {other}")


def answer_unreadably():
    return Unreadable("one", "other")


def fail_unreadably():
    raise Unreadable("one", "other")


@pytest.mark.parametrize("function", [answer_unreadably, fail_unreadably, threading.Lock])
def test_an_answer_that_cannot_be_sent_or_read_is_told(loopback, function):
    with pytest.raises(InputError) as caught:
        list(run_calls([call(abs, -1), call(function)], Cluster(loopback.address)))
    rule = "a call did not come through ("
    assert_told(caught, "--scheduler", "", loopback.address, rule, "install the same on all")


def fail():
    raise ZeroDivisionError("in a call")


def test_an_error_of_a_call_comes_back_with_its_traceback(loopback):
    with pytest.raises(ZeroDivisionError, match="in a call") as caught:
        list(run_calls([call(fail)], Cluster(loopback.address)))
    (note,) = caught.value.__notes__
    assert note.startswith("In a worker:\nTraceback ")
    assert "in fail" in note


# --- a law of one's own -------------------------------------------------------------------------


def test_a_law_of_ones_own_is_found_by_workers_that_stand_elsewhere(tmp_path, loopback):
    campaign = user_campaign(tmp_path)
    assert (
        calibrate(campaign, Cluster(loopback.address)).repeatable()
        == calibrate(campaign).repeatable()
    )


@pytest.mark.parametrize("change", ["missing", "changed"])
def test_workers_without_the_law_that_was_read_say_so(tmp_path, loopback, change):
    """On other machines, its file may not be there, or be an older one."""
    campaign, file = user_campaign(tmp_path), tmp_path / "mine.py"
    if change == "missing":
        file.unlink()
    else:
        file.write_text(USER_LAW + "\n")
    with pytest.raises(InputError) as caught:
        calibrate(campaign, Cluster(loopback.address))
    remedy = "put it at the same place on all machines"
    assert_told(caught, "mine:load", "law", None, f"{file} is missing or changed on ", remedy)


def test_a_law_that_was_edited_between_two_fits_is_the_new_one_in_every_worker(tmp_path, loopback):
    where = Cluster(loopback.address)
    before = calibrate(user_campaign(tmp_path), where).coefficients["K_star"]
    stiffer = USER_LAW.replace("return K_star", "return 2 * K_star")
    assert stiffer != USER_LAW
    campaign = user_campaign(tmp_path, text=stiffer)
    assert calibrate(campaign, where).coefficients["K_star"] == pytest.approx(before / 2)
