"""A checked clevis: movement, bending of the pin, loads at the edges, with their text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.files.writing import json_text
from cylcontact.joint.bush import limits_of, shown
from cylcontact.joint.clevis_beam import SOURCE, Clevis, PinBeam, Plate, PlateLaw, State, sizes_of
from cylcontact.support.arrays import FloatArray, require_positive
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from cylcontact.joint.page import Page, Source

__all__ = ["ClevisCheck", "ClevisNumbers", "check_clevis"]

# Means of the line load are over these lengths from an edge, in R.
EDGES = (0.1, 0.25)
# The largest axial stress over 32M/(πd³), and how much too low the moment may be in lugs.
_PEAK, _LUG = 1.06, 1.10
# The factor on the force of a second solution, for the stiffness.
_MORE = 1.01
# Ranges that were compared with elements: E of pin over E of plate, thickness, gap and R_o over R.
_STIFF = 20e3  # MPa
_RANGES = {"thickness": (0.3, 6.7), "gap": (0.05, 1.0), "R_o": (1.6, np.inf)}
COLUMNS = ("tightest", "middle", "loosest")
NOT_INCLUDED = (
    "the ultimate load of pin and lugs, friction, chamfers, hollow pins, heads and nuts, a load "
    "beside the axis of the lug, plastic flow"
)


@dataclass(frozen=True)
class ClevisNumbers:
    """Results for one clevis of the band; NaN if unknown.

    Attributes
    ----------
    pin_mm, eye_clearance_um, cheek_clearance_um : float
        The diameter of the pin, and the radial clearances.
    movement_um, elastic_um : float
        Of the eye against the cheeks along the load, with and without the clearances.
    stiffness_N_per_mm : float
        Of the whole joint, for a force between eye and cheeks.
    moment_Nmm, shear_plane_moment_Nmm, bending_stress_MPa, pin_factor : float
        Of the pin: in the middle of the eye, at the eye's face; 1.06·32M/(πd³), NaN for a pin that
        is shorter than its diameter; and the factor to its yield, in a lug with a tenth more.
    eye_edge, cheek_edge : tuple of float
        The mean line load in N/mm over 0.1 R and 0.25 R from the inner edge.
    eye_ratio, cheek_ratio : tuple of float
        The same over the nominal line load.
    eye_pressure_MPa, cheek_pressure_MPa : tuple of float
        The largest pressure of the plane law under these loads.
    """

    pin_mm: float
    eye_clearance_um: float
    cheek_clearance_um: float
    movement_um: float
    elastic_um: float
    stiffness_N_per_mm: float
    moment_Nmm: float
    shear_plane_moment_Nmm: float
    bending_stress_MPa: float
    pin_factor: float
    eye_edge: tuple[float, float]
    cheek_edge: tuple[float, float]
    eye_ratio: tuple[float, float]
    cheek_ratio: tuple[float, float]
    eye_pressure_MPa: tuple[float, float]
    cheek_pressure_MPa: tuple[float, float]


@dataclass(frozen=True, eq=False)
class ClevisCheck:
    """A clevis under a force with its answer; `check_clevis` makes it.

    Attributes
    ----------
    clevis : Clevis
    force : float
        On the eye in N.
    band : dict of ClevisNumbers
        "tightest", "middle" and "loosest", or "joint" for sizes without limits.
    states : dict of State
        Line load and moment along the pin.
    rules : dict of float
        The moment in N mm by the rules that designers use.
    """

    clevis: Clevis
    force: float
    band: dict[str, ClevisNumbers]
    states: dict[str, State]
    rules: dict[str, float]

    @property
    def needed_moment(self) -> float:
        """The largest moment of the band in N mm, in a lug a tenth more."""
        return max(each.moment_Nmm for each in self.band.values()) * _margin(self.clevis)

    @property
    def factor(self) -> float:
        """The lowest factor to yield of the pin; NaN if it is not known."""
        return min(each.pin_factor for each in self.band.values())

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful, a sentence each."""
        return tuple(_warnings(self))

    @property
    def table(self) -> pd.DataFrame:
        """The numbers as a table: a row for each, a column for each clevis of the band."""
        import pandas as pd

        return pd.DataFrame({name: flat(numbers) for name, numbers in self.band.items()})

    def __str__(self) -> str:
        parts = [*_described(self), "", str(TextTable(*_cells(self))), "", *_summary(self)]
        return "\n".join([*parts, "", f"not included  {NOT_INCLUDED}"])

    def _repr_html_(self) -> str:
        return TextTable(*_cells(self), _described(self)[0])._repr_html_()

    def to_dict(self) -> dict[str, Any]:
        """Return the clevis and its numbers under plain names, for JSON; None for the unknown."""
        clevis = self.clevis
        return {
            "pin": clevis.pin.title,
            "diameter_mm": list(limits_of(clevis.diameter, "diameter", SOURCE)),
            **{
                name: {
                    "thickness_mm": plate.thickness,
                    "material": plate.material.title,
                    "hole_mm": list(limits_of(plate.hole, "hole", SOURCE)),
                    "housing": str(plate.housing) if plate.housing else None,
                }
                for name, plate in clevis.plates.items()
            },
            "gap_mm": clevis.gap,
            "beyond_mm": clevis.beyond,
            "force_N": self.force,
            "rules_Nmm": self.rules,
            "needed_moment_Nmm": self.needed_moment,
            "pin_factor": _finite(self.factor),
            "warnings": list(self.warnings),
            "not_included": NOT_INCLUDED,
            "numbers": {
                name: {key: _finite(value) for key, value in flat(numbers).items()}
                for name, numbers in self.band.items()
            },
        }

    def to_json(self) -> str:
        """Return `to_dict` as JSON."""
        return json_text(self.to_dict())

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the line load along the pin beside the uniform one.

        The first 0.02 R at an edge are left out: the load there is no number.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw into; by default those of a new figure.
        """
        from cylcontact.joint.clevis_picture import draw_line_load

        return draw_line_load(self.clevis, self.force, self.states, ax)

    def save(self, path: Path | str) -> Path:
        """Write the answer on one page, .html, .pdf or .png, with a sketch and the line load."""
        from cylcontact.joint.page import write_page

        return write_page(_page(self), path)


def check_clevis(clevis: Clevis, force: float) -> ClevisCheck:
    """Check a clevis under a force: movement, bending of the pin, load at the edges.

    Parameters
    ----------
    clevis : Clevis
    force : float
        On the eye in N, along the axis of lugs.

    Returns
    -------
    ClevisCheck

    Raises
    ------
    InputError
        If the force is not positive, or the contact does not settle.

    Notes
    -----
    The model is described in `cylcontact.joint.clevis_beam`. Beside finite elements in three
    dimensions, of metals and plates clamped at four radii, movement is within 3 %, and moment too
    where the eye is at most four radii thick; with an eye of five radii the moment is 4.3 % high.
    The means over 0.1 R are within 7 % (12 % in bronze and aluminium plates), over 0.25 R within
    7 %. In lugs of R_o/R = 2 the movement is within 3 %, the moment up to 7 % low, the mean over
    0.1 R of the eye up to 17 % high, in thin lugs (1.6) 9 % low and 27 % high; so the factor of the
    pin takes a tenth more in a lug. A largest line load is no number: at a sharp edge it grows with
    the fineness of any mesh. For the same reason eye and cheek have no factor to yield.
    """
    require_positive(force, SOURCE, "force", "give it in N")
    band, states = {}, {}
    for name, (pin, eye, cheek) in sizes_of(clevis).items():
        solver = PinBeam(clevis, pin / 2, (eye - pin) / 2, (cheek - pin) / 2)
        laws = solver.laws_at(force)
        states[name] = state = solver.solve(force, laws)
        more = solver.solve(_MORE * force, solver.laws_at(_MORE * force))
        stiffness = (_MORE - 1) * force / (more.movement - state.movement)
        band[name] = _numbers(solver, laws, state, force, stiffness)
    return ClevisCheck(clevis, float(force), band, states, clevis.rules(force))


def _is_soft(clevis: Clevis) -> bool:
    """Return whether a plate has a housing, in which the moment may be low."""
    return any(plate.housing is not None for plate in clevis.plates.values())


def _margin(clevis: Clevis) -> float:
    return _LUG if _is_soft(clevis) else 1.0


def _numbers(
    solver: PinBeam,
    laws: Mapping[str, PlateLaw],
    state: State,
    force: float,
    stiffness: float,
) -> ClevisNumbers:
    """Return the numbers of a state."""
    clevis, R = solver.clevis, solver.R
    q = np.where(state.in_eye, -1.0, 1.0) * state.line_load * state.weights
    face = clevis.eye.thickness / 2
    moment = float(q @ state.z)
    stress = _PEAK * 4 * moment / (np.pi * R**3)
    if clevis.pin_length < 2 * R:
        stress = np.nan
    yields = clevis.pin.yield_stress
    factor = np.nan if yields is None else yields / (stress * _margin(clevis))
    found: dict[str, Any] = {}
    nominal = {"eye": force / clevis.eye.thickness, "cheek": force / 2 / clevis.cheek.thickness}
    inner = {"eye": face, "cheek": face + clevis.gap}
    for name, law in laws.items():
        part = state.in_eye if name == "eye" else ~state.in_eye
        distance = np.abs(state.z[part] - inner[name])
        loads = tuple(
            _mean(distance, state.weights[part], state.line_load[part], share * R)
            for share in EDGES
        )
        found[f"{name}_edge"] = loads
        found[f"{name}_ratio"] = tuple(load / nominal[name] for load in loads)
        found[f"{name}_pressure_MPa"] = tuple(law.peak_pressure(load) for load in loads)
    clearances = solver.clearances
    return ClevisNumbers(
        pin_mm=2 * R,
        eye_clearance_um=1e3 * clearances["eye"],
        cheek_clearance_um=1e3 * clearances["cheek"],
        movement_um=1e3 * state.movement,
        elastic_um=1e3 * (state.movement - sum(clearances.values())),
        stiffness_N_per_mm=stiffness,
        moment_Nmm=moment,
        shear_plane_moment_Nmm=float(np.maximum(state.z - face, 0) @ q),
        bending_stress_MPa=stress,
        pin_factor=factor,
        **found,
    )


def _mean(distance: FloatArray, weights: FloatArray, f: FloatArray, length: float) -> float:
    """Return the mean of f over the first `length` from an edge."""
    order = np.argsort(distance)
    reach = np.append(0.0, np.cumsum(weights[order]))
    carried = np.append(0.0, np.cumsum((weights * f)[order]))
    return float(np.interp(length, reach, carried) / min(length, reach[-1]))


# --- the text -------------------------------------------------------------------------------------


def flat(numbers: ClevisNumbers) -> dict[str, float]:
    """Return numbers under plain names, with the length of each mean at an edge."""
    flat = {}
    for key, value in asdict(numbers).items():
        if isinstance(value, tuple):
            stem, _, unit = key.partition("_MPa")
            for share, each in zip(EDGES, value, strict=True):
                flat[f"{stem}_{share:g}R{'_MPa' if key.endswith('_MPa') else ''}{unit}"] = each
        else:
            flat[key] = value
    return flat


_ROWS = {
    "radial clearance of the eye, µm": "eye_clearance_um",
    "radial clearance of the cheeks, µm": "cheek_clearance_um",
    "movement of the eye, µm": "movement_um",
    "of it elastic, µm": "elastic_um",
    "stiffness of the joint, N/mm": "stiffness_N_per_mm",
    "moment, middle of the eye, N mm": "moment_Nmm",
    "moment, face of the eye, N mm": "shear_plane_moment_Nmm",
    "bending stress of the pin, MPa": "bending_stress_MPa",
    "factor to yield of the pin": "pin_factor",
    "eye, mean over 0.1 R, N/mm": "eye_edge_0.1R",
    "over the nominal load": "eye_ratio_0.1R",
    "eye, mean over 0.25 R, N/mm": "eye_edge_0.25R",
    "pressure there (0.1 R), MPa": "eye_pressure_0.1R_MPa",
    "cheek, mean over 0.1 R, N/mm": "cheek_edge_0.1R",
    "over the nominal load ": "cheek_ratio_0.1R",
    "cheek, mean over 0.25 R, N/mm": "cheek_edge_0.25R",
    "pressure there (0.1 R), MPa ": "cheek_pressure_0.1R_MPa",
}


def _described(check: ClevisCheck) -> list[str]:
    """Return the clevis and its force in some lines."""
    clevis = check.clevis
    eye, cheek = clevis.eye, clevis.cheek
    lines = [
        f"{clevis.pin.title} pin {shown(clevis.diameter)}, {clevis.pin_length:g} mm long, "
        f"gaps of {clevis.gap:g} mm",
        f"eye {eye.thickness:g} mm of {eye.material.title}, hole {shown(eye.hole)}, {_around(eye)}",
        f"cheeks {cheek.thickness:g} mm of {cheek.material.title}, hole {shown(cheek.hole)}, "
        f"{_around(cheek)}",
        f"under {check.force:,.6g} N on the eye",
    ]
    nominal = check.force / eye.thickness, check.force / 2 / cheek.thickness
    diameter = sum(limits_of(clevis.diameter, "diameter", SOURCE)) / 2
    lines.append(
        f"nominal line load {_text(nominal[0])} N/mm in the eye, {_text(nominal[1])} in a cheek: "
        f"{_text(nominal[0] / diameter)} and {_text(nominal[1] / diameter)} MPa over the pin's "
        "diameter"
    )
    return lines


def _around(plate: Plate) -> str:
    """Return the housing of a plate in words."""
    if plate.housing is None:
        return "clamped at four radii of the pin"
    return f"in {str(plate.housing).partition(' (as ')[0]}"


def _cells(check: ClevisCheck) -> tuple[list[str], list[list[str]]]:
    """Return the headings and the rows of the answer."""
    columns = [flat(numbers) for numbers in check.band.values()]
    rows = []
    for name, key in _ROWS.items():
        values = [column[key] for column in columns]
        if not all(np.isnan(values)):
            rows.append([name.strip(), *("-" if np.isnan(v) else _text(v) for v in values)])
    return ["", *check.band], rows


def _summary(check: ClevisCheck) -> list[str]:
    """Return the designers' rules beside the moment, and the factor of the pin."""
    needed, clevis = check.needed_moment, check.clevis
    raised = ", raised by a tenth as it may be low in a lug" if _is_soft(clevis) else ""
    lines = [f"moment of the pin   {_text(needed)} N mm{raised}"]
    for name, moment in check.rules.items():
        verdict = "safe" if moment >= needed else "UNSAFE"
        lines.append(f"  {name:<32}{_text(moment)} N mm, {moment / needed:.2f} of it: {verdict}")
    if clevis.pin_length < limits_of(clevis.diameter, "diameter", SOURCE)[1]:
        lines.append("bending stress      not given: the pin is shorter than its diameter, and its "
                     "stress is one of contact")  # fmt: skip
    elif np.isnan(check.factor):
        lines.append("factor of the pin   the yield stress is not given")
    else:
        lines.append(f"factor of the pin   {check.factor:.3g} to yield, at 1.06·32M/(πd³)")
    lines.append("eye and cheeks      no factor: a sharp edge has no yield load, and a largest "
                 "line load is no number")  # fmt: skip
    return lines


def _warnings(check: ClevisCheck) -> list[str]:
    """Return where the clevis is outside of what was compared, and whether its pin yields."""
    clevis = check.clevis
    R = limits_of(clevis.diameter, "diameter", SOURCE)[1] / 2
    found = []
    bodies = {"the pin": clevis.pin} | {f"the {k}": p.material for k, p in clevis.plates.items()}
    for name, material in bodies.items():
        if float(material.E) < _STIFF:
            found.append(
                f"{name} is of {material.title}: beside elements, soft plates moved by 8 % more "
                "and a soft pin had 9 % more moment than this answer"
            )
    for name, plate in clevis.plates.items():
        if plate.housing is not None and plate.housing.layers:
            found.append(f"the {name} has a ring around its hole, as a bush is: no such joint was "
                         "compared with elements")  # fmt: skip
    sizes = {"gap": clevis.gap} | {
        f"thickness of the {k}": p.thickness for k, p in clevis.plates.items()
    }
    sizes |= {f"R_o of the {k}": p.housing.R_o for k, p in clevis.plates.items() if p.housing}
    for name, value in sizes.items():
        low, high = _RANGES[name.partition(" ")[0]]
        if not low <= value / R <= high:
            ends = f"{low:g} to {high:g}" if np.isfinite(high) else f"at least {low:g}"
            found.append(
                f"the {name} is {value / R:.2g} R; it was compared with elements for {ends} R"
            )
    if check.factor < 1:
        found.append("the pin yields in bending; this answer is elastic")
    return found


# --- the page -----------------------------------------------------------------------------------


def _page(check: ClevisCheck) -> Page:
    """Return the page of a check."""
    from cylcontact.joint.clevis_picture import draw_clevis, draw_line_load
    from cylcontact.joint.page import Page

    clevis, drawn = check.clevis, (check.clevis, check.force, check.states)
    title = f"{clevis.pin.title} pin Ø{shown(clevis.diameter)} in an eye between two cheeks"
    sections = {
        "Bending of the pin": [" ".join(line.split()) for line in _summary(check)],
        "Assumptions": [
            "Linear elasticity; the pin is a beam on the exact contact law, fitted to finite "
            "elements in three dimensions.",
        ],
        "Not included": [NOT_INCLUDED],
    }
    return Page(
        "Check of a clevis", title, partial(draw_clevis, *drawn), partial(draw_line_load, *drawn),
        _inputs(check), *_cells(check), [], check.warnings, sections,
    )  # fmt: skip


def _inputs(check: ClevisCheck) -> list[Source]:
    """Return what the answer is computed from."""
    from cylcontact.joint.page import numbers_of_material

    clevis = check.clevis
    rows = [
        ("pin", *numbers_of_material(clevis.pin)),
        ("", f"Ø{shown(clevis.diameter)}, {clevis.pin_length:g} mm long", "given"),
    ]
    for name, plate in clevis.plates.items():
        title = "cheek, one of 2" if name == "cheek" else name
        rows += [
            (title, *numbers_of_material(plate.material)),
            ("", f"{plate.thickness:g} mm, hole Ø{shown(plate.hole)}, {_around(plate)}", "given"),
        ]
        if plate.housing is not None:
            rows += [
                (f"  from {radius:g} mm", *numbers_of_material(body))
                for body, radius in plate.housing.layers
            ]
    return [*rows, ("gap", f"{clevis.gap:g} mm", "given"),
            ("load", f"{check.force:,.6g} N on the eye", "given")]  # fmt: skip


def _text(value: float) -> str:
    """Return a number with four digits and no exponent."""
    return f"{float(f'{value:.4g}'):,.10g}"


def _finite(value: float) -> float | None:
    """Return a number for JSON."""
    return float(value) if np.isfinite(value) else None
