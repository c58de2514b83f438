"""What 1.0.0rc1 had and this release has not, with what to use instead. Kept for one release."""

from __future__ import annotations

from collections.abc import Sequence

from cylcontact.support.errors import InputError

# By command.
COMMANDS: dict[str, str] = {
    "paper": "draw figures with `cylcontact figure` and include their PDF in a text of yours",
    "bifurcation": "use `cylcontact sweep datasets/slider_crank.toml --clearance 0.02,0.1,0.5 "
    "--revolutions 40 -o build/sweep.csv`, whose table has the period of each run",
    "tolerances": "use `cylcontact simulate datasets/slider_crank.toml --tolerance 1e-9`, which "
    "prints the error of the energy",
    "uncertainty": "`cylcontact fit` gives the standard errors and intervals, --level their level",
    "optimizers": "cylcontact fit searches with PyGAD, then descends from many points",
}
# By command and option.
OPTIONS: dict[tuple[str, str], str] = {
    ("figure", "--results"): "name a fit as an argument, e.g. fig12 result=build/internal.json",
    ("claims", "--results"): "the claims read the folder that they are run in",
    ("claims", "-j"): "leave it out; the claims need seconds",
    ("claims", "--jobs"): "leave it out; the claims need seconds",
    ("report", "-j"): "leave it out; the page is written from figures that are drawn",
    ("report", "--jobs"): "leave it out; the page is written from figures that are drawn",
    ("simulate", "-o"): "use --table run.csv for the steps, Trajectory.plot for pictures",
    ("simulate", "--out"): "use --table run.csv for the steps, Trajectory.plot for pictures",
    ("simulate", "--method"): "leave it out; there is one method",
    ("simulate", "--resume"): "leave it out; a run starts anew",
    ("sweep", "--method"): "leave it out; there is one method",
    ("sweep", "--resume"): "leave it out; a sweep starts anew",
    ("sweep", "--against"): "compare two runs with cylcontact.mechanism.horizon",
    **dict.fromkeys(
        ((command, "--loss") for command in ("fit", "choose", "design")),
        "leave it out: the report lists outliers with the fit without them",
    ),
    ("fit", "--optimizer"): "leave it out: the search is PyGAD's, with descents from many points",
}


def refuse_gone(arguments: Sequence[str]) -> None:
    """Raise `InputError` where a command line names a command or an option that is gone."""
    command = next((word for word in arguments if not word.startswith("-")), "")
    if command in COMMANDS:
        raise InputError("command line", "", command, "is gone", COMMANDS[command])
    for word in arguments:
        option = word.partition("=")[0]
        if (command, option) in OPTIONS:
            raise InputError(command, option, None, "is gone", OPTIONS[command, option])
