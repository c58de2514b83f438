"""Campaigns of the enhanced law, all coefficients free, on grids that a user might make."""

from cylcontact.fitting.campaign import Campaign

# E in GPa, ν, ΔR in mm, and the load in N/mm: first, last, number of points and spacing.
GRIDS = {
    "light alloys and steel": (
        ("internal", (60, 210, 4), (0.25, 0.35, 3), (0.02, 2, 21, "log"), (5, 500, 15, "log"))
    ),
    "the same, few points": (
        ("internal", (60, 210, 2), (0.25, 0.35, 2), (0.05, 1, 6, "log"), (10, 200, 4, "log"))
    ),
    "polymers": (
        ("internal", (1, 10, 4), (0.3, 0.45, 3), (0.05, 5, 31, "linear"), (1, 50, 10, "log"))
    ),
    "stiff, all clearances": (
        ("internal", (100, 400, 5), (0.2, 0.3, 2), (0.1, 9, 41, "log"), (10, 1000, 12, "log"))
    ),
    "close fits": (
        ("internal", (60, 210, 4), (0.25, 0.35, 3), (0.01, 0.2, 15, "linear"), (5, 100, 10))
    ),
    "external": (
        ("external", (60, 210, 4), (0.25, 0.35, 3), (5, 200, 21, "log"), (5, 500, 15, "log"))
    ),
}


def campaign_of(name, **genetic):
    contact, *axes = GRIDS[name]
    campaign = {"dataset": "inline", "law": "enhanced", "genetic": genetic}
    named = dict(zip(("E", "nu", "dR", "load"), map(axis_of, axes), strict=True))
    dataset = {"contact": contact, "reference": "johnson", "axes": named}
    return Campaign.of_settings(name, {"campaign": campaign, "dataset": dataset}, name)


def axis_of(axis):
    low, high, points, spacing = (*axis, "linear")[:4]
    return {"min": float(low), "max": float(high), "points": points, "spacing": spacing}
