"""No figure has a fault that a journal's desk would send back, ."""

from pathlib import Path

import pytest

from cylcontact.plots.style import JOURNAL, STYLES
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
