"""One page of a checked joint, to sign and file: sketch, inputs, answer, picture, assumptions."""

from __future__ import annotations

import io
import textwrap
from html import escape
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.bodies.material import Material, shipped_materials
from cylcontact.files.provenance import spec_hash
from cylcontact.files.writing import replacing, require_suffix
from cylcontact.joint.answer import cells, described, not_included, words
from cylcontact.joint.picture import draw_check, title_of
from cylcontact.joint.sketch import draw_sketch
from cylcontact.plots.figure import StyledFigure, new_figure
from cylcontact.plots.style import figure_style
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    from cylcontact.joint.answer import Answer

SUFFIXES = (".html", ".pdf", ".png")
# A sheet of A4 with its margins, in mm, and the dots per inch of a picture of it.
_WIDTH, _HEIGHT, _DPI = 190.0, 272.0, 200
# A blank at which no line breaks.
_FIXED = "\u00a0"
_STYLE = """
body { font: 14px/1.45 system-ui, sans-serif; max-width: 60rem; margin: 1.5rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.4rem; margin-bottom: .2rem; } h2 { font-size: 1rem; margin: 1.2rem 0 .3rem; }
.side { display: flex; flex-wrap: wrap; gap: 1.5rem; } .side > * { flex: 1 1 20rem; }
svg { max-width: 100%; height: auto; } table { border-collapse: collapse; }
td, th { padding: .12rem .7rem .12rem 0; text-align: right; vertical-align: top; }
td:first-child, th:first-child, .inputs td { text-align: left; font-weight: normal; }
tr { border-bottom: 1px solid #8884; }
.warning { border-left: 4px solid #D55E00; padding-left: .6rem; }
footer { margin-top: 2rem; color: #666; font-size: 12px; }
@media print { body { margin: 0; font-size: 11px; } }
"""


def inputs(check: Answer) -> list[tuple[str, str, str]]:
    """Return what the answer is computed from: its name, its value, and where that is from."""
    joint, pair = check.joint, check.joint.drawn
    first, second = ("hole", "pin") if pair.contact == "internal" else ("roller i", "roller j")
    R_i, R_j = (float(radius) for radius in pair.radii("a page"))
    rows = [(first, *_material(pair.material_i)), (second, *_material(pair.material_j))]
    from_fit = f"middle of {joint.iso.code}" if joint.iso else "given"
    rows += [
        ("R_i", f"{R_i:.6g} mm", from_fit),
        ("R_j", "a plane" if np.isinf(R_j) else f"{R_j:.6g} mm", from_fit),
    ]
    if joint.iso is not None:
        rows.append(("fit", str(joint.iso).partition(": ")[2], "ISO 286-1"))
    elif pair.contact == "internal":
        rows.append(("ΔR", f"{float(pair.dR):.6g} mm, {2 * float(pair.dR):.6g} mm on the diameter",
                     "R_i − R_j"))  # fmt: skip
    if joint.housing is not None:
        rows.append(("housing", str(joint.housing), "given"))
        rows += [
            (f"layer from {radius:g} mm", *_material(body)) for body, radius in joint.housing.layers
        ]
    if joint.temperature is not None:
        pin, hole = joint.temperature
        rim = joint.rim.title if isinstance(joint.rim, Material) else joint.rim
        rows.append(("temperature", f"pin {pin:g} °C, hole {hole:g} °C"
                     + (f", rim: {rim}" if rim else ""), "given"))  # fmt: skip
    if joint.depth is not None:
        rows.append(("depth of the plane", f"{joint.depth:g} mm", "given"))
    load, length = float(joint.load), pair.length
    total = f" ({load * length:,.6g} N on {length:g} mm)" if length else ""
    return [*rows, ("load", f"{load:,.6g} N/mm{total}", "given"), ("plane", pair.plane, "given")]


def _material(body: Material) -> tuple[str, str]:
    """Return the numbers of a material, and where they are from."""
    parts = [f"E = {float(body.E) / 1e3:.4g} GPa", f"ν = {float(body.nu):.3g}"]
    if body.yield_stress is not None:
        parts.append(f"σ_Y = {body.yield_stress:g} MPa")
    if body.thermal_expansion is not None:
        parts.append(f"α = {1e6 * body.thermal_expansion:g}e-6/K")
    row = shipped_materials().get(body.name)
    source = "given"
    if row is not None and row.material == body:
        source = f"table ({', '.join(dict.fromkeys(row.provenance.values()))})"
    numbers = [part.replace(" ", _FIXED) for part in parts]
    return ", ".join([*([body.name] if body.name else []), *numbers]), source


def assumptions(check: Answer) -> list[str]:
    """Return what the answer rests on."""
    joint = check.joint
    lines = [
        f"Linear elasticity in plane {joint.drawn.plane}, the load spread evenly over the length.",
        "First yield by von Mises, from the stresses inside both bodies.",
    ]
    if joint.drawn.contact == "external":
        lines.append("Pressure of Hertz; penetration by Johnson's law.")
        return lines
    if joint.housing is None:
        lines.append("The hole is in an infinite plate; penetration by Johnson's reference point.")
    else:
        lines.append("Penetration of the pin's centre against the clamped part of the rim.")
        lines.append("Layers are bonded to each other." if joint.housing.layers else "")
    if joint.iso is not None:
        lines.append("Produced diameters are normally distributed, with the limits at ±3σ.")
    if joint.temperature is not None:
        lines.append("Radii are those at 20 °C; parts are free along their axis.")
    return [line for line in lines if line]


def _fingerprint(check: Answer) -> str:
    """Return the version of the program, and a hash of the inputs."""
    data = {"rows": [list(row) for row in inputs(check)]}
    return f"cylcontact {version('cylcontact')}, inputs {spec_hash(data)}"


def write_page(check: Answer, path: Path | str) -> Path:
    """Write the page of a check as .html, .pdf or .png, by the suffix of the path."""
    suffix = require_suffix(path, *SUFFIXES)
    with replacing(path) as temporary, figure_style():
        if suffix == ".html":
            temporary.write_text(_html(check), encoding="utf-8")
        else:
            sheet = _sheet(check)
            details: dict[str, Any] = {"metadata": {"CreationDate": None}}
            if suffix == ".png":
                details = {"dpi": _DPI}
            sheet.savefig(temporary, format=suffix[1:], **details)
    return Path(path)


# --- a sheet of paper ---------------------------------------------------------------------------


def _sheet(check: Answer) -> StyledFigure:
    """Return a sheet of A4."""
    figure = new_figure("page", _HEIGHT)
    figure.set_size_inches(_WIDTH / 25.4, _HEIGHT / 25.4)
    figure.set_layout_engine("none")
    joint = check.joint

    def write(x: float, y: float, text: str, **more: Any) -> None:
        figure.text(x / _WIDTH, y / _HEIGHT, text, **{"va": "top", "ha": "left"} | more)

    def lines(x: float, y: float, rows: list[str], size: float = 7.0, **more: Any) -> float:
        write(x, y, "\n".join(rows), fontsize=size, linespacing=1.35, **more)
        return y - 0.3528 * 1.35 * 1.22 * size * len(rows) - 3

    def heading(x: float, y: float, text: str) -> float:
        write(x, y, text, fontsize=9)
        return y - 6

    write(8, _HEIGHT - 8, "Check of a joint", fontsize=14)
    write(8, _HEIGHT - 16, title_of(joint), fontsize=9.5)
    sketch = figure.add_axes((4 / _WIDTH, 178 / _HEIGHT, 88 / _WIDTH, 72 / _HEIGHT))
    draw_sketch(check, sketch)
    y = heading(96, _HEIGHT - 24, "Inputs")
    for name, value, source in inputs(check):
        wrapped = textwrap.wrap(value, 46)
        wrapped[-1] += f"   [{source}]" if source != "given" else ""
        write(96, y, name, fontsize=7)
        y = lines(118, y, wrapped) + 1.2
    y = heading(8, min(y - 4, 172), "Answer")
    columns, rows = cells(check)
    for row in [columns, *rows] if check.iso else rows:
        write(8, y, row[0], fontsize=7)
        for k, cell in enumerate(row[1:]):
            write(84 + 20 * k, y, cell, fontsize=7, ha="right")
        y -= 4.1
    y = lines(8, y - 1, [line for line in words(check) if line], 7.0)
    for warning in check.warnings:
        y = lines(8, y, textwrap.wrap(f"Warning: {warning}", 130), 7.5, color="#B00000") + 1
    bottom = 28.0
    high = min(70.0, y - bottom - 12)
    plot = figure.add_axes((20 / _WIDTH, (y - high - 6) / _HEIGHT, 82 / _WIDTH, high / _HEIGHT))
    draw_check(check, plot)
    plot.set_title("")
    below = heading(112, y, "Assumptions")
    for line in assumptions(check):
        below = lines(112, below, textwrap.wrap(f"– {line}", 52, subsequent_indent="  ")) + 2
    below = heading(112, below - 2, "Not included")
    lines(112, below, textwrap.wrap(", ".join(not_included(joint)), 52))
    for x, name in ((8, "checked by"), (76, "approved by"), (144, "date")):
        figure.add_artist(_line(figure, x, x + 42, 16))
        write(x, 15, name, fontsize=6.5)
    write(8, 7, _fingerprint(check), fontsize=6.5, color="0.4")
    return figure


def _line(figure: StyledFigure, start: float, end: float, y: float) -> Any:
    from matplotlib.lines import Line2D

    x = [start / _WIDTH, end / _WIDTH]
    return Line2D(x, [y / _HEIGHT] * 2, transform=figure.transFigure, color="black",
                  linewidth=0.6, linestyle="-", marker="")  # fmt: skip


# --- a page of HTML -----------------------------------------------------------------------------


def _html(check: Answer) -> str:
    """Return a page of HTML with its pictures."""
    joint = check.joint
    sketch, picture = new_figure("column", 75.0), new_figure("column", 75.0)
    draw_sketch(check, sketch.subplots())
    draw_check(check, picture.subplots())
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td>{escape(value)}</td><td>{escape(source)}</td></tr>"
        for name, value, source in inputs(check)
    )
    warnings = "".join(f'<p class="warning">Warning: {escape(w)}</p>' for w in check.warnings)
    assumed = "".join(f"<li>{escape(line)}</li>" for line in assumptions(check))
    said = "<br>".join(map(escape, described(joint)))
    return "\n".join(
        [
            '<!doctype html><html lang="en"><meta charset="utf-8">'
            f"<title>{escape(title_of(joint))}</title>"
            f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style>',
            f"<h1>Check of a joint</h1><p><b>{escape(title_of(joint))}</b><br>{said}</p>",
            warnings,
            f'<div class="side"><figure>{_svg(sketch)}</figure><div><h2>Inputs</h2>'
            f'<table class="inputs"><tr><td></td><td>value</td><td>source</td></tr>{rows}</table>'
            "</div></div>",
            f"<h2>Answer</h2>{TextTable(*cells(check), described(joint)[0])._repr_html_()}",
            *(f"<p>{escape(line)}</p>" for line in words(check)),
            f'<div class="side"><figure>{_svg(picture)}</figure><div><h2>Assumptions</h2>'
            f"<ul>{assumed}</ul><h2>Not included</h2>"
            f"<p>{escape(', '.join(not_included(joint)))}</p></div></div>",
            f"<p>checked by {'_' * 22} approved by {'_' * 22} date {'_' * 12}</p>",
            f"<footer>{escape(_fingerprint(check))}</footer></html>",
        ]
    )


def _svg(figure: StyledFigure) -> str:
    """Return a picture as SVG, to stand inside a page."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()[text.getvalue().index("<svg") :]
