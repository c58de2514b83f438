"""Compare with numbers of others, and write the page: python -m benchmarks.references."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from cylcontact import CylinderPair, Material, limits
from cylcontact.laws import Johnson

ROOT = Path(__file__).resolve().parents[1]
FOLDER, PAGE = ROOT / "datasets" / "references", ROOT / "docs" / "checked-against.md"
HEAD = """# Checked against

Numbers of others beside those of the program, from `datasets/references`.
`make references` writes this page.
"""


def ours(key: str, pair: dict[str, Any]) -> float:
    """Return the program's number of a quantity."""
    one, other = (Material(body, pair[f"E_{body}"], pair["nu"]) for body in "ij")
    if pair["contact"] == "raceways":
        roller, load = pair["R_roller"], float(key.removeprefix("at_"))
        inner = CylinderPair.external(pair["R_inner"], roller, one)
        outer = CylinderPair.internal(pair["R_outer"], roller, one)
        return 1e3 * sum(float(Johnson().penetration(load, each)) for each in (inner, outer))
    cylinders = CylinderPair.external(pair["R_i"], pair["R_j"], one, material_j=other)
    of = limits.hertz_half_width if key == "hertz_half_width" else limits.hertz_stress
    return float(of(pair["load"], cylinders))


def compared() -> list[tuple[dict[str, Any], list[tuple[dict[str, Any], float, float]]]]:
    """Return each reference with its quantities, our number, and the difference in percent."""
    found = []
    for path in sorted(FOLDER.glob("*.toml")):
        about = tomllib.loads(path.read_text(encoding="utf-8"))
        rows = []
        for key, value in about["values"].items():
            mine = ours(key, about["pair"])
            rows.append((value, mine, 100 * (mine / value["theirs"] - 1)))
        found.append((about, rows))
    return found


def page() -> str:
    """Return the page in Markdown."""
    parts = [HEAD]
    for about, rows in compared():
        lines = ["| quantity | theirs | ours | difference |", "|---|---|---|---|"]
        lines += [
            f"| {of['what']} | {of['theirs']:.6g} {of['unit']} | {mine:.6g} | {off:+.2f} % |"
            for of, mine, off in rows
        ]
        where = f"Geometry: {about['geometry']}; {about['licence']}."
        text = f"{about['citation']}.\n\n{where}\n\n{about['shows']}"
        parts.append(f"## {about['title']}\n\n{text}\n\n" + "\n".join(lines) + "\n")
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
