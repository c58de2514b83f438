"""Texts of others that are markup, commands, formulas, or too much, and what pages consist of."""

from html.parser import HTMLParser

TAME = "specimen 7"
HOSTILE = {
    "an element of HTML": '<img src=x onerror=alert(1)><b>&amp; "quoted"',
    "the end of an attribute": "' onmouseover='alert(1)\" autofocus onfocus=\"alert(1)",
    "the end of a script": "</script></title></style><script>alert(1)</script>\u2028",
    "a template": "{{ 7 * 7 }}{% raw %} ${name} $name {0} %(x)s",
    "Markdown": "[a](javascript:alert(1)) ![b](x) `c` **d** | e |",
    "LaTeX": r"\input{/etc/passwd}\write18{id} & % # _ ^^5c ~ -- \\",
    "a formula": r"$x^2_3$ $\nosuch{$",
    "half a formula": r"$\frac{1",
    "one dollar": "$",
    "rich markup": "[red]a[/red] [link=https://x.y]b[/link] :smile: [/]",
    "an escape sequence": "\x1b[2J\x1b[31mred\x1b]8;;https://x.y\x07\x9b1A",
    "control characters": "a\x00b\x07c\x08\x7f\x85d",
    "line breaks": "one\ntwo\r\nthree\rfour\x0bfive\u2028six",
    "the other direction": "a\u202eb\u2066c\u061cd",
    "characters without width": "a\u200b\u200d\ufeff\u00ad\U000e0041b",
    "a call of a program": "=cmd|' /C calc'!A0",
    "a sum": "+1+1",
    "a difference": "-2+3",
    "a function": '@SUM(1;2)","=1+1',
    "a tab and a formula": "\t=1+1",
    "an apostrophe and a formula": "'=1+1",
    "the end of a comment": '*/ system("id"); /* ??/ \\',
    "the end of a string": '"""\nimport os\n"""; %{\n%}',
    "an entity of XML": "<!DOCTYPE a [<!ENTITY x SYSTEM 'file:///etc/passwd'>]>&x;]]>-->",
    "a path": "../../../x",
    "a leading underscore": "_hidden",
    "letters of the world": "Prüfstück Ελ русский عربي",
    "a million characters": "x" * 1_000_000,
}
SURROGATE = "a\udcffb"


class Structure(HTMLParser):
    """The elements of a page with the names of their attributes, and its visible text."""

    def __init__(self, page):
        super().__init__()
        self.elements, self.texts = [], []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, tuple(name for name, _ in attrs)))

    def handle_data(self, data):
        self.texts.append(data)

    def handle_comment(self, _data):
        self.elements.append(("comment", ()))

    handle_decl = handle_pi = unknown_decl = handle_comment


def elements(page):
    """Return the elements of a page, doctype and comments too."""
    return Structure(page).elements
