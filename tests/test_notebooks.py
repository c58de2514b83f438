"""The notebooks: each runs, equals its script, and the explorer's controls move its numbers."""

import math
import re
import sys
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
EXPLORER = ROOT / "notebooks" / "3_explore_the_maps.py"
each_notebook = pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
STEEL = Material("steel", E=207e3, nu=0.3, yield_stress=250.0)
E_STAR = e_star(207e3, 0.3)


def execute(cells, allow_errors=False):
    """Run a notebook in a kernel of this environment, in the notebooks' folder."""
    nbclient = import_module("nbclient")
    place = {"metadata": {"path": str(ROOT / "notebooks")}}
    nbclient.NotebookClient(
        cells, timeout=120, kernel_name="python3", resources=place, allow_errors=allow_errors
    ).execute()
    return [output for cell in cells.cells if cell.cell_type == "code" for output in cell.outputs]


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
    code = [cell for cell in paired.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code), "make pair clears it"
    assert paired.metadata.kernelspec.name == "cylcontact"


@each_notebook
def test_notebook_runs(script):
    outputs = execute(import_module("jupytext").read(script))
    assert len(outputs) >= 3
    assert not [output for output in outputs if output.get("name") == "stderr"]


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
        exec(EXPLORER.read_text(encoding="utf-8"), {})


def test_outside_a_checkout_the_notebooks_say_so(tmp_path):
    with pytest.raises(InputError, match=r"no bench here or above.*; lay one out with: cylcontact"):
        notebook.open_bench(tmp_path)


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


@pytest.fixture
def explorer(monkeypatch):
    """The names of the explorer, after its cells have run."""
    import_module("ipywidgets")
    import_module("IPython")
    monkeypatch.chdir(ROOT / "notebooks")
    names = {}
    exec(EXPLORER.read_text(encoding="utf-8"), names)
    return names


def row(names, what):
    """Return a number that the explorer shows."""
    return re.search(rf"{what}</th><td>([^<]*)</td>", names["table"].value)[1]


CHANGES = {
    "material": "aluminium alloy",
    "modulus": 100.0,
    "ratio": 0.2,
    "strength": 300.0,
    "other": "bronze",
    "contact": "external",
    "dR": 0.5,
    "radius": 20.0,
    "load": 300.0,
    "law": "explicit",
}


@pytest.mark.parametrize("control", CHANGES)
def test_every_control_moves_numbers_and_picture(explorer, control):
    assert {id(explorer[name]) for name in CHANGES} == set(map(id, explorer["controls"]))
    before = explorer["table"].value, explorer["picture"].value
    explorer[control].value = CHANGES[control]
    after = explorer["table"].value, explorer["picture"].value
    assert before[0] != after[0]
    assert before[1] != after[1]


def test_a_material_fills_in_its_numbers(explorer):
    explorer["material"].value = "aluminium alloy"
    assert (explorer["modulus"].value, explorer["ratio"].value) == (69.0, 0.33)
    explorer["dR"].value = 0.0075
    # The limit that the paper gives for aluminium at 7.5 µm.
    assert round(float(row(explorer, "Johnson&#x27;s largest load, N/mm"))) == 494


def test_what_is_wrong_is_said_in_place_of_numbers(explorer):
    explorer["ratio"].value = 0.7
    assert explorer["picture"].value == ""
    assert "Poisson&#x27;s ratio must lie in [0, 0.5]" in explorer["table"].value
    explorer["ratio"].value = 0.3
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
