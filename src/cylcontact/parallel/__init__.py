"""Calls spread over processes, threads or a Dask cluster, all by joblib, with the same results.

What a call returns must not depend on where it runs: its random numbers come from a seed among
its arguments, and its sums have a fixed order. Then one process, many and a cluster agree to
the bit.
"""

from cylcontact.parallel.calls import Call, call
from cylcontact.parallel.cluster import Cluster
from cylcontact.parallel.run import Workers, run_calls

__all__ = ["Call", "Cluster", "Workers", "call", "run_calls"]


def __dir__() -> list[str]:
    return __all__
