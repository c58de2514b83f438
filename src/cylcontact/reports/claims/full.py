"""All claims at once: those of the equations, of the fits, of finite elements, of the mechanism."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from cylcontact.fitting.result import FitResult
from cylcontact.materials import shipped_materials
from cylcontact.parallel import Workers
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import calibration, section4, section32
from cylcontact.reports.claims.claim import Claim
from cylcontact.reports.claims.ledger import ledger

# The stage, what is done of it, and how much there is.
Progress = Callable[[str, int, int], None]


def full_ledger(
    bench: Bench,
    results: Mapping[str, FitResult],
    jobs: Workers = 1,
    progress: Progress = lambda *_: None,
) -> list[Claim]:
    """Compute every claim of the paper that the bench has the inputs for.

    Parameters
    ----------
    bench : Bench
        Where the finite-element tables and the mechanism's spec lie.
    results : mapping of str to FitResult
        The fits by name; claims on one that is missing say so.
    jobs : int or Cluster, optional
        Where the mechanism's cases are run; the claims do not depend on it.
    progress : callable, optional
        Called with the stage, how many groups of claims are done and their total.

    Returns
    -------
    list of Claim
        In the order of the paper's sections.

    Raises
    ------
    InputError
        If a finite-element table or the mechanism's spec is wrong.
    """
    groups: tuple[Callable[[], list[Claim]], ...] = (
        lambda: calibration.claims(results),
        lambda: section32.claims(bench),
        lambda: section4.claims(bench, jobs),
    )
    more: list[Claim] = []
    progress("claims", 0, len(groups) + 1)
    materials = shipped_materials()
    for done, group in enumerate(groups, start=1):
        more += group()
        progress("claims", done, len(groups) + 1)
    found = ledger(materials, more)
    progress("claims", len(groups) + 1, len(groups) + 1)
    return found
