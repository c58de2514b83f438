"""Results for one pair at one load, and controls that show them in a notebook.

A `Choice` is a pair, a load and a law. `numbers` computes its results, `verdicts` states them in
sentences and `view` draws them. `explore_pair` connects them to controls.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from cylcontact import limits
from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.html_repr import table_html
from cylcontact.laws import LAWS, ContactLaw, Johnson, difference_percent
from cylcontact.materials import Material, shipped_materials
from cylcontact.pair import CONTACTS, Contact, CylinderPair
from cylcontact.plain_text import as_label
from cylcontact.plots import Drawing, new_figure, plot_laws
from cylcontact.plots.style import ACCENT, COLOURS, QUIET, figure_style
from cylcontact.reports.laws_bounds import truth_of
from cylcontact.reports.notebook import require_extra

__all__ = [
    "Choice",
    "as_message",
    "as_table",
    "curve",
    "explore_pair",
    "numbers",
    "verdicts",
    "view",
]

# The ends of the curves, relative to the chosen load.
SPAN = (0.02, 5.0)
POINTS = 161
# Percent; Figs 10 to 14 call smaller differences good.
TOLERANCE = 10.0


@dataclass(frozen=True)
class Choice:
    """A pair, a load and a law.

    Attributes
    ----------
    material : Material
        Of both bodies, or of body *i* when `material_j` is given.
    contact : {"internal", "external"}
        Pin in a hole, or two rollers of equal radii.
    dR : float
        ΔR in mm: the radial clearance, or the sum of the radii.
    load : float
        In N/mm.
    law : ContactLaw
        The law to evaluate.
    R_i : float
        The radius of the hole in mm; not used for rollers, whose radii follow from ΔR.
    length : float
        The axial length in mm, for the laws that need it.
    material_j : Material, optional
        Of the pin, or of the other roller.
    """

    material: Material
    contact: Contact
    dR: float
    load: float
    law: ContactLaw
    R_i: float = 10.0
    length: float = 10.0
    material_j: Material | None = None

    @property
    def pair(self) -> CylinderPair:
        """The pair with its radii."""
        R_i = self.R_i if self.contact == "internal" else self.dR / 2
        return CylinderPair.from_dR(
            self.contact, self.dR, self.material, self.length, R_i, self.material_j
        )


def numbers(choice: Choice) -> dict[str, float]:
    """Return the results of a choice by name and unit.

    Parameters
    ----------
    choice : Choice
        What the reader has set.

    Returns
    -------
    dict of str to float
        NaN where a law is undefined, a reference does not apply, or a material has no yield
        stress; inf where there is no limit. Conformal contact is `laws.Persson`, or
        `laws.Conformal` for a pin of another material.

    Raises
    ------
    InputError
        If the law is not for this contact or these materials, or the load is not positive.

    Examples
    --------
    >>> from cylcontact import laws
    >>> steel = Material("steel", E=207e3, nu=0.3, yield_stress=250.0)
    >>> results = numbers(Choice(steel, "internal", 0.05, 100.0, laws.Enhanced()))
    >>> print(f"{results['penetration, µm']:.4f}, {results['difference from Johnson, %']:.2f} %")
    1.5144, -2.88 %
    """
    _require_load(choice.load)
    law, load, pair = choice.law, choice.load, choice.pair
    delta = law.penetration(load, pair)
    results = {
        "penetration, µm": 1e3 * delta,
        "stiffness, N/mm²": law.stiffness(delta, pair),
        "Johnson's penetration, µm": 1e3 * Johnson().penetration(load, pair),
        "difference from Johnson, %": difference_percent(law, Johnson(), load, pair),
        "difference from conformal contact, %": _from_conformal(choice, as_floats(load)),
        "Hertz's peak pressure, MPa": limits.hertz_stress(load, pair),
        "first yield, N/mm": _yield_load(choice),
        "Johnson's largest load, N/mm": limits.johnson_limit_load(pair),
        "the law's largest load, N/mm": law.max_load(pair),
        "f/(E*·ΔR), -": load / (pair.E_star * choice.dR),
    }
    return {name: float(value) for name, value in results.items()}


def verdicts(choice: Choice) -> list[str]:
    """Return sentences on a choice: the law's domain, Johnson's limit, and yield.

    Examples
    --------
    >>> from cylcontact import laws
    >>> aluminium = Material("aluminium", E=69e3, nu=0.33, yield_stress=276.0)
    >>> for line in verdicts(Choice(aluminium, "internal", 0.0075, 600.0, laws.Explicit())):
    ...     print(line)
    Johnson's law has ended: 600 N/mm is beyond its 493.8 N/mm.
    Elastic: first yield, by von Mises, is at 3951.4 N/mm.
    """
    results = numbers(choice)
    sentences = []
    if np.isnan(results["penetration, µm"]):
        sentences.append(f"The {choice.law.name} law has no answer here: outside its domain.")
    end = results["Johnson's largest load, N/mm"]
    if choice.load > end:
        sentences.append(
            f"Johnson's law has ended: {choice.load:g} N/mm is beyond its {end:.1f} N/mm."
        )
    elif abs(difference := results["difference from conformal contact, %"]) > TOLERANCE:
        sentences.append(f"{difference:+.1f} % from conformal contact, more than {TOLERANCE:g} %.")
    top = results["first yield, N/mm"]
    if np.isnan(top):
        sentences.append("No yield limit: a material has no yield stress.")
    elif choice.load > top:
        sentences.append(f"Not elastic: first yield, by von Mises, is at {top:.1f} N/mm.")
    else:
        sentences.append(f"Elastic: first yield, by von Mises, is at {top:.1f} N/mm.")
    return sentences


def curve(choice: Choice) -> pd.DataFrame:
    """Return the penetrations of the law and the references at loads around the chosen one.

    Parameters
    ----------
    choice : Choice
        What the reader has set.

    Returns
    -------
    pandas.DataFrame
        Columns load_N_per_mm, penetration_mm, johnson_penetration_mm,
        johnson_difference_percent and conformal_difference_percent; NaN beyond a law's domain,
        and the last one for rollers.
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
            "conformal_difference_percent": _from_conformal(choice, load),
        }
    )


@figure_style()
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
        If the law is not for this contact or these materials, or the load is not positive.
    """
    table, results = curve(choice), numbers(choice)
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
    force.plot(micrometres, load, **plain, color=COLOURS[1], label=as_label(choice.law.name))
    point = (results["penetration, µm"], choice.load)
    force.plot(*point, "o", color=ACCENT, label="chosen load", zorder=3)
    force.set(xlabel="penetration (µm)", ylabel="load (N/mm)", xlim=0, ylim=(0, load.iloc[-1]))
    difference.axhspan(-TOLERANCE, TOLERANCE, color="0.93", linewidth=0)
    span = (load.iloc[0], load.iloc[-1])
    for name, reference in (("Johnson", Johnson()), ("conformal", truth_of(choice.pair))):
        if table[f"{name.lower()}_difference_percent"].notna().any():
            plot_laws(
                {f"from {name}": choice.law},
                choice.pair,
                load=span,
                relative_to=reference,
                ax=difference,
                marker="",
            )
    difference.plot(choice.load, results["difference from Johnson, %"], "o", color=ACCENT, zorder=3)
    _mark_limits(difference, results, span)
    for axes in (force, difference):
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="best")
    return Drawing(figure, table, results, " ".join(verdicts(choice)))


def explore_pair(own: Sequence[Material] = ()) -> Any:
    """Return controls for two materials, a contact, a load and a law, with the results, live.

    A material fills in its numbers, which can then be changed.

    Parameters
    ----------
    own : sequence of Material, optional
        Materials to choose from, beside those that ship.

    Returns
    -------
    ipywidgets.VBox
        The controls with the table of `numbers`, and the picture of `view` below them.

    Raises
    ------
    InputError
        If ipywidgets is not installed.
    """
    widgets = require_extra("ipywidgets")
    materials = {name: row.material for name, row in shipped_materials().items()}
    materials |= {material.name: material for material in own}
    controls = _controls(widgets, list(materials))
    picture, table = widgets.HTML(), widgets.HTML()

    def fill_in(_change: object = None) -> None:
        chosen = materials[controls["material"].value]
        controls["E"].value, controls["nu"].value = chosen.E / 1e3, chosen.nu
        controls["yield_stress"].value = chosen.yield_stress or 0.0

    def update(_change: object = None) -> None:
        set_to = {name: control.value for name, control in controls.items()}
        try:
            drawn = view(_choice(set_to, materials))
        except InputError as error:
            picture.value, table.value = "", as_message(error)
            return
        picture.value, table.value = drawn._repr_html_(), as_table(drawn.headline)

    fill_in()
    update()
    controls["material"].observe(fill_in, names="value")
    for control in controls.values():
        control.observe(update, names="value")
    return widgets.VBox([widgets.HBox([widgets.VBox([*controls.values()]), table]), picture])


def _controls(widgets: Any, materials: list[str]) -> dict[str, Any]:
    """Return the controls by name."""
    wide = {"style": {"description_width": "10em"}, "layout": widgets.Layout(width="28em")}
    slider = {"base": 10, "step": 0.01, "continuous_update": False, **wide}
    number, dropdown = widgets.FloatText, widgets.Dropdown
    return {
        "material": dropdown(options=materials, description="material", **wide),
        "E": number(description="E (GPa)", **wide),
        "nu": number(description="ν (-)", **wide),
        "yield_stress": number(description="yield stress (MPa)", **wide),
        "material_j": dropdown(options=["same", *materials], description="pin or roller j", **wide),
        "contact": widgets.ToggleButtons(options=CONTACTS, description="contact", **wide),
        "dR": widgets.FloatLogSlider(value=0.05, min=-3, max=3, description="ΔR (mm)", **slider),
        "R_i": widgets.FloatLogSlider(
            value=10.0, min=0, max=3, description="R_i of the hole (mm)", **slider
        ),
        "load": widgets.FloatLogSlider(
            value=100.0, min=0, max=4, description="load (N/mm)", **slider
        ),
        "law": dropdown(options=list(LAWS), value="enhanced", description="law", **wide),
    }


def _choice(set_to: Mapping[str, Any], materials: Mapping[str, Material]) -> Choice:
    """Return the choice that controls are set to; a yield stress of 0 is none."""
    E, strength = f"{set_to['E']} GPa", set_to["yield_stress"] or None
    return Choice(
        Material(set_to["material"], E, set_to["nu"], strength),
        set_to["contact"],
        set_to["dR"],
        set_to["load"],
        LAWS[set_to["law"]](),
        set_to["R_i"],
        material_j=materials.get(set_to["material_j"]),
    )


def as_table(results: Mapping[str, float]) -> str:
    """Return the results of `numbers` as an HTML table, with a dash for NaN and "none" for inf.

    Examples
    --------
    >>> "<td>–</td>" in as_table({"first yield, N/mm": float("nan")})
    True
    """

    def cell(value: float) -> object:
        return None if np.isnan(value) else "none" if np.isinf(value) else value

    return table_html("What follows", {name: cell(value) for name, value in results.items()})


def as_message(error: InputError) -> str:
    """Return an error message as HTML.

    Examples
    --------
    >>> print(as_message(InputError("pair", "dR", -1.0, "must be > 0", "give it in mm")))
    <p role="alert">pair: dR = -1.0: must be &gt; 0; give it in mm</p>
    """
    return f'<p role="alert">{escape(str(error))}</p>'


def _mark_limits(axes: Axes, results: Mapping[str, float], span: tuple[float, float]) -> None:
    """Draw the loads at first yield and at Johnson's limit, if they are on the axis."""
    lines = {
        "first yield, N/mm": ("first yield", ":"),
        "Johnson's largest load, N/mm": ("Johnson's limit", "--"),
    }
    for key, (label, style) in lines.items():
        if span[0] <= results[key] <= span[1]:
            axes.axvline(results[key], color=QUIET, linestyle=style, label=label)


def _from_conformal(choice: Choice, load: FloatArray) -> FloatArray:
    """Return the difference from conformal contact in percent; NaN for rollers."""
    if choice.contact == "external":
        return as_floats(np.full_like(load, np.nan))
    pair = choice.pair
    return difference_percent(choice.law, truth_of(pair), load, pair)


def _yield_load(choice: Choice) -> FloatArray:
    """Return the load of first yield in N/mm; NaN where a material has no yield stress."""
    pair = choice.pair
    if pair.material_i.yield_stress is None or pair.material_j.yield_stress is None:
        return as_floats(np.nan)
    return limits.yield_load(pair)


def _require_load(load: float) -> None:
    """Raise `InputError` for a load that is not positive and finite."""
    if not (load > 0 and np.isfinite(load)):
        raise InputError("explorer", "load", load, "must be positive and finite", "give it in N/mm")
