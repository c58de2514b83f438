"""The power-law fits of Sect. 3.1."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.power_fit import PowerFit, fit_power, fit_power_to_law
from cylcontact.laws import Johnson
from cylcontact.materials import Material
from cylcontact.pair import Contact, CylinderPair
from cylcontact.reports.claims import agrees_as_printed

from .paper import E_REFERENCE, FIG2_DR, FIG2_FITS, NU_REFERENCE


def stepped_loads(first: float, step: float, last: float) -> FloatArray:
    """Return the loads first, step, 2·step, …, last in N/mm."""
    return np.concatenate([[first], step * np.arange(1, round(last / step) + 1)])


# The loads of Fig 2. The internal list is the one that gives every printed digit; the external
# list is the same over a range ten times as wide.
FIG2_LOADS: dict[Contact, FloatArray] = {
    "internal": stepped_loads(1, 10, 1000),
    "external": stepped_loads(1, 100, 10000),
}


def reference_pair(contact: Contact, dR: float, E: float = E_REFERENCE) -> CylinderPair:
    """Return a pair with ΔR in mm of a material with modulus E in MPa and Fig 2's ν."""
    return CylinderPair.from_dR(contact, dR, Material("reference", E, NU_REFERENCE))


def johnson_points(load: FloatArray, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
    """Return the loads up to Johnson's limit and their penetrations in mm."""
    inside = load[load <= Johnson().max_load(pair)]
    return inside, Johnson().penetration(inside, pair)


def fit_at(contact: Contact, dR: float, E: float, load: FloatArray) -> PowerFit:
    """Fit f = K·δⁿ to Johnson's law at ΔR in mm and E in MPa over the loads up to its limit."""
    return fit_power(*johnson_points(load, reference_pair(contact, dR, E)))


def fig2_fit(contact: Contact, load: FloatArray | None = None) -> PowerFit:
    """Fit f = K·δⁿ to Johnson's law in Fig 2's case, over its loads unless others are given."""
    chosen = FIG2_LOADS[contact] if load is None else load
    return fit_power_to_law(Johnson(), chosen, reference_pair(contact, FIG2_DR[contact]))


def r_squared(values: FloatArray, model: FloatArray) -> float:
    """Return the part of the variance of `values` that a model of them explains."""
    residual = values - model
    return float(1 - residual @ residual / np.sum((values - values.mean()) ** 2))


def r_squared_at(n: ArrayLike, load: FloatArray, penetration: FloatArray) -> FloatArray:
    """Return R² of ln f about the best line of each slope n."""
    y, x = np.log(load), np.log(penetration)
    y, x = y - y.mean(), x - x.mean()
    slope = as_floats(n)
    return as_floats((2 * slope * (x @ y) - slope**2 * (x @ x)) / (y @ y))


# Lists of loads tried for Fig 2's external case, once and by hand.
WIDER_SEARCH = 340_000


def searched_loads() -> Iterator[tuple[str, FloatArray]]:
    """Yield plausible lists of loads in N/mm for Fig 2's external case, with their names.

    First the internal case's form with other steps and ends, then lists with a finer step at first.
    The list that gives both printed numbers came from a search of `WIDER_SEARCH` lists of the
    second form with more steps and ends; one other gave them, 5 to 100 by 5, to 9800 by 100.
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


def ends_spread(values: tuple[float, float]) -> float:
    """Return the spread between two end values in percent of their mean."""
    return 100 * abs(values[1] - values[0]) / (sum(values) / 2)
