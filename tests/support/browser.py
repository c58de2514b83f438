"""A headless Chromium for the tests of pages, and what they measure in it."""

from contextlib import contextmanager

from tests.support.programs import require_package, require_program


@contextmanager
def chromium():
    """Run a headless Chromium, and end it whatever happens."""
    path = require_program("chromium")
    playwright = require_package("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox"])
        try:
            yield browser
        finally:
            browser.close()
