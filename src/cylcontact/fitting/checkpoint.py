"""Keep every finished run of a campaign, so that an interrupted one can be resumed."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from pathlib import Path

from cylcontact.errors import InputError
from cylcontact.fitting.run import RunRecord
from cylcontact.spec import parse_spec


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
        self._written: os.stat_result | None = None

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
            contents = self.path.read_bytes()
        except FileNotFoundError:
            return []
        except OSError as error:
            raise InputError(
                str(self.path), "", None, f"cannot be read ({error.strerror})", "move it away"
            ) from error
        if self._header.encode().startswith(contents):  # cut short before its first run
            self.start()
            return []
        complete = contents[: contents.rfind(b"\n") + 1]
        header, *lines = complete.decode(errors="replace").split("\n")[:-1] or [""]
        if header != self._header:
            raise InputError(
                str(self.path),
                "",
                None,
                "keeps the runs of another campaign or of other settings",
                "run without --resume to start anew, or restore the settings",
            )
        records = [self._parse(line) for line in lines]
        if complete != contents:
            self._truncate(len(complete))
        return records

    def add(self, record: RunRecord) -> None:
        """Append a finished run and force it to the disk.

        Raises
        ------
        InputError
            If it cannot be written, or the file written before is no longer there.
        """
        try:
            self._require_still_there()
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("ab") as file:
                lines = ["" if file.tell() else self._header + "\n", record.model_dump_json(), "\n"]
                file.write("".join(lines).encode())
                file.flush()
                os.fsync(file.fileno())
                self._written = os.fstat(file.fileno())
        except OSError as error:
            raise _unwritable(self.path, error) from error

    def _require_still_there(self) -> None:
        """Refuse to go on in another file than before: the runs in that one would be missing."""
        if self._written is None:
            return
        with suppress(FileNotFoundError):
            if os.path.samestat(self._written, self.path.stat()):
                return
        raise InputError(
            str(self.path),
            "",
            None,
            "was removed or replaced while the fit was running",
            "start the fit again, and leave its folder alone until it ends",
        )

    def _truncate(self, size: int) -> None:
        """Cut the file off after its complete lines."""
        try:
            os.truncate(self.path, size)
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
