"""What a recipe returns: the figure and everything that goes with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd
from matplotlib.figure import Figure


@dataclass(frozen=True)
class Drawing:
    """A figure, the numbers drawn in it, the ones that sum it up, and its caption.

    Attributes
    ----------
    figure : matplotlib.figure.Figure
        Made without pyplot.
    table : pandas.DataFrame
        The numbers drawn, one row each, units in the columns' names.
    headline : mapping of str to float
        The numbers that a reader takes away and a test pins.
    caption : str
        What is shown, with the units, the choices made and what is assumed.
    """

    figure: Figure
    table: pd.DataFrame
    headline: Mapping[str, float]
    caption: str
