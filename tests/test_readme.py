"""The README: its code runs, its table holds the committed results, its commands exist."""

import re
import subprocess
from pathlib import Path

import pytest

from cylcontact.fitting import FitResult
from cylcontact.reports import Bench
from cylcontact.reports.build import find_recipes

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


def planned():
    """The commands that make would run from scratch."""
    command = ["make", "--dry-run", "--always-make"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout


def test_make_draws_as_many_figures_as_it_says():
    names = re.search(r"cylcontact report (.*) --results build", planned())[1].split()
    assert f"leaves {len(names)} figures" in README
    assert set(names) <= set(find_recipes(Bench(ROOT)))
    assert {name for name in names if name[3:].isdigit()} == {f"fig{n:02d}" for n in range(1, 20)}


def test_make_targets_named_exist():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"`make ([a-z]+)`", README):
        assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE)


@pytest.mark.parametrize("link", re.findall(r"\]\(([^)]+)\)", README))
def test_links_lead_somewhere(link):
    assert (ROOT / link).exists()


def test_the_main_job_writes_nothing_that_is_committed():
    """A rule for a committed table would redo it as soon as a figure reads it."""
    written = re.findall(r"-o +(\S+)", planned())
    assert {"build/internal.json", "build/external.json"} <= set(written)
    assert all(path.startswith("build/") for path in written), written
