"""The notebooks: each runs in time and ends with a picture."""

import math
import re
import time
from importlib import import_module
from pathlib import Path

import pytest

from cylcontact import Material
from tests.support.paper_equations import e_star

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
# Those that have a script as well.
SCRIPTS = sorted((ROOT / "notebooks").glob("*.py"))
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
    assert [path.stem[0] for path in NOTEBOOKS] == [str(n) for n in range(1, len(NOTEBOOKS) + 1)]
    listed = (ROOT / "notebooks" / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"`(\d_\w+)`", listed) == [path.stem for path in NOTEBOOKS]


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_has_no_outputs(notebook):
    cells = import_module("nbformat").read(notebook, as_version=4)
    filled = [cell for cell in code_cells(cells) if cell.outputs or cell.execution_count]
    assert not filled, "clear the outputs"
    assert cells.metadata.kernelspec.name == "cylcontact"


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_notebook_with_a_script_is_its_script(script):
    jupytext, nbformat = import_module("jupytext"), import_module("nbformat")
    paired = nbformat.read(script.with_suffix(".ipynb"), as_version=4)
    written = jupytext.read(script)
    assert [(cell.cell_type, cell.source) for cell in paired.cells] == [
        (cell.cell_type, cell.source) for cell in written.cells
    ], "make pair brings the notebook in line with its script"


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs_in_time_and_ends_with_a_picture(notebook):
    cells = import_module("nbformat").read(notebook, as_version=4)
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
