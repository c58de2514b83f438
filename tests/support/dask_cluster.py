"""A real Dask cluster on the loopback interface: a scheduler and workers, each a process."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time

from tests.support.tether import tethered


class LoopbackCluster:
    """A scheduler and workers that end with the block, or with this process where it is killed."""

    def __init__(self, folder, workers=2, threads=1, environment=None, host="127.0.0.1"):
        self.folder = folder
        self.workers = []
        self._threads, self._host = threads, host
        self._environment = {**os.environ, **(environment or {})}
        self._file = folder / "scheduler.json"
        self.start_scheduler()
        for _ in range(workers):
            self.add_worker()

    def start_scheduler(self, port="0"):
        """Start the scheduler, by default at any port."""
        self._file.unlink(missing_ok=True)
        quiet = ("--no-dashboard", "--scheduler-file", str(self._file))
        self.scheduler = self._start("scheduler", "--host", self._host, "--port", port, *quiet)
        self.address = self._wait_for_address()

    def add_worker(self, environment=None):
        """Start one more worker, with more variables in its environment."""
        self.workers.append(
            self._start(
                "worker",
                self.address,
                *("--no-nanny", "--no-dashboard", "--nthreads", str(self._threads)),
                *("--host", self._host, "--local-directory", str(self.folder)),
                environment=environment,
            )
        )

    def __enter__(self):
        from distributed import Client

        if self.workers:  # on a busy machine they take longer to start than commands wait
            with Client(self.address, timeout=60, set_as_default=False) as client:
                client.wait_for_workers(len(self.workers), timeout=120)
        return self

    def __exit__(self, *_):
        for process in (*self.workers, self.scheduler):
            kill(process)

    def _start(self, what, *arguments, environment=None):
        command = tethered([sys.executable, "-m", f"distributed.cli.dask_{what}", *arguments])
        log = (self.folder / f"{what}-{len(self.workers)}.log").open("w")
        with log:
            return subprocess.Popen(
                command, stdout=log, stderr=log, env=self._environment | (environment or {})
            )

    def _wait_for_address(self):
        end = time.monotonic() + 60
        while time.monotonic() < end and self.scheduler.poll() is None:
            with contextlib.suppress(OSError, ValueError):
                return json.loads(self._file.read_text())["address"]
            time.sleep(0.05)
        raise AssertionError((self.folder / "scheduler-0.log").read_text())


def kill(process):
    """End a process at once and wait until it is gone."""
    with contextlib.suppress(ProcessLookupError):
        process.send_signal(signal.SIGKILL)
    process.wait()
