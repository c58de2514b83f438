"""Fig 14 again, for aluminium alloy, with the coefficients refitted here."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.maps import refit_map


def draw(bench: Bench) -> Drawing:
    return refit_map(bench.material("aluminium alloy"), bench.result("internal"))
