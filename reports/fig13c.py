"""Fig 13 again, for titanium alloy, refitted to Persson's solution and judged by it."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.maps import refit_map


def draw(bench: Bench) -> Drawing:
    return refit_map(
        bench.material("titanium alloy"), bench.result("conformal"), "refit to Persson"
    )
