"""The program and its commands. Commands import slow libraries when they run."""

from collections.abc import Callable

import typer

import cylcontact
from cylcontact.cli import data, fit, init, joint, laws, mechanism, reporting
from cylcontact.cli.options import keep_inputs, option


def _version(wanted: bool) -> None:
    """Print the version and exit."""
    if wanted:
        typer.echo(f"cylcontact {cylcontact.__version__}")
        raise typer.Exit


app = typer.Typer(
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback()
def _common(
    version: bool = option(
        "Show the version.", "--version", callback=_version, is_eager=True, default=False
    ),
) -> None:
    """Contact of parallel cylinders: fit laws, check joints, export them, reproduce the paper."""


# The groups of `cylcontact --help`: each command with an example, which its own help ends with.
_GROUPS: dict[str, dict[Callable[..., None], str]] = {
    "Data and fits": {
        data.sample: "sample datasets/internal.toml -o build/internal.parquet",
        fit.fit: "fit fitting/external-E1000.toml",
        fit.choose: "choose datasets/examples/pin-in-hole.csv --contact internal",
        fit.predict: 'predict build/data/result.json --load "4500 N"',
        fit.plan: "plan datasets/examples/specimens.csv --law explicit --candidates 5:400 "
        "--contact internal --material 'high-strength steel' --Ri 10 --Rj 9.97 --length 20",
        fit.compare: "compare fitting/results/internal.json",
    },
    "Joints and laws": {
        joint.check: 'check --iso 20H7/g6 --pin "high-strength steel" --hole bronze --R-o 20 '
        '--clamp pulled:60 --load "6 kN" --length 12',
        joint.size: 'size clearance --material "low-carbon steel" --Ri 10 --load 500 '
        "--stiffness 2e5",
        laws.export: "export johnson --to c",
    },
    "Mechanism": {
        mechanism.simulate: "simulate datasets/slider_crank.toml --law explicit --revolutions 3",
        mechanism.sweep: "sweep datasets/slider_crank.toml --law johnson,explicit --revolutions 3 "
        "-o build/sweep.csv",
        data.finite_element: "finite-element datasets/finite_element/recommended.toml",
    },
    "Figures and claims": {
        reporting.figure: "figure fig12 --width column --format pdf,svg",
        reporting.report: "report -o build/report.html",
        reporting.claims: "claims -o build/claims.csv",
        fit.verify: "verify fitting/results/external-E1000.json",
        init.init: "init mine",
    },
}

for _group, _examples in _GROUPS.items():
    for _command, _example in _examples.items():
        _example = f"Example: cylcontact {_example}"
        app.command(rich_help_panel=_group, epilog=_example)(keep_inputs(_command))

laws_app = typer.Typer(rich_markup_mode="rich", context_settings=app.info.context_settings)
_LAWS: dict[Callable[..., None], str] = {
    laws.compare: 'compare --pin "low-carbon steel" --hole bronze --Ri 10 --Rj 9.95 --load 300',
    laws.accuracy: "accuracy --contact external",
}


@laws_app.callback(invoke_without_command=True)
def _laws(context: typer.Context, contact: str = laws.CONTACT) -> None:
    """List the laws, or compare them for a joint or over a range."""
    if context.invoked_subcommand is None:
        laws.listing(contact)


for _command, _example in _LAWS.items():
    laws_app.command(epilog=f"Example: cylcontact laws {_example}")(keep_inputs(_command))
app.add_typer(
    laws_app, name="laws", rich_help_panel="Joints and laws", epilog="Example: cylcontact laws"
)
