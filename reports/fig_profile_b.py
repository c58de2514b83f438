"""How sharply the external fit determines b: the objective with the others re-optimised."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.fit_figures import profile_drawing


def draw(bench: Bench) -> Drawing:
    return profile_drawing(bench.result("external"), "b", "$b$ (mm$^{2-n}$)")
