"""Set a manuscript: a PDF to read, LaTeX for a journal, and the numbers that stand in it.

Pandoc turns the Markdown into a tree, in which references to figures, tables, equations and
sections are resolved here; from the tree it writes Typst, which becomes the PDF, and LaTeX.
"""

from __future__ import annotations

import importlib
import json
import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Any
from urllib.parse import unquote

import pandas as pd

from cylcontact.errors import InputError
from cylcontact.files import replacing_all, require_writable
from cylcontact.plots.style import choose
from cylcontact.progress import Progress, silent
from cylcontact.reading import read_text, require_file
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import FigureResult, build
from cylcontact.reports.manuscript import (
    PLACEHOLDER,
    Filled,
    Values,
    figures_named,
    fill,
    require_holds,
)

__all__ = ["TypesetManuscript", "typed_numbers", "typeset"]

# Pandoc's Markdown, without what would take a text with digits, @ or < for something else.
_READER = "markdown-example_lists-implicit_header_references-raw_html"
# The folder of the sources for a journal.
JOURNAL = "latex"
_TEMPLATES = {"latex": "article.tex", "typst": "article.typ"}
# How the kinds of labels are named where the text refers to them.
_KINDS = {"fig": "Fig.", "tbl": "Table", "eq": "Eq.", "sec": "Sect."}
_LABEL = re.compile(r"\{#(eq:[\w:.-]+)\}")
# An entry of a file in BibTeX.
_KEY = re.compile(
    r"^\s*@(?!(?:comment|string|preamble)\b)\w+\s*\{\s*([^\s,]+)\s*,", re.MULTILINE | re.IGNORECASE
)
_PICTURES = (".pdf", ".png", ".jpg", ".jpeg")
_YEAR = re.compile(r"\b(?:1[89]|20)\d\d\b")
# What stands for a number before there is one.
_WORD = "VALUE"

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
        does not mention, phrases of `HOLDS` that are not in it.
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
    text = read_text(source, "name a manuscript, a Markdown file")
    if folder.resolve() == source.resolve().parent:
        rule, remedy = "is the manuscript's own folder", "choose another"
        raise InputError("manuscript", "--out", str(folder), rule, remedy)
    pdf = folder / f"{source.stem}.pdf"
    require_writable(pdf, folder / "numbers.csv", folder / JOURNAL / f"{source.stem}.tex")
    try:
        notes = _typeset(bench, source, text, folder, progress)
    except RecursionError:
        raise InputError(str(source), "", None, "is nested too deeply", "flatten it") from None
    return TypesetManuscript(pdf, folder / JOURNAL, tuple(notes))


def _typeset(bench: Bench, source: Path, text: str, folder: Path, progress: Progress) -> list[str]:
    """Do the work of `typeset`; return the notes."""
    tree = _read(PLACEHOLDER.sub(_WORD, text), source)
    _require_places(tree, text, source)
    absent = require_holds(text, bench, source)
    with TemporaryDirectory(prefix="cylcontact-") as name:
        scratch = Path(name)
        figures, pictures = _draw(bench, source, text, tree, scratch / JOURNAL, progress)
        progress("typesetting", 0, 1)
        values = Values(bench, source, figures)
        filled = fill(text, values)
        notes = _set(filled.text, source, pictures, scratch)
        _write_numbers(filled, scratch)
        _move(scratch, folder)
        progress("typesetting", 1, 1)
    typed, own = _typed(tree), values.names_own
    return [
        *([f"typed, and not from a result: {', '.join(typed)}"] if typed else []),
        *notes,
        *(f"HOLDS guards a phrase that is not in the text: {one}" for one in absent if own),
    ]


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
    return _typed(_read(PLACEHOLDER.sub(_WORD, text), source))


def _typed(tree: Node) -> list[str]:
    """Return the words of a tree in which a digit is typed."""
    prose = [tree["meta"].get(key) for key in ("title", "abstract", "keywords")]
    words = (node["c"] for node in _nodes([prose, tree["blocks"]], "Str", without=("Cite",)))
    return list(dict.fromkeys(w for w in words if re.search(r"\d", _YEAR.sub("", w))))


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


def _write_numbers(filled: Filled, folder: Path) -> None:
    """Write the list of numbers, and each table as CSV."""
    numbers = pd.DataFrame(filled.numbers, columns=["line", "placeholder", "value", "unit"])
    numbers.to_csv(folder / "numbers.csv", index=False, lineterminator="\n")
    for name, table in filled.tables.items():
        (folder / "tables").mkdir(exist_ok=True)
        table.to_csv(folder / "tables" / f"{name}.csv", index=False, lineterminator="\n")


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
    targets = list(dict.fromkeys(map(_target, _nodes(tree, "Image"))))
    files = [target for target in targets if Path(target).suffix.lower() in _PICTURES]
    recipes = {target: _recipe(target, source) for target in targets if target not in files}
    plain = _without_arguments(recipes.values(), figures_named(text), source)
    place = folder / "figures"
    place.mkdir(parents=True)
    for target in files:
        _copy_picture(source, target, place)
    options = choose(bench.recipes_folder / "style.mplstyle", formats=("pdf",))
    drawn = build(bench, plain, place, options, progress) if plain else []
    figures = {figure.name: figure for figure in map(_complete, drawn)}
    pictures = {target: f"figures/{Path(target).name}" for target in files}
    for target, (name, arguments) in recipes.items():
        if arguments:
            (variant,) = map(_complete, build(bench, [name], place, options, silent, arguments))
            figures.setdefault(name, variant)
        figure = variant if arguments else figures[name]
        pictures[target] = f"figures/{figure.paths[0].name}"
    _require_apart(pictures, source)
    return figures, pictures


def _without_arguments(
    recipes: Collection[tuple[str, Mapping[str, str]]], named: Sequence[str], source: Path
) -> list[str]:
    """Return the recipes to draw without arguments: of images, and of numbers that are named.

    The numbers of a recipe that is drawn with arguments are that figure's, so there is one.
    """
    of = {name: [arguments for one, arguments in recipes if one == name] for name, _ in recipes}
    for name in named:
        if len(of.get(name, ())) > 1:
            rule = "is drawn with several arguments, so its numbers are not those of one figure"
            raise InputError(str(source), "", f"figure.{name}", rule, "name a value of your own")
    plain = {name for name, each in of.items() if {} in each}
    return sorted(plain | {name for name in named if name not in of})


def _recipe(target: str, source: Path) -> tuple[str, dict[str, str]]:
    """Return the recipe that an image names, and its arguments."""
    name, *pairs = re.split(r"\s+(?=\w+=)", target)
    arguments = dict(pair.split("=", 1) for pair in pairs)
    if len(arguments) < len(pairs):
        raise InputError(str(source), "", target, "has an argument twice", "leave one out")
    if "/" in name or Path(name).suffix or not name:
        rule = f"is neither a recipe nor a picture ({', '.join(_PICTURES)})"
        raise InputError(str(source), "", target, rule, "name a file beside it, or a recipe")
    return name, arguments


def _target(image: Node) -> str:
    """Return what an image names."""
    return unquote(image["c"][2][0])


def _copy_picture(source: Path, target: str, folder: Path) -> None:
    """Copy a picture that is beside the manuscript."""
    picture = source.parent / target
    require_file(picture, "name a picture beside the manuscript, or a recipe")
    copyfile(picture, folder / picture.name)


def _require_apart(pictures: Mapping[str, str], source: Path) -> None:
    """Refuse two images whose pictures would have one name."""
    taken = Counter(pictures.values())
    for target, picture in pictures.items():
        if taken[picture] > 1:
            rule = f"would be {picture}, and so would another figure"
            raise InputError(str(source), "", target, rule, "rename the picture")


def _complete(figure: FigureResult) -> FigureResult:
    """Return a figure that has been drawn; raise the reason if it has not."""
    if figure.problem is not None:
        raise figure.problem
    return figure


# --- what may stand where -----------------------------------------------------------------------


def _require_places(tree: Node, text: str, source: Path) -> None:
    """Refuse a missing title, TeX, which one of the outputs would leave out, and misplaced values.

    In a formula, in code and in an address a value would be something else than its text.
    """
    if not tree["meta"].get("title"):
        rule, remedy = "is missing", "name it at the top, e.g. title: On rollers"
        raise InputError(str(source), "title", None, rule, remedy)
    for node in _nodes(tree, "RawInline", "RawBlock"):
        rule = "is TeX or HTML, which the PDF would leave out"
        raise InputError(str(source), "", node["c"][1], rule, "write it in Markdown")
    if _WORD in PLACEHOLDER.sub("", text):  # it may stand anywhere then
        rule = "stands for numbers while the text is read"
        raise InputError(str(source), "", _WORD, rule, "take another word")
    for node in _nodes(tree, "Math", "Code", "CodeBlock"):
        if _WORD in node["c"][1]:
            _refuse_place(source, node["c"][1], "a formula or code")
    for node in _nodes(tree, "Link", "Image"):
        if _WORD in node["c"][2][0]:
            _refuse_place(source, node["c"][2][0], "an address")


def _refuse_place(source: Path, near: str, where: str) -> None:
    """Raise the error for a placeholder where it cannot stand."""
    rule = f"is {where}, where no number can be put in ({_WORD} is where it would be)"
    remedy = "end it before the number, as in $x$ = {{fit.NAME.a}}"
    raise InputError(str(source), "", near, rule, remedy)


def _checked(tree: Node, library: Path, source: Path) -> list[str]:
    """Refuse labels and references that cannot be set; return what the text does not refer to."""
    labels, keys = list(_labels(tree, source)), set(_KEY.findall(library.read_text("utf-8")))
    for label, times in Counter(labels).items():
        if times > 1:
            rule = f"labels {times} things"
            raise InputError(str(source), "", f"{{#{label}}}", rule, "rename one")
    named = [one for cite in _nodes(tree, "Cite") for one in _cited(cite, source)]
    for name in named:
        if name not in (labels if _is_label(name) else keys):
            kinds = ", ".join(_KINDS)
            rule = f"is no label, and {library.name} has no such entry"
            remedy = f"label it, as in {{#fig:map}} (the kinds are {kinds}), or add the entry"
            raise InputError(str(source), "", f"@{name}", rule, remedy)
    shown = [label for label in labels if label.startswith(("fig:", "tbl:"))]
    missing = sorted(set(shown) - set(named))
    return [f"not referred to in the text: {', '.join(missing)}"] if missing else []


def _cited(cite: Node, source: Path) -> list[str]:
    """Return what a citation names: labels, or entries of the bibliography."""
    cited = cite["c"][0]
    names = [one["citationId"] for one in cited]
    if any(map(_is_label, names)):
        has_words = any(one["citationPrefix"] or one["citationSuffix"] for one in cited)
        if has_words or not all(map(_is_label, names)):
            rule = "stands in brackets with something else"
            label = next(name for name in names if _is_label(name))
            raise InputError(str(source), "", f"@{label}", rule, "write it without brackets")
    return names


def _labels(tree: Node, source: Path) -> Iterator[str]:
    """Yield the labels of figures, tables, sections and equations."""
    for node in _nodes(tree, "Figure", "Table", "Header"):
        identifier = node["c"][1 if node["t"] == "Header" else 0][0]
        if identifier:
            yield identifier
    equations = [found[1] for nodes in _lists(tree) for found in _equations(nodes)]
    texts = [node["c"] for node in _nodes(tree, "Str") if "{#eq:" in node["c"]]
    if len(texts) > len(equations):
        stray = next((one for one in texts if not _LABEL.fullmatch(one)), texts[-1])
        rule = "stands behind no displayed equation"
        remedy = "write $$ … $$ {#eq:one}, any full stop before the dollars"
        raise InputError(str(source), "", stray, rule, remedy)
    yield from equations


def _equations(nodes: list[Any]) -> Iterator[re.Match[str]]:
    """Yield the labels of the displayed equations in a list of nodes."""
    for place, node in enumerate(nodes):
        before = [one for one in nodes[:place] if _type(one) not in ("Space", "SoftBreak")]
        found = _LABEL.fullmatch(node["c"]) if _type(node) == "Str" else None
        formula = before[-1] if before and _type(before[-1]) == "Math" else None
        if found and formula and formula["c"][0]["t"] == "DisplayMath":
            yield found


# --- references ---------------------------------------------------------------------------------


def _resolved(tree: Any, kind: str) -> Any:
    """Return a tree whose labels and references are those of LaTeX or Typst."""
    if isinstance(tree, dict):
        return {key: _resolved(value, kind) for key, value in tree.items()}
    if not isinstance(tree, list):
        return tree
    nodes: list[Any] = []
    for node in tree:
        found = _LABEL.fullmatch(node["c"]) if _type(node) == "Str" else None
        if found:
            _label_equation(nodes, found[1], kind)
        elif _type(node) == "Cite" and _is_label(node["c"][0][0]["citationId"]):
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
    labelled = f"\\begin{{equation}}\\label{{{label}}}\n{formula}\n\\end{{equation}}"
    nodes.append(_raw(kind, labelled))


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


def _type(node: object) -> str:
    """Return the type of a node; empty for what is none."""
    return str(node.get("t", "")) if isinstance(node, dict) else ""


def _nodes(tree: Any, *kinds: str, without: Sequence[str] = ()) -> Iterator[Node]:
    """Yield the nodes of some kinds, in the order of the text, and none below others."""
    if isinstance(tree, list):
        for node in tree:
            yield from _nodes(node, *kinds, without=without)
    elif isinstance(tree, dict) and tree.get("t") not in without:
        if tree.get("t") in kinds:
            yield tree
        for value in tree.values():
            yield from _nodes(value, *kinds, without=without)


def _lists(tree: Any) -> Iterator[list[Any]]:
    """Yield all lists of a tree."""
    if isinstance(tree, list):
        yield tree
    for value in (
        tree.values() if isinstance(tree, dict) else tree if isinstance(tree, list) else ()
    ):
        yield from _lists(value)


def _read(text: str, source: Path) -> Node:
    """Return a text in Markdown as pandoc's tree."""
    tree: Node = json.loads(_pandoc(source, text, "json", _READER))
    return tree


def _write(tree: Node, kind: str, source: Path) -> str:
    """Return a tree as LaTeX or Typst."""
    template = source.with_name(_TEMPLATES[kind])
    read_text(template, "name a template of pandoc", "copy it from cylcontact init")
    options = ["--natbib", f"--template={template.resolve()}"]
    return _pandoc(source, json.dumps(tree), kind, "json", options)


def _pandoc(source: Path, text: str, to: str, form: str, options: Sequence[str] = ()) -> str:
    """Return what pandoc makes of a text; what it warns of is an error."""
    pypandoc = _extra("pypandoc")
    try:
        made: str = pypandoc.convert_text(
            text, to, form, extra_args=["--fail-if-warnings", *options]
        )
    except RuntimeError as error:
        reasons = str(error).partition("conversion: ")[2] or str(error)
        rule = f"is not what pandoc can set ({' '.join(reasons.split())})"
        raise InputError(str(source), "", None, rule, "correct it") from error
    except OSError as error:
        raise _without("pandoc") from error
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
        raise _without(name) from error


def _without(name: str) -> InputError:
    """Return the error for a package that is not installed."""
    remedy = "pip install 'cylcontact[paper]', or make extras"
    return InputError("manuscript", "", None, f"needs {name}", remedy)


def _bibliography(tree: Node, source: Path) -> Path:
    """Return the file of references that a manuscript names, beside it."""
    given = tree["meta"].get("bibliography")
    parts = _nodes(given if _type(given) == "MetaInlines" else None, "Str", "Space")
    name = "".join(part.get("c", " ") for part in parts)
    if not name or Path(name).name != name:
        rule = "must name one file beside the manuscript"
        raise InputError(
            str(source), "bibliography", name or None, rule, "e.g. bibliography: references.bib"
        )
    library = source.with_name(name)
    read_text(library, "name a file in BibTeX")
    return library
