"""What the functions that draw laws share: their laws, ranges and axes, and the legend."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import LAWS, ContactLaw
from cylcontact.plots.figure import new_figure
from cylcontact.plots.style import figure_style
from cylcontact.support.arrays import FloatArray, require
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import as_label

__all__ = [
    "AnyLaw",
    "Range",
    "as_law",
    "axes_for",
    "law_label",
    "pins_in_hole",
    "require_line",
    "require_one_pair",
    "require_range",
]

AnyLaw = ContactLaw | str
Range = tuple[float, float]
# Laws that are called after what they are.
_DESCRIBED = ("conformal", "enhanced", "explicit")


@contextmanager
def axes_for(ax: Axes | None, source: str, width: str, height_mm: float) -> Iterator[Axes]:
    """Yield the caller's axes, or new ones in a figure and a style of our own.

    Examples
    --------
    >>> with axes_for(None, "example", "column", 60.0) as axes:
    ...     _ = axes.plot([1, 2], [1, 2])
    """
    if ax is None:
        with figure_style():
            yield new_figure(width, height_mm).subplots()
        return
    require(
        isinstance(ax, Axes),
        source,
        "ax",
        ax,
        "must be one matplotlib Axes",
        "give one panel, e.g. axes[0] of fig, axes = plt.subplots(1, 2)",
    )
    yield ax


def as_law(law: AnyLaw, source: str, key: str) -> ContactLaw:
    """Return a law from itself or its name.

    Examples
    --------
    >>> as_law("johnson", "example", "law")
    Johnson()
    """
    if isinstance(law, str):
        if law not in LAWS:
            rule = "is not a law with its coefficients"
            raise InputError(source, key, law, rule, f"choose {', '.join(LAWS)}, or give a law")
        return LAWS[law]()
    require(
        hasattr(law, "penetration") and not isinstance(law, type),
        source,
        key,
        law,
        "must be a law or its name",
        "give e.g. laws.Johnson(), with parentheses",
    )
    return law


def law_label(name: str, possessive: bool = False) -> str:
    """Return a law's name as a figure writes it; one that is called after a person has capitals.

    Examples
    --------
    >>> law_label("lankarani-nikravesh"), law_label("johnson", possessive=True)
    ('Lankarani-Nikravesh', "Johnson's")
    >>> law_label("enhanced"), law_label("explicit", possessive=True)
    ('enhanced', "the explicit law's")
    """
    if name in LAWS and name not in _DESCRIBED:
        person = name.title().replace("Esdu", "ESDU")
        return f"{person}'s" if possessive else person
    label = as_label(name)
    return f"the {label} law's" if possessive else label


def require_range(given: Range, source: str, key: str, unit: str) -> None:
    """Raise `InputError` unless `given` is a positive, increasing and finite range.

    Examples
    --------
    >>> require_range((1000.0, 10.0), "example", "load", "N/mm")
    Traceback (most recent call last):
    cylcontact.support.errors.InputError: example: load = (1000.0, 10.0): must be two positive
    numbers, the lower first; give them in N/mm
    """
    try:
        low, high = (float(end) for end in given)
    except (TypeError, ValueError):
        low, high = np.nan, np.nan
    require(
        0 < low < high < np.inf,
        source,
        key,
        given,
        "must be two positive numbers, the lower first",
        f"give them in {unit}",
    )


def require_line(settings: Mapping[str, object], source: str, takes: str) -> None:
    """Raise `InputError` for a setting that matplotlib's lines do not have.

    Examples
    --------
    >>> require_line({"loads": (1.0, 2.0)}, "plot_laws", "laws, pair, load")
    Traceback (most recent call last):
    cylcontact.support.errors.InputError: plot_laws: loads = (1.0, 2.0): is neither an argument nor
    a setting of a line; the arguments are laws, pair, load
    """
    for name, value in settings.items():
        rule = "is neither an argument nor a setting of a line"
        known = hasattr(Line2D, f"set_{name}")
        require(known, source, name, value, rule, f"the arguments are {takes}")


def pins_in_hole(
    clearances: FloatArray,
    source: str,
    material: Material,
    R_i: float,
    material_j: Material | None = None,
    length: float | None = None,
) -> CylinderPair:
    """Return pins of many clearances in one hole, in mm."""
    one = CylinderPair.from_dR("internal", clearances.flat[0], material, length, R_i, material_j)
    require_one_pair(one, source, "material, R_i")
    return CylinderPair.from_dR("internal", clearances, material, length, R_i, material_j)


def require_one_pair(pair: CylinderPair, source: str, key: str) -> None:
    """Raise `InputError` for a pair that holds arrays, or is none."""
    remedy = "build one with CylinderPair.internal or .external"
    require(isinstance(pair, CylinderPair), source, key, pair, "must be a CylinderPair", remedy)
    numbers = (pair.dR, pair.R_i, *pair.moduli)
    require(
        all(number is None or np.ndim(number) == 0 for number in numbers),
        source,
        key,
        None,
        "must hold single numbers, no arrays",
        "call once for each, with the same ax",
    )
