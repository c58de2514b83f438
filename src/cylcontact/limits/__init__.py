"""Limits of a contact: first yield, and the end of Johnson's law."""

from cylcontact.limits.loads import (
    elastic_limit_clearance,
    first_yield,
    first_yields,
    hertz_half_width,
    hertz_pressure,
    hertz_stress,
    johnson_limit_load,
    seat_opens,
    stress_at_johnson_limit,
    yield_load,
    yield_warning,
)
from cylcontact.limits.rings import AtRest, at_rest, at_temperature, loose_temperatures
from cylcontact.limits.yield_search import FirstYield

__all__ = [
    "AtRest",
    "FirstYield",
    "at_rest",
    "at_temperature",
    "elastic_limit_clearance",
    "first_yield",
    "first_yields",
    "hertz_half_width",
    "hertz_pressure",
    "hertz_stress",
    "johnson_limit_load",
    "loose_temperatures",
    "seat_opens",
    "stress_at_johnson_limit",
    "yield_load",
    "yield_warning",
]
