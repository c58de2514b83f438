"""Fig 18: the journal's centre in its bearing at a clearance of 0.5 mm, three laws, four cases."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.path_drawing import path_drawing


def draw(bench: Bench) -> Drawing:
    return path_drawing(bench, clearance=0.5, revolutions=3)
