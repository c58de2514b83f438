"""The page of a joint with a bush."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from cylcontact.bodies.material import Material
from cylcontact.joint.bush import NOT_INCLUDED, cells, limits_of, shown, summary
from cylcontact.joint.page import Page, Source, numbers_of_material
from cylcontact.joint.sketch import draw_pin
from cylcontact.laws import Housing

if TYPE_CHECKING:
    from cylcontact.joint.bush import BushCheck


def page_of(check: BushCheck) -> Page:
    """Return the page of a check."""
    numbers = check.band.get("joint") or check.band["middle"]
    pin = sum(limits_of(check.pin_diameter, "pin")) / 4
    seat = sum(check.bush.sizes.hole) / 4
    shape = Housing(check.housing.R_o, check.housing.clamp, [(check.hole, seat)])
    title = f"{check.pin.title} pin in a {str(check.bush).partition(' (')[0]}"
    sketch = partial(
        draw_pin, R_i=numbers.bore_mm / 2, R_j=pin, housing=shape,
        gap=f"bush after pressing, ΔR = {numbers.clearance_um:.4g} µm",
    )  # fmt: skip
    sections = {"Assumptions": _assumptions(check), "Not included": [NOT_INCLUDED]}
    words = [" ".join(line.split()) for line in summary(check)]
    return Page(
        "Check of a joint with a bush", title, sketch, None, _inputs(check), *cells(check), words,
        check.warnings, sections,
    )  # fmt: skip


def _inputs(check: BushCheck) -> list[Source]:
    """Return what the answer is computed from."""
    bush, (warm_pin, warm) = check.bush, check.temperature
    inner = f"bore {shown(bush.bore)}" if bush.wall is None else f"wall {shown(bush.wall)}"
    seat = bush.seat if isinstance(bush.seat, str) else " / ".join(map(shown, bush.seat))
    wrapped = ", rolled of strip" if bush.wrapped else ""
    rim = check.rim.title if isinstance(check.rim, Material) else check.rim
    total = f" ({check.load * check.length:,.6g} N on {check.length:g} mm)" if check.length else ""
    return [
        ("bush", *numbers_of_material(bush.material)),
        ("", f"{inner} before pressing, seat {seat}{wrapped}", "given"),
        ("pin", *numbers_of_material(check.pin)),
        ("", f"diameter {shown(check.pin_diameter)}", "given"),
        ("around it", *numbers_of_material(check.hole)),
        ("", f"{str(check.housing).partition(' (as ')[0]}; rim at rest: {rim}", "given"),
        ("temperature", f"pin {warm_pin:g} °C, other parts {warm:g} °C", "given"),
        ("load", f"{check.load:,.6g} N/mm{total}", "given"),
        ("plane", check.plane, "given"),
    ]


def _assumptions(check: BushCheck) -> list[str]:
    """Return what the answer rests on."""
    return [
        f"Linear elasticity, plane {check.plane} under the load; at rest the ends are free.",
        "The seat slides or sticks: each yield is the lower one of both.",
        "Diameters are normally distributed, with the limits at ±3σ.",
    ]
