"""The reference: the Markdown target's text as HTML, with frames drawn in place of its diagrams."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from markdown_it import MarkdownIt
from markupsafe import Markup

from protogen.model.protocol import Protocol
from protogen.targets.html.drawing import drawings
from protogen.targets.markdown.emit import page_text

if TYPE_CHECKING:
    from markdown_it.rules_inline import StateInline
    from markdown_it.token import Token

_ANCHOR = re.compile(r'<a id="([^"<>&]+)"></a>')
"""An anchor as the Markdown target writes it. Texts of a schema hold no `<`, as that is escaped."""
_CODE_CELL = re.compile(r"<td><code>([^<]*)</code>(?=<|\n)")
"""A cell with nothing but code, of which a page has thousands."""
_HEADINGS = ("h2", "h3")


def reference(protocol: Protocol) -> tuple[Markup, tuple[Heading, ...]]:
    """The page's text, and its headings for a table of contents."""
    parser = _parser()
    tokens = parser.parse(page_text(protocol))
    headings = tuple(_name_headings(tokens))
    text = parser.renderer.render(tokens, parser.options, {"drawings": iter(drawings(protocol))})
    shown = _CODE_CELL.sub(r"<td class=c>\1", text)
    return Markup(shown), headings  # noqa: S704 - made by a parser that passes no HTML.


def inline(text: str) -> Markup:
    """A line of Markdown without its links, which lead to places of its own page."""
    return Markup(_inline_parser().renderInline(text))  # noqa: S704 - made by a parser that passes no HTML.


class Heading:
    """A heading of the page."""

    def __init__(self, level: int, anchor: str, text: str) -> None:
        self.level = level
        self.anchor = anchor
        self.text = text


@cache
def _inline_parser() -> MarkdownIt:
    parser = _parser()
    renderer: Any = parser.renderer
    renderer.rules |= {name: lambda *_: "" for name in ("link_open", "link_close", "anchor")}
    return parser


def _parser() -> MarkdownIt:
    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    parser.inline.ruler.before("text", "anchor", _take_anchor)
    renderer: Any = parser.renderer
    rules = renderer.rules
    rules["anchor"] = _show_anchor
    rules["fence"] = _show_fence
    rules["table_open"] = lambda *_: '<div class="wide" tabindex="0"><table>\n'
    rules["table_close"] = lambda *_: "</table></div>\n"
    rules["thead_open"] = lambda *_: "<thead>"
    rules["tbody_open"] = lambda *_: "<tbody>"
    rules["tr_open"] = lambda *_: "<tr>"
    rules["th_open"] = lambda *_: "<th>"
    rules["td_open"] = lambda *_: "<td>"
    for name in ("td", "th", "tr", "thead", "tbody", "list_item"):
        rules[f"{name}_close"] = lambda *_: ""  # HTML lets their ends be left out.
    return parser


def _take_anchor(state: StateInline, silent: bool) -> bool:
    found = _ANCHOR.match(state.src, state.pos)
    if found is None:
        return False
    if not silent:
        state.push("anchor", "", 0).content = found[1]
    state.pos = found.end()
    return True


def _show_anchor(tokens: Sequence[Token], index: int, *_: object) -> str:
    return f'<span id="{Markup.escape(tokens[index].content)}"></span>'


def _show_fence(tokens: Sequence[Token], index: int, _: object, env: Any) -> str:
    token = tokens[index]
    if token.info == "mermaid":
        return str(next(env["drawings"]))
    return f"<pre>{Markup.escape(token.content)}</pre>\n"


def _name_headings(tokens: Sequence[Token]) -> Iterator[Heading]:
    """Give each heading the name that leads to it, and yield those of the contents."""
    known: set[str] = set()
    for opened, inline in pairwise(tokens):
        if opened.type != "heading_open":
            continue
        children = inline.children or []
        anchor = next((item.content for item in children if item.type == "anchor"), "")
        inline.children = [item for item in children if item.type != "anchor"]
        text = "".join(item.content for item in inline.children)
        name = anchor or _free(_slug(text), known)
        known.add(name)
        opened.attrSet("id", name)
        if opened.tag in _HEADINGS:
            yield Heading(int(opened.tag[1]), name, text)


def _slug(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "section"


def _free(name: str, known: set[str]) -> str:
    """The name, with a number behind it where it is taken."""
    found, number = name, 2
    while found in known:
        found, number = f"{name}-{number}", number + 1
    return found
