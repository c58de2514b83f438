"""One case as an input deck of CalculiX.

Its contact pressures scatter from point to point, so the peak is read from the stress in the two
cells that meet at the top. At their middles it differs from the surface's by about 0.1 % while the
contact is narrow. With 16 cells it is 2 % low at f/(E*·ΔR) = 0.3 and 4 % at 1, and the penetration
0.2 and 0.8 %; with half as many cells nearly twice as much.

This works with CalculiX 2.20: the pin is moved in by half of the reference law's penetration, so
that contact exists from the start; one increment; surface-to-surface penalty contact with a linear,
very stiff law; CPE4, with equivalent moduli for plane stress. The step is repeated, because the
first may end with contact points that the final load does not have; the second confirms the set.

CPE4 locks near ν = 0.5, and CalculiX has no B-bar or incompatible modes for plane strain. CPE4R,
with one point of quadrature and hourglass control, takes over where the embedded solver leaves its
plain quads; there the two solvers agree as well as they do below, to ν = 0.499999.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cylcontact.datasets.finite_element.elasticity import LOCKS_FROM
from cylcontact.datasets.finite_element.mesh import Body, IntArray, Mesh
from cylcontact.datasets.finite_element.setup import BodyName, Setup
from cylcontact.datasets.finite_element.solve import clamped_nodes, node_shares
from cylcontact.laws import Conformal

__all__ = ["Deck", "make_deck"]

# Overlap at the start, as a fraction of the reference law's penetration.
_OVERLAP = 0.5
# The stiffness of the contact in MPa/mm: the overlap of the surfaces is pressure over stiffness.
_STIFFNESS = 1e9
# The step, used twice.
_STEP = """*STEP
*STATIC,DIRECT
1.,1.
{loads}*NODE PRINT,NSET=CENTRE
U
*EL PRINT,ELSET=TOP
S
*END STEP
"""


@dataclass(frozen=True, eq=False)
class Deck:
    """An input deck, and the overlap needed to read its results.

    Attributes
    ----------
    text : str
        The deck.
    overlap : float
        Initial displacement of the pin into the plate in mm.
    """

    text: str
    overlap: float


def make_deck(setup: Setup, dR: float, load: float, mesh: Mesh) -> Deck:
    """Return one case as an input deck.

    Parameters
    ----------
    setup : Setup
        The set-up.
    dR, load : float
        Clearance in mm and load in N/mm.
    mesh : Mesh
        The mesh, the same as for the embedded solver.

    Returns
    -------
    Deck

    Examples
    --------
    >>> setup = Setup(2.245, 3.3, E=207e3, nu=0.3, cells=8, pin_E="10 MPa", pin_nu=0.499)
    >>> deck = make_deck(setup, 0.1, 20.0, setup.mesh(0.1, np.array([20.0])))
    >>> [line for line in deck.text.splitlines() if "CPE4" in line]
    ['*ELEMENT,TYPE=CPE4,ELSET=PLATE', '*ELEMENT,TYPE=CPE4R,ELSET=PIN']
    """
    overlap = _OVERLAP * float(Conformal().penetration(load, setup.pair(dR)))
    shift = len(mesh.plate.points)
    on_hole = _faces(mesh.plate, mesh.plate.surface[: mesh.pairs.count])
    on_pin = _faces(mesh.pin, mesh.pin.surface[: mesh.pairs.count])
    shares = load / 2 * node_shares(setup, dR, mesh)
    lines = [
        *_nodes(mesh, overlap),
        *_body("plate", setup, mesh.plate.quads + 1, 1),
        *_body("pin", setup, mesh.pin.quads + 1 + shift, 1 + len(mesh.plate.quads)),
        *_surface("HOLE", on_hole, 0),
        *_surface("FACE", on_pin, len(mesh.plate.quads)),
        "*SURFACE INTERACTION,NAME=CONTACT",
        "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR",
        f"{_STIFFNESS:.6e}",
        "*CONTACT PAIR,INTERACTION=CONTACT,TYPE=SURFACE TO SURFACE",
        "FACE,HOLE",
        "*BOUNDARY",
        *(f"{node + 1},1,2" for node in clamped_nodes(setup, mesh)),
        *(f"{node + 1},1,1" for node in mesh.plate.axis),
        *(f"{node + 1 + shift},1,1" for node in mesh.pin.axis),
        "*NSET,NSET=CENTRE",
        str(mesh.centre + 1 + shift),
        "*ELSET,ELSET=TOP",
        f"{on_hole[0][0] + 1},{on_pin[0][0] + 1 + len(mesh.plate.quads)}",
    ]
    loads = "".join(
        f"{node + 1 + shift},2,{share:.12e}\n" for node, share in enumerate(shares) if share
    )
    text = "\n".join(lines) + "\n" + _STEP.format(loads="*CLOAD\n" + loads) + _STEP.format(loads="")
    return Deck(text, overlap)


def _nodes(mesh: Mesh, overlap: float) -> Iterator[str]:
    """Yield the nodes, the plate's first; CalculiX reads up to 20 characters of a number."""
    points = np.vstack([mesh.plate.points, mesh.pin.points + np.array([0.0, overlap])])
    yield "*NODE,NSET=NODES"
    yield from (f"{i},{x:.12e},{y:.12e},0." for i, (x, y) in enumerate(points, start=1))


def _body(of: BodyName, setup: Setup, quads: IntArray, first: int) -> Iterator[str]:
    """Yield cells, numbered from `first`, section and material of a body."""
    name = of.upper()
    E, nu = setup.equivalent(of)
    yield f"*ELEMENT,TYPE={'CPE4R' if nu > LOCKS_FROM else 'CPE4'},ELSET={name}"
    yield from (f"{i},{a},{b},{c},{d}" for i, (a, b, c, d) in enumerate(quads, start=first))
    yield from (f"*MATERIAL,NAME={name}", "*ELASTIC", f"{E:.12e},{nu:.12e}")
    yield from (f"*SOLID SECTION,ELSET={name},MATERIAL={name}", "1.")


def _surface(name: str, faces: list[tuple[int, int]], shift: int) -> Iterator[str]:
    """Yield a surface of cells' faces."""
    yield f"*SURFACE,NAME={name},TYPE=ELEMENT"
    yield from (f"{cell + 1 + shift},S{side + 1}" for cell, side in faces)


def _faces(body: Body, surface: IntArray) -> list[tuple[int, int]]:
    """Return cell and side of each face between neighbouring nodes of a surface, in order."""
    position = np.full(len(body.points), -1)
    position[surface] = np.arange(surface.size)
    ends = np.stack([position[body.quads], position[np.roll(body.quads, -1, axis=1)]])
    cells, sides = np.nonzero(ends.min(axis=0) >= 0)
    order = np.argsort(ends.min(axis=0)[cells, sides])
    return list(zip(cells[order].tolist(), sides[order].tolist(), strict=True))
