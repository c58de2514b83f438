"""A bush that is pressed into a lug or a ring: from the drawing to clearance, seat and first yield.

The rings at rest (`cylcontact.limits.rings`) give how far the bore closes in, the pressure of the
seat and the stress before any load; the law of conformal contact with a seat that slides or is
bonded gives what the load adds. Friction decides how far a seat slides, and no one knows it: so
both are answered, and each yield is the lower of the two.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cylcontact.bodies.iso286 import diameters
from cylcontact.bodies.material import Material, is_known_at
from cylcontact.bodies.pair import CylinderPair, Plane
from cylcontact.files.writing import json_text
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.limits import AtRest, at_rest, at_temperature, first_yields, loose_temperatures
from cylcontact.limits import seat_opens as opening_load
from cylcontact.limits.housing_stress import largest_hoop_in
from cylcontact.limits.rings import Rim
from cylcontact.limits.yield_search import FirstYield
from cylcontact.support.arrays import FloatArray, as_floats, require, require_positive
from cylcontact.support.errors import InputError
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.joint.page import Page, Source

__all__ = ["Bush", "BushCheck", "BushNumbers", "check_bush"]

Limits = str | float | tuple[float, float]

_SOURCE = "bush"
# Of the clearance: the least, percentiles of produced joints, the middle, the largest.
COLUMNS = ("least", "5 %", "middle", "95 %", "most")
# Sizes without limits are one joint; seats may be tighter or looser than those of the band.
_ALONE, _TIGHTEST, _LOOSEST = "joint", "tightest seat", "loosest seat"
_ANSWERED = ("least", "middle", "most", _ALONE, _TIGHTEST, _LOOSEST)
# The standard normal distribution at 95 %, and the standard deviation of one that is cut off at ±3.
_AT_95, _CUT_OFF = 1.6448536, 0.98658
# Materials below this modulus are taken for polymers, whose stress at rest relaxes.
_POLYMERS = 20e3  # MPa
# A nominal interference, by which the close-in factor is computed: it is linear.
_UNIT = 1e-3  # mm
# A seat with less pressure than this is loose.
_LOOSE = 1e-9  # MPa
BODIES = ("bush", "housing", "pin")
NOT_INCLUDED = (
    "wear, p·v limits, fatigue, the ultimate load of the lug, friction in the seat, bending of the "
    "pin, tilt, plastic flow"
)


class Sizes(NamedTuple):
    """Limits of diameters in mm, and of the wall if the bore is not given."""

    hole: tuple[float, float]
    outer: tuple[float, float]
    bore: tuple[float, float] | None
    wall: tuple[float, float] | None


@dataclass(frozen=True)
class Bush:
    """A bush before it is pressed in.

    Parameters
    ----------
    material : Material
    seat : str, or (hole, outer)
        The ISO fit of hole and bush, as "26H7/s6", or the diameter of the hole that the bush is
        pressed into and the outer diameter of the bush, each a number in mm, a pair of limits, or
        a class such as "26H7".
    bore : str, float or (float, float), optional
        The diameter of the bore before pressing, as for the seat.
    wall : float or (float, float), optional
        The thickness of the wall in mm, in place of the bore.
    wrapped : bool
        A bush that is rolled of strip, with a gap. It yields when it is pressed in, and its bore
        closes in by all of the interference, as catalogues say.

    Raises
    ------
    InputError
        If a size cannot be read, bore and wall are both given or both missing, the seat has no
        interference in its middle, or the wall is not positive.

    Examples
    --------
    >>> bush = Bush(Material.named("bronze"), seat="26H7/s6", bore="20E6")
    >>> print(bush)
    bronze bush, bore 20E6, seat 26H7/s6 (interference 7 to 24 µm on the radius)
    """

    material: Material
    seat: str | tuple[Limits, Limits]
    bore: Limits | None = None
    wall: Limits | None = None
    wrapped: bool = False

    def __post_init__(self) -> None:
        rule = "is missing" if self.bore is None else "is given, and the wall too"
        one = (self.bore is None) != (self.wall is None)
        require(one, _SOURCE, "bore", self.bore, rule, "give the bore before pressing, or the wall")
        sizes = self.sizes
        low, high = self.interference
        rule = f"has no interference in its middle: {1e3 * low:.3g} to {1e3 * high:.3g} µm"
        remedy = "choose a tighter bush, p6 to u6; a bush that is glued in is a bonded layer"
        require(low + high > 0, _SOURCE, "seat", self.seat, rule, remedy)
        inner = sizes.bore or (sizes.outer[0] - 2 * sizes.wall[1], sizes.outer[0])  # type: ignore[index]
        rule, remedy = "leaves no wall", "check the diameters; the wall is half their difference"
        require(0 < inner[0] and inner[1 if sizes.bore else 0] < sizes.outer[0], _SOURCE, "bore",
                self.bore if self.wall is None else self.wall, rule, remedy)  # fmt: skip

    @property
    def sizes(self) -> Sizes:
        """The limits of the diameters in mm, or of the wall."""
        seat = self.seat
        if isinstance(seat, str):
            hole, slash, outer = seat.partition("/")
            rule, remedy = "is not an ISO fit", 'write hole and bush, "26H7/s6"'
            require(bool(slash), _SOURCE, "seat", seat, rule, remedy)
            nominal = hole.strip().rstrip("0123456789").rstrip("ABCDEFGHIJKLMNOPQRSTUVXYZ")
            seat = (hole.strip(), f"{nominal}{outer.strip()}")
        rule, remedy = "must be a fit or two diameters", 'e.g. "26H7/s6", or (26.0, 26.03)'
        require(len(seat) == 2, _SOURCE, "seat", seat, rule, remedy)
        return Sizes(
            limits_of(seat[0], "seat"),
            limits_of(seat[1], "seat"),
            None if self.bore is None else limits_of(self.bore, "bore"),
            None if self.wall is None else limits_of(self.wall, "wall"),
        )

    @property
    def interference(self) -> tuple[float, float]:
        """The least and the largest interference of the seat in mm, on the radius."""
        sizes = self.sizes
        return (sizes.outer[0] - sizes.hole[1]) / 2, (sizes.outer[1] - sizes.hole[0]) / 2

    def __str__(self) -> str:
        low, high = (1e3 * each for each in self.interference)
        inner = f"bore {shown(self.bore)}" if self.wall is None else f"wall {shown(self.wall)}"
        seat = self.seat if isinstance(self.seat, str) else " / ".join(map(shown, self.seat))
        kind = "wrapped " if self.wrapped else ""
        return (
            f"{kind}{self.material.title} bush, {inner}, seat {seat} "
            f"(interference {_text(low, 2)} to {_text(high, 2)} µm on the radius)"
        )


def limits_of(size: Limits, key: str, source: str = _SOURCE) -> tuple[float, float]:
    """Return the least and the largest size in mm of a number, a pair of limits, or a class."""
    if isinstance(size, str):
        return diameters(size, source, key)
    values = np.ravel(np.asarray(size, dtype=float))
    rule, remedy = (
        "must be a size, or a lower and an upper limit",
        "give it in mm, e.g. [26, 26.02]",
    )
    sound = values.size in (1, 2) and bool(np.all(np.isfinite(values) & (values > 0)))
    require(sound and values[0] <= values[-1], source, key, size, rule, remedy)
    return float(values[0]), float(values[-1])


def shown(size: Limits | None) -> str:
    """Return a size as it is on a drawing."""
    if isinstance(size, str) or size is None:
        return size or ""
    return " to ".join(f"{each:g}" for each in np.unique(np.ravel(size)).tolist())


class Fitted(NamedTuple):
    """One joint of the band at 20 °C: radii of bore and pin, and interference, in mm."""

    bore: float
    pin: float
    interference: float

    @property
    def clearance(self) -> float:
        """The radial clearance in mm after pressing."""
        return self.bore - self.pin


def fitted(
    bush: Bush, pin_diameter: Limits, hole: Material, housing: Housing, rim: Rim | None = None
) -> tuple[float, dict[str, Fitted]]:
    """Return the close-in factor of a pressed bush, and the joints of its band.

    Parameters
    ----------
    bush, pin_diameter, hole, housing, rim
        As for `check_bush`.

    Returns
    -------
    close_in : float
        By how much of the interference the bore closes in; 1 for a wrapped bush.
    band : dict of Fitted
        As in `BushCheck.band`.

    Examples
    --------
    >>> bronze, steel = map(Material.named, ("bronze", "low-carbon steel"))
    >>> bush = Bush(bronze, seat="26H7/s6", bore="20E6")
    >>> close_in, band = fitted(bush, "20f7", steel, Housing(26.0), "free")
    >>> print(f"{close_in:.3f}: {2e3 * band['middle'].clearance:.0f} µm on the diameter")
    0.813: 52 µm on the diameter
    """
    rule, remedy = "has layers, and the bush is one", "give the part around the bush alone"
    alone = not housing.layers and housing.g is None
    require(alone, _SOURCE, "housing", str(housing), rule, remedy)
    outer = bush.sizes.hole[1] / 2
    rule = f"must have its rim outside the seat, whose radius is {outer:g} mm"
    remedy = "give R_o, the outer radius of the part around the bush"
    require(housing.R_o > 1.02 * outer, _SOURCE, "housing", housing.R_o, rule, remedy)
    joint = _Joint(bush, hole, housing, _rim_of(housing, rim))
    columns = _columns(bush.sizes, limits_of(pin_diameter, "pin"), joint.close_in)
    widest = max(each.clearance for each in columns.values())
    rule = "leaves no clearance at any joint"
    require(widest > 0, _SOURCE, "pin", pin_diameter, rule, "choose a looser pin")
    return joint.close_in, columns


def _rim_of(housing: Housing, rim: Rim | None) -> Rim:
    """Return what the rim does at rest: it is free where the housing is clamped on a sector."""
    if rim is None and isinstance(housing.clamp, Sector):
        return "free"
    rule, remedy = "is missing for a rim that is clamped all round", "give free, held or a material"
    require(rim is not None, _SOURCE, "rim", None, rule, remedy)
    assert rim is not None
    return rim


@dataclass(frozen=True)
class BushNumbers:
    """Results for one joint of the band; NaN if unknown.

    Attributes
    ----------
    bore_mm : float
        The diameter of the bore after pressing, at 20 °C.
    interference_um : float
        On the radius, at 20 °C.
    seat_pressure_MPa, warm_seat_pressure_MPa : float
        At 20 °C and at the joint's temperature.
    clearance_um, diametral_clearance_um : float
        Between bore and pin, at the joint's temperature.
    sliding_penetration_um, bonded_penetration_um, peak_pressure_MPa, projected_pressure_MPa : float
        Under the load; the peak is the larger one of both seats.
    hoop_MPa : float
        The largest hoop stress of the housing under the load, of both seats.
    seat_opens_N_per_mm : float
        The load from which the seat opens, the lower one of both seats; inf for none.
    bush_yield_N_per_mm, housing_yield_N_per_mm, pin_yield_N_per_mm : float
        First yield by von Mises, the lowest of both seats and, for polymers, of with and without
        the stress at rest.
    """

    bore_mm: float = np.nan
    interference_um: float = np.nan
    seat_pressure_MPa: float = np.nan
    warm_seat_pressure_MPa: float = np.nan
    clearance_um: float = np.nan
    diametral_clearance_um: float = np.nan
    sliding_penetration_um: float = np.nan
    bonded_penetration_um: float = np.nan
    peak_pressure_MPa: float = np.nan
    projected_pressure_MPa: float = np.nan
    hoop_MPa: float = np.nan
    seat_opens_N_per_mm: float = np.nan
    bush_yield_N_per_mm: float = np.nan
    housing_yield_N_per_mm: float = np.nan
    pin_yield_N_per_mm: float = np.nan


_ROWS = {
    "bore after pressing, mm": "bore_mm",
    "interference on the radius, µm": "interference_um",
    "pressure of the seat, MPa": "seat_pressure_MPa",
    "the same, warm, MPa": "warm_seat_pressure_MPa",
    "radial clearance, µm": "clearance_um",
    "diametral clearance, µm": "diametral_clearance_um",
    "penetration, seat slides, µm": "sliding_penetration_um",
    "penetration, seat sticks, µm": "bonded_penetration_um",
    "peak pressure, MPa": "peak_pressure_MPa",
    "projected pressure, MPa": "projected_pressure_MPa",
    "hoop stress of the housing, MPa": "hoop_MPa",
    "first yield of the bush, N/mm": "bush_yield_N_per_mm",
    "first yield of the housing, N/mm": "housing_yield_N_per_mm",
    "first yield of the pin, N/mm": "pin_yield_N_per_mm",
    "the seat opens at, N/mm": "seat_opens_N_per_mm",
}


@dataclass(frozen=True, eq=False)
class BushCheck:
    """A joint with a bush under a load, and its answer; `check_bush` makes it.

    Attributes
    ----------
    bush, pin, pin_diameter, hole, housing, load, length, plane, temperature, rim
        The joint, as it was given.
    close_in : float
        By how much of the interference the bore closes in.
    loose_at : float
        The temperature in °C of the whole joint at which the loosest seat comes loose, or inf.
    band : dict of BushNumbers
        For "least", "5 %", "middle", "95 %" and "most" of the clearance at 20 °C, and for the
        "tightest seat" and the "loosest seat" if they are in none of these; "joint" alone for sizes
        without limits.
    yields : dict of dict of (FirstYield, str)
        The first yield of "bush", "housing" and "pin" in each column, and of which seat it is.
    """

    bush: Bush
    pin: Material
    pin_diameter: Limits
    hole: Material
    housing: Housing
    load: float
    length: float | None
    plane: Plane
    temperature: tuple[float, float]
    rim: Rim
    close_in: float
    loose_at: float
    band: dict[str, BushNumbers]
    yields: dict[str, dict[str, tuple[FirstYield, str]]]

    @property
    def worst(self) -> tuple[str, str, float]:
        """The body and the column that yield first, and the factor on the load."""
        loads = [
            (float(at.load), body, column)
            for column, bodies in self.yields.items()
            for body, (at, _) in bodies.items()
            if not np.isnan(at.load)
        ]
        if not loads:
            return "", "", np.nan
        load, body, column = min(loads)
        return body, column, load / self.load

    def factor(self, body: str) -> float:
        """Return the lowest first yield of a body over the load; NaN if it is not known."""
        loads = [float(each[body][0].load) for each in self.yields.values() if body in each]
        known = [load for load in loads if not np.isnan(load)]
        return min(known) / self.load if known else np.nan

    @property
    def is_warm(self) -> bool:
        """Whether the joint has another temperature than 20 °C."""
        return self.temperature != (20.0, 20.0)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong or doubtful, a sentence each."""
        return tuple(_warnings(self))

    @property
    def table(self) -> pd.DataFrame:
        """The numbers as a table: a row for each, a column for each joint of the band."""
        import pandas as pd

        return pd.DataFrame({name: asdict(numbers) for name, numbers in self.band.items()})

    def __str__(self) -> str:
        parts = [*_described(self), "", str(TextTable(*_cells(self))), "", *_summary(self)]
        return "\n".join([*parts, "", f"not included  {NOT_INCLUDED}"])

    def _repr_html_(self) -> str:
        return TextTable(*_cells(self), _described(self)[0])._repr_html_()

    def to_dict(self) -> dict[str, Any]:
        """Return the joint and its numbers under plain names, for JSON; None for the unknown."""
        body, column, factor = self.worst
        return {
            "bush": str(self.bush),
            "pin": self.pin.title,
            "pin_diameter_mm": list(limits_of(self.pin_diameter, "pin")),
            "hole": self.hole.title,
            "housing": str(self.housing),
            "load_N_per_mm": self.load,
            "length_mm": self.length,
            "plane": self.plane,
            "temperature_C": list(self.temperature),
            "close_in": self.close_in,
            "loose_at_C": _finite(self.loose_at),
            "worst": {"body": body, "column": column, "factor": _finite(factor)},
            "factors": {each: _finite(self.factor(each)) for each in BODIES},
            "warnings": list(self.warnings),
            "not_included": NOT_INCLUDED,
            "numbers": {
                name: {key: _finite(value) for key, value in asdict(numbers).items()}
                for name, numbers in self.band.items()
            },
        }

    def to_json(self) -> str:
        """Return `to_dict` as JSON."""
        return json_text(self.to_dict())

    def save(self, path: Path | str) -> Path:
        """Write the answer on one page, .html, .pdf or .png."""
        from cylcontact.joint.page import write_page

        return write_page(_page(self), path)


def check_bush(
    bush: Bush,
    pin: Material,
    pin_diameter: Limits,
    hole: Material,
    housing: Housing,
    load: float,
    *,
    length: float | None = None,
    plane: Plane = "strain",
    temperature: float | tuple[float, float] = 20.0,
    rim: Rim | None = None,
) -> BushCheck:
    """Check a joint with a pressed bush: clearance, seat, penetration, first yield of each body.

    Parameters
    ----------
    bush : Bush
    pin : Material
    pin_diameter : str, float or (float, float)
        In mm, or a class such as "20f7".
    hole : Material
        Of the part that the bush is pressed into.
    housing : Housing
        That part: its outer radius and its clamp, without layers.
    load : float
        Load per unit length in N/mm.
    length : float, optional
        Axial length in mm.
    plane : {"strain", "stress"}
        For the load. At rest the ends of all parts are free.
    temperature : float or (float, float)
        Of the joint, or of the pin and of all other parts, in °C.
    rim : "free", "held" or Material, optional
        What the outer rim does when the bush is pressed in or warms up. It is free by
        default where the housing is clamped on a sector, and has to be given for a whole rim.

    Returns
    -------
    BushCheck

    Raises
    ------
    InputError
        If a size or a number cannot be used, or the pin does not fit in any bush.

    Notes
    -----
    Each diameter is normally distributed around the middle of its limits, which are 3 standard
    deviations away. The percentiles take the slopes of the clearance in the middle, which are exact
    if every pair interferes. A wrapped bush yields when it is pressed in. Its seat then has at most
    the pressure at which it is plastic throughout, (2/√3)·σ_Y·ln(outer/bore).

    Examples
    --------
    >>> bronze, steel, hard = map(
    ...     Material.named, ("bronze", "low-carbon steel", "high-strength steel")
    ... )
    >>> bush, lug = Bush(bronze, seat=(26.0, 26.03), bore=20.04), Housing(26.0, Sector.lug())
    >>> check = check_bush(bush, hard, 19.97, steel, lug, 500.0, plane="stress")
    >>> clearance = check.band["joint"].clearance_um
    >>> print(f"{clearance:.1f} µm, factor {check.factor('housing'):.2f} of the lug")
    22.8 µm, factor 3.01 of the lug
    """
    require_positive(load, _SOURCE, "load", "give it in N/mm")
    close_in, columns = fitted(bush, pin_diameter, hole, housing, rim)
    values = np.ravel(np.asarray(temperature, dtype=float))
    rule, remedy = "must be one number or two, (pin, hole)", "give them in °C, e.g. 80.0"
    require(values.size in (1, 2), _SOURCE, "temperature", temperature, rule, remedy)
    warm = float(values[0]), float(values[-1])
    state = _rim_of(housing, rim)
    joint = _Joint(bush, hole, housing, state)
    under = _Load(joint, pin, float(load), length, plane, warm)
    band, yields = {}, {}
    for name, drawn in columns.items():
        band[name], yields[name] = under.solved(drawn, name in _ANSWERED)
    low, _ = bush.interference
    loose = np.inf
    if joint.expands and low > 0:
        loose = float(loose_temperatures(joint.materials, joint.radii, low, state)[0])
    return BushCheck(
        bush, pin, pin_diameter, hole, housing, float(load), length, plane, warm, state, close_in,
        20.0 + loose, band, {name: each for name, each in yields.items() if each},
    )  # fmt: skip


def _columns(sizes: Sizes, pins: tuple[float, float], close_in: float) -> dict[str, Fitted]:
    """Return the joints of the band, from the least clearance to the largest."""
    given = (sizes.hole, sizes.outer, pins, sizes.bore or sizes.wall)
    limits = np.array(given)

    def drawn(values: FloatArray) -> Fitted:
        hole, outer, pin, inner = values.tolist()
        interference = (outer - hole) / 2
        before = outer / 2 - inner if sizes.bore is None else inner / 2
        return Fitted(before - close_in * max(interference, 0.0), pin / 2, interference)

    corners = [drawn(np.array(each)) for each in itertools.product(*limits)]
    # Of corners with one clearance the least has the tighter seat, and the most the looser one.
    least = min(corners, key=lambda each: (round(each.clearance, 12), -each.interference))
    most = max(corners, key=lambda each: (round(each.clearance, 12), -each.interference))
    middle, sigma = limits.mean(axis=1), _CUT_OFF * np.diff(limits)[:, 0] / 6
    step = np.diag(np.maximum(sigma, _UNIT * 1e-3))
    slopes = [
        (drawn(middle + each).clearance - drawn(middle - each).clearance) / (2 * each.max())
        for each in step
    ]
    spread = np.array(slopes) * sigma
    total = float(np.hypot.reduce(spread)) or 1.0
    # The most likely sizes of joints whose clearance is at the percentile.
    way = _AT_95 * spread * sigma / total
    found = {
        "least": least,
        "5 %": drawn(middle - way),
        "middle": drawn(middle),
        "95 %": drawn(middle + way),
        "most": most,
    }
    if not np.any(sigma):
        return {_ALONE: found["middle"]}
    seats = [each.interference for each in found.values()]
    tightest, loosest = (
        max(corners, key=lambda each: (round(sign * each.interference, 12), each.clearance))
        for sign in (1, -1)
    )
    if tightest.interference > max(seats) + 1e-9:
        found[_TIGHTEST] = tightest
    if loosest.interference < min(seats) - 1e-9:
        found[_LOOSEST] = loosest
    return found


@dataclass(frozen=True, eq=False)
class _Joint:
    """The rings of all joints of the band."""

    bush: Bush
    hole: Material
    housing: Housing
    rim: Rim

    @property
    def materials(self) -> list[Material]:
        return [self.bush.material, self.hole]

    @property
    def radii(self) -> list[float]:
        """Bore, seat and rim in mm: middles of the limits."""
        sizes = self.bush.sizes
        seat = sum(sizes.hole) / 4
        inner = sum(sizes.bore) / 4 if sizes.bore else seat - sum(sizes.wall or (0.0, 0.0)) / 2
        return [inner, seat, self.housing.R_o]

    @property
    def expands(self) -> bool:
        """Whether the expansion of all rings is known."""
        rings = [*self.materials, *([self.rim] if isinstance(self.rim, Material) else [])]
        return all(x.thermal_expansion is not None and is_known_at(x, 1.0) for x in rings)

    @property
    def close_in(self) -> float:
        """By how much of the interference the bore closes in."""
        if self.bush.wrapped:
            return 1.0
        return float(-at_rest(self.materials, self.radii, _UNIT, 0.0, self.rim).bore) / _UNIT

    def at_rest(self, drawn: Fitted, warmer: float) -> AtRest:
        """Return the state of a seat; that of a wrapped bush has no more than plastic pressure."""
        yields, radii = self.bush.material.yield_stress, [drawn.bore, *self.radii[1:]]
        interference = max(drawn.interference, 0.0)
        if self.bush.wrapped and yields is not None and interference > 0:
            plastic = 2 / np.sqrt(3) * yields * np.log(radii[1] / radii[0])
            cold = at_rest(self.materials, radii, interference, 0.0, self.rim)
            interference *= min(1.0, plastic / float(cold.pressures[0]))
        return at_rest(self.materials, radii, interference, warmer, self.rim)


@dataclass(frozen=True, eq=False)
class _Load:
    """What all joints of the band are under."""

    joint: _Joint
    pin: Material
    load: float
    length: float | None
    plane: Plane
    temperature: tuple[float, float]

    def solved(
        self, drawn: Fitted, answered: bool
    ) -> tuple[BushNumbers, dict[str, tuple[FirstYield, str]]]:
        """Return the numbers of a joint, and the first yields if it is to be answered."""
        joint = self.joint
        warmer = self.temperature[1] - 20.0
        state = joint.at_rest(drawn, warmer)
        numbers = BushNumbers(
            bore_mm=2 * drawn.bore,
            interference_um=1e3 * drawn.interference,
            seat_pressure_MPa=float(joint.at_rest(drawn, 0.0).pressures[0]),
            warm_seat_pressure_MPa=float(state.pressures[0]) if warmer else np.nan,
        )
        pair = self._pair(drawn)
        if pair is None:
            return numbers, {}
        clearance = 1e3 * float(pair.dR)
        numbers = replace(numbers, clearance_um=clearance, diametral_clearance_um=2 * clearance)
        if not answered or bool(state.open[0]) or drawn.interference <= 0:
            return numbers, {}
        seats = {
            seat: Housing(
                joint.housing.R_o, joint.housing.clamp, [(joint.hole, joint.radii[1])], seat=seat
            )
            for seat in ("sliding", "bonded")
        }
        laws = {seat: Conformal(each) for seat, each in seats.items()}
        depths = {seat: 1e3 * float(law.penetration(self.load, pair)) for seat, law in laws.items()}
        yields = self._yields(pair, seats, state)
        numbers = replace(
            numbers,
            sliding_penetration_um=depths["sliding"],
            bonded_penetration_um=depths["bonded"],
            peak_pressure_MPa=max(
                float(law.peak_pressure(self.load, pair)) for law in laws.values()
            ),
            projected_pressure_MPa=self.load / (2 * float(as_floats(pair.R_j))),
            hoop_MPa=max(
                float(largest_hoop_in(each, pair, self.load, state)) for each in seats.values()
            ),
            seat_opens_N_per_mm=min(
                float(opening_load(pair, each, state)) for each in seats.values()
            ),
            **{f"{body}_yield_N_per_mm": float(at.load) for body, (at, _) in yields.items()},
        )
        return numbers, yields

    def _pair(self, drawn: Fitted) -> CylinderPair | None:
        """Return pin and bush at their temperatures; None without clearance."""
        joint = self.joint
        if drawn.clearance <= 0:
            return None
        pair = CylinderPair.internal(
            drawn.bore, drawn.pin, pin=self.pin, hole=joint.bush.material, length=self.length,
            plane=self.plane,
        )  # fmt: skip
        if self.temperature == (20.0, 20.0):  # no expansion has to be known
            return pair
        ring = Housing(joint.housing.R_o, joint.housing.clamp, [(joint.hole, joint.radii[1])])
        try:
            return at_temperature(
                pair, *self.temperature, housing=ring, rim=joint.rim,
                interference=max(drawn.interference, 0.0),
            )  # fmt: skip
        except InputError as error:
            if not error.rule.startswith("seizes the pin"):
                raise
            return None

    def _yields(
        self, pair: CylinderPair, seats: Mapping[str, Housing], state: AtRest
    ) -> dict[str, tuple[FirstYield, str]]:
        """Return the lowest first yield of each body, and of what it is."""
        joint = self.joint
        cases = {f"seat {seat}": (each, state) for seat, each in seats.items()}
        if float(np.max(joint.bush.material.E)) < _POLYMERS:
            for seat, each in seats.items():
                cases[f"seat {seat}, stress at rest relaxed"] = each, None  # type: ignore[assignment]
        found: dict[str, tuple[FirstYield, str]] = {}
        for name, (housing, rest) in cases.items():
            for body, at in zip(BODIES, first_yields(pair, housing, rest), strict=True):
                if body == "bush" and joint.bush.wrapped:
                    continue  # it yields when it is pressed in
                if np.isnan(at.load):
                    continue
                if body not in found or at.load < found[body][0].load:
                    found[body] = at, name
        return found


# --- the text -------------------------------------------------------------------------------------


def _described(check: BushCheck) -> list[str]:
    """Return the joint and its load in some lines."""
    pin, hole = check.temperature
    warm = f"at {pin:g} °C" if pin == hole else f"pin at {pin:g} °C, bush at {hole:g} °C"
    rim = f"in a frame of {check.rim.title}" if isinstance(check.rim, Material) else f"{check.rim}"
    total = ""
    if check.length:
        total = f" ({_text(check.load * check.length)} N on {check.length:g} mm)"
    return [
        str(check.bush),
        f"in {check.hole.title}, {str(check.housing).partition(' (as ')[0]}; rim at rest: {rim}",
        f"{check.pin.title} pin {shown(check.pin_diameter)}, plane {check.plane}, {warm}",
        f"under {_text(check.load)} N/mm{total}",
    ]


def _cells(check: BushCheck) -> tuple[list[str], list[list[str]]]:
    """Return the headings and the rows of the answer."""
    rows = []
    for name, key in _ROWS.items():
        values = [getattr(numbers, key) for numbers in check.band.values()]
        if not all(np.isnan(values)):
            digits = 7 if key == "bore_mm" else 4
            rows.append(
                [name, *("-" if np.isnan(each) else _text(each, digits) for each in values)]
            )
    return ["", *check.band], rows


def _summary(check: BushCheck) -> list[str]:
    """Return close-in factor, temperatures of the seat and factors in words."""
    lines = [f"close-in of the bore  {check.close_in:.3g} of the interference"]
    if np.isfinite(check.loose_at):
        side = "below" if check.loose_at < 20 else "above"
        lines.append(f"the seat is loose     {side} {check.loose_at:.0f} °C")
    for body in BODIES:
        found = [
            (float(at.load), name, at, seat)
            for name, bodies in check.yields.items()
            for key, (at, seat) in bodies.items()
            if key == body
        ]
        if not found:
            lines.append(f"first yield of the {body:<8}{_why_unknown(check, body)}")
            continue
        load, name, at, seat = min(found, key=lambda each: each[0])
        place = f", {float(at.angle):.0f}° from the load" if float(at.angle) >= 0.5 else ""
        lines.append(
            f"first yield of the {body:<8}{_text(load)} N/mm ({name}, {seat}{place}), "
            f"factor {load / check.load:.3g}"
        )
    return lines


def _why_unknown(check: BushCheck, body: str) -> str:
    """Return why a body has no first yield."""
    if body == "bush" and check.bush.wrapped:
        return "it yields when it is pressed in"
    bodies = {"bush": check.bush.material, "housing": check.hole, "pin": check.pin}
    if bodies[body].yield_stress is None:
        return "the yield stress is not given"
    return "not reached with a seat that is closed and a pin that touches along one arc"


def _warnings(check: BushCheck) -> list[str]:
    """Return what is wrong or doubtful, a sentence each."""
    found = [*_about_seat(check), *_about_yield(check)]
    if float(np.max(check.bush.material.E)) < _POLYMERS:
        found.append(
            "a polymer relaxes: its seat loses pressure in time, and each yield is the lower one "
            "of with and without the stress at rest"
        )
    return found


def _about_seat(check: BushCheck) -> list[str]:
    """Return what is doubtful about seat and clearance."""
    found = []
    hot = check.temperature[1]
    low, _ = check.bush.interference
    if low <= 0:
        found.append(f"some bushes have no interference ({1e3 * low:.3g} µm on the radius)")
    key = "seat_pressure_MPa" if hot == 20 else "warm_seat_pressure_MPa"
    loose = [name for name, numbers in check.band.items() if getattr(numbers, key) <= _LOOSE]
    if loose:
        names = ", ".join(loose)
        found.append(f"the bush is loose at {hot:g} °C ({names}): no law here holds then")
    tight = [name for name, numbers in check.band.items() if np.isnan(numbers.clearance_um)]
    if tight:
        found.append(f"there is no clearance for the pin ({', '.join(tight)})")
    opens = [numbers.seat_opens_N_per_mm for numbers in check.band.values()]
    least = min((each for each in opens if not np.isnan(each)), default=np.inf)
    if check.load > least:
        found.append(
            f"the load is above {_text(least)} N/mm, from which the loosest seat opens on one "
            "side: neither a sliding nor a bonded seat describes it"
        )
    return found


def _about_yield(check: BushCheck) -> list[str]:
    """Return which bodies yield, at rest or under the load."""
    found = []
    if check.bush.wrapped:
        found.append(
            "a wrapped bush yields when it is pressed in: the bore closes in by all of the "
            "interference, and its own first yield is not computed"
        )
    for body in BODIES[:2]:
        yields = {name: each[body][0].load for name, each in check.yields.items() if body in each}
        names = ", ".join(name for name, load in yields.items() if load == 0)
        if names:
            heat = " and heat" if check.temperature[1] != 20 else ""
            found.append(
                f"the {body} yields by press fit{heat} alone ({names}): choose a looser seat, or "
                "another thickness of the part around it"
            )
    body, column, factor = check.worst
    if 0 < factor < 1:
        found.append(f"the load is above first yield of the {body} ({column}); laws are elastic")
    return found


# --- the page -----------------------------------------------------------------------------------


def _page(check: BushCheck) -> Page:
    """Return the page of a check."""
    from cylcontact.joint.page import Page
    from cylcontact.joint.sketch import draw_pin

    numbers = check.band.get("joint") or check.band["middle"]
    pin = sum(limits_of(check.pin_diameter, "pin")) / 4
    seat = sum(check.bush.sizes.hole) / 4
    shape = Housing(check.housing.R_o, check.housing.clamp, [(check.hole, seat)])
    title = f"{check.pin.title} pin in a {str(check.bush).partition(' (')[0]}"
    sketch = partial(
        draw_pin, R_i=numbers.bore_mm / 2, R_j=pin, housing=shape,
        gap=f"bush after pressing, ΔR = {numbers.clearance_um:.4g} µm",
    )  # fmt: skip
    sections = {"Assumptions": _assumptions(check), "Not included": [NOT_INCLUDED]}
    words = [" ".join(line.split()) for line in _summary(check)]
    return Page(
        "Check of a joint with a bush", title, sketch, None, _inputs(check), *_cells(check), words,
        check.warnings, sections,
    )  # fmt: skip


def _inputs(check: BushCheck) -> list[Source]:
    """Return what the answer is computed from."""
    from cylcontact.joint.page import numbers_of_material

    bush, (warm_pin, warm) = check.bush, check.temperature
    inner = f"bore {shown(bush.bore)}" if bush.wall is None else f"wall {shown(bush.wall)}"
    seat = bush.seat if isinstance(bush.seat, str) else " / ".join(map(shown, bush.seat))
    wrapped = ", rolled of strip" if bush.wrapped else ""
    rim = check.rim.title if isinstance(check.rim, Material) else check.rim
    total = f" ({check.load * check.length:,.6g} N on {check.length:g} mm)" if check.length else ""
    return [
        ("bush", *numbers_of_material(bush.material)),
        ("", f"{inner} before pressing, seat {seat}{wrapped}", "given"),
        ("pin", *numbers_of_material(check.pin)),
        ("", f"diameter {shown(check.pin_diameter)}", "given"),
        ("around it", *numbers_of_material(check.hole)),
        ("", f"{str(check.housing).partition(' (as ')[0]}; rim at rest: {rim}", "given"),
        ("temperature", f"pin {warm_pin:g} °C, other parts {warm:g} °C", "given"),
        ("load", f"{check.load:,.6g} N/mm{total}", "given"),
        ("plane", check.plane, "given"),
    ]


def _assumptions(check: BushCheck) -> list[str]:
    """Return what the answer rests on."""
    return [
        f"Linear elasticity, plane {check.plane} under the load; at rest the ends are free.",
        "The seat slides or sticks: each yield is the lower one of both.",
        "Diameters are normally distributed, with the limits at ±3σ.",
    ]


def _text(value: float, digits: int = 4) -> str:
    """Return a number with some digits and no exponent."""
    return f"{float(f'{value:.{digits}g}'):,.10g}" if np.isfinite(value) else f"{value:g}"


def _finite(value: float) -> float | None:
    """Return a number for JSON."""
    return float(value) if np.isfinite(value) else None
