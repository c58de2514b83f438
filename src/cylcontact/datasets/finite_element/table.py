"""Tables of solved cases: CSV with a header that records their provenance.

The lines of the header begin with "# " and hold, as KEY: VALUE, the study, a hash of its set-up
file, the engine and its version, the calibrated constant, and a hash of the rows. A table edited by
hand does not match the hash and is refused. The first line is the version of this format.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cylcontact.errors import InputError
from cylcontact.files import replacing
from cylcontact.reading import marked, read_text, unmarked

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.datasets.finite_element.cases import Row
    from cylcontact.datasets.finite_element.spec import Study

__all__ = [
    "COLUMNS",
    "KEYS",
    "PIN_COLUMNS",
    "FiniteElementTable",
    "read_table",
    "require_same_inputs",
    "write_table",
]

COLUMNS = (
    *("variant", "E_GPa", "nu", "dR_mm", "load_N_per_mm", "penetration_mm", "half_width_mm"),
    *("peak_pressure_MPa", "hole_radius_mm", "outer_radius_mm", "cells"),
)
# After these, in tables of studies in which a pin has its own material.
PIN_COLUMNS = ("pin_E_GPa", "pin_nu")
# More digits than the error of either engine, fewer than the rounding of different processors.
_DIGITS = 7
KEYS = ("study", "set-up", "engine", "calibrated", "sha256")


@dataclass(frozen=True)
class FiniteElementTable:
    """A table of solved cases.

    Attributes
    ----------
    rows : pandas.DataFrame
        Columns `COLUMNS`, and `PIN_COLUMNS` if a pin has its own material.
    header : dict
        The lines of the header but the version, by the keys `KEYS`.
    """

    rows: pd.DataFrame
    header: dict[str, str]


def write_table(path: Path | str, study: Study, engine: str, rows: Sequence[Row]) -> None:
    """Write solved cases to a table; the file is complete or not written at all.

    Parameters
    ----------
    path : path
        A CSV file.
    study : Study
        The study.
    engine : str
        The engine and its version.
    rows : sequence of Row
        The solved cases.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    import pandas as pd

    frame = pd.DataFrame(map(_cells, rows), columns=(*COLUMNS, *PIN_COLUMNS))
    if not any(setup.pin_is_other for setup in study.setups.values()):
        frame = frame[list(COLUMNS)]
    body = frame.to_csv(index=False, float_format=f"%.{_DIGITS}g", lineterminator="\n")
    base = study.setups["base"]
    calibrated = (
        f"outer_radius_mm = {base.outer_radius:g} ({base.outer_ratio:g} hole radii, "
        f"{study.origin['outer_ratio']}); it sets the additive constant of the penetration"
    )
    values = (study.name, study.key, engine, calibrated, _hash(body))
    contents = marked(dict(zip(KEYS, values, strict=True)))
    header = "".join(f"# {key}: {value}\n" for key, value in contents.items())
    with replacing(path) as temporary:
        temporary.write_text(header + body, encoding="utf-8", newline="\n")


def read_table(path: Path | str) -> FiniteElementTable:
    """Read a table and check its hash.

    Raises
    ------
    InputError
        If the file cannot be read, is not such a table or one of a newer format, or does not match
        its hash.
    """
    import io

    import pandas as pd

    remedy = "make finite-element writes it"
    text = read_text(path, remedy, remedy)
    lines = text.splitlines(keepends=True)
    head = [line for line in lines if line.startswith("# ")]
    header = {key: value for key, _, value in (line[2:].rstrip().partition(": ") for line in head)}
    version: int | str = header.get("format", "1")
    with suppress(ValueError):
        version = int(version)
    header = unmarked({**header, "format": version}, str(path))
    body = "".join(lines[len(head) :])
    columns = tuple(body.partition("\n")[0].split(","))
    if tuple(header) != KEYS or columns not in (COLUMNS, (*COLUMNS, *PIN_COLUMNS)):
        raise InputError(
            str(path),
            "",
            None,
            "is not a table of finite elements",
            "name one that cylcontact finite-element has written",
        )
    if _hash(body) != header["sha256"]:
        raise InputError(
            str(path),
            "sha256",
            header["sha256"],
            f"does not match the rows, whose hash is {_hash(body)}: the table was edited by hand",
            "restore it, or make it anew with cylcontact finite-element",
        )
    return FiniteElementTable(pd.read_csv(io.StringIO(body)), header)


def require_same_inputs(path: Path, study: Study) -> None:
    """Raise `InputError` if a file is not a table of this study's set-up; it may be missing.

    Raises
    ------
    InputError
        If the file is a table of another set-up, or no readable table.
    """
    if not path.exists():
        return
    remedy = "write elsewhere with -o, or add --force to replace it"
    try:
        before = read_table(path).header
    except InputError as error:
        rule = "exists and is not a readable table of finite elements"
        raise InputError(str(path), "", None, rule, remedy) from error
    if before["set-up"] != study.key:
        rule = f"holds a table that came from another set-up, not from {study.source} as it is now"
        raise InputError(str(path), "set-up", before["set-up"], rule, remedy)


def _cells(row: Row) -> tuple[str | float, ...]:
    """Return one case in the order of `COLUMNS`."""
    setup, case = row.setup, row.case
    plate, pin = setup.material("plate"), setup.material("pin")
    return (
        *(row.variant, float(plate.E) / 1e3, setup.nu, case.dR, case.load, case.penetration),
        *(case.half_width, case.peak_pressure, setup.hole_radius, setup.outer_radius, case.cells),
        *(float(pin.E) / 1e3, float(pin.nu)),
    )


def _hash(body: str) -> str:
    """Return the hash of a table's rows."""
    return hashlib.sha256(body.encode()).hexdigest()[:16]
