"""One pair at one load, looked at from all sides: what the explorer's widgets show.

A `Choice` is what a reader has set. `numbers` gives what follows from it, `verdicts` what it
means, and `view` draws it; none of them knows of widgets.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from cylcontact import limits
from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.html_repr import table_html
from cylcontact.laws import ContactLaw, Johnson, Persson, difference_percent
from cylcontact.materials import Material
from cylcontact.pair import Contact, CylinderPair
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import ACCENT, COLOURS, QUIET

# Curves go from this share of the chosen load to this many times it.
SPAN = (0.02, 5.0)
POINTS = 161
# Figs 10 to 14 call differences within this many percent good.
TOLERANCE = 10.0


@dataclass(frozen=True)
class Choice:
    """A pair of one material, a load and a law.

    Attributes
    ----------
    material : Material
        Of both bodies.
    contact : {"internal", "external"}
        Pin in a hole, or two rollers of equal radii.
    dR : float
        ΔR in mm: the radial clearance, or the sum of the radii.
    load : float
        In N/mm.
    law : ContactLaw
        The law looked at.
    R_i : float
        The radius of the hole in mm; not used for rollers, whose radii follow from ΔR.
    length : float
        The axial length in mm, for the laws that need it.
    """

    material: Material
    contact: Contact
    dR: float
    load: float
    law: ContactLaw
    R_i: float = 10.0
    length: float = 10.0

    @property
    def pair(self) -> CylinderPair:
        """The pair, its radii known."""
        R_i = self.R_i if self.contact == "internal" else self.dR / 2
        return CylinderPair.from_dR(self.contact, self.dR, self.material, self.length, R_i)


def numbers(choice: Choice) -> dict[str, float]:
    """Return what follows from a choice, each number under its name and unit.

    Parameters
    ----------
    choice : Choice
        What the reader has set.

    Returns
    -------
    dict of str to float
        NaN where a law has no answer, a reference does not apply, or the material has no yield
        stress; inf for a limit that there is not.

    Raises
    ------
    InputError
        If the law is not for this contact, or the load is not positive.

    Examples
    --------
    >>> from cylcontact import laws
    >>> steel = Material("steel", E=207e3, nu=0.3, yield_stress=250.0)
    >>> found = numbers(Choice(steel, "internal", 0.05, 100.0, laws.Enhanced()))
    >>> print(f"{found['penetration, µm']:.4f}, {found['difference from Johnson, %']:.2f} %")
    1.5144, -2.88 %
    """
    _require_load(choice.load)
    law, load, pair = choice.law, choice.load, choice.pair
    delta = law.penetration(load, pair)
    found = {
        "penetration, µm": 1e3 * delta,
        "stiffness, N/mm²": law.stiffness(delta, pair),
        "Johnson's penetration, µm": 1e3 * Johnson().penetration(load, pair),
        "difference from Johnson, %": difference_percent(law, Johnson(), load, pair),
        "difference from Persson, %": _difference_from_persson(choice, as_floats(load)),
        "Hertz's peak pressure, MPa": limits.hertz_stress(load, pair),
        "load at yield, N/mm": _yield_load(choice),
        "Johnson's largest load, N/mm": limits.johnson_limit_load(pair),
        "the law's largest load, N/mm": law.max_load(pair),
        "f/(E*·ΔR), -": load / (pair.E_star * choice.dR),
    }
    return {name: float(value) for name, value in found.items()}


def verdicts(choice: Choice) -> list[str]:
    """Return in sentences where a choice lies: the law's domain, Johnson's, and yield.

    Examples
    --------
    >>> from cylcontact import laws
    >>> aluminium = Material("aluminium", E=69e3, nu=0.33, yield_stress=276.0)
    >>> for line in verdicts(Choice(aluminium, "internal", 0.0075, 600.0, laws.Explicit())):
    ...     print(line)
    Johnson's law has ended: 600 N/mm is beyond its 493.8 N/mm.
    Elastic: Hertz's peak pressure reaches the yield stress at 82354.7 N/mm.
    """
    found = numbers(choice)
    said = []
    if np.isnan(found["penetration, µm"]):
        said.append(f"The {choice.law.name} law has no answer here: outside its domain.")
    end = found["Johnson's largest load, N/mm"]
    if choice.load > end:
        said.append(f"Johnson's law has ended: {choice.load:g} N/mm is beyond its {end:.1f} N/mm.")
    elif abs(found["difference from Persson, %"]) > TOLERANCE:
        away = found["difference from Persson, %"]
        said.append(f"{away:+.1f} % from conformal contact, more than {TOLERANCE:g} %.")
    top = found["load at yield, N/mm"]
    if np.isnan(top):
        said.append("No yield limit: the material has no yield stress.")
    elif choice.load > top:
        said.append(
            f"Not elastic: Hertz's peak pressure reaches the yield stress at {top:.1f} N/mm."
        )
    else:
        said.append(f"Elastic: Hertz's peak pressure reaches the yield stress at {top:.1f} N/mm.")
    return said


def curve(choice: Choice) -> pd.DataFrame:
    """Return loads around the chosen one, and what the law and the references say there.

    Parameters
    ----------
    choice : Choice
        What the reader has set.

    Returns
    -------
    pandas.DataFrame
        Columns load_N_per_mm, penetration_mm, johnson_penetration_mm,
        johnson_difference_percent and persson_difference_percent; NaN beyond a law's domain and
        where Persson's law does not apply.
    """
    _require_load(choice.load)
    load = as_floats(choice.load * np.geomspace(*SPAN, POINTS))
    pair = choice.pair
    return pd.DataFrame(
        {
            "load_N_per_mm": load,
            "penetration_mm": choice.law.penetration(load, pair),
            "johnson_penetration_mm": Johnson().penetration(load, pair),
            "johnson_difference_percent": difference_percent(choice.law, Johnson(), load, pair),
            "persson_difference_percent": _difference_from_persson(choice, load),
        }
    )


def view(choice: Choice) -> Drawing:
    """Draw the law beside Johnson's, and their difference, with the limits marked.

    Parameters
    ----------
    choice : Choice
        What the reader has set.

    Returns
    -------
    Drawing
        Its headline is `numbers`, its caption `verdicts`.

    Raises
    ------
    InputError
        If the law is not for this contact, or the load is not positive.
    """
    table, found = curve(choice), numbers(choice)
    figure = new_figure("full", 78.0)
    force, difference = figure.subplots(1, 2)
    load, micrometres = table["load_N_per_mm"], 1e3 * table["penetration_mm"]
    plain = {"marker": "", "linestyle": "-"}
    force.plot(
        1e3 * table["johnson_penetration_mm"],
        load,
        **plain | {"linestyle": "--"},
        color=QUIET,
        label="Johnson",
    )
    force.plot(micrometres, load, **plain, color=COLOURS[1], label=choice.law.name)
    chosen = (found["penetration, µm"], choice.load)
    force.plot(*chosen, "o", color=ACCENT, label="chosen load", zorder=3)
    force.set(xlabel="penetration (µm)", ylabel="load (N/mm)", xlim=0, ylim=(0, load.iloc[-1]))
    difference.axhspan(-TOLERANCE, TOLERANCE, color="0.93", linewidth=0)
    for name, style in (("johnson", "-"), ("persson", "-.")):
        values = table[f"{name}_difference_percent"]
        if values.notna().any():
            label = f"from {name.capitalize()}"
            difference.plot(load, values, **plain | {"linestyle": style}, label=label)
    difference.plot(choice.load, found["difference from Johnson, %"], "o", color=ACCENT, zorder=3)
    difference.set(
        xscale="log",
        xlabel="load (N/mm)",
        ylabel="difference of penetration (%)",
        xlim=(load.iloc[0], load.iloc[-1]),
    )
    _mark_limits(difference, found, (load.iloc[0], load.iloc[-1]))
    for axes in (force, difference):
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="best")
    return Drawing(figure, table, found, " ".join(verdicts(choice)))


def as_table(found: Mapping[str, float]) -> str:
    """Return the numbers as an HTML table: a dash for NaN, "none" for a limit that there is not.

    Examples
    --------
    >>> "<td>–</td>" in as_table({"load at yield, N/mm": float("nan")})
    True
    """

    def shown(value: float) -> object:
        return None if np.isnan(value) else "none" if np.isinf(value) else value

    return table_html("What follows", {name: shown(value) for name, value in found.items()})


def as_message(error: InputError) -> str:
    """Return why there are no numbers, as HTML.

    Examples
    --------
    >>> print(as_message(InputError("pair", "dR", -1.0, "must be > 0", "give it in mm")))
    <p role="alert">pair: dR = -1.0: must be &gt; 0; give it in mm</p>
    """
    return f'<p role="alert">{escape(str(error))}</p>'


def _mark_limits(axes: Axes, found: Mapping[str, float], span: tuple[float, float]) -> None:
    """Draw the loads at yield and at Johnson's limit, where they lie on the axis."""
    lines = {
        "load at yield, N/mm": ("load at yield", ":"),
        "Johnson's largest load, N/mm": ("Johnson's limit", "--"),
    }
    for key, (label, style) in lines.items():
        if span[0] <= found[key] <= span[1]:
            axes.axvline(found[key], color=QUIET, linestyle=style, label=label)


def _difference_from_persson(choice: Choice, load: FloatArray) -> FloatArray:
    """Return the difference from conformal contact in percent; NaN for rollers."""
    if choice.contact == "external":
        return as_floats(np.full_like(load, np.nan))
    return difference_percent(choice.law, Persson(), load, choice.pair)


def _yield_load(choice: Choice) -> FloatArray:
    """Return the load at yield in N/mm; NaN where the material has no yield stress."""
    if choice.material.yield_stress is None:
        return as_floats(np.nan)
    return limits.yield_load(choice.pair)


def _require_load(load: float) -> None:
    """Refuse a load that is not positive and finite."""
    if not (load > 0 and np.isfinite(load)):
        raise InputError("explorer", "load", load, "must be positive and finite", "give it in N/mm")
