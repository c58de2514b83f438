"""Calls in processes or threads by joblib, or on a Dask cluster, with the same results.

The result of a call must not depend on where it runs: its random numbers come from a seed among
its arguments, and its sums have a fixed order. Then one process, many processes and a cluster of
like processors agree to the bit.
"""

from __future__ import annotations

import asyncio
import logging
import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Generator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cylcontact.support.errors import InputError
from cylcontact.support.progress import Progress, silent

# A function with its arguments, as joblib takes it.
Call = tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]

_RESUME = "a command with --resume continues from what is complete"
# Seconds between two looks of a worker whether its parent is alive.
_POLLING = 0.2
# Seconds to find the scheduler and a first worker.
_CONNECTING = 10
# Results are the same only if these versions agree.
_SAME_VERSIONS = ("cylcontact", "numpy", "scipy", "numba", "pygad")


@dataclass(frozen=True)
class Cluster:
    """A running Dask cluster, by the address of its scheduler, e.g. tcp://192.168.1.5:8786."""

    address: str

    def __post_init__(self) -> None:
        try:
            import distributed  # noqa: F401
        except ImportError:
            remedy = "make extras, or pip install 'cylcontact[distributed]'"
            raise self.error("needs the extra 'distributed'", remedy) from None

    def error(self, rule: str, remedy: str) -> InputError:
        """Return the error for what is wrong with the cluster."""
        return InputError("--scheduler", "", self.address, rule, remedy)


# A number of workers on this machine, or a cluster.
Workers = int | Cluster


def call(function: Callable[..., Any], *arguments: Any, **named: Any) -> Call:
    """Return a deferred call of a module-level function, as `joblib.delayed`, with types."""
    return function, arguments, named


def run_calls(
    calls: Sequence[Call], workers: Workers = 1, *, ordered: bool = True, threads: bool = False
) -> Generator[Any]:
    """Run calls and yield their results, in the order of the calls or as they are completed.

    `threads` is for calls that spend their time in numpy or numba. Close the generator where the
    loop may be left early (`contextlib.closing`), which cancels pending calls.
    """
    if isinstance(workers, Cluster):
        return _on_cluster(calls, workers, ordered)
    workers = max(1, min(workers, len(calls)))
    if workers == 1:  # joblib takes long to import
        return (function(*arguments, **named) for function, arguments, named in calls)
    return _on_this_machine(calls, workers, ordered, threads)


def collect(
    calls: Sequence[Call], workers: Workers = 1, progress: Progress = silent, stage: str = ""
) -> list[Any]:
    """Run calls in processes and return their results in order."""
    collected = []
    with closing(run_calls(calls, workers)) as results:
        for result in results:
            collected.append(result)
            progress(stage, len(collected), len(calls))
    return collected


def _on_this_machine(
    calls: Sequence[Call], workers: int, ordered: bool, threads: bool
) -> Generator[Any]:
    """Run calls in processes or threads of this machine."""
    import joblib

    # loky replaces a worker whose memory has grown, and warns of it; no call is lost.
    warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)
    where: dict[str, Any] = {"backend": "threading"}
    if not threads:
        where = {"backend": "loky", "initializer": _end_with, "initargs": (os.getpid(),)}
        if workers > 1:  # left from an earlier call, they may be in another folder
            calls = [call(_in_folder, Path.cwd(), *deferred) for deferred in calls]
    in_order = "generator" if ordered else "generator_unordered"
    waits = _interruption_waits() if workers > 1 and not threads else nullcontext()
    with joblib.parallel_config(**where), waits:
        results = joblib.Parallel(workers, return_as=in_order)(calls)
    try:
        for result in results:  # noqa: UP028 - `yield from` would close it before `finally` does
            yield result
    except BrokenProcessPool as error:
        rule = "the system ended a worker process, probably because memory ran out"
        remedy = f"use fewer --jobs, or a smaller grid; {_RESUME}"
        raise InputError("workers", "jobs", workers, rule, remedy) from error
    finally:
        with warnings.catch_warnings(action="ignore"):  # of pending calls
            results.close()


@contextmanager
def _interruption_waits() -> Generator[None]:
    """Keep Ctrl-C until the workers have started, which never get it: they inherit this mask."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    from joblib.externals.loky.backend import resource_tracker as of_loky

    for tracker in (resource_tracker, of_loky):  # now, as their start lets Ctrl-C through
        tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _in_folder(folder: Path, function: Callable[..., Any], arguments: Any, named: Any) -> Any:
    os.chdir(folder)
    return function(*arguments, **named)


def _end_with(parent: int) -> None:
    """Let this worker process end with its parent, and leave Ctrl-C to it.

    Otherwise it would wait for calls: the workers hold each other's queues open. A signal of Linux
    would come when the thread that started the worker ends, and workers outlive that thread.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_POLLING)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _on_cluster(calls: Sequence[Call], cluster: Cluster, ordered: bool) -> Generator[Any]:
    """Run calls on a cluster, which gives those of a lost worker to another one.

    joblib's backend for Dask waits for ever once the scheduler is lost, so this submits them.
    """
    import distributed

    dask: Any = distributed  # declares few types
    logging.getLogger("distributed").setLevel(logging.CRITICAL + 1)  # its errors are raised
    try:
        client = dask.Client(cluster.address, timeout=_CONNECTING, set_as_default=False)
    except Exception as error:  # whatever speaks another protocol may cause any
        rule = f"cannot be reached ({_first_line(error)})"
        raise cluster.error(rule, "give the address that dask scheduler prints") from error
    with client:
        _require_workers(client, cluster)
        futures = [client.submit(_answer, *deferred, pure=False) for deferred in calls]
        for future in futures if ordered else dask.as_completed(futures, loop=client.loop):
            try:
                result, failure = future.result()
            except (Exception, asyncio.CancelledError) as error:
                rule = f"lost a call ({_first_line(error)})"
                remedy = f"start it again, with more memory if that ran out; {_RESUME}"
                raise cluster.error(rule, remedy) from error
            if failure is not None:
                raise failure
            yield result


def _require_workers(client: Any, cluster: Cluster) -> None:
    """Raise `InputError` without workers, or if one has other versions than this process."""
    try:
        client.wait_for_workers(1, timeout=_CONNECTING)
    except TimeoutError as error:
        rule = f"has no workers after {_CONNECTING} s"
        remedy = f"start some, each with: dask worker {cluster.address}"
        raise cluster.error(rule, remedy) from error
    versions = client.get_versions(packages=list(_SAME_VERSIONS))
    for theirs in versions["workers"].values():
        for name, own in versions["client"]["packages"].items():
            if name in ("python", *_SAME_VERSIONS) and theirs["packages"].get(name) != own:
                rule = f"a worker has {name} {theirs['packages'].get(name)}, here it is {own}"
                remedy = "install the same on all machines, e.g. from requirements.lock"
                raise cluster.error(rule, remedy)


def _answer(function: Callable[..., Any], arguments: Any, named: Any) -> tuple[Any, Any]:
    """Return the result of a call in a worker, or its error, which is none of the cluster's."""
    from threadpoolctl import threadpool_limits

    threadpool_limits(limits=1)  # for good: the threads of a worker share the setting
    try:
        return function(*arguments, **named), None
    except Exception as error:
        return None, error


def _first_line(error: BaseException) -> str:
    """Return the first line of an error, or its type if it has no message."""
    return (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")
