"""The power law f = K·δⁿ, Eqs 3–4."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan
from cylcontact.errors import InputError
from cylcontact.pair import CylinderPair


def power_load(penetration: ArrayLike, factor: FloatArray, n: FloatArray) -> FloatArray:
    """Return f = K·δⁿ, NaN where δ is negative."""
    delta = as_floats(penetration)
    touching = delta >= 0
    return inside_or_nan(factor * np.where(touching, delta, 0.0) ** n, touching)


def power_penetration(load: ArrayLike, factor: FloatArray, n: FloatArray) -> FloatArray:
    """Return δ = (f/K)^(1/n), NaN where f is negative."""
    f = as_floats(load)
    touching = f >= 0
    return inside_or_nan((np.where(touching, f, 0.0) / factor) ** (1 / n), touching)


def power_stiffness(penetration: ArrayLike, factor: FloatArray, n: FloatArray) -> FloatArray:
    """Return df/dδ = n·K·δⁿ⁻¹, NaN where δ is negative; infinite at δ = 0 if n < 1."""
    with np.errstate(divide="ignore"):
        return as_floats(n * power_load(penetration, factor, n - 1))


@dataclass(frozen=True)
class PowerLaw:
    """The power law f = K·δⁿ (Eq 3), its factor given as K or as K* = K·ΔR/E* (Eq 4).

    Parameters
    ----------
    n : float
        Exponent, positive.
    K : float, optional
        Factor in N/mm per mmⁿ, for the one pair that it was fitted to.
    K_star : float, optional
        Factor K* of K = K*·E*/ΔR (per unit length), which carries over to other pairs.

    Raises
    ------
    InputError
        Unless exactly one positive factor and a positive exponent are given.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> print(f"{PowerLaw(n=1.237, K=312148).load(1e-3, pair):.2f} N/mm")
    60.72 N/mm
    """

    n: float
    K: float | None = None
    K_star: float | None = None
    name: ClassVar[str] = "power"

    def __post_init__(self) -> None:
        given = [value for value in (self.K, self.K_star) if value is not None]
        if len(given) != 1 or not (given[0] > 0 and np.isfinite(given[0])):
            raise InputError(
                "PowerLaw",
                "K, K_star",
                (self.K, self.K_star),
                "exactly one of them must be given, positive and finite",
                "use K for one pair, K_star for a law that scales with E*/ΔR",
            )
        if not (self.n > 0 and np.isfinite(self.n)):
            raise InputError(
                "PowerLaw", "n", self.n, "must be positive and finite", "contact has n ≥ 1"
            )

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        return power_penetration(load, self.factor(pair), as_floats(self.n))

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        return power_load(penetration, self.factor(pair), as_floats(self.n))

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm²."""
        return power_stiffness(penetration, self.factor(pair), as_floats(self.n))

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return inf: a power law has no largest load."""
        return as_floats(np.full_like(self.factor(pair), np.inf))

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return inf: a power law has no largest penetration."""
        return self.max_load(pair)

    def factor(self, pair: CylinderPair) -> FloatArray:
        """Return K in N/mm per mmⁿ for `pair`."""
        scale = pair.E_star / as_floats(pair.dR)
        if self.K_star is not None:
            return as_floats(self.K_star * scale)
        return as_floats(np.full_like(scale, self.K))
