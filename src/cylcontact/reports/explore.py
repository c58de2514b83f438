"""Several laws for one pair at one load: in numbers, in words, in a picture, and live.

A `Choice` is what the reader has set. `numbers` are the pair's, `table` has a row for each law,
`verdicts` puts both into sentences and `view` draws them. `explore_pair` connects them to controls.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any, Literal

import numpy as np
import pandas as pd

from cylcontact.bodies.material import Material, shipped_materials
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import LAWS, Conformal, ContactLaw, Housing, Sector
from cylcontact.laws.housing_spec import in_housing, takes_housing
from cylcontact.limits import (
    first_yield,
    hertz_half_width,
    hertz_stress,
    johnson_limit_load,
)
from cylcontact.limits.sizing import half_width
from cylcontact.plots import Drawing, new_figure, plot_laws
from cylcontact.plots.figure import legend_below
from cylcontact.plots.style import ACCENT, QUIET, figure_style
from cylcontact.reports.laws_bounds import truth_of
from cylcontact.reports.laws_table import comparison
from cylcontact.reports.notebook import require_extra
from cylcontact.support.arrays import require
from cylcontact.support.errors import InputError
from cylcontact.support.html_repr import table_html

# The ends of the curves, relative to the chosen load.
_SPAN = (0.02, 5.0)
# What the choice of a clamp means for `Housing`: the side of a sector, or its whole rim.
_CLAMPS: Mapping[str, Literal["rim", "near", "far"] | None] = {
    "not known": None,
    "whole rim": "rim",
    "sector, pin pushed towards it": "near",
    "sector, pin pulled away": "far",
}
# On a telephone the picture is as wide as the screen, and the tables scroll.
_STYLE = (
    "<style>.explored {overflow-x: auto} .explored img {max-width: 100%} "
    ".explored :is(th, td) {text-align: left; padding-right: 1em}</style>"
)
_CONTACTS = {"pin in a hole": "internal", "two rollers": "external"}


@dataclass(frozen=True)
class Choice:
    """A pair, a load, some laws, and the housing around the hole.

    Attributes
    ----------
    pair : CylinderPair
        With its radii.
    load : float
        In N/mm.
    laws : tuple of str
        Names in `cylcontact.laws.LAWS`.
    housing : Housing, optional
        The datum of the laws that take one. Without it the penetration is by Johnson's.
    """

    pair: CylinderPair
    load: float
    laws: tuple[str, ...] = ("explicit",)
    housing: Housing | None = None

    def __post_init__(self) -> None:
        positive = self.load > 0 and np.isfinite(self.load)
        rule, remedy = "must be positive and finite", "give it in N/mm"
        require(positive, "explorer", "load", self.load, rule, remedy)

    @property
    def reference(self) -> ContactLaw:
        """What the laws are compared with: conformal contact, for rollers Johnson's law."""
        return truth_of(self.pair) if self.housing is None else Conformal(self.housing)

    def law(self, name: str) -> ContactLaw:
        """Return a law, in the housing if it takes one."""
        if self.housing is None or not takes_housing(name):
            return LAWS[name]()
        return in_housing(name, self.housing, "explorer")


def numbers(choice: Choice) -> dict[str, float]:
    """Return the limits of a pair and the size of its contact, by name and unit.

    Parameters
    ----------
    choice : Choice
        What the reader has set.

    Returns
    -------
    dict of str to float
        NaN for first yield where a material has no yield stress. The width is that of a strip, from
        end to end, by conformal contact; for rollers it is Hertz's, as is the pressure.

    Examples
    --------
    >>> steel = Material("steel", E=207e3, nu=0.3, yield_stress=250.0)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.95, material=steel)
    >>> results = numbers(Choice(pair, 1000.0))
    >>> print(f"{results['width of the contact, mm']:.2f}, {results['first yield, N/mm']:.0f}")
    8.65, 3599
    """
    pair, load = choice.pair, choice.load
    if pair.contact == "internal":
        conformal = Conformal(choice.housing or "johnson")
        width = np.nan if pair.R_i is None else 2 * half_width(load, pair, conformal)
        pressure = conformal.peak_pressure(load, pair)
    else:
        width, pressure = 2 * hertz_half_width(load, pair), hertz_stress(load, pair)
    known = None not in (pair.material_i.yield_stress, pair.material_j.yield_stress)
    results = {
        "width of the contact, mm": width,
        "largest pressure, MPa": pressure,
        "first yield, N/mm": first_yield(pair, housing=choice.housing).load if known else np.nan,
        "Johnson's largest load, N/mm": johnson_limit_load(pair),
        "f/(E*·ΔR), -": load / (pair.E_star * pair.dR),
    }
    return {name: float(value) for name, value in results.items()}


def table(choice: Choice) -> pd.DataFrame:
    """Return the chosen laws side by side at the chosen load.

    Parameters
    ----------
    choice : Choice
        What the reader has set.

    Returns
    -------
    pandas.DataFrame
        Columns law, penetration_um, stiffness_N_per_mm2, max_load_N_per_mm, difference_percent (of
        the penetration, from conformal contact or for rollers from Johnson's law) and note; NaN
        where a law is undefined, for the reason in the note.

    Examples
    --------
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.95, material=Material("steel", 207e3, 0.3))
    >>> print(table(Choice(pair, 1000.0, ("explicit", "johnson")))["difference_percent"].round(2))
    law
    explicit   -0.04
    johnson    -4.19
    Name: difference_percent, dtype: float64
    """
    rows = comparison(choice.pair, choice.load, housing=choice.housing).set_index("law")
    chosen = rows.loc[list(choice.laws)]
    exact = 1e3 * choice.reference.penetration(choice.load, choice.pair)
    off = 100 * (chosen["penetration_um"] / float(exact) - 1)
    chosen.insert(len(chosen.columns) - 1, "difference_percent", off)
    return chosen


def verdicts(choice: Choice) -> list[str]:
    """Return sentences on a choice: laws that end, the housing, and yield.

    Examples
    --------
    >>> aluminium = Material("aluminium", E=69e3, nu=0.33, yield_stress=276.0)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.9925, material=aluminium)
    >>> for line in verdicts(Choice(pair, 600.0, ("johnson",), Housing(15.0))):
    ...     print(line)
    johnson: beyond its largest load.
    In this housing the penetration is 0.64 times that by Johnson's datum.
    Elastic: first yield, by von Mises, is at 5874 N/mm.
    """
    return _sentences(choice, numbers(choice), table(choice))


def _sentences(choice: Choice, results: Mapping[str, float], rows: pd.DataFrame) -> list[str]:
    """Return the verdicts that follow from the numbers and the table."""
    pair, housing = choice.pair, choice.housing
    sentences = [f"{law}: {note}." for law, note in rows["note"].items() if note]
    if housing is not None:
        datums = [Conformal(datum).penetration(choice.load, pair) for datum in (housing, "johnson")]
        times = f"{float(datums[0] / datums[1]):.2f} times that by Johnson's datum"
        sentences.append(f"In this housing the penetration is {times}.")
    elif pair.contact == "internal":
        sentences.append(
            "By Johnson's datum: the housing, which is not known here, changes the penetration by "
            "more than most of these laws differ."
        )
    top = results["first yield, N/mm"]
    if np.isnan(top):
        sentences.append("First yield is not known: a material has no yield stress, or no answer.")
    else:
        state = "Not elastic" if choice.load > top else "Elastic"
        sentences.append(f"{state}: first yield, by von Mises, is at {top:.0f} N/mm.")
    return sentences


@figure_style()
def view(choice: Choice) -> Drawing:
    """Draw the penetration of the laws over the load, and their difference from the reference.

    Parameters
    ----------
    choice : Choice
        What the reader has set.

    Returns
    -------
    Drawing
        Its table is `table`, its headline `numbers`, its caption `verdicts`.

    Raises
    ------
    InputError
        If no law is for this contact and these materials.
    """
    results, rows = numbers(choice), table(choice)
    defined = rows.index[~rows["max_load_N_per_mm"].isna()]
    remedy = "choose another, such as explicit"
    require(len(defined) > 0, "explorer", "laws", choice.laws, "are none for this pair", remedy)
    laws = {name: choice.law(name) for name in defined}
    span = (_SPAN[0] * choice.load, _SPAN[1] * choice.load)
    figure = new_figure("full", 78.0)
    depth, difference = figure.subplots(1, 2)
    plot_laws(laws, choice.pair, load=span, ax=depth)
    plot_laws(laws, choice.pair, load=span, ax=difference, relative_to=choice.reference)
    for axes, column in ((depth, "penetration_um"), (difference, "difference_percent")):
        at_load = rows.loc[defined, column]
        loads = np.full(len(at_load), choice.load)
        axes.plot(loads, at_load, "o", color=ACCENT, zorder=3, label="chosen load")
        for name, style in (("first yield", ":"), ("Johnson's largest load", "--")):
            if span[0] <= results[f"{name}, N/mm"] <= span[1]:
                axes.axvline(results[f"{name}, N/mm"], color=QUIET, linestyle=style, label=name)
    reference = "Johnson's" if choice.pair.contact == "external" else "conformal contact's"
    difference.set_ylabel(f"difference from {reference} (%)")
    legend_below(depth, 4)
    return Drawing(figure, rows.reset_index(), results, " ".join(_sentences(choice, results, rows)))


def explore_pair(own: Sequence[Material] = ()) -> Any:
    """Return controls for a pair, its housing, a load and some laws, with the results, live.

    A material fills in its numbers, which can then be changed.

    Parameters
    ----------
    own : sequence of Material, optional
        Materials to choose from, beside those that ship.

    Returns
    -------
    ipywidgets.HBox
        The controls, and beside them the picture of `view` above `numbers` and `table`.

    Raises
    ------
    InputError
        If ipywidgets is not installed.
    """
    widgets = require_extra("ipywidgets")
    materials = {name: row.material for name, row in shipped_materials().items()}
    materials |= {material.name: material for material in own}
    controls = _controls(widgets, list(materials))
    answer = widgets.HTML(layout=widgets.Layout(flex="1 1 30em", min_width="0"))

    def update(_change: object = None) -> None:
        try:
            choice = _choice({name: control.value for name, control in controls.items()})
            answer.value = _as_html(choice)
        except InputError as error:
            answer.value = f'<p role="alert">{escape(str(error))}</p>'

    def fill_in(body: str) -> None:
        chosen = materials[controls[body].value]
        controls[f"{body} E"].value, controls[f"{body} ν"].value = chosen.E / 1e3, chosen.nu
        controls[f"{body} σ_Y"].value = chosen.yield_stress or 0.0

    for body in ("hole", "pin"):
        fill_in(body)
        controls[body].observe(lambda _change, body=body: fill_in(body), names="value")
    for control in controls.values():
        control.observe(update, names="value")
    update()
    left = widgets.VBox(list(controls.values()), layout=widgets.Layout(min_width="25em"))
    return widgets.HBox([left, answer], layout=widgets.Layout(flex_flow="row wrap"))


def _controls(widgets: Any, materials: list[str]) -> dict[str, Any]:
    """Return the controls by name."""
    wide = {"style": {"description_width": "9em"}, "layout": widgets.Layout(width="24em")}
    slider = {"continuous_update": False, **wide}
    log = {"base": 10, "step": 0.01, "readout_format": ".4g", **slider}

    def body(name: str, label: str) -> dict[str, Any]:
        number = widgets.BoundedFloatText
        return {
            name: widgets.Dropdown(
                options=materials, value="low-carbon steel", description=label, **wide
            ),
            f"{name} E": number(description="E (GPa)", min=1e-3, max=1e4, **wide),
            f"{name} ν": number(description="ν (-)", max=0.5, step=0.01, **wide),
            f"{name} σ_Y": number(description="yield stress (MPa)", max=1e5, **wide),
        }

    return {
        "contact": widgets.Dropdown(options=_CONTACTS, description="contact", **wide),
        **body("hole", "hole, or roller i"),
        **body("pin", "pin, or roller j"),
        "R_i": widgets.FloatLogSlider(
            value=10.0, min=0, max=3, description="R_i, hole (mm)", **log
        ),
        "dR": widgets.FloatLogSlider(value=0.05, min=-3, max=3, description="ΔR (mm)", **log),
        "length": widgets.FloatLogSlider(
            value=10.0, min=0, max=3, description="length (mm)", **log
        ),
        "clamp": widgets.Dropdown(options=list(_CLAMPS), description="housing, clamped", **wide),
        "R_o/R_i": widgets.FloatSlider(
            value=2.0, min=1.1, max=10.0, step=0.05, description="its R_o/R_i", **slider
        ),
        "angle": widgets.IntSlider(
            value=60, min=10, max=350, step=5, description="sector (degrees)", **slider
        ),
        "load": widgets.FloatLogSlider(
            value=1000.0, min=0, max=4, description="load (N/mm)", **log
        ),
        "laws": widgets.SelectMultiple(
            options=list(LAWS), value=["explicit"], rows=8, description="laws", **wide
        ),
    }


def _choice(setting: Mapping[str, Any]) -> Choice:
    """Return the choice that controls are set to; a yield stress of 0 is none."""
    hole, pin = (
        Material(
            setting[body],
            f"{setting[f'{body} E']} GPa",
            setting[f"{body} ν"],
            setting[f"{body} σ_Y"] or None,
        )
        for body in ("hole", "pin")
    )
    dR, contact = setting["dR"], setting["contact"]
    # Rollers are of equal radii.
    R_i = setting["R_i"] if contact == "internal" else dR / 2
    pair = CylinderPair.from_dR(contact, dR, hole, setting["length"], R_i, pin)
    clamp, R_o = _CLAMPS[setting["clamp"]], R_i * setting["R_o/R_i"]
    if clamp is None or contact == "external":
        housing = None
    elif clamp == "rim":
        housing = Housing(R_o)
    else:
        housing = Housing(R_o, Sector(setting["angle"], clamp))
    return Choice(pair, setting["load"], tuple(setting["laws"]) or ("explicit",), housing)


def _as_html(choice: Choice) -> str:
    """Return the picture, the numbers and the table of a choice for a notebook."""

    def cell(value: float) -> object:
        return None if np.isnan(value) else "none" if np.isinf(value) else value

    drawn = view(choice)
    results = {name: cell(value) for name, value in drawn.headline.items()}
    names = {
        "penetration_um": "penetration, µm",
        "stiffness_N_per_mm2": "stiffness, N/mm²",
        "max_load_N_per_mm": "largest load, N/mm",
        "difference_percent": "difference, %",
    }
    laws = (
        drawn.table.rename(columns=names)
        .replace(np.inf, "none")
        .to_html(index=False, float_format="{:.6g}".format, na_rep="–", border=0)
    )
    pair = table_html("The pair at this load", results)
    return f"{_STYLE}<div class='explored'>{drawn._repr_html_()}{laws}{pair}</div>"
