"""Text for LaTeX."""

from __future__ import annotations

import re

# LaTeX's special characters, and the characters beyond ASCII in our texts.
LATEX = {
    "\\": r"\textbackslash{}",
    **{mark: f"\\{mark}" for mark in "&%$#_{}"},
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\ensuremath{<}",
    ">": r"\ensuremath{>}",
    "|": r"\ensuremath{|}",
    **{
        letter: rf"\ensuremath{{\{name}}}"
        for letter, name in {
            **{"α": "alpha", "β": "beta", "δ": "delta", "Δ": "Delta", "ε": "varepsilon"},
            **{"κ": "kappa", "Λ": "Lambda", "λ": "lambda", "μ": "mu", "ν": "nu", "π": "pi"},
            **{"σ": "sigma", "φ": "varphi", "χ": "chi", "θ": "theta", "τ": "tau", "Σ": "Sigma"},
            **{"ω": "omega", "·": "cdot", "×": "times", "≤": "leq", "≥": "geq", "∞": "infty"},
            **{"≈": "approx", "→": "to", "±": "pm", "′": "prime", "√": "surd", "∝": "propto"},
        }.items()
    },
    "µ": r"\ensuremath{\mu}",
    "−": r"\ensuremath{-}",
    "°": r"\ensuremath{^\circ}",
    "…": r"\dots{}",
    "–": "--",
    "—": "---",
    "\u2009": r"\,",
    **{
        raised: rf"\ensuremath{{^{{{plain}}}}}"
        for raised, plain in zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻ⁿ⁺", (*"0123456789-n+",), strict=True)
    },
    **{
        lowered: rf"\ensuremath{{_{{{plain}}}}}"
        for lowered, plain in zip("₀₁₂₃₄₅₆₇₈₉₋ₙᵢⱼ", (*"0123456789-nij",), strict=True)
    },
}


def latex(text: str) -> str:
    r"""Escape a text for LaTeX.

    No part of it acts as a command or ends a paragraph; characters that are not listed stay as
    they are, in UTF-8.

    Examples
    --------
    >>> print(latex("ΔR_i < 50 % of R², {x}"))
    \ensuremath{\Delta}R\_i \ensuremath{<} 50 \% of R\ensuremath{^{2}}, \{x\}
    """
    # Two hyphens make no dash, and a cell that begins with [ or * is no option of the row above.
    parts = re.split("(?<=-)(?=-)", " ".join(text.split("\n")))
    escaped = "{}".join("".join(LATEX.get(mark, mark) for mark in part) for part in parts)
    return f"{{{escaped[0]}}}{escaped[1:]}" if escaped.startswith(("[", "*")) else escaped
