"""Write docs/figures.md and docs/claims.md from what `make docs` has drawn and computed."""

from pathlib import Path

import pandas as pd

DOCS = Path(__file__).parent


def figures():
    """Return a page of all figures, each above the command that draws it."""
    parts = ["# Figures\n"]
    for text in sorted((DOCS / "figures").glob("*.txt")):
        name, caption = text.stem, text.read_text(encoding="utf-8").strip()
        parts.append(f"## {name}\n\n![{name}](figures/{name}.png)\n\n{caption}\n")
        parts.append(f"`cylcontact figure {name}`, [numbers](figures/{name}.csv)\n")
    return "\n".join(parts)


def claims(table):
    """Return a page of the paper's claims, by verdict."""
    parts = [
        "# What the paper claims\n",
        "Each claim is read in every way that its words allow; ✓ and ✗ say whether it holds so. "
        "`cylcontact claims` prints the same.\n",
    ]
    for verdict in ("holds", "depends on the reading", "does not hold"):
        rows = table[table["verdict"] == verdict]
        by_claim = rows.groupby(["section", "claim", "printed", "quotation"], sort=False)
        parts.append(f"## {verdict.capitalize()} ({by_claim.ngroups})\n")
        for (section, claim, printed, quotation), readings in by_claim:
            parts.append(f"**{section}** {claim} ({printed}) “{quotation}”\n")
            signs = {True: "✓", False: "✗"}
            parts += [f"- {signs[r.holds]} {r.reading}: {r.ours}" for r in readings.itertuples()]
            parts.append("")
    return "\n".join(parts)


if __name__ == "__main__":
    (DOCS / "figures.md").write_text(figures(), encoding="utf-8")
    table = pd.read_csv(DOCS.parent / "reports" / "claims.csv", dtype=str)
    table["holds"] = table["holds"] == "True"
    (DOCS / "claims.md").write_text(claims(table), encoding="utf-8")
