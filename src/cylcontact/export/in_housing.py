"""A law in the housing of one joint as a law of δ, E* and ΔR alone, which every language takes.

With the materials and R_o/R_i given, φ = f/(E*·ΔR) is a function of d = δ/ΔR: five constants if
they follow the series within 1 %, and otherwise a table, a cubic in ln φ over ln d with the series'
slopes at its nodes. Such cubics are a sum that needs no search,

    ln φ = y₀ + s₀·(x − x₀) + Σ m²·(b + c·m),    m = max(x − x_k, 0),    x = ln d,

b and c being the jumps of the second and third derivatives at node k over 2 and 6.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws import Explicit, Housing, Sector
from cylcontact.laws.formula import Formula, Step, steps_of
from cylcontact.laws.housed import Curve, FiveConstants, series_of
from cylcontact.laws.law import ContactLaw, Law
from cylcontact.laws.tabulated import cubic
from cylcontact.support.arrays import FloatArray, as_floats

_FIVE = (
    "f = pi*E_star*penetration/L with depth = penetration/dR and "
    "L = c + ln(1 + B/depth*(ln(1 + A/depth + G/sqrt(depth)) + D))"
)
_TABLE = "f = E_star*dR*exp(y), y a cubic of x = ln(penetration/dR) between nodes"
# The error up to which five constants are exported.
_FEW = 0.01
# The largest errors of a table in load and stiffness, relative, and where it begins in ln d.
_LOAD, _STIFFNESS, _FIRST = 5e-4, 5e-3, np.log(1e-9)


@dataclass(frozen=True)
class Table(Formula):
    """A formula that is a table, as a sum over its nodes."""

    nodes: tuple[tuple[float, float, float], ...] = ()

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The assignments up to f and k, and the end."""
        x, y, slope = np.array(self.nodes).T
        width, rise = np.diff(x), np.diff(y) / np.diff(x)
        square = (3 * rise - 2 * slope[:-1] - slope[1:]) / width
        third = (slope[:-1] + slope[1:] - 2 * rise) / width**2
        square_jumps, third_jumps = (np.diff(each, prepend=0.0) for each in (square, third))
        square_jumps[1:] -= 3 * third[:-1] * width[:-1]
        lines = [
            f"last = {float(np.exp(x[-1]))!r} * dR",
            "x = log(penetration / dR)",
            f"y = {float(y[0])!r} + {float(slope[0])!r} * (x - {float(x[0])!r})",
            f"s = {float(slope[0])!r}",
        ]
        jumps = zip(x[:-1].tolist(), square_jumps.tolist(), third_jumps.tolist(), strict=True)
        for at, b, c in jumps:
            lines += [
                f"m = max(x - {at!r}, 0)",
                f"y = y + m * m * ({b!r} + {c!r} * m)",
                f"s = s + m * ({2 * b!r} + {3 * c!r} * m)",
            ]
        return steps_of("\n".join([*lines, "f = E_star * dR * exp(y)", "k = f * s / penetration"]))


@dataclass(frozen=True)
class InHousing(Law):
    """A law in the housing of one joint."""

    stated: Formula
    five: FiveConstants | None = None
    name: ClassVar[str] = "in-housing"
    contacts: ClassVar[tuple[Contact, ...]] = ("internal",)

    def formula_for(self, contact: Contact) -> Formula:  # noqa: ARG002
        """Return the formula."""
        return self.stated

    def constants_for(self, contact: Contact) -> dict[str, float]:  # noqa: ARG002
        """Return the five constants, none for a table."""
        five = {} if self.five is None else self.five._asdict()
        return {name: value for name, value in five.items() if name != "error"}


def law_in_housing(law: ContactLaw, pair: CylinderPair) -> tuple[InHousing, str]:
    """Return a law with a housing for export, and how far it is from the series, in words."""
    housing = getattr(law, "datum", None)
    assert isinstance(housing, Housing)
    series, remark = series_of(housing, pair), _remark(housing, pair)
    if isinstance(law, Explicit) and (formula := law.formula_at(pair)) is not None:
        stated = InHousing(replace(formula, equation=_FIVE), law.five_constants(pair))
        error = _error(stated, series, pair)
        if error <= _FEW:
            return _remarked(stated, remark, f"five constants, within {100 * error:.2g} percent")
    nodes = tuple(zip(*(each.tolist() for each in _thinned(series)), strict=True))
    stated = InHousing(Table(_function, end=_function, equation=_TABLE, nodes=nodes))
    error = _error(stated, series, pair)
    return _remarked(
        stated, remark, f"a table of {len(nodes)} nodes, within {100 * error:.2g} percent"
    )


def _error(law: InHousing, series: Curve, pair: CylinderPair) -> float:
    """Return the largest error of a law's load for φ from 1e-4 to 10, relative to the series."""
    last = min(np.log(10.0), series.y[-1] - 1e-9)
    d = np.exp(np.interp(np.linspace(np.log(1e-4), last, 400), series.y, series.x))
    exact = series.at(as_floats(d))[0] * float(pair.E_star * pair.dR)
    return float(np.abs(law.load(d * float(pair.dR), pair) / exact - 1).max())


def _remarked(law: InHousing, remark: str, words: str) -> tuple[InHousing, str]:
    """Return a law whose formula says what it is for and how exact it is."""
    words += " of the load by the series, for f over E_star dR from 1e-4 to 10"
    return replace(law, stated=replace(law.stated, remark=f"{remark}. It is {words}")), words


def _thinned(curve: Curve) -> Curve:
    """Return the nodes that a table needs: every interval is halved until it is close enough."""
    x, y, slopes = curve
    first, last = int(np.searchsorted(x, _FIRST)), x.size - 1
    chosen, open_ = {first, last}, [(first, last)]
    while open_:
        low, high = open_.pop()
        inside = np.arange(low + 1, high)
        width, rise = x[high] - x[low], (y[high] - y[low]) / (x[high] - x[low])
        above, slope = cubic((x[inside] - x[low]) / width, width, rise, slopes[low], slopes[high])
        far = np.abs(y[low] + above - y[inside]).max(initial=0.0) > _LOAD
        if inside.size and (far or np.abs(slope / slopes[inside] - 1).max() > _STIFFNESS):
            middle = (low + high) // 2
            chosen.add(middle)
            open_ += [(low, middle), (middle, high)]
    nodes = sorted(chosen)
    return Curve(x[nodes], y[nodes], slopes[nodes])


def _function(penetration: FloatArray, _pair: CylinderPair) -> FloatArray:
    """Stand for a table, which has no constants."""
    return penetration


def _remark(housing: Housing, pair: CylinderPair) -> str:
    """Return what the law is for."""
    hole, pin = pair.material_i, pair.material_j
    clamp = "all of its rim clamped"
    if isinstance(housing.clamp, Sector):
        angle, side = housing.clamp.angle, housing.clamp.side
        clamp = (
            f"{angle:g} degrees of its rim clamped, {side} from the load, which acts along the "
            "middle of this sector: the law is for no other direction"
        ).replace("near from", "near")
    R_i = float(np.asarray(pair.R_i))
    for material, radius in housing.layers:
        clamp += f", a ring of E = {material.E:g} MPa and nu = {material.nu:g} bonded around it "
        clamp += f"from {radius / R_i:g} R_i on"
    return (
        f"For a pin of E = {float(pin.E):g} MPa and nu = {float(pin.nu):g} in a hole of "
        f"E = {float(hole.E):g} MPa and nu = {float(hole.nu):g}, plane {pair.plane}, in a housing "
        f"of R_o/R_i = {housing.R_o / R_i:g}, {clamp}. The penetration is that of the pin's centre "
        "against the clamped rim, less the clearance"
    )
