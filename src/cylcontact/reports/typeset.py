"""Set a manuscript: a PDF to read, LaTeX for a journal, and the numbers that stand in it.

Pandoc turns the Markdown into a tree, in which references to figures, tables, equations and
sections are resolved here; from the tree it writes Typst, which becomes the PDF, and LaTeX.
"""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from shutil import copyfile
from typing import Any
from urllib.parse import unquote

import pandas as pd

from cylcontact.errors import InputError
from cylcontact.files import keeping, replacing_all, require_writable, scratch_folder
from cylcontact.plain_text import csv_text
from cylcontact.plots.style import choose
from cylcontact.progress import Progress, silent
from cylcontact.reading import SPEC_BYTES, TABLE_BYTES, read_text, require_file
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import FigureResult, build
from cylcontact.reports.manuscript import (
    PLACEHOLDER,
    Values,
    figures_named,
    fill,
    require_holds,
)

__all__ = ["TypesetManuscript", "typed_numbers", "typeset"]

# Pandoc's Markdown, without what would take a text with digits or @ for something else.
_READER = "markdown-example_lists-implicit_header_references-raw_html"
# The folder of the sources for a journal.
JOURNAL = "latex"
_TEMPLATES = {"latex": "article.tex", "typst": "article.typ"}
# How the kinds of labels are named where the text refers to them.
_KINDS = {"fig": "Fig.", "tbl": "Table", "eq": "Eq.", "sec": "Sect."}
_LABEL = re.compile(r"\{#(eq:[\w:.-]+)\}")
# An entry of a file in BibTeX.
_KEY = re.compile(r"^\s*@\w+\s*\{\s*([^\s,]+)\s*,", re.MULTILINE)
_PICTURES = (".pdf", ".png", ".jpg", ".jpeg")
_YEAR = re.compile(r"\b(?:1[89]|20)\d\d\b")

Node = dict[str, Any]


@dataclass(frozen=True)
class TypesetManuscript:
    """What was written.

    Attributes
    ----------
    pdf : path
        The PDF.
    sources : path
        The folder with LaTeX, references and figures.
    notes : tuple of str
        What a referee would ask about: numbers that are typed, figures and tables that the text
        does not mention.
    """

    pdf: Path
    sources: Path
    notes: tuple[str, ...]


def typeset(
    bench: Bench, source: Path, folder: Path, progress: Progress = silent
) -> TypesetManuscript:
    """Fill in a manuscript's numbers, draw its figures, and write the PDF and the LaTeX sources.

    Parameters
    ----------
    bench : Bench
        The bench whose results the manuscript names.
    source : path
        The manuscript; its bibliography and the templates `article.typ` and `article.tex` are
        beside it.
    folder : path
        Where to write.
    progress : callable, optional
        Called with the stage, what is done and the total.

    Returns
    -------
    TypesetManuscript

    Raises
    ------
    InputError
        If a part is missing, a placeholder names nothing, a phrase does not hold any more, or a
        reference leads nowhere. Nothing is written then.
    """
    text = read_text(source, SPEC_BYTES, "name a manuscript, a Markdown file")
    pdf = folder / f"{source.stem}.pdf"
    require_writable(pdf)
    tree = _read(text, source)
    require_holds(text, bench, source)
    inputs = [source, *source.parent.glob("*.*"), *bench.inputs]
    with scratch_folder() as scratch, keeping(inputs):
        figures, pictures = _draw(bench, source, text, tree, scratch / JOURNAL, progress)
        progress("typesetting", 0, 1)
        filled = fill(text, Values(bench, source, figures))
        notes = _set(filled.text, source, pictures, scratch)
        numbers = pd.DataFrame(filled.numbers, columns=["line", "placeholder", "value", "unit"])
        (scratch / "numbers.csv").write_text(csv_text(numbers), encoding="utf-8")
        _move(scratch, folder)
        progress("typesetting", 1, 1)
    typed = typed_numbers(text, source)
    if typed:
        notes = [f"typed, and not from a result: {', '.join(typed)}", *notes]
    return TypesetManuscript(pdf, folder / JOURNAL, tuple(notes))


def typed_numbers(text: str, source: Path) -> list[str]:
    """Return the words of a manuscript in which a digit is typed.

    Equations, citations, code and years may have digits.

    Parameters
    ----------
    text : str
        The manuscript, with its placeholders.
    source : path
        Its file, for errors.

    Returns
    -------
    list of str
    """
    tree = _read(PLACEHOLDER.sub("", text), source)
    prose = [tree["meta"].get(key) for key in ("title", "abstract", "keywords")]
    words = (node["c"] for node in _nodes([prose, tree["blocks"]], "Str", without=("Cite",)))
    return [word for word in words if re.search(r"\d", _YEAR.sub("", word))]


def _set(text: str, source: Path, pictures: Mapping[str, str], folder: Path) -> list[str]:
    """Write a manuscript without placeholders in both forms; return what a referee would note."""
    tree = _read(text, source)
    for image in _nodes(tree, "Image"):
        image["c"][2][0] = pictures[_target(image)]
    library = _bibliography(tree, source)
    notes = _checked(tree, library, source)
    # Typst finds pictures and references where LaTeX does.
    place = folder / JOURNAL
    copyfile(library, place / library.name)
    latex, typst = (place / f"{source.stem}.{ending}" for ending in ("tex", "typ"))
    latex.write_text(_write(_resolved(tree, "latex"), "latex", source), encoding="utf-8")
    typst.write_text(_write(_resolved(tree, "typst"), "typst", source), encoding="utf-8")
    _compile(typst, folder / f"{source.stem}.pdf", source)
    typst.unlink()
    return notes


def _move(scratch: Path, folder: Path) -> None:
    """Copy all files of one folder to another, all of them or none."""
    made = sorted(path for path in scratch.rglob("*") if path.is_file())
    with replacing_all(folder / path.relative_to(scratch) for path in made) as temporaries:
        for temporary, path in zip(temporaries, made, strict=True):
            copyfile(path, temporary)


# --- figures ------------------------------------------------------------------------------------


def _draw(
    bench: Bench, source: Path, text: str, tree: Node, folder: Path, progress: Progress
) -> tuple[dict[str, FigureResult], dict[str, str]]:
    """Draw a manuscript's figures; return them by recipe, and the pictures by the image's target.

    A target is a recipe, with arguments as on the command line, or a picture beside the manuscript.
    """
    targets = dict.fromkeys(map(_target, _nodes(tree, "Image")))
    given: dict[str, tuple[str, dict[str, str]]] = {}
    pictures: dict[str, str] = {}
    (folder / "figures").mkdir(parents=True)
    for target in targets:
        if Path(target).suffix in _PICTURES:
            pictures[target] = _copied(source, target, folder / "figures")
        else:
            name, *pairs = re.split(r"\s+(?=\w+=)", target)
            given[target] = name, dict(pair.split("=", 1) for pair in pairs)
    plain = {name for name, arguments in given.values() if not arguments}
    names = sorted({*plain, *figures_named(text)})
    options = choose(bench.recipes_folder / "style.toml", formats=("pdf",))
    drawn = build(bench, names, folder / "figures", options, progress) if names else []
    figures = {figure.name: figure for figure in map(_complete, drawn)}
    for target, (name, arguments) in given.items():
        figure = figures.get(name)
        if arguments or figure is None:
            (figure,) = map(
                _complete, build(bench, [name], folder / "figures", options, silent, arguments)
            )
        pictures[target] = f"figures/{figure.paths[0].name}"
    return figures, pictures


def _target(image: Node) -> str:
    """Return what an image names."""
    return unquote(image["c"][2][0])


def _copied(source: Path, target: str, folder: Path) -> str:
    """Copy a picture that is beside the manuscript; return its name for the typeset one."""
    picture = source.parent / target
    require_file(picture, TABLE_BYTES, "name a picture beside the manuscript, or a recipe")
    copyfile(picture, folder / picture.name)
    return f"figures/{picture.name}"


def _complete(figure: FigureResult) -> FigureResult:
    """Return a figure that has been drawn; raise the reason if it has not."""
    if figure.problem is not None:
        raise figure.problem
    return figure


# --- references ---------------------------------------------------------------------------------


def _checked(tree: Node, library: Path, source: Path) -> list[str]:
    """Refuse references that lead nowhere; return what the text does not refer to."""
    labels, keys = set(_labels(tree)), set(_KEY.findall(library.read_text(encoding="utf-8")))
    named = [cited["citationId"] for cite in _nodes(tree, "Cite") for cited in cite["c"][0]]
    for name in named:
        if name not in labels | keys:
            where, kinds = f"no label, and {library.name} has no such entry", ", ".join(_KINDS)
            remedy = f"label it as {{#{name}}} (the kinds are {kinds}), or add the entry"
            raise InputError(str(source), "", f"@{name}", f"is {where}", remedy)
    shown = sorted(label for label in labels - set(named) if label.startswith(("fig:", "tbl:")))
    return [f"not referred to in the text: {', '.join(shown)}"] if shown else []


def _labels(tree: Node) -> Iterator[str]:
    """Yield the labels of figures, tables, sections and equations."""
    for node in _nodes(tree, "Figure", "Table", "Header"):
        identifier = node["c"][1 if node["t"] == "Header" else 0][0]
        if identifier:
            yield identifier
    for node in _nodes(tree, "Str"):
        if found := _LABEL.fullmatch(node["c"]):
            yield found[1]


def _resolved(tree: Any, kind: str) -> Any:
    """Return a tree whose labels and references are those of LaTeX or Typst."""
    if isinstance(tree, dict):
        return {key: _resolved(value, kind) for key, value in tree.items()}
    if not isinstance(tree, list):
        return tree
    nodes: list[Any] = []
    for node in tree:
        of = node.get("t") if isinstance(node, dict) else None
        found = _LABEL.fullmatch(node["c"]) if of == "Str" else None
        if found and nodes:
            _label_equation(nodes, found[1], kind)
        elif of == "Cite" and _is_label(node["c"][0][0]["citationId"]):
            nodes += _reference(node, kind)
        else:
            nodes.append(_resolved(node, kind))
    return nodes


def _label_equation(nodes: list[Node], label: str, kind: str) -> None:
    """Label the equation at the end of a list of nodes, before a space or not."""
    if nodes[-1]["t"] in ("Space", "SoftBreak"):
        nodes.pop()
    if kind == "typst":
        # Equations without a label have no number.
        numbered = '#[#set math.equation(numbering: "(1)")\n'
        nodes[-1:] = [_raw(kind, numbered), nodes[-1], _raw(kind, f" <{label}>]")]
        return
    formula = nodes.pop()["c"][1].strip()
    nodes.append(_raw(kind, f"\\begin{{equation}}\\label{{{label}}}\n{formula}\n\\end{{equation}}"))


def _is_label(name: str) -> bool:
    """Return whether what is cited is a figure, a table, an equation or a section."""
    return name.partition(":")[0] in _KINDS and ":" in name


def _reference(cite: Node, kind: str) -> Iterator[Node]:
    """Yield a reference to labels: the kind, and the numbers, which LaTeX and Typst insert."""
    for place, cited in enumerate(cite["c"][0]):
        label = cited["citationId"]
        of = label.partition(":")[0]
        text = f"{_KINDS[of]}\u00a0"
        yield {"t": "Str", "c": f", {text}" if place else text}
        number = f"\\ref{{{label}}}" if kind == "latex" else f"#ref(<{label}>, supplement: none)"
        yield _raw(kind, f"({number})" if of == "eq" else number)


def _raw(kind: str, text: str) -> Node:
    """Return text that goes into LaTeX or Typst as it is."""
    return {"t": "RawInline", "c": [kind, text]}


# --- pandoc and Typst ---------------------------------------------------------------------------


def _nodes(tree: Any, *kinds: str, without: Sequence[str] = ()) -> Iterator[Node]:
    """Yield the nodes of some kinds, in the order of the text, and none below others."""
    if isinstance(tree, list):
        for node in tree:
            yield from _nodes(node, *kinds, without=without)
    elif isinstance(tree, dict):
        if tree.get("t") in without:
            return
        if tree.get("t") in kinds:
            yield tree
        for value in tree.values():
            yield from _nodes(value, *kinds, without=without)


def _read(text: str, source: Path) -> Node:
    """Return a text in Markdown as pandoc's tree."""
    tree: Node = json.loads(_pandoc(source, text, "json", _READER))
    return tree


def _write(tree: Node, kind: str, source: Path) -> str:
    """Return a tree as LaTeX or Typst."""
    template = source.with_name(_TEMPLATES[kind])
    read_text(template, SPEC_BYTES, "name a template of pandoc", "copy it from cylcontact init")
    options = ["--natbib", f"--template={template.resolve()}"]
    return _pandoc(source, json.dumps(tree), kind, "json", options)


def _pandoc(source: Path, text: str, to: str, form: str, options: Sequence[str] = ()) -> str:
    """Return what pandoc makes of a text."""
    pypandoc = _extra("pypandoc")
    try:
        made: str = pypandoc.convert_text(text, to, form, extra_args=options)
    except RuntimeError as error:
        rule = f"is not what pandoc can set ({error})"
        raise InputError(str(source), "", None, rule, "correct it") from error
    return made


def _compile(file: Path, pdf: Path, source: Path) -> None:
    """Write the PDF of a file in Typst, with fonts that are the same on all machines."""
    typst = _extra("typst")
    try:
        typst.compile(file, pdf, file.parent, ignore_system_fonts=True)
    except typst.TypstError as error:
        rule = f"cannot be set by Typst ({error.message})"
        raise InputError(str(source), "", None, rule, "correct it") from error


def _extra(name: str) -> Any:
    """Import a package that only manuscripts need."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        rule, remedy = f"needs {name}", "make paper, or pip install 'cylcontact[paper]'"
        raise InputError("manuscript", "", None, rule, remedy) from error


def _bibliography(tree: Node, source: Path) -> Path:
    """Return the file of references that a manuscript names, beside it."""
    given = tree["meta"].get("bibliography")
    if given is None:
        rule, remedy = "is missing", "name it at the top, e.g. bibliography: references.bib"
        raise InputError(str(source), "bibliography", None, rule, remedy)
    name = "".join(node["c"] for node in _nodes(given, "Str"))
    library = source.with_name(name)
    read_text(library, SPEC_BYTES, "name a file in BibTeX")
    return library
