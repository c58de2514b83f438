"""Run calls in processes, in threads or on a cluster."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import closing
from typing import Any

from cylcontact.parallel.calls import Call
from cylcontact.parallel.cluster import Cluster, on_cluster
from cylcontact.parallel.local import in_processes, in_threads
from cylcontact.progress import Progress, silent

__all__ = ["Workers", "collect", "run_calls"]

# A number of workers on this machine, or a cluster.
Workers = int | Cluster


def run_calls(
    calls: Sequence[Call], workers: Workers = 1, *, ordered: bool = True, threads: bool = False
) -> Generator[Any]:
    """Run calls and yield their results.

    Parameters
    ----------
    calls : sequence of Call
        Made with `call`.
    workers : int or Cluster
        Number of workers on this machine, at most one for each call; or a cluster.
    ordered : bool
        Whether to yield in the order of the calls or in the order of completion.
    threads : bool
        Whether workers on this machine are threads, for calls that spend their time in numpy or
        numba; by default they are processes.

    Yields
    ------
    object
        The result of each call. Close the generator (`contextlib.closing`) where the loop may be
        left early; that cancels pending calls.

    Raises
    ------
    InputError
        If a call raises it, the system kills a worker, or the cluster is lost.

    Examples
    --------
    >>> from cylcontact.parallel import call
    >>> list(run_calls([call(abs, value) for value in (-1, -2, -3)]))
    [1, 2, 3]
    """
    if isinstance(workers, Cluster):
        return on_cluster(calls, workers, ordered)
    if threads:
        return in_threads(calls, workers, ordered)
    return in_processes(calls, workers, ordered)


def collect(
    calls: Sequence[Call], workers: Workers = 1, progress: Progress = silent, stage: str = ""
) -> list[Any]:
    """Run calls in processes and return their results in order.

    Parameters
    ----------
    calls, workers
        As for `run_calls`.
    progress : callable, optional
        Called with the stage, how many calls are done, and their number.
    stage : str, optional
        What the calls do.

    Returns
    -------
    list

    Examples
    --------
    >>> from cylcontact.parallel import call
    >>> collect([call(abs, value) for value in (-1, -2, -3)])
    [1, 2, 3]
    """
    collected = []
    with closing(run_calls(calls, workers)) as results:
        for result in results:
            collected.append(result)
            progress(stage, len(collected), len(calls))
    return collected
