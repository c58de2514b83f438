"""Turn Ctrl-C, SIGTERM and SIGHUP (a closed terminal) into one interruption of a command."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

# Seconds after which a lost interruption is raised again.
_REPEAT_AFTER = 1.0


@contextmanager
def stopped_by_signals() -> Iterator[None]:
    """Raise KeyboardInterrupt in the block at each of the signals that nohup does not ignore.

    Some compiled libraries lose it, so it is raised again; some turn it into another exception.
    """
    if sys.platform == "win32":
        yield
        return
    received: list[int] = []

    def stop(number: int, _frame: FrameType | None) -> None:
        received.append(number)
        if number != signal.SIGINT:  # a terminal that closes may send its signal twice
            signal.signal(number, signal.SIG_IGN)
        _leave_lost_terminal()
        signal.setitimer(signal.ITIMER_REAL, _REPEAT_AFTER, _REPEAT_AFTER)
        raise KeyboardInterrupt

    ending = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    handled = [number for number in ending if signal.getsignal(number) is not signal.SIG_IGN]
    handlers = {number: signal.signal(number, stop) for number in handled}
    handlers[signal.SIGALRM] = signal.signal(signal.SIGALRM, _insist)
    try:
        yield
    except Exception as error:
        if received:
            raise KeyboardInterrupt from error
        raise
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in handlers.items():
            signal.signal(number, handler)


def _insist(_number: int, _frame: FrameType | None) -> None:
    """Interrupt again, unless an exception is being handled, most likely the interruption."""
    if sys.exc_info()[0] is None:
        raise KeyboardInterrupt


def _leave_lost_terminal() -> None:
    """Write to nowhere if the terminal has closed, or an error would replace the interruption."""
    for stream in (1, 2):
        try:
            os.write(stream, b"")
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
