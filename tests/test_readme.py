"""The README: its code runs, its table holds the committed results, its commands exist."""

import re
import subprocess
from pathlib import Path

import pytest

from cylcontact.fitting import FitResult

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CODE = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)


def test_code_blocks_run_in_order(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    names = {}
    for block in CODE:
        exec(block, names)
    assert "nan" not in capsys.readouterr().out
    assert len(CODE) == 3


def test_the_law_is_shown_in_ten_lines():
    assert len(CODE[0].splitlines()) <= 10


@pytest.mark.parametrize("contact", ["internal", "external"])
def test_table_holds_the_committed_results(contact):
    result = FitResult.load(ROOT / f"fitting/results/{contact}.json")
    paper = result.published
    expected = {
        n: (f"{paper.coefficients[n]:g}", f"{v:.5g}") for n, v in result.coefficients.items()
    }
    expected["RMS of ln(δ/δ_Johnson)"] = (
        f"{paper.objective:.5g}",
        f"{result.objective.value:.5g}",
    )
    expected["bound with K* and n free at every ΔR"] = ("", f"{result.bound:.5g}")
    table = README.split(f"| {contact} contact |")[1].split("\n\n")[0]
    rows = [[c.strip() for c in line.split("|")[1:-1]] for line in table.splitlines()[2:]]
    assert {name: (published, refit) for name, published, refit in rows} == expected


def test_number_of_figures_is_the_number_of_recipes():
    names = [path.stem for path in (ROOT / "reports").glob("*.py")]
    extra = [name for name in names if name[-1] in "cp" or name.startswith("fig_")]
    assert f"leaves {len(names) - len(extra) + 1} figures" in README


def test_make_targets_named_exist():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"`make ([a-z]+)`", README):
        assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE)


@pytest.mark.parametrize("link", re.findall(r"\]\(([^)]+)\)", README))
def test_links_lead_somewhere(link):
    assert (ROOT / link).exists()


def test_the_main_job_writes_nothing_that_is_committed():
    """A rule for a committed table would redo it as soon as a figure reads it."""
    command = ["make", "--dry-run", "--always-make"]
    planned = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    written = re.findall(r"-o +(\S+)", planned)
    assert {"build/internal.json", "build/external.json"} <= set(written)
    assert all(path.startswith("build/") for path in written), written
