"""Tables of random layout, of one known truth, and what their reader offers, pasted."""

import re
import shlex
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

from cylcontact import InputError
from cylcontact.datasets.measurements import read_measured
from cylcontact.datasets.reading import TableSpec
from cylcontact.files.units import unit_of
from cylcontact.support.arrays import FloatArray
from tests.support.machine_files import FORCE_UNITS, LENGTH, LENGTH_UNITS

CONSTANTS = {"E_GPa": 207.0, "nu": 0.3, "R_i_mm": 10.0, "R_j_mm": 9.97, "length_mm": LENGTH}
SEPARATORS = (",", ";", "\t", "|", " ")
KINDS = ("plain", "factors", "brackets", "dates")

_PREAMBLES = (
    "", "Prüfprotokoll\n", "Test 3\n\nOperator{s}NN\n", "# rig 3\n# a{s}b{s}c\n", "sep={s}\n",
    "Date{s}2021-05-03\nSpeed{s}1{d}5{s}mm/min\nSample{s}A\n", "Force and travel of pins; zeroed\n",
    '"Width"{s}6{d}02{s}"mm"\n"Load cell"{s}""\n"Speed"{s}1{s}"mm/min"\n',
    "Results Table 1\n{s}Max load{s}E\n1{s}5{s}6{s}7{s}8\n",
)  # fmt: skip
_LINES_ABOVE = (
    "", "Test 1\n", "Test 1 2 3 4\n", "Machine XY, load cell 25 kN, cert. 7\n",
    "Run 12-1; 3.5.2024\n", "05.03.2024 10:00\n", "2024-03-05\n\nTest 12\n",
)  # fmt: skip
# Names; a unit behind | is in a row below them.
_LOADS = (
    "load_{u}", "F [{u}]", "Standard force|{u}", "Kraft in {u}", "Axial Force ({u})", "Force / {u}",
    "Load [{u}]", "Charge|[{u}]", "Fuerza ({u})", "FORZA|({u})",
)  # fmt: skip
_DEPTHS = (
    "penetration_{u}", "Weg [{u}]", "Standard travel|{u}", "Crosshead|({u})", "Extension ({u})",
    "δ / {u}", "Depth, {u}", "Course ({u})", "corsa|[{u}]",
)  # fmt: skip
_FORCES, _TRAVELS = ("Force", "Load", "Kraft"), ("Displacement", "Weg", "Depth")
# Of a power of ten it is clear what it multiplies, of other factors it is not: then the number in a
# cell was multiplied, or is to be; of a bare number it may also be the range of the instrument.
_CLEAR = (
    "{w} 10^{n} {u}", "{w} [10^{n} {u}]", "{w} / 10^{n} {u}", "{w}_1e{n}_{u}", "{w}|10^{n} {u}",
    "{w} (10^{n}·{u})", "{w}, 1e{n} {u}",
)  # fmt: skip
_UNCLEAR = (
    "{w} x{m} [{u}]", "{w} (x{m}) [{u}]", "{w}_x{m}_{u}", "{w} [x{m} {u}]", "{w} ({u}) x{m}",
    "{w} ({u}/{m})", "{w} ·10^{n} [{u}]", "x{m} {w} [{u}]", "{w} (x{m})|{u}", "Kanal A x{m} [{u}]",
    "Kanal A {m} {u}", "{w} {m} {u}", "{w} [{m} {u}]", "{w} ×10^{n} / {u}",
)  # fmt: skip
_BRACKETED = (
    "{w} (filtered) [{u}]", "{w} (Strain 1)|({u})", "{w}(8800 (0,1):{w}) ({u})", "{w} [{u}] (mean)",
    "{w} (LVDT 2) / {u}", "{w} (channel 3)|{u}", "{w} (1) [{u}]", "{w} (avg)|[{u}]",
    "{w} (sensor no. 12) ({u})",
)  # fmt: skip
_Cells = Callable[[int], list[Any]]
_OTHERS: tuple[tuple[str, _Cells], ...] = (
    ("Nr.", lambda n: [str(k + 1) for k in range(n)]),
    ("Time (s)", lambda n: [k / 8 for k in range(n)]),
    ("Clock", lambda n: [f"00:0{k % 6}:{k:02d}" for k in range(n)]),
    ("Specimen", lambda n: (["#1", "#2", "A", "B"] * n)[:n]),
    ("Note", lambda n: (["ok", "", "bad"] * n)[:n]),
    ("Temperature [°C]", lambda n: [20.5] * n),
    ("E (J)", lambda n: [0.25 * k for k in range(n)]),
    ("weight", lambda n: [1.5] * n),
)
_DATES: tuple[tuple[str, _Cells], ...] = (
    ("Date", lambda n: ["2024-03-05"] * n),
    ("Datum", lambda n: ["05.03.2024"] * n),
    ("Day", lambda n: ["3/5/2024"] * n),
    ("Stamp", lambda n: [f"2024-03-05 10:00:{k:02d}" for k in range(n)]),
    ("Zeitpunkt", lambda n: [f"05.03.2024 10:{k:02d}" for k in range(n)]),
    ("Specimen", lambda n: ["12-1"] * n),
    ("Probe", lambda n: [f"{k + 1}-{k % 3}" for k in range(n)]),
    ("Serial", lambda n: ["2024.117.3"] * n),
)
# Beside the readings: what a machine was told, or the travel of its crosshead.
_BESIDE: tuple[tuple[str, _Cells], ...] = (
    ("Force (target) [N]", lambda n: [7.5 * k for k in range(n)]),
    ("Crosshead position [mm]", lambda n: [0.5 * k for k in range(n)]),
    ("Strain 1 (mm/mm)", lambda n: [0.001 * k for k in range(n)]),
)


@dataclass(frozen=True)
class Layout:
    """A file of random layout, what marks its decimals, and its loads in N and depths in mm.

    `names` are those of the columns of load and penetration, and `keys` say what these are.
    """

    content: bytes
    mark: str
    load: FloatArray
    penetration: FloatArray
    names: Mapping[str, str]
    keys: Mapping[str, str]


def _with_factor(draw: st.DrawFn, word: str, unit: str) -> tuple[str, float]:
    """Return a name with a factor, and the multiple of its unit that a cell of 1 is."""
    power = draw(st.sampled_from([-6, -3, -2, 1, 2, 3, 6]))
    if draw(st.booleans()):
        return draw(st.sampled_from(_CLEAR)).format(w=word, u=unit, n=power), 10.0**power
    form, factor = draw(st.sampled_from(_UNCLEAR)), 10 ** abs(power)
    bare = re.search(r"(^| |\[)\{m\} \{u\}", form) is not None
    factors = [float(factor), 1.0] if bare else [float(factor), 1 / factor]
    if "{n}" in form:
        factors = [10.0**power, 10.0**-power]
    return form.format(w=word, u=unit, m=factor, n=power), draw(st.sampled_from(factors))


@dataclass(frozen=True)
class _Style:
    """How cells are written."""

    separator: str
    mark: str
    thousands: str
    digits: int  # behind the mark, or of a number with an exponent
    has_exponent: bool
    is_quoted: bool

    def rounded(self, values: FloatArray) -> FloatArray:
        """Return numbers as they can be written."""
        if self.has_exponent:
            return np.array([float(f"{value:.5e}") for value in values])
        return np.round(values, self.digits)

    def cell(self, value: object, of_data: bool = True) -> str:
        """Return a number, a name or a word as the file has it."""
        text = str(value)
        if isinstance(value, float) and self.has_exponent:
            text = f"{value:.5e}".replace(".", self.mark)
        elif isinstance(value, float):
            text = f"{value:,.{self.digits}f}".replace(",", "\0").replace(".", self.mark)
            text = text.replace("\0", self.thousands)
        if self.separator != " ":
            return f'"{text}"' if self.is_quoted or self.separator in text else text
        if of_data and re.match(r"\d[^ ]*[-.]\d.* \d+:", text):  # a date and a time
            return f'"{text}"'
        return (text if of_data else text.replace(" ", "_").replace(",", "")) or "-"

    def line(self, cells: Iterable[object], of_data: bool = True) -> str:
        """Return cells as a line."""
        return self.separator.join(self.cell(each, of_data) for each in cells)


@st.composite
def _styles(draw: st.DrawFn, separator: str, kind: str) -> _Style:
    mark = "." if separator == "," else draw(st.sampled_from(".,"))
    thousands = draw(st.sampled_from([*[""] * 8, " ", "'", ".", ",", "\u00a0"]))
    return _Style(
        separator,
        mark,
        "" if thousands in (mark, separator) else thousands,
        draw(st.integers(1, 5)),
        kind == "dates" and draw(st.booleans()),
        draw(st.booleans()),
    )


def _name(draw: st.DrawFn, kind: str, quantity: str, unit: str) -> tuple[str, float]:
    """Return a name for a column, with the multiple of its unit that a cell of 1 is."""
    is_load = quantity == "load"
    word = draw(st.sampled_from(_FORCES if is_load else _TRAVELS))
    if kind == "factors":
        return _with_factor(draw, word, unit)
    forms = _BRACKETED if kind == "brackets" else _LOADS if is_load else _DEPTHS
    return draw(st.sampled_from(forms)).format(w=word, u=unit), 1.0


def _text(draw: st.DrawFn, kind: str, style: _Style, columns: list[tuple[str, list[Any]]]) -> str:
    """Return the lines of a table, with lines above and comments between."""
    names, _, below = zip(*(name.partition("|") for name, _ in columns), strict=True)
    head = "# " if draw(st.booleans()) and not style.is_quoted else ""
    lines = [head + style.line(names, False)]
    lines += [style.line(below, False)] if any(below) else []
    body = [style.line(row) for row in zip(*(cells for _, cells in columns), strict=True)]
    for text in draw(st.lists(st.sampled_from(["# a comment", "", "# 1 of 2"]), max_size=2)):
        body.insert(draw(st.integers(0, len(body))), text)
    above = draw(st.sampled_from(_LINES_ABOVE if kind == "dates" else _PREAMBLES))
    text = above.format(s=style.separator, d=style.mark) + "\n".join([*lines, *body])
    text += draw(st.sampled_from(["", "\n", "\n\n"]))
    return text.replace("\n", draw(st.sampled_from(["\n", "\r\n"])))


@st.composite
def layouts(draw: st.DrawFn, separator: str, kind: str) -> Layout:
    """Return layouts of a separator: marks, lines above, units, order, comments, encodings.

    Factors are in names, words in brackets in names, dates and numbers of specimens in cells.
    """
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    style, count = draw(_styles(separator, kind)), draw(st.integers(2, 13))
    columns: list[tuple[str, list[Any]]] = []
    values, names, keys = [], {}, {}
    for quantity, known, ends in (
        ("load", FORCE_UNITS, (-1, 4)),
        ("penetration", LENGTH_UNITS, (-2, 2)),
    ):
        unit, cells = draw(st.sampled_from([*known])), np.sort(10 ** rng.uniform(*ends, count))
        (name, times), cells = _name(draw, kind, quantity, unit), style.rounded(cells)
        columns.append((name, cells.tolist()))
        values.append(cells * times * known[unit])
        names[quantity] = name.partition("|")[0].replace(" ", "_" if separator == " " else " ")
        spelt = unit_of(unit)
        keys[quantity] = f"{quantity} [{times:.12g} {spelt}]"
        keys[quantity] = f"{quantity}_{spelt}" if times == 1 else keys[quantity]
    further = {"dates": _DATES, "brackets": _OTHERS + _BESIDE}.get(kind, _OTHERS)
    beside = st.lists(
        st.sampled_from(further), min_size=kind == "dates", max_size=3, unique_by=lambda x: x[0]
    )
    columns += [(name, cells(count)) for name, cells in draw(beside)]
    text = _text(draw, kind, style, draw(st.permutations(columns)))
    try:
        content = text.encode(draw(st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "cp1252"])))
    except UnicodeEncodeError:  # a δ
        content = text.encode()
    return Layout(content, style.mark, *values, names, keys)


# A word of a shell.
_WORD = r"""(?:[^\s'";,]|'[^']*'|"[^"]*")+"""
_OFFERED = re.compile(rf"--(columns|ignore|decimal|separator|encoding|header) ({_WORD})")


def read_with_remedies(path: Path, layout: Layout) -> tuple[Any, list[str]]:
    """Return what is read of a layout, None if it is refused for good, and the remedies pasted.

    The user knows what the columns of load and penetration are, and what a cell of 1 is.
    """
    given: dict[str, Any] = {}
    pasted: list[str] = []
    for _ in range(6):
        try:
            return read_measured(path, "internal", CONSTANTS, spec=TableSpec(**given)), pasted
        except InputError as error:
            before, message = len(pasted), str(error)
        for name, word in _OFFERED.findall(message):
            (value,) = shlex.split(word)
            if f"--{name} {value}" in pasted or (name != "columns" and name in given):
                continue
            if name == "columns":
                new, columns = _column_pasted(message, value, layout), given.setdefault(name, {})
                if {*new.values()} <= {*columns.values()}:
                    continue
                columns |= new
            elif name in ("decimal", "separator", "header"):
                given[name] = {"decimal": layout.mark}.get(name, value)
                given |= {name: int(value)} if name == "header" else {}
            else:
                continue
            pasted.append(f"--{name} {value}")
            if name in ("separator", "header"):
                break
        if len(pasted) == before:
            break
    return None, pasted


def _column_pasted(message: str, value: str, layout: Layout) -> dict[str, str]:
    """Return what a user makes of an offered --columns, whose choices must hold the truth."""
    key, _, column = value.partition("=")
    quantity = re.split(r"[_ ]", key)[0]
    if quantity not in layout.keys:
        return {}
    truth = {layout.keys[quantity]: layout.names[quantity]}
    if column != layout.names[quantity] or key.endswith("_UNIT"):
        return truth
    if "if it is" in message:
        ((wanted, _),) = truth.items()
        offered = message.replace("'", "").replace("µ", "u")
        assert f"{wanted}={column}".replace("µ", "u") in offered, message
        return truth
    return {key: column}
