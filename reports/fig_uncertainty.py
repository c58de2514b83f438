"""How sure two coefficients are together: noise of measured data beside discrepancy of laws."""

from cylcontact.fitting.calibrate import calibrate
from cylcontact.fitting.planning import read_plan
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.pair_maps import uncertainty_drawing


def draw(bench: Bench) -> Drawing:
    measured = calibrate(read_plan(bench.input("fitting/examples/pin-in-hole.toml")))
    labels = (r"$\kappa$ (-)", "$c$ (-)", "$b$ (mm$^{2-n}$)", "$n$ (-)")
    return uncertainty_drawing(measured, bench.result("external"), ("b", "n"), labels)
