"""The power-law fits of Sect. 3.1."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.fitting.power_fit import PowerFit, fit_power, fit_power_to_law
from cylcontact.laws import Johnson
from cylcontact.support.arrays import FloatArray, as_floats

from .paper import E_REFERENCE, FIG2_DR, NU_REFERENCE


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


def ends_spread(values: tuple[float, float]) -> float:
    """Return the spread between two end values in percent of their mean."""
    return 100 * abs(values[1] - values[0]) / (sum(values) / 2)
