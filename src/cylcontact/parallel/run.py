"""Run calls wherever they are to run, and hand back what they return."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from cylcontact.parallel.calls import Call
from cylcontact.parallel.cluster import Cluster, on_cluster
from cylcontact.parallel.local import in_processes, in_threads

__all__ = ["Workers", "run_calls"]

# A number of workers on this machine, or a cluster.
Workers = int | Cluster


def run_calls(
    calls: Sequence[Call], workers: Workers = 1, *, ordered: bool = True, threads: bool = False
) -> Generator[Any]:
    """Run calls and yield what they return.

    Parameters
    ----------
    calls : sequence of Call
        Made with `call`.
    workers : int or Cluster
        As many on this machine (no more are started than there are calls), or a cluster.
    ordered : bool
        Whether to yield in the order of the calls, or each as it ends.
    threads : bool
        Whether workers on this machine are threads of this process, for calls that spend
        their time in numpy or numba; elsewhere they are processes that import the package.

    Yields
    ------
    object
        Close the generator (`contextlib.closing`) where it may be left early: calls under way
        are then given up.

    Raises
    ------
    InputError
        What a call raised, or that the system ended a worker, or that the cluster is gone.

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
