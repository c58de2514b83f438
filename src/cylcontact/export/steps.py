"""The steps of each law, in the order in which the package computes them.

The order matters: an exported function agrees with the package to the last digits and leaves its
domain at the same number.
"""

from __future__ import annotations

POWER = """
f = factor * penetration ** n
k = n * (factor * penetration ** (n - 1))
"""

ENHANCED_INTERNAL = """
Y_log = Y_log_scale * log(1000 * dR) ** Y_log_exponent
Y = max(Y_log, Y_slope * dR + Y_offset)
n = Y * dR ** n_exponent
K_geometry = a * dR + b
factor = K_geometry * E_star / dR if K_geometry > 0 and n > 0 else nan
"""

ENHANCED_EXTERNAL = """
K_geometry = a * dR + b
factor = K_geometry * E_star / dR if K_geometry > 0 and n > 0 else nan
"""

# Lambert's W in the variables of laws/lambert.py. Every condition sends NaN to the regular case,
# and the regular case is kept away from p = 0 and p = 1.
LOGARITHMIC = """
f_max = ({reach}) * E_star * peak
compliance = kappa / (pi * E_star)
share = penetration / (compliance * f_max)
p = share if share <= 1 else nan
inner = 0.5 if p <= 0 or p >= 1 else p
g = -log(inner)
root = sqrt(g)
top = 0.3361 * sqrt(0.5) * root
bottom = 1 + -0.0042 * g * exp(-0.0201 * root)
start = g + 2 / 0.3361 * top / (bottom + top)
u = 1 + start
h = start - log1p(start) - g
h1 = start / u
h2 = 1 / (u * u)
h3 = -2 / (u * u * u)
above = 6 * (h1 * h1) - 3 * h * h2
below = 6 * (h1 * h1 * h1) - 6 * h * h1 * h2 + h * h * h3
w = 0 if p >= 1 else start - h * above / below
f = f_max * (p / (1 + w))
k = 0 if p <= 0 else 1 / (compliance * w)
"""

EXPLICIT = """
d = penetration / dR if penetration > 0 else 1
ratio = A / d
first = log(B / d)
second = c + log1p(ratio * first)
third = c + log1p(ratio * second)
second_slope = -(ratio * (first + 1)) / (1 + ratio * first)
third_slope = ratio * (second_slope - second) / (1 + ratio * second)
f = pi * E_star * penetration / third
k = pi * E_star * (1 - third_slope / third) / third if penetration > 0 else 0
"""

LIU = """
root = sqrt(penetration / (2 * (dR + penetration)))
f = pi / 2 * E_star * penetration * root
k = pi / 4 * E_star * root * (3 * dR + 2 * penetration) / (dR + penetration)
"""

LANKARANI_NIKRAVESH = """
factor = 4 / 3 * E_star * sqrt(R_i * R_j / dR) / length
"""

# x - sin x by its power series where the difference loses digits, as in laws/winkler.py.
WINKLER = """
d = penetration / dR
x = 2 * atan(sqrt(d) * sqrt(2 + d))
small = x if x < 1 else 1
square = small * small
s18 = 1 - square / 342
s16 = 1 - square / 272 * s18
s14 = 1 - square / 210 * s16
s12 = 1 - square / 156 * s14
s10 = 1 - square / 110 * s12
s8 = 1 - square / 72 * s10
s6 = 1 - square / 42 * s8
s4 = 1 - square / 20 * s6
excess = x * x * x / 6 * s4 if x < 1 else x - sin(x)
f = E_star * dR / depth * ((1 + d) * excess / 2)
k = E_star / depth * ((x + sin(x)) / 2)
"""
