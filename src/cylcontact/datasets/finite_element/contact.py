"""Frictionless contact of two surfaces, condensed to the pairs of nodes that may touch.

With the pin's centre at depth δ, forces λ ≥ 0 between pairs open them by Cλ, where C is the sum of
the compliances of both bodies. The applied load opens them by c·f. The gaps are

    g = g₀ + C·λ + c·f − δ·cos θ ≥ 0,    λ ≥ 0,    λᵀg = 0,    Σ λcos θ = f/2,

with half of the load f because the model is one half. For a given set of touching pairs this is a
small linear system. Pairs in tension are removed from the set and overlapping pairs are added,
until the set does not change.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.errors import InputError

__all__ = ["Condensed"]

# The set converges within about ten rounds on all meshes tried.
_ROUNDS = 100
# Touching pairs in the first guess.
_FIRST = 5


@dataclass(frozen=True, eq=False)
class Condensed:
    """The contact problem of one geometry.

    Attributes
    ----------
    compliance : array of float, shape (m, m)
        C in mm per N/mm.
    load_opening : array of float, shape (m,)
        c in mm per N/mm of the whole load.
    cosines : array of float, shape (m,)
        cos θ of the normals of the pairs.
    gap : array of float, shape (m,)
        g₀ in mm.
    """

    compliance: FloatArray
    load_opening: FloatArray
    cosines: FloatArray
    gap: FloatArray

    def touch(self, load: float, rounds: int = _ROUNDS) -> tuple[FloatArray, float]:
        """Return the forces λ of the pairs in N/mm and the penetration δ in mm.

        Raises
        ------
        InputError
            If the set of touching pairs does not settle, or reaches the last pair.

        Examples
        --------
        Two springs of 1 and 3 N/mm per mm side by side under 8 N/mm, half of which they carry:

        >>> springs = Condensed(np.diag([1.0, 1 / 3]), np.zeros(2), np.ones(2), np.zeros(2))
        >>> springs._system(np.array([True, True]), 8.0)[0].round(12)
        array([1., 3.])
        """
        active: BoolArray = np.arange(self.gap.size) < _FIRST
        opened = self.gap + self.load_opening * load
        for _ in range(rounds):
            forces, depth = self._system(active, load)
            gaps = opened + self.compliance @ forces - depth * self.cosines
            # The tolerance covers the rounding error of a closed gap.
            closed = gaps < -1e-9 * abs(depth)
            changed = np.where(active, forces > 0, closed)
            if np.array_equal(changed, active):
                break
            active = changed if changed.any() else ~active
        else:
            raise _unsettled(load, rounds)
        if active[-1]:
            raise InputError(
                "finite elements",
                "load",
                load,
                "presses the pin into contact up to the side of the hole, beyond the mesh's pairs",
                "lower the load, or raise dR or E",
            )
        return forces, depth

    def _system(self, active: BoolArray, load: float) -> tuple[FloatArray, float]:
        """Return forces and penetration if exactly the active pairs touch."""
        touching = np.flatnonzero(active)
        n = touching.size
        cosines = self.cosines[touching]
        matrix = np.zeros((n + 1, n + 1))
        matrix[:n, :n] = self.compliance[np.ix_(touching, touching)]
        matrix[:n, n] = matrix[n, :n] = -cosines
        right = np.append(-(self.gap + self.load_opening * load)[touching], -load / 2)
        solution = np.linalg.solve(matrix, right)
        forces = np.zeros(active.size)
        forces[touching] = solution[:n]
        return forces, float(solution[n])


def _unsettled(load: float, rounds: int) -> InputError:
    """Return the error for a set that does not converge."""
    return InputError(
        "finite elements",
        "load",
        load,
        f"the set of touching pairs still changes after {rounds} rounds",
        "change the number of cells a little, or the clearance",
    )
