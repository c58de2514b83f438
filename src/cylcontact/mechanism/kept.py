"""Complete cases of a sweep kept in a file, so that an interrupted one can be taken up."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from cylcontact.errors import InputError
from cylcontact.files import unwritable


class Kept:
    """A file of lines of JSON: a header, then one line for each case.

    Parameters
    ----------
    path : Path
        The file.
    key : str
        A hash of what the cases have in common; cases kept under another are refused.
    """

    def __init__(self, path: Path, key: str) -> None:
        self.path = path
        self._header = json.dumps({"sweep": key})

    def start(self) -> None:
        """Begin anew; the file comes with the first case."""
        try:
            self.path.unlink(missing_ok=True)
        except OSError as error:
            raise unwritable(self.path, error) from error

    def load(self) -> list[dict[str, Any]]:
        """Return the cases kept so far; a line that a kill has cut short is dropped.

        Raises
        ------
        InputError
            If the file belongs to another sweep or is not such a file.
        """
        try:
            contents = self.path.read_bytes()
        except FileNotFoundError:
            return []
        complete = contents[: contents.rfind(b"\n") + 1]
        header, *lines = complete.decode(errors="replace").splitlines() or [self._header]
        if header != self._header:
            raise InputError(
                str(self.path), "", None, "keeps cases of another sweep or of other settings",
                "run without --resume to start anew, or restore the settings",
            )  # fmt: skip
        try:
            found = [json.loads(line) for line in lines]
        except ValueError as error:
            raise InputError(
                str(self.path), "", None, "has a damaged line", "run without --resume"
            ) from error
        if complete != contents:
            self.path.write_bytes(complete)
        return found

    def add(self, line: dict[str, Any]) -> None:
        """Append a case and force it to the disk."""
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                if not file.tell():
                    file.write(self._header + "\n")
                file.write(json.dumps(line) + "\n")
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise unwritable(self.path, error) from error
