"""Tables as testing machines, spreadsheets and programs write them, all of one known truth."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl

import cylcontact as cc
from tests.support.noisy_series import PAIR

LENGTH = 20.0
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


def workbook(path: Path, sheets: dict[str, list[list[Any]]]) -> Path:
    """Write sheets of rows as a workbook."""
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, cells in sheets.items():
        sheet = book.create_sheet(title)
        for row in cells:
            sheet.append(row)
    book.save(path)
    return path


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
        Form("extensometer beside the crosshead", "Time,Extension,Displacement (Strain 1),Strain 1,"
             "Load\n(sec),(mm),(mm),(mm/mm),(N)\n" + rows(t, w * 1.2, w, w / 50, F),
             said="penetration from 'Displacement (Strain 1)'; --columns penetration=Extension"),
        Form("nested brackets", "Load(8800 (0,1):Load) (kN);Position(8800 (0,1):Position) (µm)\n"
             + rows(F / 1e3, w * 1e3, **semi), said="in kN"),
        Form("six lines of header", "Column title,Date,Time,1,2\nData name,,,Force,Displacement\n"
             "Comment,,,Cell 1,LVDT 2\nType,,,FLOAT,FLOAT\nUnit,,,N,mm\n"
             + rows([""] * ROWS, ["2024-03-05"] * ROWS, clocks, F, w),
             said="lines 1, 3, 4 before the rows; units from line 5"),
        Form("exponents behind a space", "Force (N),Travel (mm)\n"
             + rows(F, [f"{x * 1e3:.9f} E-03" for x in w])),
        Form("times ten to the power", "Force (N);Travel (m)\n"
             + rows(F, [f"{x * 1e3:.9f}×10-6".replace(".", ",") for x in w], **semi)),
        Form("Fortran", "Force (N),Travel (mm)\n"
             + rows(F, [f"{x:.9e}".replace("e", "D") for x in w])),
        Form("units in cells", "Force,Travel\n" + rows([f"{number(a)} N" for a in F],
             [f"{number(x * 1e3)}µm" for x in w]), said="units from the cells of 'Force' and"),
        Form("two units in cells", "Force;Travel\n" + rows([f"{number(a)} N" if a < 1e3 else
             f"{number(a / 1e3)} kN" for a in F], [f"{number(x)} mm" for x in w], separator=";")),
        Form("a date and a line above", "Test 1\nDate,Force [N],Travel [mm]\n"
             + rows(["2024-03-05"] * ROWS, F, w), said="line 1 before the rows"),
        Form("two rows of dates", "Machine XY, load cell 25 kN, cert. 7\nDatum;Kraft [N];Weg [mm]\n"
             + rows(["05.03.2024"] * ROWS, F, w, **semi), said="separated by semicolons"),
        Form("numbers of specimens", "Test 1 of 2\nSpecimen,Force [N],Travel [mm]\n"
             + rows(["12-1"] * ROWS, F, w), {"group": "Specimen"}, "group from 'Specimen'"),
        Form("spaces beside exponents", "Kraft_[N]  Weg_[mm]\n"
             + "".join(f"{a:.9e}  {x:.9e}\n".replace(".", ",") for a, x in zip(F, w, strict=True)),
             said="separated by spaces; marked by commas"),
        Form("powers of ten", "Force 10^3 N,Displacement 10^-3 mm\n" + rows(F / 1e3, w * 1e3),
             said="load from 'Force 10^3 N' in 1000 N; in 0.001 mm"),
        Form("powers of ten below", "Force;Weg\n10³ N;[10⁻³ mm]\n" + rows(F / 1e3, w * 1e3, **semi),
             said="in 1000 N"),
        Form("a factor that is not clear", "Force (x10) [N],Weg [mm]\n" + rows(F / 10, w),
             {"columns": {"load [10 N]": "Force (x10) [N]"}}, "in 10 N"),
        Form("blocks", "Data Header:,Time: 0.5 Sec\nForce,Travel\nN,mm\n" + rows(F[:4], w[:4])
             + "Data Header:,Time: 1.5 Sec\nForce,Travel\nN,mm\n" + rows(F[4:], w[4:]),
             {"group": "block"}, "lines 8 to 10 between blocks; 2 blocks; group from 'block'"),
        Form("thousands of Windows", "Kraft [N];Weg [mm]\n"
             + rows([f"{a:,.1f}".translate({44: 0xA0, 46: 44}) for a in F], w, **semi),
             {"decimal": ","}, "text in Windows-1252", "cp1252"),
        Form("Cyrillic", "Время (с),Сила (Н),Перемещение (мм)\n" + rows(t, F, w),
             {"encoding": "cp1251", "columns": {"load": "Сила (Н)", "penetration": "3"}},
             "text in cp1251", "cp1251"),
        Form("Chinese", "力 (N),位移 (mm)\n" + rows(F, w),
             {"encoding": "gbk", "columns": {"load": "1", "penetration": "2"}}, "gbk", "gbk"),
        Form("a separator by name", "F [N]|w [mm]\n" + rows(F, w, separator="|"),
             {"separator": "bar"}, "separated by bars"),
        Form("a row excluded", "F [N],w [mm]\n" + rows(F, w) + "9e3,0.5\n",
             {"exclude": (f"{ROWS + 2}",)}, f"1 row excluded (line {ROWS + 2})"),
        Form("UTF-16", "δ [µm]\tF [N]\n" + rows(w * 1e3, F, **tabs), encoding="utf-16"),
    ]  # fmt: skip
