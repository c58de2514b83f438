"""Hypothesis strategies for materials, pairs and points of a law's domain."""

import numpy as np
from hypothesis import strategies as st

from cylcontact import CylinderPair, Material

# Half a unit in the last place at 1: the relative error of one correctly rounded operation.
ROUNDING = 2.0**-53

# Loads of bodies that do not touch, or that are not known.
NOT_TOUCHING = (-1.0, -1e-300, -np.inf, np.nan)


def powers_of_ten(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers between 10^low and 10^high, log-uniform rather than uniform."""
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


moduli = powers_of_ten(3, 7)
ratios = st.floats(0.0, 0.5)
gaps = powers_of_ten(-3, 3)
loads = powers_of_ten(-3, 5)
materials = st.builds(Material, st.just("any"), E=moduli, nu=ratios)
pairs = st.builds(CylinderPair.from_dR, st.sampled_from(["internal", "external"]), gaps, materials)

# Parts of the way to a limit: anywhere, close to nothing, close to the limit.
fractions = st.one_of(
    st.floats(1e-300, 1.0),
    powers_of_ten(-300, 0),
    powers_of_ten(-16, -1).map(lambda short: 1.0 - short),
)
