"""Joblib's own backend for Dask, made to tell of losses for which it would wait for ever."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError
from contextlib import suppress
from typing import Any

from joblib._dask import DaskDistributedBackend

__all__ = ["ClusterBackend", "Watch"]


class ClusterBackend(DaskDistributedBackend):  # type: ignore[misc]
    """A backend that leaves nothing to this process and hands every failure on.

    Joblib runs calls itself where it counts a single worker, and never hears of a call whose
    workers were killed again and again, or that was submitted as the scheduler went away.

    Parameters
    ----------
    client : distributed.Client
        The connection.
    """

    def __init__(self, client: Any) -> None:
        super().__init__(client=client)
        self._submitted: list[Future[Any]] = []

    def effective_n_jobs(self, n_jobs: int) -> int:
        """Return the workers' threads, at least two."""
        return max(2, int(super().effective_n_jobs(n_jobs)))

    def submit(self, func: Any, callback: Callable[[Any], None] | None = None) -> Future[Any]:
        """Send a batch of calls, and hear of it even if it fails."""
        future: Future[Any] = super().submit(func, callback)

        def hand_on(done: Future[Any]) -> None:
            if callback is not None and done.exception() is not None:
                callback(done.exception())

        future.add_done_callback(hand_on)
        self._submitted = [other for other in self._submitted if not other.done()]
        self._submitted.append(future)
        return future

    def retrieve_result_callback(self, out: Any) -> Any:
        """Return what a batch of calls gave, or raise what was handed on instead."""
        if isinstance(out, BaseException):
            raise out
        return super().retrieve_result_callback(out)

    def fail(self, error: BaseException) -> None:
        """End every call that is still waited for."""
        for future in list(self._submitted):
            with suppress(InvalidStateError):
                future.set_exception(error)


class Watch:
    """Give a cluster up that has had no scheduler or no worker for a while.

    Parameters
    ----------
    backend : ClusterBackend
        The calls under way.
    patience : float
        Seconds.

    Attributes
    ----------
    deserted : bool
        Whether it was given up.
    """

    def __init__(self, backend: ClusterBackend, patience: float) -> None:
        self.deserted = False
        self._backend = backend
        self._patience = patience
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)
        self._thread.start()

    def _look(self) -> None:
        period = min(1.0, self._patience / 2)
        alone = 0.0
        while not self._ended.wait(period):
            alone = 0.0 if self._has_workers() else alone + period
            if alone >= self._patience:
                self.deserted = True
                self._backend.fail(TimeoutError())
                return

    def _has_workers(self) -> bool:
        client = self._backend.client
        with suppress(Exception):  # of many kinds, while the scheduler is away
            return client.status == "running" and bool(client.scheduler_info()["workers"])
        return False

    def stop(self) -> None:
        """Look no more."""
        self._ended.set()
        self._thread.join()
