"""CalculiX on the meshes of the finite elements, and the table that it gives.

    python -m benchmarks.calculix    # writes datasets/finite_element/recommended-calculix.csv
    python -m benchmarks calculix    # times it beside ours

CalculiX's contact pressures scatter, so the peak is the stress in the two cells that meet at the
top, 0.1 % below the surface's while the contact is narrow. The pin starts half of the reference
penetration inside the plate, so that there is contact; the step is repeated until the contact
points settle. Near ν = 0.5 CPE4 locks; CPE4R takes over where our solver leaves its plain quads.
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from benchmarks.harness import Row, compare, require_agreement
from cylcontact.datasets.finite_element import Setup, read_study, read_table, solve, write_table
from cylcontact.datasets.finite_element.mesh import Body, Mesh
from cylcontact.datasets.finite_element.solver import LOCKS_FROM, clamped_nodes, node_shares
from cylcontact.laws import Conformal

TABLES = Path(__file__).parents[1] / "datasets/finite_element"
# Overlap at the start, as a fraction of the reference law's penetration.
OVERLAP = 0.5
# The stiffness of the contact in MPa/mm: the overlap of the surfaces is pressure over stiffness.
STIFFNESS = 1e9
# Largest relative difference between the two steps if contact has settled.
SETTLED = 2e-4
STEP = """*STEP
*STATIC,DIRECT
1.,1.
{loads}*NODE PRINT,NSET=CENTRE
U
*EL PRINT,ELSET=TOP
S
*END STEP
"""


def main() -> None:
    """Solve the recommended set-up, in the rows of our own table of it."""
    study, own = read_study(TABLES / "recommended.toml"), TABLES / "recommended-embedded.csv"
    (setup,), rows = study.setups.values(), read_table(own).rows
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        solved = pool.map(
            lambda dR, load: run_case(setup, dR, load, study.load),
            rows["dR_mm"],
            rows["load_N_per_mm"],
        )
        penetrations, peaks = zip(*solved, strict=True)
    rows = rows.assign(penetration_mm=penetrations, peak_pressure_MPa=peaks, half_width_mm=np.nan)
    said = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    version = re.search(r"Version\s+(\S+)", said)
    name = f"CalculiX {version[1] if version else 'unknown'}"
    write_table(TABLES / "recommended-calculix.csv", study, name, rows)


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the time for some loads at one clearance."""
    setup = Setup(hole_radius=2.245, outer_ratio=3.3, E=207e3, nu=0.3, cells=8)
    loads = np.array([20.0, 40.0, 100.0])[: 1 if short else 3]
    sides = {
        "cylcontact": lambda: [case.penetration for case in solve(setup, 0.1, loads)],
        "CalculiX": lambda: [run_case(setup, 0.1, load, loads)[0] for load in loads],
    }
    require_agreement(sides, 0.003)  # each has its own contact
    case = f"a pin in a hole, {loads.size} loads, {setup.mesh(0.1, loads).cells:,} cells"
    yield compare(case, sides, 1 if short else 3, "s", 1.0)


def run_case(setup: Setup, dR: float, load: float, loads: Sequence[float]) -> tuple[float, float]:
    """Return penetration in mm and peak pressure in MPa, on the mesh for all of the loads."""
    mesh = setup.mesh(dR, loads)
    overlap = OVERLAP * float(Conformal().penetration(load, setup.pair(dR)))
    with tempfile.TemporaryDirectory() as folder:
        case = Path(folder, "case.inp")
        case.write_text(deck(setup, dR, load, mesh, overlap), encoding="ascii")
        # One thread: cases run in parallel, and the result does not depend on the machine.
        done = subprocess.run(
            ["ccx", "-i", "case"],
            cwd=folder,
            env={**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_RESULTS": "1"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
            timeout=600,
        )
        results = case.with_suffix(".dat")
        if done.returncode or not results.exists():
            raise RuntimeError(
                f"CalculiX ended with code {done.returncode}:\n{done.stdout[-1000:]}"
            )
        return read_results(results.read_text(encoding="ascii", errors="replace"), overlap)


def read_results(text: str, overlap: float) -> tuple[float, float]:
    """Return the penetration in mm and the peak pressure in MPa, if the two steps agree."""
    steps: list[float] = []
    top = np.nan
    for block in re.split(r"\n(?= displacements| stresses)", "\n" + text):
        rows = [line.split() for line in block.splitlines()[2:] if line.strip()]
        if block.startswith(" displacements"):
            steps.append(float(rows[0][2]) + overlap)
        elif block.startswith(" stresses"):
            # Cell, integration point, σxx, σyy, ...
            top = float(np.mean([float(row[3]) for row in rows]))
    if len(steps) < 2 or abs(steps[-2] / steps[-1] - 1) > SETTLED:
        raise RuntimeError(f"CalculiX has not settled: its steps give {steps} mm")
    return steps[-1], -top


def deck(setup: Setup, dR: float, load: float, mesh: Mesh, overlap: float) -> str:
    """Return one case as an input deck, the pin moved by `overlap` mm into the plate."""
    shift, cells = len(mesh.plate.points), len(mesh.plate.quads)
    on_hole, on_pin = (
        _faces(body, body.surface[: mesh.pairs.count]) for body in (mesh.plate, mesh.pin)
    )
    points = np.vstack([mesh.plate.points, mesh.pin.points + np.array([0.0, overlap])])
    lines = [
        "*NODE,NSET=NODES",
        # CalculiX reads up to 20 characters of a number.
        *(f"{i},{x:.12e},{y:.12e},0." for i, (x, y) in enumerate(points, start=1)),
        *_cells("PLATE", *setup.equivalent("plate"), mesh.plate.quads + 1, 1),
        *_cells("PIN", *setup.equivalent("pin"), mesh.pin.quads + 1 + shift, 1 + cells),
        "*SURFACE,NAME=HOLE,TYPE=ELEMENT",
        *(f"{cell + 1},S{side + 1}" for cell, side in on_hole),
        "*SURFACE,NAME=FACE,TYPE=ELEMENT",
        *(f"{cell + 1 + cells},S{side + 1}" for cell, side in on_pin),
        "*SURFACE INTERACTION,NAME=CONTACT",
        "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR",
        f"{STIFFNESS:.6e}",
        "*CONTACT PAIR,INTERACTION=CONTACT,TYPE=SURFACE TO SURFACE",
        "FACE,HOLE",
        "*BOUNDARY",
        *(f"{node + 1},1,2" for node in clamped_nodes(setup, mesh)),
        *(f"{node + 1},1,1" for node in mesh.plate.axis),
        *(f"{node + 1 + shift},1,1" for node in mesh.pin.axis),
        "*NSET,NSET=CENTRE",
        str(mesh.centre + 1 + shift),
        "*ELSET,ELSET=TOP",
        f"{on_hole[0][0] + 1},{on_pin[0][0] + 1 + cells}",
    ]
    shares = enumerate(load / 2 * node_shares(setup, dR, mesh), start=1 + shift)
    loads = "".join(f"{node},2,{share:.12e}\n" for node, share in shares if share)
    text = "\n".join(lines) + "\n"
    return text + STEP.format(loads="*CLOAD\n" + loads) + STEP.format(loads="")


def _cells(name: str, E: float, nu: float, quads: np.ndarray, first: int) -> Iterator[str]:
    """Yield cells, numbered from `first`, section and material of a body."""
    yield f"*ELEMENT,TYPE={'CPE4R' if nu > LOCKS_FROM else 'CPE4'},ELSET={name}"
    yield from (f"{i},{a},{b},{c},{d}" for i, (a, b, c, d) in enumerate(quads, start=first))
    yield from (f"*MATERIAL,NAME={name}", "*ELASTIC", f"{E:.12e},{nu:.12e}")
    yield from (f"*SOLID SECTION,ELSET={name},MATERIAL={name}", "1.")


def _faces(body: Body, surface: np.ndarray) -> list[tuple[int, int]]:
    """Return cell and side of each face between neighbouring nodes of a surface, in order."""
    position = np.full(len(body.points), -1)
    position[surface] = np.arange(surface.size)
    ends = np.stack([position[body.quads], position[np.roll(body.quads, -1, axis=1)]])
    cells, sides = np.nonzero(ends.min(axis=0) >= 0)
    order = np.argsort(ends.min(axis=0)[cells, sides])
    return list(zip(cells[order].tolist(), sides[order].tolist(), strict=True))


if __name__ == "__main__":
    main()
