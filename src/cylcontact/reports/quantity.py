"""Numbers with units, and symbols, as a manuscript prints them, in pandoc's Markdown."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal
from string import punctuation

import numpy as np

from cylcontact.errors import InputError
from cylcontact.plots.latex import LATEX

__all__ = ["FORMAT", "Quantity", "Symbol", "unit_text"]

# What may stand behind the colon of a placeholder.
FORMAT = re.compile(r"\+?\.[0-9]{1,2}[efg]|words")
# Numbers from here on, and below the inverse of this, are printed with a power of ten.
_LARGE, _SMALL = 10**6, Decimal("1e-4")
_WORDS = (
    *("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine"),
    *("ten", "eleven", "twelve"),
)
_SPACE = "\\ "  # between a number and its unit, where a line does not break
_FORMULA = re.compile(r"\\ensuremath\{(.*)\}")
_MARKDOWN = {
    mark: f"${match[1]}$"
    for mark, text in LATEX.items()
    if not mark.isascii() and (match := _FORMULA.fullmatch(text))
}


class Symbol(str):
    """A formula in LaTeX, without dollar signs, as a cell or a heading of a table.

    Give the table and its columns `dtype=object`, so that pandas keeps it.
    """

    __slots__ = ()


@dataclass(frozen=True)
class Quantity:
    r"""A number of a manuscript, or a range, with its unit.

    Parameters
    ----------
    value : float, int or tuple of float
        Integers are printed in full. Two numbers are the ends of a range.
    unit : str
        The unit, empty for a number without one.
    digits : int
        The significant digits to print, unless a placeholder has a format of its own.

    Raises
    ------
    InputError
        If the value is no finite number or range, or there are no digits to print.

    Examples
    --------
    >>> print(Quantity(0.96609, "mm").text(), Quantity((-2.04, 1.31), "%", digits=2).text())
    0.966\ mm $-2.0$ to 1.3\ \%
    >>> print(Quantity(3.1e-7).text(".2g"), Quantity(8).text("words"))
    $3.1 \times 10^{-7}$ eight
    """

    value: float | int | tuple[float, float]
    unit: str = ""
    digits: int = 3

    def __post_init__(self) -> None:
        ends = self.value if isinstance(self.value, tuple) else (self.value,)
        plain = [end.item() if isinstance(end, np.generic) else end for end in ends]
        is_range = isinstance(self.value, tuple)
        if len(plain) != 1 + is_range or not all(map(_is_finite, plain)):
            rule = "is neither a finite number nor the two ends of a range"
            raise InputError("Quantity", "value", self.value, rule, "give one")
        if not 1 <= self.digits <= 17:
            rule = "must be from 1 to 17"
            raise InputError("Quantity", "digits", self.digits, rule, "3 is the default")
        object.__setattr__(self, "value", tuple(plain) if is_range else plain[0])

    @property
    def ends(self) -> tuple[float, ...]:
        """The number, or the two ends of the range."""
        return self.value if isinstance(self.value, tuple) else (self.value,)

    def text(self, form: str = "") -> str:
        """Return it as Markdown.

        Parameters
        ----------
        form : str, optional
            A format of Python such as ".2g", "+.1f" or ".2e"; or "words" for a small integer.

        Raises
        ------
        ValueError
            If the format is none of these, or does not suit the number.
        """
        if form and not FORMAT.fullmatch(form):
            raise ValueError("is no format; write .3g, .1f, .2e or words")
        if form == "words":
            numbers = self._in_words()
        else:
            numbers = " to ".join(self._number(end, form) for end in self.ends)
        return f"{numbers}{unit_text(self.unit)}"

    def _in_words(self) -> str:
        """Return a small integer as a word, and a larger one in digits, as usual in print."""
        if not isinstance(self.value, int):
            raise ValueError("is no integer, so it has no word; leave out :words")
        return _WORDS[self.value] if 0 <= self.value < len(_WORDS) else _signed(str(self.value))

    def _number(self, number: float, form: str) -> str:
        """Return a number with a true minus sign and, where it needs one, a power of ten."""
        if isinstance(number, int) and not form:
            return _signed(str(number))
        plain = format(number, (form or f".{self.digits}g").replace(".", "#.", 1))
        shown = Decimal(plain)
        if not shown:
            return format(abs(shown), "f").rstrip(".")
        is_usual = _SMALL <= abs(shown) < _LARGE
        if form.endswith("e") or not (is_usual or form.endswith("f")):
            mantissa, _, exponent = format(shown, f".{_decimals(plain)}e").partition("e")
            factor = "" if mantissa == "1" else rf"{mantissa} \times "
            return rf"${factor}10^{{{int(exponent)}}}$"
        sign = "+" if plain.startswith("+") else ""
        return _signed(sign + format(shown, "f").rstrip("."))


def unit_text(unit: str) -> str:
    r"""Return a unit as it follows a number.

    Examples
    --------
    >>> print("1" + unit_text("mm^(1-n)"), "2" + unit_text("N/mm"), "3" + unit_text("°"))
    1\ mm$^{1-n}$ 2\ $\mathrm{N/mm}$ 3$^\circ$
    """
    if not unit:
        return ""
    parts = re.split(r"\^(?:\(([^(){}]*)\)|(-?\w+))", unit)
    texts = [
        _upright(part) if place % 3 == 0 else f"$^{{{part}}}$"
        for place, part in enumerate(parts)
        if part
    ]
    return ("" if unit.startswith("°") else _SPACE) + "".join(texts)


def _upright(unit: str) -> str:
    """Return a unit with an upright µ, and as a formula where a line could break at a slash."""
    if re.fullmatch("[A-Za-z]+/[A-Za-z]+", unit):
        return rf"$\mathrm{{{unit}}}$"
    return markdown(unit).replace(r"$\mu$", "µ")


def _signed(number: str) -> str:
    """Return a number with a minus sign in place of a hyphen."""
    return f"${number}$" if number.startswith("-") else number


def _is_finite(number: object) -> bool:
    """Return whether this is an integer or a finite number."""
    return type(number) is int or (type(number) is float and math.isfinite(number))


def _decimals(number: str) -> int:
    """Return how many digits a number in text has behind the first significant one."""
    digits = number.partition("e")[0].replace(".", "").lstrip("+-0")
    return max(len(digits) - 1, 0)


def markdown(text: str) -> str:
    r"""Escape a text for pandoc's Markdown, from which LaTeX and Typst are made.

    No part of it acts as markup or ends a paragraph. Greek letters and signs become formulas, which
    every font of a journal has.

    Examples
    --------
    >>> print(markdown("ΔR_i < 50 % of *R*²"))
    $\Delta$R\_i \< 50 \% of \*R\*$^{2}$
    """
    # A line does not break in a negative number.
    parts = re.split(r"(−[0-9]+(?:\.[0-9]+)?)", " ".join(text.split("\n")).strip(" "))
    escaped = "".join(
        f"$-{part[1:]}$" if index % 2 else "".join(map(_in_markdown, part))
        for index, part in enumerate(parts)
    )
    # Before a digit, a dollar sign does not end a formula.
    return re.sub(r"(?<=[^ ]\$)[0-9]", lambda digit: f"&#{ord(digit[0])};", escaped)


def _in_markdown(mark: str) -> str:
    """Return one character for pandoc's Markdown."""
    return _MARKDOWN.get(mark, f"\\{mark}" if mark in punctuation else mark)
