"""Set a manuscript whose numbers, tables and figures come from results, as PDF and as LaTeX.

A manuscript is a template of Jinja in pandoc's Markdown. It may name

- groups: functions of `values.py` beside it, which take the bench and return texts, numbers and
  tables (DataFrames) by name. An `assert` there guards what the text says in words;
- `fit("internal")`, a result of the bench, or one of measurements by its file below the root;
- `figure("fig12")`, the main results of a figure.

An image that names a recipe is drawn; any other is a picture beside the manuscript.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from decimal import Decimal
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Any

import jinja2
import jinja2.meta
import numpy as np
import pandas as pd

from cylcontact.files.reading import read_text, require_file
from cylcontact.files.writing import replacing_all, require_writable
from cylcontact.fitting.results import FitResult
from cylcontact.plots.style import choose
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import build, draw
from cylcontact.support.errors import InputError
from cylcontact.support.progress import Progress, silent

# Pandoc's Markdown, without what would take a text with digits, @ or < for something else.
_READER = "markdown-example_lists-implicit_header_references-raw_html-raw_tex"
_FILTER = Path(__file__).with_name("crossref.lua")
_TEMPLATES = {"latex": "article.tex", "typst": "article.typ"}
_IMAGE = re.compile(r"\]\(<?([^<>()\n]+)>?\)(?=\{#fig:)")
_BIBLIOGRAPHY = re.compile(r"^bibliography: *(\S+) *$", re.MULTILINE)
Number = float | np.integer[Any]
_WORDS = [
    "zero",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
]


def typeset(bench: Bench, source: Path, folder: Path, progress: Progress = silent) -> Path:
    """Write a manuscript as PDF, and its sources for a journal in a folder `latex` beside that.

    Parameters
    ----------
    bench : Bench
        The bench whose results the manuscript names.
    source : path
        The manuscript; its bibliography is beside it, and so may be layouts of its own, in place
        of `article.typ` and `article.tex` of `reports/manuscript`.
    folder : path
        Where to write.
    progress : callable, optional
        Called with the stage, what is done and the total.

    Returns
    -------
    path
        The PDF.

    Raises
    ------
    InputError
        If a part is missing, a name stands for nothing, or an assertion fails; nothing is written.
    """
    text = read_text(source, "name a manuscript, a Markdown file")
    pdf = folder / f"{source.stem}.pdf"
    require_writable(pdf, folder / f"latex/{source.stem}.tex")
    filled = fill(text, bench, source)
    with TemporaryDirectory(prefix="cylcontact-") as name:
        sources = Path(name) / "latex"
        (sources / "figures").mkdir(parents=True)
        library = _BIBLIOGRAPHY.search(filled)
        if library is None:
            remedy = "name a file in BibTeX, e.g. bibliography: references.bib"
            raise InputError(str(source), "bibliography", None, "is missing", remedy)
        references = source.with_name(library[1])
        require_file(references, "name a file in BibTeX")
        copyfile(references, sources / references.name)
        filled = _with_pictures(filled, bench, source, sources / "figures", progress)
        progress("typesetting", 0, 1)
        tex, typ = (sources / f"{source.stem}.{ending}" for ending in ("tex", "typ"))
        tex.write_text(_pandoc(filled, "latex", bench, source), encoding="utf-8")
        typ.write_text(_pandoc(filled, "typst", bench, source), encoding="utf-8")
        _compile(typ, Path(name) / pdf.name, source)
        typ.unlink()
        made = [path for path in sorted(Path(name).rglob("*")) if path.is_file()]
        with replacing_all(folder / path.relative_to(name) for path in made) as temporaries:
            for temporary, path in zip(temporaries, made, strict=True):
                copyfile(path, temporary)
        progress("typesetting", 1, 1)
    return pdf


def fill(text: str, bench: Bench, source: Path) -> str:
    """Return a manuscript with the values that it names.

    Examples
    --------
    >>> from cylcontact.files.writing import shipped_bench
    >>> text = 'Its error is {{ fit("internal").objective.value | number(digits=2) }}.'
    >>> print(fill(text, Bench(shipped_bench()), Path("mine.md")))
    Its error is 0.064.
    """
    # Jinja's own comments would begin with a label such as {#eq:one}.
    jinja = jinja2.Environment(
        undefined=jinja2.StrictUndefined,
        finalize=_put,
        comment_start_string="<#",
        comment_end_string="#>",
        autoescape=False,
    )
    jinja.filters |= {"number": number, "words": words}
    given: dict[str, Any] = {
        "fit": lambda name: _result(bench, name),
        "figure": lambda name: draw(name, bench).headline,
    }
    try:
        named = jinja2.meta.find_undeclared_variables(jinja.parse(text))
        groups = {name: _group(name, bench, source) for name in sorted(named - given.keys())}
        return jinja.from_string(text).render(**given, **groups)
    except InputError:
        raise
    except Exception as error:
        where = getattr(error, "lineno", None) or _line(error)
        rule = f"cannot be filled in ({error})"
        remedy = "name a function of values.py and a key of what it returns, or fit, or figure"
        raise InputError(f"{source}, line {where}", "", None, rule, remedy) from error


def _line(error: BaseException) -> int:
    """Return the line of the template in which an error was raised."""
    lines, trace = [0], error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == "<template>":
            lines.append(trace.tb_lineno)
        trace = trace.tb_next
    return lines[-1]


def _group(name: str, bench: Bench, source: Path) -> Mapping[str, object]:
    """Return what a function of `values.py` beside a manuscript returns."""
    file = source.resolve().with_name("values.py")
    require_file(file, f"write it, with a function {name}(bench)")
    try:
        parts = file.parent.relative_to(bench.recipes_folder.resolve()).parts
    except ValueError:
        rule = f"is not in {bench.recipes_folder}, so it cannot import from there"
        raise InputError(str(file), "", None, rule, "move the manuscript there") from None
    function: Callable[[Bench], Any] | None = getattr(
        bench.module(".".join((*parts, "values"))), name, None
    )
    if not callable(function):
        raise InputError(str(file), name, None, "is no function of it", "add it")
    try:
        values: Mapping[str, object] = function(bench)
    except InputError:
        raise
    except AssertionError as error:
        rule, remedy = f"is not what the results say any more ({error})", "rewrite the text"
        raise InputError(str(file), name, None, rule, f"{remedy} and the assertion") from error
    except (Exception, SystemExit) as error:
        rule = f"failed with {type(error).__name__} ({error})"
        raise InputError(str(file), name, None, rule, "correct the file") from error
    return values


def _result(bench: Bench, name: str) -> FitResult:
    """Return a campaign's result by its name, or any by its file below the root."""
    if not name.endswith(".json"):
        return bench.result(name)
    return FitResult.read(bench.required(name, "this result does not exist", "fit it first"))


# --- values as Markdown ---------------------------------------------------------------------------


def _put(value: object) -> object:
    """Return a value as it stands in the text."""
    if isinstance(value, pd.DataFrame):
        return table_text(value)
    return number(value) if isinstance(value, float | int | np.integer | tuple) else value


def number(value: Number | tuple[Number, ...], unit: str = "", digits: int = 3) -> str:
    r"""Return a number, or a range, with its unit; integers in full.

    Examples
    --------
    >>> print(number(0.96609, "mm"), number((-2.04, 1.31), "%", digits=2), number(3.1e-7))
    0.966\ mm $-2.0$ to 1.3\ % $3.10 \times 10^{-7}$
    """
    ends = value if isinstance(value, tuple) else (value,)
    space = r"\ " if unit and unit != "°" else ""
    return " to ".join(_digits(end, digits) for end in ends) + space + unit


def _digits(value: Number, digits: int) -> str:
    """Return a number with so many significant digits, very large and small ones with a power."""
    printed = str(value) if isinstance(value, int | np.integer) else f"{float(value):#.{digits}g}"
    if not 1e-4 <= abs(Decimal(printed)) < 1e6 and "e" in printed:
        mantissa, _, power = printed.partition("e")
        factor = "" if mantissa == "1." else rf"{mantissa.rstrip('.')} \times "
        return f"${factor}10^{{{int(power)}}}$"
    text = f"{Decimal(printed):f}".rstrip(".") if "e" in printed else printed.rstrip(".")
    return f"${text}$" if text.startswith("-") else text


def words(value: int) -> str:
    """Return a small integer as a word, and a larger one in digits, as usual in print."""
    return _WORDS[value] if 0 <= value < len(_WORDS) else str(value)


def plain(text: str) -> str:
    r"""Escape a text, which may be a user's, so that no part of it is Markdown.

    Examples
    --------
    >>> print(plain("f = E*·ΔR_i < 2"))
    f = E\*·ΔR\_i \< 2
    """
    return re.sub(r"([\\`*_{}\[\]<>#$|~^@&])", r"\\\1", text)


def table_text(table: pd.DataFrame) -> str:
    """Return a table in Markdown, columns of numbers to the right.

    Examples
    --------
    >>> print(table_text(pd.DataFrame({"law": ["Johnson"], "error, %": [1.5]})))
    | law | error, % |
    |:------------|-----------:|
    | Johnson | 1.500 |
    """
    rows = [[_cell(cell) for cell in row] for row in table.astype(object).to_numpy()]
    rules = []
    for head, *cells in zip(table.columns, *rows, strict=True):
        width = max(*(len(word) for word in head.split()), *(min(len(c), 40) for c in cells))
        numeric = all(re.fullmatch(r"[$\d.± \\+−*-]+|–|", cell) for cell in cells)
        # Pandoc takes a column's share of the width from the hyphens.
        rules.append(f"{'-' * (width + 5)}:" if numeric else f":{'-' * (width + 5)}")
    lines = [f"| {' | '.join(row)} |" for row in (list(table.columns), *rows)]
    return "\n".join([lines[0], f"|{'|'.join(rules)}|", *lines[1:]])


def _cell(cell: object) -> str:
    """Return a cell of a table, numbers with four digits."""
    return number(cell, digits=4) if isinstance(cell, float) else str(cell)


# --- pictures, pandoc and Typst -------------------------------------------------------------------


def _with_pictures(text: str, bench: Bench, source: Path, folder: Path, progress: Progress) -> str:
    """Draw the recipes that images name, copy the pictures, and return the text with their paths.

    An image may give a recipe arguments: `<maps material=bronze>`.
    """
    made: dict[str, str] = {}
    options = choose(bench.recipes_folder / "style.mplstyle", formats=("pdf",))
    for target in dict.fromkeys(_IMAGE.findall(text)):
        if Path(target).suffix:
            picture = source.parent / target
            require_file(picture, "name a picture beside the manuscript, or a recipe")
            made[target] = picture.name
            copyfile(picture, folder / picture.name)
            continue
        name, *pairs = re.split(r"\s+(?=\w+=)", target)
        arguments = dict(pair.split("=", 1) for pair in pairs)
        (figure,) = build(bench, [name], folder, options, progress, arguments)
        if figure.problem is not None:
            raise figure.problem
        made[target] = figure.paths[0].name
    return _IMAGE.sub(lambda found: f"](<figures/{made[found[1]]}>)", text)


def _pandoc(text: str, kind: str, bench: Bench, source: Path) -> str:
    """Return a manuscript as LaTeX or Typst; what pandoc warns of is an error."""
    template = source.with_name(_TEMPLATES[kind])
    if not template.is_file():
        template = bench.recipes_folder / "manuscript" / template.name
    require_file(template, "cylcontact init lays out a bench that has it")
    options = ["--natbib", f"--template={template.resolve()}", f"--lua-filter={_FILTER}"]
    try:
        import pypandoc  # type: ignore[import-untyped]

        made: str = pypandoc.convert_text(
            text, kind, _READER, extra_args=["--fail-if-warnings", *options]
        )
    except (ImportError, OSError) as error:
        raise _without("pandoc") from error
    except RuntimeError as error:
        reason = " ".join((str(error).partition("conversion: ")[2] or str(error)).split())
        rule = f"is not what pandoc can set ({reason})"
        raise InputError(str(source), "", None, rule, "correct it") from error
    return made


def _compile(file: Path, pdf: Path, source: Path) -> None:
    """Write the PDF of a file in Typst, with fonts that are the same on all machines."""
    try:
        import typst
    except ImportError as error:
        raise _without("typst") from error
    try:
        typst.compile(file, pdf, file.parent, ignore_system_fonts=True)
    except typst.TypstError as error:
        rule = f"cannot be set by Typst ({error.message})"
        raise InputError(str(source), "", None, rule, "correct it") from error


def _without(name: str) -> InputError:
    """Return the error for a package that is not installed."""
    remedy = "pip install 'cylcontact[paper]', or make extras"
    return InputError("paper", "", None, f"needs {name}", remedy)
