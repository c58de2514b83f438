"""The tables with which a notebook shows materials, pairs, laws and results."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import asdict, fields, is_dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from cylcontact.support.text_tables import Table

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
    return Table(["", ""], cells, title)._repr_html_()


def law_html(law: Any, defaults: Mapping[Any, Any] = MappingProxyType({})) -> str:
    """Return an HTML table of a law: the first line of its docstring and its coefficients.

    Of coefficients that are None it shows the `defaults` by contact.
    """
    units: Mapping[str, str] = getattr(law, "units", {})
    values: dict[str, tuple[str, object]] = {}
    for field in fields(law):
        value = getattr(law, field.name)
        if value is None:
            for contact, coefficients in defaults.items():
                named = asdict(coefficients).items()
                values |= {f"{contact}: {name}": (name, number) for name, number in named}
        elif is_dataclass(value) and not isinstance(value, type):
            values |= {name: (name, number) for name, number in asdict(value).items()}
        else:
            values[field.name] = (field.name, value)
    rows = {
        f"{text} ({units[name]})" if units.get(name) else text: value
        for text, (name, value) in values.items()
    }
    summary = (inspect.getdoc(law) or law.name).splitlines()[0]
    return table_html(f"{type(law).__name__}: {summary}", rows)


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
