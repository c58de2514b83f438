"""Never lose work: killed, interrupted and resumed commands, and no process left."""

import itertools
import json
import os
import pickle
import random
import re
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.support import killable
from tests.support.killable import ROOT, family, wait_until
from tests.support.spec_files import ELEMENTS, tree, write_bench, write_toml

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGKILL"),
]
LONG = pytest.mark.long
in_proc = pytest.mark.skipif(
    not Path("/proc/self/environ").exists(), reason="processes are found in /proc"
)

# Quick but for the runs: a fit spends most of its time between the first and the last of them.
FEW = {"parameters.n": {"value": 1.2, "fixed": True}}
RUNS = FEW | {"genetic.runs": 12, "genetic.generations": 60, "genetic.populations": [16]}
MINUTES = {"genetic.runs": 50, "genetic.generations": 3000, "genetic.populations": [16]}
FIT = ("fit", "fitting/small.toml", "--jobs", "1")
AS_USER = (sys.executable, "-m", "cylcontact.cli")
RESULT = "fitting/results/small.json"
SHARED = Path("/dev/shm")


def bench(root):
    folder = root / "bench"
    write_bench(folder, RUNS)
    write_toml(folder / "elements.toml", ELEMENTS)
    return folder


def repeatable(path):
    """Return the text of a result file without the times and the provenance."""
    data = json.loads(path.read_text(encoding="utf-8"))
    del data["provenance"]
    for run in data["runs"]:
        del run["seconds"]
    return json.dumps(data)


# --- the commands -----------------------------------------------------------------------------


class Command(NamedTuple):
    """A command in a bench, where `out` is; it is in the middle once a part of it is kept."""

    long: tuple[str, ...]  # has work for minutes
    short: tuple[str, ...] = ()  # ends by itself within some seconds
    output: str = ""
    read: Callable[[Path], object] = Path.read_bytes  # what another run of it gives again

    @property
    def partial(self):
        """The file that keeps the complete parts, from which it resumes."""
        return f"{self.output}.partial"

    def is_in_the_middle(self, folder):
        """Whether a part is complete: a line after the first one."""
        path = folder / self.partial
        return path.exists() and path.read_bytes().count(b"\n") > 1


CASES = ("sweep", f"{ROOT}/datasets/slider_crank.toml", "-o")
STUDY = ("finite-element", f"{ROOT}/datasets/finite_element/convergence.toml", "-o")
COMMANDS = {
    "fit": Command(
        ("fit", "{out}/fitting/small.toml", "-o", "{out}/fit.json"), FIT, RESULT, repeatable
    ),
    "cases": Command(
        (*CASES, "{out}/cases.csv", "--law", "johnson,enhanced", "--friction", "0,0.1"),
        (
            *(*CASES, "cases.csv", "--revolutions", "40", "--law", "enhanced", "--jobs", "1"),
            *("--restitution", "1,0.9", "--friction", "0,0.1"),
        ),
        "cases.csv",
    ),
    "finite-element": Command(
        (*STUDY, "{out}/embedded.csv"),
        ("finite-element", "elements.toml", "-o", "elements.csv", "--jobs", "1"),
        "elements.csv",
    ),
    "optimizers": Command(("optimizers", "{out}/fitting/small.toml", "-o", "{out}/optimizers.csv")),
    "figure": Command(("figure", "-o", "{out}/figures")),
}
RESUMABLE = [name for name, command in COMMANDS.items() if command.short]
EXIT_CODES = {"SIGKILL": -signal.SIGKILL, "SIGINT": 130, "SIGTERM": 130, "SIGHUP": 130}


# --- killed and resumed -----------------------------------------------------------------------


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    """A bench in which the short commands ran through."""
    folder = bench(tmp_path_factory.mktemp("uninterrupted"))
    for name in RESUMABLE:
        assert killable.run(folder, *COMMANDS[name].short) == 0
    return folder


@pytest.mark.parametrize(
    ("name", "how"),
    [
        # Before every change one of each; by night all.
        pytest.param(*case, marks=() if case in (("fit", "SIGKILL"), ("cases", "SIGINT")) else LONG)
        for case in itertools.product(RESUMABLE, ("SIGKILL", "SIGINT", "SIGTERM", "SIGHUP"))
    ],
)
def test_stopped_in_the_middle_and_resumed_it_gives_the_same(uninterrupted, tmp_path, name, how):
    command = COMMANDS[name]
    folder = bench(tmp_path)
    before = tree(folder)
    process = killable.start(folder, *command.short)
    wait_until(lambda: command.is_in_the_middle(folder) or not process.is_alive())
    os.kill(process.pid, getattr(signal, how))
    process.join()
    assert process.exitcode == EXIT_CODES[how], killable.said(folder)
    if how != "SIGKILL":
        line = rf"cylcontact: interrupted; \d+ complete .* kept in {command.partial}; "
        line += "the same command with --resume goes on from there\n"
        assert re.fullmatch(line, killable.said(folder))
        assert written(folder, before) == {command.partial}
    assert killable.run(folder, *command.short, "--resume") == 0, killable.said(folder)
    assert command.read(folder / command.output) == command.read(uninterrupted / command.output)
    assert written(folder, before) == {command.output}


def written(folder, before):
    """Return the files in a folder that were not there before."""
    return {name for name in tree(folder).keys() - before.keys() if (folder / name).is_file()}


def assert_interrupted(started):
    """A command ended by Ctrl-C, and said so in one line.

    Python itself ends by the signal, whatever code it was given, when Ctrl-C falls into the `exec`
    of a string, as a dataclass is made. Rarely, joblib's tracker of resources warns of one that has
    just been removed.
    """
    errors = started.said.read_text()
    assert started.process.returncode in (130, -signal.SIGINT), errors
    lines = re.sub(r".*resource_tracker.*\n( .*\n)?", "", errors)
    assert re.fullmatch(r"cylcontact: interrupted.*\n", lines), errors


# --- no process outlives its command ------------------------------------------------------------

# Seconds after the first worker process is there; the first one is from the very start.
MOMENTS = {"early": None, "workers start": 0.4, "under way": 2.0}


def end_one(folder, name, how, moment):
    """Start a command, and end it at a moment: nobody is left."""
    out, scratch, said = folder / "out", folder / "scratch", folder / "stderr"
    write_bench(out, MINUTES)
    before, shared = set(tree(out)), set(SHARED.iterdir())
    scratch.mkdir()
    arguments = [part.format(out=out) for part in COMMANDS[name].long]
    command = [*AS_USER, *arguments, "--jobs", "2"]
    terminal = how == "closed terminal"
    with family(command, said, terminal=terminal, TMPDIR=str(scratch)) as started:
        if moment == "early":
            time.sleep(random.uniform(0.1, 1.5))
        else:
            wait_until(started.has_workers)
            time.sleep(MOMENTS[moment])
        assert started.process.poll() is None, said.read_text()
        numbers = [*started.members()]
        started.end(how)
        started.wait_until_gone()
    assert shared_memory(numbers, shared) == []
    if how != "SIGKILL":
        assert [path for path in set(tree(out)) - before if is_half_written(path)] == []
        assert tree(scratch) == {}
    if how in ("SIGINT", "SIGTERM") and moment != "early":
        assert_interrupted(started)


def is_half_written(path):
    """Whether a file is none that a command completes, nor one that it keeps to resume from."""
    return Path(path).name.startswith(".")


def shared_memory(numbers, before):
    """Return what processes left in shared memory: loky's semaphores, joblib's arrays."""
    marks = [mark for n in numbers for mark in (f"loky-{n}-", f"_folder_{n}_")]
    left = set(SHARED.iterdir()) - before  # of before may be those of a process with this number
    return [path for path in left if any(mark in path.name for mark in marks)]


ENDS = itertools.product(COMMANDS, ("SIGKILL", "SIGINT", "SIGTERM", "closed terminal"), MOMENTS)


@in_proc
@pytest.mark.parametrize(
    ("name", "how", "moment"),
    [
        pytest.param(*case, marks=() if case == ("cases", "SIGKILL", "early") else LONG)
        for case in ENDS
    ],
)
def test_no_command_leaves_a_process_whatever_ends_it_and_when(tmp_path, name, how, moment):
    end_one(tmp_path, name, how, moment)


# --- files are read, never run ----------------------------------------------------------------


class Payload:
    """Unpickled, it makes a file."""

    def __init__(self, target):
        self.target = target

    def __reduce__(self):
        return (Path.touch, (Path(self.target),))


@pytest.mark.parametrize("kind", ["pickle", pytest.param("python", marks=LONG)])
def test_no_file_of_the_users_is_unpickled_or_run(tmp_path, kind):
    folder = bench(tmp_path)
    mark = tmp_path / "was-run"
    evil = {
        "pickle": pickle.dumps(Payload(mark)),
        "python": f"import pathlib; pathlib.Path({str(mark)!r}).touch()\n".encode(),
    }[kind]
    names = (
        *("evil.toml", "evil.json", "evil.csv", "evil.parquet", "evil.pkl", "r.json.partial"),
        *("numpy.py", "sitecustomize.py", "conftest.py", "evil.npy"),
    )
    for name in names:
        (folder / name).write_bytes(evil)
    read = {"fit": "toml csv parquet pkl", "compare": "json pkl", "simulate": "toml"}
    for command, name in ((c, f"evil.{kind}") for c in read for kind in read[c].split()):
        assert killable.run(folder, command, name) == 2, killable.said(folder)
        assert len(killable.said(folder).splitlines()) == 1
    assert killable.run(folder, *FIT, "--resume", "-o", "r.json") == 2
    assert killable.run(folder, *FIT, "-o", "r.json") == 0
    assert not mark.exists()
