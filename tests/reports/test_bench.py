"""The bench as a package of its own, its recipes' arguments, and what a user adds to it."""

import ast
import doctest
import os
import shutil
import sys
from pathlib import Path

import pandas as pd
import pytest

import cylcontact
from cylcontact import CylinderPair, Material, limits
from cylcontact.laws import LAWS
from cylcontact.materials import COLUMNS
from cylcontact.parallel import call, run_calls
from cylcontact.plots.style import JOURNAL, FigureOptions
from cylcontact.reports.bench import Bench, call_in_bench
from cylcontact.reports.build import build, chosen_recipes, draw, find_recipes
from tests.support.drawn_figures import BENCH, DrawnFigures
from tests.support.spec_files import tree

ROOT = BENCH.root
SOURCE = Path(cylcontact.__file__).parent
SVG = FigureOptions(JOURNAL, ("svg",))
RECIPE = '''"""Loads over loads."""

import pandas as pd

from cylcontact.plots import Drawing, new_figure

from .paper import LOADS


def draw(bench):
    figure = new_figure("column", 60)
    figure.subplots().plot(LOADS, LOADS)
    table = pd.DataFrame({"load_N_per_mm": LOADS})
    return Drawing(figure, table, {"largest load, N/mm": max(LOADS)}, "A line of loads, N/mm.")
'''
TWO_FIGURES = """
from functools import partial

from .fig99 import draw as line


def named(bench, name):
    return line(bench)


FIGURES = {name: partial(named, name=name) for name in ("fig97", "fig98")}
"""
CLAIM = """
from cylcontact.reports.claims import Finding, claim

from ..paper import LOADS


@claim("7-light", "the loads are light", paper="light", rule="at most 1000 N/mm")
def light():
    return Finding(f"{max(LOADS):g} N/mm", holds=max(LOADS) <= 1000)
"""


def put(bench: Bench, name: str, text: str) -> Path:
    """Write a file of a bench's `reports` folder."""
    path = bench.recipes_folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    """A bench with constants and one recipe that imports them, as the working folder."""
    bench = Bench(tmp_path / "bench")
    put(bench, "paper.py", "LOADS = (10.0, 1000.0)\n")
    put(bench, "fig99.py", RECIPE)
    monkeypatch.chdir(bench.root)
    return bench


@pytest.fixture
def maps_bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    """The shipped maps with a few fits and a material of its own, as the working folder."""
    bench = Bench(tmp_path / "bench")
    for folder in (bench.recipes_folder, bench.results_folder, bench.materials_file.parent):
        folder.mkdir(parents=True)
    for name in ("paper.py", "maps.py"):
        shutil.copy(ROOT / "reports" / name, bench.recipes_folder)
    for name in ("practical", "conformal", "external"):
        shutil.copy(BENCH.result_file(f"{name}.json"), bench.results_folder)
    row = "gunmetal,110,assumed,0.34,assumed,220,assumed,ours"
    bench.materials_file.write_text(f"{','.join(COLUMNS[:8])}\n{row}\n", encoding="utf-8")
    monkeypatch.chdir(bench.root)
    return bench


PRACTICAL = {"material": "low-carbon steel", "law": "practical"}


class TestModules:
    def test_files_import_each_other_relatively(self, bench: Bench) -> None:
        assert bench.module("fig99").LOADS == (10.0, 1000.0)

    def test_an_unchanged_file_is_read_once(self, bench: Bench) -> None:
        assert bench.module("paper") is bench.module("paper")

    def test_a_changed_file_is_read_anew_and_so_is_what_imports_it(self, bench: Bench) -> None:
        assert draw("fig99", bench).headline == {"largest load, N/mm": 1000.0}
        put(bench, "paper.py", "LOADS = (10.0, 20.0, 2000.0)\n")
        assert draw("fig99", bench).headline == {"largest load, N/mm": 2000.0}

    def test_two_benches_in_one_process(self, bench: Bench, tmp_path: Path) -> None:
        other = Bench(tmp_path / "other")
        put(other, "paper.py", "LOADS = (1.0, 2.0)\n")
        put(other, "fig99.py", RECIPE)
        largest = [draw("fig99", each).table.max().item() for each in (bench, other, bench)]
        assert largest == [1000.0, 2.0, 1000.0]

    def test_nothing_compiled_is_left_in_the_folder(self, bench: Bench) -> None:
        before = sys.dont_write_bytecode
        build(bench, options=SVG)
        assert sys.dont_write_bytecode == before
        assert sorted(path.name for path in bench.recipes_folder.iterdir()) == [
            *("fig99.py", "figures", "paper.py"),
        ]

    @pytest.mark.slow
    def test_workers_call_its_functions(self, bench: Bench) -> None:
        text = "import os\n\nfrom .paper import LOADS\n\n\ndef scaled(factor):\n"
        put(bench, "loads.py", text + "    return os.getpid(), factor * LOADS[0]\n")
        work = [call(call_in_bench, bench.root, "loads", "scaled", k) for k in (1, 2, 3)]
        processes, loads = zip(*run_calls(work, 2), strict=True)
        assert loads == (10.0, 20.0, 30.0)
        assert os.getpid() not in processes


class TestRecipes:
    def test_they_are_listed_without_being_run(self, bench: Bench) -> None:
        put(bench, "fig98.py", "def draw(bench): ...\n\n\nraise RuntimeError\n")
        put(bench, "helper.py", "raise RuntimeError\n")
        assert list(find_recipes(bench)) == ["fig98", "fig99"]

    def test_a_file_may_list_several_figures(self, bench: Bench) -> None:
        several = put(bench, "several.py", TWO_FIGURES)
        assert find_recipes(bench) == {
            "fig97": several,
            "fig98": several,
            "fig99": bench.recipes_folder / "fig99.py",
        }
        (figure,) = build(bench, ["fig98"], options=SVG)
        assert [path.name for path in figure.paths] == ["fig98.svg", "fig98.csv"]

    def test_inputs_name_the_files_that_it_imports(self, bench: Bench) -> None:
        put(bench, "several.py", TWO_FIGURES)
        several, _, single = build(bench, options=SVG)
        assert set(single.inputs) == {"reports/fig99.py", "reports/paper.py"}
        assert set(several.inputs) == {"reports/several.py", *single.inputs}

    def test_inputs_of_a_map(self, maps_bench: Bench) -> None:
        (figure,) = build(maps_bench, ["maps"], options=SVG, arguments=PRACTICAL)
        assert set(figure.inputs) == {
            "reports/maps.py",
            "reports/paper.py",
            "cylcontact/data/materials.csv",
            "fitting/results/practical.json",
        }

    @pytest.mark.parametrize(
        ("name", "text", "problem"),
        [
            ("fig98", "def draw(bench:\n", "failed with SyntaxError ('(' was never closed"),
            ("fig98", "import no_such\n\ndef draw(bench): ...\n", "failed with ModuleNotFound"),
            ("several", "FIGURES = {'fig97': no_such}\n", "failed with NameError (name 'no_such'"),
        ],
    )
    def test_a_broken_file_is_a_problem_of_its_own(
        self, bench: Bench, name: str, text: str, problem: str
    ) -> None:
        file = put(bench, f"{name}.py", text)
        broken, sound = sorted(build(bench, options=SVG), key=lambda figure: not figure.problem)
        assert (broken.name, sound.name) == (name, "fig99")
        assert str(broken.problem).startswith(f"{file}: {problem}")
        assert [path.name for path in sound.paths] == ["fig99.svg", "fig99.csv"]
        assert sound.problem is None


class TestMapsByArgument:
    def test_the_papers_maps_among_them(
        self, figures: DrawnFigures, maps_bench: Bench, run
    ) -> None:
        done = run("figure", "maps", "material=low-carbon steel", "--format", "svg", "--jobs", 1)
        assert done == (0, "1 figure in reports/figures\n", "")
        csv = maps_bench.figures_folder / "maps-low-carbon-steel.csv"
        drawn, papers = map(pd.read_csv, (csv, figures["fig12"].paths[0].with_suffix(".csv")))
        pd.testing.assert_frame_equal(drawn, papers, check_exact=True)
        assert csv.with_suffix(".svg").is_file()

    @pytest.mark.slow
    def test_the_yield_line_is_first_yield_by_von_mises(self, maps_bench: Bench) -> None:
        drawing = draw("maps", maps_bench, arguments={"material": "gunmetal"})
        gunmetal = Material("gunmetal", 110e3, 0.34, 220)
        for dR, load in drawing.table[["dR_mm", "yield_load_N_per_mm"]].drop_duplicates().values:
            pair = CylinderPair.internal(R_i=10.0, R_j=10.0 - dR, material=gunmetal)
            assert load == pytest.approx(float(limits.yield_load(pair)), rel=1e-6, abs=0)
        texts = [text.get_text() for text in drawing.figure.legends[0].get_texts()]
        assert "first yield (von Mises), $R_i$ = 10 mm; ticked side yields" in texts
        assert "von Mises stress in either body" in drawing.method
        table = drawing.table
        elastic = table[table["load_N_per_mm"] <= table["yield_load_N_per_mm"]]
        assert drawing.headline["largest |difference| before first yield, %"] == (
            elastic["difference_percent"].abs().max()
        )

    def test_a_law_and_a_reference(self, maps_bench: Bench, run) -> None:
        arguments = ("material=gunmetal", "law=explicit", "reference=persson")
        assert run("figure", "maps", *arguments, "--format", "svg", "--jobs", 1)[0] == 0
        csv = maps_bench.figures_folder / "maps-gunmetal-explicit-persson.csv"
        assert "persson_penetration_mm" in csv.read_text().partition("\n")[0]

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            (["maps"], "maps: material: is needed; write: cylcontact figure maps material=…"),
            (
                ["maps", "law=explicit"],
                "maps: material: is needed; write: cylcontact figure maps material=…",
            ),
            (
                ["maps", "material=brass"],
                "datasets/materials.csv: name = 'brass': no material has this name; add it to this "
                "table, or choose ceramics, high-strength steel, low-carbon steel, titanium alloy, "
                "aluminium alloy, bronze, PEEK, PTFE, gunmetal",
            ),
            (
                ["maps", "material=ceramics", "law=no-such"],
                "maps: law = 'no-such': is neither a law nor a fit result in fitting/results; "
                f"choose {', '.join(LAWS)}, or fit it",
            ),
            (
                ["maps", "material=ceramics", "law=external"],
                "maps: law = 'external': is not a fit on a grid of internal contacts; choose one "
                "that is",
            ),
            (
                ["maps", "material=ceramics", "reference=liu"],
                "maps: reference = 'liu': is not a reference of the maps; choose johnson, persson",
            ),
            (
                ["maps", "material=ceramics", "colour=red"],
                "maps: colour = 'red': takes material, law, reference; write: cylcontact figure "
                "maps material=…",
            ),
            (
                ["fig12", "material=ceramics"],
                "fig12: material = 'ceramics': takes no arguments; write: cylcontact figure fig12",
            ),
            (
                ["fig98", "material=ceramics"],
                "fig98: material = 'ceramics': takes no arguments; write: cylcontact figure fig98",
            ),
            (
                ["maps", "fig12", "material=ceramics"],
                "figure: material = 'ceramics': is an argument of one recipe; name that recipe "
                "before it, and no other",
            ),
            (
                ["material=ceramics"],
                "figure: material = 'ceramics': is an argument of one recipe; name that recipe "
                "before it, and no other",
            ),
        ],
    )
    def test_mistakes(self, maps_bench: Bench, run, words: list[str], message: str) -> None:
        put(maps_bench, "fig98.py", RECIPE)
        assert run("figure", *words, "--jobs", 1) == (2, "", f"cylcontact: {message}\n")
        assert not maps_bench.figures_folder.exists()

    def test_without_arguments_all_other_figures_are_drawn(self) -> None:
        assert set(find_recipes(BENCH)) - set(chosen_recipes(BENCH)) == {"maps"}


class TestAdditions:
    def test_a_figure_is_one_file(self, bench: Bench, run) -> None:
        put(bench, "fig_mine.py", RECIPE.replace("A line of loads", "Loads of mine"))
        assert run("figure", "fig_mine", "--jobs", 1)[:2] == (0, "1 figure in reports/figures\n")
        assert {path.suffix for path in bench.figures_folder.glob("fig_mine.*")} == {
            *(".png", ".pdf", ".csv"),
        }
        code, out, errors = run("report", "--jobs", 1)
        assert (code, out, errors) == (0, "open build/site/index.html\n", "")
        page = Path("build/site/figures.html").read_text(encoding="utf-8")
        assert "Loads of mine, N/mm." in page
        assert 'href="figures/fig_mine.csv"' in page

    @pytest.mark.slow
    def test_a_material_is_one_row_and_moves_no_other_figure(
        self, figures: DrawnFigures, maps_bench: Bench, run
    ) -> None:
        assert run("figure", "maps", "material=gunmetal", "--format", "svg", "--jobs", 1)[0] == 0
        assert (maps_bench.figures_folder / "maps-gunmetal.svg").is_file()
        for name in ("fig07", "clearance"):
            shutil.copy(ROOT / "reports" / f"{name}.py", maps_bench.recipes_folder)
        for drawn in build(maps_bench, ["fig07", "fig10", "fig14"], options=SVG):
            assert drawn.paths[-1].read_bytes() == figures[drawn.name].paths[-1].read_bytes()
            assert "datasets/materials.csv" not in drawn.inputs

    def test_no_output_replaces_an_input(self, bench: Bench, run) -> None:
        text = RECIPE.replace(
            "    figure =", "    bench.input('datasets/loads.csv').read_text()\n    figure ="
        )
        put(bench, "loads.py", text)
        for name in ("materials", "loads"):
            put(bench, f"../datasets/{name}.csv", "mine\n")
        before = tree(bench.root)
        for command, name in (
            (("claims", "-o", "datasets/materials.csv"), "materials"),
            (("figure", "loads", "-o", "datasets", "--jobs", 2), "loads"),
        ):
            code, out, errors = run(*command)
            assert (code, out) == (2, "")
            assert f"datasets/{name}.csv: cannot be written (it is an input)" in errors
            assert errors.count("\n") == 1
        assert tree(bench.root) == before

    def test_without_claims_there_is_no_ledger(self, run, tmp_path, monkeypatch) -> None:
        monkeypatch.chdir(tmp_path)
        code, out, errors = run("claims")
        assert (code, out, errors.count("\n")) == (2, "", 1)
        assert "reports/claims: there are no claims here" in errors

    def test_a_claim_is_one_function(self, bench: Bench, run) -> None:
        put(bench, "claims/mine.py", CLAIM)
        code, out, errors = run("claims", "--jobs", 1)
        assert (code, errors) == (0, "")
        assert out.startswith("Of 1 testable statement, 1 is reproduced.")
        assert "7-light\n  the paper says  the loads are light: light\n" in out


def imports(file: Path) -> set[str]:
    """Return the modules that a file imports; those of its own folder begin with a dot."""
    names = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            start = "." * node.level + (node.module or "")
            names |= {start, *(f"{start.rstrip('.')}.{alias.name}" for alias in node.names)}
    return names


class TestShippedBench:
    @pytest.mark.parametrize("name", sorted(path.stem for path in ROOT.glob("reports/*.py")))
    def test_examples_run(self, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(ROOT)
        assert (
            doctest.testmod(BENCH.module(name), optionflags=doctest.NORMALIZE_WHITESPACE).failed
            == 0
        )

    def test_no_figure_depends_on_the_claims(self) -> None:
        queue = sorted(set(find_recipes(BENCH).values()))
        for file in queue:  # grows by what its files import
            imported = imports(file)
            assert not [name for name in imported if "claims" in name], file.name
            neighbours = [BENCH.recipes_folder / f"{name[1:]}.py" for name in imported]
            queue += [each for each in neighbours if each.is_file() and each not in queue]
        assert BENCH.recipes_folder / "slider_crank.py" in queue

    @pytest.mark.slow
    def test_the_package_depends_on_no_bench_and_no_paper(self) -> None:
        naming = set()
        for file in SOURCE.rglob("*.py"):
            assert not [each for each in imports(file) if "_cylcontact_bench" in each]
            tree = ast.parse(file.read_text(encoding="utf-8"))
            docstrings = {
                id(node.value)
                for node in ast.walk(tree)
                if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
            }
            naming |= {
                file.relative_to(SOURCE).as_posix()
                for node in ast.walk(tree)
                if isinstance(node, ast.Constant) and id(node) not in docstrings
                if "Pereira" in str(node.value)
            }
        # Exported formulas cite the source of their coefficients.
        assert naming == {"laws/enhanced.py"}
        assets = (SOURCE / "reports" / "html").rglob("*.[jc]*")
        assert not [path for path in assets if b"Pereira" in path.read_bytes()]


def test_a_figure_of_a_file_that_cannot_be_imported_is_told_with_that_file(bench, run):
    listing = put(bench, "maps.py", TWO_FIGURES)
    assert run("figure", "fig97", "-j", 1)[0] == 0
    for line, told in (
        ("def broken(:", "failed with SyntaxError (invalid syntax (maps.py, line 12))"),
        ("import absent_module", "failed with ModuleNotFoundError"),
    ):
        listing.write_text(f"{TWO_FIGURES}{line}\n")
        code, said, errors = run("figure", "fig97")
        assert (code, said, errors.count("\n")) == (2, "", 1)
        assert f"there is no such recipe, unless in a file that {told}" in errors
        assert "correct reports/maps.py, or choose among" in errors
