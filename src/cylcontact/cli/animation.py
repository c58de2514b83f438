"""The command `animate`."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from cylcontact.cli.mechanism import Changes, Integration, SpecFile
from cylcontact.cli.options import expand_options, integer_from
from cylcontact.cli.terminal import progress_bars
from cylcontact.files import require_writable

__all__ = ["animate"]


@expand_options
def animate(
    spec: SpecFile,
    *,
    out: Annotated[Path, typer.Option("-o", "--out", help="The .gif (or .mp4) to write.")],
    changes: Changes,
    revolutions: Annotated[
        int, typer.Option(parser=integer_from(1), metavar="INTEGER", help="Revolutions shown.")
    ] = 1,
    first: Annotated[
        int,
        typer.Option(
            parser=integer_from(0), metavar="INTEGER", help="First revolution shown, from 0."
        ),
    ] = 2,
    integration: Integration,
) -> None:
    """Film a mechanism with a clearance joint, the journal magnified beside it."""
    from cylcontact.mechanism import read_mechanism
    from cylcontact.mechanism import simulate as run
    from cylcontact.mechanism.movie import film, require_film

    require_film(out)
    require_writable(out)
    mechanism = read_mechanism(spec, **asdict(changes))
    with progress_bars() as progress:
        trajectory = run(
            mechanism, revolutions=first + revolutions, progress=progress, **asdict(integration)
        )
        frames = film(trajectory, out, first, progress)
    typer.echo(f"{frames} frames in {out}; assumed: {'; '.join(trajectory.assumptions)}")
