"""The tables with which a notebook shows materials, pairs, laws and results."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import Field, fields, is_dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from cylcontact.support.text_tables import TextTable

# An array of more numbers than this is shown as a range.
_MOST_NUMBERS = 4


def table_html(title: str, rows: Mapping[str, object]) -> str:
    """Return an HTML table with names on the left and values on the right.

    Examples
    --------
    >>> print(table_html("a < b", {"E (MPa)": 207e3}))
    <table><caption style="text-align:left;white-space:nowrap"><b>a &lt; b</b></caption><tbody>
    <tr><th style="text-align:left">E (MPa)</th><td>207000</td></tr>
    </tbody></table>
    """
    cells = [(name, _cell(value)) for name, value in rows.items()]
    return TextTable(["", ""], cells, title)._repr_html_()


def summary_of(law: Any) -> str:
    """Return what a law is on one line."""
    return getattr(law, "about", "") or (inspect.getdoc(law) or law.name).splitlines()[0]


def law_html(law: Any, defaults: Mapping[Any, Any] = MappingProxyType({})) -> str:
    """Return an HTML table of a law: its summary and its constants.

    Of coefficients that are None it shows the `defaults` by contact.
    """
    rows: dict[str, object] = {}
    for field in (each for each in fields(law) if each.repr and each.name != "name"):
        value = getattr(law, field.name)
        if value is None and defaults:
            for contact, coefficients in defaults.items():
                rows |= _numbers(coefficients, f"{contact}: ")
        elif is_dataclass(value) and not isinstance(value, type):
            rows |= _numbers(value)
        else:
            rows[_with_unit(field)] = value
    return table_html(f"{type(law).__name__}: {summary_of(law)}", rows)


def _numbers(values: Any, before: str = "") -> dict[str, object]:
    return {before + _with_unit(each): getattr(values, each.name) for each in fields(values)}


def _with_unit(field: Field[Any]) -> str:
    unit = field.metadata.get("unit")
    return f"{field.name} ({unit})" if unit else field.name


def _cell(value: object) -> str:
    """Return the text of a cell: numbers with six digits, longer arrays as a range."""
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
