"""Limits of a contact: first yield, and the end of Johnson's law."""

from cylcontact.limits.loads import (
    elastic_limit_clearance,
    first_yield,
    hertz_half_width,
    hertz_pressure,
    hertz_stress,
    johnson_limit_load,
    stress_at_johnson_limit,
    yield_load,
    yield_warning,
)
from cylcontact.limits.temperature import at_temperature, bore_expansion
from cylcontact.limits.yield_search import FirstYield

__all__ = [
    "FirstYield",
    "at_temperature",
    "bore_expansion",
    "elastic_limit_clearance",
    "first_yield",
    "hertz_half_width",
    "hertz_pressure",
    "hertz_stress",
    "johnson_limit_load",
    "stress_at_johnson_limit",
    "yield_load",
    "yield_warning",
]
