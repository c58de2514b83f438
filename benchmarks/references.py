"""Published benchmarks beside ours: python -m benchmarks.references [FILE ...] prints them."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from cylcontact import CylinderPair, InputError, Material, limits
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.laws.conformal.series import enough_terms, glauert

FOLDER = Path(__file__).resolve().parents[1] / "datasets" / "references"
NAMES = {
    "hertz_stress": "peak pressure",
    "hertz_half_width": "half-width",
    "contact_angle": "half contact angle",
    "pressure_on_axis": "pressure on the axis",
}


def read(path: Path) -> dict[str, Any]:
    """Return a reference; raise `InputError` if something is left empty."""
    about = tomllib.loads(path.read_text(encoding="utf-8"))
    needed = dict.fromkeys(("title", "citation", "geometry", "licence", "shows", "values"))
    for key, value in (needed | about | about["pair"]).items():
        if not value:
            number = value if isinstance(value, float) else None
            raise InputError(str(path), key, number, "is empty", "fill it in from the source")
    return about


def pair_of(given: dict[str, Any]) -> CylinderPair:
    """Return the pair of a reference."""
    one, other = (Material(body, given[f"E_{body}"], given["nu"]) for body in "ij")
    if given["contact"] == "external":
        return CylinderPair.external(given["R_i"], given["R_j"], one, material_j=other)
    R_i, dR = given["R_i"], given["dR"]
    return CylinderPair("internal", dR, one, other, R_i=R_i, R_j=R_i - dR)


def ours(quantity: str, load: float, given: dict[str, Any]) -> float:
    """Return our number of a quantity under a load in N/mm."""
    pair, housing = pair_of(given), None
    if quantity.startswith("hertz"):
        return float(getattr(limits, quantity)(load, pair))
    if "compliances" in given:
        housing = Housing.from_compliances(FOLDER / given["compliances"])
    elif "R_o" in given:
        clamp = Sector(given["clamp_far"], "far") if "clamp_far" in given else "rim"
        housing = Housing(given["R_o"], clamp)
    law = Conformal(housing or "johnson")
    if quantity == "pressure_on_axis":
        b = np.tan(np.radians(np.atleast_1d(law.contact_angle(load, pair))) / 2)
        g = housing.kernels(pair)[1][0].g if housing else None
        peak = glauert(b, float(pair.beta), enough_terms(float(b[0])), g).peak[0]
        return load / given["R_i"] * float(peak)
    number = float(getattr(law, quantity)(load, pair))
    return 1e3 * number if quantity == "penetration" else number


def compared(path: Path) -> tuple[dict[str, Any], list[tuple[dict[str, Any], float, float]]]:
    """Return a reference, and of each value our number and the difference in percent."""
    about, rows = read(path), []
    for value in about["values"]:
        load = value.get("load", about["pair"].get("load"))
        mine = ours(value["quantity"], load, about["pair"])
        rows.append((value, mine, 100 * (mine / value.get("theirs", np.nan) - 1)))
    return about, rows


def lines(files: Iterable[Path]) -> Iterator[str]:
    """Yield what the comparisons show, and their numbers, in Markdown."""
    every = [compared(path) for path in files]
    for about, _ in every:
        yield f"- **{about['title']}**: {about['citation']}. {about['shows']}"
    yield "\n| | quantity | theirs | ours | difference |\n|---|---|---:|---:|---:|"
    for about, rows in every:
        for value, mine, off in rows:
            what = NAMES.get(value["quantity"], value["quantity"].replace("_", " "))
            what += f" at {value['load']:.6g} N/mm" if "load" in value else ""
            what += f", {value['note']}" if "note" in value else ""
            numbers = f"— | {mine:.6g} | —"
            if "theirs" in value:
                numbers = f"{value['theirs']:.6g} | {mine:.6g} | {off:+.2f} %"
            title = about["title"] if value is rows[0][0] else ""
            yield f"| {title} | {what}, {value['unit']} | {numbers} |"


def main(arguments: list[str]) -> int:
    """Print the comparison of the files named, or of all; return the exit code."""
    try:
        print(
            "\n".join(lines(map(Path, arguments) if arguments else sorted(FOLDER.glob("*.toml"))))
        )
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
