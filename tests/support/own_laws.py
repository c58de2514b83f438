"""Functions of a user's own, as laws: names that other languages have, letters of other scripts."""

from numpy import log1p, maximum, where


def awkward(penetration, pair, double=1.2, γ=0.3, End=2.0, end=0.5):  # noqa: PLC2401
    load = penetration / pair.dR
    stiffness = double * pair.E_star
    inside = where(load < γ, load, γ)
    S = log1p(inside) * End
    s = maximum(load - end, 0)
    return stiffness * (S + s + load) * pair.dR


def looped(penetration, pair, n=1.3):
    """Loops in loops, whose numbers divide each other."""
    x = penetration / pair.dR
    total, slope = 0.0, 0.0
    for j in range(5, 2, -1):
        share = 1.0 / j
        for i in range(1, 3):
            total = total + n * share * i / j * x
        slope = slope + share
    f = pair.E_star * pair.dR * (x + total * x + slope * x)
    return f, pair.E_star * (1 + 2 * total + slope)


def untranslatable(penetration, pair, n=1.5):
    return pair.E_star * abs(penetration) ** n
