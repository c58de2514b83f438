"""Figures restyled without touching code: styles, formats, fonts, and many at once."""

from pathlib import Path

import matplotlib as mpl
import pytest
from PIL import Image

from cylcontact import InputError
from cylcontact.plots.figure import new_figure
from cylcontact.plots.style import STYLES, FigureOptions, choose, figure_style
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import build, chosen_recipes
from tests.support.figure_files import embedded_fonts, page_mm

ROOT = Path(__file__).parents[2]
BENCH = Bench(ROOT)
SIMPLE = """
import pandas as pd
from cylcontact.plots.figure import Drawing
from cylcontact.plots.figure import new_figure


def draw(bench):
    figure = new_figure("column", 60)
    figure.subplots().plot([1, 2], [1, 2], label="a")
    table = pd.DataFrame({"load_N_per_mm": [1 / 3]})
    return Drawing(figure, table, {}, "A line, 100 % of it: α_1 < β & {γ}.")
"""


@pytest.fixture
def small(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A bench with one recipe, as the working folder."""
    (tmp_path / "reports").mkdir()
    (tmp_path / "reports" / "fig99.py").write_text(SIMPLE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


class TestStyles:
    def test_the_style_in_force_is_put_back(self) -> None:
        with figure_style(STYLES["slides"]):
            assert mpl.rcParams["font.size"] == 13.0
            with figure_style():
                assert mpl.rcParams["font.size"] == 13.0
        with figure_style():
            assert mpl.rcParams["font.size"] == 8.0

    @pytest.mark.long
    @pytest.mark.parametrize("style", STYLES.values())
    def test_every_figure_draws_in_every_style(self, style, tmp_path: Path) -> None:
        figures = build(Bench(ROOT, jobs=2), (), tmp_path, FigureOptions(style, ("pdf",)))
        assert len(figures) == len(chosen_recipes(BENCH))
        assert [str(figure.problem) for figure in figures if figure.problem] == []


class TestFormats:
    def test_svg_has_no_date_and_the_caption_and_png_the_size(self, small: Path, run) -> None:
        actual = run("figure", "--format", "svg,png")
        assert actual == (0, "1 figure in reports/figures\n", "")
        folder = small / "reports" / "figures"
        assert sorted(path.name for path in folder.iterdir()) == [
            *("fig99.csv", "fig99.png", "fig99.svg", "fig99.txt"),
        ]
        svg = (folder / "fig99.svg").read_text(encoding="utf-8")
        assert "A line, 100 % of it" in svg
        assert "<dc:date>" not in svg
        with Image.open(folder / "fig99.png") as png:
            assert png.size[0] / 300 * 25.4 == pytest.approx(84, abs=0.1)


class TestStyleFile:
    def test_ones_own_is_read_over_the_named_one(self, tmp_path: Path) -> None:
        own = tmp_path / "style.mplstyle"
        own.write_text("font.family: DejaVu Serif\nfont.size: 18\n")
        chosen = choose(own, style="double-column", formats=("pdf", "pdf"))
        assert (chosen.style.name, chosen.formats) == ("double-column", ("pdf",))
        with figure_style(chosen.style):
            assert mpl.rcParams["font.size"] == 18
            assert mpl.rcParams["pdf.fonttype"] == 42
            figure = new_figure("column", 50)
            figure.subplots().set_title("text")
            figure.savefig(tmp_path / "own.pdf")
        fonts = embedded_fonts(tmp_path / "own.pdf")
        assert {font[: len("DejaVuSerif")] for font in fonts} == {"DejaVuSerif"}

    def test_a_mistake_is_told_with_the_file(self, tmp_path: Path) -> None:
        path = tmp_path / "style.mplstyle"
        path.write_text("font.size: large\nlines.linewidth: thick\n")
        with pytest.raises(InputError) as caught:
            choose(path)
        assert str(caught.value).startswith(f"{path}: is not a matplotlib style (")


class TestCommand:
    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (["--style", "poster"], "figure: --style = 'poster': is unknown; choose journal, "),
            (
                ["--format", "gif"],
                "figure: --format = 'gif': is unknown; choose png, pdf, svg",
            ),
            (["fig98"], "reports: recipe = 'fig98': there is no such recipe; choose among fig99"),
        ],
    )
    def test_mistakes_are_told_and_write_nothing(
        self, small: Path, run, arguments: list[str], message: str
    ) -> None:
        code, said, errors = run("figure", *arguments)
        assert (code, said, len(errors.splitlines())) == (2, "", 1)
        assert errors.startswith(f"cylcontact: {message}")
        assert [path.name for path in (small / "reports").iterdir()] == ["fig99.py"]

    def test_styled_figures_leave_the_plain_ones_alone(self, small: Path, run) -> None:
        for style in ("journal", "single-column"):
            assert run("figure", "fig99", "--style", style)[0] == 0
        folder = small / "reports" / "figures"
        assert page_mm(folder / "fig99.pdf")[0] == pytest.approx(84, abs=0.01)
        assert page_mm(folder / "single-column" / "fig99.pdf")[0] == pytest.approx(90, abs=0.01)
