"""HTML tables with which a notebook shows materials, pairs, laws and results."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import asdict, fields, is_dataclass
from typing import Any

import numpy as np

from cylcontact.plain_text import html

__all__ = ["completed_law_html", "law_html", "table_html"]

# An array of more numbers than this is shown as a range.
_MOST_NUMBERS = 4


def table_html(title: str, rows: Mapping[str, object]) -> str:
    """Return an HTML table with a title, names on the left and values on the right.

    Parameters
    ----------
    title : str
        The caption.
    rows : mapping of str to object
        Values by name. Numbers are shown with six digits, longer arrays as a range, and None as
        a dash.

    Returns
    -------
    str
        An HTML fragment with all texts escaped.

    Examples
    --------
    >>> print(table_html("a < b", {"E (MPa)": 207e3}))
    <table><caption style="text-align:left;white-space:nowrap"><b>a &lt; b</b></caption><tbody>
    <tr><th style="text-align:left">E (MPa)</th><td>207000</td></tr>
    </tbody></table>
    """
    lines = "\n".join(
        f'<tr><th style="text-align:left">{html(name)}</th><td>{html(_cell(value))}</td></tr>'
        for name, value in rows.items()
    )
    style = "text-align:left;white-space:nowrap"
    caption = f'<caption style="{style}"><b>{html(title)}</b></caption>'
    return f"<table>{caption}<tbody>\n{lines}\n</tbody></table>"


def law_html(law: Any) -> str:
    """Return an HTML table of a law: the first line of its docstring and its coefficients.

    Parameters
    ----------
    law : ContactLaw
        A dataclass with a docstring.

    Returns
    -------
    str
        An HTML fragment.

    Examples
    --------
    >>> from cylcontact import laws
    >>> "Johnson&#x27;s law, Eq 1" in law_html(laws.Johnson())
    True
    """
    return completed_law_html(law, {})


def completed_law_html(law: Any, defaults: Mapping[Any, Any]) -> str:
    """Return an HTML table of a law, with `defaults` by contact for coefficients that are None."""
    units: Mapping[str, str] = getattr(law, "units", {})
    rows: dict[str, object] = {}
    for field in fields(law):
        value = getattr(law, field.name)
        if value is None:
            for contact, coefficients in defaults.items():
                named = _with_units(asdict(coefficients), units)
                rows |= {f"{contact}: {name}": number for name, number in named.items()}
        elif is_dataclass(value) and not isinstance(value, type):
            rows |= _with_units(asdict(value), units)
        else:
            rows |= _with_units({field.name: value}, units)
    summary = (inspect.getdoc(law) or law.name).splitlines()[0]
    return table_html(f"{type(law).__name__}: {summary}", rows)


def _with_units(values: Mapping[str, object], units: Mapping[str, str]) -> dict[str, object]:
    """Return values by name and unit."""
    return {
        f"{name} ({units[name]})" if units.get(name) else name: value
        for name, value in values.items()
    }


def _cell(value: object) -> str:
    """Return the text of a table cell."""
    if value is None:
        return "–"
    if isinstance(value, str) or is_dataclass(value):
        return str(value)
    numbers = np.asarray(value)
    if numbers.dtype.kind not in "fiu":
        return str(value)
    if numbers.size > _MOST_NUMBERS:
        return f"{numbers.min():.6g} to {numbers.max():.6g} ({numbers.size} values)"
    return ", ".join(f"{number:.6g}" for number in numbers.ravel())
