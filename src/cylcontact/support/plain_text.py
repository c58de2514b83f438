"""Names, labels and messages as plain text, for each place where text is put out."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from keyword import kwlist
from textwrap import fill
from unicodedata import category

# The most characters of a name within a sentence or a cell, and in a figure.
_NAME, _LABEL = 100, 60
# The width of reports: a block of the pages shows 90 columns in a window of 1366 pixels.
WIDTH = 88


# Whether a command prints, so that advice names options, not arguments of Python.
_IN_SHELL = ContextVar("in_shell", default=False)
# Options in advice, and the same in Python.
_IN_PYTHON: list[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]]] = [
    (re.compile(pattern), python)
    for pattern, python in (
        (r"--(free|noise|group|sign|branch|loads|decimal|sheet) ([^\s,;)]+)", r'\1="\2"'),
        (r"--drift\b", "drift=True"),
        (r"--load-error 1%", "load_error=0.01"),
        (r"--fix (\w+)=([\w.+-]+)", r'fixed={"\1": \2}'),
        (r"--runs (\d+)", r"runs=\1"),
        (r"`cylcontact choose`", "`cylcontact.choose`"),
        (r"--exclude ([^\s;)]+)", lambda found: f"exclude={found[1].split(',')}"),
        (r"--bound (\w+)=([\w.+-]+):([\w.+-]+)", r'bounds={"\1": (\2, \3)}'),
        (r"--([a-z][a-z-]+)", lambda found: found[1].replace("-", "_")),  # any other, by its name
    )
]


@contextmanager
def in_shell() -> Iterator[None]:
    """Keep the options of the command line in what the block prints."""
    token = _IN_SHELL.set(True)
    try:
        yield
    finally:
        _IN_SHELL.reset(token)


def advice(text: str) -> str:
    """Return a sentence with its options as arguments of Python, unless a command prints it.

    Examples
    --------
    >>> advice("allow for it with --group COLUMN, or --fix n=1.1")
    'allow for it with group="COLUMN", or fixed={"n": 1.1}'
    >>> advice("give it by --uncertain, or --bound n=1:1.5")
    'give it by uncertain, or bounds={"n": (1, 1.5)}'
    """
    if not _IN_SHELL.get():
        for option, argument in _IN_PYTHON:
            text = option.sub(argument, text)
    return text


def item(sentence: str, mark: str = "- ", width: int = WIDTH) -> str:
    """Return a sentence as an item of a list, wrapped, its options in the words of the reader."""
    return fill(advice(sentence), width, initial_indent=mark, subsequent_indent="  ")


def visible(text: str, keep: str = "") -> str:
    r"""Escape invisible characters except those to `keep`: they may act on a terminal.

    Examples
    --------
    >>> print(visible("a\x1b[2Jb\u202ec\nd ΔR"))
    a\x1b[2Jb\u202ec\nd ΔR
    """
    return "".join(
        c if c.isprintable() or c in keep or category(c) == "Zs" else repr(c)[1:-1] for c in text
    )


def brief(text: str, most: int = _NAME) -> str:
    """Return a text for a sentence or a cell: visible, and cut if it is long.

    Examples
    --------
    >>> brief("x" * 1000, 9)
    'xxxxxxxx…'
    """
    cleaned = visible(text[: most + 1])
    return cleaned if len(cleaned) <= most else f"{cleaned[: most - 1]}…"


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
