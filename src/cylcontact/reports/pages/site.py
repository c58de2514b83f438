"""Build the site: the documentation, where there is one, and the pages of the results."""

from __future__ import annotations

import logging
import os
import shutil
import tempfile
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from cylcontact.files.writing import require_writable
from cylcontact.reports.bench import Bench
from cylcontact.reports.pages.content import collect
from cylcontact.support.errors import InputError
from cylcontact.support.progress import Progress, silent

__all__ = ["Site", "build_site"]

HERE = Path(__file__).parent
# What every site has, and hardly another folder.
MARK = "search/search_index.json"


@dataclass(frozen=True)
class Site:
    """The site on disk."""

    index: Path
    missing: tuple[str, ...]


def build_site(bench: Bench, folder: Path, progress: Progress = silent) -> Site:
    """Build the pages of the results in a folder; in a checkout, within its documentation.

    They need no server and no network. Figures, fits and statements that fail are listed as
    missing, with the reason. The folder changes only when all pages are made.
    """
    _require_mkdocs()
    require_writable(folder / "index.html")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / MARK).is_file():
        rule, remedy = "holds files that are no site", "choose a new folder"
        raise InputError(str(folder), "", None, rule, remedy)
    documented = (bench.root / "mkdocs.yml").is_file()
    content = collect(bench, "results.md" if documented else "index.md", progress)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".site-") as scratch:
        made = Path(scratch) / "site"
        _build(bench, documented, content, made)
        if folder.is_dir():
            shutil.rmtree(folder)
        made.rename(folder)
    return Site(folder / "index.html", content.missing)


def _require_mkdocs() -> None:
    """Refuse to begin without the libraries that build the site."""
    try:
        for name in ("latex2mathml", "material", "mkdocs"):
            import_module(name)
    except ImportError as error:
        rule = f"needs {error.name}, which is not installed"
        remedy = "pip install 'cylcontact[docs]', or make extras"
        raise InputError("report", "", None, rule, remedy) from None


class _Warnings(logging.Handler):
    """Notes what mkdocs warns of, such as a link to nowhere."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.told: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Note one warning."""
        self.told.append(" ".join(record.getMessage().split()))


def _build(bench: Bench, documented: bool, content: object, folder: Path) -> None:
    """Let mkdocs build the site."""
    # The theme would advertise a fork.
    os.environ.setdefault("NO_MKDOCS_2_WARNING", "1")
    from mkdocs.commands.build import build
    from mkdocs.config import load_config
    from mkdocs.exceptions import Abort, MkDocsException

    file = (bench.root if documented else HERE) / "mkdocs.yml"
    warnings, logger = _Warnings(), logging.getLogger("mkdocs")
    logger.addHandler(warnings)
    with tempfile.TemporaryDirectory() as empty:
        docs = bench.root / "docs" if documented else Path(empty)
        try:
            config = load_config(
                str(file.resolve()),
                docs_dir=str(docs.resolve()),
                site_dir=str(folder.resolve()),
                hooks=[str(HERE / "hooks.py")],
                strict=True,
            )
            config.extra["content"] = content
            build(config)
        except (Abort, MkDocsException) as error:
            rule = f"cannot be built: {'; '.join(warnings.told) or str(error).strip()}"
            raise InputError(str(file), "", None, rule, "mend these pages") from error
        finally:
            logger.removeHandler(warnings)
