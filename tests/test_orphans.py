"""Nothing outlives its parent, which is killed, interrupted, or loses its terminal."""

import os
import random
import re
import signal
import subprocess
import sys
import time
import uuid
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from cylcontact.tether import tethered
from tests.programs import require_program
from tests.spec_files import tree, write_bench

pytestmark = pytest.mark.skipif(
    not Path("/proc/self/environ").exists(), reason="processes are found in /proc"
)

ROOT = Path(__file__).resolve().parents[1]
STUDY = ROOT / "datasets/finite_element/convergence.toml"
COMMANDS = {
    "fit": ("fit", "{out}/fitting/small.toml", "-o", "{out}/fit.json"),
    "optimizers": ("optimizers", "{out}/fitting/small.toml", "-o", "{out}/optimizers.csv"),
    "sweep": ("sweep", "datasets/slider_crank.toml", "-o", "{out}/sweep.csv"),
    "report": ("report", "-o", "{out}/figures"),
    "finite-element": ("finite-element", STUDY, "-o", "{out}/embedded.csv"),
    "calculix": ("finite-element", STUDY, "--engine", "calculix", "-o", "{out}/calculix.csv"),
}
LONG = {"genetic.runs": 50, "genetic.generations": 3000, "genetic.populations": [16]}
CCX = "#!/bin/sh\ncase $1 in -v) echo This is Version 9.9 ;; *) exec sleep 600 ;; esac\n"
ENDS = ("SIGKILL", "SIGINT", "SIGTERM", "closed terminal")
# Seconds after the first worker process is there; the first one is from the very start.
MOMENTS = {"early": None, "first worker": 0.0, "workers start": 0.4, "under way": 2.0}


class Family:
    """A command and all processes that descend from it.

    They are known by a variable of the environment, which is inherited whatever becomes of
    parents, process groups and sessions, or by having been seen as a child of one of them.
    """

    def __init__(self, command, said, terminal=False, **environment):
        name, value = "CYLCONTACT_TEST_FAMILY", str(uuid.uuid4())
        self._mark = f"{name}={value}"
        self._seen = set()
        command, self._terminals = [*map(str, command)], ()
        if terminal:
            # As the leader of a session, the shell makes the terminal its own by opening it.
            self._terminals = os.openpty()
            shell = 'exec <"$0" >"$0" 2>&1; "$@"; exit $?'
            command = ["sh", "-c", shell, os.ttyname(self._terminals[1]), *command]
        with said.open("w") as errors:
            self.process = subprocess.Popen(
                tethered(command),
                cwd=ROOT,
                env={**os.environ, **environment, name: value},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=errors,
                start_new_session=True,
            )

    def members(self):
        """The command lines of those that are alive, by number."""
        alive = processes()
        found = {who for who, (_, _, own) in alive.items() if self._mark in own}
        found |= self._seen & alive.keys()
        more = found
        while more:  # Chromium writes its title over the environment; its parent is marked
            numbers = {number for number, _ in more}
            more = {who for who, (parent, _, _) in alive.items() if parent in numbers} - found
            found |= more
        self._seen |= found
        return {number: alive[number, begun][1] for number, begun in found}

    def has_workers(self):
        assert self.process.poll() is None, "the command has ended by itself"
        return any("popen_loky" in line for line in self.members().values())

    def end(self, how):
        """End the command as a user would, or the system."""
        if how == "closed terminal":
            self.close_terminal()
        elif how == "SIGINT":  # a terminal sends it to all
            os.killpg(self.process.pid, signal.SIGINT)
        else:
            self.process.send_signal(getattr(signal, how))

    def close_terminal(self):
        for end in self._terminals:
            os.close(end)
        self._terminals = ()

    def wait_until_gone(self):
        """Wait until nobody is left, and return how many seconds that took."""
        begun = time.monotonic()
        self.process.wait(60)
        wait_until(lambda: not self.members(), self.members)
        return time.monotonic() - begun


def processes():
    """All processes: number and start → number of the parent, command line, environment."""
    found = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it has just ended
            state, parent, *others = (folder / "stat").read_text().rpartition(")")[2].split()
            line, own = ((folder / name).read_bytes() for name in ("cmdline", "environ"))
            if state not in "ZX":
                texts = (text.decode(errors="replace") for text in (line, own))
                found[int(folder.name), others[17]] = (int(parent), *texts)
    return found


@contextmanager
def family(command, said, **options):
    """Start a command; whatever it leaves is killed in the end."""
    started = Family(command, said, **options)
    try:
        yield started
    finally:
        started.close_terminal()
        for number in started.members():
            with suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
        started.process.wait()


def wait_until(holds, why=lambda: ""):
    end = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < end, why()
        time.sleep(0.02)


# --- the commands -----------------------------------------------------------------------------


def end_one(folder, name, how, moment):
    """Start a command, end it at a moment, and return the seconds until nobody was left."""
    out, scratch, said = folder / "out", folder / "scratch", folder / "stderr"
    write_bench(out, LONG)
    before = set(tree(out))
    scratch.mkdir()
    fake_ccx(folder / "bin")
    arguments = [str(part).format(out=out) for part in COMMANDS[name]]
    command = [sys.executable, "-m", "cylcontact.cli", *arguments, "--jobs", "2"]
    environment = {"PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "TMPDIR": str(scratch)}
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
        code = started.process.returncode
    assert shared_memory(numbers) == []
    if how != "SIGKILL":
        assert [path for path in set(tree(out)) - before if is_half_written(path)] == []
        assert tree(scratch) == {}
    if how in ("SIGINT", "SIGTERM") and moment != "early":
        assert code == 130, said.read_text()
        # Rarely, joblib's tracker of resources warns of one that has just been removed.
        lines = re.sub(r".*resource_tracker.*\n( .*\n)?", "", said.read_text())
        assert re.fullmatch(r"cylcontact: interrupted.*\n", lines)
    return seconds


def fake_ccx(folder):
    """Make a program that stands for CalculiX and does not end."""
    folder.mkdir()
    (folder / "ccx").write_text(CCX)
    (folder / "ccx").chmod(0o755)


def is_half_written(path):
    """Whether a file is none that a command completes, nor one that it keeps to resume from."""
    return Path(path).name.startswith(".") or Path(path).suffix == ".lock"


def shared_memory(numbers):
    """What processes have left in shared memory: semaphores of loky's, arrays of joblib's."""
    left = [path.name for path in Path("/dev/shm").iterdir()]
    return [
        name
        for name in left
        if any(mark in name for n in numbers for mark in (f"loky-{n}-", f"_folder_{n}_"))
    ]


@pytest.mark.parametrize(
    ("name", "how", "moment"),
    [
        ("fit", "SIGKILL", "first worker"),
        ("sweep", "SIGKILL", "early"),
        ("report", "SIGTERM", "workers start"),
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


@pytest.mark.slow
@pytest.mark.parametrize("how", ENDS)
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


@pytest.mark.parametrize("helper", HELPERS)
def test_killed_tests_leave_no_process(tmp_path, helper, pytestconfig):
    if helper == "browser":
        require_program("chromium")
    code = (
        "import sys, time; from pathlib import Path; folder = Path(sys.argv[1]);"
        "from tests.test_orphans import wait_until;"
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
