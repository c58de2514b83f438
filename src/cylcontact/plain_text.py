"""Text from others as plain text, for each place where it is put out.

Names, labels, notes and messages come from files that others wrote, and from other programs. They
may hold markup, formulas, commands of a terminal, or a million characters. Here is one function for
each place: a terminal or a message, a page, LaTeX, Markdown, a figure, a CSV file, source code, a
file's name. Results store texts unchanged.
"""

from __future__ import annotations

import re
from html import escape
from keyword import kwlist
from string import punctuation
from typing import TYPE_CHECKING, Any
from unicodedata import category

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "RESERVED",
    "as_label",
    "brief",
    "comment",
    "csv_text",
    "file_name",
    "from_csv",
    "html",
    "identifier",
    "latex",
    "markdown",
    "page_text",
    "visible",
]

# The most characters of a name within a sentence, a cell or a figure, and of a text on a page.
_NAME, _LABEL, _PARAGRAPH = 100, 60, 10_000


def visible(text: str, keep: str = "") -> str:
    r"""Escape the characters that are not seen, and could hide, reorder or erase what is.

    These are control characters, marks of the direction of writing, characters without width, and
    halves of surrogate pairs. Spaces of any width stay.

    Parameters
    ----------
    text : str
        Any text.
    keep : str, optional
        Control characters that may stay, such as line breaks.

    Examples
    --------
    >>> print(visible("a\x1b[2Jb\u202ec\nd ΔR"))
    a\x1b[2Jb\u202ec\nd ΔR
    """
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() or c in keep or category(c) == "Zs" else repr(c)[1:-1] for c in text
    )


def brief(text: str, most: int = _NAME) -> str:
    """Return a name for a sentence or a cell: visible, and cut if it is long.

    Examples
    --------
    >>> brief("x" * 1_000_000, 9)
    'xxxxxxxx…'
    """
    shown = visible(text[: most + 1])
    return shown if len(shown) <= most else f"{shown[: most - 1]}…"


def html(text: str) -> str:
    """Return a text for a page or an attribute in double quotes: it opens no element.

    Examples
    --------
    >>> html("<b>a & b</b>")
    '&lt;b&gt;a &amp; b&lt;/b&gt;'
    """
    return escape(page_text(text))


def page_text(text: str) -> str:
    """Return a text as a page shows it, not yet escaped for HTML."""
    shown = visible(text[: _PARAGRAPH + 1], keep="\n\t")
    return shown if len(shown) <= _PARAGRAPH else f"{shown[: _PARAGRAPH - 1]}…"


def as_label(text: str) -> str:
    r"""Return a name as part of a text in a figure, where matplotlib takes $…$ for a formula.

    A legend leaves out labels that begin with an underscore, so that one gets a space before it.

    Examples
    --------
    >>> print(as_label(r"$\frac$"), as_label("_a"))
    \$\frac\$  _a
    """
    name = brief(text, _LABEL).replace("$", r"\$")
    return f" {name}" if name.startswith("_") else name


# --- LaTeX --------------------------------------------------------------------------------------

# LaTeX's special characters, and the characters beyond ASCII in our texts.
_LATEX = {
    "\\": r"\textbackslash{}",
    **{mark: f"\\{mark}" for mark in "&%$#_{}"},
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\ensuremath{<}",
    ">": r"\ensuremath{>}",
    "|": r"\ensuremath{|}",
    **{
        letter: rf"\ensuremath{{\{name}}}"
        for letter, name in {
            **{"α": "alpha", "β": "beta", "δ": "delta", "Δ": "Delta", "ε": "varepsilon"},
            **{"κ": "kappa", "Λ": "Lambda", "λ": "lambda", "μ": "mu", "ν": "nu", "π": "pi"},
            **{"σ": "sigma", "φ": "varphi", "χ": "chi", "θ": "theta", "τ": "tau", "Σ": "Sigma"},
            **{"ω": "omega", "·": "cdot", "×": "times", "≤": "leq", "≥": "geq", "∞": "infty"},
            **{"≈": "approx", "→": "to", "±": "pm", "′": "prime", "√": "surd", "∝": "propto"},
        }.items()
    },
    "µ": r"\ensuremath{\mu}",
    "−": r"\ensuremath{-}",
    "°": r"\ensuremath{^\circ}",
    "…": r"\dots{}",
    "–": "--",
    "—": "---",
    "\u2009": r"\,",
    **{
        raised: rf"\ensuremath{{^{{{plain}}}}}"
        for raised, plain in zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻ⁿ⁺", (*"0123456789-n+",), strict=True)
    },
    **{
        lowered: rf"\ensuremath{{_{{{plain}}}}}"
        for lowered, plain in zip("₀₁₂₃₄₅₆₇₈₉₋ₙᵢⱼ", (*"0123456789-nij",), strict=True)
    },
}


def latex(text: str) -> str:
    r"""Escape a text for LaTeX.

    No part of it acts as a command or ends a paragraph; characters that are not listed stay as
    they are, in UTF-8.

    Examples
    --------
    >>> print(latex("ΔR_i < 50 % of R², {x}"))
    \ensuremath{\Delta}R\_i \ensuremath{<} 50 \% of R\ensuremath{^{2}}, \{x\}
    """
    # Two hyphens make no dash, and a cell that begins with [ or * is no option of the row above.
    parts = re.split("(?<=-)(?=-)", visible(" ".join(text.split("\n"))))
    escaped = "{}".join("".join(_LATEX.get(mark, mark) for mark in part) for part in parts)
    return f"{{{escaped[0]}}}{escaped[1:]}" if escaped.startswith(("[", "*")) else escaped


# --- Markdown -----------------------------------------------------------------------------------

_MATH = re.compile(r"\\ensuremath\{(.*)\}")
_MARKDOWN = {
    mark: f"${found[1]}$"
    for mark, text in _LATEX.items()
    if not mark.isascii() and (found := _MATH.fullmatch(text))
}


def markdown(text: str) -> str:
    r"""Escape a text for pandoc's Markdown, from which LaTeX and Typst are made.

    No part of it acts as markup or ends a paragraph. Greek letters and signs become formulas, which
    every font of a journal has.

    Examples
    --------
    >>> print(markdown("ΔR_i < 50 % of *R*²"))
    $\Delta$R\_i \< 50 \% of \*R\*$^{2}$
    """
    shown = visible(" ".join(text.split("\n"))).strip(" ")
    parts = re.split(r"(−[0-9]+(?:\.[0-9]+)?)", shown)  # a line does not break in a negative number
    escaped = "".join(
        f"$-{part[1:]}$" if place % 2 else "".join(map(_in_markdown, part))
        for place, part in enumerate(parts)
    )
    # Before a digit, a dollar sign does not end a formula.
    return re.sub(r"(?<=[^ ]\$)[0-9]", lambda digit: f"&#{ord(digit[0])};", escaped)


def _in_markdown(mark: str) -> str:
    """Return one character for pandoc's Markdown."""
    return _MARKDOWN.get(mark, f"\\{mark}" if mark in punctuation else mark)


# --- CSV ----------------------------------------------------------------------------------------

_FORMULA = re.compile(r"'*[=+\-@\t\r]")


def csv_text(table: pd.DataFrame, **settings: Any) -> str:
    r"""Return a table as CSV that a spreadsheet shows and does not compute.

    A spreadsheet takes a cell that begins with =, +, -, @, a tab or a carriage return for a
    formula, which may call other programs. Such a text gets an apostrophe before it, and one more
    if it has some already, so that `from_csv` gives back every text exactly. Numbers stay as they
    are, in columns of numbers and in texts.

    Parameters
    ----------
    table : DataFrame
        The table, written without its index.
    **settings
        Of `DataFrame.to_csv`.

    Examples
    --------
    >>> import pandas as pd
    >>> print(csv_text(pd.DataFrame({"group": ["=1+1", "-0.3", "a"], "mm": [-1.0, 2.0, 3.0]})))
    group,mm
    '=1+1,-1.0
    -0.3,2.0
    a,3.0
    <BLANKLINE>
    """
    guarded: dict[Any, list[Any]] = {
        name: [f"'{cell}" if _is_formula(cell) else cell for cell in column]
        for name, column in table.items()
        if any(map(_is_formula, column))
    }
    text: str = table.assign(**guarded).to_csv(index=False, lineterminator="\n", **settings)
    return text


def from_csv(cell: str) -> str:
    """Return the text of a cell that `csv_text` wrote.

    Examples
    --------
    >>> from_csv("'=1+1"), from_csv("'tis")
    ('=1+1', "'tis")
    """
    return cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell


def _is_formula(cell: object) -> bool:
    """Return whether a spreadsheet would compute a text that is no number."""
    if not isinstance(cell, str) or not _FORMULA.match(cell):
        return False
    try:
        float(cell)
    except ValueError:
        return True
    return cell[0] in "\t\r"


# --- source code and files ----------------------------------------------------------------------

# The words that cannot name a class, a module, a function or a file of functions in C++, Python
# or MATLAB. Fortran has none.
_WORDS = """
    alignas alignof and_eq asm auto bitand bitor bool case catch char class compl const constexpr
    const_cast decltype default delete do double dynamic_cast enum explicit export extern float
    friend goto inline int long mutable namespace new noexcept not_eq nullptr operator or_eq private
    protected public register reinterpret_cast short signed sizeof static static_assert static_cast
    struct switch template this thread_local throw true typedef typeid typename union unsigned using
    virtual void volatile wchar_t xor xor_eq false
    classdef elseif end function otherwise parfor persistent spmd
"""
RESERVED = frozenset([*kwlist, *_WORDS.split()])


def comment(text: str) -> str:
    """Return text that is safe in a comment of any language: one line of plain ASCII.

    Examples
    --------
    >>> comment("fit result 'ΔR */ #1'")
    "fit result '_R __ _1'"
    """
    return re.sub(r"[^\w '.,:;=()+-]", "_", brief(text, 2 * _NAME), flags=re.ASCII)


def identifier(name: str) -> str:
    """Return a name as the languages of exported joints take it.

    Examples
    --------
    >>> identifier("wrist pin"), identifier("class")
    ('wrist_pin', 'class_')
    """
    word = re.sub("[^A-Za-z0-9]+", "_", name).strip("_")
    return f"{word}_" if word in RESERVED else word


def file_name(text: str) -> str:
    """Return a text as a part of a file's name, in the same folder.

    Examples
    --------
    >>> file_name("titanium alloy"), file_name("../x")
    ('titanium-alloy', '..-x')
    """
    return re.sub(r"[^\w.+-]+", "-", text)
