"""Calibrate explicit contact laws for parallel cylinders, and see where each can be trusted."""

from cylcontact import dissipation, friction, laws, limits
from cylcontact.errors import InputError
from cylcontact.laws import ContactLaw
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair

__all__ = [
    "ContactLaw",
    "CylinderPair",
    "InputError",
    "Material",
    "dissipation",
    "friction",
    "laws",
    "limits",
]
__version__ = "0.1.0"
