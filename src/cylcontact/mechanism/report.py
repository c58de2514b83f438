"""A run as text: the summary, the statistics, and everything that was assumed."""

from __future__ import annotations

from cylcontact.mechanism.trajectory import Trajectory

WIDTH = 98


def to_text(run: Trajectory) -> str:
    """Return what `cylcontact simulate` prints.

    Parameters
    ----------
    run : Trajectory
        The run.

    Returns
    -------
    str
        Lines, the last one ended.
    """
    milliseconds = run.counts["seconds"].to_numpy() * 1e3
    lines = [
        repr(run),
        "",
        "Over the revolutions:",
        *(f"  {line}" for line in repr(run.statistics()).splitlines()[1:]),
        "",
        f"{milliseconds.min():.1f} ms of computing for the fastest revolution, "
        f"{run.mechanism.period * 1e3:.3g} ms in real time",
        "",
        "Assumed, not from the paper:",
        *_wrapped(run.assumptions),
    ]
    return "\n".join(lines) + "\n"


def _wrapped(entries: tuple[str, ...]) -> list[str]:
    """Return entries separated by semicolons, in lines of bounded width."""
    import textwrap

    return textwrap.wrap("; ".join(entries), WIDTH, initial_indent="  ", subsequent_indent="  ")
