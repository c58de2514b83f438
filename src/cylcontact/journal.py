"""Journals of finished parts, from which interrupted work resumes."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

from cylcontact.errors import InputError
from cylcontact.files import what_else
from cylcontact.formats import FORMATS, marked
from cylcontact.reading import JOURNAL_BYTES, read_bytes

__all__ = ["Journal"]

Part = TypeVar("Part")


class Journal:
    """A file of finished parts of long work: a header, then one line of JSON for each.

    Parameters
    ----------
    path : Path
        The file.
    kind : str
        What the key identifies: "campaign", "sweep" or "study".
    key : str
        A hash of everything that the parts depend on.
    anew : str
        How the user starts anew.

    Raises
    ------
    InputError
        If the path is that of a folder, a link, a pipe or a device.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "result.json.partial"
    >>> Journal(path, "campaign", "3f2a").add({"index": 0})
    >>> Journal(path, "campaign", "3f2a").load(dict)
    [{'index': 0}]
    >>> Journal(path, "campaign", "9c41").load(dict)
    Traceback (most recent call last):
    ...
    cylcontact.errors.InputError: ...: belongs to other work: its campaign or settings differ; ...
    """

    def __init__(self, path: Path, kind: str, key: str, anew: str = "run without --resume") -> None:
        self.path = path
        self._kind = kind
        self._header = json.dumps(marked("journal", {kind: key}))
        self._anew = f"{anew} to start anew"
        self._written: os.stat_result | None = None
        if problem := what_else(path):
            raise self._error(f"cannot be used ({problem})", "move it away")

    def start(self) -> None:
        """Discard the parts recorded so far; the next part starts a new file.

        Raises
        ------
        InputError
            If the file cannot be removed.
        """
        try:
            self.path.unlink(missing_ok=True)
        except OSError as error:
            raise self._unwritable(error) from error

    def load(self, parse: Callable[[Any], Part]) -> list[Part]:
        """Return the recorded parts; none if there is no file.

        A last line that a kill cut short is removed from the file.

        Parameters
        ----------
        parse : callable
            Makes a part from what its line of JSON holds.

        Returns
        -------
        list

        Raises
        ------
        InputError
            If the file cannot be read, has another format or key, or a damaged line.
        """
        if not os.path.lexists(self.path):
            return []
        contents = read_bytes(self.path, JOURNAL_BYTES, "move it away")
        if self._header.encode().startswith(contents):  # killed while the header was written
            self.start()
            return []
        complete = contents[: contents.rfind(b"\n") + 1]
        header, *lines = complete.decode(errors="replace").split("\n")[:-1] or [""]
        if header != self._header:
            raise self._of_other_work(header)
        parts = [self._parsed(line, parse) for line in lines]
        if complete != contents:
            try:
                os.truncate(self.path, len(complete))
            except OSError as error:
                raise self._unwritable(error) from error
        return parts

    def add(self, *parts: Mapping[str, Any]) -> None:
        """Append finished parts and flush them to the disk.

        Parameters
        ----------
        *parts : mapping
            What JSON can hold.

        Raises
        ------
        InputError
            If the file cannot be written, or was removed or replaced since the last part.
        """
        try:
            self._require_same_file()
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("ab") as file:
                lines = [] if file.tell() else [self._header]
                lines += [json.dumps(part) for part in parts]
                file.write("".join(f"{line}\n" for line in lines).encode())
                file.flush()
                os.fsync(file.fileno())
                self._written = os.fstat(file.fileno())
        except OSError as error:
            raise self._unwritable(error) from error

    def _require_same_file(self) -> None:
        """Refuse to append to a new file, which would lack the parts of the one before."""
        if self._written is None:
            return
        with suppress(FileNotFoundError):
            if os.path.samestat(self._written, self.path.stat()):
                return
        raise self._error(
            "was removed or replaced while in use",
            "start again, and leave its folder alone until the work ends",
        )

    def _parsed(self, line: str, parse: Callable[[Any], Part]) -> Part:
        """Return the part on a line."""
        try:
            return parse(json.loads(line))
        except InputError:
            raise
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise self._error("has a damaged line", self._anew) from error

    def _of_other_work(self, header: str) -> InputError:
        """Return what is wrong with a journal that has another header."""
        with suppress(ValueError, RecursionError, AttributeError):  # it is no header at all
            begun = json.loads(header)
            version, today = begun.get("format"), FORMATS["journal"]
            if self._kind in begun and version != today:
                rule = f"is that of another version of cylcontact, not {today}"
                remedy = f"finish the work with that version, or {self._anew}"
                return InputError(str(self.path), "format", version, rule, remedy)
        return self._error(
            f"belongs to other work: its {self._kind} or settings differ",
            f"{self._anew}, or restore the settings",
        )

    def _unwritable(self, error: OSError) -> InputError:
        return self._error(
            f"cannot be written ({error.strerror})",
            "make room, or choose another output; the parts already in it are kept",
        )

    def _error(self, rule: str, remedy: str) -> InputError:
        return InputError(str(self.path), "", None, rule, remedy)
