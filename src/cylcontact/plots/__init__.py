"""Figures for papers: laws, maps and limits drawn into axes; styles, and figures that fit them."""

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


def __dir__() -> list[str]:
    return __all__
