"""The paper's equations, written out once more for tests that compute its numbers again.

Nothing here calls the package. Lengths in mm, moduli and stresses in MPa, loads in N/mm; values
may be arrays.
"""

import numpy as np

# Where Eq 6 changes its branch of Y.
SWITCH = 0.34954


def e_star(E, nu):
    """E* of two bodies of one material."""
    return E / (2 * (1 - nu**2))


def johnson(load, E_star, dR):
    """Eq 1, which gives the penetration under a load."""
    return load / (np.pi * E_star) * (np.log(4 * np.pi * E_star * dR / load) - 1)


def johnson_end(E_star, dR):
    """Eq 8, the largest load of Eq 1."""
    return 4 * np.pi * E_star * dR / np.e**2


def factor_and_exponent(E_star, dR, contact="internal"):
    """K and n of Eqs 5 and 6."""
    if contact == "external":
        return (0.39 * dR + 0.85) * E_star / dR, 1.094
    Y = np.where(dR < SWITCH, 1.51 * np.log(1000 * dR) ** -0.151, 0.0151 * dR + 1.151)
    return (0.965 * dR + 0.0965) * E_star / dR, Y * dR**-0.005


def enhanced(load, E_star, dR, contact="internal"):
    """Eqs 5 and 6, solved for the penetration."""
    K, n = factor_and_exponent(E_star, dR, contact)
    return (load / K) ** (1 / n)


def difference(load, E_star, dR):
    """Eq 9 in percent."""
    return 100 * (enhanced(load, E_star, dR) / johnson(load, E_star, dR) - 1)


def effective_radius(R_i, dR):
    """R_i·R_j/ΔR of a pin in a hole."""
    return R_i * (R_i - dR) / dR


def yield_load(stress, E_star, R):
    """Eq 7, solved for the load at the yield stress."""
    return np.pi * stress**2 * R / E_star


def power_fit(loads, E_star, dR):
    """K and n of the least-squares line through Eq 1 in logarithms."""
    loads = np.asarray(loads, dtype=float)
    x, y = np.log(johnson(loads, E_star, dR)), np.log(loads)
    n = ((x - x.mean()) * (y - y.mean())).sum() / ((x - x.mean()) ** 2).sum()
    return np.exp(y.mean() - n * x.mean()), n
