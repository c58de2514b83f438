"""Calls on a Dask cluster, through joblib's own backend for it.

When a worker is lost, the scheduler gives its calls to another worker. Calls carry their arguments
along instead of leaving them in the memory of a worker, so no data is lost with it.
"""

from __future__ import annotations

import asyncio
import logging
import pickle
import re
import traceback
from collections.abc import Generator, Iterator, Mapping, Sequence
from concurrent import futures
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from cylcontact.errors import InputError
from cylcontact.parallel.calls import RESUME, Call
from cylcontact.parallel.local import as_generator, give_up

if TYPE_CHECKING:
    from cylcontact.parallel.dask_backend import Watch

__all__ = ["CONNECTING", "DESERTED", "Cluster", "on_cluster"]

# Seconds to find the scheduler and a first worker, and to wait for workers once all are lost.
CONNECTING = 10.0
DESERTED = 30.0
# Results are the same only if these versions agree.
_SAME_VERSIONS = ("python", "cylcontact", "numpy", "scipy", "numba", "pygad")
_SAME = "install the same on all machines, e.g. from requirements.lock"
# What tells Dask of the certificates for tls://.
_CERTIFICATES = [
    f"DASK_DISTRIBUTED__COMM__TLS__{name}" for name in ("CA_FILE", "CLIENT__CERT", "CLIENT__KEY")
]
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

    # As arguments of `partial`, large ones are not scattered to the memory of workers.
    here = cluster.address, _versions()
    sent: list[Call] = [(partial(_answer, *here, *call), (), {}) for call in calls]
    with _connected(cluster) as client:
        backend = ClusterBackend(client)
        watch, results = Watch(backend, DESERTED), None
        try:
            with joblib.parallel_config(backend=backend):
                parallel = joblib.Parallel(n_jobs=-1, return_as=as_generator(ordered))
            results = parallel(sent)
            for done, outcome in _answers(results, cluster, watch):
                if not done:
                    raise outcome
                yield outcome
        finally:
            watch.stop()
            give_up(results)


def _answers(results: Generator[bytes], cluster: Cluster, watch: Watch) -> Iterator[Any]:
    """Yield the answers of calls; raise `InputError` if one is missing or cannot be read."""
    try:
        for answer in results:
            yield pickle.loads(answer)
    # Dask raises many kinds of errors, and those of the calls are among the answers.
    except (Exception, asyncio.CancelledError) as error:
        raise _lost(cluster, error, watch.deserted) from error


def _answer(
    cluster: str, own: Mapping[str, str | None], function: Any, arguments: Any, named: Any
) -> bytes:
    """Make a call in a worker; return whether it was done, and its result or its error.

    The versions are compared here too, because a worker may join at any time. The answer is
    pickled here, because joblib waits forever for what it cannot unpickle. The limit of one thread
    for linear algebra is permanent: the threads of a worker share the setting, and the first to
    finish would otherwise lift it for the others.
    """
    from distributed import get_worker
    from threadpoolctl import threadpool_limits

    threadpool_limits(limits=1)
    try:
        _require_versions(cluster, own, f"worker {get_worker().address}", _versions())
        answer = True, function(*arguments, **named)
    except Exception as error:
        error.add_note(f"In a worker:\n{traceback.format_exc()}")
        answer = False, error
    return pickle.dumps(answer)


def _versions() -> dict[str, str | None]:
    """Return the versions that the results depend on, as Dask finds them."""
    from distributed.versions import get_versions

    found = get_versions(_SAME_VERSIONS[1:])["packages"]
    return {name: found[name] for name in _SAME_VERSIONS}


def _require_versions(
    address: str, own: Mapping[str, str | None], who: str, theirs: Mapping[str, str | None]
) -> None:
    """Raise `InputError` if a scheduler or a worker of a cluster has other versions."""
    for name in _SAME_VERSIONS:
        actual, expected = (versions.get(name) or "missing" for versions in (theirs, own))
        if actual != expected:
            raise InputError(
                "--scheduler",
                "",
                address,
                f"its {who} has {name} {actual}, here it is {expected}",
                _SAME,
            )


@contextmanager
def _connected(cluster: Cluster) -> Iterator[Any]:
    """Yield a client of a cluster that has workers; silence Dask's log."""
    import distributed

    with _quiet():
        _require_scheduler(cluster)
        client: Any = distributed.Client(  # type: ignore[no-untyped-call]
            cluster.address, timeout=CONNECTING, set_as_default=False
        )
        try:
            _require_workers(client, cluster)
            yield client
        finally:
            with suppress(OSError, TimeoutError):
                client.close(timeout=CONNECTING)


def _require_scheduler(cluster: Cluster) -> None:
    """Raise `InputError` unless a scheduler of Dask answers at the address.

    A client of Dask would wait forever for one that accepts the connection and says nothing. It is
    asked in a thread, because a notebook has a running loop.
    """
    remedy = "start one with dask scheduler, and give the address that it prints"
    if cluster.address.startswith(("tls:", "wss:")):
        remedy = f"set {', '.join(_CERTIFICATES)}, and give the address that dask scheduler prints"
    try:
        with futures.ThreadPoolExecutor(1) as thread:
            kind = thread.submit(asyncio.run, _kind_at(cluster.address)).result()
    except Exception as error:  # whatever speaks another protocol may cause any
        reason = _first_line(error)
        raise InputError(
            "--scheduler", "", cluster.address, f"cannot be reached ({reason})", remedy
        ) from error
    if kind != "Scheduler":
        rule = f"is the address of a {kind.lower()}, not of a scheduler"
        raise InputError("--scheduler", "", cluster.address, rule, remedy)


async def _kind_at(address: str) -> str:
    """Return what a server of Dask says that it is, such as "Scheduler" or "Worker"."""
    from distributed import Security
    from distributed.core import rpc

    arguments = Security().get_connection_args("client")  # type: ignore[no-untyped-call]
    connect: Any = rpc
    server = connect(address, timeout=CONNECTING, connection_args=arguments)
    async with asyncio.timeout(CONNECTING), server:
        return str((await server.identity())["type"])


def _require_workers(client: Any, cluster: Cluster) -> None:
    """Raise `InputError` for a cluster without workers, or with other versions."""
    own, packages = _versions(), _SAME_VERSIONS[1:]
    try:
        client.wait_for_workers(1, timeout=CONNECTING)
        scheduler = client.sync(
            client.scheduler.versions, packages=packages, callback_timeout=CONNECTING
        )
    except (TimeoutError, OSError) as error:
        raise InputError(
            "--scheduler",
            "",
            cluster.address,
            f"has no workers after {CONNECTING:g} s",
            f"start some, each with: dask worker {cluster.address}",
        ) from error
    _require_versions(cluster.address, own, "scheduler", scheduler["packages"])
    with suppress(TimeoutError):  # where one is stopped; each call compares them again
        workers = client.sync(
            client.scheduler.broadcast,
            msg={"op": "versions", "packages": packages},
            on_error="ignore",
            callback_timeout=CONNECTING,
        )
        for worker, found in workers.items():
            _require_versions(cluster.address, own, f"worker {worker}", found["packages"])


def _lost(cluster: Cluster, error: BaseException, deserted: bool) -> InputError:
    """Return the error for calls without an answer."""
    from distributed import KilledWorker

    lost = (OSError, TimeoutError, asyncio.CancelledError, futures.CancelledError)
    rule = f"a call did not come through ({type(error).__name__}: {_first_line(error)})"
    remedy = _SAME
    if deserted:
        rule = f"has had no scheduler or no workers for {DESERTED:g} s"
        remedy = "start it again"
    elif isinstance(error, KilledWorker):
        rule = f"a call ended {error.allowed_failures + 1} workers, probably as memory ran out"
        remedy = "give its workers more memory, or use a smaller grid"
    elif isinstance(error, lost):
        rule, remedy = f"was lost during the run ({_first_line(error)})", "start it again"
    return InputError("--scheduler", "", cluster.address, rule, f"{remedy}; {RESUME}")


def _first_line(error: BaseException) -> str:
    """Return the first line of an error, or its type if it has no message."""
    if isinstance(error, TimeoutError) and not str(error):
        return f"no answer in {CONNECTING:g} s"
    if isinstance(error, MemoryError):  # the first bytes of another protocol, taken for a length
        return "what answers there is not Dask"
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
