"""The integrator's steps over one revolution, without losses and with both of them."""

import pandas as pd

from cylcontact.mechanism import Case
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.disclosure import assumed
from cylcontact.reports.mechanism.runs import CLEARANCES, mechanism, simulated
from cylcontact.reports.mechanism.steps import step_panels, step_table

REVOLUTION = 3
LOSSES = ((1.0, 0.0), (0.9, 0.1))
CASES = [Case("enhanced", c, *losses) for c in CLEARANCES for losses in LOSSES]
CAPTION = (
    "Accepted steps (µs) of the integrator, CVODE's Adams method at a tolerance of {tolerance:g}, "
    "over revolution {revolution} of the slider-crank with the enhanced law, by radial clearance "
    "(mm) and losses: without any, and with c_e = 0.9 and c_f = 0.1. Each onset and release of "
    "contact is found by root and followed by a short first step, which makes the combs. The "
    "paper's largest step is 100 µs. {assumed}"
)


def draw(bench: Bench) -> Drawing:
    runs = {case: simulated(bench, case, REVOLUTION + 1) for case in CASES}
    tables = {case: step_table(case, run, REVOLUTION) for case, run in runs.items()}
    headline = {}
    for case, table in tables.items():
        name = f"{case.clearance:g} mm, c_e = {case.restitution:g}, c_f = {case.friction:g}"
        headline[f"{name}: steps"] = float(len(table))
        for mode, steps in table.groupby("mode")["step_us"]:
            headline[f"{name}: mean step in {mode}, us"] = float(steps.mean())
    one = mechanism(bench)
    caption = CAPTION.format(
        tolerance=one.integration.tolerance, revolution=REVOLUTION + 1, assumed=assumed(one)
    )
    table = pd.concat(tables.values(), ignore_index=True)
    return Drawing(step_panels(tables), table, headline, caption)
