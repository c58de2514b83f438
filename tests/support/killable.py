"""The command line in processes that can be killed at any moment.

`start` forks a command from a process that has imported everything, which is quick; `family` starts
it as a user does, with everything that descends from it.
"""

import contextlib
import multiprocessing
import multiprocessing.util
import os
import signal
import subprocess
import sys
import threading
import time
import uuid
from pathlib import Path

from benchmarks.tether import tethered

ROOT = Path(__file__).resolve().parents[2]


def context():
    """Processes forked from one that has imported everything already."""
    forkserver = multiprocessing.get_context("forkserver")
    forkserver.set_forkserver_preload(["tests.support.preloaded"])
    return forkserver


def start(folder, *arguments):
    """Start a command in a folder; its errors go to a file there that `said` reads."""
    process = context().Process(target=_run, args=(folder, arguments))
    process.start()
    return process


def run(folder, *arguments):
    """Run a command to its end and return its exit code."""
    process = start(folder, *arguments)
    process.join()
    return process.exitcode


def said(folder):
    """What the last command in a folder said on standard error."""
    return (folder.parent / f"{folder.name}.stderr").read_text()


def wait_until(holds, why=lambda: ""):
    """Wait until a condition holds, for a minute at most."""
    end = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < end, why()
        time.sleep(0.02)


def _run(folder, arguments):
    from joblib.externals.loky import process_executor

    from cylcontact import cli

    # Otherwise multiprocessing waits for joblib's workers, which nobody tells to end before that.
    multiprocessing.util.Finalize(None, process_executor._python_exit, exitpriority=20)
    threading.Thread(target=_end_with_the_tests, daemon=True).start()
    os.chdir(folder)
    sys.argv = ["cylcontact", *map(str, arguments)]
    with (
        (folder.parent / f"{folder.name}.stderr").open("w") as errors,
        contextlib.redirect_stderr(errors),
        contextlib.redirect_stdout(None),
    ):
        cli.main()


def _end_with_the_tests():
    """End this process when the one that asked for it is killed; its parent only forked it."""
    multiprocessing.parent_process().join()
    os._exit(1)


# --- with everything that descends from it ------------------------------------------------------


class Family:
    """A command and all processes that descend from it.

    They are known by a variable of the environment, which is inherited whatever becomes of
    parents, process groups and sessions, or by having been seen as a child of one of them.
    """

    def __init__(self, command, said, terminal=False, **environment):
        name, value = "CYLCONTACT_TEST_FAMILY", str(uuid.uuid4())
        self._mark = f"{name}={value}"
        self._seen, self.said = set(), said
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
        members = {who for who, (_, _, own) in alive.items() if self._mark in own}
        members |= self._seen & alive.keys()
        more = members
        while more:  # Chromium writes its title over the environment; its parent is marked
            numbers = {number for number, _ in more}
            more = {who for who, (parent, _, _) in alive.items() if parent in numbers} - members
            members |= more
        self._seen |= members
        return {number: alive[number, begun][1] for number, begun in members}

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
        """Wait until nobody is left."""
        self.process.wait(60)
        wait_until(lambda: not self.members(), self.members)


def processes():
    """All processes: number and start → number of the parent, command line, environment."""
    alive = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):  # it has just ended
            state, parent, *others = (folder / "stat").read_text().rpartition(")")[2].split()
            line, own = ((folder / name).read_bytes() for name in ("cmdline", "environ"))
            if state not in "ZX":
                texts = (text.decode(errors="replace") for text in (line, own))
                alive[int(folder.name), others[17]] = (int(parent), *texts)
    return alive


@contextlib.contextmanager
def family(command, said, **options):
    """Start a command; whatever it leaves is killed in the end."""
    started = Family(command, said, **options)
    try:
        yield started
    finally:
        started.close_terminal()
        for number in started.members():
            with contextlib.suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
        started.process.wait()
