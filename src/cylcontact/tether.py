"""Programs that end with the process that starts them, however that one ends.

Linux sends a process a signal when the thread that started it ends, if the process has asked for
it. So this file, run as a script, asks for SIGKILL and then becomes the program.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence

__all__ = ["tethered"]

_PR_SET_PDEATHSIG = 1  # <linux/prctl.h>


def tethered(command: Sequence[str]) -> list[str]:
    """Return a command whose process ends with this one; on systems other than Linux, the same.

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
    # Isolated and without site-packages, Python starts in some hundredths of a second. A function
    # that subprocess calls between fork and exec would be faster, and is unsafe beside threads.
    return [sys.executable, "-I", "-S", __file__, str(os.getpid()), *command]


def _become(parent: int, command: list[str]) -> None:
    """Become a program that ends with its parent, unless the parent has ended already."""
    import ctypes

    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() == parent:
        os.execvp(command[0], command)


if __name__ == "__main__":
    _become(int(sys.argv[1]), sys.argv[2:])
