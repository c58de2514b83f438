"""Compare with numbers of others, and write the page: python -m benchmarks.references [FILE]."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from cylcontact import CylinderPair, InputError, Material, limits
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.laws.conformal.series import enough_terms, glauert

ROOT = Path(__file__).resolve().parents[1]
FOLDER, PAGE = ROOT / "datasets" / "references", ROOT / "docs" / "checked-against.md"
HEAD = """# Checked against

Numbers of others beside those of the program, from `datasets/references`. A dash is where no
outside number could be read. `make references` writes this page.
"""
NAMES = {
    "hertz_stress": "peak pressure",
    "hertz_half_width": "half-width",
    "penetration": "penetration",
    "contact_angle": "half of the contact's angle",
    "peak_pressure": "peak pressure",
    "pressure_on_axis": "pressure on the line of the load",
}


def read(path: Path) -> dict[str, Any]:
    """Return a reference; raise `InputError` if something is left empty."""
    about = tomllib.loads(path.read_text(encoding="utf-8"))
    for key in ("title", "citation", "geometry", "licence", "shows", "values"):
        if not about.get(key):
            raise InputError(str(path), key, None, "is empty", "fill it in from the source")
    for key, number in about["pair"].items():
        if number == 0:
            raise InputError(str(path), key, number, "is empty", "fill it in from the source")
    return about


def pair_of(given: dict[str, Any]) -> CylinderPair:
    """Return the pair of a reference."""
    one, other = (Material(body, given[f"E_{body}"], given["nu"]) for body in "ij")
    if given["contact"] == "external":
        return CylinderPair.external(given["R_i"], given["R_j"], one, material_j=other)
    R_i, dR = given["R_i"], given["dR"]
    return CylinderPair("internal", dR, one, other, R_i=R_i, R_j=R_i - dR)


def housing_of(given: dict[str, Any]) -> Housing | None:
    """Return the housing of a hole, None if none is given."""
    if "compliances" in given:
        return Housing.from_compliances(FOLDER / given["compliances"])
    clamp = Sector(given["clamp_far"], "far") if "clamp_far" in given else "rim"
    return Housing(given["R_o"], clamp) if "R_o" in given else None


def ours(quantity: str, load: float, given: dict[str, Any]) -> float:
    """Return the program's number of a quantity under a load in N/mm."""
    pair = pair_of(given)
    if quantity.startswith("hertz"):
        return float(getattr(limits, quantity)(load, pair))
    housing = housing_of(given)
    law = Conformal(housing or "johnson")
    if quantity == "pressure_on_axis":
        b = np.tan(np.radians(np.atleast_1d(law.contact_angle(load, pair))) / 2)
        g = housing.kernels(pair)[1][0].g if housing else None
        peak = glauert(b, float(pair.beta), enough_terms(float(b[0])), g).peak[0]
        return load / given["R_i"] * float(peak)
    number = float(getattr(law, quantity)(load, pair))
    return 1e3 * number if quantity == "penetration" else number


def compared(files: Iterable[Path]) -> list[tuple[dict[str, Any], list[tuple[Any, float, float]]]]:
    """Return each reference with its values, our number, and the difference in percent."""
    found = []
    for path in files:
        about, rows = read(path), []
        for value in about["values"]:
            load = value.get("load", about["pair"].get("load"))
            mine = ours(value["quantity"], load, about["pair"])
            rows.append((value, mine, 100 * (mine / value.get("theirs", np.nan) - 1)))
        found.append((about, rows))
    return found


def page(files: Iterable[Path]) -> str:
    """Return the page in Markdown."""
    parts = [HEAD]
    for about, rows in compared(files):
        lines = ["| quantity | theirs | ours | difference |", "|---|---|---|---|"]
        for value, mine, off in rows:
            what = NAMES[value["quantity"]]
            what += f" at {value['load']:.6g} N/mm" if "load" in value else ""
            what += f", {value['note']}" if "note" in value else ""
            theirs = f"{value['theirs']:.6g} {value['unit']}" if "theirs" in value else "—"
            mine_too = f"{mine:.6g}" if "theirs" in value else f"{mine:.6g} {value['unit']}"
            difference = f"{off:+.2f} %" if "theirs" in value else "—"
            lines.append(f"| {what} | {theirs} | {mine_too} | {difference} |")
        where = f"Geometry: {about['geometry']}; {about['licence']}."
        text = f"{about['citation']}.\n\n{where}\n\n{about['shows']}"
        parts.append(f"## {about['title']}\n\n{text}\n\n" + "\n".join(lines) + "\n")
    return "\n".join(parts)


def main(arguments: list[str]) -> int:
    """Print the comparison of the files named, or write the page of all; return the exit code."""
    try:
        if arguments:
            print(page(map(Path, arguments)))
        else:
            PAGE.write_text(page(sorted(FOLDER.glob("*.toml"))), encoding="utf-8")
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
