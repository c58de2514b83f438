"""The notebooks: each runs, equals its script, and the explorer's controls move its numbers."""

import ast
import math
import re
import sys
import time
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws, limits
from cylcontact.plots import new_figure
from cylcontact.reports import explore, notebook
from cylcontact.reports.fit_figures import runs_drawing, runs_table
from tests.paper_equations import e_star, johnson, johnson_end

ROOT = Path(__file__).resolve().parents[1]
SCRIPTS = sorted((ROOT / "notebooks").glob("*.py"))
each_notebook = pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
STEEL = Material("steel", E=207e3, nu=0.3, yield_stress=250.0)
E_STAR = e_star(207e3, 0.3)


# A notebook takes less than 30 s on two cores. A busy machine runs it several times slower, and the
# first simulation in a fresh checkout compiles the equations.
LIMIT = 30.0
LOADED = 6.0
PICTURES = ("<img", "<svg")


def execute(cells, allow_errors=False):
    """Run a notebook in a kernel of this environment, in the notebooks' folder."""
    nbclient = import_module("nbclient")
    place = {"metadata": {"path": str(ROOT / "notebooks")}}
    end = time.monotonic() + LOADED * LIMIT
    # A cell may take what the ones before it have left of the notebook's time.
    nbclient.NotebookClient(
        cells,
        timeout_func=lambda _: max(1, math.ceil(end - time.monotonic())),
        kernel_name="python3",
        resources=place,
        allow_errors=allow_errors,
    ).execute()
    return [output for cell in code_cells(cells) for output in cell.outputs]


def code_cells(cells):
    """Return the cells of code of a notebook."""
    return [cell for cell in cells.cells if cell.cell_type == "code"]


def imports_of(cell):
    """Return the imports of a cell, those in functions among them."""
    nodes = ast.walk(ast.parse(cell.source))
    return [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]


def has_picture(cell):
    """Return whether a cell shows a picture."""
    shown = [output.get("data", {}) for output in cell.outputs]
    return any(
        "image/png" in data or any(tag in data.get("text/html", "") for tag in PICTURES)
        for data in shown
    )


# --- all notebooks ---


def test_there_is_one_for_every_stage():
    assert [path.stem[0] for path in SCRIPTS] == [str(n) for n in range(1, len(SCRIPTS) + 1)]
    listed = (ROOT / "notebooks" / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"`(\d_\w+)`", listed) == [path.stem for path in SCRIPTS]


@each_notebook
def test_notebook_is_its_script_without_outputs(script):
    jupytext, nbformat = import_module("jupytext"), import_module("nbformat")
    paired = nbformat.read(script.with_suffix(".ipynb"), as_version=4)
    written = jupytext.read(script)
    assert [(cell.cell_type, cell.source) for cell in paired.cells] == [
        (cell.cell_type, cell.source) for cell in written.cells
    ], "make pair brings the notebook in line with its script"
    filled = [cell for cell in code_cells(paired) if cell.outputs or cell.execution_count]
    assert not filled, "make pair clears it"
    assert paired.metadata.kernelspec.name == "cylcontact"


@each_notebook
def test_notebook_starts_with_two_imports_at_most(script):
    first, *others = map(imports_of, code_cells(import_module("jupytext").read(script)))
    assert 1 <= sum(len(node.names) for node in first) <= 2
    assert [names for names in others if names] == []


@each_notebook
def test_notebook_runs_in_time_and_ends_with_a_picture(script):
    cells = import_module("jupytext").read(script)
    outputs = execute(cells)
    assert len(outputs) >= 3
    assert not [output for output in outputs if output.get("name") == "stderr"]
    assert has_picture(code_cells(cells)[-1])


def test_a_notebook_that_takes_too_long_is_stopped(monkeypatch):
    monkeypatch.setitem(globals(), "LIMIT", 0.0)
    nbformat = import_module("nbformat")
    cell = nbformat.v4.new_code_cell("import time\ntime.sleep(60)")
    with pytest.raises(import_module("nbclient").exceptions.CellTimeoutError):
        execute(nbformat.v4.new_notebook(cells=[cell]))


def test_a_missing_extra_is_told_in_one_line():
    nbformat = import_module("nbformat")
    code = (
        "import sys\nsys.modules['ipywidgets'] = None\n"
        "from cylcontact.reports.notebook import require_extra\nrequire_extra('ipywidgets')"
    )
    cell = nbformat.v4.new_code_cell(code)
    (output,) = execute(nbformat.v4.new_notebook(cells=[cell]), allow_errors=True)
    assert output.traceback == [
        "notebook: ipywidgets is not installed; run `make extras` in the repository, or: "
        "pip install 'cylcontact[notebooks]'"
    ]


def test_without_the_extra_the_explorer_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    with pytest.raises(InputError, match="ipywidgets is not installed; run `make extras`"):
        explore.explore_pair()


def test_progress_is_shown_and_escaped(monkeypatch):
    display = import_module("IPython.display")
    visible = []

    class Handle:
        def update(self, bar):
            visible.append(bar.data)

    def show(bar, display_id):
        assert display_id
        visible.append(bar.data)
        return Handle()

    monkeypatch.setattr(display, "display", show)
    with notebook.live_progress() as progress:
        progress("a<b", 0, 2)
        progress("a<b", 2, 2)
    assert visible == [notebook.progress_bar("a<b", done, 2) for done in (0, 2)]
    assert "<b" not in visible[0]


# --- the explorer ---


MINE = Material("<b>mine</b>", E=10e3, nu=0.2)


@pytest.fixture
def explorer():
    """The controls of the explorer by description, and its table and picture."""
    import_module("ipywidgets")
    top, picture = explore.explore_pair([MINE]).children
    controls, table = top.children
    named = {control.description: control for control in controls.children}
    return named | {"table": table, "picture": picture}


def row(explorer, what):
    """Return a number that the explorer shows."""
    return re.search(rf"{what}</th><td>([^<]*)</td>", explorer["table"].value)[1]


CHANGES = {
    "material": "aluminium alloy",
    "E (GPa)": 100.0,
    "ν (-)": 0.2,
    "yield stress (MPa)": 300.0,
    "pin or roller j": "bronze",
    "contact": "external",
    "ΔR (mm)": 0.5,
    "R_i of the hole (mm)": 20.0,
    "load (N/mm)": 300.0,
    "law": "explicit",
}


@pytest.mark.parametrize("control", CHANGES)
def test_every_control_moves_numbers_and_picture(explorer, control):
    assert set(explorer) == {*CHANGES, "table", "picture"}
    before = explorer["table"].value, explorer["picture"].value
    explorer[control].value = CHANGES[control]
    after = explorer["table"].value, explorer["picture"].value
    assert before[0] != after[0]
    assert before[1] != after[1]


def test_a_material_fills_in_its_numbers(explorer):
    explorer["material"].value = "aluminium alloy"
    assert (explorer["E (GPa)"].value, explorer["ν (-)"].value) == (69.0, 0.33)
    explorer["ΔR (mm)"].value = 0.0075
    # The limit that the paper gives for aluminium at 7.5 µm.
    assert round(float(row(explorer, "Johnson&#x27;s largest load, N/mm"))) == 494


def test_a_material_of_ones_own_is_among_them(explorer):
    explorer["material"].value = MINE.name
    assert (explorer["E (GPa)"].value, explorer["yield stress (MPa)"].value) == (10.0, 0.0)
    assert row(explorer, "first yield, N/mm") == "–"
    assert MINE.name not in explorer["table"].value + explorer["picture"].value


def test_what_is_wrong_is_said_in_place_of_numbers(explorer):
    explorer["ν (-)"].value = 0.7
    assert explorer["picture"].value == ""
    assert "Poisson&#x27;s ratio must lie in [0, 0.5]" in explorer["table"].value
    explorer["ν (-)"].value = 0.3
    assert "<figure>" in explorer["picture"].value
    explorer["law"].value, explorer["contact"].value = "persson", "external"
    assert "hole" in explorer["table"].value


def test_numbers_by_hand():
    choice = explore.Choice(STEEL, "internal", 0.05, 100.0, laws.Johnson())
    actual = explore.numbers(choice)
    by_hand = 1e3 * johnson(100.0, E_STAR, 0.05)
    assert actual["penetration, µm"] == pytest.approx(by_hand, rel=1e-12)
    assert actual["difference from Johnson, %"] == 0
    assert actual["first yield, N/mm"] == limits.yield_load(choice.pair)
    end = johnson_end(E_STAR, 0.05)
    assert actual["Johnson's largest load, N/mm"] == pytest.approx(end, rel=1e-12)
    assert actual["the law's largest load, N/mm"] == pytest.approx(end, rel=1e-12)
    assert actual["f/(E*·ΔR), -"] == pytest.approx(100 / (E_STAR * 0.05), rel=1e-12)


def test_rollers_share_their_radii_and_have_no_conformal_reference():
    choice = explore.Choice(STEEL, "external", 20.0, 100.0, laws.Enhanced())
    assert (choice.pair.R_i, choice.pair.R_j) == (10.0, 10.0)
    assert math.isnan(explore.numbers(choice)["difference from conformal contact, %"])
    assert explore.curve(choice)["conformal_difference_percent"].isna().all()


def test_a_pin_of_another_material_is_measured_by_the_law_for_two():
    aluminium = Material("aluminium", 69e3, 0.33, yield_stress=276.0)
    choice = explore.Choice(STEEL, "internal", 0.02, 1500.0, laws.Explicit(), material_j=aluminium)
    pair = CylinderPair.internal(10.0, 9.98, STEEL, 10.0, aluminium)
    actual = explore.numbers(choice)
    ratio = laws.Explicit().penetration(1500.0, pair) / laws.Conformal().penetration(1500.0, pair)
    off = float(100 * (ratio - 1))
    assert off < -2
    assert actual["difference from conformal contact, %"] == pytest.approx(off, rel=1e-9)
    assert actual["first yield, N/mm"] == pytest.approx(float(limits.yield_load(pair)), rel=1e-9)
    table = explore.curve(choice).set_index("load_N_per_mm")
    assert np.interp(1500.0, table.index, table["conformal_difference_percent"]) == pytest.approx(
        off, rel=1e-2
    )
    johnson = explore.verdicts(replace(choice, law=laws.Johnson()))
    assert any("from conformal contact, more than 10 %" in line for line in johnson)
    with pytest.raises(InputError, match="must have the same E and ν as material_i"):
        explore.numbers(replace(choice, law=laws.Persson()))
    bare = replace(choice, material_j=Material("bare", 69e3, 0.33))
    assert any("a material has no yield stress" in line for line in explore.verdicts(bare))


@pytest.mark.parametrize(
    ("choice", "said"),
    [
        (explore.Choice(STEEL, "internal", 0.05, 2e4, laws.Johnson()), "has no answer here"),
        (explore.Choice(STEEL, "internal", 0.05, 2e4, laws.Explicit()), "Johnson's law has ended"),
        (explore.Choice(STEEL, "internal", 0.05, 2e4, laws.Explicit()), "Not elastic"),
        (explore.Choice(STEEL, "internal", 5.0, 10.0, laws.Enhanced()), "from conformal contact"),
        (explore.Choice(Material("x", 1e3, 0.3), "internal", 5.0, 1.0, laws.Liu()), "No yield"),
        (explore.Choice(STEEL, "internal", 0.05, 10.0, laws.Explicit()), "Elastic"),
    ],
)
def test_verdicts(choice, said):
    assert any(line.startswith(said) or said in line for line in explore.verdicts(choice))


@pytest.mark.parametrize("load", [0.0, -1.0, math.nan])
def test_a_load_that_is_none_is_refused(load):
    choice = explore.Choice(STEEL, "internal", 0.05, load, laws.Johnson())
    for what in (explore.numbers, explore.curve):
        with pytest.raises(InputError, match=r"explorer: load = .*: must be positive"):
            what(choice)


# --- what notebooks show of figures and runs ---


def test_runs_are_shown_best_first(small_result):
    table = runs_table(small_result)
    assert table["polished"].is_monotonic_increasing
    assert (table["polished"] <= table["searched"]).all()
    drawing = runs_drawing(small_result)
    assert drawing.headline["objective"] == small_result.objective.value
    assert 1 <= drawing.headline["runs that reached it"] <= len(small_result.runs)
    assert len(small_result.runs) == len(drawing.figure.axes[0].lines[0].get_xdata())


def test_a_drawing_shows_its_picture_and_its_caption_escaped(small_result):
    hostile = small_result.model_copy(update={"name": '"><script>'})
    visible = runs_drawing(hostile)._repr_html_()
    assert "<script>" not in visible
    assert visible.count("&quot;&gt;&lt;script&gt;") == 2
    assert 'src="data:image/png;base64,iVBOR' in visible


def test_a_figure_without_pyplot_is_shown():
    display = import_module("IPython.core.formatters").DisplayFormatter()
    figure = new_figure("column", 60.0)
    figure.subplots().plot([0.0, 1.0])
    shown, _ = display.format(figure)
    assert shown["image/png"].startswith(b"\x89PNG")
