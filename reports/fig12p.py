"""Fig 12 again, for low-carbon steel, with coefficients refitted in this very window."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.maps import refit_map


def draw(bench: Bench) -> Drawing:
    return refit_map(
        bench.material("low-carbon steel"), bench.result("practical"), "refit in this window"
    )
