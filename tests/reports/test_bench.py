"""The bench: its files as a package, recipes, what is written, and what a user adds to it."""

import ast
import doctest
import os
import shutil
from pathlib import Path

import matplotlib as mpl
import pandas as pd
import pytest
from PIL import Image

import cylcontact
from cylcontact import InputError
from cylcontact.bodies.material import COLUMNS
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import JOURNAL, FigureOptions
from cylcontact.reports.bench import Bench, call_in_bench
from cylcontact.reports.build import build, chosen_recipes, draw, find_recipes, write
from cylcontact.support.parallel import call, run_calls
from tests.support.drawn_figures import BENCH
from tests.support.figure_files import embedded_fonts, page_mm
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


def put(bench, name, text):
    """Write a file of a bench's `reports` folder."""
    path = bench.recipes_folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A bench with constants and one recipe that imports them, as the working folder."""
    bench = Bench(tmp_path / "bench")
    put(bench, "paper.py", "LOADS = (10.0, 1000 / 3)\n")
    put(bench, "fig99.py", RECIPE)
    monkeypatch.chdir(bench.root)
    return bench


@pytest.fixture
def maps_bench(tmp_path, monkeypatch):
    """The shipped maps with a few fits and a material of its own, as the working folder."""
    bench = Bench(tmp_path / "bench")
    for folder in (bench.recipes_folder, bench.results_folder, bench.materials_file.parent):
        folder.mkdir(parents=True)
    for name in ("paper.py", "maps.py"):
        shutil.copy(ROOT / "reports" / name, bench.recipes_folder)
    for name in ("practical", "external"):
        shutil.copy(BENCH.result_file(f"{name}.json"), bench.results_folder)
    row = "gunmetal,110,assumed,0.34,assumed,220,assumed,ours"
    bench.materials_file.write_text(f"{','.join(COLUMNS[:8])}\n{row}\n", encoding="utf-8")
    monkeypatch.chdir(bench.root)
    return bench


# --- its inputs and its modules ---


def test_what_is_missing_names_the_file_and_the_remedy(bench):
    path = bench.results_folder / "internal.json"
    with pytest.raises(InputError) as caught:
        bench.result("internal")
    assert str(caught.value) == (
        f"{path}: this fit result does not exist; "
        f"make it with: cylcontact fit fitting/internal.toml -o {path}"
    )
    path.parent.mkdir(parents=True)
    path.write_text("{}")
    with pytest.raises(InputError, match=r"internal\.json"):
        bench.result("internal")


def test_a_changed_file_is_read_anew_and_so_is_what_imports_it(bench, tmp_path):
    assert bench.module("paper") is bench.module("paper")
    assert draw("fig99", bench).table.max().item() == 1000 / 3
    put(bench, "paper.py", "LOADS = (10.0, 20.0, 2000.0)\n")
    other = Bench(tmp_path / "other")
    put(other, "paper.py", "LOADS = (1.0, 2.0)\n")
    put(other, "fig99.py", RECIPE)
    largest = [draw("fig99", each).table.max().item() for each in (bench, other, bench)]
    assert largest == [2000.0, 2.0, 2000.0]


@pytest.mark.slow
def test_workers_call_its_functions(bench):
    text = "import os\n\nfrom .paper import LOADS\n\n\ndef scaled(factor):\n"
    put(bench, "loads.py", text + "    return os.getpid(), factor * LOADS[0]\n")
    work = [call(call_in_bench, bench.root, "loads", "scaled", k) for k in (1, 2, 3)]
    processes, loads = zip(*run_calls(work, 2), strict=True)
    assert loads == (10.0, 20.0, 30.0)
    assert os.getpid() not in processes


# --- recipes ---


def test_recipes_are_listed_without_being_run_and_a_file_may_list_several(bench):
    put(bench, "fig96.py", "def draw(bench): ...\n\n\nraise RuntimeError\n")
    several = put(bench, "several.py", TWO_FIGURES)
    assert list(find_recipes(bench)) == ["fig96", "fig97", "fig98", "fig99"]
    assert find_recipes(bench)["fig97"] == several
    (figure,) = build(bench, ["fig98"], options=SVG)
    assert [path.name for path in figure.paths] == ["fig98.svg", "fig98.csv", "fig98.txt"]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("def draw(bench:\n", "failed with SyntaxError ('(' was never closed"),
        ("import no_such\n\ndef draw(bench): ...\n", "failed with ModuleNotFound"),
        ("FIGURES = {'fig97': no_such}\n", "failed with NameError (name 'no_such'"),
        ("def draw(bench):\n    return None.x\n", "draw: failed with AttributeError"),
    ],
)
def test_a_broken_file_is_a_problem_of_its_own(bench, run, text, problem):
    file = put(bench, "fig98.py", text)
    broken, sound = sorted(build(bench, options=SVG), key=lambda figure: not figure.problem)
    assert str(broken.problem).startswith(f"{file}: {problem}")
    assert [path.name for path in sound.paths] == ["fig99.svg", "fig99.csv", "fig99.txt"]
    code, _, errors = run("figure", "--jobs", 1)
    assert (code, errors.count("\n")) == (2, 1)
    assert problem in errors


def test_a_figure_of_a_file_that_cannot_be_imported_is_told_with_that_file(bench, run):
    put(bench, "maps.py", f"{TWO_FIGURES}import absent_module\n")
    code, said, errors = run("figure", "fig97")
    assert (code, said, errors.count("\n")) == (2, "", 1)
    assert "failed with ModuleNotFoundError" in errors
    assert "correct reports/maps.py, or choose among" in errors


def test_unknown_recipes_are_told_before_anything_is_drawn(bench, tmp_path):
    with pytest.raises(InputError, match=r"recipe = 'fig1': there is no such.*among fig99"):
        build(bench, ["fig99", "fig1"])
    assert not bench.figures_folder.exists()
    with pytest.raises(InputError, match=r"reports: holds no recipe; run this in a bench"):
        build(Bench(tmp_path))


def test_the_papers_maps_are_among_those_by_argument(figures, maps_bench, run):
    done = run("figure", "maps", "material=low-carbon steel", "--format", "svg", "--jobs", 1)
    assert done == (0, "1 figure in reports/figures\n", "")
    csv = maps_bench.figures_folder / "maps-low-carbon-steel.csv"
    drawn, papers = map(pd.read_csv, (csv, figures["fig12"].paths[0].with_suffix(".csv")))
    pd.testing.assert_frame_equal(drawn, papers, check_exact=True)
    arguments = ("material=gunmetal", "law=explicit", "reference=persson")
    assert run("figure", "maps", *arguments, "--format", "svg", "--jobs", 1)[0] == 0
    csv = maps_bench.figures_folder / "maps-gunmetal-explicit-persson.csv"
    assert "persson_penetration_mm" in csv.read_text().partition("\n")[0]
    assert set(find_recipes(BENCH)) - set(chosen_recipes(BENCH)) == {"maps"}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["maps"], "material: is needed; write: cylcontact figure maps material=…"),
        (["maps", "material=soap"], "name = 'soap': no material has this name"),
        (["maps", "material=ceramics", "law=no-such"], "is neither a law nor a fit result in"),
        (["maps", "material=ceramics", "law=external"], "is not a fit on a grid of internal"),
        (["maps", "material=ceramics", "reference=liu"], "is not a reference of the maps; choose"),
        (["maps", "material=ceramics", "colour=red"], "takes material, law, reference; write"),
        (["fig98", "material=ceramics"], "takes no arguments; write: cylcontact figure fig98"),
        (["maps", "fig12", "material=ceramics"], "is an argument of one recipe; name that"),
        (["material=ceramics"], "is an argument of one recipe; name that recipe before it"),
    ],
)
def test_mistakes_in_arguments(maps_bench, run, words, message):
    put(maps_bench, "fig98.py", RECIPE)
    code, out, errors = run("figure", *words, "--jobs", 1)
    assert (code, out, errors.count("\n")) == (2, "", 1)
    assert message in errors
    assert not maps_bench.figures_folder.exists()


# --- what is written ---


def test_a_build_returns_and_reports_what_it_wrote(bench):
    stages = []
    (figure,) = build(bench, progress=lambda *stage: stages.append(stage))
    assert stages == [("drawing", 0, 1), ("drawing", 1, 1)]
    assert [path.name for path in figure.paths] == [
        "fig99.png",
        "fig99.pdf",
        "fig99.csv",
        "fig99.txt",
    ]
    assert sorted(figure.paths) == sorted(bench.figures_folder.iterdir())
    assert figure.headline == {"largest load, N/mm": 1000 / 3}
    assert figure.size_mm == pytest.approx((84.0, 60.0))
    png, pdf, csv, _note = figure.paths
    assert csv.read_bytes() == b"load_N_per_mm\n10\n333.3333\n"
    with Image.open(png) as image:
        assert image.info["Description"] == figure.caption == "A line of loads, N/mm."
        # A picture has whole pixels only.
        width = image.size[0] / image.info["dpi"][0] * 25.4
    assert width == pytest.approx(84, abs=25.4 / 300)
    assert page_mm(pdf)[0] == pytest.approx(84, abs=0.01)
    assert {font.partition("-")[0] for font in embedded_fonts(pdf)} <= {"Arimo", "STIXGeneral"}
    # Nothing compiled is left beside it.
    names = sorted(path.name for path in bench.recipes_folder.iterdir())
    assert names == ["fig99.py", "figures", "paper.py"]


def test_the_same_input_gives_the_same_bytes_under_any_settings(bench, tmp_path):
    (figure,) = build(bench, ["fig99"])
    with mpl.rc_context({"font.size": 20.0, "lines.linewidth": 5.0, "pdf.fonttype": 3}):
        (again,) = build(Bench(bench.root, jobs=2), ["fig99"], tmp_path / "again")
        assert mpl.rcParams["font.size"] == 20.0
    for one, other in zip(figure.paths, again.paths, strict=True):
        assert one.read_bytes() == other.read_bytes()


def test_a_figure_is_written_whole_or_not_at_all(tmp_path):
    def a_drawing(title):
        figure = new_figure("column", 60)
        figure.subplots().set_title(title)
        return Drawing(figure, pd.DataFrame({"dR_mm": [0.05]}), {}, "ΔR in mm.")

    (tmp_path / "fig.csv").mkdir()
    with pytest.raises(InputError, match=r"fig\.csv: cannot be written \(it is a folder\)"):
        write(a_drawing(r"$\Delta R$"), "fig", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["fig.csv"]
    before = {path: path.read_bytes() for path in write(a_drawing("a"), "b", tmp_path)}
    with pytest.raises(ValueError, match="ParseSyntaxException"):
        write(a_drawing(r"$\frac{1$"), "b", tmp_path)
    assert {path: path.read_bytes() for path in before} == before


# --- what a user adds ---


def test_a_figure_and_a_claim_are_one_file_each(bench, run):
    put(bench, "fig_mine.py", RECIPE.replace("A line of loads", "Loads of mine"))
    put(bench, "claims/mine.py", CLAIM)
    assert run("figure", "fig_mine", "--jobs", 1)[:2] == (0, "1 figure in reports/figures\n")
    assert run("report", "--jobs", 1) == (0, "open build/site/index.html\n", "")
    page = Path("build/site/figures.html").read_text(encoding="utf-8")
    assert "Loads of mine, N/mm." in page
    assert 'href="figures/fig_mine.csv"' in page
    code, out, errors = run("claims", "--jobs", 1)
    assert (code, errors) == (0, "")
    assert out.startswith("Of 1 testable statement, 1 is reproduced.")


def test_no_output_replaces_an_input(bench, run):
    reading = "    bench.input('datasets/loads.csv').read_text()\n    figure ="
    put(bench, "loads.py", RECIPE.replace("    figure =", reading))
    put(bench, "claims/mine.py", CLAIM)
    for name in ("materials", "loads"):
        put(bench, f"../datasets/{name}.csv", "mine\n")
    before = tree(bench.root)
    for command, name in (
        (("claims", "-o", "datasets/materials.csv"), "materials"),
        (("figure", "loads", "-o", "datasets", "--jobs", 2), "loads"),
    ):
        code, out, errors = run(*command)
        assert (code, out, errors.count("\n")) == (2, "", 1)
        assert f"datasets/{name}.csv: cannot be written (it is an input)" in errors
    assert tree(bench.root) == before


def test_without_claims_there_is_no_ledger(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, errors = run("claims")
    assert (code, out, errors.count("\n")) == (2, "", 1)
    assert "reports/claims: there are no claims here" in errors


# --- the shipped one ---


@pytest.mark.parametrize("name", sorted(path.stem for path in ROOT.glob("reports/*.py")))
def test_examples_run(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    found = doctest.testmod(BENCH.module(name), optionflags=doctest.NORMALIZE_WHITESPACE)
    assert found.failed == 0


def imports(file):
    """Return the names that a file imports, a relative one with its dots."""
    names = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add("." * node.level + (node.module or ""))
    return names


def test_the_package_imports_no_bench_and_no_figure_the_claims():
    for file in SOURCE.rglob("*.py"):
        assert not [name for name in imports(file) if "_cylcontact_bench" in name], file
    for file in ROOT.glob("reports/*.py"):
        assert not [name for name in imports(file) if name.startswith(".claims")], file
