"""Calls on this machine: in threads, or in processes that leave signals to this one."""

from __future__ import annotations

import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, nullcontext
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any

from cylcontact.errors import InputError
from cylcontact.parallel.calls import Call, call

__all__ = ["SETTLING", "as_generator", "give_up", "in_processes", "in_threads"]

# Seconds after which the thread that feeds new workers has done so; it breaks if stopped before.
SETTLING = 0.2
# Seconds between two checks of a worker that its parent is alive.
_POLLING = 0.2


def in_processes(calls: Sequence[Call], jobs: int, ordered: bool = True) -> Generator[Any]:
    """Run calls in at most `jobs` worker processes; see `run_calls`."""
    import joblib

    _expect_new_workers()
    workers = max(1, min(jobs, len(calls)))
    parallel = joblib.Parallel(
        n_jobs=workers,
        return_as=as_generator(ordered),
        initializer=_end_with,
        initargs=(os.getpid(),),
    )
    results = None
    try:
        with _signals_held() if workers > 1 else nullcontext():
            results = parallel(_in_this_folder(calls) if workers > 1 else calls)
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
        give_up(results)


def in_threads(calls: Sequence[Call], jobs: int, ordered: bool = True) -> Generator[Any]:
    """Run calls in at most `jobs` threads of this process; see `run_calls`."""
    import joblib

    workers = max(1, min(jobs, len(calls)))
    results = joblib.Parallel(workers, prefer="threads", return_as=as_generator(ordered))(calls)
    try:
        for result in results:  # noqa: UP028 - as above
            yield result
    finally:
        give_up(results)


def _expect_new_workers() -> None:
    """Leave out loky's warning that a worker stopped while there was work.

    It replaces a worker whose memory has grown by 300 MB, as matplotlib's and pandas' caches do
    over many figures, and warns of a short timeout or a leak; no call is lost, and the reader can
    do nothing about it. The warning comes from a thread of loky's, at any time, so that it cannot
    be caught around a call. A worker that the system ended is another case, and an error.
    """
    warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)


def _in_this_folder(calls: Sequence[Call]) -> list[Call]:
    """Return the same calls for workers that stand in the folder of this process.

    A worker may be left from an earlier call, made when its parent stood in another folder.
    """
    folder = str(Path.cwd())
    return [call(_in_folder, folder, *one) for one in calls]


def _in_folder(folder: str, function: Callable[..., Any], arguments: Any, named: Any) -> Any:
    """Make a call in a folder."""
    os.chdir(folder)
    return function(*arguments, **named)


def _end_with(parent: int) -> None:
    """Let this worker process end with its parent, even before its first call.

    Otherwise it would wait for calls: the workers hold each other's queues open, so that none of
    them reads an end of file. Linux could send a signal, but does so when the thread that started
    the worker ends, and workers serve later threads as well. On Windows the number of the parent
    never changes, and joblib ends a worker that has been idle for five minutes.
    """
    threading.Thread(target=_watch, args=(parent,), daemon=True).start()


def _watch(parent: int) -> None:
    """End this process once its parent has ended, be it before this process was ready.

    A call that holds the interpreter's lock, as some compiled code does, delays it.
    """
    while os.getppid() == parent:
        time.sleep(_POLLING)
    os._exit(1)


def as_generator(ordered: bool) -> str:
    """Return joblib's name for results in the order of the calls, or as they come."""
    return "generator" if ordered else "generator_unordered"


def give_up(results: Generator[Any] | None) -> None:
    """End what still runs; calls cut short are none of the user's mistakes."""
    if results is not None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            results.close()


@contextmanager
def _signals_held() -> Iterator[None]:
    """Hold Ctrl-C, SIGTERM and SIGHUP back until the end; processes started meanwhile ignore them.

    A terminal sends its signals to all processes at once. A worker that is still importing would
    print a traceback, and one that ends first would pass for one that the system has ended. A
    blocked signal stays blocked in new processes; here, where other threads may still receive
    it, it is noted and raised again.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    from joblib.externals.loky.backend import resource_tracker as loky_resource_tracker

    ending = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    noted: list[int] = []
    in_main = threading.current_thread() is threading.main_thread()
    handlers = (
        [signal.signal(number, lambda number, _: noted.append(number)) for number in ending]
        if in_main
        else []
    )
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, ending)
    try:
        for tracker in (resource_tracker, loky_resource_tracker):
            tracker.ensure_running()  # needed by the workers; it lifts the mask as it starts
        signal.pthread_sigmask(signal.SIG_BLOCK, ending)
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number, handler in zip(ending, handlers, strict=False):
            signal.signal(number, handler)
        if noted:
            time.sleep(SETTLING)
            signal.raise_signal(noted[0])
