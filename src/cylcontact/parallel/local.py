"""Calls on this machine, in threads or processes; only this process handles signals."""

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
from cylcontact.memory import require_memory
from cylcontact.parallel.calls import RESUME, Call, call

__all__ = ["SETTLING", "as_generator", "give_up", "in_processes", "in_threads"]

# Seconds that the thread which feeds new workers needs; it fails if stopped earlier.
SETTLING = 0.2
# Seconds between two checks by a worker that its parent is alive.
_POLLING = 0.2
# Of a worker process that has imported the package and not worked yet.
_WORKER_BYTES = 100e6


def in_processes(calls: Sequence[Call], jobs: int, ordered: bool = True) -> Generator[Any]:
    """Run calls in at most `jobs` worker processes; see `run_calls`."""
    import joblib

    _expect_new_workers()
    workers = max(1, min(jobs, len(calls)))
    if workers > 1:
        require_memory("workers", "jobs", jobs, _WORKER_BYTES * workers, "use fewer: --jobs")
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
            "the system ended a worker process, probably because memory ran out",
            f"use fewer, or a smaller grid; {RESUME}",
        ) from error
    finally:
        give_up(results)


def in_threads(calls: Sequence[Call], jobs: int, ordered: bool = True) -> Generator[Any]:
    """Run calls in at most `jobs` threads of this process, one for each core; see `run_calls`."""
    # More would not be faster, and the system has no room for 100,000.
    workers = max(1, min(jobs, len(calls), os.cpu_count() or 1))
    if workers == 1:
        for function, arguments, named in calls:
            yield function(*arguments, **named)
        return
    import joblib

    results = joblib.Parallel(workers, prefer="threads", return_as=as_generator(ordered))(calls)
    try:
        for result in results:  # noqa: UP028 - as above
            yield result
    finally:
        give_up(results)


def _expect_new_workers() -> None:
    """Ignore loky's warning that a worker stopped while there was work.

    loky replaces a worker whose memory has grown by 300 MB, which the caches of matplotlib and
    pandas do over many figures, and warns of a short timeout or a leak. No call is lost. The
    warning comes from a thread of loky at any time, so it cannot be caught around a call. A worker
    that was killed by the system raises an error instead.
    """
    warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)


def _in_this_folder(calls: Sequence[Call]) -> list[Call]:
    """Return the same calls, made in the working directory of this process.

    A worker may be left from an earlier call, when its parent had another working directory.
    """
    folder = str(Path.cwd())
    return [call(_in_folder, folder, *deferred) for deferred in calls]


def _in_folder(folder: str, function: Callable[..., Any], arguments: Any, named: Any) -> Any:
    """Make a call with a folder as the working directory."""
    os.chdir(folder)
    return function(*arguments, **named)


def _end_with(parent: int) -> None:
    """Make this worker process end with its parent, even before its first call.

    Otherwise it would wait for calls: the workers hold each other's queues open, so none of them
    reads an end of file. Linux could send a signal, but it does so when the thread that started
    the worker ends, and workers outlive that thread. On Windows the parent's id never changes,
    and joblib ends a worker that has been idle for five minutes.
    """
    threading.Thread(target=_watch, args=(parent,), daemon=True).start()


def _watch(parent: int) -> None:
    """End this process once its parent has ended.

    A call that holds the interpreter's lock, as some compiled code does, delays the check.
    """
    while os.getppid() == parent:
        time.sleep(_POLLING)
    os._exit(1)


def as_generator(ordered: bool) -> str:
    """Return joblib's name for results in the order of the calls, or as they are completed."""
    return "generator" if ordered else "generator_unordered"


def give_up(results: Generator[Any] | None) -> None:
    """Cancel the pending calls, without joblib's warnings about them."""
    if results is not None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            results.close()


@contextmanager
def _signals_held() -> Iterator[None]:
    """Defer Ctrl-C, SIGTERM and SIGHUP to the end of the block; new processes ignore them.

    A terminal sends its signals to all processes at once. A worker that is still importing would
    print a traceback, and a worker that ends first would look like one killed by the system. A
    blocked signal stays blocked in new processes. In this process other threads may still
    receive it, so it is noted and raised again.
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
