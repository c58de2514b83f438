"""Run CalculiX on a deck and read its results."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.datasets.finite_element.calculix_deck import Deck, make_deck
from cylcontact.datasets.finite_element.cases import Case
from cylcontact.datasets.finite_element.setup import Setup
from cylcontact.errors import InputError
from cylcontact.tether import tethered

__all__ = ["SolverError", "find_program", "read_results", "run_case", "version"]

_PROGRAM = "ccx"
# Number of lines of a failed run in the error.
_TAIL = 12
# Largest relative difference between the two steps of a deck if contact has settled.
_SETTLED = 2e-4


class SolverError(Exception):
    """CalculiX returned no result for a case.

    Parameters
    ----------
    reason : str
        What happened, in a few words.
    lines : tuple of str
        The last lines of its output.
    """

    def __init__(self, reason: str, lines: tuple[str, ...] = ()) -> None:
        super().__init__(reason, lines)
        self.reason = reason
        self.lines = lines


def find_program() -> str:
    """Return the path of CalculiX.

    Raises
    ------
    InputError
        If it is not installed.
    """
    path = shutil.which(_PROGRAM)
    if path is None:
        raise InputError(
            "CalculiX",
            "",
            None,
            f"there is no program '{_PROGRAM}' on the path",
            "on Debian and Ubuntu: apt install calculix-ccx; or use --engine embedded",
        )
    return path


def version(program: str) -> str:
    """Return the version of CalculiX, such as "2.20", or "unknown"."""
    try:
        done = subprocess.run([program, "-v"], capture_output=True, text=True, check=False)
    except OSError:
        return "unknown"
    match = re.search(r"Version\s+(\S+)", done.stdout)
    return match[1] if match else "unknown"


def run_case(
    setup: Setup,
    dR: float,
    load: float,
    loads: FloatArray,
    program: str,
    scratch: Path | None = None,
) -> Case:
    """Solve one case with CalculiX.

    Parameters
    ----------
    setup : Setup
        The set-up.
    dR, load : float
        Clearance in mm and load in N/mm.
    loads : array of float
        All loads at this clearance, to which the mesh is adapted.
    program : str
        The path of CalculiX.
    scratch : path, optional
        Parent of its working folder; by default the folder for temporary files.

    Returns
    -------
    Case

    Raises
    ------
    SolverError
        If CalculiX fails, is killed, or does not settle.
    """
    mesh = setup.mesh(dR, loads)
    deck = make_deck(setup, dR, load, mesh)
    penetration, peak = read_results(_run_deck(deck, program, scratch), deck)
    return Case(dR, load, penetration, np.nan, peak, mesh.cells)


def _run_deck(deck: Deck, program: str, scratch: Path | None = None) -> str:
    """Run a deck in a temporary folder and return the text of its results.

    Raises
    ------
    SolverError
        If the program ends with an error, is killed, or writes no results.
    """
    with TemporaryDirectory(dir=scratch) as name:
        folder = Path(name)
        (folder / "case.inp").write_text(deck.text, encoding="ascii")
        # One thread: cases run in parallel, and the result does not depend on the machine.
        done = subprocess.run(
            tethered([program, "-i", "case"]),
            cwd=folder,
            env={**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_RESULTS": "1"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
        )
        lines = [line.strip() for line in done.stdout.splitlines() if line.strip()]
        last = tuple(lines[-_TAIL:])
        if done.returncode < 0:
            raise SolverError(f"was killed by signal {-done.returncode}", last)
        if done.returncode > 0:
            raise SolverError(f"ended with code {done.returncode}", last)
        results = folder / "case.dat"
        text = results.read_text(encoding="ascii", errors="replace") if results.exists() else ""
        if "displacements" not in text:
            raise SolverError("wrote no results", last)
        return text


def read_results(text: str, deck: Deck) -> tuple[float, float]:
    """Return the penetration in mm and the peak pressure in MPa.

    Raises
    ------
    SolverError
        If the two steps disagree.
    """
    steps: list[float] = []
    top = np.nan
    for block in re.split(r"\n(?= displacements| stresses)", "\n" + text):
        rows = [line.split() for line in block.splitlines()[2:] if line.strip()]
        if block.startswith(" displacements"):
            steps.append(float(rows[0][2]) + deck.overlap)
        elif block.startswith(" stresses"):
            # Cell, integration point, σxx, σyy, ...
            top = float(np.mean([float(row[3]) for row in rows]))
    if len(steps) < 2 or abs(steps[-2] / steps[-1] - 1) > _SETTLED:
        penetrations = ", ".join(f"{1e3 * step:.6g} µm" for step in steps)
        raise SolverError(f"has not settled: its steps give {penetrations}")
    return steps[-1], -top
