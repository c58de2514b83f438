"""The page of a checked joint: its sketch, inputs, answer, picture and assumptions."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from cylcontact.bodies.material import Material
from cylcontact.joint.answer import cells, not_included, words
from cylcontact.joint.page import Page, Source, numbers_of_material
from cylcontact.joint.picture import draw_check, title_of
from cylcontact.joint.sketch import draw_sketch

if TYPE_CHECKING:
    from cylcontact.joint.answer import Answer


def page_of(check: Answer) -> Page:
    """Return the page of a check."""
    sections = {"Assumptions": assumptions(check)}
    sections["Not included"] = [", ".join(not_included(check.joint))]
    return Page(
        "Check of a joint", title_of(check.joint), partial(draw_sketch, check),
        partial(draw_check, check), inputs(check), *cells(check), words(check), check.warnings,
        sections,
    )  # fmt: skip


def inputs(check: Answer) -> list[Source]:
    """Return what the answer is computed from: its name, its value, and where that is from."""
    joint, pair = check.joint, check.joint.drawn
    first, second = ("hole", "pin") if pair.contact == "internal" else ("roller i", "roller j")
    R_i, R_j = (float(radius) for radius in pair.radii("a page"))
    rows = [
        (first, *numbers_of_material(pair.material_i)),
        (second, *numbers_of_material(pair.material_j)),
    ]
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
            (f"layer from {radius:g} mm", *numbers_of_material(body))
            for body, radius in joint.housing.layers
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
