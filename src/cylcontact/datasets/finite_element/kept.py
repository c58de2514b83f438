"""Solved cases kept on disk until a table is complete, so that a study can be resumed."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from cylcontact.datasets.finite_element.cases import Case
from cylcontact.datasets.finite_element.setup import Setup
from cylcontact.errors import InputError


@dataclass(frozen=True)
class Row:
    """A solved case with the set-up that it is of.

    Attributes
    ----------
    variant : str
        The set-up's name in its study.
    setup : Setup
        The set-up.
    case : Case
        What was found.
    """

    variant: str
    setup: Setup
    case: Case

    @property
    def place(self) -> tuple[str, float, float]:
        """Variant, clearance and load."""
        return self.variant, self.case.dR, self.case.load


class Kept:
    """A file of solved cases: a header line, then a line of JSON for each.

    Parameters
    ----------
    path : Path
        The file.
    key : str
        What the cases depend on; cases kept under another key are refused.
    """

    def __init__(self, path: Path, key: str) -> None:
        self.path = path
        self._header = json.dumps({"study": key})

    def start(self) -> None:
        """Begin anew, with no cases; the file comes with the first."""
        self.path.unlink(missing_ok=True)

    def load(self) -> list[Row]:
        """Return the cases kept so far; none where there is no file. A line cut short is dropped.

        Raises
        ------
        InputError
            If they are of another study or engine, or the file is damaged.
        """
        if not self.path.exists():
            return []
        text = self.path.read_text(encoding="utf-8", errors="replace")
        header, *lines = text[: text.rfind("\n") + 1].splitlines() or [""]
        if header != self._header:
            raise InputError(
                str(self.path),
                "",
                None,
                "keeps the cases of another set-up or engine",
                "run without --resume to start anew",
            )
        try:
            rows = [_row(json.loads(line)) for line in lines]
        except (ValueError, TypeError, KeyError):
            raise InputError(
                str(self.path), "", None, "has a damaged line", "run without --resume"
            ) from None
        whole = "\n".join([header, *lines]) + "\n"
        if whole != text:
            self.path.write_text(whole, encoding="utf-8")
        return rows

    def add(self, rows: Sequence[Row]) -> None:
        """Append solved cases and force them to the disk."""
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                if not file.tell():
                    file.write(self._header + "\n")
                file.writelines(json.dumps(asdict(row)) + "\n" for row in rows)
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise InputError(
                str(self.path),
                "",
                None,
                f"cannot be written ({error.strerror})",
                "make room, or choose another output",
            ) from error


def _row(data: dict[str, dict[str, object]]) -> Row:
    """Return the row that a line describes."""
    return Row(str(data["variant"]), Setup(**data["setup"]), Case(**data["case"]))  # type: ignore[arg-type]
