"""Lists of loads that the paper may have fitted Fig 2's external case to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from itertools import product

import numpy as np

from cylcontact.fitting.power_fit import PowerFit
from cylcontact.reports.claims import agrees_as_printed
from cylcontact.support.arrays import FloatArray

from .paper import FIG2_FITS
from .power_fits import fig2_fit, stepped_loads

# Lists of loads tried for Fig 2's external case, once and by hand, and how many of them gave both
# printed numbers.
WIDER_SEARCH, WIDER_FOUND = 340_000, 2


def searched_loads() -> Iterator[tuple[str, FloatArray]]:
    """Yield plausible lists of loads in N/mm for Fig 2's external case, with their names.

    First the internal case's form with other steps and ends, then lists with a finer step at first.
    The list that gives both printed numbers came from a search of `WIDER_SEARCH` lists of the
    second form with more steps and ends; the other of `WIDER_FOUND` was 5 to 100 by 5, to 9800 by
    100.
    """
    for step, count in product((10, 20, 25, 50, 100, 200, 250, 500), range(20, 121)):
        last = step * count
        yield f"1, {step}, {2 * step}, …, {last} N/mm", stepped_loads(1, step, last)
    for start, fine, change, coarse, last in product(
        ([], [1.0]),
        (5, 10, 20, 25, 50),
        (100, 200, 500, 1000),
        (50, 100, 200, 250, 500, 1000),
        (1000, 2000, 5000, 10000),
    ):
        if fine < coarse and change < last:
            parts = np.arange(fine, change + 1, fine), np.arange(change + coarse, last + 1, coarse)
            name = f"{fine} to {change} by {fine}, to {last} by {coarse} N/mm"
            yield f"{'1, ' if start else ''}{name}", np.concatenate([start, *parts])


@cache
def external_matches() -> tuple[int, Mapping[str, PowerFit]]:
    """Return how many lists were searched, and the fits whose n is that of Fig 2's external case.

    The fits are by the name of their list, the one closest to the printed K first.
    """
    K, n = FIG2_FITS["external"]
    fits = {name: fig2_fit("external", load) for name, load in searched_loads()}
    matching = [name for name, fit in fits.items() if agrees_as_printed(fit.n, n)]
    matching.sort(key=lambda name: abs(fits[name].K - float(K)))
    return len(fits), {name: fits[name] for name in matching}


def expected_matches() -> float:
    """Return how many lists of the wider search would give both printed numbers by chance.

    Those that give n are taken to be as frequent there as here, and their K as evenly spread; one
    in as many as this spread has units rounds to the printed K.
    """
    tried, matches = external_matches()
    factors = [fit.K for fit in matches.values()]
    return WIDER_SEARCH * len(matches) / tried / (max(factors) - min(factors))
