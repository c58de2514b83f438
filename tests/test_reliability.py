"""The page on reliability states what the tests count, and the limits that the program has."""

from cylcontact import reading, tables
from cylcontact.memory import as_size
from tests.counts import PAGE, written


def test_the_page_states_the_recorded_counts():
    """python -m tests.counts writes them."""
    page = PAGE.read_text(encoding="utf-8")
    assert written(page) == page


def test_the_page_states_the_limits():
    page = PAGE.read_text(encoding="utf-8")
    size = "{} | {} |".format
    for row in (
        size("the file of a law of your own", as_size(reading.SPEC_BYTES)),
        size("a result", as_size(reading.RESULT_BYTES)),
        size("as a file", as_size(reading.TABLE_BYTES)),
        size("finished parts of interrupted work", as_size(reading.JOURNAL_BYTES)),
        f"| {tables.MAX_ROWS:,}, {tables.MAX_COLUMNS:,} and {tables.MAX_CELLS:,} |",
    ):
        assert row in page, row
