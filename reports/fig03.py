"""Fig 3: the exponent of power laws fitted to Johnson's law, against ΔR, E and ν."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.arrays import FloatArray
from cylcontact.fitting.power_fit import fit_power
from cylcontact.laws import Enhanced
from cylcontact.materials import Material
from cylcontact.pair import Contact, CylinderPair
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_log, plain_number
from cylcontact.reports.bench import Bench

from .paper import TRAINING_DR, TRAINING_LOADS
from .power_fits import ends_spread, johnson_points

# The material about which ΔR, E and ν are varied one at a time.
E_GPA, NU = 207.0, 0.3


@dataclass(frozen=True)
class ExponentStudy:
    """One panel of Fig 3: the exponent of a power law fitted pair by pair.

    Attributes
    ----------
    contact : {"internal", "external"}
        Pin in hole, or two rollers.
    dR : array of float
        The values of ΔR in mm.
    ticks : tuple of float
        The values of ΔR that the axis labels.
    """

    contact: Contact
    dR: FloatArray
    ticks: tuple[float, ...]


def exponent_table(
    study: ExponentStudy, moduli: Sequence[float], ratios: Sequence[float], loads: FloatArray
) -> pd.DataFrame:
    """Fit a power law to Johnson's law pair by pair.

    Parameters
    ----------
    study : ExponentStudy
        The contact and the values of ΔR.
    moduli : sequence of float
        Young's moduli in GPa.
    ratios : sequence of float
        Poisson's ratios.
    loads : array of float
        Loads in N/mm; at each pair those beyond the law's domain are left out.

    Returns
    -------
    pandas.DataFrame
        Columns contact, E_GPa, nu, dR_mm, points (loads left), n, K_N_per_mm_n, R2.

    Examples
    --------
    >>> study = ExponentStudy("external", np.array([140.0]), (140.0,))
    >>> table = exponent_table(study, [207.0], [0.3], np.geomspace(10.0, 1000.0, 41))
    >>> print(table["n"].round(4).item())
    1.0805
    """
    rows = []
    for E, nu, dR in product(moduli, ratios, study.dR):
        pair = CylinderPair.from_dR(study.contact, dR, Material("any", E * 1e3, nu))
        inside, penetration = johnson_points(loads, pair)
        fit = fit_power(inside, penetration)
        rows.append((study.contact, E, nu, dR, inside.size, fit.n, fit.K, fit.r_squared))
    names = ("contact", "E_GPa", "nu", "dR_mm", "points", "n", "K_N_per_mm_n", "R2")
    return pd.DataFrame(rows, columns=names)


def exponent_panels(
    studies: Sequence[ExponentStudy],
    moduli: Sequence[float],
    ratios: Sequence[float],
    loads: FloatArray,
) -> tuple[Figure, pd.DataFrame]:
    """Draw n against ΔR: a line per modulus, the spread over ν, the published n.

    Parameters
    ----------
    studies : sequence of ExponentStudy
        One panel each.
    moduli : sequence of float
        Young's moduli in GPa, 207 among them.
    ratios : sequence of float
        Poisson's ratios, 0.3 among them.
    loads : array of float
        Loads in N/mm.

    Returns
    -------
    figure : matplotlib.figure.Figure
    table : pandas.DataFrame
        Those of `exponent_table`, one below the other.
    """
    figure = new_figure("full", 80.0)
    tables = [exponent_table(study, moduli, ratios, loads) for study in studies]
    panels = list(figure.subplots(1, len(studies), squeeze=False).flat)
    for number, (axes, study, table) in enumerate(zip(panels, studies, tables, strict=True)):
        _draw_moduli(axes, table)
        _draw_ratios(axes, table)
        _draw_published(axes, study)
        plain_log(axes, "x", study.ticks)
        axes.set(xlabel=r"$\Delta R$ (mm)", xlim=(study.dR[0], study.dR[-1]))
        panel_title(axes, number, f"{study.contact} contact")
    panels[0].set_ylabel("exponent $n$ (-)")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure, pd.concat(tables, ignore_index=True)


def exponent_spreads(table: pd.DataFrame) -> dict[str, float]:
    """Return how far n spreads over ΔR, E and ν, each varied alone, in percent of the mean.

    Parameters
    ----------
    table : pandas.DataFrame
        From `exponent_panels`.

    Returns
    -------
    dict
        For each contact the spread over ΔR (207 GPa, ν = 0.3), over E (ν = 0.3, the middle
        ΔR) and over ν (207 GPa, the middle ΔR).
    """
    spreads = {}
    for contact, fits in table.groupby("contact", sort=False):
        middle = fits["dR_mm"].unique()[fits["dR_mm"].nunique() // 2]
        held = {"E_GPa": E_GPA, "nu": NU, "dR_mm": middle}
        for varied in ("dR_mm", "E_GPa", "nu"):
            fixed = {name: value for name, value in held.items() if name != varied}
            n = fits.loc[(fits[list(fixed)] == pd.Series(fixed)).all(axis=1), "n"]
            spreads[f"{contact}: spread of n over {varied}, %"] = float(
                ends_spread((n.min(), n.max()))
            )
    return spreads


def _draw_moduli(axes: Axes, table: pd.DataFrame) -> None:
    """Draw a line per modulus."""
    for number, (E, lines) in enumerate(table[table["nu"] == NU].groupby("E_GPa")):
        label = f"$E$ = {plain_number(float(str(E)))} GPa"
        dR, n = lines["dR_mm"].to_numpy(), lines["n"].to_numpy()
        axes.plot(dR, n, label=label, markevery=(1 + 2 * number, 12))


def _draw_ratios(axes: Axes, table: pd.DataFrame) -> None:
    """Draw the band that Poisson's ratio spans at one modulus."""
    spread = table[table["E_GPa"] == E_GPA].groupby("dR_mm")["n"].agg(["min", "max"])
    ends = f"{table['nu'].min():g} to {table['nu'].max():g}"
    axes.fill_between(
        spread.index.to_numpy(),
        spread["min"],
        spread["max"],
        color="0.8",
        linewidth=0,
        zorder=0,
        label=f"$\\nu$ from {ends}, $E$ = {E_GPA:g} GPa",
    )


def _draw_published(axes: Axes, study: ExponentStudy) -> None:
    """Draw the published exponent, which knows ΔR only."""
    pair = CylinderPair.from_dR(study.contact, study.dR, Material("any", 1.0, 0.0))
    n = Enhanced().exponent(pair)
    axes.plot(
        study.dR,
        n,
        "-",
        marker="",
        color="0.6",
        linewidth=2.2,
        zorder=1,
        label="published $n$ (Eq 6c)",
    )


TICKS: Mapping[Contact, tuple[float, ...]] = {
    "internal": (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10),
    "external": (5, 10, 20, 50, 100, 200, 500),
}
MODULI_GPA = (20.7, 69.0, 207.0, 600.0, 10000.0)
RATIOS = (0.1, 0.3, 0.5)
CAPTION = (
    "Exponent n (-) of the power law f = K δⁿ fitted to Johnson's law pair by pair, against ΔR "
    "(mm). Lines: ν = 0.3 and five values of E. Light band: ν from 0.1 to 0.5 at 207 GPa; E and ν "
    "act through E* = E/(2(1 - ν²)) alone, and E* and ΔR only through their product. Thick grey "
    "line: the published exponent (Eq 6c). The fit is least squares in ln δ and ln f over 41 loads "
    "from 10 to 1000 N/mm spaced logarithmically; loads beyond Johnson's limit (Eq 8) are left "
    "out. The spacing of the loads, the values of E and the fit are our choice, as the paper names "
    "none."
)


def draw(_bench: Bench) -> Drawing:
    studies = [
        ExponentStudy(contact, np.geomspace(*TRAINING_DR[contact], 47), ticks)
        for contact, ticks in TICKS.items()
    ]
    figure, table = exponent_panels(studies, MODULI_GPA, RATIOS, TRAINING_LOADS)
    return Drawing(figure, table, exponent_spreads(table), CAPTION)
