"""Figures for papers: styles, figures that fit their style, contour maps, sketches."""

from cylcontact.plots.figure import Drawing, StyledFigure, new_figure
from cylcontact.plots.style import FigureStyle, figure_style

__all__ = ["Drawing", "FigureStyle", "StyledFigure", "figure_style", "new_figure"]


def __dir__() -> list[str]:
    return __all__
