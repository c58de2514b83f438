"""The error that bad input raises."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cylcontact.support.plain_text import brief

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# The most characters of a message, part of which other programs and files may have written.
_MESSAGE = 2000


class InputError(ValueError):
    """Bad input, described in one line: source, value, the rule it breaks and the remedy.

    Parameters
    ----------
    source : str
        The file, object or command line the value came from.
    key : str
        The name of the value in the source; empty when the source as a whole is wrong.
    value : object
        The offending value; `None` to show none.
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
        setting = " = ".join(part for part in (key, short(value)) if part)
        where = ": ".join(part for part in (source, setting) if part)
        super().__init__(brief(" ".join(f"{where}: {rule}; {remedy}".splitlines()), _MESSAGE))

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str, object, str, str]]:
        """Pickle the five parts, so that worker processes can send the error back."""
        return (type(self), (self.source, self.key, self.value, self.rule, self.remedy))

    def _render_traceback_(self) -> list[str]:
        """Return the message without a traceback; IPython calls this in notebooks."""
        return [str(self)]


def short(value: object, width: int = 80) -> str:
    """Return `value` on one line of at most `width` characters; empty for `None`."""
    if value is None:
        return ""
    plain: Any = value
    if type(value).__module__ == "numpy" and plain.shape == ():
        plain = plain.item()
    return brief(" ".join(repr(plain).split()), width)


def require(
    holds: bool | NDArray[np.bool_] | np.bool_,
    source: str,
    key: str,
    value: object,
    rule: str,
    remedy: str,
) -> None:
    """Raise `InputError` unless `holds` is true for every element."""
    # Laws are made thousands of times in a fit: `np.all` takes longer than the rest.
    every: Any = holds
    if not (every.all() if getattr(every, "ndim", 0) else every):
        raise InputError(source, key, value, rule, remedy)
