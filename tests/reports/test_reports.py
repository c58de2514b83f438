"""The machinery behind the figures: benches, recipes, files, style."""

import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text
from PIL import Image

from cylcontact import InputError
from cylcontact.plots.figure import Drawing, new_figure, plain_number
from cylcontact.plots.maps import draw_contours, label_contours
from cylcontact.plots.style import figure_style
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import build, draw, find_recipes, write
from tests.support.figure_files import page_mm

ROOT = Path(__file__).parents[2]
RECIPE = """
import pandas as pd
from cylcontact.plots.figure import Drawing
from cylcontact.plots.figure import new_figure


def draw(bench):
    figure = new_figure("column", 60)
    figure.subplots().plot([1, 2], [1, 2])
    table = pd.DataFrame({"load_N_per_mm": [1 / 3]})
    return Drawing(figure, table, {"load, N/mm": 1 / 3}, "A line.")
"""


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    """A bench with two recipes and nothing else."""
    bench = Bench(tmp_path / "bench")
    bench.recipes_folder.mkdir(parents=True)
    for name in ("fig98", "fig99"):
        (bench.recipes_folder / f"{name}.py").write_text(RECIPE)
    return bench


def a_drawing() -> Drawing:
    figure = new_figure("column", 60)
    figure.subplots().set_title(r"$\Delta R$ and text")
    return Drawing(figure, pd.DataFrame({"dR_mm": [0.05]}), {}, "ΔR in mm.")


class TestBench:
    def test_folders_follow_from_the_root(self) -> None:
        bench = Bench(Path("here"))
        assert bench.results_folder == Path("here/fitting/results")
        assert Bench(Path("here"), Path("build")).results_folder == Path("build")

    def test_unknown_material_names_the_known_ones(self) -> None:
        with pytest.raises(InputError, match=r"materials\.csv: name = 'brass'.*ceramics, high-str"):
            Bench(ROOT).material("brass")

    def test_missing_result_names_the_file_and_the_command(self, bench: Bench) -> None:
        path = bench.results_folder / "internal.json"
        with pytest.raises(InputError) as caught:
            bench.result("internal")
        assert str(caught.value) == (
            f"{path}: this fit result does not exist; "
            f"make it with: cylcontact fit fitting/internal.toml -o {path}"
        )

    def test_corrupt_result_is_refused(self, bench: Bench) -> None:
        bench.results_folder.mkdir(parents=True)
        (bench.results_folder / "internal.json").write_text("{}")
        with pytest.raises(InputError, match=r"internal\.json"):
            bench.result("internal")


class TestRecipes:
    def test_every_file_with_a_figure_is_one(self, bench: Bench) -> None:
        assert list(find_recipes(bench)) == ["fig98", "fig99"]

    def test_no_recipes(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match=r"reports: holds no recipe; run this in a bench"):
            build(Bench(tmp_path))

    def test_unknown_name_is_told_before_anything_is_drawn(self, bench: Bench) -> None:
        with pytest.raises(InputError) as caught:
            build(bench, ["fig98", "fig1"])
        assert str(caught.value) == (
            f"{bench.recipes_folder}: recipe = 'fig1': there is no such recipe; "
            "choose among fig98, fig99"
        )
        assert not bench.figures_folder.exists()

    def test_unknown_name_in_draw(self, bench: Bench) -> None:
        with pytest.raises(InputError, match="recipe = 'fig1'"):
            draw("fig1", bench)

    def test_file_without_draw(self, bench: Bench) -> None:
        (bench.recipes_folder / "fig97.py").write_text("x = 1\n")
        with pytest.raises(InputError, match=r"fig97\.py: draw: a recipe must define this"):
            draw("fig97", bench)

    def test_recipe_with_a_missing_result_writes_nothing(self, tmp_path: Path) -> None:
        (figure,) = build(Bench(ROOT, tmp_path / "none"), ["fig_maps_refit"], tmp_path / "figures")
        assert "internal.json: this fit result does not exist" in str(figure.problem)
        assert figure.paths == ()
        assert not (tmp_path / "figures").exists()


class TestBuild:
    def test_returns_and_reports_what_it_wrote(self, bench: Bench) -> None:
        stages: list[tuple[str, int, int]] = []
        figures = build(bench, progress=lambda *stage: stages.append(stage))
        assert stages == [("drawing", 0, 2), ("drawing", 1, 2), ("drawing", 2, 2)]
        assert [figure.name for figure in figures] == ["fig98", "fig99"]
        assert [path.name for path in figures[0].paths] == ["fig98.png", "fig98.pdf", "fig98.csv"]
        assert all(path.is_file() for figure in figures for path in figure.paths)
        assert figures[1].headline == {"load, N/mm": 1 / 3}
        assert figures[1].caption == "A line."
        assert figures[1].size_mm == pytest.approx((84.0, 60.0))
        assert set(figures[1].inputs) == {"reports/fig99.py"}
        assert len(list(bench.figures_folder.iterdir())) == 6

    def test_numbers_have_seven_digits(self, bench: Bench) -> None:
        (figure,) = build(bench, ["fig98"])
        assert figure.paths[2].read_bytes() == b"load_N_per_mm\n0.3333333\n"

    @pytest.mark.slow
    def test_same_bytes_in_another_process(self, bench: Bench, tmp_path: Path) -> None:
        (figure,) = build(bench, ["fig98"])
        code = (
            "import sys, pathlib\n"
            "from cylcontact.reports.bench import Bench\n"
            "from cylcontact.reports.build import build\n"
            "root, out = map(pathlib.Path, sys.argv[1:])\n"
            "build(Bench(root), ['fig98'], out)\n"
            "assert 'matplotlib.pyplot' not in sys.modules\n"
        )
        command = [sys.executable, "-c", code, str(bench.root), str(tmp_path / "again")]
        source = Path(sys.modules["cylcontact"].__file__ or "").parents[2]
        environment = {"PYTHONHASHSEED": "7", "PYTHONPATH": str(source)}
        subprocess.run(command, check=True, env=environment)
        for path in figure.paths:
            assert (tmp_path / "again" / path.name).read_bytes() == path.read_bytes()

    def test_readers_settings_change_nothing(self, bench: Bench, tmp_path: Path) -> None:
        (figure,) = build(bench, ["fig98"])
        with mpl.rc_context({"font.size": 20.0, "lines.linewidth": 5.0, "pdf.fonttype": 3}):
            (again,) = build(bench, ["fig98"], tmp_path / "again")
            assert mpl.rcParams["font.size"] == 20.0
        for one, other in zip(figure.paths, again.paths, strict=True):
            assert one.read_bytes() == other.read_bytes()

    def test_caption_travels_with_the_picture(self, bench: Bench) -> None:
        (figure,) = build(bench, ["fig98"])
        with Image.open(figure.paths[0]) as png:
            assert png.info["Description"] == "A line."
            assert "Software" not in png.info
        assert b"/Subject (A line.)" in figure.paths[1].read_bytes()
        assert b"Date" not in figure.paths[1].read_bytes()

    def test_folder_that_is_a_file(self, bench: Bench, tmp_path: Path) -> None:
        (tmp_path / "figures").write_text("in the way")
        with pytest.raises(InputError, match=r"figures/fig98\.png: cannot be written"):
            build(bench, ["fig98"], tmp_path / "figures")

    def test_one_file_in_the_way_leaves_none_of_the_three(self, tmp_path: Path) -> None:
        (tmp_path / "fig.csv").mkdir()
        with pytest.raises(InputError, match=r"fig\.csv: cannot be written \(it is a folder\)"):
            write(a_drawing(), "fig", tmp_path)
        assert [path.name for path in tmp_path.iterdir()] == ["fig.csv"]

    def test_failure_while_saving_keeps_the_figure_of_before(self, tmp_path: Path) -> None:
        before = {path: path.read_bytes() for path in write(a_drawing(), "fig", tmp_path)}
        broken = a_drawing()
        broken.figure.axes[0].set_title(r"$\frac{1$")
        with pytest.raises(ValueError, match="ParseSyntaxException"):
            write(broken, "fig", tmp_path)
        assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


class TestStyle:
    @pytest.mark.parametrize(("width", "wide"), [("column", 84), ("middle", 129), ("full", 174)])
    def test_files_have_the_journals_width(self, tmp_path: Path, width: str, wide: float) -> None:
        drawing = Drawing(new_figure(width, 50), pd.DataFrame(), {}, "")  # type: ignore[arg-type]
        png, pdf, _ = write(drawing, "fig", tmp_path)
        with Image.open(png) as image:
            pixels, dpi = image.size[0], image.info["dpi"][0]
        # A picture has whole pixels only.
        assert pixels / dpi * 25.4 == pytest.approx(wide, abs=25.4 / 300)
        assert page_mm(pdf)[0] == pytest.approx(wide, abs=0.01)

    def test_style_is_put_back(self) -> None:
        before = dict(mpl.rcParams)
        with figure_style():
            assert mpl.rcParams["font.family"] == ["Arimo", "DejaVu Sans"]
        assert dict(mpl.rcParams) == before

    @pytest.mark.parametrize(
        ("value", "text"),
        [(0.0075, "0.0075"), (20.7, "20.7"), (1000, "1000"), (10000, "10\u2009000"), (2.0, "2")],
    )
    def test_plain_number(self, value: float, text: str) -> None:
        assert plain_number(value) == text


class TestContours:
    @pytest.fixture
    def plane(self) -> tuple[np.ndarray, np.ndarray]:
        return np.meshgrid(np.geomspace(1, 10, 30), np.geomspace(1, 10, 30), indexing="ij")

    def labels(self, percent: np.ndarray, plane: tuple, keep_clear: np.ndarray) -> list[Text]:
        with figure_style():
            figure = new_figure("middle", 95.0)
            axes = figure.subplots()
            axes.set(xscale="log", yscale="log")
            lines = draw_contours(axes, *plane, percent)
            figure.draw_without_rendering()
            label_contours(axes, lines, keep_clear)
        return list(lines.labelTexts)

    def test_each_label_stands_on_its_level(self, plane: tuple) -> None:
        x, y = plane
        for text in self.labels(3 * (x - y), plane, np.empty((0, 2))):
            at = text.get_position()
            level = float(text.get_text().replace("−", "-"))
            assert 3 * (at[0] - at[1]) == pytest.approx(level, abs=0.3)

    def test_labels_stay_away_from_notes(self, plane: tuple) -> None:
        x, _ = plane
        (free,) = self.labels(4 * (x - 3) / 7, plane, np.empty((0, 2)))[:1]
        (moved,) = self.labels(4 * (x - 3) / 7, plane, np.array([free.get_position()]))[:1]
        assert abs(np.log(moved.get_position()[1] / free.get_position()[1])) > 0.3

    def test_map_without_contours(self, plane: tuple) -> None:
        assert self.labels(np.full_like(plane[0], 1.0), plane, np.empty((0, 2))) == []
