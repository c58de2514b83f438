"""Section 4: the slider-crank, simulated as often as its statements need it."""

from __future__ import annotations

from cylcontact.parallel import Workers
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import (
    section4_contact,
    section4_forces,
    section4_laws,
    section4_model,
    section4_steps,
)
from cylcontact.reports.claims.claim import Claim
from cylcontact.reports.mechanism.runs import statistics_table


def claims(bench: Bench, workers: Workers = 1) -> list[Claim]:
    """Return the claims of Section 4, and those of Section 5 that sum it up.

    Parameters
    ----------
    bench : Bench
        Where the mechanism's spec lies; without it there is one claim that says so.
    workers : int or Cluster, optional
        Where the 24 cases are run; the claims do not depend on it.

    Raises
    ------
    InputError
        If the spec is wrong.
    """
    if not bench.mechanism_file.is_file():
        return [_missing(bench)]
    table = statistics_table(bench, workers)
    return [
        *section4_model.claims(bench),
        *section4_laws.claims(bench),
        *section4_contact.claims(table),
        *section4_forces.claims(table),
        *section4_steps.claims(table),
    ]


def _missing(bench: Bench) -> Claim:
    """Return what stands for all claims where there is no mechanism."""
    return Claim(
        id="4.3-mechanism",
        section="4.3",
        statement="how a slider-crank with a clearance joint moves, by law, clearance and losses",
        paper="Figs 17 to 19",
        ours="",
        rule="",
        holds=None,
        choice=f"{bench.mechanism_file} does not exist",
    )
