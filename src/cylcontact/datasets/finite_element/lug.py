"""A round-ended lug on a straight shank, pulled by its pin, by finite elements.

The lug is an eye of radius R_o on a shank of half-width W = shank·R_o. A shank as wide as the eye
makes a parallel-sided lug. Flanks at 30° to the load lead from the eye to a wider shank, and
fillets of radius R_o/2 to a narrower one. The shank ends three half-widths below the eye: there it
does not move along the load and is free to move across it. So the stress has no singular place,
and first yield is sought in all cells of the lug and of the pin.

The penetration is that of the pin's centre against the section of the shank one R_o below the
hole's centre: the even stretch of the shank between there and its end is subtracted.

`python -m cylcontact.datasets.finite_element.lug` makes datasets/finite_element/lug.csv.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import get_args

import numpy as np

from cylcontact.bodies.pair import Plane
from cylcontact.datasets.finite_element.mesh import (
    Body,
    BodyName,
    Grading,
    Setup,
    graded,
    polar,
    quads_of,
)
from cylcontact.datasets.finite_element.solver import Solution, condense
from cylcontact.files.writing import replacing
from cylcontact.support.arrays import FloatArray, IndexArray, on_one_thread, require
from cylcontact.support.errors import InputError

# The flanks' angle to the load, the fillets' radius and the shank's length, over R_o and W.
_TAPER, _FILLET, _LENGTH = np.radians(30), 0.5, 3.0
# The eye's cells end so far below its centre, over R_o: below the flanks and the fillets.
_PARALLEL, _OTHER = 1.0, 1.6
# Cells at the bore are so many times thinner than long, because the stress falls fast from there.
_THINNER = 4

# The table: a steel pin in a steel lug, R = 10 mm.
E, NU, YIELD_STRESS, RADIUS = 207e3, 0.3, 350.0, 10.0
SHANKS, RATIOS, CLEARANCES = (
    (0.5, 0.75, 1.0, 1.2, 1.5),
    (1.3, 1.5, 2.0, 3.0, 4.0),
    (0.005, 0.02, 0.1),
)
SIZES = (0.08, 0.04)  # mm, the smallest cells of the two meshes
_COMMAND = "python -m cylcontact.datasets.finite_element.lug"
COLUMNS = (
    *("plane", "shank", "outer_ratio", "dR_mm", "first_yield_N_per_mm", "first_yield_coarse"),
    *("body", "angle_deg", "penetration_um", "penetration_coarse", "stiffness_N_per_mm2"),
)


def _depth(shank: float) -> float:
    return _PARALLEL if shank == 1 else _OTHER


def outline(angle: FloatArray, shank: float) -> FloatArray:
    """Return the distance of half the outline from the centre over R_o, at angles from the top."""
    s, c = np.sin(angle), np.cos(angle)
    straight = 1 / np.maximum(np.maximum(s / shank, -c / _depth(shank)), 1e-9)
    if shank >= 1:  # the flank touches the eye at `first`
        first = np.pi / 2 - (_TAPER if shank > 1 else 0.0)
        flank = 1 / np.maximum(np.cos(angle - first), 1e-9)
        return np.where(angle < first, 1.0, np.minimum(flank, straight))
    x, reach = shank + _FILLET, 1 + _FILLET  # the fillet's centre, and its distance from the eye's
    y = -np.sqrt(reach**2 - x**2)
    along = x * s + y * c
    fillet = along - np.sqrt(np.maximum(along**2 - reach**2 + _FILLET**2, 0.0))
    below = np.where(angle < np.arctan2(shank, y), fillet, straight)
    return np.where(angle < np.arctan2(x, y), 1.0, below)


def _plate(
    shank: float, setup: Setup, rays: FloatArray, grading: Grading
) -> tuple[Body, IndexArray]:
    """Mesh half of the lug, with `rays` as its first angles, and return the shank's end too."""
    R, R_o = setup.hole_radius, setup.outer_radius
    width, depth = shank * R_o, _depth(shank) * R_o
    # The eye: cells on rays from the centre, one of which goes to the corner of the eye's cells.
    corner = np.pi - np.arctan(width / depth)
    even = replace(grading, fine=np.inf, size=(rays[-1] - rays[-2]) * R)
    side = rays[-1] + graded((corner - rays[-1]) * R, even, R)[1:] / R
    under = np.linspace(corner, np.pi, int(np.ceil((np.pi - corner) / grading.largest)) + 1)
    theta = np.concatenate([rays, side, under[1:]])
    outwards = replace(even, size=grading.size / _THINNER)
    share = graded(R_o - R, outwards, R)[:, None] / (R_o - R)
    eye = polar(R + share * (R_o * outline(theta, shank) - R), theta)
    nodes = np.arange(eye[..., 0].size).reshape(eye.shape[:2])
    # The shank: columns of cells below the eye's last nodes.
    top = eye[-1, -under.size :]
    rows = graded(_LENGTH * width, replace(even, size=width / 24, largest=width / 6 / R), R)[1:]
    columns = top - rows[:, None, None] * np.array([0.0, 1.0])
    below = nodes.size + np.arange(columns[..., 0].size).reshape(columns.shape[:2])
    shank_nodes = np.concatenate([nodes[-1:, -under.size :], below])
    body = Body(
        np.concatenate([eye.reshape(-1, 2), columns.reshape(-1, 2)]),
        np.concatenate([quads_of(nodes), quads_of(shank_nodes)]),
        nodes[0],
        np.concatenate([nodes[:, 0], nodes[:, -1], below[:, -1]]),
    )
    return body, below[-1]


def lug(setup: Setup, shank: float, dR: float, load: float) -> Callable[[float], Solution]:
    """Return what solves a lug at any load; `load` in N/mm is one that the mesh is made for."""
    mesh = setup.mesh(dR, [load], partial(_plate, shank), eighths=5)
    solve = condense(setup, dR, mesh, 2 * mesh.outer + 1)
    E, nu = setup.equivalent("plate")
    length = _depth(shank) + _LENGTH * shank - 1
    stretch = length / (2 * shank) * (1 - nu**2) / E

    def at(load: float) -> Solution:
        solution = solve(load)
        return replace(solution, penetration=solution.penetration - stretch * load)

    return at


def first_yield(
    at: Callable[[float], Solution], guess: float, yield_stress: float
) -> tuple[Solution, str, float]:
    """Return the solution at first yield by von Mises, the body, and the angle of the place."""
    from scipy.optimize import brentq

    def largest(solution: Solution) -> tuple[float, BodyName, int]:
        """Return the largest stress, its body and its cell."""
        stresses: dict[BodyName, FloatArray] = {
            of: solution.stress(of).von_mises for of in get_args(BodyName)
        }
        return max((float(s.max()), of, int(s.argmax())) for of, s in stresses.items())

    def above(load: float) -> float:
        try:
            return largest(at(load))[0] / yield_stress - 1
        except InputError:  # the pin is in contact beyond the pairs of the mesh
            return 9.0

    solution = at(brentq(above, guess / 6, 6 * guess, rtol=1e-4))
    stress, of, cell = largest(solution)
    rule, remedy = "is not reached while the mesh's pairs hold the contact", "raise dR"
    reached = abs(stress / yield_stress - 1) < 1e-3
    require(reached, "finite elements", "first yield", None, rule, remedy)
    body: Body = getattr(solution.mesh, of)
    x, y = body.points[body.quads[cell]].mean(axis=0)
    return solution, "hole" if of == "plate" else "pin", float(np.degrees(np.arctan2(x, y)))


def row(plane: Plane, shank: float, ratio: float, dR: float, size: float) -> tuple[object, ...]:
    """Return first yield, body, angle, penetration and stiffness of a case on one mesh."""
    setup = Setup(
        hole_radius=RADIUS, outer_ratio=ratio, E=E, nu=NU, plane=plane, size=size,
        contact_size=6 * size,
    )  # fmt: skip
    # Near the yield load: the net section at its yield stress over three.
    guess = 2 * YIELD_STRESS * RADIUS * min(ratio - 1, 2.0) / 3
    at = lug(setup, shank, dR, guess)
    solution, body, angle = first_yield(at, guess, YIELD_STRESS)
    load = solution.load
    softer, stiffer = at(0.9 * load).penetration, at(1.1 * load).penetration
    stiffness = 0.2 * load / (stiffer - softer)
    return load, body, angle, 1e3 * solution.penetration, stiffness


def rows() -> Iterator[str]:
    """Yield the lines of the table."""
    yield ",".join(COLUMNS)
    for case in product(("strain", "stress"), SHANKS, RATIOS, CLEARANCES):
        with on_one_thread():
            coarse, fine = (row(*case, size) for size in SIZES)  # type: ignore[arg-type]
        load, body, angle, depth, stiffness = fine
        numbers = f"{load:.1f},{coarse[0]:.1f},{body},{angle:.0f},{depth:.2f},{coarse[3]:.2f}"
        yield ",".join(map(str, case)) + f",{numbers},{stiffness:.0f}"


def main(path: str) -> None:
    """Write the table."""
    note = f"# Pulled lugs at first yield, steel on steel: R = {RADIUS:g} mm, E = {E / 1e3:g} GPa, "
    note += f"nu = {NU:g}, yield stress {YIELD_STRESS:g} MPa; made by {_COMMAND}\n"
    with replacing(Path(path)) as temporary:
        text = note + "".join(f"{line}\n" for line in rows())
        temporary.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "datasets/finite_element/lug.csv")
