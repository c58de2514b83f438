"""Fig 12: enhanced law against Johnson's for low-carbon steel, published coefficients."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.maps import published_map


def draw(bench: Bench) -> Drawing:
    return published_map(bench.material("low-carbon steel"))
