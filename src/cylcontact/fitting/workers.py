"""Spread work over processes that leave Ctrl-C to the one that started them."""

from __future__ import annotations

import signal
import threading
import time
import warnings
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, nullcontext
from multiprocessing import resource_tracker
from typing import Any

import joblib
from joblib.externals.loky.backend import resource_tracker as loky_resource_tracker

from cylcontact.errors import InputError

# Seconds after which the thread that feeds new workers has done so; it breaks if stopped before.
SETTLING = 0.2


def in_processes(calls: Sequence[Any], jobs: int, ordered: bool = True) -> Generator[Any]:
    """Run calls in worker processes and yield what they return.

    Parameters
    ----------
    calls : sequence
        Made with `joblib.delayed`.
    jobs : int
        Processes; no more are started than there are calls.
    ordered : bool
        Whether to yield in the order of the calls, or each as it ends.

    Yields
    ------
    object

    Raises
    ------
    InputError
        If the system ended a worker, which it does where memory is short.
    """
    workers = max(1, min(jobs, len(calls)))
    return_as = "generator" if ordered else "generator_unordered"
    parallel = joblib.Parallel(n_jobs=workers, return_as=return_as)
    results = None
    try:
        with _interrupts_held() if workers > 1 else nullcontext():
            results = parallel(calls)
        for result in results:  # noqa: UP028 - `yield from` would close it before `finally` does
            yield result
    except BrokenProcessPool as error:
        raise InputError(
            "workers",
            "jobs",
            jobs,
            "the system ended a worker process, probably for want of memory",
            "use fewer, or a smaller grid; fit --resume goes on from the runs that are kept",
        ) from error
    finally:
        if results is not None:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # calls cut short are told of as a mistake
                results.close()


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Hold Ctrl-C back until the end; processes started meanwhile never see it.

    A terminal sends it to all processes at once, and a worker that is still importing would
    print its traceback. A blocked signal stays blocked in new processes; here, where other
    threads may still receive it, it is noted and raised again.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    for tracker in (resource_tracker, loky_resource_tracker):
        tracker.ensure_running()  # needed by the workers; it lifts the mask as it starts
    noted = []
    in_main = threading.current_thread() is threading.main_thread()
    handler = signal.signal(signal.SIGINT, lambda number, _: noted.append(number)) if in_main else 0
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        if in_main:
            signal.signal(signal.SIGINT, handler)
        if noted:
            time.sleep(SETTLING)
            signal.raise_signal(signal.SIGINT)
