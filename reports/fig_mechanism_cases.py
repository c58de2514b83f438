"""Contact, impacts and steps of the slider-crank, for three laws and eight cases, with scatter."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.case_panels import case_panels
from cylcontact.reports.mechanism.disclosure import assumed
from cylcontact.reports.mechanism.runs import (
    FIRST,
    REVOLUTIONS,
    WHIRLING_REVOLUTIONS,
    mechanism,
    statistics_table,
)

COLUMNS = {
    "law": "law",
    "clearance": "clearance_mm",
    "restitution": "restitution",
    "friction": "friction",
    "contact_fraction": "contact_fraction",
    "contact_fraction_std": "contact_fraction_std",
    "impacts": "impacts",
    "impacts_std": "impacts_std",
    "step_us": "step_us",
    "step_us_std": "step_us_std",
    "mean_penetration_um": "mean_penetration_um",
    "max_penetration_um": "max_penetration_um",
    "force_p99_N": "force_p99_N",
    "onsets": "onsets",
    "continued": "continued",
    "left": "left",
}
CAPTION = (
    "Share of the time in contact, impacts per revolution and the integrator's mean step of the "
    "slider-crank, by radial clearance (mm), restitution c_e and friction c_f, for three laws. "
    "Markers: means over revolutions {first} to {last} of one run (to {long} where the journal can "
    "whirl, at 0.02 mm with c_e = 1 and c_f = 0.1); bars: standard deviation from revolution to "
    "revolution. Runs with impacts are sensitive to everything, so that only "
    "such statistics can be compared. Johnson's law goes on along its tangent from 0.9 of its "
    "largest penetration: {continued:.0f} of {onsets:.0f} of its contacts, {left:.0f} of them "
    "beyond its end, all at 0.02 mm without dissipation. {assumed}"
)


def draw(bench: Bench) -> Drawing:
    table = statistics_table(bench)
    johnson = table[table["law"] == "johnson"]
    headline = {
        f"{row.law}, {row.clearance:g} mm, c_e = {row.restitution:g}, c_f = {row.friction:g}: "
        f"{name}": getattr(row, column)
        for row in table.itertuples()
        for column, name in (
            ("contact_fraction", "share of time in contact, -"),
            ("impacts", "impacts per revolution, -"),
        )
    }
    caption = CAPTION.format(
        first=FIRST + 1,
        last=REVOLUTIONS,
        long=WHIRLING_REVOLUTIONS,
        continued=johnson["continued"].sum(),
        onsets=johnson["onsets"].sum(),
        left=johnson["left"].sum(),
        assumed=assumed(mechanism(bench)),
    )
    shown = table[list(COLUMNS)].rename(columns=COLUMNS)
    return Drawing(case_panels(table), shown, headline, caption)
