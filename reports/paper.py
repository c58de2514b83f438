"""Numbers of the paper that several figures and claims need.

C. Pereira, A. Ramalho and J. Ambrósio, An enhanced cylindrical contact force model, Multibody
System Dynamics (2015), doi:10.1007/s11044-015-9463-x.
"""

from __future__ import annotations

from pathlib import Path

from cylcontact.bodies.material import Material, known_materials
from cylcontact.support.errors import InputError

# Figs 10 to 14, in their order.
NAMES = (
    "ceramics",
    "high-strength steel",
    "low-carbon steel",
    "titanium alloy",
    "aluminium alloy",
)
MATERIALS = {name: Material.named(name) for name in NAMES}
STEEL = Material("steel of Figs 2 and 6", E=207e3, nu=0.3)
RADII = (100.0, 10.0, 5.0)  # mm, R_i of Figs 7 and 9
LOADS = (10.0, 1000.0)  # N/mm, Figs 10 to 14
CLEARANCES = (0.0075, 2.0)  # mm, Figs 10 to 14
FITTED_FROM = 0.05  # mm, where the paper's fit for a pin in a hole begins
JOHNSON_LIMITS = {  # N/mm by material and ΔR in mm, as printed in Section 3.4
    ("aluminium alloy", 0.0075): 494,
    ("aluminium alloy", 0.010): 658,
    ("titanium alloy", 0.0075): 865,
}


def material_of(name: str) -> Material:
    """Return a material that ships, or one of the folder's own table."""
    own = Path("datasets/materials.csv")
    rows = known_materials(own if own.is_file() else None)
    if name not in rows:
        remedy = f"add it to {own}, or choose {', '.join(rows)}"
        raise InputError(str(own), "name", name, "no material has this name", remedy)
    return rows[name].material
