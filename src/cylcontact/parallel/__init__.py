"""Calls in processes, threads or on a Dask cluster, all by joblib, with the same results.

The result of a call must not depend on where it runs: its random numbers come from a seed among
its arguments, and its sums have a fixed order. Then one process, many processes and a cluster of
like processors agree to the bit.
"""

from cylcontact.parallel.calls import Call, call
from cylcontact.parallel.cluster import Cluster
from cylcontact.parallel.recorded import call_for, run_recorded
from cylcontact.parallel.run import Workers, collect, run_calls

__all__ = ["Call", "Cluster", "Workers", "call", "call_for", "collect", "run_calls", "run_recorded"]


def __dir__() -> list[str]:
    return __all__
