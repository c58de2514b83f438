"""What a contact does while it moves: dissipation and friction."""

from cylcontact.impact.dissipation import (
    FACTORS,
    IMPACT_RATE_FLOOR,
    RATIO_BEND,
    HysteresisFactor,
    achieved_restitution,
    bounded_ratio,
    dissipative_load,
    exact_factor,
    hysteresis_factor,
    lankarani_nikravesh,
)
from cylcontact.impact.friction import dynamic_correction, friction_load

__all__ = [
    "FACTORS",
    "IMPACT_RATE_FLOOR",
    "RATIO_BEND",
    "HysteresisFactor",
    "achieved_restitution",
    "bounded_ratio",
    "dissipative_load",
    "dynamic_correction",
    "exact_factor",
    "friction_load",
    "hysteresis_factor",
    "lankarani_nikravesh",
]
