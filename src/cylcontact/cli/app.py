"""The program and its commands; a command's heavy imports wait until it runs."""

import typer

from cylcontact.cli import calibration, reporting

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Calibrate contact laws for parallel cylinders and see where each can be trusted.",
)
app.command()(calibration.sample)
app.command()(calibration.fit)
app.command()(calibration.compare)
app.command()(calibration.verify)
app.command()(reporting.report)
app.command()(reporting.claims)
app.command("laws")(reporting.compare_laws)
app.command()(reporting.export)
