"""The command `animate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cylcontact.cli.mechanism import Beyond, Method, SpecFile, Tolerance
from cylcontact.cli.options import integer_from
from cylcontact.cli.terminal import progress_bars
from cylcontact.files import require_writable

__all__ = ["animate"]


def animate(
    spec: SpecFile,
    out: Annotated[Path, typer.Option("-o", "--out", help="The .gif (or .mp4) to write.")],
    law: Annotated[str | None, typer.Option(help="A contact law, e.g. johnson.")] = None,
    clearance: Annotated[float | None, typer.Option(help="Radial clearance, mm.")] = None,
    restitution: Annotated[float | None, typer.Option(help="Restitution, (0, 1].")] = None,
    friction: Annotated[float | None, typer.Option(help="Friction coefficient.")] = None,
    revolutions: Annotated[
        int, typer.Option(parser=integer_from(1), metavar="INTEGER", help="Revolutions shown.")
    ] = 1,
    first: Annotated[
        int,
        typer.Option(
            parser=integer_from(0), metavar="INTEGER", help="First revolution shown, from 0."
        ),
    ] = 2,
    method: Method = None,
    tolerance: Tolerance = None,
    beyond: Beyond = "stop",
) -> None:
    """Film a mechanism with a clearance joint, the journal magnified beside it."""
    from cylcontact.mechanism import read_mechanism
    from cylcontact.mechanism import simulate as run
    from cylcontact.mechanism.movie import film, require_film

    require_film(out)
    require_writable(out)
    changes = {"law": law, "clearance": clearance, "restitution": restitution, "friction": friction}
    mechanism = read_mechanism(spec, **changes)
    with progress_bars() as progress:
        trajectory = run(mechanism, method, first + revolutions, tolerance, beyond, progress)
        frames = film(trajectory, out, first, progress)
    typer.echo(f"{frames} frames in {out}; assumed: {'; '.join(trajectory.assumptions)}")
