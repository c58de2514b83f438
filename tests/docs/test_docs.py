"""The documentation: its code runs and prints what it says, its site is whole and offline."""

import re
import shutil
import subprocess
import sys
from functools import partial

import pytest
import typer

from cylcontact.cli import app
from cylcontact.reports import write_figures
from tests.support.doc_blocks import ROOT, blocks, copy_bench, run_page, same
from tests.support.programs import require_package

PAGES = sorted(
    path
    for pattern in ("*.md", "docs/**/*.md", "*/README.md")
    for path in ROOT.glob(pattern)
    if ".venv" not in path.parts and path.name not in ("figures.md", "claims.md")  # of make docs
)
README = ROOT / "README.md"  # followed twice in a row, below
WITH_CODE = [
    page
    for page in PAGES
    if page != README and any(b.language in ("python", "bash") for b in blocks(page))
]
SLOW = {
    "science.md", "calibration.md", "extend.md", "mechanism.md", "fit-my-data.md",
    "errors-of-readings.md", "choose-a-law.md", "export.md", "reproduce-the-paper.md",
    "from-a-drawing.md", "housing.md", "plots.md", "a-pressed-bush.md",
    "a-pin-that-tilts.md", "reports",
}  # fmt: skip
each_page = pytest.mark.parametrize(
    "page",
    [
        pytest.param(p, marks=pytest.mark.slow) if {p.name, p.parent.name} & SLOW else p
        for p in WITH_CODE
    ],
    ids=lambda path: str(path.relative_to(ROOT)),
)


@each_page
def test_code_runs_and_prints_what_the_page_says(page, tmp_path, monkeypatch):
    copy_bench(tmp_path)
    before = None
    for block, printed in run_page(page, tmp_path, monkeypatch):
        if block.language == "text" and block.adjacent and before is not None:
            assert same(block.text, before), f"\nshown:\n{block.text}\nprinted:\n{before}"
        before = printed


def test_commands_fit_the_window_of_a_laptop():
    """A block of the pages shows 90 columns in a window of 1366 pixels."""
    lines = [
        line
        for page in WITH_CODE
        for block in blocks(page)
        if block.language == "bash" and page.parent.name != "reports"
        for line in block.text.splitlines()
    ]
    assert [line for line in lines if len(line) > 90 and not line.startswith(("#", "sed"))] == []


@pytest.mark.slow
def test_the_readme_leaves_no_litter_and_can_be_followed_twice(tmp_path, monkeypatch):
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True)
    for name in listed.stdout.decode().strip("\0").split("\0"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, tmp_path / name)
    git = partial(subprocess.run, cwd=tmp_path, check=True, capture_output=True, text=True)
    identity = ("-c", "user.name=n", "-c", "user.email=e", "-c", "commit.gpgsign=false")
    for command in (("init",), ("add", "."), ("commit", "--message", "all")):
        git(["git", *identity, *command])
    for _ in range(2):
        run_page(README, tmp_path, monkeypatch)
        assert git(["git", "status", "--porcelain"]).stdout == ""


# --- the site ---


@pytest.mark.slow
def test_the_site_is_built_without_a_broken_link(tmp_path):
    """With one figure: make docs draws all."""
    require_package("mkdocstrings")
    made = shutil.ignore_patterns("figures", "figures.md", "claims.md")
    for folder in ("docs", "reports"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=made)
    shutil.copyfile(ROOT / "mkdocs.yml", tmp_path / "mkdocs.yml")
    write_figures(tmp_path, ["fig08"], folder=tmp_path / "docs" / "figures", formats=["png"])
    for command in (["docs/results.py"], ["-m", "mkdocs", "build", "--quiet", "--strict"]):
        done = subprocess.run(
            [sys.executable, *command], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
    for page in (tmp_path / "docs").rglob("*.md"):
        built = tmp_path / "site" / page.relative_to(tmp_path / "docs").with_suffix(".html")
        assert built.is_file()
    shown = (tmp_path / "site" / "figures.html").read_text(encoding="utf-8")
    assert 'src="figures/fig08.png"' in shown
    assert ">fig08</span>" in shown  # its code


def test_every_command_is_in_the_reference():
    text = (ROOT / "docs/reference/command-line.md").read_text(encoding="utf-8")
    commands = typer.main.get_command(app).commands
    assert set(re.findall(r"^\| `([a-z-]+)", text, re.MULTILINE)) == set(commands)
