"""Calls of a user's function, in a process of its own.

Whatever the function does then, this process goes on and can tell: it may print, leave by sys.exit
or os._exit, crash, or never return.
"""

from __future__ import annotations

import atexit
import os
import pickle
import queue
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

from cylcontact.errors import InputError
from cylcontact.tether import tethered

__all__ = ["LAW_TIMEOUT", "UserProcess", "process_of"]

# Seconds that a function of the user may take for one call, or its module to be imported.
LAW_TIMEOUT = 60.0
_PROGRAM = Path(__file__).with_name("user_code.py")


class UserProcess:
    """A process that has imported a function of the user.

    Parameters
    ----------
    spec : str
        "module:function".
    folder : str
        Where the module is searched for first.

    Attributes
    ----------
    parameters : dict
        The names of the function's parameters, with their defaults or None.
    """

    def __init__(self, spec: str, folder: str, seconds: float) -> None:
        self._spec = spec
        self._lock = threading.Lock()
        self._replies: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        path = os.pathsep.join(entry or str(Path.cwd()) for entry in sys.path)
        self._process = subprocess.Popen(
            tethered([sys.executable, "-PB", str(_PROGRAM), folder, spec]),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": path},
        )
        threading.Thread(target=self._receive, daemon=True).start()
        try:
            reply = self._reply(seconds, "its import")
        except InputError:
            self.end()
            raise
        self.parameters: dict[str, float | None] = reply["parameters"]

    @property
    def is_alive(self) -> bool:
        """Whether it can be called."""
        return self._process.poll() is None

    def call(self, request: tuple[Any, ...], seconds: float) -> Any:
        """Return the loads for a penetration, a pair and parameters.

        Raises
        ------
        InputError
            If the function fails, returns no loads, ends the process, or takes longer than this.
        """
        with self._lock:
            with suppress(OSError):  # it has ended, which the reply tells
                pickle.dump(request, self._process.stdin)  # type: ignore[arg-type]
                self._process.stdin.flush()  # type: ignore[union-attr]
            return self._reply(seconds, "a call", request[2])["load"]

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
        with suppress(OSError):  # what it has not read
            self._process.stdin.close()  # type: ignore[union-attr]

    def _receive(self) -> None:
        """Hand on replies until there are no more."""
        with suppress(EOFError, OSError, pickle.UnpicklingError), self._process.stdout as replies:  # type: ignore[union-attr]
            while True:
                self._replies.put(pickle.load(replies))
        self._replies.put({})

    def _reply(self, seconds: float, what: str, parameters: Any = None) -> dict[str, Any]:
        """Return the next reply; raise `InputError` for one that tells what is wrong, or none."""
        key = "load" if parameters is not None else "law"
        at = "".join(f", {name} = {value:.6g}" for name, value in (parameters or {}).items())
        try:
            reply = self._replies.get(timeout=seconds)
        except queue.Empty:
            self.end()
            rule = f"did not return: {what}{at} took longer than {seconds:g} s"
            remedy = "correct the function, or allow it more time: --law-timeout SECONDS"
            raise InputError(self._spec, key, None, rule, remedy) from None
        except BaseException:  # an interruption; the reply would be taken for that of a later call
            self.end()
            raise
        if not reply:
            status = self._process.wait()
            how = f"exit code {status}" if status >= 0 else f"signal {-status}"
            rule = f"ended the process that it runs in ({how}) in {what}{at}"
            raise InputError(self._spec, key, None, rule, "correct the function")
        if "wrong" in reply:
            raise InputError(self._spec, key, None, reply["wrong"], reply["remedy"])
        return reply


# By the id of the parent: after a fork the processes belong to the former one.
_RUNNING: dict[tuple[int, str, str, str], UserProcess] = {}
_STARTING = threading.Lock()


def process_of(
    spec: str, folder: str, digest: str, seconds: float, anew: bool = False
) -> UserProcess:
    """Return the process of a function; a new one if there is none, or `anew` is true.

    The digest tells the versions of the module's file apart.
    """
    key = os.getpid(), spec, folder, digest
    with _STARTING:
        running = _RUNNING.get(key)
        if running is not None and running.is_alive and not anew:
            return running
        if running is not None:
            running.end()
        _RUNNING[key] = UserProcess(spec, folder, seconds)
        return _RUNNING[key]


@atexit.register
def _end_all() -> None:
    for (parent, *_), process in _RUNNING.items():
        if parent == os.getpid():
            process.end()
