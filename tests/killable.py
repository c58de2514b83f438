"""The command line in processes that can be killed at any moment, quick to start."""

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
import time

AUDITED = {"os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.truncate", "os.chmod"}
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_APPEND


def context():
    """Processes forked from one that has imported everything already."""
    found = multiprocessing.get_context("forkserver")
    found.set_forkserver_preload(["tests.preloaded"])
    return found


def start(folder, *arguments, kill_at=None, file_size=None):
    """Start a command in a folder; its errors go to a file there that `said` reads.

    `kill_at` is the number of the operation on a file before which it kills itself, and
    `file_size` the largest file that it may write, in bytes.
    """
    process = context().Process(target=_run, args=(folder, arguments, kill_at, file_size))
    process.start()
    return process


def run(folder, *arguments, **limits):
    """Run a command to its end and return its exit code, -9 where it was killed."""
    process = start(folder, *arguments, **limits)
    process.join()
    return process.exitcode


def run_and_kill(folder, *arguments, seconds):
    """Run a command, kill -9 it after some seconds, and tell whether that was before its end."""
    process = start(folder, *arguments)
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline and process.is_alive():
        time.sleep(0.001)
    process.kill()
    process.join()
    return process.exitcode == -signal.SIGKILL


def said(folder):
    """What the last command in a folder said on standard error."""
    return (folder.parent / f"{folder.name}.stderr").read_text()


def _run(folder, arguments, kill_at, file_size):
    from cylcontact import cli

    threading.Thread(target=_end_with_the_tests, daemon=True).start()
    os.chdir(folder)
    sys.argv = ["cylcontact", *map(str, arguments)]
    with (
        (folder.parent / f"{folder.name}.stderr").open("w") as errors,
        contextlib.redirect_stderr(errors),
        contextlib.redirect_stdout(None),
    ):
        if kill_at is not None:
            _kill_at(folder, kill_at)
        if file_size is not None:
            import resource

            resource.setrlimit(resource.RLIMIT_FSIZE, (file_size, file_size))
        cli.main()


def _end_with_the_tests():
    """End this process when the one that asked for it is killed; its parent only forked it."""
    multiprocessing.parent_process().join()
    os._exit(1)


def _kill_at(folder, number):
    """Kill this process before its operation of this number on a file in the folder."""
    waiting = number

    def count():
        nonlocal waiting
        if waiting == 0:
            os.kill(os.getpid(), signal.SIGKILL)
        waiting -= 1

    def hook(event, arguments):
        path = arguments[0] if arguments else ""
        inside = str(path).startswith((str(folder), "fitting")) or isinstance(path, int)
        if (event in AUDITED and inside) or (event == "open" and inside and arguments[2] & WRITING):
            count()

    to_disk = os.fsync

    def fsync(handle):
        count()  # written, and not yet on the disk
        to_disk(handle)

    os.fsync = fsync
    sys.addaudithook(hook)
