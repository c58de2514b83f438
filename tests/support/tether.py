"""Child programs that end with their parent process, however the parent ends.

On Linux a process can ask for a signal when the thread that started it ends. This file, run as a
script, asks for SIGKILL and then becomes the program.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
from collections.abc import Sequence

_PR_SET_PDEATHSIG = 1  # <linux/prctl.h>


def tethered(command: Sequence[str]) -> list[str]:
    """Return a command whose process ends with this one; outside Linux, the command unchanged.

    The thread that starts it must outlive it. A `preexec_fn` would be unsafe in a process with
    threads.
    """
    if sys.platform != "linux":
        return list(command)
    return [sys.executable, "-I", "-S", __file__, str(os.getpid()), *command]


if __name__ == "__main__":
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() == int(sys.argv[1]):  # else the parent has ended before
        os.execvp(sys.argv[2], sys.argv[2:])
