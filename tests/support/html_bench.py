"""A small bench with user text of the worst kind and with things missing, and its report."""

import shutil
from pathlib import Path

from cylcontact.materials import COLUMNS

ROOT = Path(__file__).parents[2]
EVIL = "<img src=x onerror=alert(1)> & \"quoted\" '{{ 7 * 7 }}'"
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
FITS = (
    *("internal", "external", "explicit-internal"),
    *("practical", "power-practical", "power-external"),
    *("power-clearance-practical-six", "power-clearance-external"),
    *("recovered-internal", "recovered-external"),
)
CACHES = shutil.ignore_patterns("__pycache__")
FEW_MAPS = """
FIGURES = {name: FIGURES[name] for name in ("fig12", "fig_maps_refit")}
FIGURES["fig12p"] = lambda bench: bench.result("missing")
"""


def build_small_site(root):
    """Write the bench in a folder and build its report."""
    from cylcontact.reports.bench import Bench
    from cylcontact.reports.html import build_site

    for folder in ("datasets", "fitting/results", "reports"):
        (root / folder).mkdir(parents=True)
    quoted = EVIL.replace('"', '""')
    (root / "datasets" / "materials.csv").write_text(
        f'{",".join(COLUMNS)}\n"{quoted}",70,assumed,0.3,assumed,300,assumed,"{quoted}"\n',
        encoding="utf-8",
    )
    results = root / "fitting" / "results"
    shutil.copy(ROOT / "datasets" / "benchmarks.json", root / "datasets")
    for name in FITS:
        shutil.copy(ROOT / "fitting" / "results" / f"{name}.json", results)
    text = (results / "external.json").read_text(encoding="utf-8")
    evil = text.replace(
        '"name": "external"', f'"name": "{EVIL.replace(chr(34), chr(92) + chr(34))}"'
    )
    (results / "evil.json").write_text(evil, encoding="utf-8")
    (results / "broken.json").write_text("{}", encoding="utf-8")
    (root / "fitting" / "never-run.toml").write_text("")
    shutil.copytree(ROOT / "reports" / "claims", root / "reports" / "claims", ignore=CACHES)
    for file in (ROOT / "reports").glob("*.py"):
        if not file.stem.startswith("fig") and file.stem not in {"maps", "paths"}:
            shutil.copy(file, root / "reports")
    maps = (ROOT / "reports" / "maps.py").read_text(encoding="utf-8") + FEW_MAPS
    (root / "reports" / "maps.py").write_text(maps, encoding="utf-8")
    (root / "reports" / "fig03.py").write_text("def draw(bench):\n    return 1 / 0\n")
    (root / "reports" / "fig_evil.py").write_text(EVIL_RECIPE)
    return build_site(Bench(root, jobs=2), root / "reports" / "html")
