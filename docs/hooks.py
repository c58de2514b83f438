"""mkdocs: formulas become MathML, which browsers set without scripts or fonts from elsewhere."""

import html
import re

from latex2mathml.converter import convert

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[([](.*?)\\[)\]]</\1>', re.DOTALL)


def on_page_content(text, **_):
    """Set the formulas of a page."""

    def mathml(match):
        latex = html.unescape(match[2])
        if match[1] == "span":
            return convert(latex)
        return f'<div class="formula">{convert(latex, display="block")}</div>'

    return FORMULA.sub(mathml, text)
