"""A small folder with user text of the worst kind and with things missing, and its site."""

import shutil
from pathlib import Path

from tests.support.programs import skipping

ROOT = Path(__file__).parents[2]
EVIL = "<img src=x onerror=alert(1)> & \"quoted\" '{{ 7 * 7 }}' **bold** </div>"
EVIL_RECIPE = f'''
"""A line of {EVIL[:28]}"""
import pandas as pd
from cylcontact.plots.figure import Drawing
from cylcontact.plots.figure import new_figure


def draw(bench):
    figure = new_figure("column", 60)
    figure.subplots().plot([1, 2], [1, 2])
    table = pd.DataFrame({{"load_N_per_mm": [1 / 3]}})
    return Drawing(figure, table, {{{EVIL!r}: 1 / 3}}, "Caption " + {EVIL!r}, "A note.")
'''
EVIL_CLAIM = f"""
from cylcontact.reports.claims import Finding, claim


@claim("7-evil", {EVIL!r}, paper={EVIL!r}, rule="at most c_e", figures=("fig_evil",))
def evil():
    return Finding({EVIL!r}, holds=False)
"""
PAPER = """
from cylcontact.reports.paper import Paper

FITS = ("internal", "recovered-internal")
PAPER = Paper(title="A paper", figures={3: "Three", 15: "Fifteen"}, fits=FITS)
"""
FITS = (
    *("internal", "external", "explicit-internal"),
    *("practical", "power-practical", "power-external"),
    *("power-clearance-practical-six", "power-clearance-external"),
    *("recovered-internal", "recovered-external"),
)


def build_small_site(root):
    """Write the folder and build its site."""
    from cylcontact.reports.bench import Bench
    from cylcontact.reports.pages import build_site

    results, recipes = root / "fitting" / "results", root / "reports"
    for folder in (root / "datasets", results, recipes / "claims"):
        folder.mkdir(parents=True)
    shutil.copy(ROOT / "datasets" / "benchmarks.json", root / "datasets")
    for name in FITS:
        shutil.copy(ROOT / "fitting" / "results" / f"{name}.json", results)
    text = (results / "external.json").read_text(encoding="utf-8")
    evil = text.replace(
        '"name": "external"', f'"name": "{EVIL.replace(chr(34), chr(92) + chr(34))}"'
    )
    (results / "evil.json").write_text(evil, encoding="utf-8")
    (results / "broken.json").write_text("{}", encoding="utf-8")
    for name, text in (
        ("paper", PAPER),
        ("fig03", "def draw(bench):\n    return 1 / 0\n"),
        ("fig_evil", EVIL_RECIPE),
        ("claims/mine", EVIL_CLAIM),
    ):
        (recipes / f"{name}.py").write_text(text, encoding="utf-8")
    with skipping():
        return build_site(Bench(root), root / "build" / "site")
