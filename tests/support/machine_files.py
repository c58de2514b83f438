"""Tables as testing machines, spreadsheets and programs write them, all of one known truth."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from hypothesis import strategies as st

import cylcontact as cc
from cylcontact.support.arrays import FloatArray

LENGTH = 20.0
PAIR = cc.CylinderPair.internal(
    R_i=10.0, R_j=9.97, material=cc.Material("steel", E=207e3, nu=0.3), length=LENGTH
)
OPTIONS = ("--contact", "internal", "--E", "207 GPa", "--nu", 0.3, "--Ri", 10, "--Rj", 9.97)
LOAD = np.array([64.0, 150.5, 310.0, 720.0, 1250.0, 2400.0, 4100.0, 7300.0, 11800.0])
DEPTH = cc.laws.Explicit().penetration(LOAD / LENGTH, PAIR)
ROWS = len(LOAD)

# Values in N and mm by definition: the pound is 0.45359237 kg, the inch 25.4 mm, g 9.80665 m/s².
POUND = 0.45359237 * 9.80665
FORCE_UNITS = {
    **{"N": 1.0, "kN": 1e3, "MN": 1e6, "mN": 1e-3, "µN": 1e-6, "nN": 1e-9, "daN": 10.0},
    **{"kgf": 9.80665, "lbf": POUND, "kip": 1e3 * POUND},
}
LENGTH_UNITS = {
    **{"m": 1e3, "cm": 10.0, "mm": 1.0, "µm": 1e-3, "nm": 1e-6, "in": 25.4, "mil": 0.0254}
}


def number(value: float, mark: str = ".") -> str:
    """Return a number with 12 digits."""
    return f"{value:.12g}".replace(".", mark)


def rows(
    *columns: Sequence[object],
    separator: str = ",",
    mark: str = ".",
    quote: str = "",
) -> str:
    """Return columns as lines of text."""
    cells = (
        [c if isinstance(c, str) else number(float(c), mark) for c in row]  # type: ignore[arg-type]
        for row in zip(*columns, strict=True)
    )
    return "".join(separator.join(f"{quote}{c}{quote}" for c in row) + "\n" for row in cells)


@dataclass(frozen=True)
class Form:
    """A file, the keys that it needs to be read, and words of what is said of it."""

    name: str
    content: str
    keys: dict[str, Any] = field(default_factory=dict)
    said: str = ""
    encoding: str = "utf-8"


def forms() -> list[Form]:
    """Return the truth in the forms of machines and programs, as they come."""
    F, w, t = LOAD, DEPTH, np.arange(ROWS) / 4
    preamble = '"Width",6.02,"mm"\n"Load cell",""\n"Speed",1,"mm/min"\n'
    block = "Results Table 1\nMaximum load,Extension,Area\n(N),(mm),(mm^2)\n9000,0.01,5\n\n"
    lvm = (
        "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\n***End_of_Header***\t\n\t\n"
        "Channels\t2\t\t\nY_Unit_Label\tN\tmm\t\nX0\t0,0E+0\t0,0E+0\t\n***End_of_Header***\t\t\t\n"
    )
    semi: dict[str, Any] = {"separator": ";", "mark": ","}
    tabs: dict[str, Any] = {"separator": "\t"}
    clocks = [f"10:00:{k:02d}" for k in range(ROWS)]
    german = "Prüfprotokoll;Prüfer;XY\nKraft;Weg\nkN;µm\n"
    return [
        Form("preamble", f'{preamble}"Time","Standard force","Standard travel"\n"s","N","mm"\n'
             + rows(t, F, w), said="lines 1 to 3 before the rows; units from line 5"),
        Form("preamble, cp1252", german + rows(F / 1e3, w * 1e3, **semi), encoding="cp1252",
             said="line 1 before; units from line 3; text in Windows-1252; marked by commas"),
        Form("results above", f"{block}Time,Displacement,Force\n(s),(mm),(N)\n" + rows(t, w, F),
             {"header": 6}, "lines 1 to 4 before the rows; time from 'Time' in s"),
        Form("acquisition", "Data Acquisition: Timed\tTime: 5.2 Sec\nAxial Displacement\tAxial "
             "Force\tRunning Time\nmm\tkN\tSec\n" + rows(w, F / 1e3, t, **tabs), said="line 1"),
        Form("LabVIEW", f"{lvm}X_Value\tForce (N)\tLVDT (mm)\tComment\n"
             + rows(["0,0"] * ROWS, F, w, separator="\t", mark=","),
             {"columns": {"penetration": "LVDT (mm)"}}, "lines 1 to 4, 6 to 9 before the rows"),
        Form("capitals", "KRAFT [KN];WEG [MM]\n" + rows(F / 1e3, w, **semi)),
        Form("DIN", "F / kN;s / µm\n" + rows(F / 1e3, w * 1e3, **semi)),
        Form("French", "Charge (daN),Déplacement (cm)\n" + rows(F / 10, w / 10)),
        Form("Italian", "Prova n. 12;2021;\nForza [N];Spostamento [mm];\n"
             + rows(F, w, [""] * ROWS, **semi), encoding="cp1252"),
        Form("Spanish", "Fuerza (kgf)\tDesplazamiento (mm)\n" + rows(F / 9.80665, w, **tabs)),
        Form("inches", 'Load (lbf);Displacement (")\n' + rows(F / POUND, w / 25.4, separator=";")),
        Form("per inch", "Line load (lbf/in),Depth (mil)\n"
             + rows(F / LENGTH / POUND * 25.4, w / 0.0254)),
        Form("spelt", "load_micro_N,penetration_nm\n" + rows(F * 1e6, w * 1e6)),
        Form("units above", "N,mm\nForce,Extension\n" + rows(F, w), said="units from line 1"),
        Form("channels", "Force,Displacement\nChannel A,Channel B\nkN,µm\n"
             + rows(F / 1e3, w * 1e3), said="line 2 before the rows; units from line 3"),
        Form("savetxt", "# load_N penetration_mm\n" + rows(F, w, separator=" ")),
        Form("savetxt, two heads", "# rig 3, run 7\n# Force [N]\tTravel [mm]\n"
             + rows(F, w, **tabs), said="line 1 before the rows"),
        Form("fixed width", "      Force    Extension\n       [N]       [mm]\n"
             + "".join(f"{a:12.3f} {b:18.12f}\n" for a, b in zip(F, w, strict=True))),
        Form("bars", "| load_N | penetration_mm |\n|---|---|\n"
             + "".join(f"| {number(a)} | {number(b)} |\n" for a, b in zip(F, w, strict=True))),
        Form("index", ",load_N,penetration_mm\n" + rows(list(map(str, range(ROWS))), F, w)),
        Form("quoted", '\ufeffsep=;\n"Force [N]";"Travel [mm]"\n'
             + rows(F, w, quote='"', **semi)),
        Form("no names", rows(F, w), {"columns": {"load_N": "1", "penetration_mm": "2"}},
             f"lines 1 to {ROWS}: load from 'column 1' in N"),
        Form("no names below a title", "Test 5\n" + rows(F, w, separator="\t", mark=","),
             {"columns": {"load_N": "1", "penetration_mm": "2"}}, "line 1 before the rows"),
        Form("specimens with #", "Specimen;Force [N];Travel [mm]\n"
             + rows(["A", "#2", "#3"] * 3, F, w, **semi), {"group": "Specimen"}, "group from"),
        Form("only specimens with #", "Probe,Force [N],Travel [mm]\n"
             + rows(["#1", "#2", "#3"] * 3, F, w), {"group": "Probe"}),
        Form("a row commented out", "load_N,penetration_mm\n" + rows(F[:5], w[:5])
             + "#5000,0.5\n# a note, and another\n" + rows(F[5:], w[5:]),
             said="lines 7, 8 with # in front"),
        Form("a specimen commented out", "Specimen,load_N,penetration_mm\n"
             + rows(["A"] * ROWS, F, w) + "#A,5000,0.5\n", {"group": "Specimen"}, "with #"),
        Form("many settings", "".join(f"Setting {k};{k},5\n" for k in range(40))
             + "Kraft [N];Weg [mm]\n" + rows(F, w, **semi), said="lines 1 to 40 before the rows"),
        Form("clock", "Zeit;Kraft [N];Weg [mm]\n" + rows(clocks, F, w, **semi), said="time from"),
        Form("dates", "Time,Force [N],Displacement [mm]\n"
             + rows([f"2024-01-01T{each}.25" for each in clocks], F, w), said="time from"),
        Form("a time lacks", "Time [s],Force [N],Displacement [mm]\n"
             + rows(["" if k == 4 else str(k) for k in range(ROWS)], F, w), said="the time (line"),
        Form("odd columns", "weight,E (J),length,Load (V),Load (N),Stroke (mm),Extension (mm),"
             "w (mm)\n" + rows(*[F * 3] * 4, F, w * 9, w, w * 2),
             said="penetration from 'Extension (mm)'; 'E (J)', whose unit is not known; 'w (mm)'"),
        Form("compression negative", "Load (N),Extension (mm)\n" + rows(-F, -w),
             said="sign of the load turned; sign of the penetration turned"),
        Form("travel negative", "Load (N),Crosshead (mm)\n" + rows(F, -w),
             said="sign of the penetration turned, as it falls"),
        Form("baseline", "Load (N),Extension (mm)\n0.3,0\n-0.2,0.00001\n" + rows(F, w),
             {"loads": "5:"}, "2 rows with loads below 5 N (lines 2, 3)"),
        Form("break", "Force (N),Stroke (mm)\n" + rows(F, w)
             + "".join(f"{3000 - k},{0.05 + k / 1e4:.4f}\n" for k in range(2 * ROWS))
             + "-1.2,0.5\n0.4,0.6\n",
             {"loads": "5:", "branch": "loading"}, "rows of unloading (--branch loading)"),
        Form("thousands", "Kraft [N];Weg [mm]\n"
             + rows([f"{a:,.1f}".translate(str.maketrans(",.", ".,")) for a in F], w, **semi),
             {"decimal": ","}),
        Form("longer series beside", "F [N];s [mm];Mean\n" + rows(F, w, [1.5] * ROWS, **semi)
             + ";;2,5\n;;3,5\n", said="2 rows empty in these columns (lines 11, 12)"),
        Form("footer", "Force [N],Displ. [mm]\n" + rows(F, w) + "End of test\n***,\n",
             said=f"lines {ROWS + 2}, {ROWS + 3} below the rows"),
        Form("old Mac", ("Force [N]\tTravel [mm]\n" + rows(F, w, **tabs)).replace("\n", "\r")),
        Form("UTF-16", "δ [µm]\tF [N]\n" + rows(w * 1e3, F, **tabs), encoding="utf-16"),
    ]  # fmt: skip


# --- layouts at random --------------------------------------------------------------------------

_PREAMBLES = (
    "", "Prüfprotokoll\n", "Test 3\n\nOperator{s}NN\n", "# rig 3\n# a{s}b{s}c\n", "sep={s}\n",
    "Date{s}2021-05-03\nSpeed{s}1{d}5{s}mm/min\nSample{s}A\n", "Force and travel of pins; zeroed\n",
    '"Width"{s}6{d}02{s}"mm"\n"Load cell"{s}""\n"Speed"{s}1{s}"mm/min"\n',
    "Results Table 1\n{s}Max load{s}E\n1{s}5{s}6{s}7{s}8\n",
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
_OTHERS: tuple[tuple[str, Callable[[int], list[Any]]], ...] = (
    ("Nr.", lambda n: [str(k + 1) for k in range(n)]),
    ("Time (s)", lambda n: [k / 8 for k in range(n)]),
    ("Clock", lambda n: [f"00:0{k % 6}:{k:02d}" for k in range(n)]),
    ("Specimen", lambda n: (["#1", "#2", "A", "B"] * n)[:n]),
    ("Note", lambda n: (["ok", "", "bad"] * n)[:n]),
    ("Temperature [°C]", lambda n: [20.5] * n),
    ("E (J)", lambda n: [0.25 * k for k in range(n)]),
    ("weight", lambda n: [1.5] * n),
)


@dataclass(frozen=True)
class Layout:
    """A file of random layout, what marks its decimals, and its loads in N and depths in mm."""

    content: bytes
    mark: str
    load: FloatArray
    penetration: FloatArray


@st.composite
def layouts(draw: st.DrawFn, separator: str) -> Layout:
    """Return layouts of a separator: marks, preambles, units, order, comments, encodings."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    mark = "." if separator == "," else draw(st.sampled_from(".,"))
    thousands = draw(st.sampled_from([*[""] * 8, " ", "'", ".", ","]))
    thousands = "" if thousands in (mark, separator) else thousands
    count, digits = draw(st.integers(2, 13)), draw(st.integers(1, 5))
    load = np.round(np.sort(10 ** rng.uniform(-1, 4, count)), digits)
    depth = np.round(np.sort(10 ** rng.uniform(-2, 2, count)), digits)
    force, unit = draw(st.sampled_from([*FORCE_UNITS])), draw(st.sampled_from([*LENGTH_UNITS]))
    columns: list[tuple[str, Sequence[Any]]] = [
        (draw(st.sampled_from(_LOADS)).format(u=force), load.tolist()),
        (draw(st.sampled_from(_DEPTHS)).format(u=unit), depth.tolist()),
    ]
    others = draw(st.lists(st.sampled_from(_OTHERS), max_size=3, unique_by=lambda x: x[0]))
    columns = draw(st.permutations([*columns, *((name, cells(count)) for name, cells in others)]))
    is_quoted = separator == "," or draw(st.booleans())

    def cell(value: object, of_data: bool = True) -> str:
        if isinstance(value, float):
            text = f"{value:,.{digits}f}".replace(",", "\0").replace(".", mark)
            text = text.replace("\0", thousands)
        else:
            text = str(value)
        if separator == " ":
            return (text if of_data else text.replace(" ", "_").replace(",", "")) or "-"
        return f'"{text}"' if is_quoted else text

    names, _, units = zip(*(name.partition("|") for name, _ in columns), strict=True)
    head = "# " if draw(st.booleans()) and not is_quoted else ""
    lines = [head + separator.join(cell(name, False) for name in names)]
    if any(units):
        lines.append(separator.join(cell(each, False) for each in units))
    body = [separator.join(cell(c[k]) for _, c in columns) for k in range(count)]
    for text in draw(st.lists(st.sampled_from(["# a comment", "", "# 1 of 2"]), max_size=2)):
        body.insert(draw(st.integers(0, len(body))), text)
    preamble = draw(st.sampled_from(_PREAMBLES)).format(s=separator, d=mark)
    text = preamble + "\n".join([*lines, *body]) + draw(st.sampled_from(["", "\n", "\n\n"]))
    text = text.replace("\n", draw(st.sampled_from(["\n", "\r\n"])))
    encoding = draw(st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "cp1252"]))
    try:
        content = text.encode(encoding)
    except UnicodeEncodeError:  # a δ
        content = text.encode()
    return Layout(content, mark, load * FORCE_UNITS[force], depth * LENGTH_UNITS[unit])
