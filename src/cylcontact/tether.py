"""Child programs that end with their parent process, however the parent ends.

On Linux a process can ask for a signal when the thread that started it ends. This file, run as a
script, asks for SIGKILL and then becomes the program.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence

__all__ = ["tethered"]

_PR_SET_PDEATHSIG = 1  # <linux/prctl.h>


def tethered(command: Sequence[str]) -> list[str]:
    """Return a command whose process ends with this one; outside Linux, the command unchanged.

    The thread that starts it must outlive it.

    Parameters
    ----------
    command : sequence of str
        A program and its arguments.

    Examples
    --------
    >>> import subprocess
    >>> subprocess.run(tethered(["true"])).returncode
    0
    """
    if sys.platform != "linux":
        return list(command)
    # Isolated and without site-packages, Python starts in some hundredths of a second. A
    # `preexec_fn` would be faster but is unsafe in a process with threads.
    return [sys.executable, "-I", "-S", __file__, str(os.getpid()), *command]


def _become(parent: int, command: list[str]) -> None:
    """Replace this process by a program that ends with its parent; return if that has ended."""
    import ctypes

    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() == parent:
        os.execvp(command[0], command)


if __name__ == "__main__":
    _become(int(sys.argv[1]), sys.argv[2:])
