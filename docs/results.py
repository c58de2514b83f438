"""Write docs/figures.md and docs/claims.md from what `make docs` has drawn and computed."""

import inspect
import re
from functools import partial
from pathlib import Path

import pandas as pd

from cylcontact.reports.figures import recipes

DOCS = Path(__file__).parent
ROOT = DOCS.parent
BELOW = "---\nsearch:\n  boost: 0.5\n---\n"  # the other pages come first in a search


def figures():
    """Return a page of all figures, each above its caption and its code."""
    functions = recipes(ROOT)
    parts = [
        f"{BELOW}# Figures\n",
        "The figures of the paper, and after them ours. The caption of a figure is the docstring "
        "of its function; helpers are beside it in the file.\n",
    ]
    for text in sorted((DOCS / "figures").glob("*.txt")):
        name, caption = text.stem, text.read_text(encoding="utf-8").strip()
        function = functions[name]
        function = function.func if isinstance(function, partial) else function
        file = Path(inspect.getfile(function)).name
        title = re.sub(r"^fig0?(\d+)$", r"Fig \1", name)
        code = inspect.getsource(function).replace("\n", "\n    ").rstrip()
        parts += [
            f"## {title}\n",
            f"![{name}](figures/{name}.png)\n",
            f"{escaped(caption)}\n",
            f"`cylcontact figure {name}`, [numbers](figures/{name}.csv)\n",
            f'??? note "Code, in reports/{file}"\n\n    ```python\n    {code}\n    ```\n',
        ]
    return "\n".join(parts)


def claims(table):
    """Return a page of the paper's claims, by verdict."""
    parts = [
        f"{BELOW}# What the paper claims\n",
        "Each claim with every interpretation that its words allow: ✓ it holds, ✗ it does not, "
        "○ the number is no evidence. `cylcontact claims` prints the same.\n",
    ]
    for verdict in ("holds", "depends on the interpretation", "does not hold"):
        chosen = table[table["verdict"] == verdict]
        by_claim = chosen.groupby(["section", "claim", "printed", "quotation"], sort=False)
        parts.append(f"## {verdict.capitalize()} ({by_claim.ngroups})\n")
        for (section, claim, printed, quotation), rows in by_claim:
            parts.append(f"**{escaped(claim)}** (Section {section})\n")
            parts.append(f"The paper: {escaped(printed)}; “{escaped(quotation)}”.\n")
            signs = {"True": "✓", "False": "✗", "": "○"}
            parts += [
                f"- {signs[row.holds]} {escaped(row.interpretation)}: {escaped(row.ours)}"
                for row in rows.itertuples()
            ]
            parts.append("")
    return "\n".join(parts)


def escaped(text):
    """Return a text with the signs that Markdown would take for its own."""
    return re.sub(r"([\\*_<`\[])", r"\\\1", text)


if __name__ == "__main__":
    (DOCS / "figures.md").write_text(figures(), encoding="utf-8")
    table = pd.read_csv(
        ROOT / "reports" / "claims.csv", dtype=str, keep_default_na=False, comment="#"
    )
    (DOCS / "claims.md").write_text(claims(table), encoding="utf-8")
