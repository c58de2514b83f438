"""The program and its commands. Commands import slow libraries when they run."""

from typing import Annotated

import typer

import cylcontact
from cylcontact.cli import (
    animation,
    calibration,
    finite_element,
    init,
    measured,
    mechanism,
    reporting,
)

__all__ = ["app"]


def _version(wanted: bool) -> None:
    """Print the version and exit."""
    if wanted:
        typer.echo(f"cylcontact {cylcontact.__version__}")
        raise typer.Exit


app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Calibrate contact laws for parallel cylinders and see where each can be trusted."""


app.command()(init.init)
app.command()(calibration.sample)
app.command()(calibration.fit)
app.command()(measured.choose)
app.command()(calibration.optimizers)
app.command()(measured.uncertainty)
app.command()(calibration.compare)
app.command()(calibration.verify)
app.command()(mechanism.simulate)
app.command()(mechanism.sweep)
app.command()(mechanism.bifurcation)
app.command()(mechanism.tolerances)
app.command()(animation.animate)
app.command("finite-element")(finite_element.finite_element)
app.command()(reporting.report)
app.command()(reporting.claims)
app.command("laws")(reporting.compare_laws)
app.command()(reporting.export)
