"""The README: its code runs, its sentences hold the committed results, its commands exist."""

import json
import re
import subprocess
from pathlib import Path

import pandas as pd

from cylcontact.reports.figures import recipes, report_module

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CODE = re.search(r"```python\n(.*?)```", README, re.DOTALL)[1]


def test_the_python_runs_and_prints_what_the_page_shows(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    exec(CODE, {})
    assert capsys.readouterr().out == re.search(r"```text\n(.*?)```", README, re.DOTALL)[1]


def test_it_is_read_in_three_minutes():
    assert len(README.splitlines()) <= 100


def test_pages_say_of_the_choices_what_the_study_gives():
    """Word for word, on README, the page on reproduction and in the second notebook."""
    pages = "README.md", "docs/how-to/reproduce-the-paper.md"
    texts = {page: (ROOT / page).read_text("utf-8") for page in pages}
    notebook = json.loads((ROOT / "notebooks/2_recover_the_coefficients.ipynb").read_text("utf-8"))
    texts["notebook 2"] = "\n".join("".join(cell["source"]) for cell in notebook["cells"])
    for page, text in texts.items():
        for sentence in report_module(ROOT, "choices").sentences(ROOT):
            assert sentence in " ".join(text.split()), page


def planned():
    """The commands that make would run from scratch."""
    command = ["make", "--dry-run", "--always-make"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout


def test_make_draws_as_many_figures_as_it_says():
    names = {
        name for words in re.findall(r"cylcontact figure (.*)", planned()) for name in words.split()
    }
    names &= set(recipes(ROOT))
    assert f"leaves {len(names)} figures" in README
    paper = {f"fig{n:02d}" for n in (*range(2, 15), 17, 18, 19)}
    assert names == paper | {"fig_choices", "fig_refit"}


def test_the_verdicts_are_counted():
    table = pd.read_csv(ROOT / "reports/claims.csv", comment="#")
    counts = table.groupby("verdict")["claim"].nunique()
    depends = counts["depends on the interpretation"]
    said = f"{counts['holds']} hold, {depends} depend on the interpretation, "
    said += f"and {counts['does not hold']} do not hold"
    science = (ROOT / "docs/science.md").read_text(encoding="utf-8")
    for page in (README, science):
        assert said in " ".join(page.split())
    assert f"compares {counts.sum()} claims" in README


def test_the_main_job_writes_nothing_that_is_committed():
    """A rule for a committed table would redo it as soon as a figure reads it."""
    written = re.findall(r"-o +(\S+)", planned())
    assert {"build/internal.json", "build/external.json"} <= set(written)
    assert all(path.startswith("build/") for path in written), written
