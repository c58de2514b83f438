"""A figure and claims of one's own, as files of a folder's `reports`, and the shipped figures."""

import contextlib
import functools
from pathlib import Path

from cylcontact.plots import figure_style
from cylcontact.reports.figures import recipes

ROOT = Path(__file__).parents[2]

FIGURE = '''
import pandas as pd

from cylcontact.plots import new_figure


def fig99(load="10", name="mine"):
    """A load of {load} N/mm."""
    figure = new_figure("column", 60.0)
    figure.subplots().plot([0, 1], [0, float(load)])
    return figure, pd.DataFrame({"load_N_per_mm": [float(load)]})


FIGURES = {"fig99": fig99}
'''
CLAIMS = '''
from cylcontact.reports import claim


@claim("1", "2", "one and one is two")
def sum_of_ones():
    """One and one is two."""
    yield "as numbers", f"{1 + 1}", 1 + 1 == 2
    yield "as texts", "11", "1" + "1" == "2"
    yield "as defined here", "2", None


@claim("2", "3", "one and one is three")
def wrong_sum():
    """One and one is three."""
    yield "as numbers", f"{1 + 1}", 1 + 1 == 3
'''


@functools.cache
def shipped_figure(name, **arguments):
    """Return a figure of the checkout, not yet arranged, with its numbers; once in a process."""
    with contextlib.chdir(ROOT), figure_style():
        return recipes(ROOT)[name](**arguments)
