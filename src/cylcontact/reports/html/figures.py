"""The figures of the report, and the checklist of the paper's figures."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cylcontact.reports.build import FigureResult
from cylcontact.reports.paper import Paper

__all__ = ["Download", "Figure", "Plate", "describe", "plates"]

NAME = re.compile(r"fig(\d\d)([a-z]*)")


@dataclass(frozen=True)
class Download:
    """A file for download."""

    kind: str
    href: str
    size: str


@dataclass(frozen=True)
class Figure:
    """One figure of the report, drawn or missing.

    Attributes
    ----------
    name, title, variant : str
        The recipe's name, the figure's title, and its variant.
    recipe : str
        The recipe's file.
    caption, method, problem : str
        The caption and the note of the method, or the reason why there is no figure.
    picture : str
        The PNG's address on the page.
    width, height : int
        Of the picture on the page, in pixels.
    downloads : tuple of Download
        The files for download.
    headline : mapping of str to str
        The figure's main results.
    inputs : mapping of str to str
        The files read for the figure, and the start of their hashes.
    """

    name: str
    title: str
    variant: str
    recipe: str
    caption: str
    method: str
    problem: str
    picture: str
    width: int
    height: int
    downloads: tuple[Download, ...]
    headline: Mapping[str, str]
    inputs: Mapping[str, str]


@dataclass(frozen=True)
class Plate:
    """One of the paper's figures with all its variants, or another figure."""

    id: str
    number: int | None
    title: str
    figures: tuple[Figure, ...]
    problem: str

    @property
    def page(self) -> str:
        """The name of its page, which is no other page's whatever the recipe is called."""
        return f"figure-{self.id}"

    @property
    def heading(self) -> str:
        """The title, behind the number that the paper gives it."""
        return f"Figure {self.number}. {self.title}" if self.number else self.title

    @property
    def status(self) -> str:
        """Either "missing" or "drawn"."""
        return "missing" if self.problem else "drawn"


def describe(result: FigureResult, recipe: Path, root: Path, page: Path, paper: Paper) -> Figure:
    """Return a figure as the page presents it.

    Parameters
    ----------
    result : FigureResult
        The recipe's outcome.
    recipe : path
        The recipe's file.
    root, page : path
        The bench's folder and the page's.
    paper : Paper
        The bench's description of its paper.
    """
    match = NAME.fullmatch(result.name)
    files = {path.suffix[1:]: path for path in result.paths}
    width, height = (round(mm * 96 / 25.4) for mm in result.size_mm)
    return Figure(
        name=result.name,
        title=_title(recipe),
        variant=paper.variants.get(match[2], match[2]) if match else "",
        recipe=recipe.relative_to(root).as_posix(),
        caption=result.caption,
        method=result.method,
        problem=str(result.problem or ""),
        picture=files["png"].relative_to(page).as_posix() if files else "",
        width=width,
        height=height,
        downloads=tuple(
            Download(kind.upper(), path.relative_to(page).as_posix(), _size(path))
            for kind, path in files.items()
        ),
        headline={name: f"{value:.6g}" for name, value in result.headline.items()},
        inputs=result.inputs,
    )


def plates(figures: Iterable[Figure], paper: Paper) -> tuple[list[Plate], list[Plate]]:
    """Return the paper's figures in order, and the others.

    Parameters
    ----------
    figures : iterable of Figure
        The figures of all recipes.
    paper : Paper
        Its `figures` are the checklist.

    Returns
    -------
    numbered, others : list of Plate
        A figure of the paper without a recipe is missing, with the reason.
    """
    numbered: dict[int, list[Figure]] = {number: [] for number in paper.figures}
    others = []
    for figure in figures:
        match = NAME.fullmatch(figure.name)
        if match and int(match[1]) in numbered:
            numbered[int(match[1])].append(figure)
        else:
            title = figure.title or figure.name
            others.append(Plate(figure.name, None, title, (figure,), figure.problem))
    plates = [_plate(number, numbered[number], title) for number, title in paper.figures.items()]
    return plates, others


def _plate(number: int, figures: Sequence[Figure], title: str) -> Plate:
    """Return one of the paper's figures."""
    name = f"fig{number:02d}"
    ordered = sorted(figures, key=lambda figure: "rpc".find(figure.name.removeprefix(name)[:1]))
    own = next((figure for figure in ordered if figure.name == name), None)
    problem = own.problem if own else f"there is no recipe reports/{name}.py"
    return Plate(name, number, title, tuple(ordered), problem)


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


def _size(path: Path) -> str:
    """Return a file's size in kB as text."""
    return f"{max(1, round(path.stat().st_size / 1000))} kB"
