"""Journals of finished parts, from which interrupted work resumes."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from cylcontact.errors import InputError
from cylcontact.files import require_writable, unwritable
from cylcontact.reading import marked, read_bytes

Part = TypeVar("Part")
_ANEW = "run without --resume to start anew"


class Journal:
    """A file of finished parts of long work: a header, then one line of JSON for each.

    The header holds a key, a hash of everything that the parts depend on.
    """

    def __init__(self, path: Path, kind: str, key: str) -> None:
        require_writable(path)
        self.path = path
        self._kind = kind
        self._header = json.dumps(marked({kind: key}))

    def start(self) -> None:
        """Discard the parts recorded so far."""
        self.path.unlink(missing_ok=True)

    def load(self, parse: Callable[[Any], Part]) -> list[Part]:
        """Return the recorded parts; remove from the file what follows the last complete line."""
        contents = read_bytes(self.path) if self.path.exists() else b""
        complete = contents[: contents.rfind(b"\n") + 1]
        if complete != contents:  # a kill has cut the last line short
            os.truncate(self.path, len(complete))
        header, *lines = complete.decode(errors="replace").splitlines() or [self._header]
        if header != self._header:
            rule = f"belongs to other work: its {self._kind} or settings differ"
            raise InputError(str(self.path), "", None, rule, f"{_ANEW}, or restore the settings")
        try:
            return [parse(json.loads(line)) for line in lines]
        except InputError:
            raise
        except (ValueError, TypeError, KeyError) as error:
            raise InputError(str(self.path), "", None, "has a damaged line", _ANEW) from error

    def add(self, *parts: Mapping[str, Any]) -> None:
        """Append finished parts and flush them to the disk."""
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                lines = [] if file.tell() else [self._header]
                lines += map(json.dumps, parts)
                file.write("".join(f"{line}\n" for line in lines))
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise unwritable(self.path, error) from error
