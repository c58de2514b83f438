"""The energy balance of the slider-crank: the ledgers of one run, the errors of all cases."""

from cylcontact.mechanism import Case
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.disclosure import assumed
from cylcontact.reports.mechanism.energy import energy_panels, energy_table
from cylcontact.reports.mechanism.runs import REVOLUTIONS, mechanism, simulated, statistics_table

CASE = Case("enhanced", 0.5, 0.9, 0.1)
SHOWN = 3
BOUND = 1e-5
CAPTION = (
    "(a) Energies (J) of the slider-crank since its start, over {shown} revolutions with the "
    "enhanced law at 0.5 mm, c_e = 0.9 and c_f = 0.1: the drive's work and both losses are "
    "integrated with the motion. (b) The largest error of the balance (kinetic and elastic energy, "
    "less the drive's work, plus the losses) over {revolutions} revolutions or more, relative to "
    "the peak of the kinetic energy, {peak:.3g} J, for three laws and eight cases at a tolerance "
    "of {tolerance:g}; dotted: the bound that we set, {bound:g}. {assumed}"
)


def draw(bench: Bench) -> Drawing:
    run = simulated(bench, CASE, SHOWN)
    cases = statistics_table(bench)
    table = energy_table(run)
    headline = {
        "largest error over the peak of the kinetic energy, -": cases["energy_error"].max(),
        "drive's work per revolution, J": run.drive_work[-1] / SHOWN,
        "lost in the normal force per revolution, J": run.normal_dissipation[-1] / SHOWN,
        "lost in friction per revolution, J": run.friction_dissipation[-1] / SHOWN,
        "peak of the kinetic energy, J": run.kinetic_energy.max(),
    }
    one = mechanism(bench)
    caption = CAPTION.format(
        shown=SHOWN,
        revolutions=REVOLUTIONS,
        peak=run.kinetic_energy.max(),
        tolerance=one.integration.tolerance,
        bound=BOUND,
        assumed=assumed(one),
    )
    return Drawing(energy_panels(table, cases, BOUND), table, headline, caption)
