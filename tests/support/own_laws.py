"""Functions of a user's own, as laws."""

import numpy as np


def power(penetration, E_star, dR, K=0.4, n=1.2):
    """Return C·E*·ΔR·(δ/ΔR)ⁿ."""
    return K * E_star * dR * (penetration / dR) ** n


def harder(x, factor):
    """Return x and what grows faster."""
    return x + factor * np.log1p(x) * x


def looped(penetration, E_star, dR, R_i, R_j, K=0.4, soft=0.3):
    """Return a load with a helper, loops, choices and all that a pair has."""
    x = penetration / dR
    total = 0.0
    for j in range(5, 2, -1):
        for i in range(1, 3):
            total = total + K * i / j
    # Softer up to a tenth of the clearance.
    share = np.where(x < 0.1, 1 - soft * (0.1 - x), 1.0)
    return E_star * np.sqrt(R_i * R_j) * harder(np.maximum(x, 0.0), total) * share


def untranslatable(penetration, E_star, n=1.5):
    """Return a load that other languages have not."""
    return E_star * np.tanh(penetration) ** n


def double(penetration, E_star, n=1.5):
    """Return a load by a name that C has for something else."""
    return E_star * penetration**n


def cased(penetration, E_star, K=1.0, k=0.5):
    """Return a load of names that Fortran takes for one."""
    return E_star * penetration * (K + k)


def awkward(penetration, E_star, γ=1.0):  # noqa: PLC2401
    """Return a load of a name that is not ASCII."""
    return γ * E_star * penetration
