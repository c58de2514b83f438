"""The notebooks: each asks a question, answers it in its first cell, and runs in time."""

import math
import re
import time

import pytest

from tests.support.doc_blocks import ROOT
from tests.support.programs import require_package

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
# A notebook takes less than 30 s on two cores. A busy machine runs it several times slower, and the
# first simulation in a fresh checkout compiles the equations.
LIMIT = 30.0
LOADED = 6.0


def execute(notebook):
    """Run a notebook in a kernel of this environment, in the notebooks' folder."""
    end = time.monotonic() + LOADED * LIMIT
    # A cell may take what the ones before it have left of the notebook's time.
    require_package("nbclient").NotebookClient(
        notebook,
        timeout_func=lambda _: max(1, math.ceil(end - time.monotonic())),
        kernel_name="python3",
        resources={"metadata": {"path": str(ROOT / "notebooks")}},
    ).execute()
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def has_picture(cell):
    """Return whether a cell shows a picture."""
    shown = [output.get("data", {}) for output in cell.outputs]
    return any("image/png" in data or "<img" in data.get("text/html", "") for data in shown)


def test_there_is_one_for_every_stage():
    names = [path.stem for path in NOTEBOOKS]
    assert [name[0] for name in names] == [str(n) for n in range(1, len(names) + 1)]
    listed = (ROOT / "notebooks" / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"`(\d_\w+)`", listed) == names


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs_in_time_and_answers_first(path):
    notebook = require_package("nbformat").read(path, as_version=4)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs for cell in cells), "clear the outputs before a commit"
    assert "?" in notebook.cells[0].source  # a question, which the first code answers
    outputs = [output for cell in execute(notebook) for output in cell.outputs]
    assert not [output for output in outputs if output.get("name") == "stderr"]
    assert cells[0].outputs
    assert any(map(has_picture, cells))
