"""Contact of parallel cylinders: laws, checks of joints, fits to measurements, export."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cylcontact import laws, limits
    from cylcontact.bodies import iso286
    from cylcontact.bodies.material import Material
    from cylcontact.bodies.pair import CylinderPair
    from cylcontact.fitting import choose, fit
    from cylcontact.impact import dissipation, friction
    from cylcontact.joint.check import check_joint
    from cylcontact.laws import ContactLaw
    from cylcontact.limits import sizing
    from cylcontact.support.errors import InputError

__all__ = [
    "ContactLaw",
    "CylinderPair",
    "InputError",
    "Material",
    "check_joint",
    "choose",
    "datasets",
    "dissipation",
    "export",
    "fit",
    "fitting",
    "friction",
    "iso286",
    "joint",
    "laws",
    "limits",
    "mechanism",
    "plots",
    "reports",
    "sizing",
]
__version__ = "1.0.0"

# Where the names are that are no modules. All are loaded on first use, so that a command which
# needs no numbers begins at once.
_IN = {
    "ContactLaw": "laws",
    "CylinderPair": "bodies.pair",
    "InputError": "support.errors",
    "Material": "bodies.material",
    "check_joint": "joint.check",
    "choose": "fitting",
    "fit": "fitting",
}
# Modules of a package that the public face shows at its top.
_DEEPER = {
    "dissipation": "impact.dissipation",
    "iso286": "bodies.iso286",
    "friction": "impact.friction",
    "sizing": "limits.sizing",
}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'cylcontact' has no attribute {name!r}")
    if name in _IN:
        value = getattr(import_module(f"cylcontact.{_IN[name]}"), name)
    else:
        value = import_module(f"cylcontact.{_DEEPER.get(name, name)}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
