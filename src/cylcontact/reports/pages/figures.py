"""The figures of the site: drawn where their inputs have changed, and in the paper's order."""

from __future__ import annotations

import ast
import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from cylcontact.files import replacing
from cylcontact.progress import Progress, silent
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import FigureResult, build, chosen_recipes
from cylcontact.reports.paper import Paper

__all__ = ["Shown", "draw_changed", "sections"]

PACKAGE = Path(__file__).parents[3]
# Figures are drawn in parts, so that an interrupted build goes on where it was.
PART = 12


@dataclass(frozen=True)
class Shown:
    """A figure under its heading; one of the paper that nobody draws has a problem only."""

    name: str
    heading: str
    problem: str = ""
    result: FigureResult | None = None
    recipe: str = ""


def draw_changed(bench: Bench, progress: Progress = silent) -> list[FigureResult]:
    """Return all figures; those whose inputs are as in the last build are not drawn again."""
    folder = bench.root / "build" / "figures"
    record = folder / "drawn.json"
    package = hashlib.sha256(
        "".join(map(_hash, sorted((PACKAGE / "cylcontact").rglob("*.py")))).encode()
    ).hexdigest()
    names = chosen_recipes(bench)
    known = {
        name: result
        for name, result in _recorded(record, package).items()
        if name in names and is_current(result, bench.root)
    }
    old = [name for name in names if name not in known]
    failed: dict[str, FigureResult] = {}
    for start in range(0, len(old), PART):
        for result in build(bench, old[start : start + PART], folder, progress=progress):
            (failed if result.problem else known)[result.name] = result
        figures = [
            asdict(figure) | {"paths": [path.name for path in figure.paths]}
            for figure in known.values()
        ]
        with replacing(record) as temporary:
            temporary.write_text(json.dumps({"package": package, "figures": figures}), "utf-8")
    return [(known | failed)[name] for name in names]


def _recorded(record: Path, package: str) -> dict[str, FigureResult]:
    """Return the figures that this version of the package has drawn, by name."""
    try:
        drawn = json.loads(record.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    if drawn["package"] != package:
        return {}
    results = (
        FigureResult(**figure | {"paths": tuple(record.parent / name for name in figure["paths"])})
        for figure in drawn["figures"]
    )
    return {result.name: result for result in results}


def is_current(result: FigureResult, root: Path) -> bool:
    """Return whether a figure's files are there, and its inputs those that it was drawn from."""
    return all(path.is_file() for path in result.paths) and all(
        any(_hash(path) == known for path in (PACKAGE / name, root / name) if path.is_file())
        for name, known in result.inputs.items()
    )


def _hash(path: Path) -> str:
    """Return the start of a file's hash, as the results of figures have it."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:12]


def sections(
    results: Sequence[FigureResult], recipes: Mapping[str, Path], paper: Paper
) -> tuple[list[Shown], list[Shown]]:
    """Return the figures that the paper numbers, in its order, and the others."""
    rest = {result.name: result for result in results}
    numbered = []
    for number, title in paper.figures.items():
        name, heading = f"fig{number:02d}", f"Figure {number}. {title}"
        drawn = rest.pop(name, None)
        lacking = Shown(name, heading, f"there is no recipe reports/{name}.py")
        numbered.append(_shown(drawn, heading, recipes) if drawn else lacking)
    others = [
        _shown(each, _title(recipes[each.name]) or each.name, recipes) for each in rest.values()
    ]
    return numbered, others


def _shown(result: FigureResult, heading: str, recipes: Mapping[str, Path]) -> Shown:
    """Return a result under a heading."""
    problem = str(result.problem or "")
    return Shown(
        result.name, heading, problem, None if problem else result, recipes[result.name].name
    )


def _title(recipe: Path) -> str:
    """Return the first paragraph of a recipe's docstring, or nothing if it cannot be read.

    The numbers that the paper gives its figures are left out.

    Examples
    --------
    >>> import tempfile
    >>> recipe = Path(tempfile.mkdtemp()) / "fig98.py"
    >>> _ = recipe.write_text("'''Figs 98 and 99: a line, drawn.'''")
    >>> _title(recipe)
    'A line, drawn'
    """
    try:
        text = ast.get_docstring(ast.parse(recipe.read_text(encoding="utf-8"))) or ""
    except (SyntaxError, ValueError, OSError):
        return ""
    line = re.sub(
        r"^Figs? \d+\w*(?: (?:and|to) \d+)?:\s*", "", text.split("\n\n", 1)[0].replace("\n", " ")
    )
    return (line[:1].upper() + line[1:]).rstrip(".")
