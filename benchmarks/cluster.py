"""How the package scales on a Dask cluster, here of local processes, and what a task costs.

python -m benchmarks.cluster    # prints the table of docs/how-to/cluster.md; some minutes
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import cloudpickle
from distributed import LocalCluster

from benchmarks.harness import Side, seconds_of
from cylcontact.fitting import Campaign, calibrate
from cylcontact.fitting.calibration import space_of
from cylcontact.fitting.runs import searches
from cylcontact.mechanism import cases, read_mechanism, sweep
from cylcontact.support.parallel import Cluster, Workers, call, collect

ROOT = Path(__file__).parents[1]
WORKERS, ROUNDS, RUNS, EMPTY = (1, 2, 4, 8), 3, 64, 500
CASES = cases(["johnson"], [0.5, 0.3, 0.2, 0.1, 0.07, 0.05], [1.0, 0.9], [0.0, 0.1])
REVOLUTIONS = 150


def main() -> None:
    """Time each job with each number of workers, of one thread each, and print both tables."""
    campaign = Campaign.read(ROOT / "fitting/internal.toml", runs=RUNS)
    spec = campaign.spec
    mechanism = read_mechanism(ROOT / "datasets/slider_crank.toml")
    jobs: dict[str, Callable[[Workers], Any]] = {
        f"fit of {RUNS} runs": lambda workers: calibrate(campaign, workers),
        f"{len(CASES)} cases, {REVOLUTIONS} revolutions": lambda workers: sweep(
            mechanism, CASES, REVOLUTIONS, beyond="tangent", workers=workers
        ),
        f"{EMPTY} empty calls": lambda workers: collect([call(abs, -1)] * EMPTY, workers),
    }
    print("| workers | " + " | ".join(jobs) + " |\n|---:|" + "---:|" * len(jobs))
    for count in WORKERS:
        with LocalCluster(
            n_workers=count, threads_per_worker=1, processes=True, dashboard_address=None
        ) as local:
            where = Cluster(local.scheduler_address)
            sides = [Side(name, partial(job, where)) for name, job in jobs.items()]
            seconds = [min(seconds_of(side) for _ in range(ROUNDS)) for side in sides]
        print(f"| {count} | " + " | ".join(f"{each:.2f} s" for each in seconds) + " |", flush=True)
    space, _ = space_of(campaign)
    run = searches(space, spec.genetic, spec.seed)[0]
    for name, task in {"run": run, "case": call(sweep, mechanism, CASES[:1], REVOLUTIONS)}.items():
        function, arguments, named = task
        sent, back = len(cloudpickle.dumps(task)), function(*arguments, **named)
        print(
            f"{name}: {sent / 1e3:.1f} kB there, {len(cloudpickle.dumps(back)) / 1e3:.1f} kB back"
        )


if __name__ == "__main__":
    main()
