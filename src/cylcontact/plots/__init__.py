"""Figures for papers: laws, maps and limits drawn into axes; styles, and figures that fit them."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cylcontact.plots.difference_map import map_table, plot_map
    from cylcontact.plots.figure import Drawing, StyledFigure, new_figure
    from cylcontact.plots.law_curves import plot_laws
    from cylcontact.plots.limit_curves import plot_limits
    from cylcontact.plots.style import figure_style

__all__ = [
    "Drawing",
    "StyledFigure",
    "figure_style",
    "map_table",
    "new_figure",
    "plot_laws",
    "plot_limits",
    "plot_map",
]

# Loaded on first use: a fit draws its picture without the others.
_MODULES = {
    **dict.fromkeys(("map_table", "plot_map"), "difference_map"),
    **dict.fromkeys(("Drawing", "StyledFigure", "new_figure"), "figure"),
    "plot_laws": "law_curves",
    "plot_limits": "limit_curves",
    "figure_style": "style",
}


def __getattr__(name: str) -> object:
    if name in _MODULES:
        return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
