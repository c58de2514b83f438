"""Many like cases, of which make test runs a few."""

import pytest


def sampled(cases, few, rest=pytest.mark.slow):
    """Return the parameters of cases; those that are not among the few are slow."""
    return [
        pytest.param(
            *(case if isinstance(case, tuple) else (case,)), marks=() if case in few else rest
        )
        for case in cases
    ]
