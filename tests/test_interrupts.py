"""Never lose work: killed, interrupted and resumed commands, full disks, lost folders, locks."""

import errno
import json
import os
import pickle
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

import pytest

from cylcontact import InputError
from cylcontact.files import owning, replacing
from cylcontact.fitting import calibrate, read_campaign
from cylcontact.mechanism import Trajectory
from cylcontact.tether import tethered
from tests import killable
from tests.killable import ROOT, family, wait_until
from tests.programs import fake_program, require_program
from tests.spec_files import ELEMENTS, GRID, assert_told, changed, tree, write_bench, write_toml

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGKILL"),
]
in_proc = pytest.mark.skipif(
    not Path("/proc/self/environ").exists(), reason="processes are found in /proc"
)

# Quick but for the runs: a fit spends most of its time between the first and the last of them.
FEW = {"parameters.n": {"value": 1.2, "fixed": True}}
RUNS = FEW | {"genetic.runs": 12, "genetic.generations": 60, "genetic.populations": [16]}
LONGER = RUNS | {"genetic.generations": 200}
LONG = {"genetic.runs": 50, "genetic.generations": 3000, "genetic.populations": [16]}
FIT = ("fit", "fitting/small.toml", "--jobs", "1")
AS_USER = (sys.executable, "-m", "cylcontact.cli")
RESULT = "fitting/results/small.json"
ROOT_USER = hasattr(os, "geteuid") and os.geteuid() == 0
NOBODY = 65534
SHARED = Path("/dev/shm")


def bench(root, name="bench", campaign=RUNS):
    folder = root / name
    write_bench(folder, campaign)
    write_toml(folder / "elements.toml", ELEMENTS)
    return folder


def repeatable(path):
    """Return the text of a result file without the times and the provenance."""
    data = json.loads(path.read_text(encoding="utf-8"))
    del data["provenance"]
    for run in data["runs"]:
        del run["seconds"]
    return json.dumps(data)


def beside_result(folder):
    """The names of what is in the folder of the result."""
    return {path.name for path in (folder / RESULT).parent.iterdir()}


def resume(folder, uninterrupted):
    """Go on from what is kept: the uninterrupted result comes, and nothing else is left."""
    assert killable.run(folder, *FIT, "--resume") == 0, killable.said(folder)
    assert_complete(folder, uninterrupted)


def assert_complete(folder, uninterrupted):
    assert repeatable(folder / RESULT) == repeatable(uninterrupted / RESULT)
    assert beside_result(folder) == {"small.json"}


def one_line(folder):
    """What the last command said, which is a single line."""
    (line,) = killable.said(folder).splitlines()
    return line


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


CASES = ("simulate", f"{ROOT}/datasets/slider_crank.toml", "--study", "cases", "-o")
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
    "optimizers": Command(
        ("fit", "{out}/fitting/small.toml", "--optimizer", "all", "-o", "{out}/optimizers.csv")
    ),
    "figure": Command(("figure", "-o", "{out}/figures")),
    "calculix": Command((*STUDY, "{out}/calculix.csv", "--engine", "calculix")),
}
RESUMABLE = [name for name, command in COMMANDS.items() if command.short]
EXIT_CODES = {"SIGKILL": -signal.SIGKILL, "SIGINT": 130, "SIGTERM": 130, "SIGHUP": 130}


# --- killed and resumed -----------------------------------------------------------------------


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    """A bench in which the short commands ran through, and how many seconds the fit took."""
    folder = bench(tmp_path_factory.mktemp("uninterrupted"))
    for name in RESUMABLE:
        assert killable.run(folder, *COMMANDS[name].short) == 0  # imports what is left to import
    started = time.monotonic()
    assert killable.run(folder, *FIT) == 0
    folder.joinpath("seconds").write_text(str(time.monotonic() - started))
    return folder


@pytest.mark.parametrize("name", RESUMABLE)
@pytest.mark.parametrize(
    "how",
    [
        *("SIGKILL", "SIGINT"),
        "SIGTERM",
        "SIGHUP",
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


def test_an_interrupted_simulation_keeps_its_revolutions(tmp_path):
    out = tmp_path / "bench/run.parquet"
    simulate = ("simulate", f"{ROOT}/datasets/slider_crank.toml", "-o", out, "--revolutions")
    out.parent.mkdir()
    seconds = 0.5
    while not out.exists():  # until a revolution was complete
        process = killable.start(out.parent, *simulate, 5000)
        wait_until(out.with_name("run.parquet.lock").exists)
        time.sleep(seconds)
        os.kill(process.pid, signal.SIGINT)
        process.join()
        assert process.exitcode == 130
        seconds *= 2
    revolutions = Trajectory.load(out).revolutions
    line = f"interrupted; complete revolutions kept in {out}: {revolutions}; "
    assert line in killable.said(out.parent)
    assert revolutions >= 1
    assert list(tree(out.parent)) == ["run.parquet"]


@pytest.mark.long
def test_resume_after_kill_9_at_random_moments(uninterrupted, tmp_path):
    trials = 20
    seconds = float((uninterrupted / "seconds").read_text())
    moments = random.Random(20150101)
    killed = resumable = 0
    for trial in range(trials):
        folder = bench(tmp_path, f"trial{trial}")
        killed += killable.run_and_kill(folder, *FIT, seconds=moments.uniform(0, seconds))
        resumable += (folder / f"{RESULT}.partial").exists()
        resume(folder, uninterrupted)
    # Most are killed on the way, wherever this machine's load puts that.
    assert killed >= trials / 2
    assert resumable >= trials / 6


@pytest.mark.long
def test_killed_again_and_again_it_arrives_in_the_end(uninterrupted, tmp_path):
    seconds = float((uninterrupted / "seconds").read_text())
    folder = bench(tmp_path)
    for _ in range(50):
        if not killable.run_and_kill(folder, *FIT, "--resume", seconds=0.6 * seconds):
            break
        seconds *= 1.05
    assert_complete(folder, uninterrupted)


@pytest.mark.long
def test_killed_before_every_single_operation_on_a_file(tmp_path):
    """Three runs: the lock, the journal, the result, and what is removed in the end."""
    whole = bench(tmp_path, "whole", FEW)
    assert killable.run(whole, *FIT) == 0
    operations = 0
    while True:
        folder = bench(tmp_path, f"before{operations}", FEW)
        code = killable.run(folder, *FIT, kill_at=operations)
        if code == 0:
            break
        assert code == -signal.SIGKILL
        resume(folder, whole)
        operations += 1
    assert operations > 15


@pytest.fixture(scope="module")
def longer(tmp_path_factory):
    """A bench whose fit took long enough for worker processes to start, and ran through."""
    folder = bench(tmp_path_factory.mktemp("longer"), campaign=LONGER)
    assert killable.run(folder, *FIT) == 0
    return folder


def test_a_fit_with_worker_processes_ends_in_a_forked_process_too(tmp_path):
    assert killable.run(bench(tmp_path), *FIT[:2], "--jobs", "2") == 0


@pytest.mark.long
@in_proc
@pytest.mark.parametrize("how", ["SIGKILL", "SIGINT"])
def test_stopped_with_worker_processes_under_way_it_resumes(longer, tmp_path, how):
    """As a user runs it: processes of its own, and all of them gone soon after."""
    folder = bench(tmp_path, campaign=LONGER)
    with family([*AS_USER, *FIT[:2], "--jobs", "2"], tmp_path / "stderr", folder) as fit:
        wait_until(lambda: COMMANDS["fit"].is_in_the_middle(folder))
        fit.end(how)
        fit.wait_until_gone()
    complete = (folder / f"{RESULT}.partial").read_bytes().count(b"\n") - 1
    assert 1 <= complete < 12
    if how == "SIGINT":
        assert_interrupted(
            fit, f"interrupted; {complete} complete runs? .* kept in {RESULT}.partial; .*"
        )
        assert beside_result(folder) == {"small.json.partial"}
    resume(folder, longer)


@pytest.mark.long
@in_proc
def test_a_fit_interrupted_while_its_workers_start_keeps_nothing_and_says_so(tmp_path):
    folder = bench(tmp_path, campaign=LONG)
    before = tree(folder)
    command = [*AS_USER, "fit", "fitting/small.toml", "-o", "new/r.json", "--jobs", "2"]
    with family(command, tmp_path / "stderr", folder) as fit:
        wait_until(fit.has_workers)
        fit.end("SIGINT")
        fit.wait_until_gone()
    assert_interrupted(fit, "interrupted before a run was complete; nothing is kept")
    assert tree(folder) == before


def assert_interrupted(started, message):
    """A command ended by Ctrl-C, and said so in one line.

    Python itself ends by the signal, whatever code it was given, when Ctrl-C falls into the `exec`
    of a string, as a dataclass is made. Rarely, joblib's tracker of resources warns of one that has
    just been removed.
    """
    errors = started.said.read_text()
    assert started.process.returncode in (130, -signal.SIGINT), errors
    lines = re.sub(r".*resource_tracker.*\n( .*\n)?", "", errors)
    assert re.fullmatch(rf"cylcontact: {message}\n", lines), errors


def test_an_interrupted_table_leaves_nothing(tmp_path):
    folder = bench(tmp_path)
    large = {"axes.E.points": 300, "axes.dR.points": 1000, "axes.load.points": 300}
    write_toml(folder / "datasets/large.toml", changed(GRID, large))
    before = tree(folder)
    process = killable.start(folder, "sample", "datasets/large.toml", "-o", "new/large.parquet")
    wait_until(lambda: list(folder.glob("new/.large-*.parquet")))
    os.kill(process.pid, signal.SIGINT)
    process.join()
    assert process.exitcode == 130
    assert killable.said(folder) == "cylcontact: interrupted; nothing is left half-written\n"
    assert tree(folder) == before


# --- no process outlives its command ------------------------------------------------------------

# Seconds after the first worker process is there; the first one is from the very start.
MOMENTS = {"early": None, "first worker": 0.0, "workers start": 0.4, "under way": 2.0}


def end_one(folder, name, how, moment):
    """Start a command, end it at a moment, and return the seconds until nobody was left."""
    out, scratch, said = folder / "out", folder / "scratch", folder / "stderr"
    write_bench(out, LONG)
    before, shared = set(tree(out)), set(SHARED.iterdir())
    scratch.mkdir()
    # It stands for CalculiX and does not end.
    script = "case $1 in -v) echo This is Version 9.9 ;; *) exec sleep 600 ;; esac"
    ccx = fake_program(folder / "bin", "ccx", script)
    arguments = [part.format(out=out) for part in COMMANDS[name].long]
    command = [*AS_USER, *arguments, "--jobs", "2"]
    environment = {"PATH": f"{ccx.parent}:{os.environ['PATH']}", "TMPDIR": str(scratch)}
    with family(command, said, terminal=how == "closed terminal", **environment) as started:
        if moment == "early":
            time.sleep(random.uniform(0.1, 1.5))
        else:
            wait_until(started.has_workers)
            time.sleep(MOMENTS[moment])
        assert started.process.poll() is None, said.read_text()
        numbers = [*started.members()]
        started.end(how)
        seconds = started.wait_until_gone()
    assert shared_memory(numbers, shared) == []
    if how != "SIGKILL":
        assert [path for path in set(tree(out)) - before if is_half_written(path)] == []
        assert tree(scratch) == {}
    if how in ("SIGINT", "SIGTERM") and moment != "early":
        assert_interrupted(started, "interrupted.*")
    return seconds


def is_half_written(path):
    """Whether a file is none that a command completes, nor one that it keeps to resume from."""
    return Path(path).name.startswith(".") or Path(path).suffix == ".lock"


def shared_memory(numbers, before):
    """Return what processes left in shared memory: loky's semaphores, joblib's arrays."""
    marks = [mark for n in numbers for mark in (f"loky-{n}-", f"_folder_{n}_")]
    left = set(SHARED.iterdir()) - before  # of before may be those of a process with this number
    return [path for path in left if any(mark in path.name for mark in marks)]


@in_proc
@pytest.mark.parametrize(
    ("name", "how", "moment"),
    [
        pytest.param("fit", "SIGKILL", "first worker", marks=pytest.mark.long),
        ("cases", "SIGKILL", "early"),
        pytest.param("figure", "SIGTERM", "workers start", marks=pytest.mark.long),
        ("calculix", "SIGKILL", "under way"),
        ("fit", "closed terminal", "workers start"),
    ],
)
def test_a_command_leaves_no_process(tmp_path, name, how, moment):
    end_one(tmp_path, name, how, moment)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such signal")
def test_a_program_whose_parent_has_ended_already_is_not_started(tmp_path):
    command = tethered(["touch", str(tmp_path / "started")])
    subprocess.run(command, check=True)
    (tmp_path / "started").unlink()
    command[command.index(str(os.getpid()))] = "0"
    subprocess.run(command, check=True)
    assert not (tmp_path / "started").exists()


@pytest.mark.long
@in_proc
@pytest.mark.parametrize("how", ["SIGKILL", "SIGINT", "SIGTERM", "closed terminal"])
@pytest.mark.parametrize("moment", ["early", "workers start", "under way"])
@pytest.mark.parametrize("name", COMMANDS)
def test_no_command_leaves_a_process_whatever_ends_it_and_when(
    tmp_path, name, how, moment, pytestconfig
):
    seconds = []
    for number in range(pytestconfig.getoption("--trials")):
        (tmp_path / str(number)).mkdir()
        seconds.append(end_one(tmp_path / str(number), name, how, moment))
    print(f"{name}, {how}, {moment}, {len(seconds)} times: nobody left after {max(seconds):.1f} s")


# --- two processes on one output --------------------------------------------------------------


def test_the_second_of_two_fits_of_one_output_says_so_and_stops(tmp_path):
    folder = bench(tmp_path, campaign=RUNS | {"genetic.generations": 30_000})
    first = killable.start(folder, *FIT)
    wait_until((folder / f"{RESULT}.lock").exists)
    before = tree(folder)
    assert killable.run(folder, *FIT) == 2
    said = one_line(folder)
    assert f"{RESULT}: is being written by process {first.pid} on " in said
    assert said.endswith("; wait for it to end, or choose another output with -o")
    assert set(tree(folder)) >= set(before)
    first.kill()
    first.join()
    # The file stays behind, and locks nothing any more.
    assert (folder / f"{RESULT}.lock").exists()
    write_bench(folder, FEW)
    assert killable.run(folder, *FIT) == 0, killable.said(folder)
    assert beside_result(folder) == {"small.json"}


@pytest.mark.long
@pytest.mark.parametrize(
    "arguments",
    [
        ("sample", "datasets/small.toml", "-o", "held.csv"),
        ("fit", "fitting/small.toml", "-o", "held.json"),
        ("fit", "fitting/small.toml", "--optimizer", "all", "-o", "held.csv"),
    ],
    ids=lambda arguments: " ".join(arguments[:-2:2]),
)
def test_every_long_command_respects_the_lock(tmp_path, arguments):
    folder = bench(tmp_path)
    with owning(folder / arguments[-1]):
        before = tree(folder)
        assert killable.run(folder, *arguments) == 2
        assert tree(folder) == before
    assert f"{arguments[-1]}: is being written by process {os.getpid()} on " in killable.said(
        folder
    )


def test_a_lock_ends_with_the_block_and_leaves_nothing(tmp_path):
    for _ in range(2):
        with owning(tmp_path / "new/folder/out.json"):
            pass
    with pytest.raises(KeyboardInterrupt), owning(tmp_path / "new/folder/out.json"):
        raise KeyboardInterrupt
    assert tree(tmp_path) == {}


def test_a_lock_file_removed_by_hand_is_nobodys_loss(tmp_path):
    path = tmp_path / "out.json"
    with owning(path):
        (tmp_path / "out.json.lock").unlink()
        with owning(path):
            pass
    assert tree(tmp_path) == {}


def test_what_a_killed_process_half_wrote_is_removed_and_nothing_else(tmp_path):
    mark, date = "0123456789abcdef", "20261123"
    others = (f".other-{mark}.json", f".out-{date}.json", f".out-{mark}.csv", f"out-{mark}.json")
    for name in (*others, f".out-{mark}.json"):
        (tmp_path / name).touch()
    with owning(tmp_path / "out.json"):
        pass
    assert set(tree(tmp_path)) == set(others)


# --- full disks, lost permissions, removed folders --------------------------------------------


class SmallDisk:
    """A folder on a file system of some bytes, which can be filled up.

    Only root, outside of most containers, may mount one; elsewhere the system calls that write
    say that there is no room.
    """

    def __init__(self, folder, size, monkeypatch, mount):
        folder.mkdir()
        self.folder, self._monkeypatch = folder, monkeypatch
        command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
        wanted = mount and ROOT_USER and shutil.which("mount")
        self.mounted = bool(wanted) and subprocess.run(command, check=False).returncode == 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.free()
        if self.mounted:
            subprocess.run(["umount", str(self.folder)], check=True)

    def fill(self):
        """Leave no room."""
        if self.mounted:
            with (self.folder / "filler").open("wb", buffering=0) as file, suppress(OSError):
                while True:
                    file.write(bytes(1024))
        for name in () if self.mounted else ("fsync", "write"):
            self._monkeypatch.setattr(os, name, self._no_room)

    def free(self):
        """Make room again."""
        (self.folder / "filler").unlink(missing_ok=True)
        if not self.mounted:
            self._monkeypatch.undo()

    @staticmethod
    def _no_room(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def stopping(action, after):
    """A progress callback that acts once some runs are done."""

    def progress(stage, done, _):
        if (stage, done) == ("searching", after):
            action()

    return progress


@pytest.mark.long
@pytest.mark.parametrize("mount", [True, False])
def test_a_disk_that_fills_up_keeps_the_complete_runs(tmp_path, monkeypatch, mount):
    campaign = read_campaign(bench(tmp_path, campaign=RUNS) / "fitting/small.toml", runs=40)
    with SmallDisk(tmp_path / "disk", "64k", monkeypatch, mount) as disk:
        kept = disk.folder / "small.json.partial"
        with pytest.raises(InputError) as caught:
            calibrate(campaign, 1, stopping(disk.fill, 3), kept)
        rule = "cannot be written (No space left on device)"
        assert_told(caught, kept, "", None, rule, "the parts already in it are kept")
        assert kept.read_bytes().count(b"\n") > 3
        disk.free()
        resumed = calibrate(campaign, 1, checkpoint=kept, resume=True)
    assert resumed.repeatable() == calibrate(campaign).repeatable()


@pytest.mark.long
@pytest.mark.parametrize("mount", [True, False])
def test_a_full_disk_leaves_the_result_of_before(tmp_path, small_result, monkeypatch, mount):
    with SmallDisk(tmp_path / "disk", "64k", monkeypatch, mount) as disk:
        path = disk.folder / "result.json"
        small_result.save(path)
        before = path.read_bytes()
        disk.fill()
        with pytest.raises(InputError) as caught:
            small_result.save(path)
        rule = "cannot be written (No space left on device)"
        assert_told(caught, path, "", None, rule, "with room left")
        with pytest.raises(InputError) as caught, owning(path):
            pass
        assert_told(caught, f"{path}.lock", "", None, rule, "with room left")
        disk.free()
        assert [path.name for path in disk.folder.iterdir()] == ["result.json"]
        assert path.read_bytes() == before


@pytest.mark.parametrize(("size", "file"), [(1500, ".partial"), (6000, "")])
def test_a_file_that_may_not_grow_stops_the_fit_which_resumes(uninterrupted, tmp_path, size, file):
    """The system's limit on the size of files stands for any disk: first in the journal."""
    folder = bench(tmp_path)
    (folder / RESULT).parent.mkdir()
    before = (uninterrupted / RESULT).read_bytes()
    (folder / RESULT).write_bytes(before)
    assert killable.run(folder, *FIT, file_size=size) == 2
    line = f"cylcontact: {RESULT}{file}: cannot be written (File too large); "
    assert one_line(folder).startswith(line)
    assert (folder / RESULT).read_bytes() == before
    assert beside_result(folder) == {"small.json", "small.json.partial"}
    resume(folder, uninterrupted)


@contextmanager
def without_permission(folder):
    """Take the right to write into a folder from this process, root or not."""
    if ROOT_USER:
        os.seteuid(NOBODY)
    else:
        folder.chmod(0o555)
    try:
        yield
    finally:
        if ROOT_USER:
            os.seteuid(0)
        else:
            folder.chmod(0o755)


def test_a_folder_that_is_closed_on_the_way(small_campaign, small_result, tmp_path):
    tmp_path.chmod(0o755)
    folder = tmp_path / "results"
    folder.mkdir()
    small_result.save(folder / "result.json")
    before = tree(folder)
    with without_permission(folder):
        for write in (small_result.save, lambda path: owning(path).__enter__()):
            with pytest.raises(InputError) as caught:
                write(folder / "result.json")
            assert_told(
                caught, folder / "result.json", "", None, "cannot be written (", "may write to"
            )
        with pytest.raises(InputError) as caught:
            calibrate(small_campaign, 1, checkpoint=folder / "kept.partial")
    assert_told(caught, folder / "kept.partial", "", None, "cannot be written (", "kept")
    assert tree(folder) == before


def test_a_journal_removed_on_the_way(small_campaign, tmp_path):
    kept = tmp_path / "results/kept.partial"
    for action in (lambda: shutil.rmtree(kept.parent), lambda: replace_file(kept)):
        with pytest.raises(InputError) as caught:
            calibrate(small_campaign, 1, stopping(action, 1), kept)
        rule = "was removed or replaced while in use"
        assert_told(caught, kept, "", None, rule, "start again, and leave its folder alone")


def replace_file(path):
    other = path.with_name("other")
    other.write_text("someone else's")
    other.replace(path)


def test_a_folder_removed_while_a_file_is_written(tmp_path):
    path = tmp_path / "folder/out.csv"
    with pytest.raises(InputError) as caught, replacing(path):
        shutil.rmtree(path.parent)
    assert_told(caught, path, "", None, "cannot be written (No such file or directory)", "choose")
    assert tree(tmp_path) == {}


def test_a_folder_removed_during_a_fit_is_told_of(tmp_path):
    folder = bench(tmp_path, campaign=RUNS | {"genetic.generations": 3000})
    fit = killable.start(folder, *FIT)
    wait_until((folder / f"{RESULT}.partial").exists)
    shutil.rmtree((folder / RESULT).parent)
    fit.join()
    assert fit.exitcode == 2
    assert f"{RESULT}.partial: was removed or replaced while in use; start" in one_line(folder)
    assert not (folder / RESULT).parent.exists()


# --- files are read, never run ----------------------------------------------------------------


class Payload:
    """Unpickled, it makes a file."""

    def __init__(self, target):
        self.target = target

    def __reduce__(self):
        return (Path.touch, (Path(self.target),))


@pytest.mark.parametrize("kind", ["pickle", "python"])
def test_no_file_of_the_users_is_unpickled_or_run(tmp_path, kind):
    folder = bench(tmp_path)
    mark = tmp_path / "was-run"
    evil = {
        "pickle": pickle.dumps(Payload(mark)),
        "python": f"import pathlib; pathlib.Path({str(mark)!r}).touch()\n".encode(),
    }[kind]
    names = (
        *("evil.toml", "evil.json", "evil.csv", "evil.parquet", "evil.pkl", "r.json.partial"),
        *("numpy.py", "sitecustomize.py", "conftest.py", "r.json.lock", "evil.npy"),
    )
    for name in names:
        (folder / name).write_bytes(evil)
    for command in ("fit", "sample", "compare", "verify", "simulate"):
        for name in ("evil.toml", "evil.json", "evil.csv", "evil.parquet", "evil.pkl"):
            out = ("-o", "out.csv") if command == "sample" else ()
            assert killable.run(folder, command, name, *out) == 2, killable.said(folder)
            assert one_line(folder)
    assert killable.run(folder, *FIT, "--resume", "-o", "r.json") == 2
    assert killable.run(folder, *FIT, "-o", "r.json") == 0
    assert not mark.exists()


# --- the tests themselves ---------------------------------------------------------------------

HELPERS = {
    "dask": "from tests.dask_cluster import LoopbackCluster; LoopbackCluster(folder)",
    "forked command": (
        "from tests import killable; from tests.spec_files import write_bench;"
        f"write_bench(folder, {LONG}); killable.start(folder, 'fit', 'fitting/small.toml');"
        "wait_until((folder / 'fitting/results/small.json.partial').exists)"
    ),
    "browser": "from tests.browser import chromium; running = chromium(); running.__enter__()",
}


@pytest.mark.long
@in_proc
@pytest.mark.parametrize("helper", HELPERS)
def test_killed_tests_leave_no_process(tmp_path, helper, pytestconfig):
    if helper == "browser":
        require_program("chromium")
    code = (
        "import sys, time; from pathlib import Path; folder = Path(sys.argv[1]);"
        "from tests.killable import wait_until;"
        f"{HELPERS[helper]}; (folder / 'ready').touch(); time.sleep(600)"
    )
    for trial in range(pytestconfig.getoption("--trials")):
        folder = tmp_path / str(trial)
        folder.mkdir()
        command = [sys.executable, "-c", code, folder]
        with family(command, tmp_path / "stderr") as started:
            wait_until((folder / "ready").exists, (tmp_path / "stderr").read_text)
            assert len(started.members()) > 2
            started.end("SIGKILL")
            started.wait_until_gone()
