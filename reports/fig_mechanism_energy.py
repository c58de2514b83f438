"""The energy balance of the slider-crank: the ledgers of one run, the errors of all cases."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.mechanism import Case, Trajectory
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.reports.bench import Bench

from .fig_mechanism_cases import balance_panel
from .long_runs import FEW, FIRST, statistics_table
from .slider_crank import assumed, mechanism, simulated

CASE = Case("enhanced", 0.5, 0.9, 0.1)
DRAWN = 3  # revolutions
BOUND = 1e-5
CAPTION = (
    "(a) Energies (J) of the slider-crank since its start, over {drawn} revolutions with the "
    "enhanced law at 0.5 mm, c_e = 0.9 and c_f = 0.1: the drive's work and both losses are "
    "integrated with the motion. (b) The largest error of the balance (kinetic and elastic energy, "
    "less the drive's work, plus the losses) over {revolutions} revolutions or more, relative to "
    "the peak of the kinetic energy, {peak:.3g} J, for three laws and eight cases at a tolerance "
    "of {tolerance:g}; dotted: the bound that we set, {bound:g}. {assumed}"
)
# Rows of the table for each revolution.
POINTS = 180
LEDGERS = {
    "kinetic_J": "kinetic, less that at the start",
    "drive_work_J": "work of the drive",
    "normal_dissipation_J": "lost in the normal force",
    "friction_dissipation_J": "lost in friction",
}


def draw(bench: Bench) -> Drawing:
    run = simulated(bench, CASE, DRAWN)
    cases = statistics_table(bench)
    table = _energies(run)
    headline = {
        "largest error over the peak of the kinetic energy, -": cases["energy_error"].max(),
        "drive's work per revolution, J": run.drive_work[-1] / DRAWN,
        "lost in the normal force per revolution, J": run.normal_dissipation[-1] / DRAWN,
        "lost in friction per revolution, J": run.friction_dissipation[-1] / DRAWN,
        "peak of the kinetic energy, J": run.kinetic_energy.max(),
    }
    slider_crank = mechanism(bench)
    caption = CAPTION.format(
        drawn=DRAWN,
        revolutions=FIRST + FEW,
        peak=run.kinetic_energy.max(),
        tolerance=slider_crank.integration.tolerance,
        bound=BOUND,
        assumed=assumed(slider_crank),
    )
    return Drawing(_draw_panels(table, cases), table, headline, caption)


def _energies(run: Trajectory) -> pd.DataFrame:
    """Return the energies of a run at the steps nearest after evenly spaced times."""
    times = np.linspace(0, run.revolutions, POINTS * run.revolutions + 1)
    rows = np.minimum(np.searchsorted(run.revolution, times), run.time.size - 1)
    return pd.DataFrame(
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


def _draw_panels(table: pd.DataFrame, cases: pd.DataFrame) -> Figure:
    """Draw the ledgers of one run beside the errors of all."""
    figure = new_figure("full", 74.0)
    left, right = figure.subplots(1, 2)
    _draw_ledgers(left, table)
    panel_title(left, 0, "since the start")
    balance_panel(right, cases, BOUND)
    panel_title(right, 1, "error over the peak of the kinetic energy")
    right.legend(loc="upper left", bbox_to_anchor=(0.0, 0.93), handlelength=1.2)
    return figure


def _draw_ledgers(axes: Axes, table: pd.DataFrame) -> None:
    """Draw each ledger against time."""
    for number, (column, name) in enumerate(LEDGERS.items()):
        every = (20 + 30 * number, 120)
        axes.plot(table["revolution"], table[column], label=name, markevery=every)
    axes.set(xlabel="time (revolutions of the crank)", ylabel="energy (J)")
    axes.set_xlim(0, table["revolution"].max())
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.45 * (high - low))
    axes.legend(loc="upper left", ncols=1)
