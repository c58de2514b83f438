"""Calls on a Dask cluster, through joblib's own backend for it.

When a worker is lost, the scheduler gives its calls to another worker. Calls carry their arguments
along instead of leaving them in the memory of a worker, so no data is lost with it.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

from cylcontact.errors import InputError
from cylcontact.parallel.calls import Call
from cylcontact.parallel.local import as_generator, give_up

__all__ = ["CONNECTING", "DESERTED", "Cluster", "on_cluster"]

# Seconds to find the scheduler and a first worker, and to wait for workers once all are lost.
CONNECTING = 10.0
DESERTED = 30.0
# Results agree to the bit only if these versions agree.
_SAME_VERSIONS = ("python", "cylcontact", "numpy", "scipy", "pygad")
_ADDRESS = re.compile(
    r"((tcp|tls|ws|wss|ucx|ucxx)://)?(\[[0-9A-Fa-f:.]+\]|[^\s:/\[\]]+):[0-9]{1,5}"
)
_LOGGERS = ("distributed", "distributed.client")


@dataclass(frozen=True)
class Cluster:
    """A running Dask cluster, given by the address of its scheduler.

    Parameters
    ----------
    address : str
        For example tcp://192.168.1.5:8786.

    Raises
    ------
    InputError
        If the address is invalid, or the extra `distributed` is not installed.
    """

    address: str

    def __post_init__(self) -> None:
        # Given an empty address, Dask would start a cluster of its own on this machine.
        if not _ADDRESS.fullmatch(self.address):
            raise InputError(
                "--scheduler",
                "",
                self.address,
                "is not the address of a scheduler",
                "give it as dask scheduler prints it, e.g. tcp://192.168.1.5:8786",
            )
        try:
            import distributed  # noqa: F401
        except ImportError:
            raise InputError(
                "--scheduler",
                "",
                None,
                "needs the extra 'distributed'",
                "make extras, or pip install 'cylcontact[distributed]'",
            ) from None


def on_cluster(calls: Sequence[Call], cluster: Cluster, ordered: bool = True) -> Generator[Any]:
    """Run calls on a cluster; see `run_calls`."""
    import joblib

    from cylcontact.parallel.dask_backend import ClusterBackend, Watch

    limited: list[Call] = [(partial(_on_one_thread, *call), (), {}) for call in calls]
    with _connected(cluster) as client:
        backend = ClusterBackend(client)
        watch, results = Watch(backend, DESERTED), None
        try:
            with joblib.parallel_config(backend=backend):
                parallel = joblib.Parallel(n_jobs=-1, return_as=as_generator(ordered))
            results = parallel(limited)
            for result in results:  # noqa: UP028 - `yield from` would close it too early
                yield result
        except _losses() as error:
            raise _lost(cluster, error, watch.deserted) from error
        finally:
            watch.stop()
            give_up(results)


def _on_one_thread(function: Any, arguments: Any, named: Any) -> Any:
    """Make a call in a worker with linear algebra limited to one thread.

    The limit is permanent: the threads of a worker share the setting, and the first to finish
    would otherwise lift it for the others.
    """
    from threadpoolctl import threadpool_limits

    threadpool_limits(limits=1)
    return function(*arguments, **named)


@contextmanager
def _connected(cluster: Cluster) -> Iterator[Any]:
    """Yield a client of a cluster whose workers have the same versions; silence Dask's log."""
    import distributed

    with _quiet():
        try:
            client: Any = distributed.Client(  # type: ignore[no-untyped-call]
                cluster.address, timeout=CONNECTING, set_as_default=False
            )
        except (OSError, ValueError, TypeError, ImportError) as error:
            raise InputError(
                "--scheduler",
                "",
                cluster.address,
                f"cannot be reached ({_first_line(error)})",
                "start one with dask scheduler, and give the address that it prints",
            ) from error
        try:
            _require_workers(client, cluster)
            yield client
        finally:
            with suppress(OSError, TimeoutError):
                client.close(timeout=CONNECTING)


def _require_workers(client: Any, cluster: Cluster) -> None:
    """Raise `InputError` for a cluster without workers or with workers of other versions."""
    try:
        client.wait_for_workers(1, timeout=CONNECTING)
        versions = client.get_versions(packages=list(_SAME_VERSIONS[1:]))
    except (TimeoutError, OSError) as error:
        raise InputError(
            "--scheduler",
            "",
            cluster.address,
            f"has no workers after {CONNECTING:g} s",
            f"start some, each with: dask worker {cluster.address}",
        ) from error
    own = versions["client"]["packages"]
    for worker, environment in versions["workers"].items():
        theirs = environment["packages"]
        for name in _SAME_VERSIONS:
            if theirs.get(name) != own.get(name):
                raise InputError(
                    "--scheduler",
                    "",
                    cluster.address,
                    f"its worker {worker} has {name} {theirs.get(name)}, here it is {own[name]}",
                    "install the same on all machines, e.g. from requirements.lock",
                )


def _losses() -> tuple[type[BaseException], ...]:
    """Return the errors that the loss of a cluster raises."""
    from asyncio import CancelledError as AsyncCancelledError
    from concurrent.futures import CancelledError

    from distributed import KilledWorker
    from distributed.comm.core import CommClosedError

    return (KilledWorker, CommClosedError, CancelledError, AsyncCancelledError, TimeoutError)


def _lost(cluster: Cluster, error: BaseException, deserted: bool) -> InputError:
    """Return the error for a cluster that was lost."""
    rule = f"was lost during the run ({_first_line(error)})"
    if deserted:
        rule = f"has had no scheduler or no workers for {DESERTED:g} s"
    return InputError(
        "--scheduler",
        "",
        cluster.address,
        rule,
        "start it again; fit --resume continues from the saved runs",
    )


def _first_line(error: BaseException) -> str:
    """Return the first line of an error, or its type if it has no message."""
    return (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence Dask's log; its errors are raised as `InputError`."""
    loggers = [logging.getLogger(name) for name in _LOGGERS]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)
