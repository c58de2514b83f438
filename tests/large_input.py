"""Files that are too large, at once or when they are read, and what reading them takes."""

import io
import time
import zipfile
from contextlib import contextmanager
from pathlib import Path

import openpyxl

from tests.programs import require_package

STATUS, RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")
# What a refusal may take: a few times the largest text that is looked at, and the libraries.
MOST_BYTES, MOST_SECONDS = 700e6, 15.0


@contextmanager
def frugally():
    """Check that a block takes little time, and on Linux little memory."""
    measured = RESET.exists()
    if measured:
        RESET.write_text("5")  # the peak counts from here
        before = _bytes("VmRSS")
    begun = time.perf_counter()
    yield
    assert time.perf_counter() - begun < MOST_SECONDS
    if measured:
        assert _bytes("VmHWM") - before < MOST_BYTES


def _bytes(key):
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith(key))
    return 1024 * int(line.split()[1])


def hole(path, size=3_200_000_000):
    """Write a file of zeros that takes no room on the disk."""
    with path.open("wb") as file:
        file.truncate(size)


def text(content):
    """Return what writes a text."""
    return lambda path: path.write_bytes(
        content if isinstance(content, bytes) else content.encode()
    )


def sheet(rows, dimension="A1:B2"):
    """Return what writes a workbook whose sheet has these rows, as XML."""

    def write(path):
        book = io.BytesIO()
        openpyxl.Workbook().save(book)
        with zipfile.ZipFile(book) as old, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
            for part in old.namelist():
                if part != "xl/worksheets/sheet1.xml":
                    new.writestr(part, old.read(part))
            with new.open("xl/worksheets/sheet1.xml", "w") as file:
                name = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
                file.write(f'<worksheet xmlns="{name}"><dimension ref="{dimension}"/>'.encode())
                file.write(b"<sheetData>")
                for part in rows:
                    file.write(part.encode())
                file.write(b"</sheetData></worksheet>")

    return write


def cells(line, *columns):
    """Return a row of ones in these columns."""
    values = "".join(f'<c r="{column}{line}"><v>1</v></c>' for column in columns)
    return f'<row r="{line}">{values}</row>'


def parquet(table, **options):
    """Return what writes a Parquet file of columns."""

    def write(path):
        pa = require_package("pyarrow")
        require_package("pyarrow.parquet").write_table(pa.table(table), path, **options)

    return write


def without_footer(path):
    """Write a Parquet file whose description is damaged."""
    parquet({"load_N": [1.0], "penetration_um": [2.0]})(path)
    content = bytearray(path.read_bytes())
    content[-200:-8] = bytes(192)
    path.write_bytes(content)


def nested(depth, opening="[", closing="]"):
    return opening * depth + closing * depth
