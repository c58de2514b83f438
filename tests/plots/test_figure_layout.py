"""No figure has a fault that a journal's desk would send back, ."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes

from cylcontact.plots.figure import StyledFigure, new_figure
from cylcontact.plots.style import JOURNAL, STYLES, figure_style
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import chosen_recipes, draw
from tests.support.drawn_figures import DrawnFigures, each_figure
from tests.support.figure_layout import layout_faults

BENCH = Bench(Path(__file__).parents[2])
NAMES = chosen_recipes(BENCH)
MOST_WORDS = 60


@each_figure(NAMES)
class TestEveryFigure:
    def test_in_the_journals_style(self, figures: DrawnFigures, name: str) -> None:
        assert layout_faults(figures[name].drawing.figure) == []

    def test_caption_is_short_and_the_rest_in_a_note(
        self, figures: DrawnFigures, name: str
    ) -> None:
        drawing = figures[name].drawing
        assert len(drawing.caption.split()) <= MOST_WORDS
        assert drawing.method.endswith(".")


@pytest.mark.slow
@pytest.mark.parametrize("style", [name for name in STYLES if name != JOURNAL.name])
@pytest.mark.parametrize("name", ["fig12", "fig_explicit", "fig_housing"])
def test_in_other_styles(name: str, style: str) -> None:
    assert layout_faults(draw(name, BENCH, STYLES[style]).figure, STYLES[style]) == []


def _label_across_contours(axes: Axes) -> None:
    x = np.linspace(0.0, 1.0, 20)
    axes.contour(x, x, np.add.outer(x, x))
    axes.text(0.5, 0.2, "fitted from 0.05 mm on", rotation=90)


def _struck_through(axes: Axes) -> None:
    axes.plot([0.0, 1.0], [0.5, 0.5])
    axes.text(0.5, 0.5, "658 N/mm", va="center")


def _out_of_the_frame(axes: Axes) -> None:
    axes.text(0.9, 0.5, "an annotation that is longer than its panel")


def _off_the_page(axes: Axes) -> None:
    axes.figure.text(0.9, 0.5, "beyond the right margin").set_in_layout(False)


def _too_small(axes: Axes) -> None:
    axes.text(0.5, 0.5, "small print", fontsize=5.0)


def _legend_over_a_line(axes: Axes) -> None:
    axes.plot([0.0, 1.0], [1.0, 0.0], label="a line that runs through its own legend")
    axes.legend(loc="center")


@pytest.mark.parametrize(
    ("spoil", "fault"),
    [
        (_label_across_contours, "'fitted from 0.05 mm on' has a line through it"),
        (_struck_through, "'658 N/mm' has a line through it"),
        (_out_of_the_frame, "'an annotation that is longer than its panel' crosses the frame"),
        (_off_the_page, "'beyond the right margin' leaves the page"),
        (_too_small, "'small print' has 5.0 points"),
        (_legend_over_a_line, "'a line that runs through its own legend' has a line through it"),
    ],
)
def test_each_fault_is_found(spoil: Callable[[Axes], None], fault: str) -> None:
    with figure_style():
        figure = new_figure("column", 60.0)
        axes = figure.subplots()
        axes.set(xlim=(0, 1), ylim=(0, 1))
        assert layout_faults(figure) == []
        spoil(axes)
    assert any(found.startswith(fault) for found in layout_faults(figure))


def test_a_width_that_is_not_the_styles_is_found() -> None:
    assert layout_faults(StyledFigure(figsize=(5.0, 3.0))) == ["is 127.0 mm wide"]
