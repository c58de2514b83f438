"""Build the report: draw every figure, collect fits and claims, write the pages."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from html import escape
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

from cylcontact.errors import InputError
from cylcontact.files import replacing, replacing_all, require_writable
from cylcontact.fitting.results import FitResult
from cylcontact.laws.enhanced import InternalCoefficients
from cylcontact.progress import Progress, silent
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import build, find_recipes
from cylcontact.reports.claims import Claim, ledger, withdrawn
from cylcontact.reports.claims_text import (
    MEANINGS,
    counts,
    described,
    grouped,
    what_stands,
)
from cylcontact.reports.html.answer import Answer, answers
from cylcontact.reports.html.campaigns import (
    Campaigns,
    headline,
    made_with,
    read_campaigns,
    tables,
)
from cylcontact.reports.html.claim_pages import ClaimPage, claim_pages
from cylcontact.reports.html.figures import Plate, describe, plates
from cylcontact.reports.paper import Paper, paper_of

__all__ = ["Site", "build_site"]

# A symbol of one letter with an index; Greek letters and powers may stand beside it.
SYMBOL = re.compile(r"(?<![A-Za-z0-9_])([^\W\d_])_([A-Za-z]+|\d)(?![A-Za-z0-9_])")
COEFFICIENTS = {each.name for each in fields(InternalCoefficients)}
PAGES = ("index", "claims", "fits")
# The classes that the pages give to the groups of claims.
MARKS = dict(
    zip(
        MEANINGS,
        ("yes", "choice", "no", "open", "hangs", "untestable", "misprints"),
        strict=True,
    )
)


@dataclass(frozen=True)
class Site:
    """The report on disk.

    Attributes
    ----------
    index : path
        The page to open.
    missing : tuple of str
        The missing parts, each with its reason.
    """

    index: Path
    missing: tuple[str, ...]


@dataclass(frozen=True)
class _ReadableBench(Bench):
    """A bench without the fit results that cannot be read, which the page lists separately."""

    def results_by_name(self) -> dict[str, FitResult]:
        """Load every readable fit result, name → result."""
        return dict(read_campaigns(self).results)


@dataclass(frozen=True)
class _Ledger:
    """The claims, or the reason why there are none."""

    claims: tuple[Claim, ...]
    withdrawn: Mapping[str, str] = field(default_factory=dict)
    problem: str = ""


def build_site(bench: Bench, folder: Path, progress: Progress = silent) -> Site:
    """Draw all figures and write the pages, `figures/` and the claims' `code/` in a folder.

    The index has the answer and the gallery; each figure, each section's claims and the fits
    have pages of their own. They need no server and no network. Figures, fits and claims
    that fail are listed as missing, with the reason.

    Parameters
    ----------
    bench : Bench
        The recipes and their inputs; its `jobs` processes draw and run long computations.
    folder : path
        Where to write.
    progress : callable, optional
        Called with the stage, the number of parts done and their total.

    Returns
    -------
    Site

    Raises
    ------
    InputError
        If there is no recipe at all, or the folder cannot be written to.
    """
    require_writable(*(folder / f"{page}.html" for page in PAGES))
    recipes = find_recipes(bench)
    drawn = build(bench, folder=folder / "figures", progress=progress)
    paper = paper_of(bench)
    figures = [describe(each, recipes[each.name], bench.root, folder, paper) for each in drawn]
    numbered, others = plates(figures, paper)
    campaigns = read_campaigns(bench)
    claims = _claims(bench, progress)
    parts = list(claim_pages(claims.claims))
    laws = list(answers(bench)) if paper.fits else []
    render = _renderer(
        version=version("cylcontact"),
        made_with=made_with(campaigns.results),
        paper=paper,
        marks=MARKS,
        page_of={claim.id: part.name for part in parts for claim in part.claims},
        counts=counts(claims.claims),
        what_stands=what_stands(claims.claims) if claims.claims else "",
        claims_problem=claims.problem,
    )
    pages = {
        "index": render("index", **_index(numbered, others, campaigns, paper, laws)),
        "claims": render("claims", **_claims_overview(claims, parts, paper)),
        "fits": render(
            "fits", tables=tables(campaigns.results), missing_campaigns=campaigns.missing
        ),
        **_figure_pages(render, [*numbered, *others], claims),
        **_section_pages(render, parts, [*numbered, *others], _copied_code(claims, bench, folder)),
    }
    with replacing_all(folder / f"{page}.html" for page in pages) as files:
        for file, text in zip(files, pages.values(), strict=True):
            file.write_text(text, encoding="utf-8")
    missing = [f"{figure.name}: {figure.problem}" for figure in figures if figure.problem]
    missing += [f"{name}: {reason}" for name, reason in campaigns.missing.items()]
    missing += [f"laws: {law.problem}" for law in laws if law.problem]
    missing += [f"claims: {claims.problem}"] if claims.problem else []
    return Site(folder / "index.html", tuple(missing))


def _renderer(**common: Any) -> Callable[..., str]:
    """Return a function that renders a template with its content, escaped.

    Parameters
    ----------
    **common
        The variables of all pages.

    Returns
    -------
    function
        Of the template's name and its own variables.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("cylcontact.reports.html"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    # Our own styles and scripts are inserted verbatim; everything else is escaped.
    environment.filters["subscripts"] = lambda text: Markup(_subscripts(escape(text)))
    environment.globals |= common
    environment.globals["described"] = described
    environment.globals["asset"] = lambda name: Markup(_asset(name))

    def render(page: str, **content: Any) -> str:
        return environment.get_template(f"{page}.html.j2").render(page=page, **content)

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


def _asset(name: str) -> str:
    """Return the text of one of our style sheets or scripts."""
    return (files("cylcontact.reports.html") / "assets" / name).read_text(encoding="utf-8")


def _index(
    numbered: list[Plate],
    others: list[Plate],
    campaigns: Campaigns,
    paper: Paper,
    laws: list[Answer],
) -> dict[str, Any]:
    """Return the content of the report's first page."""
    main = headline(campaigns.results, paper.fits)
    return {
        "answers": laws,
        "recovered": [table for table in main if table.recovered],
        "refitted": [table for table in main if not table.recovered],
        "numbered": numbered,
        "others": others,
    }


def _claims_overview(claims: _Ledger, parts: list[ClaimPage], paper: Paper) -> dict[str, Any]:
    """Return the content of the page that leads to the claims."""
    sections: dict[str, list[ClaimPage]] = {}
    for part in parts:
        sections.setdefault(part.section, []).append(part)
    groups = grouped(claims.claims)
    return {
        "parts": parts,
        "sections": sections,
        "groups": groups,
        "cells": {
            group: {
                section: (
                    sum(claim.section == section for claim in members),
                    next((p.name for p in pages if group in grouped(p.claims)), ""),
                )
                for section, pages in sections.items()
            }
            for group, members in groups.items()
        },
        "meanings": MEANINGS,
        "definitions": paper.definitions,
        "withdrawn": claims.withdrawn,
        "references": paper.references,
    }


def _figure_pages(
    render: Callable[..., str], shown: list[Plate], claims: _Ledger
) -> dict[str, str]:
    """Return the pages of the figures, with the claims that each shows."""
    pages = {}
    for at, plate in enumerate(shown):
        names = {figure.name for figure in plate.figures}
        pages[plate.page] = render(
            "figure",
            plate=plate,
            before=shown[at - 1] if at else None,
            after=shown[at + 1] if at + 1 < len(shown) else None,
            resting=[claim for claim in claims.claims if names & set(claim.figures)],
        )
    return pages


def _section_pages(
    render: Callable[..., str],
    parts: list[ClaimPage],
    shown: list[Plate],
    code: Mapping[str, str],
) -> dict[str, str]:
    """Return the pages of the claims of each section."""
    plate_of = {figure.name: plate.page for plate in shown for figure in plate.figures}
    return {
        part.name: render(
            "section",
            part=part,
            before=parts[at - 1] if at else None,
            after=parts[at + 1] if at + 1 < len(parts) else None,
            groups=grouped(part.claims),
            meanings=MEANINGS,
            plate_of=plate_of,
            code=code,
        )
        for at, part in enumerate(parts)
    }


def _copied_code(claims: _Ledger, bench: Bench, folder: Path) -> dict[str, str]:
    """Copy the files that the claims are computed in, and return their addresses by place."""
    addresses = {}
    for place in {claim.code for claim in claims.claims}:
        source = bench.root / place.rpartition(":")[0]
        copy = folder / "code" / f"{source.name}.txt"
        with replacing(copy) as temporary:
            temporary.write_bytes(source.read_bytes())
        addresses[place] = copy.relative_to(folder).as_posix()
    return addresses


def _claims(bench: Bench, progress: Progress) -> _Ledger:
    """Return the ledger, or the reason why there is none."""
    readable = _ReadableBench(bench.root, bench.results, bench.jobs)
    try:
        return _Ledger(tuple(ledger(readable, progress)), withdrawn(readable))
    except InputError as error:
        return _Ledger((), problem=str(error))
