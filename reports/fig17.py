"""Fig 17: contact force against penetration over an impact, for three laws and two clearances."""

from cylcontact.mechanism import Case
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.disclosure import assumed, law_ends
from cylcontact.reports.mechanism.hysteresis import (
    crossings,
    force_ratio,
    impact_panels,
    impact_table,
)
from cylcontact.reports.mechanism.runs import CLEARANCES, LAW_NAMES, mechanism, simulated

CASES = [Case(law, clearance, 0.9, 0.0) for clearance in CLEARANCES for law in LAW_NAMES]
CAPTION = (
    "Contact force against penetration over the first impact of the slider-crank, without friction "
    "and with c_e = 0.9; before it the runs are alike, so that all laws meet the same impact, and "
    "it is the hardest of the start: {impacts}. Upper branch: approach; lower: return; thin: the "
    "law without dissipation. Markers at quarters of the largest penetration. Johnson over "
    "enhanced, at equal penetration: {crossed}. The loads, over 10 mm of length, go up to "
    "{top:.0f} N/mm, beyond the 1000 N/mm that the enhanced law is fitted to. Which impact the "
    "paper draws is not said; this one is our choice. {ends} {assumed}"
)


def draw(bench: Bench) -> Drawing:
    runs = {case: simulated(bench, case, 1) for case in CASES}
    table = impact_table(runs)
    headline, crossed, impacts = {}, [], []
    for clearance, rows in table.groupby("clearance_mm", sort=False):
        case = Case("johnson", clearance, 0.9, 0.0)
        speed = runs[case].contacts.loc[0, "impact_rate_m_per_s"]
        impacts.append(f"{speed:.3g} m/s at {clearance:g} mm")
        pair = runs[case].mechanism.clearance.pair
        deepest = rows.loc[rows["law"] == case.law, "penetration_um"].max() * 1e-3
        even = crossings(force_ratio("johnson", "enhanced", pair, deepest))
        crossed.append(f"stiffer from {1e3 * even[-1]:.3g} µm on at {clearance:g} mm")
        headline[f"{clearance:g} mm, Johnson stiffer than enhanced from, um"] = 1e3 * even[-1]
        for law, loop in rows.groupby("law", sort=False):
            headline[f"{clearance:g} mm, {law}: penetration, um"] = loop["penetration_um"].max()
            headline[f"{clearance:g} mm, {law}: force, N"] = loop["force_N"].max()
    caption = CAPTION.format(
        impacts=", ".join(impacts),
        crossed=", ".join(crossed),
        top=table["force_N"].max() / 10,
        ends=law_ends(list(runs.values())),
        assumed=assumed(mechanism(bench)),
    )
    return Drawing(impact_panels(table, CLEARANCES), table, headline, caption)
