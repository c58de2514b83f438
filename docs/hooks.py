"""mkdocs: formulas become MathML, which browsers set without scripts or fonts from elsewhere."""

import re

from latex2mathml.converter import convert

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[([](.*?)\\[)\]]</\1>', re.DOTALL)


def on_page_content(html, **_):
    """Set the formulas of a page."""

    def mathml(match):
        display = "block" if match[1] == "div" else "inline"
        return convert(match[2].replace("&lt;", "<").replace("&gt;", ">"), display=display)

    return FORMULA.sub(mathml, html)
