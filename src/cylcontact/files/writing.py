"""Files that appear complete or not at all."""

from __future__ import annotations

import json
import math
import os
import secrets
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cylcontact.support.choices import OUTPUT_SUFFIXES
from cylcontact.support.errors import InputError

if TYPE_CHECKING:
    import pandas as pd


@contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """Yield a temporary path beside `path`, and rename it to `path` when the block succeeds."""
    with replacing_all([path]) as (temporary,):
        yield temporary


@contextmanager
def replacing_all(paths: Iterable[Path | str]) -> Iterator[list[Path]]:
    """Do what `replacing` does for files that belong together: none appears before all are written.

    Each is flushed to the disk before its renaming, or a crash could leave an empty file under
    the final name.
    """
    targets = [Path(path) for path in paths]
    require_writable(*targets)
    unique = secrets.token_hex(4)
    temporaries = [file.with_name(f".{file.stem}-{unique}{file.suffix}") for file in targets]
    try:
        for target in targets:
            target.parent.mkdir(parents=True, exist_ok=True)
        yield temporaries
        for temporary, target in zip(temporaries, targets, strict=True):
            if target.exists():
                shutil.copymode(target, temporary)
            with temporary.open("rb+") as file:
                os.fsync(file.fileno())
        for temporary, target in zip(temporaries, targets, strict=True):
            temporary.replace(target)
    except OSError as error:
        raise unwritable(targets[0] if len(targets) == 1 else targets[0].parent, error) from error
    finally:
        for temporary in temporaries:
            with suppress(OSError):  # report the first error, not this one
                temporary.unlink(missing_ok=True)


def unwritable(path: Path, error: OSError) -> InputError:
    """Return the error for a file that could not be written."""
    rule = f"cannot be written ({error.strerror or error})"
    remedy = "choose a folder in which you can write, with room left"
    return InputError(str(path), "", None, rule, remedy)


def require_writable(*paths: Path | str) -> None:
    """Raise `InputError` if one of some files cannot be written, before any work; create nothing.

    A link is refused too: the file that it points to would stay as it is.
    """
    for path in map(Path, paths):
        try:
            problem = _obstacle(path)
        except OSError as error:
            problem = error.strerror or str(error)
        if problem:
            remedy = "choose a file in a folder you may write to"
            raise InputError(str(path), "", None, f"cannot be written ({problem})", remedy)


def _obstacle(path: Path) -> str:
    """Return why a file cannot be written, in a few words; empty if it can be."""
    folder = next((folder for folder in path.parents if folder.exists()), Path())
    if path.is_symlink():
        return "it is a link"
    if path.is_dir():
        return "it is a folder"
    if path.exists() and not path.is_file():
        return "it is a device, a pipe or a socket"
    if not folder.is_dir():
        return f"{folder} is not a folder"
    if not os.access(folder, os.W_OK | os.X_OK):
        return f"no permission to write in {folder}"
    return ""


def require_apart(outputs: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Raise `InputError` if an output is one of the inputs, by this or another name."""
    for output, file in product(outputs, inputs):
        with suppress(OSError):  # one of them is not there
            if output.samefile(file):
                rule = "cannot be written (it is an input)"
                raise InputError(str(output), "", None, rule, "choose another file")


def require_suffix(path: Path | str, *suffixes: str) -> str:
    """Return the suffix of an output path, which must be one of some."""
    suffix = Path(path).suffix
    if suffix not in suffixes:
        none = f"not a {suffixes[0]}" if len(suffixes) == 1 else f"neither {' nor '.join(suffixes)}"
        raise InputError(str(path), "", None, f"is {none}", "name the output so that it is one")
    if suffix == ".parquet":
        require_parquet(path)
    return suffix


def require_parquet(path: Path | str) -> Any:
    """Return pyarrow, which the Parquet file `path` needs and nothing else does."""
    try:
        import pyarrow.parquet
    except ImportError:
        remedy = "pip install 'cylcontact[parquet]', or make extras"
        raise InputError(str(path), "", None, "needs the extra 'parquet'", remedy) from None
    return pyarrow


def write_table(table: pd.DataFrame, path: Path | str) -> None:
    """Write a table as .csv or .parquet."""
    suffix = require_suffix(path, *OUTPUT_SUFFIXES)
    with replacing(path) as temporary:
        if suffix == ".csv":
            table.to_csv(temporary, index=False, lineterminator="\n")
        else:
            table.to_parquet(temporary, index=False)


def json_text(data: Any) -> str:
    """Return plain data, arrays and tables (their rows) as JSON: null for NaN, "inf" for infinity.

    Examples
    --------
    >>> json_text([1.5, float("nan"), float("-inf")]).split()
    ['[', '1.5,', 'null,', '"-inf"', ']']
    """
    return json.dumps(plain(data), ensure_ascii=False, indent=1)


def plain(value: Any) -> Any:
    """Return plain data, arrays and tables for JSON, as `json_text` writes them."""
    if hasattr(value, "to_dict"):
        value = value.to_dict("records")
    elif hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def shipped_bench() -> Path:
    """Return the folder of the shipped bench: in the package, or the checkout around it."""
    package = Path(__file__).parents[1]
    return package / "bench" if (package / "bench").is_dir() else package.parents[1]
