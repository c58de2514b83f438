"""The program and its commands. Commands import slow libraries when they run."""

from collections.abc import Callable, Iterable
from typing import Any

import typer

import cylcontact
from cylcontact.cli import data, fit, init, joint, laws, mechanism, reporting
from cylcontact.cli.options import Command, Group, flag, keep_inputs


def _version(wanted: bool) -> None:
    """Print the version and exit."""
    if wanted:
        typer.echo(f"cylcontact {cylcontact.__version__}")
        raise typer.Exit


app = typer.Typer(
    cls=Group,
    epilog="Start with: cylcontact check --material bronze --Ri 10 --Rj 9.95 --load 300",
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback()
def _common(
    version: bool = flag("Show the version.", "--version", callback=_version, is_eager=True),
) -> None:
    """Contact of parallel cylinders: laws, checks of joints, fits to measurements, export."""


# The groups of `cylcontact --help`: each command with the examples that its own help ends with.
_GROUPS: dict[str, dict[Callable[..., None], tuple[str, ...]]] = {
    "Data and fits": {
        data.sample: ("sample datasets/internal.toml -o build/internal.parquet",),
        fit.fit: (
            "fit datasets/examples/pin-in-hole.csv --law explicit --contact internal",
            "fit fitting/external-E1000.toml",
        ),
        fit.choose: ("choose datasets/examples/pin-in-hole.csv --contact internal",),
        fit.predict: ('predict build/pin-in-hole/result.json --load "100 N/mm"',),
        fit.plan: (
            "plan datasets/examples/specimens.csv --law explicit --candidates 5:400 "
            "--contact internal --material 'high-strength steel' --Ri 10 --Rj 9.97 --length 20",
        ),
        fit.compare: ("compare fitting/results/internal.json",),
    },
    "Joints and laws": {
        joint.check: (
            "check --material bronze --Ri 10 --Rj 9.95 --load 300",
            'check --iso 20H7/g6 --pin "high-strength steel" --hole bronze --R-o 20 '
            '--clamp pulled:60 --load "6 kN" --length 12',
        ),
        joint.size: (
            'size clearance --material "low-carbon steel" --Ri 10 --load 500 --stiffness 2e5',
        ),
        laws.export: (
            "export johnson --to c",
            "export --joint datasets/joint.toml --to c -o build/joint.c",
        ),
    },
    "Mechanism": {
        mechanism.simulate: ("simulate datasets/slider_crank.toml --law explicit --revolutions 3",),
        mechanism.sweep: (
            "sweep datasets/slider_crank.toml --law johnson,explicit --revolutions 3 "
            "-o build/sweep.csv",
        ),
        data.finite_element: (
            "finite-element datasets/finite_element/recommended.toml -o build/cases.csv",
        ),
    },
    "Figures and claims": {
        reporting.figure: ("figure fig12 --width column --format pdf,svg",),
        reporting.report: ("report -o build/report.html",),
        reporting.claims: ("claims -o build/claims.csv",),
        fit.verify: ("verify fitting/results/external-E1000.json",),
        init.init: ("init mine",),
    },
}


def _added(
    to: typer.Typer, command: Callable[..., None], examples: Iterable[str], **panel: Any
) -> None:
    """Add a command whose help ends with examples."""
    epilog = "\n\n".join(f"Example: cylcontact {example}" for example in examples)
    to.command(cls=Command, epilog=epilog, **panel)(keep_inputs(command))


for _group, _commands in _GROUPS.items():
    for _command, _examples in _commands.items():
        _added(app, _command, _examples, rich_help_panel=_group)

laws_app = typer.Typer(
    cls=Group, rich_markup_mode="rich", context_settings=app.info.context_settings
)
_LAWS: dict[Callable[..., None], str] = {
    laws.compare: "laws compare --pin 'low-carbon steel' --hole bronze --Ri 10 --Rj 9.95",
    laws.accuracy: "laws accuracy --contact external",
}


@laws_app.callback(invoke_without_command=True)
def _laws(context: typer.Context, contact: str = laws.CONTACT) -> None:
    """List the laws, or compare them for a joint or over a range."""
    if context.invoked_subcommand is None:
        laws.listing(contact)


for _command, _example in _LAWS.items():
    _added(laws_app, _command, [_example])
app.add_typer(
    laws_app, name="laws", rich_help_panel="Joints and laws", epilog="Example: cylcontact laws"
)
