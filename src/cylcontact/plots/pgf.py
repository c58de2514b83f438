"""PGF figures whose text is text: matplotlib hands it to TeX as it is, which would run it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from matplotlib.backends import backend_pgf

from cylcontact.plots.latex import latex

__all__ = ["plain_pgf"]

# A formula between two dollar signs that are not escaped, in a group of its own for `re.split`.
_FORMULA = re.compile(r"((?<!\\)\$(?:\\\$|[^$])*\$)")


class _PlainRenderer(backend_pgf.RendererPgf):
    """Escapes all text but formulas."""

    def draw_text(
        self, gc: Any, x: float, y: float, s: str, prop: Any, angle: float,
        ismath: Any = False, mtext: Any = None,
    ) -> None:  # fmt: skip
        super().draw_text(gc, x, y, _escaped(s, ismath), prop, angle, ismath, mtext)  # type: ignore[no-untyped-call]

    def get_text_width_height_descent(self, s: str, prop: Any, ismath: Any) -> Any:
        return super().get_text_width_height_descent(_escaped(s, ismath), prop, ismath)  # type: ignore[no-untyped-call]


def _escaped(text: str, has_formulas: bool) -> str:
    r"""Return a text of a figure for TeX.

    Examples
    --------
    >>> print(_escaped(r"$\nu$ of \input", True), _escaped("5 $ a_b", False))
    $\nu$ of \textbackslash{}input 5 \$ a\_b
    """
    if not has_formulas:
        return latex(text)
    parts = _FORMULA.split(text)
    parts[::2] = (latex(part.replace(r"\$", "$")) for part in parts[::2])
    return "".join(parts)


@contextmanager
def plain_pgf() -> Iterator[None]:
    """Let matplotlib escape text in PGF files within a `with` block."""
    before = backend_pgf.RendererPgf
    backend_pgf.RendererPgf = _PlainRenderer  # type: ignore[misc]
    try:
        yield
    finally:
        backend_pgf.RendererPgf = before  # type: ignore[misc]
