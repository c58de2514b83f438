"""What a file is by its first bytes: compressed, a workbook, or no table at all."""

from __future__ import annotations

import gzip
import io
import re
import zlib

from cylcontact.support.errors import InputError

_GZIP = b"\x1f\x8b"
# The most bytes of a compressed file: a few kilobytes may unfold to more than the memory holds.
MAX_BYTES = 2_000_000_000
# Of files that are no tables: how they begin, what they are, and what to do.
_EXPORT = "export its columns as CSV"
_UNPACK = "unpack it"
_KINDS = (
    (b"\xd0\xcf\x11\xe0", "a workbook of Excel before 2007, which is not read", "save it as .xlsx"),
    (b"BZh", "compressed by bzip2", f"{_UNPACK}, or compress it by gzip"),
    (b"\xfd7zXZ", "compressed by xz", f"{_UNPACK}, or compress it by gzip"),
    (b"\x28\xb5\x2f\xfd", "compressed by Zstandard", f"{_UNPACK}, or compress it by gzip"),
    (b"7z\xbc\xaf", "an archive of 7-Zip", _UNPACK),
    (b"Rar!", "a RAR archive", _UNPACK),
    (b"MATLAB 5.0 MAT-file", "a MATLAB file", _EXPORT),
    (b"\x89HDF", "an HDF5 file (as MATLAB 7.3 writes too)", _EXPORT),
    (b"TDSm", "a TDMS file of LabVIEW", _EXPORT),
    (b"\x93NUMPY", "an array of NumPy", "give a DataFrame, or save it with numpy.savetxt"),
    (b"%PDF", "a PDF", _EXPORT),
    (b"\x89PNG", "a picture", "give the table of its numbers"),
    (b"\xff\xd8\xff", "a picture", "give the table of its numbers"),
    (b"PAR1", "a Parquet table under another name", "name it .parquet"),
    (b"{\\rtf", "a document", "save its table as CSV"),
)
_PAGE = re.compile(rb"\s*(?:<!doctype html|<html|<table|<meta|<head|<div)", re.IGNORECASE)
_XML = re.compile(rb"\s*<\?xml", re.IGNORECASE)


def unpacked(source: str, content: bytes) -> bytes:
    """Return the contents of a file, or of what is in it if it is compressed by gzip."""
    if not content.startswith(_GZIP):
        return content
    try:
        with gzip.open(io.BytesIO(content)) as file:
            plain = file.read(MAX_BYTES + 1)
    except (OSError, EOFError, zlib.error) as error:
        rule = f"is a damaged gzip file ({error})"
        raise InputError(source, "", None, rule, "compress it anew") from error
    if len(plain) > MAX_BYTES:
        rule = f"unfolds to more than {MAX_BYTES // 10**6:,} MB"
        raise InputError(source, "", None, rule, "thin or average its rows")
    return plain


def is_workbook(content: bytes) -> bool:
    """Return whether a file is a workbook of Excel since 2007."""
    return content.startswith(b"PK") and b"xl/workbook" in content


def require_table(source: str, content: bytes) -> None:
    """Refuse a file that is known not to be a table, and say what it is."""
    for start, kind, remedy in _KINDS:
        if content.startswith(start):
            raise InputError(source, "", None, f"is {kind}", remedy)
    rule, remedy = "", "open it in a spreadsheet program and save it as .xlsx or .csv"
    if content.startswith(b"PK"):
        rule = "is an archive (zip)"
        if b"opendocument.spreadsheet" in content[:200]:
            rule, remedy = "is a workbook of OpenDocument", "save it as .xlsx or .csv"
        else:
            remedy = _UNPACK
    elif _PAGE.match(content):
        rule = "is a web page (HTML), whatever its name says"
    elif _XML.match(content):
        rule = "is an XML file"
    if rule:
        raise InputError(source, "", None, rule, remedy)
