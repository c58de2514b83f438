"""The energy balance of the slider-crank: the ledgers of one run, the errors of all cases."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.mechanism import Case
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import QUIET
from cylcontact.reports.bench import Bench

from .fig_mechanism_cases import draw_laws, law_key
from .long_runs import FEW, FIRST, statistics_table
from .slider_crank import RECOMMENDED, assumed, mechanism, simulated

CASE = Case(RECOMMENDED, 0.5, 0.9, 0.1)
DRAWN = 3  # revolutions
BOUND = 1e-5
CAPTION = (
    "(a, b) Energies of the slider-crank since its start (J): explicit law, radial clearance c = "
    "{clearance:g} mm, restitution c_e = {restitution:g}, friction coefficient c_f = "
    "{friction:g}. (c) Largest error of the energy balance over the peak of the kinetic energy, "
    "for four laws and eight cases; dotted: the bound set for it. The mechanism's data are "
    "assumed."
)
METHOD = (
    "The drive's work and both losses are integrated with the motion. The error of the balance is "
    "kinetic and elastic energy, less the drive's work, plus the losses. In (c) it is its largest "
    "value over {revolutions} revolutions or more at a tolerance of {tolerance:g}, relative to "
    "the peak of the kinetic energy: {peak:.3g} J for the run of (a), {start:.3g} J of it at the "
    "start. The bound is {bound:g}. {assumed}"
)
# Rows of the table for each revolution.
POINTS = 180
LEDGERS = (
    {"drive_work_J": "drive's work", "kinetic_J": "change of kinetic energy"},
    {"friction_dissipation_J": "in friction", "normal_dissipation_J": "in the normal force"},
)


def draw(bench: Bench) -> Drawing:
    run = simulated(bench, CASE, DRAWN)
    cases = statistics_table(bench)
    times = np.linspace(0, run.revolutions, POINTS * run.revolutions + 1)
    rows = np.minimum(np.searchsorted(run.revolution, times), run.time.size - 1)
    table = pd.DataFrame(
        {
            "revolution": run.revolution[rows],
            "kinetic_J": (run.kinetic_energy - run.kinetic_energy[0])[rows],
            "drive_work_J": run.drive_work[rows],
            "normal_dissipation_J": run.normal_dissipation[rows],
            "friction_dissipation_J": run.friction_dissipation[rows],
            "elastic_J": run.elastic_energy[rows],
            "error_J": run.energy_error[rows],
        }
    )
    headline = {
        "largest error over the peak of the kinetic energy, -": cases["energy_error"].max(),
        "drive's work per revolution, J": run.drive_work[-1] / DRAWN,
        "lost in the normal force per revolution, J": run.normal_dissipation[-1] / DRAWN,
        "lost in friction per revolution, J": run.friction_dissipation[-1] / DRAWN,
        "peak of the kinetic energy, J": run.kinetic_energy.max(),
    }
    slider_crank = mechanism(bench)
    method = METHOD.format(
        revolutions=FIRST + FEW,
        peak=run.kinetic_energy.max(),
        start=run.kinetic_energy[0],
        tolerance=slider_crank.integration.tolerance,
        bound=BOUND,
        assumed=assumed(slider_crank),
    )
    return Drawing(
        _draw_panels(table, cases), table, headline, CAPTION.format(**vars(CASE)), method
    )


def _draw_panels(table: pd.DataFrame, cases: pd.DataFrame) -> Figure:
    """Draw the energies of one run beside the errors of all."""
    figure = new_figure("full", 74.0)
    left, middle, right = figure.subplots(1, 3, width_ratios=(1, 1, 1.2))
    for number, (axes, ledgers) in enumerate(zip((left, middle), LEDGERS, strict=True)):
        _draw_ledgers(axes, table, ledgers)
        panel_title(axes, number, ("drive and motion", "losses")[number])
    draw_laws(right, cases, "energy_error")
    right.axhline(BOUND, color=QUIET, linewidth=0.8, linestyle=":", marker="")
    right.set(ylabel="largest error (-)", yscale="log", ylim=(1e-10, 1e-4))
    panel_title(right, 2, "error of the balance")
    law_key(figure, right, "no losses")
    return figure


def _draw_ledgers(axes: Axes, table: pd.DataFrame, ledgers: Mapping[str, str]) -> None:
    """Draw energies against time."""
    for number, (column, name) in enumerate(ledgers.items()):
        every = (20 + 60 * number, 120)
        axes.plot(table["revolution"], table[column], label=name, markevery=every)
    axes.set(xlabel="time (revolutions of the crank)", ylabel="energy (J)")
    axes.set_xlim(0, table["revolution"].max())
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2))
