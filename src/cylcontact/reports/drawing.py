"""What a recipe returns: the figure and everything that goes with it."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape

import pandas as pd
from matplotlib.figure import Figure

from cylcontact.reports.style import figure_style

SCREEN_DPI = 120


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

    def _repr_html_(self) -> str:
        """Show the figure with its caption in a notebook."""
        stream = io.BytesIO()
        with figure_style():
            self.figure.savefig(stream, format="png", dpi=SCREEN_DPI)
        picture = base64.b64encode(stream.getvalue()).decode("ascii")
        caption = escape(self.caption)
        image = f'<img alt="{caption}" src="data:image/png;base64,{picture}">'
        return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"
