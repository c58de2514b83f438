"""Joblib's backend for Dask, with errors where the original would wait forever."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError
from contextlib import suppress
from typing import Any

from joblib._dask import DaskDistributedBackend

__all__ = ["ClusterBackend", "Watch"]


class ClusterBackend(DaskDistributedBackend):  # type: ignore[misc]
    """A backend that runs all calls on the cluster and passes every failure on.

    Joblib runs calls in this process when it counts a single worker. It also waits forever for a
    call whose workers were killed repeatedly, or that was submitted as the scheduler went away.

    Parameters
    ----------
    client : distributed.Client
        The connection.
    """

    def __init__(self, client: Any) -> None:
        super().__init__(client=client)
        self._submitted: list[Future[Any]] = []

    def effective_n_jobs(self, n_jobs: int) -> int:
        """Return the number of threads of the workers, at least two."""
        return max(2, int(super().effective_n_jobs(n_jobs)))

    def submit(self, func: Any, callback: Callable[[Any], None] | None = None) -> Future[Any]:
        """Submit a batch of calls; its callback is called even if it fails."""
        future: Future[Any] = super().submit(func, callback)

        def hand_on(done: Future[Any]) -> None:
            if callback is not None and done.exception() is not None:
                callback(done.exception())

        future.add_done_callback(hand_on)
        self._submitted = [other for other in self._submitted if not other.done()]
        self._submitted.append(future)
        return future

    def retrieve_result_callback(self, out: Any) -> Any:
        """Return the results of a batch of calls, or raise its error."""
        if isinstance(out, BaseException):
            raise out
        return super().retrieve_result_callback(out)

    def fail(self, error: BaseException) -> None:
        """Set an error on every call that is still pending."""
        for future in list(self._submitted):
            with suppress(InvalidStateError):
                future.set_exception(error)


class Watch:
    """A thread that gives up a cluster without a scheduler or workers for too long.

    Parameters
    ----------
    backend : ClusterBackend
        The backend with the pending calls.
    patience : float
        Time to wait in s.

    Attributes
    ----------
    deserted : bool
        Whether the cluster was given up.
    """

    def __init__(self, backend: ClusterBackend, patience: float) -> None:
        self.deserted = False
        self._backend = backend
        self._patience = patience
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def _watch(self) -> None:
        period = min(1.0, self._patience / 2)
        seen = time.monotonic()
        while not self._ended.wait(period):
            if self._has_workers():
                seen = time.monotonic()
            elif time.monotonic() - seen >= self._patience:
                self.deserted = True
                self._backend.fail(TimeoutError())
                return

    def _has_workers(self) -> bool:
        """Ask the scheduler, which may have stopped answering without closing the connection."""
        client = self._backend.client
        with suppress(Exception):  # many kinds are raised while the scheduler is away
            known = client.sync(client.scheduler.identity, callback_timeout=self._patience / 2)
            return bool(known["workers"])
        return False

    def stop(self) -> None:
        """Stop the watch thread."""
        self._ended.set()
        self._thread.join()
