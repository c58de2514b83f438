"""Former names of commands and options, each answered with the present one."""

from __future__ import annotations

from collections.abc import Sequence

from cylcontact.errors import InputError

__all__ = ["refuse_former_command", "refuse_former_option", "renamed"]

# In place of each former command or option: the present name, and the command line to write.
_COMMANDS = {
    "sweep": ("simulate --study cases", "simulate SPEC --study cases -o TABLE"),
    "tolerances": ("simulate --study tolerances", "simulate SPEC --study tolerances -o TABLE"),
    "bifurcation": ("simulate --study bifurcation", "simulate SPEC --study bifurcation -o TABLE"),
    "animate": ("simulate -o FILM.gif", "simulate SPEC -o FILM.gif"),
    "optimizers": ("fit --optimizer all", "fit CAMPAIGN --optimizer all -o TABLE.csv"),
    "uncertainty": ("fit RESULT.json", "fit RESULT.json"),
}
_OPTIONS = {
    ("report", "--html"): ("report", "report"),
    **{
        ("report", option): (f"figure {option}", f"figure NAME {option} VALUE")
        for option in ("--style", "--format", "--font-size")
    },
    **{
        ("simulate", f"{option}s"): (
            option,
            f"simulate SPEC --study {study} {option} VALUE,VALUE -o TABLE",
        )
        for study, options in (
            ("cases", ("--law", "--clearance", "--restitution", "--friction")),
            ("tolerances", ("--tolerance",)),
            ("bifurcation", ("--impact-rate",)),
        )
        for option in options
    },
}


def renamed(former: str, present: str, line: str) -> InputError:
    """Return the error for a former name: the present one, and the command line to write."""
    return InputError(former, "", None, f"is now {present}", f"write: cylcontact {line}")


def refuse_former_command(arguments: Sequence[str]) -> None:
    """Raise `InputError` if the command has another name now."""
    if arguments and arguments[0] in _COMMANDS:
        raise renamed(arguments[0], *_COMMANDS[arguments[0]])


def refuse_former_option(command: str, option: str) -> None:
    """Raise `InputError` if an unknown option of a command has another name now."""
    if (command, option) in _OPTIONS:
        raise renamed(f"{command} {option}", *_OPTIONS[command, option])
