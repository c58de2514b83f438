"""One joint under one load: penetration, stiffness, pressure, first yield, the band of a fit."""

from __future__ import annotations

import textwrap
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.bodies.iso286 import IsoFit
from cylcontact.bodies.pair import CylinderPair
from cylcontact.files.writing import json_text, plain
from cylcontact.joint.answer import (
    NO_CLEARANCE,
    NUMBERS,
    Answer,
    Numbers,
    answer_lines,
    cells,
    described,
    has_yield_stresses,
    not_included,
)
from cylcontact.joint.loaded import LoadedJoint, Temperatures, law_of, resolve
from cylcontact.laws import Conformal, Explicit, Housing
from cylcontact.limits import first_yield, hertz_half_width, hertz_stress
from cylcontact.limits.rings import Rim
from cylcontact.limits.sizing import half_width, peak_angle
from cylcontact.support.arrays import as_floats
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

__all__ = ["JointCheck", "Numbers", "check_joint"]

# Columns of the text.
_WIDTH = 100


@dataclass(frozen=True, eq=False)
class JointCheck(Answer):
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

    law: str
    error_percent: float

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
        values = {
            "contact": pair.contact,
            "load_N_per_mm": self.load,
            "dR_mm": float(pair.dR),
            "R_i_mm": R_i,
            "R_j_mm": R_j,
            "length_mm": pair.length,
            "plane": pair.plane,
            "material_i": asdict(pair.material_i),
            "material_j": asdict(pair.material_j),
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
                name: asdict(numbers)
                for name, numbers in ({"joint": self.numbers} | self.band).items()
            },
        }
        converted: dict[str, Any] = plain(values)
        return converted

    def to_json(self) -> str:
        """Return `to_dict` as JSON."""
        return json_text(self.to_dict())

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
        nothing = Numbers(first_yield=NO_CLEARANCE)
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
        angle = float(law.contact_angle(load, pair))
        values |= {
            "clearance_um": clearance,
            "diametral_clearance_um": 2 * clearance,
            "contact_angle_deg": angle,
            "width_mm": 2 * float(half_width(angle, pair)),
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
