"""One joint under one load: penetration, stiffness, pressure, first yield, the band of a fit."""

from __future__ import annotations

import json
import textwrap
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cylcontact.bodies.iso286 import IsoFit
from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair, unusual_lengths
from cylcontact.joint.loaded import LoadedJoint, Temperatures, law_of, resolve
from cylcontact.laws import Conformal, Explicit, Housing, Sector
from cylcontact.limits import first_yield, hertz_half_width, hertz_stress
from cylcontact.limits.rings import Rim
from cylcontact.limits.sizing import half_width, peak_angle
from cylcontact.support.arrays import as_floats
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd
    from matplotlib.axes import Axes

__all__ = ["JointCheck", "Numbers", "check_joint"]

_NO_CLEARANCE = "no clearance"
# Columns of the text.
_WIDTH = 100
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
class JointCheck:
    """A joint under a load with its answer; `check_joint` makes it.

    Attributes
    ----------
    joint : LoadedJoint
        The joint as it was understood: pairs, housing, temperatures, depth, load.
    numbers : Numbers
        Of the joint; with a fit, of its middle.
    band : dict of Numbers
        With a fit: "tightest", "5 %", "middle", "95 %", "loosest" and "mean". The percentiles are
        those of the clearance of produced pairs.
    law, error_percent : str, float
        The law to use in another code, and the error of its penetration at this load.
    """

    joint: LoadedJoint
    numbers: Numbers
    band: dict[str, Numbers]
    law: str
    error_percent: float

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

    def __str__(self) -> str:
        lines = [*described(self.joint), "", *answer_lines(self), "", *_advice(self)]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return TextTable(*cells(self), described(self.joint)[0])._repr_html_()

    def to_dict(self) -> dict[str, Any]:
        """Return the joint and its numbers under plain names, for JSON; None where there is none.

        The radii are those at the temperature of the joint.
        """
        joint, pair = self.joint, self.pair
        R_i, R_j = (float(radius) for radius in pair.radii("the joint"))
        return {
            "contact": pair.contact,
            "load_N_per_mm": self.load,
            "dR_mm": _finite(float(pair.dR)),
            "R_i_mm": R_i,
            "R_j_mm": _finite(R_j),
            "length_mm": pair.length,
            "plane": pair.plane,
            "material_i": _plain(pair.material_i),
            "material_j": _plain(pair.material_j),
            "housing": str(joint.housing) if joint.housing else None,
            "temperature_C": list(joint.temperature) if joint.temperature else None,
            "depth_mm": joint.depth,
            "iso": joint.iso.code if joint.iso else None,
            "without_clearance": joint.seized,
            "law": self.law,
            "law_error_percent": self.error_percent,
            "worst": self.worst[0],
            "warnings": list(self.warnings),
            "not_included": list(not_included(joint)),
            "numbers": {
                name: _plain(numbers)
                for name, numbers in ({"joint": self.numbers} | self.band).items()
            },
        }

    def to_json(self) -> str:
        """Return `to_dict` as JSON."""
        return json.dumps(self.to_dict(), ensure_ascii=False, indent=1)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the penetration against the load up to first yield, with the band of a fit.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw into; by default those of a new figure.
        """
        from cylcontact.joint.picture import draw_check

        return draw_check(self, ax)

    def save(self, path: Path | str) -> Path:
        """Write one page with sketch, inputs, answer, picture and assumptions.

        Parameters
        ----------
        path : str or Path
            The file, .html, .pdf or .png.
        """
        from cylcontact.joint.check_page import page_of
        from cylcontact.joint.page import write_page

        return write_page(page_of(self), path)


def check_joint(
    pair: CylinderPair,
    load: float,
    *,
    housing: Housing | None = None,
    iso: IsoFit | str | None = None,
    depth: float | None = None,
    temperature: Temperatures | None = None,
    rim: Rim | None = None,
) -> JointCheck:
    """Check a joint under a load: penetration, stiffness, pressure, first yield.

    Parameters
    ----------
    pair : CylinderPair
        A pin in a hole, two rollers, or a roller on a plane, with its radii at 20 °C. With a fit
        only its materials, plane and length are used.
    load : float
        Load per unit length in N/mm.
    housing : Housing, optional
        The body around the hole; without one the hole is in an infinite plate.
    iso : IsoFit or str, optional
        An ISO fit, such as "20H7/g6". The answer is then for the tightest, the middle and the
        loosest pair, for those at 5 % and 95 % of the clearances of produced pairs, and in the
        mean over all of these. Both diameters are normally distributed with limits at ±3σ.
    depth : float, optional
        For a roller on a plane: the depth in mm below the surface at which the half-plane is held.
        Without it the penetration is not defined.
    temperature : float or (float, float), optional
        Of the joint, or of the pin and of the hole with its housing, in °C.
    rim : "free", "held" or Material, optional
        With a temperature and a housing: what the rim does, as for `limits.at_temperature`.

    Returns
    -------
    JointCheck

    Raises
    ------
    InputError
        If the load is not positive, radii are missing, an argument is for another kind of joint,
        or no pair of the fit has a clearance.

    Examples
    --------
    A steel pin in a bronze eye that is pulled by its shank:

    >>> from cylcontact import CylinderPair, Material
    >>> from cylcontact.laws import Sector
    >>> steel, bronze = (Material.named(name) for name in ("high-strength steel", "bronze"))
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.95, pin=steel, hole=bronze)
    >>> check = check_joint(pair, 1000.0, housing=Housing(20.0, Sector(60, "pulled")))
    >>> print(f"{check.numbers.penetration_um:.1f} µm, {check.numbers.contact_angle_deg:.0f}°")
    48.1 µm, 47°
    """
    joint = resolve(
        pair, load, housing=housing, iso=iso, depth=depth, temperature=temperature, rim=rim
    )
    return checked(joint)


def checked(joint: LoadedJoint) -> JointCheck:
    """Return the answer for a joint."""
    each = {name: numbers_of(pair, joint) for name, pair in joint.solved()}
    band: dict[str, Numbers] = {}
    if joint.iso is not None:
        nothing = Numbers(first_yield=_NO_CLEARANCE)
        band = {name: each.get(name, nothing) for name in joint.pairs}
        band["mean"] = _mean(each, joint)
    numbers = band["middle"] if band else each["joint"]
    return JointCheck(joint, numbers, band, *_to_use(joint))


def numbers_of(pair: CylinderPair, joint: LoadedJoint) -> Numbers:
    """Evaluate one pair of a joint."""
    load, housing = float(joint.load), joint.housing
    law = law_of(pair, housing, joint.depth)
    penetration = stiffness = np.nan
    if joint.has_penetration:
        depth = float(law.penetration(load, pair))
        penetration, stiffness = 1e3 * depth, float(law.stiffness(depth, pair))
    values: dict[str, Any] = {
        "penetration_um": penetration,
        "stiffness_N_per_mm2": stiffness,
        "total_stiffness_N_per_mm": np.nan if pair.length is None else stiffness * pair.length,
    }
    if isinstance(law, Conformal):
        clearance, diameter = 1e3 * float(pair.dR), 2 * float(as_floats(pair.R_j))
        values |= {
            "clearance_um": clearance,
            "diametral_clearance_um": 2 * clearance,
            "contact_angle_deg": float(law.contact_angle(load, pair)),
            "width_mm": 2 * float(half_width(load, pair, law)),
            "peak_pressure_MPa": float(law.peak_pressure(load, pair)),
            "peak_at_deg": peak_angle(load, pair, law),
            "projected_pressure_MPa": load / diameter,
        }
    else:
        values |= {
            "width_mm": 2 * float(hertz_half_width(load, pair)),
            "peak_pressure_MPa": float(hertz_stress(load, pair)),
        }
    if has_yield_stresses(pair, housing):
        at = first_yield(pair, housing=housing)
        values |= {
            "first_yield_N_per_mm": float(at.load),
            "factor_to_yield": float(at.load) / load,
            "first_yield": str(at),
        }
    return Numbers(**values)


def has_yield_stresses(pair: CylinderPair, housing: Housing | None) -> bool:
    """Return whether the yield stresses of all bodies are known."""
    layers = [material for material, _ in housing.layers] if housing is not None else []
    bodies = [pair.material_i, pair.material_j, *layers]
    return all(body.yield_stress is not None for body in bodies)


def _mean(each: dict[str, Numbers], joint: LoadedJoint) -> Numbers:
    """Return the mean over all pairs of a fit, from those that are solved."""
    values = {
        key: sum(joint.weights[name] * getattr(numbers, key) for name, numbers in each.items())
        for key in NUMBERS
    }
    return Numbers(**values)


def _to_use(joint: LoadedJoint) -> tuple[str, float]:
    """Return the law to use in another code, and its error at the load in percent."""
    pair = joint.pair
    if pair.contact == "external":
        return "johnson", 0.0
    if joint.housing is not None or not pair.of_one_material:
        return "conformal", 0.0
    exact = float(Conformal().penetration(joint.load, pair))
    return "explicit", 100 * (float(Explicit().penetration(joint.load, pair)) / exact - 1)


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


def answer_lines(check: JointCheck) -> list[str]:
    """Return the numbers: a line each for one pair, a table for a fit."""
    if check.iso is None:
        return _single(check)
    return [str(TextTable(*cells(check))), *words(check)]


def words(check: JointCheck) -> list[str]:
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


def _shown(check: JointCheck) -> list[_Row]:
    """Return the rows that this joint has."""
    columns = list(check.band.values()) or [check.numbers]
    return [
        row for row in ROWS if not all(np.isnan(getattr(numbers, row.field)) for numbers in columns)
    ]


def _single(check: JointCheck) -> list[str]:
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


def cells(check: JointCheck) -> tuple[list[str], list[list[str]]]:
    """Return the heading and the rows of the answer as a table."""
    columns = check.band or {"": check.numbers}
    rows = []
    for row in _shown(check):
        values = [getattr(numbers, row.field) for numbers in columns.values()]
        rows.append([row.heading, *("-" if np.isnan(v) else _text(v) for v in values)])
    for place, numbers in enumerate(columns.values(), start=1):
        if numbers.first_yield == _NO_CLEARANCE:
            rows[0][place] = _NO_CLEARANCE
    return ["", *columns], rows


def _warnings(check: JointCheck) -> list[str]:
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


def _advice(check: JointCheck) -> list[str]:
    """Return which law to use in another code, and what the answer leaves out."""
    use = {
        "conformal": "conformal, which gave this answer, exported as a table",
        "explicit": f"explicit, a formula: here {check.error_percent:+.2f} % off in penetration",
        "johnson": "johnson, which gave this answer: a formula with Lambert's W",
    }[check.law]
    lines = [f"{'law to export':<20}{use}"]
    parts = ", ".join(not_included(check.joint))
    lines += textwrap.wrap(f"{'not included':<20}{parts}", _WIDTH, subsequent_indent=" " * 20)
    if check.pair.contact == "internal" and check.housing is None:
        lines.append(f"{'':<20}The housing may deform by more than this penetration: give its "
                     "outer radius (--R-o)")  # fmt: skip
    return lines


def _plain(record: Any) -> dict[str, Any]:
    """Return a record for JSON, None in the place of NaN."""
    return {name: _finite(value) for name, value in asdict(record).items()}


def _finite(value: Any) -> Any:
    """Return a number for JSON: none for NaN, a text for infinity."""
    if isinstance(value, float) and not np.isfinite(value):
        return None if np.isnan(value) else "inf"
    return value
