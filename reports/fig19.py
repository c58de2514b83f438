"""Fig 19: the journal's centre in its bearing at a clearance of 0.02 mm, three laws, four cases."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.path_drawing import path_drawing


def draw(bench: Bench) -> Drawing:
    return path_drawing(bench, clearance=0.02, revolutions=1)
