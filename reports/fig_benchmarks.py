"""The workbench against what one would use instead, from datasets/benchmarks.json."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.benchmarks import GROUPS, left_out, ratio_panel, ratios_of

CAPTION = (
    "Time that others take, in units of the workbench's on the same task with the same answer "
    "(-, logarithmic). Markers: median of the rounds; bars: their quartiles. Computed, marked by "
    "open circles: the evaluations that the optimiser needed on a small grid times the measured "
    "cost of one on this grid. The power and the logarithm do less than the workbench: they are "
    "limits. Measured by `make bench`; docs/speed.md has the numbers, the machine and the versions."
)


def draw(bench: Bench) -> Drawing:
    table = ratios_of(bench.input("datasets/benchmarks.json"))
    headline = {
        f"{group}: {row.side}": float(row.ratio)
        for group in GROUPS
        for row in table[table["group"] == group].itertuples()
    }
    return Drawing(ratio_panel(table), table, headline, CAPTION + left_out(table))
