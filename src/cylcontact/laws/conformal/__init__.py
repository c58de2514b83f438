"""A pin in a hole of any two materials, in a plate or in a housing: the exact solution.

A pin (disk j) is pressed without friction into a hole of nearly its own radius R in an infinite
plate (i), and touches it from −ε to ε. Each takes the share w of the compliance (w_i + w_j = 1,
see `CylinderPair.shares`), and α = w_j − w_i and β are Dundurs' parameters. With φ = f/(E*·ΔR) and
d = δ/ΔR, pressure p in units of f/R, ψ = θ − s and Λ = −ln(2|sin(ψ/2)|), Michell's solution for
the disk and the infinite plate makes the condition of contact on |θ| < ε

    2∫p(s)·[cos ψ·Λ(ψ) + β|sin ψ|(π − |ψ|)/2 − w_j/2]ds + K − (K + L − C)·cos θ = 0,

with K = π/φ and L = π·d/φ. The term of cos θ is a rigid displacement: **two-dimensional bodies have
no absolute approach**, and C is the choice of a datum. The operator 1 + d²/dθ² removes cos θ and
leaves the equation that `series` solves, with 2Â = K + w_i·H and H = ∫p dθ. Then

    K = 2Â − w_i·H,    L = M − w_j·H + C,

and 2Â, H and M depend on ε and β alone: **α enters linearly**. For β = 0, with S = sin²(ε/2) and
c = 1 − S, they are

    2Â = c²/S,    H = 2S − c²·ln(c)/S,    M = −ln S + S²/2 + H,

and the pressure is that of Persson (On the Stress Distribution of Cylindrical Elastic Bodies in
Contact, Chalmers 1964; see Ciavarella and Decuzzi, Int. J. Solids Struct. 38 (2001) 4507–4523) at
the same ε. With y = tan(θ/2), b = tan(ε/2), B² = 1 + b² and s² = b² − y²

    R·p/f = 2s/(πB(1 + y²)) + ln((B + s)/(B − s))/(2π·b²B²).

For equal materials w_i = 1/2, and K vanishes where 2 − 2b⁴ = ln(1 + b²), at 84.83°: no load makes
the arc larger.

**Reciprocity.** The kernel is symmetric, so a change of the arc does the same work on the pressure
and the change of the pressure on the displacement: dL = −(1 − H)·dK − K·dH. M therefore follows
from 2Â and H without a quadrature of the logarithmic kernel.

**The curve.** At fixed α, β, datum and housing, φ and d are one curve. `series` solves the equation
for arcs, `arcs` seeks the arc of a load or a penetration, `curve` makes tables of them once, `many`
seeks the arcs of many joints in compiled code, `housings` has the compliance of a ring or an eye,
and `law` is what users call.
"""

from cylcontact.laws.conformal.housings import Housing, Sector
from cylcontact.laws.conformal.law import (
    Conformal,
    ContactState,
    Persson,
    persson_pressure,
    pressure,
)

__all__ = [
    "Conformal",
    "ContactState",
    "Housing",
    "Persson",
    "Sector",
    "persson_pressure",
    "pressure",
]
