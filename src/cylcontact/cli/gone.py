"""What 1.0.0rc1 had and this release has not, with what to use instead. Kept for one release."""

from __future__ import annotations

from collections.abc import Sequence

from cylcontact.support.errors import InputError

# By command.
COMMANDS: dict[str, str] = {
    "optimizers": "cylcontact fit searches with PyGAD, then descends from many points",
}
# By command and option.
OPTIONS: dict[tuple[str, str], str] = {
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
