"""Keep every finished run of a campaign, so that an interrupted one can be resumed."""

from __future__ import annotations

import json
import os
from pathlib import Path

from cylcontact.errors import InputError
from cylcontact.fitting.run import RunRecord
from cylcontact.specs import parse_spec


class Checkpoint:
    """A file of finished runs beside a result: a header line, then a line of JSON per run.

    Parameters
    ----------
    path : Path
        The file.
    key : str
        A hash of everything that the runs depend on; runs kept under another are refused.
    """

    def __init__(self, path: Path, key: str) -> None:
        self.path = path
        self._header = json.dumps({"campaign": key})

    def start(self) -> None:
        """Begin anew, with no runs; the file comes with the first."""
        try:
            self.path.unlink(missing_ok=True)
        except OSError as error:
            raise _unwritable(self.path, error) from error

    def load(self) -> list[RunRecord]:
        """Return the runs kept so far; none where there is no file yet.

        A line cut short by a kill is dropped, from the file as well.

        Raises
        ------
        InputError
            If the file belongs to another campaign or is not a checkpoint.
        """
        try:
            text = self.path.read_text(encoding="utf-8", errors="replace")
        except FileNotFoundError:
            return []
        except OSError as error:
            raise InputError(
                str(self.path), "", None, f"cannot be read ({error.strerror})", "move it away"
            ) from error
        if self._header.startswith(text):  # cut short before its first run
            self.start()
            return []
        complete = text[: text.rfind("\n") + 1]
        header, *lines = complete.splitlines() or [""]
        if header != self._header:
            raise InputError(
                str(self.path),
                "",
                None,
                "keeps the runs of another campaign or of other settings",
                "run without --resume to start anew, or restore the settings",
            )
        records = [self._parse(line) for line in lines]
        if complete != text:
            self.path.write_text(complete, encoding="utf-8")
        return records

    def add(self, record: RunRecord) -> None:
        """Append a finished run and force it to the disk."""
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                if not file.tell():
                    file.write(self._header + "\n")
                file.write(record.model_dump_json() + "\n")
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise _unwritable(self.path, error) from error

    def _parse(self, line: str) -> RunRecord:
        try:
            data = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise InputError(
                str(self.path), "", None, "has a damaged line", "run without --resume"
            ) from error
        return parse_spec(RunRecord, data, str(self.path))


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError(
        str(path),
        "",
        None,
        f"cannot be written ({error.strerror})",
        "make room, or choose another output; runs already in it are kept",
    )
