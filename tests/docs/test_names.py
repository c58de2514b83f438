"""No stale name: what pages, docstrings and messages name does exist."""

import ast
import importlib
import json
import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path

import pytest
import typer

import cylcontact
from cylcontact.cli import app
from cylcontact.reports.figures import recipes

ROOT = Path(__file__).resolve().parents[2]
PLACES = ("*.md", "docs/**/*.md", "*/README.md", "datasets/*/README.md", "benchmarks/*.md")
# Files of the reader's, and what commands write.
THEIRS = re.compile(
    r"(mine|my|your|own|table|rig|run|result|fit|first|second|pair|joint|motion|cases|out|new|NAME|x|"
    r"data|steel|readings|hinge|bearing|sweep|curve|law|study|choice|plan|file|materials|"
    r"a|b|answers|band|bearings|choices|joints|residuals|-embedded|SETUP-embedded|STUDY)(\b|_)"
)
# Options of other programs.
OTHERS = {
    *("--install", "--name", "--porcelain", "--rest", "--sys-prefix", "--untracked-files"),
}


@cache
def texts_of(kind):
    """The texts of pages, of docstrings and messages, or of notebooks, each with its name."""
    return [*_texts_of(kind)]


def _texts_of(kind):
    if kind == "pages":
        for page in sorted({page for place in PLACES for page in ROOT.glob(place)}):
            if page.name != "CHANGELOG.md" and page.relative_to(ROOT) in committed():
                yield str(page.relative_to(ROOT)), page.read_text(encoding="utf-8")
    elif kind == "notebooks":
        for path in sorted((ROOT / "notebooks").glob("*.ipynb")):
            cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
            words = ["".join(each["source"]) for each in cells if each["cell_type"] == "markdown"]
            yield path.name, "\n".join(words)
    else:
        for path in sorted((ROOT / "src").rglob("*.py")) + sorted((ROOT / "reports").glob("*.py")):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            strings = [
                node.value
                for node in ast.walk(tree)
                if isinstance(node, ast.Constant) and isinstance(node.value, str)
            ]
            yield str(path.relative_to(ROOT)), "\n".join(strings)


@cache
def committed():
    """The files of the checkout."""
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return {Path(name) for name in listed.stdout.split()}


@cache
def committed_names():
    return {path.name for path in committed()}


@cache
def options():
    """The options of all commands, and of the project's own scripts."""
    named, left = {"--help", "--version"} | OTHERS, [typer.main.get_command(app)]
    while left:
        command = left.pop()
        named |= {name for p in command.params for name in (*p.opts, *p.secondary_opts)}
        left += getattr(command, "commands", {}).values()
    for script in (ROOT / "benchmarks").glob("*.py"):
        named |= set(re.findall(r'"(--[a-z-]+)"', script.read_text(encoding="utf-8")))
    return named


def stale_files(text):
    names = set(re.findall(r"(?<![\w.*/{}-])((?:[\w-]+/)*[\w-]+\.(?:toml|csv|py|ipynb))\b", text))
    for name in names:
        name_alone = Path(name).name
        if name_alone not in committed_names() and not THEIRS.match(name_alone):
            yield name


def stale_figures(text):
    yield from set(re.findall(r"\bfig(?:_[a-z]+|\d\d)\b", text)) - set(recipes(ROOT))


def stale_options(text):
    yield from set(re.findall(r"(?<![\w-])--[a-z][a-z-]+[a-z]\b", text)) - options()


def stale_targets(text):
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    yield from set(re.findall(r"`make ([a-z-]+)", text)) - targets


def stale_modules(text):
    for name in set(re.findall(r"\bcylcontact(?:\.\w+)+", text)):
        *parents, last = name.split(".")
        try:
            importlib.import_module(name)
        except ImportError:
            for count in range(len(parents), 0, -1):
                try:
                    there = importlib.import_module(".".join(parents[:count]))
                except ImportError:
                    continue
                for part in [*parents[count:], last]:
                    there = getattr(there, part, None)
                if there is None:
                    yield name
                break


UNITS = ("um", "mm", "nm", "N", "kN", "MPa", "GPa", "N_per_mm", "percent", "us", "ms", "N_per_mm_n")
COLUMN = re.compile(rf"`((?:[A-Za-z]\w*_)(?:{'|'.join(UNITS)}))`")


def stale_columns(text):
    yield from {name for name in COLUMN.findall(text) if name not in known_words()}


@cache
def known_words():
    """Words of the package, and of the tables that come with it."""
    words = set()
    for path in sorted((ROOT / "src").rglob("*.py")) + sorted((ROOT / "reports").glob("*.py")):
        words |= set(re.findall(r"\w+", path.read_text(encoding="utf-8")))
    for path in committed():
        if path.suffix == ".csv" and path.parts[0] == "datasets":
            lines = (ROOT / path).read_text(encoding="utf-8").splitlines()
            words |= {word for line in lines[:40] for word in re.findall(r"\w+", line)}
    return words


KINDS = {
    "files": stale_files,
    "figures": stale_figures,
    "options": stale_options,
    "targets": stale_targets,
    "modules": stale_modules,
    "columns": stale_columns,
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("place", ["pages", "notebooks", "docstrings and messages"])
def test_what_is_named_exists(place, kind, monkeypatch):
    monkeypatch.chdir(ROOT)
    stale = {name: sorted(KINDS[kind](text)) for name, text in texts_of(place)}
    assert {name: found for name, found in stale.items() if found} == {}


@pytest.mark.parametrize(
    ("kind", "text"),
    {
        "files": "see nowhere/gone.toml",
        "figures": "fig99, fig_gone",
        "options": "with --gone",
        "targets": "`make gone`",
        "modules": "cylcontact.laws.Gone",
        "columns": "`gone_um`",
    }.items(),
)
def test_a_stale_name_is_found(kind, text, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert list(KINDS[kind](text))


def test_the_program_is_described_in_one_sentence():
    said = cylcontact.__doc__.splitlines()[0].rstrip(".")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["description"] == said
    assert f'site_description: "{said}"' in (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert typer.main.get_command(app).help == f"{said}."
