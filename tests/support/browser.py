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


@contextmanager
def opened(browser, path, width=1440, theme="light"):
    """Open a page from disk; it may ask for nothing else than files, and log nothing."""
    context = browser.new_context(
        viewport={"width": width, "height": 900}, color_scheme=theme, accept_downloads=True
    )
    page = context.new_page()
    page.set_default_timeout(15_000)
    logged, asked = [], []
    page.on("console", lambda message: logged.append(message.text))
    page.on("pageerror", lambda error: logged.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    try:
        page.goto(path.as_uri())
        yield page
        assert logged == []
        assert all(url.startswith(("file:", "data:", "blob:")) for url in asked)
    finally:
        context.close()
