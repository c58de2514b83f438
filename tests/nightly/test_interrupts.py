"""Never lose work: killed, interrupted and resumed commands, and no process left."""

import itertools
import json
import os
import pickle
import random
import re
import signal
import subprocess
import sys
import time
import uuid
from contextlib import suppress
from pathlib import Path

import pytest

from tests.support.spec_files import DROP, ELEMENTS, tree, write_bench, write_toml
from tests.support.tether import tethered

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGKILL"),
]
LONG = pytest.mark.long
ROOT = Path(__file__).resolve().parents[2]
ENDS = ("SIGKILL", "SIGINT", "SIGTERM", "SIGHUP")

# Quick but for the runs: a fit spends most of its time between the first and the last of them.
FEW = {"bounds.n": DROP, "fixed.n": 1.2}
RUNS = FEW | {"genetic.runs": 12, "genetic.generations": 60, "genetic.population": 16}
MINUTES = {"genetic.runs": 50, "genetic.generations": 3000, "genetic.population": 16}
FIT = ("fit", "fitting/small.toml", "-j", "1")
CASES = ("sweep", f"{ROOT}/datasets/slider_crank.toml", "-o", "cases.csv")
# Commands that take some seconds, and what they write.
SHORT = {
    "fit": (FIT, "build/small.json"),
    "finite-element": (
        ("finite-element", "elements.toml", "-o", "elements.csv", "-j", "1"), "elements.csv"),
}  # fmt: skip
# Commands that have work for minutes.
STUDY = ("finite-element", f"{ROOT}/datasets/finite_element/convergence.toml", "-o", "fe.csv")
MANY = {
    "fit": (*FIT[:2], "-o", "fit.json"),
    "cases": (*CASES, "--law", "johnson,enhanced", "--friction", "0,0.1"),
    "finite-element": STUDY,
}


def bench(root, campaign):
    folder = root / "bench"
    write_bench(folder, campaign)
    write_toml(folder / "elements.toml", ELEMENTS)
    return folder


def start(folder, *arguments, **environment):
    """Start a command in a folder as a user does; `said` reads its errors."""
    command = tethered([sys.executable, "-m", "cylcontact.cli", *arguments])
    with (folder.parent / "stderr").open("w") as errors:
        return subprocess.Popen(
            command, cwd=folder, env=os.environ | environment, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True,
        )  # fmt: skip


def run(folder, *arguments):
    return start(folder, *arguments).wait(120)


def said(folder):
    return (folder.parent / "stderr").read_text()


def wait_until(holds):
    """Wait until a condition holds, for a minute at most."""
    end = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def repeatable(path):
    """Return the text of an output without the times and the provenance of a fit."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".json":
        return text
    data = json.loads(text)
    del data["provenance"]
    for each in data["runs"]:
        del each["seconds"]
    return json.dumps(data)


def written(folder, before):
    """Return the files in a folder that were not there before."""
    return {name for name in tree(folder).keys() - before.keys() if (folder / name).is_file()}


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    """A bench in which the short commands ran through."""
    folder = bench(tmp_path_factory.mktemp("uninterrupted"), RUNS)
    for command, _ in SHORT.values():
        assert run(folder, *command) == 0, said(folder)
    return folder


def sampled(cases, *quick):
    """Return cases of which all but some are left to the night."""
    return [pytest.param(*case, marks=() if case in quick else LONG) for case in cases]


@pytest.mark.parametrize(
    ("name", "how"),
    sampled(itertools.product(SHORT, ENDS), ("fit", "SIGKILL"), ("finite-element", "SIGINT")),
)
def test_stopped_in_the_middle_and_resumed_it_gives_the_same(uninterrupted, tmp_path, name, how):
    command, output = SHORT[name]
    folder = bench(tmp_path, RUNS)
    before, partial = tree(folder), folder / f"{output}.partial"
    process = start(folder, *command)
    wait_until(lambda: partial.exists() and partial.read_bytes().count(b"\n") > 1)
    process.send_signal(getattr(signal, how))
    assert process.wait(60) == (-signal.SIGKILL if how == "SIGKILL" else 130), said(folder)
    if how != "SIGKILL":
        line = rf"cylcontact: interrupted; \d+ complete .* kept in {output}\.partial; "
        line += "the same command with --resume goes on from there\n"
        assert re.fullmatch(line, said(folder))
        assert written(folder, before) == {f"{output}.partial"}
    assert run(folder, *command, "--resume") == 0, said(folder)
    assert repeatable(folder / output) == repeatable(uninterrupted / output)
    assert written(folder, before) == {output}


# --- no process outlives its command ------------------------------------------------------------


def marked(mark):
    """Return the command lines of processes that have inherited a variable, by number."""
    alive = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it has just ended
            if mark in (folder / "environ").read_bytes():
                alive[int(folder.name)] = (folder / "cmdline").read_bytes()
    return alive


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="no processes in /proc")
@pytest.mark.parametrize(
    ("name", "how", "moment"),
    sampled(itertools.product(MANY, ENDS, ("early", 0.4, 2.0)), ("cases", "SIGKILL", "early")),
)
def test_no_command_leaves_a_process_whatever_ends_it_and_when(tmp_path, name, how, moment):
    """At a moment from the very start, or seconds after the first worker process is there."""
    folder, value = bench(tmp_path, MINUTES), str(uuid.uuid4())
    before, shared = set(tree(folder)), set(Path("/dev/shm").iterdir())
    process = start(folder, *MANY[name], "-j", "2", TEST_FAMILY=value)
    try:
        if moment == "early":
            time.sleep(random.uniform(0.1, 1.5))
        else:
            wait_until(
                lambda: any(b"popen_loky" in each for each in marked(value.encode()).values())
            )
            time.sleep(moment)
        assert process.poll() is None, said(folder)
        numbers = marked(value.encode())
        if how == "SIGINT":  # a terminal sends it to all
            os.killpg(process.pid, signal.SIGINT)
        else:
            process.send_signal(getattr(signal, how))
        process.wait(60)
        wait_until(lambda: not marked(value.encode()))
    finally:
        for number in marked(value.encode()):
            with suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
    left = {path.name for path in set(Path("/dev/shm").iterdir()) - shared}
    assert not [n for n in left if any(f"loky-{k}-" in n or f"_folder_{k}_" in n for k in numbers)]
    if how == "SIGKILL":
        return
    assert not [path for path in set(tree(folder)) - before if Path(path).name.startswith(".")]
    if moment != "early":  # when Python itself may end by the signal, as a starting worker does
        assert "cylcontact: interrupted" in said(folder)


# --- files are read, never unpickled ---------------------------------------------------------


class Payload:
    """Unpickled, it makes a file."""

    def __init__(self, target):
        self.target = target

    def __reduce__(self):
        return (Path.touch, (Path(self.target),))


def test_no_file_of_the_users_is_unpickled(tmp_path):
    folder = bench(tmp_path, RUNS)
    mark = tmp_path / "was-run"
    evil = pickle.dumps(Payload(mark))
    names = (
        *("evil.toml", "evil.json", "evil.csv", "evil.parquet", "evil.pkl", "r.json.partial"),
        *("conftest.py", "evil.npy"),
    )
    for name in names:
        (folder / name).write_bytes(evil)
    read = {"fit": "toml csv parquet pkl", "compare": "json pkl", "simulate": "toml"}
    for command, name in ((c, f"evil.{kind}") for c in read for kind in read[c].split()):
        assert run(folder, command, name) == 2, said(folder)
        assert len(said(folder).splitlines()) == 1
    assert run(folder, *FIT, "--resume", "-o", "r.json") == 2
    assert run(folder, *FIT, "-o", "r.json") == 0
    assert not mark.exists()
