"""The notebooks: each runs, equals its script, and the explorer's controls move its numbers."""

import math
import re
import socket
import subprocess
import sys
import time
from contextlib import suppress
from importlib import import_module
from pathlib import Path

import pytest

from cylcontact import CylinderPair, Material, laws, limits
from cylcontact.datasets.finite_element import read_table
from cylcontact.reports import explore
from cylcontact.reports.fit_figures import runs_drawing, runs_table
from tests.support.paper_equations import e_star
from tests.support.programs import require_package

ROOT = Path(__file__).resolve().parents[2]
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
def test_notebook_runs_in_time_and_ends_with_a_picture(script):
    cells = import_module("jupytext").read(script)
    outputs = execute(cells)
    assert len(outputs) >= 3
    assert not [output for output in outputs if output.get("name") == "stderr"]
    assert has_picture(code_cells(cells)[-1])


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


# --- the explorer ---


MINE = Material("<b>mine</b>", E=10e3, nu=0.2)
ALUMINIUM = Material("aluminium", 69e3, 0.33, yield_stress=276.0)
EYE = laws.Housing(20.0, laws.Sector(60, side="far"))


def pin(dR=0.05, hole=STEEL, pin=STEEL):
    return CylinderPair.internal(10.0, 10.0 - dR, hole, 10.0, pin)


@pytest.fixture
def explorer():
    """The controls of the explorer by description, and what it shows."""
    import_module("ipywidgets")
    controls, answer = explore.explore_pair([MINE]).children
    named = {}
    for control in controls.children:
        named[control.description] = [*named.get(control.description, []), control]
    return named | {"answer": answer}


def row(explorer, what):
    """Return a number of the pair that the explorer shows."""
    return re.search(rf"{what}</th><td>([^<]*)</td>", explorer["answer"].value)[1]


CHANGES = {
    "hole, or roller i": "aluminium alloy",
    "pin, or roller j": "bronze",
    "E (GPa)": 100.0,
    "ν (-)": 0.2,
    "yield stress (MPa)": 100.0,
    "R_i, hole (mm)": 20.0,
    "ΔR (mm)": 0.5,
    "length (mm)": 20.0,
    "its R_o/R_i": 3.0,
    "sector (degrees)": 90,
    "housing, clamped": "whole rim",
    "load (N/mm)": 300.0,
    "laws": ("johnson", "liu"),
    "contact": "external",
}


def test_every_control_moves_what_is_shown(explorer):
    assert set(explorer) == {*CHANGES, "answer"}
    # The length matters to some laws only, the housing's size and sector in an eye.
    explorer["laws"][0].value = ("explicit", "lankarani-nikravesh")
    explorer["housing, clamped"][0].value = "sector, pin pulled away"
    for control, value in CHANGES.items():
        before = explorer["answer"].value
        for each in explorer[control]:
            each.value = value
        assert before != explorer["answer"].value, control
        assert "alert" not in explorer["answer"].value


def test_a_material_fills_in_its_numbers(explorer):
    for body in ("hole, or roller i", "pin, or roller j"):
        explorer[body][0].value = "aluminium alloy"
    assert [each.value for each in explorer["E (GPa)"]] == [69.0, 69.0]
    assert [each.value for each in explorer["ν (-)"]] == [0.33, 0.33]
    explorer["ΔR (mm)"][0].value = 0.0075
    # The limit that the paper gives for aluminium at 7.5 µm.
    assert round(float(row(explorer, "Johnson&#x27;s largest load, N/mm"))) == 494


def test_what_is_wrong_is_said_in_place_of_numbers(explorer):
    explorer["laws"][0].value = ("persson",)
    assert "<figure>" in explorer["answer"].value
    explorer["contact"][0].value = "external"
    assert explorer["answer"].value.startswith('<p role="alert">explorer: laws')
    explorer["laws"][0].value = ()
    assert "explicit" in explorer["answer"].value


@pytest.mark.long
def test_a_browser_shows_it_and_nothing_is_wider_than_a_telephone(browser):
    require_package("voila")
    with socket.socket() as free:
        free.bind(("localhost", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "voila", str(ROOT / "notebooks" / "3_explore_the_maps.ipynb")]
    with subprocess.Popen([*command, "--no-browser", f"--port={port}"]) as server:
        try:
            page = browser.new_page(viewport={"width": 390, "height": 844})
            for _ in range(60):
                with suppress(import_module("playwright.sync_api").Error):
                    page.goto(f"http://localhost:{port}/", timeout=180_000)
                    break
                time.sleep(1)
            explored = page.locator(".explored")
            explored.filter(has_text="the housing, which is not known").wait_for(timeout=180_000)
            page.get_by_label("housing, clamped").select_option("whole rim")
            explored.filter(has_text="times that by Johnson's datum").wait_for(timeout=60_000)
            assert page.evaluate("document.documentElement.scrollWidth") == 390
        finally:
            server.terminate()


def test_the_width_is_that_of_finite_elements():
    file = ROOT / "datasets" / "finite_element" / "recommended-embedded.csv"
    steel = Material("steel", 207e3, 0.3)
    rows = read_table(file).rows
    for each in rows[rows["dR_mm"] <= 0.05].itertuples():
        R_i = each.hole_radius_mm
        pair = CylinderPair.internal(R_i, R_i - each.dR_mm, steel)
        width = explore.numbers(explore.Choice(pair, each.load_N_per_mm))
        # Its elements are a sixteenth of the smallest half-width.
        assert width["width of the contact, mm"] / 2 == pytest.approx(each.half_width_mm, rel=0.04)
        assert width["largest pressure, MPa"] == pytest.approx(each.peak_pressure_MPa, rel=0.02)


def test_in_a_housing_the_laws_that_know_it_are_compared_there():
    choice = explore.Choice(pin(), 1000.0, ("conformal", "johnson"), EYE)
    off = explore.table(choice)["difference_percent"]
    assert abs(off["conformal"]) < 1e-6
    ratio = laws.Johnson().penetration(1000.0, pin()) / laws.Conformal(EYE).penetration(
        1000.0, pin()
    )
    assert off["johnson"] == pytest.approx(100 * float(ratio - 1), rel=1e-9)
    top = float(limits.yield_load(pin(), housing=EYE))
    assert explore.numbers(choice)["first yield, N/mm"] == pytest.approx(top, rel=1e-9)


@pytest.mark.parametrize(
    ("choice", "said"),
    [
        (explore.Choice(pin(), 2e4, ("johnson",)), "johnson: beyond its largest load."),
        (explore.Choice(pin(), 2e4), "Not elastic"),
        (explore.Choice(pin(), 10.0), "Elastic"),
        (explore.Choice(pin(), 10.0), "By Johnson's datum"),
        (explore.Choice(pin(), 10.0, housing=EYE), "times that by Johnson's datum"),
        (explore.Choice(pin(pin=ALUMINIUM), 10.0, ("persson",)), "persson: must have the same"),
        (explore.Choice(pin(pin=Material("x", 1e3, 0.3)), 1.0), "First yield is not known"),
    ],
)
def test_verdicts(choice, said):
    assert any(said in line for line in explore.verdicts(choice))


# --- what notebooks show of figures and runs ---


def test_runs_are_shown_best_first(small_result):
    table = runs_table(small_result)
    assert table["polished"].is_monotonic_increasing
    assert (table["polished"] <= table["searched"]).all()
    drawing = runs_drawing(small_result)
    assert drawing.headline["objective"] == small_result.objective.value
    assert 1 <= drawing.headline["runs that reached it"] <= len(small_result.runs)
    assert len(small_result.runs) == len(drawing.figure.axes[0].lines[0].get_xdata())
