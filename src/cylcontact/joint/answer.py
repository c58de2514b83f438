"""The numbers of a joint under a load, and their text."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cylcontact.bodies.iso286 import IsoFit
from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair, unusual_lengths
from cylcontact.joint.loaded import LoadedJoint
from cylcontact.laws import Housing, Sector
from cylcontact.support.arrays import as_floats
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    import pandas as pd

NO_CLEARANCE = "no clearance"
# The ratios R_o/R of the lugs by finite elements, from which the sector of a lug comes.
_STUDIED = 1.3, 4.0


@dataclass(frozen=True)
class Numbers:
    """Results for one pair under the load; NaN if unknown.

    Attributes
    ----------
    clearance_um, diametral_clearance_um : float
        At the temperature of the joint.
    penetration_um, stiffness_N_per_mm2, total_stiffness_N_per_mm : float
        The last one over the axial length. NaN for a plane of unknown depth.
    contact_angle_deg : float
        The angle of the contact from the line of the load to its end.
    width_mm : float
        The width of the contact, at most the diameter of the hole.
    peak_pressure_MPa, peak_at_deg : float
        The largest pressure, and its place from the line of the load.
    projected_pressure_MPa : float
        The load over the pin's diameter.
    first_yield_N_per_mm, factor_to_yield : float
        By von Mises; NaN without yield stresses.
    first_yield : str
        The load in words, with the body and the place.
    """

    clearance_um: float = np.nan
    diametral_clearance_um: float = np.nan
    penetration_um: float = np.nan
    stiffness_N_per_mm2: float = np.nan
    total_stiffness_N_per_mm: float = np.nan
    contact_angle_deg: float = np.nan
    width_mm: float = np.nan
    peak_pressure_MPa: float = np.nan
    peak_at_deg: float = np.nan
    projected_pressure_MPa: float = np.nan
    first_yield_N_per_mm: float = np.nan
    factor_to_yield: float = np.nan
    first_yield: str = ""


class _Row(NamedTuple):
    """A row of the answer: its name, its unit, and where its number is."""

    name: str
    unit: str
    field: str
    of_hole: bool = False  # rollers do not have it

    @property
    def heading(self) -> str:
        return f"{self.name}, {self.unit.replace(',', '')}" if self.unit else self.name


ROWS = (
    _Row("radial clearance", "µm", "clearance_um", True),
    _Row("diametral clearance", "µm", "diametral_clearance_um", True),
    _Row("penetration", "µm", "penetration_um"),
    _Row("stiffness", "N/mm²", "stiffness_N_per_mm2"),
    _Row("total stiffness", "N/mm", "total_stiffness_N_per_mm"),
    _Row("contact angle", "°, each side", "contact_angle_deg", True),
    _Row("width of contact", "mm", "width_mm"),
    _Row("peak pressure", "MPa", "peak_pressure_MPa"),
    _Row("peak is at", "° from the load", "peak_at_deg", True),
    _Row("projected pressure", "MPa", "projected_pressure_MPa", True),
    _Row("first yield", "N/mm", "first_yield_N_per_mm"),
    _Row("factor to yield", "", "factor_to_yield"),
)
NUMBERS = tuple(field.name for field in fields(Numbers) if field.name != "first_yield")


@dataclass(frozen=True, eq=False)
class Answer:
    """The numbers of a joint under a load, for its text, pictures and page.

    `JointCheck`, which users get, describes the attributes.
    """

    joint: LoadedJoint
    numbers: Numbers
    band: dict[str, Numbers]

    @property
    def pair(self) -> CylinderPair:
        """The pair at its temperature; with a fit, that in the middle."""
        return self.joint.pair

    @property
    def load(self) -> float:
        """The load in N/mm."""
        return float(self.joint.load)

    @property
    def housing(self) -> Housing | None:
        """The housing, if any."""
        return self.joint.housing

    @property
    def iso(self) -> IsoFit | None:
        """The ISO fit, if any."""
        return self.joint.iso

    @property
    def worst(self) -> tuple[str, Numbers]:
        """The pair that yields first, with its name; without yield stresses the numbers above."""
        named = {"joint": self.numbers} if self.iso is None else dict(self.band)
        named.pop("mean", None)
        known = {name: n for name, n in named.items() if not np.isnan(n.factor_to_yield)}
        if not known:
            return ("joint" if self.iso is None else "middle"), self.numbers
        name = min(known, key=lambda each: known[each].factor_to_yield)
        return name, known[name]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong or doubtful, a sentence each."""
        return tuple(_warnings(self))

    @property
    def table(self) -> pd.DataFrame:
        """The numbers as a table: a row for each, a column for each pair."""
        import pandas as pd

        columns = self.band or {"joint": self.numbers}
        values = {name: [getattr(each, key) for key in NUMBERS] for name, each in columns.items()}
        return pd.DataFrame(values, index=list(NUMBERS))


def has_yield_stresses(pair: CylinderPair, housing: Housing | None) -> bool:
    """Return whether the yield stresses of all bodies are known."""
    layers = [material for material, _ in housing.layers] if housing is not None else []
    bodies = [pair.material_i, pair.material_j, *layers]
    return all(body.yield_stress is not None for body in bodies)


# --- the text -------------------------------------------------------------------------------------


def described(joint: LoadedJoint) -> list[str]:
    """Return the joint and its load in some lines, with the radii of the drawing."""
    drawn, pair = joint.drawn, joint.pair
    R_i, R_j = (float(radius) for radius in drawn.radii("the joint"))
    one, other = drawn.material_i.title, drawn.material_j.title
    lines = []
    if drawn.contact == "internal":
        middle = "; middle of the fit" if joint.iso else ""
        lines.append(
            f"{other} pin (R_j = {R_j:.6g} mm) in {one} hole (R_i = {R_i:.6g} mm{middle}), "
            f"plane {drawn.plane}"
        )
        if joint.iso is not None:
            lines.append(str(joint.iso))
        else:
            gap = 1e3 * float(drawn.dR)
            lines.append(f"clearance {_text(gap)} µm radial, {_text(2 * gap)} µm on the diameter")
        if joint.temperature is not None:
            gap = 1e3 * float(pair.dR)
            lines.append(f"{_warm(joint)}: {_text(gap)} µm radial, {_text(2 * gap)} µm on the "
                         f"diameter{_which(joint)}")  # fmt: skip
        lines.append(f"in {in_words(joint)}" if joint.housing else "in an infinite plate")
    else:
        second = "plane" if np.isinf(R_j) else f"roller (R_j = {R_j:.6g} mm)"
        held = f", held {joint.depth:g} mm below its surface" if joint.depth else ""
        lines.append(
            f"{one} roller (R_i = {R_i:.6g} mm) on {other} {second}{held}, plane {drawn.plane}"
        )
    load, length = float(joint.load), drawn.length
    total = f" ({_text(load * length)} N on {length:g} mm)" if length else ""
    return [*lines, f"under {_text(load)} N/mm{total}"]


def in_words(joint: LoadedJoint) -> str:
    """Return the housing in words; the accuracy of a lug's yield only within its study."""
    housing, text = joint.housing, str(joint.housing)
    if is_outside_study(joint) and housing is not None and isinstance(housing.clamp, Sector):
        text = text.partition(" (as ")[0] + f" (as pulled:{housing.clamp.angle:g})"
    return text


def is_outside_study(joint: LoadedJoint) -> bool:
    """Return whether a lug is outside of the finite elements from which its sector comes."""
    housing = joint.housing
    if housing is None or not isinstance(housing.clamp, Sector) or housing.clamp.shank is None:
        return False
    ratio = housing.R_o / float(as_floats(joint.drawn.R_i))
    return bool(housing.layers) or not _STUDIED[0] <= ratio <= _STUDIED[1]


def _which(joint: LoadedJoint) -> str:
    """Return which pair of a fit stands for it."""
    if joint.iso is None:
        return ""
    return f"; {'middle' if joint.pairs['middle'] else 'loosest'} of the fit"


def _warm(joint: LoadedJoint) -> str:
    """Return the temperatures, and what the rim does."""
    assert joint.temperature is not None
    pin, hole = joint.temperature
    text = f"at {pin:g} °C" if pin == hole else f"pin at {pin:g} °C, hole at {hole:g} °C"
    if joint.housing is None:
        return text
    rim = joint.rim
    frame = f"in a frame of {rim.title}" if isinstance(rim, Material) else f"rim {rim}"
    return f"{text}, {frame}"


def answer_lines(check: Answer) -> list[str]:
    """Return the numbers: a line each for one pair, a table for a fit."""
    if check.iso is None:
        return _single(check)
    return [str(TextTable(*cells(check))), *words(check)]


def words(check: Answer) -> list[str]:
    """Return what the table of numbers does not say: where it yields, and what is missing."""
    joint, lines = check.joint, []
    if joint.seized > 5e-5:
        lines.append(f"{100 * joint.seized:.2g} % of the pairs have no clearance; the mean and "
                     "percentiles are of the others")  # fmt: skip
    name, worst = check.worst
    if worst.first_yield and not np.isnan(worst.factor_to_yield):
        which = f"the {name} pair yields first" if check.iso else "first yield"
        lines.append(f"{which}: {worst.first_yield}")
    elif not has_yield_stresses(check.pair, check.housing):
        lines.append("first yield: the yield stresses are not given")
    else:
        lines.append(f"first yield: {worst.first_yield}")
    if not joint.has_penetration:
        lines.append("the penetration needs the depth at which the plane is held")
    return lines


def _shown(check: Answer) -> list[_Row]:
    """Return the rows that this joint has."""
    columns = list(check.band.values()) or [check.numbers]
    return [
        row for row in ROWS if not all(np.isnan(getattr(numbers, row.field)) for numbers in columns)
    ]


def _single(check: Answer) -> list[str]:
    """Return the answer for one pair."""
    numbers = check.numbers
    lines = []
    for row in _shown(check):
        if row.field in ("clearance_um", "diametral_clearance_um"):
            continue  # said above
        value, unit = getattr(numbers, row.field), row.unit
        text = (
            numbers.first_yield
            if row.field.startswith("first")
            else f"{_text(value)}{' ' * (unit[:1] != '°')}{unit}"
        )
        if row.field == "projected_pressure_MPa":
            text += ", the load over the pin's diameter"
        lines.append(f"{row.name:<20}{text.rstrip()}")
    if not check.joint.has_penetration:
        lines.insert(0, f"{'penetration':<20}needs the depth at which the plane is held (--depth)")
    if np.isnan(numbers.first_yield_N_per_mm):
        missing = numbers.first_yield or "the yield stresses are not given"
        lines.append(f"{'first yield':<20}{missing}")
    return lines


def _text(value: float) -> str:
    """Return a number with four digits and no exponent.

    >>> _text(12.186), _text(112234.0), _text(0.00012)
    ('12.19', '112,200', '0.00012')
    """
    return f"{float(f'{value:.4g}'):,.10g}"


def cells(check: Answer) -> tuple[list[str], list[list[str]]]:
    """Return the heading and the rows of the answer as a table."""
    columns = check.band or {"": check.numbers}
    rows = []
    for row in _shown(check):
        values = [getattr(numbers, row.field) for numbers in columns.values()]
        rows.append([row.heading, *("-" if np.isnan(v) else _text(v) for v in values)])
    for place, numbers in enumerate(columns.values(), start=1):
        if numbers.first_yield == NO_CLEARANCE:
            rows[0][place] = NO_CLEARANCE
    return ["", *columns], rows


def _warnings(check: Answer) -> list[str]:
    """Return the warnings of a joint."""
    joint, sentences = check.joint, []
    name, worst = check.worst
    if worst.factor_to_yield < 1:
        of = f" of the {name} pair" if check.iso else ""
        sentences.append(
            f"the load, {check.load:,.0f} N/mm, is above first yield{of} at {worst.first_yield}; "
            "all laws here are elastic"
        )
    sentences += unusual_lengths(joint.drawn)
    if is_outside_study(joint):
        low, high = _STUDIED
        sentences.append(
            "this lug is outside of what finite elements have checked (one material, R_o/R from "
            f"{low:g} to {high:g}): its first yield may be further off"
        )
    return sentences


def not_included(joint: LoadedJoint) -> tuple[str, ...]:
    """Return what the answer leaves out."""
    parts = ["friction", "wear", "plastic flow"]
    if joint.drawn.contact == "internal":
        parts = ["bending and tilt of the pin", *parts]
        if joint.housing is not None and (joint.temperature or joint.housing.layers):
            parts.append("stress at rest (press fit, temperature)")
        elif joint.housing is None:
            parts.append("the housing")
    return tuple(parts)
