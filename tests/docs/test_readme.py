"""The README: its code runs, its table holds the committed results, its commands exist."""

import re
import subprocess
from pathlib import Path

import pandas as pd
import pytest
from cylcontact.reports.laws_bounds import departure_number, johnson_end, johnson_shortfall
from cylcontact.reports.laws_to_use import laws_to_use

from cylcontact import CylinderPair, Material, limits
from cylcontact.fitting import FitResult
from cylcontact.fitting.comparison import labels
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.reports.figures import recipes

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CODE = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)


def test_code_blocks_run_in_order(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    names = {}
    for block in CODE:
        exec(block, names)
    assert "nan" not in capsys.readouterr().out
    assert len(CODE) == 2
    yields = float(limits.yield_load(names["pair"]))
    assert f"# {yields:.0f} N/mm: beyond it" in CODE[0]
    assert f"first yield of low-carbon steel at {yields / 1e3:.1f} kN/mm" in README
    assert f"load this joint to {names['motion'].max_elastic_load / 1e3:.1f} kN/mm" in README


def rows_of(table):
    """Return the cells of README's table with this first heading."""
    lines = README.split(f"| {table} |")[1].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip().strip("`") for cell in line.split("|")[1:-1]] for line in lines]


def test_it_is_read_in_three_minutes():
    assert len(README.splitlines()) < 150


def test_the_recovered_coefficients_are_those_of_the_committed_results():
    """All that are searched, and no other."""
    expected = []
    for contact in ("internal", "external"):
        result = FitResult.read(ROOT / f"fitting/results/recovered-{contact}.json")
        published = result.published.coefficients
        for name, label in labels(result).items():
            if name == label:  # neither tied to others nor fixed
                value = result.coefficients[name]
                difference = f"{100 * (value / published[name] - 1):+.1f}"
                expected.append([contact, name, f"{published[name]:g}", f"{value:.5g}", difference])
    assert rows_of("contact") == expected


def test_the_laws_to_use_are_computed():
    hole, rollers = (laws_to_use(contact, ROOT) for contact in ("internal", "external"))
    assert [*hole["law"][:2], rollers["law"][1]] == ["published", "practical", "refit"]
    numbers = zip(hole["rms_johnson"], hole["rms_conformal"], rollers["rms_johnson"], strict=True)
    expected = [
        [law, *("0" if rms < 1e-9 else f"{rms:.4f}" for rms in row), units, f"{time:.1f}"]
        for law, row, units, time in zip(
            ["published", "refitted there", *hole["law"][2:]],
            numbers,
            hole["units"],
            hole["relative_time"],
            strict=True,
        )
    ]
    assert rows_of("law") == expected


def test_the_numbers_between_the_tables():
    ratio = departure_number(10.0)
    ends = f"by 10 % at f/(E\\*·ΔR) = {ratio:.2f} and by 48 % at {johnson_end():.2f}"
    assert ends in README
    assert round(johnson_shortfall(johnson_end())) == 48


def test_what_the_housing_changes():
    steel, bronze = (Material.named(name) for name in ("high-strength steel", "bronze"))
    pair = CylinderPair.internal(R_i=10.0, R_j=9.95, material=bronze, material_j=steel)
    eye = Housing(R_o=20.0, clamp=Sector(60, side="far"))
    for datum in ("johnson", Housing(R_o=100.0), Housing(R_o=1000.0), eye):
        assert f"{1e3 * Conformal(datum).penetration(1000.0, pair):.0f} µm" in README
    thin = Housing(R_o=15.0, clamp=Sector(60, side="far"))
    index = (ROOT / "docs/index.md").read_text(encoding="utf-8")
    for page in (README, index):
        assert f"{1e3 * Conformal(thin).penetration(1000.0, pair):.0f} µm" in page
        for housing in (None, thin):
            assert f"{limits.yield_load(pair, housing=housing):,.0f} N/mm" in page


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
    assert names == paper | {"fig_refit"}


def test_the_verdicts_are_counted():
    table = pd.read_csv(ROOT / "reports/claims.csv")
    counts = table.groupby("verdict")["claim"].nunique()
    said = (
        f"{counts['holds']} hold, {counts['depends on the reading']} depend on the reading, and "
        f"{counts['does not hold']} do not hold"
    )
    science = (ROOT / "docs/science.md").read_text(encoding="utf-8")
    for page in (README, science):
        assert said in " ".join(page.split())
    assert f"compares {counts.sum()} claims" in README


@pytest.mark.parametrize("link", re.findall(r"\]\((?!https:)([^)]+)\)", README))
def test_links_lead_somewhere(link):
    assert (ROOT / link.partition("#")[0]).exists()


def test_the_main_job_writes_nothing_that_is_committed():
    """A rule for a committed table would redo it as soon as a figure reads it."""
    written = re.findall(r"-o +(\S+)", planned())
    assert {"build/internal.json", "build/external.json"} <= set(written)
    assert all(path.startswith("build/") for path in written), written
