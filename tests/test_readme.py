"""The README: its code runs, its table holds the committed results, its commands exist."""

import re
import subprocess
from pathlib import Path

import pytest

from cylcontact.fitting import FitResult
from cylcontact.fitting.report import labels
from cylcontact.reports import Bench
from cylcontact.reports.build import find_recipes
from cylcontact.reports.laws_bounds import departure_number, johnson_end, johnson_shortfall
from cylcontact.reports.laws_to_use import laws_to_use

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


def rows_of(table):
    """Return the cells of README's table with this first heading."""
    lines = README.split(f"| {table} |")[1].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip().strip("`") for cell in line.split("|")[1:-1]] for line in lines]


@pytest.mark.parametrize("contact", ["internal", "external"])
def test_the_recovered_coefficients_are_those_of_the_committed_results(contact):
    result = FitResult.read(ROOT / f"fitting/results/recovered-{contact}.json")
    paper = result.published
    numbers = {
        label: (f"{paper.coefficients[name]:g}", result.coefficients[name], ".5g")
        for name, label in labels(result).items()
    }
    numbers["RMS of ln(δ/δ_Johnson)"] = (f"{paper.objective:.5g}", result.objective.value, ".5g")
    for label, published, recovered, difference in rows_of(f"{contact} contact"):
        expected, value, form = numbers.pop(label)
        assert (published, recovered) == (expected, format(value, form))
        if not label.endswith("(fixed)"):
            true = paper.objective if label.startswith("RMS") else float(published)
            assert difference == f"{100 * (value / true - 1):+.1f}"
    assert not numbers


@pytest.mark.parametrize(
    ("contact", "table"), [("internal", "pin in a hole"), ("external", "rollers")]
)
def test_the_laws_to_use_are_computed(contact, table):
    references = ["johnson", *(["conformal"] if contact == "internal" else [])]
    expected = [
        [
            row["law"],
            row["constants"],
            *("0" if row[f"rms_{r}"] < 1e-9 else f"{row[f'rms_{r}']:.4f}" for r in references),
            row["units"],
            row["defined"],
            row["calibrated"],
            f"{row['relative_time']:.1f}",
        ]
        for row in laws_to_use(contact, Bench(ROOT)).to_dict("records")
    ]
    assert rows_of(table) == expected


def test_the_numbers_between_the_tables(figures):
    assert f"under {figures['fig_readings'].drawing.headline['readings']:.0f} readings" in README
    assert f"by 10 % at φ = {departure_number(10.0):.2f} and by 48 %" in README
    assert f"φ = {johnson_end():.2f}, where Johnson's law ends" in README
    assert round(johnson_shortfall(johnson_end())) == 48


def planned():
    """The commands that make would run from scratch."""
    command = ["make", "--dry-run", "--always-make"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout


def test_make_draws_as_many_figures_as_it_says():
    names = re.search(r"cylcontact figure (.*) --results build", planned())[1].split()
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
