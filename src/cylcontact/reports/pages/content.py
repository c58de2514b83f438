"""What the pages of the results say: the laws to use, the figures, the fits, the statements."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from html import escape
from pathlib import Path
from typing import Any

from cylcontact.bodies.pair import CONTACTS, Contact
from cylcontact.fitting.comparison import by_search, side_by_side
from cylcontact.fitting.results import FitResult
from cylcontact.laws.enhanced import InternalCoefficients
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import build, find_recipes
from cylcontact.reports.claims import ledger, withdrawn
from cylcontact.reports.claims_text import MEANINGS, grouped, to_records, what_stands
from cylcontact.reports.laws_to_use import error_text, laws_to_use
from cylcontact.reports.pages.figures import sections
from cylcontact.reports.paper import paper_of
from cylcontact.support.errors import InputError
from cylcontact.support.progress import Progress, silent

__all__ = ["FORMULAS", "Content", "answer", "collect"]

# Front matter that keeps a page out of the search.
UNINDEXED = "---\nsearch:\n  exclude: true\n---\n"
# A symbol of one letter with an index; Greek letters and powers may stand beside it.
SYMBOL = re.compile(r"(?<![A-Za-z0-9_])([^\W\d_])_([A-Za-z]+|\d)(?![A-Za-z0-9_])")
COEFFICIENTS = {each.name for each in fields(InternalCoefficients)}
BODIES: Mapping[Contact, str] = {"internal": "A pin in a hole", "external": "Two rollers"}
# What the laws are compared with, the better one first.
REFERENCES = {"conformal": "conformal contact", "johnson": "Johnson's law"}
# The formulas of `laws_to_use` as LaTeX; those of other laws are shown as text.
FORMULAS = {
    "explicit": r"f = \frac{\pi E^* \delta}{c + \ln\left(1 + \frac{A}{d} \left(c + \ln\left(1 + "
    r"\frac{A}{d} \ln\left(\frac{B}{d}\right)\right)\right)\right)}, \quad d = "
    r"\frac{\delta}{\Delta R}",
    "johnson": r"f = \frac{\pi E^* \delta}{-W_{-1}\left(-\frac{e \delta}{4 \Delta R}\right)}",
}


@dataclass(frozen=True)
class Content:
    """The pages as Markdown and the files beside them, by address, and what is missing."""

    pages: Mapping[str, str]
    files: Mapping[str, Path]
    missing: tuple[str, ...]


def collect(bench: Bench, home: str, progress: Progress = silent) -> Content:
    """Draw the figures, compute the statements, and fill the pages."""
    recipes, paper = find_recipes(bench), paper_of(bench)
    figures = build(bench, folder=bench.root / "build" / "figures", progress=progress)
    numbered, others = sections(figures, recipes, paper)
    drawn = [each.result for each in (*numbered, *others) if each.result]
    fits, broken = _fits(bench)
    statements = _statements(bench, progress)
    laws = [answer(contact, bench) for contact in CONTACTS] if paper.fits else []
    render = _renderer(paper=paper, home=home, numbered=numbered, others=others, **statements)
    main = [_table([fits[name]]) for name in paper.fits if name in fits]
    pages = {
        home: render("index", laws=laws, main=main),
        "figures.md": render("figures"),
        "fits.md": render("fits", tables=_tables(fits), broken=broken),
        "statements.md": render(
            "statements", meanings=MEANINGS, shown={each.name for each in drawn}
        ),
    }
    for file in {recipes[each.name] for each in drawn}:
        code = file.read_text(encoding="utf-8")
        pages[f"figures/{file.stem}.md"] = f"{UNINDEXED}# {file.name}\n\n```python\n{code}```\n"
    changes = bench.root / "CHANGELOG.md"
    if changes.is_file():  # a checkout's, whose links are those of its root
        pages["changes.md"] = changes.read_text(encoding="utf-8").replace("(docs/", "(")
    missing = [
        f"{each.name}: {each.problem}"
        for each in (*numbered, *others)
        if each.recipe and each.problem
    ]
    missing += [f"{name}: {reason}" for name, reason in broken.items()]
    missing += [f"laws: {law['problem']}" for law in laws if law["problem"]]
    missing += [f"claims: {statements['problem']}"] if statements["problem"] else []
    files = {f"figures/{path.name}": path for each in drawn for path in each.paths}
    return Content(pages, files, tuple(missing))


def _renderer(**common: Any) -> Callable[..., str]:
    """Return a function that fills a page's template; what is put in is escaped."""
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("cylcontact.reports.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["sub"] = lambda text: Markup(_subscripts(escape(text)))
    environment.filters["short"] = lambda number: f"{number:.6g}"
    environment.globals |= common

    def render(page: str, **content: Any) -> str:
        return environment.get_template(f"{page}.md.j2").render(**content)

    return render


def _subscripts(escaped: str) -> str:
    """Return HTML with the indices of symbols such as c_e and R_i as subscripts.

    The names of coefficients stay as the package has them.

    Examples
    --------
    >>> _subscripts("c_e = 0.9, πσ_Y²; dR_mm; Y_slope")
    'c<sub>e</sub> = 0.9, πσ<sub>Y</sub>²; dR_mm; Y_slope'
    """
    return SYMBOL.sub(
        lambda found: found[0] if found[0] in COEFFICIENTS else f"{found[1]}<sub>{found[2]}</sub>",
        escaped,
    )


def answer(contact: Contact, bench: Bench) -> dict[str, Any]:
    """Return the law to use for a contact beside its rivals, or the reason why none is named."""
    law: dict[str, Any] = {"contact": contact, "bodies": BODIES[contact], "problem": ""}
    try:
        table = laws_to_use(contact, bench)
    except InputError as error:
        return law | {"problem": str(error)}
    reference = next(name for name in REFERENCES if f"rms_{name}" in table)
    best = int(table[f"rms_{reference}"].argmin())
    rows = [
        {
            "law": each["law"],
            "rms": error_text(each[f"rms_{reference}"], ".4f"),
            "largest": error_text(each[f"max_{reference}_percent"], ".3g"),
            "time": f"{each['relative_time']:.1f}",
        }
        for each in table.to_dict("records")
    ]
    names = ("formula", "constants", "units", "defined", "calibrated")
    texts = {name: str(table.loc[best, name]) for name in names}
    latex = FORMULAS.get(rows[best]["law"])
    return law | texts | {
        "reference": REFERENCES[reference], "rows": rows, "best": rows[best], "latex": latex,
    }  # fmt: skip


def _fits(bench: Bench) -> tuple[dict[str, FitResult], dict[str, str]]:
    """Return the results that can be read, and the reasons why others cannot."""
    fits: dict[str, FitResult] = {}
    broken = {}
    for name in sorted(path.stem for path in bench.results_folder.glob("*.json")):
        try:
            fits[name] = bench.result(name)
        except InputError as error:
            broken[name] = str(error)
    return fits, broken


def _tables(fits: Mapping[str, FitResult]) -> list[dict[str, Any]]:
    """Return a table for each law, contact and search, those with most fits first."""
    groups = by_search(fits.values())
    return [_table(g) for g in sorted(groups, key=lambda g: (-len(g), g[0].law, g[0].contact))]


def _table(results: Sequence[FitResult]) -> dict[str, Any]:
    """Return fits of one law, contact and search side by side."""
    first, rows = results[0], side_by_side(results)
    alone = len(results) == 1
    rows.pop("published largest |Eq 9|, %", None)
    rows["commit"] = ["", *map(_commit, results), *([""] if alone else [])]
    kind = "recovered" if first.fixed or first.ties else "refit"
    return {
        "title": f"{first.law}, {first.contact} contact",
        "about": f"{kind}, {first.contact} contact",
        "columns": ["published", *(r.name for r in results), *(["difference, %"] if alone else [])],
        "notes": ["", *(f"to {r.reference}, {r.objective.name}" for r in results), ""],
        "rows": {
            name: [(cell or "–").replace(",", "\u2009") for cell in row]
            for name, row in rows.items()
        },
        "coefficients": len(first.coefficients),
        "verdicts": {r.name: r.verdicts for r in results if r.verdicts},
    }


def _commit(result: FitResult) -> str:
    """Return the start of a fit's commit, and whether files were modified."""
    name = str(result.provenance.get("git_commit") or "unknown")
    return f"{name[:10]}, modified" if name.endswith("-dirty") else name[:10]


def _statements(bench: Bench, progress: Progress) -> dict[str, Any]:
    """Return the paper's statements by verdict, or the reason why there are none."""
    try:
        claims, gone, problem = ledger(bench, progress), withdrawn(bench), ""
    except InputError as error:
        claims, gone, problem = [], {}, str(error)
    return {
        "groups": {group: to_records(members) for group, members in grouped(claims).items()},
        "stands": what_stands(claims) if claims else "",
        "withdrawn": gone,
        "problem": problem,
    }
