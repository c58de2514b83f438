"""The clearance, modulus or length that meets a target; the width of contact, the peak's place."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from cylcontact.bodies.material import scaled
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Conformal, ContactLaw, Housing, Johnson
from cylcontact.laws.conformal.arcs import Bodies
from cylcontact.laws.conformal.series import Housed
from cylcontact.limits.loads import first_yield, hertz_stress
from cylcontact.limits.rings import Rim, at_temperature
from cylcontact.support.arrays import FloatArray, as_floats, require, require_positive
from cylcontact.support.errors import InputError

Unknown = Literal["clearance", "modulus", "length"]
# What `find` finds: its unit, and where it looks.
UNKNOWNS: dict[Unknown, tuple[str, float, float]] = {
    "clearance": ("mm", 1e-5, 1e3),
    "modulus": ("MPa", 1.0, 1e7),
    "length": ("mm", 1e-2, 1e4),
}
# What it has to meet, with the units; for a length those of the whole joint.
TARGETS = {
    "stiffness": ("N/mm²", "N/mm"),
    "penetration": ("mm", "mm"),
    "peak": ("MPa", "MPa"),
    "factor": ("", ""),
}
# Places where a target is looked at first, fewer where each needs a housing of its own.
_SCAN, _FEW = 200, 25
# A target is met with this relative deviation, or else a law jumps over it; and the relative
# distance from a jump at which a law is looked at.
_MET, _BESIDE = 1e-6, 1e-12
_SOURCE = "find"
# Places along half the contact where its pressure is compared.
_ALONG = 721


def half_width(angle: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return half the width in mm of a contact of this semi-angle in degrees, R beyond 90°."""
    sine = np.sin(np.radians(np.minimum(angle, 90.0)))
    return as_floats(pair.radii("the width")[0] * sine)


def peak_angle(load: float, pair: CylinderPair, law: Conformal | None = None) -> float:
    """Return the place of the largest pressure, in degrees from the line of the load.

    It is 0 in a plate. A thin eye presses on the pin from both sides.

    Examples
    --------
    >>> from cylcontact.bodies.material import Material
    >>> from cylcontact.laws import Sector
    >>> steel, aluminium = map(Material.named, ("low-carbon steel", "aluminium alloy"))
    >>> pair = CylinderPair.internal(5.0, 4.99, pin=steel, hole=aluminium, plane="stress")
    >>> eye = Conformal(Housing(6.7, Sector(110, "pulled")))
    >>> print(f"{peak_angle(100.0, pair, eye):.0f}°, {peak_angle(100.0, pair):.0f}°")
    59°, 0°
    """
    if law is None or not isinstance(law.datum, Housing):
        return 0.0
    _, kernels = law.datum.kernels(pair)
    bodies = Bodies(pair.shares[0], float(pair.beta.round(15)), as_floats(0.0), kernels[0])
    series, angle = bodies.remainder, np.radians(float(law.contact_angle(load, pair)))
    if np.isnan(angle):
        return float("nan")
    assert isinstance(series, Housed)
    coefficients = chebyshev.chebval(2 * angle / series.top - 1, series.coefficients)
    v = np.linspace(0, np.pi / 2, _ALONG)
    pressure = np.sin(np.outer(v, 2 * np.arange(coefficients.size) + 1)) @ coefficients
    place = 2 * np.arctan(np.tan(angle / 2) * np.cos(v[int(np.argmax(pressure))]))
    return float(np.degrees(place)) if place > 1e-9 else 0.0


def find(
    unknown: Unknown,
    pair: CylinderPair,
    load: float,
    *,
    stiffness: float | None = None,
    penetration: float | None = None,
    peak: float | None = None,
    factor: float | None = None,
    law: ContactLaw | None = None,
    temperature: tuple[float, float] | None = None,
    rim: Rim | None = None,
) -> float:
    """Return the clearance, modulus or length at which a contact meets a target.

    Parameters
    ----------
    unknown : {"clearance", "modulus", "length"}
        The radial clearance in mm, for rollers R_i + R_j; Young's modulus of the pin in MPa, that
        of the hole in the same ratio as in the pair; or the axial length in mm.
    pair : CylinderPair
        One pair; its value of the unknown is not used.
    load : float
        In N/mm; for a length the total force in N.
    stiffness : float, optional
        In N/mm²; for a length the total stiffness in N/mm.
    penetration : float, optional
        In mm.
    peak : float, optional
        The largest pressure in MPa.
    factor : float, optional
        First yield over the load. Give one of these four.
    law : ContactLaw, optional
        `laws.Conformal()` by default for a pin in a hole, `laws.Johnson()` for rollers. A housing
        in the law counts for first yield too.
    temperature : (float, float), optional
        Of the pin and of the hole in °C. The target is then met at these temperatures, by the
        value at 20 °C that is returned.
    rim : "free", "held" or Material, optional
        With a temperature and a housing, as for `limits.at_temperature`.

    Returns
    -------
    float
        If several values meet the target, the largest: the others lie near the end of a law.

    Raises
    ------
    InputError
        If no value within reach meets it; the error says what can be reached.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> pair = CylinderPair.from_dR("internal", 0.01, Material("steel", 207e3, 0.3), R_i=10.0)
    >>> dR = find("clearance", pair, 500.0, stiffness=2e5)
    >>> law = Conformal()
    >>> at = CylinderPair.from_dR("internal", dR, pair.material_i)
    >>> print(f"{dR:.5f} mm, {law.stiffness(law.penetration(500.0, at), at).item():.4f} N/mm²")
    0.00694 mm, 200000.0000 N/mm²
    """
    rule = "must be clearance, modulus or length"
    require(unknown in UNKNOWNS, _SOURCE, "", unknown, rule, "name one of these")
    given = {"stiffness": stiffness, "penetration": penetration, "peak": peak, "factor": factor}
    key, target = _target(given)
    require_positive(load, _SOURCE, "load", "give it in N/mm, for a length in N")
    if law is None:
        law = Conformal() if pair.contact == "internal" else Johnson()
    unit, low, high = UNKNOWNS[unknown]
    if unknown == "clearance" and pair.R_i is not None:
        # No pin smaller than half its hole; rollers of which the second has some radius.
        R_i = float(as_floats(pair.R_i))
        low, high = (low, R_i / 2) if pair.contact == "internal" else (R_i * (1 + 1e-6), 1e6 * R_i)
    search = _Search(unknown, key, pair, load, law, temperature, rim)
    scan = np.geomspace(low, high, _SCAN if search.housing is None else _FEW)
    if unknown == "clearance":  # both sides of a clearance at which the law jumps
        jumps = [jump for jump in getattr(law, "jumps", ()) if low < jump < high]
        scan = np.union1d(scan, np.outer(jumps, [1 - _BESIDE, 1 + _BESIDE]))
    x = _root(search.value, target, scan, search.values(scan))
    if isinstance(x, float):
        return x
    of = TARGETS[key][unknown == "length"]
    if isinstance(x, _Jump):
        rule = f"is met by no {unknown}: at {x.at:g} {unit} the law jumps from {x.below:.4g} to "
        raise InputError(_SOURCE, key, target, f"{rule}{x.above:.4g} {of}", "change the target")
    reach = f", which give {x[0]:.4g} to {x[1]:.4g}" if x is not None else ""
    rule = f"is met by no {unknown} from {low:g} to {high:g} {unit}"
    rule += f"{reach} {of}".rstrip() if reach else f", where {law.name} has no value"
    raise InputError(_SOURCE, key, target, rule, "change the load, the materials or the target")


@dataclass(eq=False)
class _Search:
    """What is to meet a target, as a function of what is sought."""

    unknown: Unknown
    key: str
    pair: CylinderPair
    load: float
    law: ContactLaw
    temperature: tuple[float, float] | None
    rim: Rim | None

    @cached_property
    def housing(self) -> Housing | None:
        """The housing of the law."""
        datum = self.law.datum if isinstance(self.law, Conformal) else None
        return datum if isinstance(datum, Housing) else None

    @cached_property
    def fixed(self) -> CylinderPair:
        """The warm pair of every length."""
        return self.warm(self.pair)

    @cached_property
    def fixed_yield(self) -> float:
        """The load of first yield of every length."""
        return float(first_yield(self.fixed, housing=self.housing).load)

    def warm(self, pair: CylinderPair) -> CylinderPair:
        """Return a pair at its temperatures."""
        if self.temperature is None:
            return pair
        pin, hole = self.temperature
        return at_temperature(pair, pin, hole, housing=self.housing, rim=self.rim)

    def value(self, x: float) -> float:
        """Return what is to meet the target, NaN where the pin seizes."""
        try:
            return float(self._at(x))
        except InputError as error:
            if "seizes" not in error.rule:
                raise
            return float("nan")

    def values(self, grid: FloatArray) -> FloatArray:
        """Return the value at each x: all at once, unless a pin seizes or there is a housing."""
        if self.housing is None:
            with suppress(InputError):
                return np.broadcast_to(self._at(grid), grid.shape)
        return np.array([self.value(x) for x in grid.tolist()])

    def _at(self, x: FloatArray | float) -> FloatArray | float:
        is_length, law = self.unknown == "length", self.law
        scale = x if is_length else 1.0
        f = self.load / scale
        pair = self.fixed if is_length else self.warm(_with(self.pair, self.unknown, x))
        if self.key == "penetration":
            return law.penetration(f, pair)
        if self.key == "stiffness":
            return scale * law.stiffness(law.penetration(f, pair), pair)
        if self.key == "peak":
            peak = law.peak_pressure if isinstance(law, Conformal) else hertz_stress
            return peak(f, pair)
        at = self.fixed_yield if is_length else first_yield(pair, housing=self.housing).load
        return at / f


def _target(given: dict[str, float | None]) -> tuple[str, float]:
    """Return the target that is given, with its name."""
    keys = [key for key, value in given.items() if value is not None]
    names = f"{', '.join([*given][:-1])} or {[*given][-1]}"
    if len(keys) != 1:
        key = keys[1] if keys else "stiffness"
        rule = f"is given beside {keys[0]}" if keys else "is missing"
        raise InputError(_SOURCE, key, given[key], rule, f"give one of {names}")
    remedy = "give it in N/mm², mm or MPa"
    return keys[0], float(require_positive(given[keys[0]], _SOURCE, keys[0], remedy))


class _Jump(NamedTuple):
    """Where a function jumps, and its values on both sides."""

    at: float
    below: float
    above: float


def _root(
    value: Callable[[float], float], target: float, grid: FloatArray, values: FloatArray
) -> float | _Jump | tuple[float, float] | None:
    """Return the largest x at which a function has a value; else what it reaches, if anything.

    The values on the grid are those of the function up to rounding.
    """
    from scipy.optimize import brentq  # which takes longer to import than the package

    known = np.isfinite(values)
    miss = np.sign(values[known] - target)
    jump = None
    # Of several the last, of the smallest f/(E*·ΔR): others are next to a law's end.
    for k in np.flatnonzero(miss[:-1] * miss[1:] <= 0)[::-1].tolist():
        below, above = grid[known][[k, k + 1]].tolist()
        if above / below > 1 + 3 * _BESIDE:
            start, end = np.log([below, above]).tolist()
            log = brentq(lambda log: value(np.exp(log)) / target - 1, start, end, xtol=1e-14)
            x = float(np.exp(log))
            if abs(value(x) / target - 1) < _MET:
                return x
            below, above = x * (1 - _MET), x * (1 + _MET)
        jump = jump or _Jump(above, value(below), value(above))
    if jump is not None:
        return jump
    return (float(values[known].min()), float(values[known].max())) if known.any() else None


def _with(pair: CylinderPair, unknown: Unknown, x: FloatArray | float) -> CylinderPair:
    """Return a pair with another value of the unknown."""
    if unknown == "length":
        return pair
    if unknown == "clearance":
        R_j = None
        if pair.R_i is not None:
            R_j = pair.R_i - x if pair.contact == "internal" else x - pair.R_i
        return replace(pair, dR=x, R_j=R_j)
    factor = x / float(as_floats(pair.material_j.E))
    hole, pin = (scaled(body, factor) for body in (pair.material_i, pair.material_j))
    return replace(pair, material_i=hole, material_j=pin)
