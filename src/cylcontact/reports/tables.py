"""Coefficients, claims and captions as LaTeX, CSV or HTML, for a manuscript."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from html import escape
from pathlib import Path

import pandas as pd

from cylcontact.errors import InputError
from cylcontact.files import replacing_all, require_apart, require_writable
from cylcontact.plots.latex import latex
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import chosen_recipes, draw
from cylcontact.reports.claims import ledger
from cylcontact.reports.claims_text import to_table

__all__ = ["KINDS", "write_tables"]


def write_tables(bench: Bench, names: Sequence[str], kind: str, folder: Path) -> list[Path]:
    r"""Write coefficients, claims and the figures' captions.

    Parameters
    ----------
    bench : Bench
        The bench with recipes, fits and materials.
    names : sequence of str
        The figures whose captions to write; empty for all of them.
    kind : {"latex", "csv", "html"}
        As `longtable` and `\caption` to input, as CSV, or as HTML fragments.
    folder : path
        Where to write.

    Returns
    -------
    list of path
        The files; on an error none is written.

    Raises
    ------
    InputError
        If the kind or a figure is unknown, or a result or the table of materials is wrong.

    Examples
    --------
    >>> write_tables(Bench(Path()), [], "word", Path("tables"))
    Traceback (most recent call last):
    cylcontact.errors.InputError: report: --tables = 'word': is unknown; choose latex, csv, html
    """
    if kind not in KINDS:
        rule, remedy = "is unknown", f"choose {', '.join(KINDS)}"
        raise InputError("report", "--tables", kind, rule, remedy)
    ending, table, captions = KINDS[kind]
    chosen = chosen_recipes(bench, names)
    files = ("coefficients", "claims", *captions(dict.fromkeys(chosen, "")))
    paths = [folder / f"{name}.{ending}" for name in files]
    require_writable(*paths)
    require_apart(paths, bench.inputs)
    caption_of = {name: draw(name, bench).caption for name in chosen}
    texts = {
        "coefficients": table(_coefficients_table(bench)),
        "claims": table(_claims_table(bench)),
    } | captions(caption_of)
    with replacing_all(paths) as temporaries:
        for temporary, text in zip(temporaries, texts.values(), strict=True):
            temporary.write_text(text, encoding="utf-8")
    return paths


def _coefficients_table(bench: Bench) -> pd.DataFrame:
    """Return a row for each coefficient of each fit, beside the published value."""
    rows = [
        {
            "fit": result.name,
            "law": result.law,
            "contact": result.contact,
            "reference": result.reference,
            "coefficient": name,
            "fitted": f"{value:.5g}",
            "published": f"{result.published.coefficients[name]:g}" if result.published else "",
        }
        for result in bench.results_by_name().values()
        for name, value in result.coefficients.items()
    ]
    columns = ["fit", "law", "contact", "reference", "coefficient", "fitted", "published"]
    return pd.DataFrame(rows, columns=columns)


def _claims_table(bench: Bench) -> pd.DataFrame:
    """Return a row for each claim: section, statement, the paper's value, ours, the verdict."""
    columns = ["section", "statement", "paper", "ours", "verdict"]
    return to_table(ledger(bench)).reindex(columns=columns)


def _latex_table(table: pd.DataFrame) -> str:
    """Return a table for the packages longtable and booktabs, long texts in wide columns."""
    widest = {name: int(table[name].map(len).max()) if len(table) else 0 for name in table}
    long = [name for name, length in widest.items() if length > 30]
    share = 0.7 / max(1, len(long))
    columns = "".join(
        rf"p{{{share:.2f}\linewidth}}" if name in long else "l" for name in table.columns
    )
    styled = table.map(latex).rename(columns=latex).style.hide(axis="index")
    text = styled.to_latex(column_format=columns, hrules=True).replace("{tabular}", "{longtable}")
    head, rule, body = text.partition("\\midrule\n")
    return "".join(["% needs \\usepackage{booktabs,longtable}\n", head, rule, "\\endhead\n", body])


def _csv_table(table: pd.DataFrame) -> str:
    """Return a table as CSV."""
    return table.to_csv(index=False, lineterminator="\n")


def _html_table(table: pd.DataFrame) -> str:
    """Return a table as an HTML fragment, all texts escaped."""
    return table.to_html(index=False, border=0, escape=True) + "\n"


def _latex_captions(captions: Mapping[str, str]) -> dict[str, str]:
    r"""Return a file for each figure that holds its \caption."""
    return {
        f"{name}-caption": f"\\caption{{{latex(text)}}}\n\\label{{fig:{name}}}\n"
        for name, text in captions.items()
    }


def _html_captions(captions: Mapping[str, str]) -> dict[str, str]:
    """Return one file with all captions."""
    lines = (
        f'<figcaption id="{escape(name)}">{escape(text)}</figcaption>'
        for name, text in captions.items()
    )
    return {"captions": "\n".join(lines) + "\n"}


def _csv_captions(captions: Mapping[str, str]) -> dict[str, str]:
    """Return one file with all captions."""
    return {
        "captions": _csv_table(
            pd.DataFrame({"figure": list(captions), "caption": list(captions.values())})
        )
    }


Kind = tuple[str, Callable[[pd.DataFrame], str], Callable[[Mapping[str, str]], dict[str, str]]]
# For each kind: the files' ending, and the functions that write a table and the captions.
KINDS: Mapping[str, Kind] = {
    "latex": ("tex", _latex_table, _latex_captions),
    "csv": ("csv", _csv_table, _csv_captions),
    "html": ("html", _html_table, _html_captions),
}
