"""All laws side by side: one case, and the whole domain."""

from __future__ import annotations

import inspect
from collections.abc import Iterable

import numpy as np
import pandas as pd

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.fitting.law_models import MODELS
from cylcontact.laws import (
    LAW_TYPES,
    LAWS,
    Conformal,
    ContactLaw,
    Housing,
)
from cylcontact.laws.housing_spec import in_housing, takes_housing
from cylcontact.laws.law import Parameter
from cylcontact.limits import first_yield, hertz_half_width, hertz_stress
from cylcontact.limits.sizing import half_width
from cylcontact.reports.laws_bounds import BOUNDED, TRUTH, departures, explicit_error, truth_of
from cylcontact.support.arrays import FloatArray, require
from cylcontact.support.errors import InputError

__all__ = ["case", "comparison", "departures", "deviations", "explicit_error", "listing", "to_text"]

# The default case: the steel and the clearance of Fig 2, the radius and the length of the paper's
# bearing.
R_I = LENGTH = 10.0  # mm
LOAD = 100.0  # N/mm

# The values of φ = f/(E*·ΔR) in the table of deviations.
LOAD_NUMBERS: dict[Contact, tuple[float, ...]] = {
    "internal": (1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0),
    "external": (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3),
}
# Laws that are used for two materials and know E* alone.
_OF_E_STAR = "explicit", "johnson"
MISSING = "-"
HUGE = 1e12


def case(dR: float = 0.05) -> CylinderPair:
    """Return the pair that is compared by default, with a ΔR in mm.

    Examples
    --------
    >>> pair = case(dR=0.02)
    >>> print(f"{pair.R_j:.2f} mm, {pair.E_star:.0f} MPa")
    9.98 mm, 113736 MPa
    """
    material = Material("the material of both bodies", 207e3, 0.3)
    return CylinderPair.from_dR("internal", dR, material, LENGTH, R_I)


def comparison(
    pair: CylinderPair,
    load: float,
    own: ContactLaw | None = None,
    housing: Housing | None = None,
) -> pd.DataFrame:
    """Evaluate every law of `cylcontact.laws.LAWS` for one pair under one load.

    Parameters
    ----------
    pair : CylinderPair
        One pair with scalar numbers.
    load : float
        Load per unit length in N/mm, positive.
    own : ContactLaw, optional
        A law of one's own, in the last row.
    housing : Housing, optional
        The datum of the laws that take one.

    Returns
    -------
    pandas.DataFrame
        Columns law, penetration_um, stiffness_N_per_mm2, max_load_N_per_mm (inf for no limit)
        and note; NaN where a law is undefined, for the reason in the note.

    Raises
    ------
    InputError
        If the load is not positive and finite.

    Examples
    --------
    >>> table = comparison(case(), 100.0).set_index("law")
    >>> print(table.loc[["johnson", "persson"], "penetration_um"].round(5).tolist())
    [1.55935, 1.56362]
    """
    require(
        load > 0 and np.isfinite(load),
        "comparison of laws",
        "load",
        load,
        "must be positive and finite",
        "give it in N/mm",
    )
    every = [
        law() if housing is None or not takes_housing(name) else in_housing(name, housing, "laws")
        for name, law in LAWS.items()
    ]
    every += [] if own is None else [own]
    return pd.DataFrame([_answers(law, pair, load) for law in every])


def _answers(law: ContactLaw, pair: CylinderPair, load: float) -> dict[str, object]:
    """Return one row of the comparison."""
    note = ""
    penetration = stiffness = highest = np.nan
    try:
        # A meaningless load may overflow; the result is then NaN.
        with np.errstate(over="ignore", invalid="ignore"):
            penetration = _finite(law.penetration(load, pair))
            stiffness = _finite(law.stiffness(penetration, pair))
        highest = float(law.max_load(pair))
    except InputError as error:
        note = error.rule
    if not note and np.isnan(penetration):
        beyond = "beyond its largest load" if load > highest else "too large for a number"
        note = "undefined at this ΔR" if np.isnan(highest) else beyond
    return {
        "law": law.name,
        "penetration_um": 1e3 * penetration,
        "stiffness_N_per_mm2": stiffness,
        "max_load_N_per_mm": highest,
        "note": note,
    }


def _of_housing(pair: CylinderPair, load: float, housing: Housing) -> str:
    """Return what the housing does to the penetration."""
    there, by_johnson = (
        float(law.penetration(load, pair)) for law in (Conformal(housing), Conformal())
    )
    return (
        f"in {housing}: {1e3 * there:.4g} µm, {there / by_johnson:.2f} times the penetration by "
        "Johnson's datum, to which all laws but conformal keep"
    )


def _finite(value: FloatArray) -> float:
    """Return a number, NaN in place of inf."""
    return float(value) if np.isfinite(value) else np.nan


def deviations(pair: CylinderPair) -> pd.DataFrame:
    """Tabulate the deviation of each law's penetration from the reference at equal load.

    The reference is Persson's law for internal contact, `laws.Conformal` if the materials differ,
    and Johnson's law for external contact.

    Parameters
    ----------
    pair : CylinderPair
        One pair; only laws that are not functions of φ alone depend on it.

    Returns
    -------
    pandas.DataFrame
        A row per law, a column per φ = f/(E*·ΔR), in percent; NaN where a law is undefined.

    Examples
    --------
    >>> print(deviations(case()).loc["johnson"].round(2).tolist())
    [-0.0, -0.01, -0.14, -2.14, -29.14, nan]
    """
    numbers = np.array(LOAD_NUMBERS[pair.contact])
    loads = numbers * pair.E_star * pair.dR
    truth = truth_of(pair).penetration(loads, pair)
    rows = {}
    for name, law in LAWS.items():
        try:
            rows[name] = 100 * (law().penetration(loads, pair) / truth - 1)
        except InputError:
            rows[name] = np.full_like(numbers, np.nan)
    return pd.DataFrame.from_dict(rows, orient="index", columns=list(numbers)).rename_axis("law")


def to_text(
    pair: CylinderPair,
    load: float,
    own: ContactLaw | None = None,
    housing: Housing | None = None,
) -> str:
    """Return the whole comparison of laws for a pair and a load as text.

    Parameters
    ----------
    pair : CylinderPair
        One pair with scalar numbers.
    load : float
        Load per unit length in N/mm, positive.
    own : ContactLaw, optional
        A law of one's own, compared with the others.
    housing : Housing, optional
        The datum of the laws that take one.

    Returns
    -------
    str
        The comparison, the deviations, and of one material in a hole Johnson's departures from
        conformal contact. `listing` has what does not depend on the pair.

    Raises
    ------
    InputError
        If the load is not positive and finite.
    """
    contact = pair.contact
    truth = truth_of(pair).name
    datum = "" if housing is None else "all by Johnson's datum, "
    side_by_side, errors = comparison(pair, load, own, housing), deviations(pair)
    sizes = {"ΔR": pair.dR, "R_i": pair.R_i, "length": pair.length}
    given = (f"{name} = {value:g} mm" for name, value in sizes.items() if value is not None)
    parts = [
        f"{contact} contact, {', '.join(given)}, E* = {float(pair.E_star):.2f} MPa, "
        f"f = {load:g} N/mm, φ = f/(E*·ΔR) = {load / float(pair.E_star * pair.dR):.6g}\n"
        f"{_contact(load, pair, housing)}",
        _comparison(side_by_side),
        f"penetration against {truth}'s at equal load, {datum}percent, at φ =",
        _deviations(errors),
    ]
    if housing is not None:
        parts.insert(1, _of_housing(pair, load, housing))
    elif not pair.of_one_material:
        parts.insert(1, _advice(pair, side_by_side))
    elif contact == "internal":
        parts += [
            "where johnson's penetration is too low against persson's: φ, and the load in N/mm "
            "at ΔR in mm; the last line is the end of johnson's law (Eq 8)",
            _departures(departures(pair.material_i)),
        ]
    if all(body.yield_stress is not None for body in (pair.material_i, pair.material_j)):
        parts[0] += f"\nfirst yield at {first_yield(pair)}"
        if housing is not None:
            parts[0] += f"; in this housing at {first_yield(pair, housing=housing)}"
    return "\n\n".join(parts)


def listing(contact: Contact) -> str:
    """Return the laws in a line each, what a fit searches, and the explicit law's error."""
    return "\n\n".join([_each_law(contact), _parameters(contact), _explicit()])


def _contact(load: float, pair: CylinderPair, housing: Housing | None) -> str:
    """Return the half-width and the largest pressure of the contact."""
    if pair.contact == "internal":
        law = Conformal(housing or "johnson")
        width, peak = half_width(load, pair, law), law.peak_pressure(load, pair)
        source = "" if housing is None else " (in this housing)"
    else:
        width, peak, source = hertz_half_width(load, pair), hertz_stress(load, pair), " (Hertz)"
    return f"half-width {float(width):.4g} mm, peak pressure {float(peak):.4g} MPa{source}"


def _advice(pair: CylinderPair, side_by_side: pd.DataFrame) -> str:
    """Return which law to use for a pin and a hole of different materials, and why."""
    penetration = side_by_side.set_index("law")["penetration_um"]

    def off(names: Iterable[str]) -> str:
        parts = []
        for name in names:
            error = 100 * (penetration[name] / penetration["conformal"] - 1)
            parts.append(f"{name} {'ends before' if np.isnan(error) else _deviation(error) + ' %'}")
        return ", ".join(parts)

    return (
        f"a {pair.material_j.name} pin in a {pair.material_i.name} hole, Dundurs' "
        f"α = {float(pair.alpha):.3f}, β = {float(pair.beta):.3f}\n"
        "for two materials use conformal, which is exact; at this load the penetration of laws "
        f"that take E* alone is off by: {off(_OF_E_STAR)}\n"
        "all penetrations are by Johnson's datum; another, such as a clamped plate, is a parameter "
        "of conformal"
    )


def _number(value: float, form: str) -> str:
    """Format a number, with six digits if huge; a dash for NaN, "none" for inf."""
    if np.isnan(value):
        return MISSING
    return "none" if np.isinf(value) else format(value, form if abs(value) < HUGE else ".6g")


def _deviation(value: float) -> str:
    """Format a deviation in percent with two decimals, none from 1000 on; no sign on zero."""
    text = _number(value, "+.2f" if abs(value) < 1000 else "+.0f")
    return text.removeprefix("-") if text == "-0.00" else text.replace("+0.00", "0.00")


def _comparison(table: pd.DataFrame) -> str:
    """Return the comparison with readable names of its columns."""
    texts = pd.DataFrame(
        {
            "law": table["law"],
            "penetration, µm": [_number(value, ".5f") for value in table["penetration_um"]],
            "stiffness, N/mm²": [_number(value, ".1f") for value in table["stiffness_N_per_mm2"]],
            "largest load, N/mm": [_number(value, ".1f") for value in table["max_load_N_per_mm"]],
            "": table["note"],
        }
    )
    return _lines(texts)


def _deviations(table: pd.DataFrame) -> str:
    """Return the deviations, one line per law."""
    texts = table.map(_deviation).rename(columns="{:g}".format)
    return _lines(texts.reset_index())


def _departures(table: pd.DataFrame) -> str:
    """Return the departures, one line per percentage."""
    low_by, numbers, *gaps = table.columns
    texts = pd.DataFrame(
        {
            "too low by, %": [f"{value:.1f}" for value in table[low_by]],
            "φ": [f"{value:.6f}" for value in table[numbers]],
        }
        | {f"{gap:g}": [_number(value, ".1f") for value in table[gap]] for gap in gaps}
    )
    return _lines(texts)


def _explicit() -> str:
    """Return the explicit law's error bounds."""
    error = explicit_error()
    lines = ["largest error of the explicit law:"]
    for contact, (low, high) in BOUNDED.items():
        for what in ("load", "penetration"):
            name = f"{contact} {what}"
            lines.append(
                f"  {name}: {error[name]:.4f} % of {TRUTH[contact].name}'s for "
                f"{low:g} ≤ φ ≤ {high:g} (at φ = {error[f'{name}, at φ']:.4g})"
            )
    return "\n".join(lines)


def _each_law(contact: Contact) -> str:
    """Return what each law is, by the first line of its documentation."""
    known = [law for law in LAW_TYPES if contact in law.contacts]
    width = max(len(name) for name in LAWS)
    lines = ["the laws; sources and conventions are in the documentation of each:"]
    for law in known:
        # A power law has names by what its factor is; the plain one is the shortest.
        name = (
            law.name if isinstance(law.name, str) else min((m.law for m in law.models()), key=len)
        )
        lines.append(f"  {name:<{width}}  {(inspect.getdoc(law) or '').splitlines()[0]}")
    return "\n".join(lines)


def _parameters(contact: Contact) -> str:
    """Return the parameters of each law and their default bounds, of like laws together."""
    alike: dict[tuple[str, ...], list[str]] = {}
    for model in MODELS.values():
        if model.contact == contact:
            alike.setdefault(tuple(map(_parameter, model.parameters)), []).append(model.law)
    lines = ["parameters that a fit searches, and its bounds unless a campaign gives others:"]
    for parameters, names in alike.items():
        lines += [f"  {', '.join(names)}", *(f"    {parameter}" for parameter in parameters)]
    return "\n".join(lines)


def _parameter(parameter: Parameter) -> str:
    """Return a parameter's name, unit, bounds and meaning."""
    searched = f"{parameter.low:g} … {parameter.high:g}"
    bounds = searched if parameter.value is None else f"fixed at {parameter.value:g}"
    return f"{parameter.name:<18} {bounds:<13} {parameter.unit:<11} {parameter.meaning}"


def _lines(table: pd.DataFrame) -> str:
    """Return a table of texts with the first column left-aligned and numbers right-aligned."""
    columns = [[str(name), *table[name].tolist()] for name in table.columns]
    widths = [max(map(len, column)) for column in columns]
    lines = []
    for cells in zip(*columns, strict=True):
        first, *others = (
            cell.ljust(width) if name in ("law", "") else cell.rjust(width)
            for cell, width, name in zip(cells, widths, table.columns, strict=True)
        )
        lines.append("  ".join([first, *others]).rstrip())
    return "\n".join(lines)
