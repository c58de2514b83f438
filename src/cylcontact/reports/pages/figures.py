"""The figures of the site, in the paper's order."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cylcontact.reports.build import FigureResult
from cylcontact.reports.paper import Paper

__all__ = ["Shown", "sections"]


@dataclass(frozen=True)
class Shown:
    """A figure under its heading; one of the paper that nobody draws has a problem only."""

    name: str
    heading: str
    problem: str = ""
    result: FigureResult | None = None
    recipe: str = ""


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
