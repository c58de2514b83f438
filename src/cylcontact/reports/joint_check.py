"""One joint under one load: penetration, stiffness, pressure, first yield, the band of a fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.bodies.fits import Fit
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Conformal, ContactLaw, Explicit, Housing, Johnson
from cylcontact.limits import first_yield, hertz_half_width, hertz_stress
from cylcontact.limits.sizing import half_width
from cylcontact.support.arrays import FloatArray, as_floats, require_positive
from cylcontact.support.errors import InputError
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["JointCheck", "Numbers", "check_joint"]

# Where the band of a fit is solved: shares of the way from the least clearance to the largest.
_SHARES = (0.0, 0.05, 0.2, 0.5, 0.8, 1.0)
_NAMED = {"tightest": 0.0, "middle": 0.5, "loosest": 1.0}
_DRAWN, _SEED = 20_000, 1
_NO_CLEARANCE = "no clearance"
_ROWS = {
    "radial clearance, µm": "clearance_um",
    "penetration, µm": "penetration_um",
    "stiffness, N/mm²": "stiffness_N_per_mm2",
    "width of contact, mm": "width_mm",
    "peak pressure, MPa": "peak_pressure_MPa",
    "first yield, N/mm": "first_yield_N_per_mm",
}


@dataclass(frozen=True)
class Numbers:
    """What one pair does under the load; NaN where it has no clearance or no yield stress."""

    clearance_um: float
    penetration_um: float = np.nan
    stiffness_N_per_mm2: float = np.nan
    width_mm: float = np.nan
    peak_pressure_MPa: float = np.nan
    first_yield_N_per_mm: float = np.nan
    first_yield: str = ""


@dataclass(frozen=True)
class JointCheck:
    """A joint under a load; `check_joint` makes it.

    Attributes
    ----------
    pair : CylinderPair
        The joint; with a fit, that in the middle of the fit.
    load : float
        In N/mm.
    housing : Housing or None
    numbers : Numbers
        Of the pair.
    band : dict of Numbers
        With a fit: "tightest", "middle", "loosest", "mean", "5 %" and "95 %".
    fit : Fit or None
    seized : float
        With a fit: the share of pairs drawn at random that have no clearance.
    law, error_percent : str, float
        The law to use in another code, and the error of its penetration at this load.
    """

    pair: CylinderPair
    load: float
    housing: Housing | None
    numbers: Numbers
    band: dict[str, Numbers]
    fit: Fit | None
    seized: float
    law: str
    error_percent: float

    def __str__(self) -> str:
        lines = [*_described(self), ""]
        lines += [str(_band_table(self))] if self.fit else _single(self)
        if self.seized:
            lines.append(f"{100 * self.seized:.2g} % of the pairs have no clearance; the mean and "
                         "percentiles are of the others")  # fmt: skip
        return "\n".join([*lines, "", *_advice(self)])

    def _repr_html_(self) -> str:
        first = _described(self)[0]
        if self.fit:
            return TextTable(_columns(self), _cells(self), first)._repr_html_()
        cells = [[name, cell] for name, cell in _cells_of(self.numbers)]
        return TextTable(["", ""], cells, first)._repr_html_()

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers under plain names, for JSON; None where there is none."""
        every = {"joint": self.numbers} | self.band
        return {
            "load_N_per_mm": self.load,
            "dR_mm": float(self.pair.dR),
            "length_mm": self.pair.length,
            "plane": self.pair.plane,
            "housing": str(self.housing) if self.housing else None,
            "fit": self.fit.code if self.fit else None,
            "without_clearance": self.seized,
            "law": self.law,
            "law_error_percent": self.error_percent,
            "numbers": {name: _plain(numbers) for name, numbers in every.items()},
        }

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the penetration over the load up to first yield, and the ends of the fit's band.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default the axes of a new figure.
        """
        from cylcontact.plots.arguments import axes_for

        end = self.numbers.first_yield_N_per_mm
        top = 1.2 * max(self.load, 0.0 if np.isnan(end) else end)
        load = as_floats(np.linspace(0, top, 161)[1:])
        pairs = {"joint" if self.fit is None else "middle": self.pair}
        if self.fit is not None:
            ends = {"tightest": 0.0, "loosest": 1.0}
            pairs |= {name: _with_radii(self.pair, self.fit, at) for name, at in ends.items()}
        with axes_for(ax, "plot", "column", 70.0) as axes:
            for name, pair in pairs.items():
                depth = 1e3 * _law(pair, self.housing).penetration(load, pair)
                axes.plot(load, depth, label=name, marker="")
            axes.plot(self.load, self.numbers.penetration_um, "o", color="black", label="this load")
            if not np.isnan(end):
                axes.axvline(end, color="0.5", linestyle=":", marker="", label="first yield")
            axes.set(xlabel="load (N/mm)", ylabel="penetration (µm)", xlim=(0, top), ylim=(0, None))
            axes.legend()
        return axes


def check_joint(
    pair: CylinderPair,
    load: float,
    *,
    housing: Housing | None = None,
    fit: Fit | str | None = None,
    depth: float | None = None,
    warm: Callable[[CylinderPair], CylinderPair] | None = None,
) -> JointCheck:
    """Check a joint under a load: penetration, stiffness, pressure, first yield.

    Parameters
    ----------
    pair : CylinderPair
        A pin in a hole, two rollers, or a roller on a plane, with its radii. With a fit only its
        materials, plane and length are used.
    load : float
        Load per unit length in N/mm.
    housing : Housing, optional
        The body around the hole; without one the hole is in an infinite plate.
    fit : Fit or str, optional
        An ISO fit, such as "20H7/g6"; the answer is then for all its clearances. Mean and
        percentiles are from 20 000 pairs with normally distributed diameters, whose limits are
        ±3σ. They are interpolated over the clearance.
    depth : float, optional
        For a roller on a plane: the depth in mm below the surface at which the half-plane is held.
    warm : callable, optional
        Takes a pair to its temperature, as `CylinderPair.at_temperature` does.

    Returns
    -------
    JointCheck

    Raises
    ------
    InputError
        If the load is not positive, radii are missing, or no pair of the fit has a clearance.

    Examples
    --------
    A steel pin in a bronze eye that is pulled by its shank:

    >>> from cylcontact import CylinderPair, Material
    >>> from cylcontact.laws import Sector
    >>> steel, bronze = (Material.named(name) for name in ("high-strength steel", "bronze"))
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.95, pin=steel, hole=bronze)
    >>> check = check_joint(pair, 1000.0, housing=Housing(20.0, Sector(60, "far")))
    >>> print(f"{check.numbers.penetration_um:.1f} µm")
    48.1 µm
    """
    require_positive(load, "check_joint", "load", "give it in N/mm")
    warm = warm or (lambda cold: cold)
    band: dict[str, Numbers] = {}
    seized = 0.0
    if fit is None:
        pair = warm(pair)
        numbers = _numbers(pair, load, housing, depth)
    else:
        fit = Fit.read(fit) if isinstance(fit, str) else fit
        band, seized = _band(fit, pair, load, housing, warm)
        middle = (
            _with_radii(pair, fit, 0.5) if band["middle"].first_yield != _NO_CLEARANCE else pair
        )
        pair, numbers = warm(middle), band["middle"]
    law, error = _to_use(pair, load, housing)
    return JointCheck(pair, load, housing, numbers, band, fit, seized, law, error)


def _law(pair: CylinderPair, housing: Housing | None, depth: float | None = None) -> ContactLaw:
    """Return the most exact law of a pair."""
    if pair.contact == "internal":
        return Conformal(housing or "johnson")
    return Johnson(datum=depth)


def _numbers(
    pair: CylinderPair, load: float, housing: Housing | None, depth: float | None = None
) -> Numbers:
    """Evaluate one pair."""
    law = _law(pair, housing, depth)
    penetration = float(law.penetration(load, pair))
    if isinstance(law, Conformal):
        width, peak = 2 * half_width(load, pair, law), law.peak_pressure(load, pair)
    else:
        width, peak = 2 * hertz_half_width(load, pair), hertz_stress(load, pair)
    yields = None not in (pair.material_i.yield_stress, pair.material_j.yield_stress)
    at = first_yield(pair, housing=housing) if yields else None
    return Numbers(
        clearance_um=1e3 * float(pair.dR),
        penetration_um=1e3 * penetration,
        stiffness_N_per_mm2=float(law.stiffness(penetration, pair)),
        width_mm=float(width),
        peak_pressure_MPa=float(peak),
        first_yield_N_per_mm=np.nan if at is None else float(at.load),
        first_yield="" if at is None else str(at),
    )


def _with_radii(pair: CylinderPair, fit: Fit, share: float) -> CylinderPair:
    """Return the pair with the radii at a place in the band of a fit."""
    R_i, R_j = (float(radius) for radius in fit.radii(share))
    return replace(pair, dR=R_i - R_j, R_i=R_i, R_j=R_j)


def _band(
    fit: Fit,
    pair: CylinderPair,
    load: float,
    housing: Housing | None,
    warm: Callable[[CylinderPair], CylinderPair],
) -> tuple[dict[str, Numbers], float]:
    """Return the numbers over a fit, and the share of pairs without clearance."""
    from scipy.interpolate import PchipInterpolator  # which only a fit needs

    low, high = fit.clearance

    def solve(share: float) -> Numbers:
        if low + share * (high - low) < -1e-12:
            return Numbers(np.nan, first_yield=_NO_CLEARANCE)
        try:
            return _numbers(warm(_with_radii(pair, fit, share)), load, housing)
        except InputError as error:
            if _NO_CLEARANCE not in error.rule:
                raise
            return Numbers(np.nan, first_yield=_NO_CLEARANCE)

    band = {name: solve(share) for name, share in _NAMED.items()}
    first = max(0.0, -low / (high - low))
    every = [*band.values(), *(solve(first + share * (1 - first)) for share in _SHARES)]
    solved = {each.clearance_um: each for each in every if each.first_yield != _NO_CLEARANCE}
    if len(solved) < len(_NAMED):
        rule, remedy = "leaves most pairs without clearance", "choose a looser pin, or stay cooler"
        raise InputError("check_joint", "fit", fit.code, rule, remedy)
    gaps = sorted(solved)
    drawn = np.random.default_rng(_SEED).normal(0.5, 1 / 6, (2, 2 * _DRAWN))
    drawn = drawn[:, (np.abs(drawn - 0.5) <= 0.5).all(axis=0)][:, :_DRAWN]
    (hole, widest), (least, pin) = fit.limits
    gap = 1e3 * (hole + drawn[0] * (widest - hole) - (least + drawn[1] * (pin - least)))
    # A change of temperature moves every clearance by nearly the same.
    gap += gaps[-1] - 1e3 * high
    inside = np.clip(gap[gap > 0], gaps[0], gaps[-1])
    fields = [field for field in _ROWS.values() if field != "clearance_um"]
    values = {"clearance_um": gap[gap > 0]}
    for field in fields:
        curve = PchipInterpolator(gaps, [getattr(solved[each], field) for each in gaps])
        values[field] = curve(inside)
    band["mean"] = _summed(values, np.mean)
    for percent in (5, 95):
        band[f"{percent} %"] = _summed(values, partial(np.percentile, q=percent))
    return band, float((gap <= 0).mean())


def _summed(values: Mapping[str, FloatArray], of: Callable[[FloatArray], Any]) -> Numbers:
    """Return a mean or a percentile of the numbers of many pairs."""
    return Numbers(**{field: float(of(each)) for field, each in values.items()})  # type: ignore[arg-type]


def _to_use(pair: CylinderPair, load: float, housing: Housing | None) -> tuple[str, float]:
    """Return the law to use in another code, and its error at the load in percent."""
    if pair.contact == "external":
        return "johnson", 0.0
    if housing is not None or not pair.of_one_material:
        return "conformal", 0.0
    exact = float(Conformal().penetration(load, pair))
    return "explicit", 100 * (float(Explicit().penetration(load, pair)) / exact - 1)


# --- the text -------------------------------------------------------------------------------------


def _described(check: JointCheck) -> list[str]:
    """Return the joint and its load in two or three lines."""
    pair = check.pair
    R_i, R_j = (float(radius) for radius in pair.radii("the joint"))
    one, other = pair.material_i.title, pair.material_j.title
    if pair.contact == "internal":
        bodies = f"{other} pin (R_j = {R_j:.6g} mm) in {one} hole (R_i = {R_i:.6g} mm), "
        bodies += f"ΔR = {_text(1e3 * float(pair.dR))} µm"
    else:
        second = "plane" if np.isinf(R_j) else f"roller (R_j = {R_j:.6g} mm)"
        bodies = f"{one} roller (R_i = {R_i:.6g} mm) on {other} {second}"
    lines = [f"{bodies}, plane {pair.plane}"]
    if pair.contact == "internal":
        lines.append(f"in {check.housing}" if check.housing else "in an infinite plate")
    total = f" ({_text(check.load * pair.length)} N on {pair.length:g} mm)" if pair.length else ""
    lines.append(f"under {_text(check.load)} N/mm{total}")
    return [*lines, str(check.fit)] if check.fit else lines


def _single(check: JointCheck) -> list[str]:
    """Return the answer for one pair."""
    numbers, pair = check.numbers, check.pair
    length, yields = pair.length, numbers.first_yield_N_per_mm
    lines = [
        f"penetration       {_text(numbers.penetration_um)} µm",
        f"stiffness         {_text(numbers.stiffness_N_per_mm2)} N/mm²"
        + (f", {_text(numbers.stiffness_N_per_mm2 * length)} N/mm in all" if length else ""),
        f"width of contact  {numbers.width_mm:.3g} mm",
        f"peak pressure     {_text(numbers.peak_pressure_MPa)} MPa",
    ]
    if pair.contact == "internal":
        nominal = check.load / (2 * float(as_floats(pair.R_j)))
        lines.append(f"nominal pressure  {_text(nominal)} MPa, the load over the pin's diameter")
    if np.isnan(yields):
        lines.append(
            f"first yield       {numbers.first_yield or 'the yield stresses are not given'}"
        )
    else:
        lines.append(f"first yield       {numbers.first_yield}")
        lines.append(f"factor to yield   {yields / check.load:.3g}")
    return lines


def _text(value: float) -> str:
    """Return a number with four digits and no exponent.

    >>> _text(12.186), _text(112234.0), _text(0.00012)
    ('12.19', '112,200', '0.00012')
    """
    return f"{float(f'{value:.4g}'):,.10g}"


def _cells_of(numbers: Numbers) -> list[tuple[str, str]]:
    return [
        (name, "-" if np.isnan(value := getattr(numbers, field)) else _text(value))
        for name, field in _ROWS.items()
    ]


def _columns(check: JointCheck) -> list[str]:
    return ["", *check.band]


def _cells(check: JointCheck) -> list[list[str]]:
    columns = [dict(_cells_of(numbers)) for numbers in check.band.values()]
    rows = [[name, *(column[name] for column in columns)] for name in _ROWS]
    for place, numbers in enumerate(check.band.values(), start=1):
        if numbers.first_yield == _NO_CLEARANCE:
            rows[0][place] = _NO_CLEARANCE
    return rows


def _band_table(check: JointCheck) -> TextTable:
    """Return the numbers over the band of a fit."""
    return TextTable(_columns(check), _cells(check))


def _advice(check: JointCheck) -> list[str]:
    """Return which law to use in another code, and what the answer leaves out."""
    use = {
        "conformal": "conformal, which gave this answer, exported as a table",
        "explicit": f"explicit, a formula: here {check.error_percent:+.2f} % off in penetration",
        "johnson": "johnson, which gave this answer: a formula with Lambert's W",
    }[check.law]
    lines = [f"law to export     {use}", "not included      friction, wear, tilt, plastic flow"]
    if check.pair.contact == "internal" and check.housing is None:
        lines[1] += ", and the housing, whose deformation may be"
        lines.append(
            "                  larger than this penetration: give its outer radius (--R-o)"
        )
    return lines


def _plain(numbers: Numbers) -> dict[str, Any]:
    """Return numbers for JSON, None in the place of NaN."""
    return {
        name: None if isinstance(value, float) and np.isnan(value) else value
        for name, value in asdict(numbers).items()
    }
