"""What a bench says of the paper that it works on, for the report's pages and the ledger."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from cylcontact.reports.bench import Bench

__all__ = ["Paper", "paper_of"]


@dataclass(frozen=True)
class Paper:
    """A paper in the words of the bench: `PAPER` in its `reports/paper.py`.

    Attributes
    ----------
    title, lead : str
        The report's heading, and the sentences below it.
    equation : str
        The paper's main equation as MathML; it goes into the page as it is.
    citation : str
        The reference, plain text.
    figures : mapping of int to str
        The paper's figures, number → what it shows; recipe figNN redraws number NN.
    fits : tuple of str
        The fit results that the report opens with.
    fits_note : str
        What these were fitted to, and how.
    definitions : mapping of str to str
        The terms that the claims are worded in, term → meaning.
    references : mapping of str to str
        The works that claims cite, short name → reference.

    Examples
    --------
    >>> Paper(title="Rollers, recomputed").figures
    {}
    """

    title: str = "Report"
    lead: str = ""
    equation: str = ""
    citation: str = ""
    figures: Mapping[int, str] = field(default_factory=dict)
    fits: tuple[str, ...] = ()
    fits_note: str = ""
    definitions: Mapping[str, str] = field(default_factory=dict)
    references: Mapping[str, str] = field(default_factory=dict)


def paper_of(bench: Bench) -> Paper:
    """Return the bench's paper; one without words where the bench has no `paper.py`."""
    if not (bench.recipes_folder / "paper.py").is_file():
        return Paper()
    paper: Paper = getattr(bench.module("paper"), "PAPER", Paper())
    return paper
