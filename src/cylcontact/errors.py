"""The one kind of error that bad input raises."""

from __future__ import annotations

import numpy as np

__all__ = ["InputError", "short"]


class InputError(ValueError):
    """Bad input, told in one line: where, what, the rule it breaks and the remedy.

    Parameters
    ----------
    source : str
        The file, object or command line the value came from.
    key : str
        The name of the value inside the source; empty when the source itself is at fault.
    value : object
        The offending value; `None` where there is none to show.
    rule : str
        What must hold.
    remedy : str
        What to do about it.

    Examples
    --------
    >>> print(InputError("Material 'steel'", "E", -3.0, "must be positive", "give it in MPa"))
    Material 'steel': E = -3.0: must be positive; give it in MPa
    """

    def __init__(self, source: str, key: str, value: object, rule: str, remedy: str) -> None:
        self.source = source
        self.key = key
        self.value = value
        self.rule = rule
        self.remedy = remedy
        shown = " = ".join(part for part in (key, short(value)) if part)
        where = ": ".join(part for part in (source, shown) if part)
        # A path or another program's message may bring line breaks and worse along.
        super().__init__(_printable(" ".join(f"{where}: {rule}; {remedy}".splitlines())))

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str, object, str, str]]:
        """Rebuild from the five parts, so that worker processes can send it back."""
        return (type(self), (self.source, self.key, self.value, self.rule, self.remedy))

    def _render_traceback_(self) -> list[str]:
        """Show the line alone in a notebook, where IPython asks for this."""
        return [str(self)]


def _printable(text: str) -> str:
    """Escape what would not show on a terminal, or do more than show."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def short(value: object, width: int = 80) -> str:
    """Return `value` on one line, cut to `width` characters; nothing for `None`."""
    if value is None:
        return ""
    plain = value.item() if isinstance(value, np.generic) else value
    text = " ".join(repr(plain).split())
    return text if len(text) <= width else text[: width - 1] + "…"
