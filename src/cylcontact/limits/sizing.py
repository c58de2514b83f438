"""A designer's questions: the band of a fit, and which clearance, modulus or length will do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.stats import truncnorm

from cylcontact.bodies.fits import Fit, apart
from cylcontact.bodies.material import material_in_MPa
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Conformal, ContactLaw, Housing, Johnson
from cylcontact.limits import johnson_limit_load, yield_load
from cylcontact.support.arrays import FloatArray, as_floats, require, require_positive
from cylcontact.support.errors import InputError
from cylcontact.support.text_tables import Table

Distribution = Literal["normal", "uniform"]
DISTRIBUTIONS: tuple[Distribution, ...] = ("normal", "uniform")
Unknown = Literal["dR", "E", "length"]
# What `find` finds: its unit, and where it looks.
UNKNOWNS: dict[Unknown, tuple[str, float, float]] = {
    "dR": ("mm", 1e-5, 1e3),
    "E": ("MPa", 1.0, 1e7),
    "length": ("mm", 1e-2, 1e4),
}
# Where a band is evaluated for its ends, and first yield for a table of it.
_POINTS = 33
_SCAN = 200
_SOURCE = "find"


@dataclass(frozen=True)
class Band:
    """What a quantity is over a fit.

    Attributes
    ----------
    name, unit : str
    least, middle, largest : float
        Between the tightest and the loosest pair, and at the middle of both diameters.
    samples : array of float
        The values of diameters drawn at random.
    """

    name: str
    unit: str
    least: float
    middle: float
    largest: float
    samples: FloatArray

    @property
    def mean(self) -> float:
        """The mean of the samples."""
        return float(np.mean(self.samples))

    @property
    def central(self) -> tuple[float, float]:
        """What 5 and 95 % of the samples are below."""
        low, high = np.quantile(self.samples, (0.05, 0.95))
        return float(low), float(high)


@dataclass(frozen=True)
class Bands:
    """The bands of a fit under a load; `bands` computes them.

    Attributes
    ----------
    fit : Fit
    load : float
        In N/mm.
    distribution : {"normal", "uniform"}
    each : dict of Band
        By name: "radial clearance", "penetration", "stiffness", "half-width", "peak pressure",
        "first yield" (if the yield stresses are known) and "Johnson's end".
    """

    fit: Fit
    load: float
    distribution: Distribution
    each: dict[str, Band]

    def __str__(self) -> str:
        drawn = {"normal": "normal, ±3σ within the limits", "uniform": "even"}[self.distribution]
        columns = ["", "least", "middle", "largest", "mean", "5 %", "95 %"]
        rows = [
            [f"{band.name}, {band.unit}", *(f"{value:.5g}" for value in
             (band.least, band.middle, band.largest)),
             *(f"{value:.4g}" for value in (band.mean, *band.central))]
            for band in self.each.values()
        ]  # fmt: skip
        what = f"under {self.load:g} N/mm; mean and percentiles for diameters that are {drawn}:"
        return f"{self.fit}\n{what}\n{Table(columns, rows)}"


def bands(
    fit: Fit | str,
    pair: CylinderPair,
    load: float,
    law: ContactLaw | None = None,
    *,
    distribution: Distribution = "normal",
    samples: int = 20_000,
    seed: int = 1,
    pin_temperature: float | None = None,
    hole_temperature: float | None = None,
) -> Bands:
    """Return what clearance, penetration and limits may be over a fit.

    Parameters
    ----------
    fit : Fit or str
        As "20H7/g6".
    pair : CylinderPair
        One pin in a hole; its materials and plane are used.
    load : float
        Load per unit length in N/mm.
    law : ContactLaw, optional
        For penetration and stiffness, without a housing; `laws.Conformal()` by default.
    distribution : {"normal", "uniform"}
        How hole and pin are drawn, apart from each other: normal about the middle of the tolerance
        with a sixth of it as standard deviation, cut off at its limits, or evenly within them.
    samples, seed : int
        How many pairs are drawn, and the seed of the draw.
    pin_temperature, hole_temperature : float, optional
        In °C, as for `CylinderPair.at_temperature`; 20 by default.

    Raises
    ------
    InputError
        If the fit has an interference or the pin seizes within the band.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", 207e3, 0.3, yield_stress=250.0)
    >>> over = bands("20H7/g6", CylinderPair.from_dR("internal", 0.01, steel), 100.0)
    >>> band = over.each["penetration"]
    >>> print(f"{band.least:.3f} to {band.largest:.3f} {band.unit}")
    0.871 to 1.320 µm
    """
    fit = Fit.read(fit) if isinstance(fit, str) else fit
    fit.require_clearance("bands")
    require_positive(load, "bands", "load", "give it in N/mm")
    rule, remedy = "must be 'normal' or 'uniform'", "see the documentation of bands"
    require(distribution in DISTRIBUTIONS, "bands", "distribution", distribution, rule, remedy)
    law = Conformal() if law is None else law
    rule, remedy = (
        "has a housing",
        "each radius would need its own: take the pairs of the fit's ends",
    )
    require(not isinstance(getattr(law, "datum", None), Housing), "bands", "law", law, rule, remedy)
    warm = pin_temperature is not None or hole_temperature is not None

    def pair_of(R_i: FloatArray, R_j: FloatArray) -> CylinderPair:
        R_i, R_j = apart(R_i, R_j)
        cold = replace(pair, dR=R_i - R_j, R_i=R_i, R_j=R_j)
        return cold.at_temperature(pin_temperature, hole_temperature) if warm else cold

    even = pair_of(*fit.radii(np.linspace(0, 1, _POINTS)))
    draw = np.random.default_rng(seed)
    drawn = pair_of(*(_drawn(draw, distribution, samples, *ends) for ends in fit.limits))
    yields = all(body.yield_stress is not None for body in (pair.material_i, pair.material_j))
    limit = yield_load(even) if yields else None
    quantities: dict[tuple[str, str], Callable[[CylinderPair], FloatArray]] = {
        ("radial clearance", "µm"): lambda p: 1e3 * as_floats(p.dR),
        ("penetration", "µm"): lambda p: 1e3 * law.penetration(load, p),
        ("stiffness", "N/mm²"): lambda p: law.stiffness(law.penetration(load, p), p),
        ("half-width", "mm"): lambda p: half_width(load, p),
        ("peak pressure", "MPa"): lambda p: Conformal().peak_pressure(load, p),
    }
    if limit is not None:
        # A smooth function of ΔR, too slow for thousands of pairs.
        quantities["first yield", "N/mm"] = lambda p: as_floats(np.interp(p.dR, even.dR, limit))
    quantities["Johnson's end", "N/mm"] = johnson_limit_load
    each = {}
    for (name, unit), of in quantities.items():
        values = as_floats(of(even))
        middle = float(values[_POINTS // 2])
        low, high = float(np.min(values)), float(np.max(values))
        each[name] = Band(name, unit, low, middle, high, as_floats(of(drawn)))
    return Bands(fit, load, distribution, each)


def half_width(load: float, pair: CylinderPair, law: Conformal | None = None) -> FloatArray:
    """Return half the width of contact in mm, R·sin ε of `laws.Conformal`, R beyond 90°.

    The law may be one with a housing.
    """
    angle = np.radians(np.minimum((law or Conformal()).contact_angle(load, pair), 90.0))
    return as_floats(pair.radii("the width")[0] * np.sin(angle))


def _drawn(
    draw: np.random.Generator, distribution: Distribution, samples: int, low: float, high: float
) -> FloatArray:
    """Return radii within limits at random."""
    if distribution == "uniform":
        return draw.uniform(low, high, samples)
    return low + (high - low) * (0.5 + truncnorm.rvs(-3, 3, size=samples, random_state=draw) / 6)


def find(
    unknown: Unknown,
    pair: CylinderPair,
    load: float,
    *,
    stiffness: float | None = None,
    penetration: float | None = None,
    law: ContactLaw | None = None,
) -> float:
    """Return the clearance, modulus or length at which a contact has a stiffness or penetration.

    Parameters
    ----------
    unknown : {"dR", "E", "length"}
        The radial clearance in mm; Young's modulus of the pin in MPa, that of the hole in the same
        ratio as in the pair; or the axial length in mm.
    pair : CylinderPair
        One pair; its value of the unknown is not used.
    load : float
        In N/mm; for a length the total force in N.
    stiffness : float, optional
        In N/mm²; for a length the total stiffness in N/mm.
    penetration : float, optional
        In mm. Give this or the stiffness.
    law : ContactLaw, optional
        `laws.Conformal()` by default for a pin in a hole, `laws.Johnson()` for rollers.

    Returns
    -------
    float
        The largest value that will do: a law may meet a stiffness again next to its end.

    Raises
    ------
    InputError
        If no value within reach meets it; the error says what can be reached.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> pair = CylinderPair.from_dR("internal", 0.01, Material("steel", 207e3, 0.3), R_i=10.0)
    >>> dR = find("dR", pair, 500.0, stiffness=2e5)
    >>> law = Conformal()
    >>> at = CylinderPair.from_dR("internal", dR, pair.material_i)
    >>> print(f"{dR:.5f} mm, {law.stiffness(law.penetration(500.0, at), at).item():.4f} N/mm²")
    0.00694 mm, 200000.0000 N/mm²
    """
    require(unknown in UNKNOWNS, _SOURCE, "", unknown, "cannot be found", "dR, E or length")
    if (stiffness is None) == (penetration is None):
        rule = "is missing" if stiffness is None else "is given beside a penetration"
        raise InputError(_SOURCE, "stiffness", stiffness, rule, "give stiffness or penetration")
    key, wanted = ("stiffness", stiffness) if penetration is None else ("penetration", penetration)
    target = float(require_positive(wanted, _SOURCE, key, "give it in N/mm² or mm"))
    require_positive(load, _SOURCE, "load", "give it in N/mm, for a length in N")
    if law is None:
        law = Conformal() if pair.contact == "internal" else Johnson()
    unit, low, high = UNKNOWNS[unknown]
    if unknown == "dR" and pair.R_i is not None:
        # No pin smaller than half its hole; rollers of which the second has some radius.
        R_i = float(as_floats(pair.R_i))
        low, high = (low, R_i / 2) if pair.contact == "internal" else (R_i * (1 + 1e-6), 1e6 * R_i)

    def value(x: ArrayLike) -> FloatArray:
        at, scale = _with(pair, unknown, as_floats(x)), as_floats(x) if unknown == "length" else 1.0
        depth = law.penetration(load / scale, at)
        return as_floats(depth if stiffness is None else scale * law.stiffness(depth, at))

    grid = np.geomspace(low, high, _SCAN)
    values = value(grid)
    known = np.isfinite(values)
    miss = np.sign(values[known] - target)
    crossings = np.flatnonzero(miss[:-1] * miss[1:] <= 0)
    if crossings.size == 0:
        reach = f"{np.min(values[known]):.4g} to {np.max(values[known]):.4g}" if known.any() else ""
        rule = f"is met by no {unknown} from {low:g} to {high:g} {unit}"
        of = "mm" if stiffness is None else "N/mm" if unknown == "length" else "N/mm²"
        rule += f", which give {reach} {of}" if reach else f", where {law.name} has no value"
        raise InputError(_SOURCE, key, target, rule, "change the load, the materials or the target")
    k = crossings[-1]  # of several that of the smallest f/(E*·ΔR): others are next to a law's end
    low, high = (float(np.log(end)) for end in grid[known][[k, k + 1]])

    def miss_at(log: float) -> float:
        return float(value(np.exp(log))) / target - 1

    return float(np.exp(brentq(miss_at, low, high, xtol=1e-14)))


def _with(pair: CylinderPair, unknown: Unknown, x: FloatArray) -> CylinderPair:
    """Return a pair with another value of the unknown."""
    if unknown == "length":
        return pair
    if unknown == "dR":
        R_j = None
        if pair.R_i is not None:
            R_j = pair.R_i - x if pair.contact == "internal" else x - pair.R_i
        return replace(pair, dR=x, R_j=R_j)
    scale = x / as_floats(pair.material_j.E)
    hole, pin = (
        material_in_MPa(body.name, body.E * scale, body.nu)
        for body in (pair.material_i, pair.material_j)
    )
    return replace(pair, material_i=hole, material_j=pin)
