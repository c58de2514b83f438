"""The report: one HTML page with coefficients, figures and claims, to open or to send."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape
from importlib.metadata import version
from pathlib import Path

from cylcontact.files.provenance import data_read, modules_of, origin_of
from cylcontact.files.writing import replacing
from cylcontact.fitting.calibration import space_of
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.results import LawFit
from cylcontact.reports.claims import Claim, claims_of
from cylcontact.reports.figures import report_module
from cylcontact.support.errors import InputError

__all__ = ["write_page"]

# For each contact: the fit with ties, and the one in which all coefficients are free.
FITS = {
    "internal": ("recovered-internal", "internal"),
    "external": ("recovered-external", "external"),
}
_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
figure { margin: 2rem 0; } img { max-width: 100%; height: auto; background: white; }
table { border-collapse: collapse; } td, th { padding: .2rem .8rem; text-align: right; }
td:first-child, th:first-child { text-align: left; } tr { border-bottom: 1px solid #8884; }
.scroll { overflow-x: auto; } details { margin: .4rem 0; } li { overflow-wrap: anywhere; }
footer { margin-top: 3rem; border-top: 1px solid #8884; font-size: .85rem; }
footer p { overflow-wrap: anywhere; }
@media (prefers-color-scheme: dark) { body { background: #111; color: #eee; } }
"""


def write_page(
    path: Path,
    root: Path,
    results: Path | None = None,
    figures: Path | None = None,
) -> list[str]:
    """Write the page of a folder, with all that is there.

    Parameters
    ----------
    path : path
        The page to write; pictures are inside it.
    root : path
        The folder that holds `reports` and `fitting`.
    results : path, optional
        The folder of fit results; by default `fitting/results`.
    figures : path, optional
        The folder of drawn figures; by default `build/figures`.

    Returns
    -------
    list of str
        What is missing, each with the command that makes it.
    """
    missing: list[str] = []
    found, claims = results or root / "fitting" / "results", root / "reports" / "claims.py"
    with data_read(root) as data:
        parts = [
            f"<h2>{contact.capitalize()} contact</h2>{_fits(found, names, missing)}"
            for contact, names in FITS.items()
        ]
        if (root / "fitting/results/choices.csv").is_file():
            listed = "".join(f"<li>{escape(each)}</li>" for each in _choices(root))
            parts.append(f"<h2>What the paper leaves open</h2><ul>{listed}</ul>")
        drawn = sorted((figures or root / "build" / "figures").glob("*.txt"))
        if not drawn:
            missing.append("the figures: cylcontact figure")
        parts += ["<h2>Figures</h2>", *(_figure(text, missing) for text in drawn)]
        try:
            computed = claims_of(root)
        except InputError as error:
            missing.append(f"the claims: {error}")
        else:
            parts += ["<h2>What the paper claims</h2>", _claims(computed)]
    head = (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>cylcontact</title>'
        f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style>'
        "<h1>An enhanced cylindrical contact force model, computed again</h1>"
        "<p>Coefficients of the law f = (a·ΔR + b)·E*/ΔR·δⁿ: as published, recovered by the same "
        "kind of search with some coefficients fixed or tied, and fitted with all of them free. "
        "The error is the root mean square of ln(δ/δ_Johnson), of every column over the samples of "
        "the last.</p>"
    )
    sources = modules_of(claims) if claims.is_file() else []
    origin = escape(str(origin_of(root, [*sources, *data], path)))
    foot = (
        f"<footer><p>Made with {origin}. A figure says in its own metadata what it is from.</p>"
        "<p>Please cite the paper, <i>An enhanced cylindrical contact force model</i>, C. Pereira, "
        "A. Ramalho and J. Ambrósio, Multibody System Dynamics (2015), "
        "doi:10.1007/s11044-015-9463-x, and this program as cylcontact "
        f"{version('cylcontact')}, with its authors as in CITATION.cff.</p></footer>"
    )
    with replacing(path) as temporary:
        temporary.write_text("\n".join([head, *parts, foot, "</html>"]), encoding="utf-8")
    return missing


def _fits(results: Path, names: Sequence[str], missing: list[str]) -> str:
    """Return the table of published, recovered and refitted coefficients."""
    fits: dict[str, LawFit] = {}
    for name, heading in zip(names, ("recovered", "refitted"), strict=True):
        file = results / f"{name}.json"
        if file.is_file():
            fits[heading] = LawFit.read(file)
        else:
            missing.append(f"{file}: cylcontact fit fitting/{name}.toml -o {file}")
    if not fits:
        return "<p>No fit yet.</p>"
    last = list(fits.values())[-1]
    columns = {heading: fit.coefficients for heading, fit in fits.items()}
    if last.published is not None:
        columns = {"published": last.published.coefficients, **columns}
    space, _ = space_of(Campaign.of_settings(last.name, last.settings, last.name))
    errors = {heading: space.value_of(values) for heading, values in columns.items()}
    rows = ["<tr><th>coefficient</th>" + "".join(f"<th>{each}</th>" for each in columns) + "</tr>"]
    for name in last.coefficients:
        cells = "".join(f"<td>{values[name]:.5g}</td>" for values in columns.values())
        rows.append(f"<tr><td>{escape(name)}</td>{cells}</tr>")
    cells = "".join(f"<td>{value:.4f}</td>" for value in errors.values())
    return f'<div class="scroll"><table>{"".join(rows)}<tr><td>error</td>{cells}</tr></table></div>'


def _choices(root: Path) -> list[str]:
    """Return what the study of every choice says."""
    said: list[str] = report_module(root, "choices").sentences(root)
    return [*said, "Percentages count our list of choices; they are no probabilities."]


def _figure(text: Path, missing: list[str]) -> str:
    """Return a figure with its caption."""
    caption = escape(text.read_text(encoding="utf-8").strip())
    kinds = {".png": "image/png", ".svg": "image/svg+xml"}
    drawn = [suffix for suffix in kinds if text.with_suffix(suffix).is_file()]
    image = ""
    if drawn:
        picture = base64.b64encode(text.with_suffix(drawn[0]).read_bytes()).decode("ascii")
        image = f'<img alt="{escape(text.stem)}" src="data:{kinds[drawn[0]]};base64,{picture}">'
    else:
        missing.append(f"the picture of {text.stem}: cylcontact figure {text.stem}")
    return f"<figure>{image}<figcaption><b>{escape(text.stem)}.</b> {caption}</figcaption></figure>"


def _claims(claims: Sequence[Claim]) -> str:
    """Return the claims, each with its interpretations to unfold."""
    signs, parts = {True: "✓", False: "✗", None: "○"}, []
    for each in claims:
        rows = "".join(
            f"<li>{signs[holds]} {escape(how)}: {escape(ours)}</li>"
            for how, ours, holds in each.interpretations
        )
        title = f"{each.section} {each.statement} ({each.printed})"
        parts.append(
            f"<details><summary><b>{each.verdict}:</b> {escape(title)}</summary>"
            f"<p>“{escape(each.quotation)}”</p><ul>{rows}</ul></details>"
        )
    return "\n".join(parts)
