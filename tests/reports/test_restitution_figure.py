"""The figure of hysteresis factors: its table against the energy balance, and its lines."""

import numpy as np
import pytest
from _cylcontact_bench.fig_restitution import LABELS, WANTED
from mpmath import mp

from cylcontact.impact import FACTORS


@pytest.fixture(scope="module")
def drawing(figures):
    return figures["fig_restitution"].drawing


def test_the_table_holds_every_factor_at_every_tenth(drawing):
    table = drawing.table
    assert list(table.columns) == [
        "factor",
        "wanted_restitution",
        "chi",
        "achieved_restitution",
        "error",
    ]
    wanted = table.groupby("factor", sort=False)["wanted_restitution"].apply(list)
    assert list(wanted.index) == list(FACTORS)
    assert all(values == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0] for values in wanted)


def test_every_row_obeys_the_energy_balance(drawing):
    """The work of the load over an impact: ∫ u/(1 + χu) du from −e to 1 vanishes."""
    for row in drawing.table.itertuples():
        out, back = (
            float(mp.quad(lambda u, chi=row.chi: u / (1 + chi * u), ends))
            for ends in ((0, 1), (-row.achieved_restitution, 0))
        )
        assert out == pytest.approx(-back, rel=1e-12)


def test_only_the_exact_factor_achieves_what_is_wanted(drawing):
    table = drawing.table
    error = table["achieved_restitution"] - table["wanted_restitution"]
    np.testing.assert_allclose(table["error"], error, rtol=0, atol=1e-12)
    worst = table.groupby("factor")["error"].apply(lambda error: error.abs().max())
    assert worst["exact"] == 0
    assert (worst.drop("exact") > 0.03).all()


def test_each_published_factor_is_drawn_once_and_marked_at_the_tables_values(drawing):
    lines = {}
    for axes in drawing.figure.axes[:2]:
        lines |= {line.get_label(): line for line in axes.get_lines()}
    rows = drawing.table.set_index("factor")
    assert set(LABELS) == set(FACTORS) - {"exact"}
    assert set(lines) == {*LABELS.values(), "wanted (exact factor)"}
    for name, label in LABELS.items():
        start, step = lines[label].get_markevery()
        np.testing.assert_array_equal(lines[label].get_xdata()[start::step], WANTED)
        drawn = lines[label].get_ydata()[start::step]
        np.testing.assert_array_equal(drawn, rows.loc[name, "achieved_restitution"])


def test_lines_of_one_panel_differ_in_colour_and_marker(drawing):
    for axes in drawing.figure.axes[:2]:
        published = [line for line in axes.get_lines() if line.get_label() in LABELS.values()]
        for look in ("get_color", "get_marker"):
            assert len({getattr(line, look)() for line in published}) == len(published) == 4
