"""A joint under a load, resolved once: every answer is computed from it.

Numbers of Python, options and rows of tables become one `LoadedJoint`. It holds the pairs at their
temperatures: one, the band of an ISO fit, or many as arrays. Nothing after it reads options again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.iso286 import IsoFit
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Conformal, ContactLaw, Housing, Johnson
from cylcontact.limits import at_temperature, hertz_half_width
from cylcontact.limits.rings import Rim
from cylcontact.support.arrays import FloatArray, as_floats, require, require_positive
from cylcontact.support.errors import InputError

__all__ = ["LoadedJoint", "resolve"]

_SOURCE = "check_joint"
# The pairs of a fit that are answered: percentiles of the produced pairs, and both ends.
BAND = ("tightest", "5 %", "middle", "95 %", "loosest")
# How much the movement of one pair of a fit may differ from that of another.
_UNLIKE = 2e-3
# How many half-widths of the contact a plane must be deep, so that its depth is a datum.
_DEEP = 10.0

Temperatures = float | tuple[float, float]


@dataclass(frozen=True, eq=False)
class LoadedJoint:
    """A joint, its surroundings and its load; `resolve` makes it from what a user gives.

    Attributes
    ----------
    drawn : CylinderPair
        The pair as on the drawing, at 20 °C; with a fit that in its middle.
    load : float or array
        Load per unit length in N/mm.
    housing : Housing or None
    iso : IsoFit or None
    depth : float or None
        The depth in mm at which a plane is held.
    temperature : (float, float) or None
        Of the pin and of the hole in °C.
    rim : str, Material or None
        What the rim of the housing does when warm.
    cold : dict of CylinderPair
        The pairs at 20 °C: "joint", or those of a fit from "tightest" to "loosest".
    pairs : dict of CylinderPair or None
        The same at their temperatures, None where there is no clearance.
    weights : dict of float
        With a fit: the weights of the pairs in the mean over all pairs.
    seized : float
        With a fit: the share of produced pairs that have no clearance.
    """

    drawn: CylinderPair
    load: FloatArray
    housing: Housing | None
    iso: IsoFit | None
    depth: float | None
    temperature: tuple[float, float] | None
    rim: Rim | None
    cold: Mapping[str, CylinderPair]
    pairs: Mapping[str, CylinderPair | None]
    weights: Mapping[str, float]
    seized: float = 0.0

    @property
    def pair(self) -> CylinderPair:
        """The pair at its temperature; with a fit the middle one, or the loosest if that seizes."""
        pairs = self.pairs
        pair = pairs["joint"] if self.iso is None else pairs["middle"] or pairs["loosest"]
        assert pair is not None
        return pair

    @cached_property
    def law(self) -> ContactLaw:
        """The most exact law of the joint."""
        return law_of(self.drawn, self.housing, self.depth)

    @property
    def has_penetration(self) -> bool:
        """Whether the penetration is defined: for a plane it needs the depth."""
        return not self.drawn.is_flat or self.depth is not None

    def solved(self) -> Iterator[tuple[str, CylinderPair]]:
        """Yield the pairs that have a clearance, with their names."""
        for name, pair in self.pairs.items():
            if pair is not None:
                yield name, pair


def law_of(pair: CylinderPair, housing: Housing | None, depth: float | None) -> ContactLaw:
    """Return the most exact law of a pair."""
    if pair.contact == "internal":
        return Conformal(housing or "johnson")
    return Johnson(datum=depth)


def resolve(
    pair: CylinderPair,
    load: ArrayLike,
    *,
    housing: Housing | None = None,
    iso: IsoFit | str | None = None,
    depth: float | None = None,
    temperature: Temperatures | None = None,
    rim: Rim | None = None,
) -> LoadedJoint:
    """Return the joint that is asked about; the arguments are those of `check_joint`.

    Raises
    ------
    InputError
        If arguments contradict each other, the error names both.
    """
    remedy = "build one with CylinderPair.internal or .external; a fit such as 20H7/g6 is iso"
    require(isinstance(pair, CylinderPair), _SOURCE, "pair", pair, "must be a CylinderPair", remedy)
    force = require_positive(load, _SOURCE, "load", "give it in N/mm")
    is_pin = pair.contact == "internal"
    of_pin = {"housing": housing, "iso": iso, "temperature": temperature, "rim": rim}
    for key, value in of_pin.items():
        rule, remedy = "is for a pin in a hole, and contact is external", "leave it out"
        require(is_pin or value is None, _SOURCE, key, value, rule, remedy)
    require(
        depth is None or pair.is_flat, _SOURCE, "depth", depth,
        "is for a plane, R_j = inf", "leave it out, or give that radius (--Rj inf)",
    )  # fmt: skip
    require(
        rim is None or temperature is not None, _SOURCE, "rim", rim,
        "is for a temperature, which is missing", "give the temperature too, or leave it out",
    )  # fmt: skip
    warm = None if temperature is None else _both(temperature)
    if iso is None:
        pair.radii("a joint")
        whole = LoadedJoint(
            pair, force, housing, None, depth, warm, rim, {"joint": pair}, {}, {"joint": 1.0}
        )
        joint = replace(whole, pairs={"joint": warmed(pair, whole)})
    else:
        joint = _of_fit(pair, force, housing, iso, warm, rim)
    _require_deep(joint)
    return joint


def _both(temperature: Temperatures | Sequence[float]) -> tuple[float, float]:
    """Return the temperatures of pin and hole, one for both or each."""
    values = np.atleast_1d(np.asarray(temperature, dtype=float))
    rule, remedy = "must be one number or two, (pin, hole)", "give them in °C, e.g. 80.0"
    good = values.size in (1, 2) and bool(np.isfinite(values).all())
    require(good, _SOURCE, "temperature", temperature, rule, remedy)
    return float(values[0]), float(values[-1])


def warmed(pair: CylinderPair, joint: LoadedJoint) -> CylinderPair:
    """Return a pair at the temperatures of a joint."""
    if joint.temperature is None:
        return pair
    pin, hole = joint.temperature
    return at_temperature(pair, pin, hole, housing=joint.housing, rim=joint.rim)


def _of_fit(
    pair: CylinderPair,
    load: FloatArray,
    housing: Housing | None,
    iso: IsoFit | str,
    temperature: tuple[float, float] | None,
    rim: Rim | None,
) -> LoadedJoint:
    """Return the joint whose clearance is that of a fit."""
    fit = IsoFit.read(iso, _SOURCE, "iso") if isinstance(iso, str) else iso
    rule, remedy = "leaves no clearance at any pair", "choose a looser pin: h, g"
    require(fit.clearance[1] > 0, _SOURCE, "iso", fit.code, rule, remedy)
    drawn = with_radii(pair, *fit.middle)
    joint = LoadedJoint(drawn, load, housing, fit, None, temperature, rim, {}, {}, {})
    loosest = with_radii(pair, *fit.radii(1.0))
    # A change of temperature moves all clearances of a fit by the same, but for a part in 1000.
    moved = as_floats(warmed(loosest, joint).dR) - as_floats(loosest.dR)
    spread = fit.shares(above=-float(moved))
    places = {"tightest": 0.0, "middle": 0.5, "loosest": 1.0}
    places |= {f"{percent} %": spread.percentile(percent) for percent in (5, 95)}
    cold = {name: with_radii(pair, *fit.radii(places[name])) for name in BAND}
    pairs: dict[str, CylinderPair | None] = {}
    low, high = fit.clearance
    for name in BAND:
        gap = low + places[name] * (high - low) + moved
        has_clearance = gap > (-1e-12 if moved == 0 else _UNLIKE * abs(moved))
        pairs[name] = warmed(cold[name], joint) if has_clearance else None
    known = [name for name, each in pairs.items() if each is not None]
    weights = spread.weights([places[name] for name in known]).tolist()
    return replace(
        joint,
        cold=cold,
        pairs=pairs,
        weights=dict(zip(known, weights, strict=True)),
        seized=spread.below,
    )


def with_radii(pair: CylinderPair, R_i: ArrayLike, R_j: ArrayLike) -> CylinderPair:
    """Return a pair with other radii."""
    hole, pin = as_floats(R_i), as_floats(R_j)
    if hole.ndim == 0:
        hole, pin = float(hole), float(pin)  # type: ignore[assignment]
    return replace(pair, dR=hole - pin, R_i=hole, R_j=pin)


def _require_deep(joint: LoadedJoint) -> None:
    """Raise `InputError` if a plane is held within ten half-widths of the contact."""
    if joint.depth is None:
        return
    require_positive(joint.depth, _SOURCE, "depth", "give it in mm")
    width = float(np.max(hertz_half_width(joint.load, joint.pair)))
    if joint.depth < _DEEP * width:
        rule = f"must be at least ten half-widths of the contact, which is {width:.3g} mm"
        remedy = f"give {_DEEP * width:.3g} mm or more, or leave it out: pressure needs no depth"
        raise InputError(_SOURCE, "depth", joint.depth, rule, remedy)
