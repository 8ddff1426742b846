"""YAML events -> nodes.

PyYAML parses; putting the nodes together is done here rather than by its composer, because
aliases, depth and size must be bounded while the tree grows, not afterwards. Its two parsers give
the same trees with the same spans. Where they differ is what they accept: without libyaml, a `?`
inside of a text between brackets needs quotes, for one.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import msgspec
import yaml

from protogen.problems import Problems, Span
from protogen.schema.text.nodes import Node, ScalarNode
from protogen.schema.text.open_nodes import OpenCollection, OpenList, OpenMapping
from protogen.schema.text.places import Places, position_of
from protogen.schema.text.scalars import resolve

GREATEST_DEPTH = 64
"""Greatest depth of mappings and lists inside each other, aliases written out."""
GREATEST_COUNT = 1_000_000
"""Greatest number of keys and values in a file, aliases written out."""

_TOO_DEEP = f"values are nested more than {GREATEST_DEPTH} deep"

Loader = Callable[[str], Any]
"""Makes a PyYAML loader, of which only the events are used, for a text."""

PURE_LOADER: Loader = yaml.SafeLoader
FAST_LOADER: Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""The loader of libyaml where PyYAML was built with it."""

_SURROGATE = re.compile("[\ud800-\udfff]")
_SYNTAX_HINTS = {
    "mapping values are not allowed": "a text that holds `: ` needs quotes around it",
    "cannot start any token": "a text that starts with this character needs quotes around it",
    "did not find expected key": "the indentation fits no mapping above",
    "expected <block end>": "the indentation fits nothing above",
    "did not find expected '-'": "the indentation fits no list above",
    "could not find expected ':'": "a key needs a `:` and a space behind it",
    "unexpected end of stream": "a quote or a bracket is never closed",
    "block sequence entries are not allowed": "a list starts on the line below its key",
    "<document start>": "a file holds one mapping and nothing behind it",
    "unknown escape character": "a backslash is written twice between double quotes",
}
"""Hints for complaints of the parser, by words of its message."""


def compose(
    text: str, file: str, problems: Problems, *, loader: Loader = FAST_LOADER
) -> Node | None:
    """Return the tree of the one document in ``text``, or None if there is no usable one.

    ``text`` has no tabs in its structure and only characters that YAML allows.
    """
    composer = _Composer(text, file, problems)
    try:
        composer.take(text, loader)
    except _GiveUpError:
        return None
    except yaml.MarkedYAMLError as error:
        _report_syntax(error, text, Places(text, file), problems)
        return None
    return composer.finish()


class _GiveUpError(Exception):
    """A problem was reported that makes going on pointless."""


class _Anchored(msgspec.Struct, frozen=True):
    """A node that an alias can repeat."""

    node: Node
    count: int
    """Number of its keys and values, itself included."""
    height: int
    """Depth of mappings and lists inside each other in it."""


class _Composer:
    """Puts one document together, event by event."""

    def __init__(self, text: str, file: str, problems: Problems) -> None:
        self._places = Places(text, file)
        self._problems = problems
        self._open: list[OpenCollection] = []
        self._anchors: dict[str, _Anchored | None] = {}
        self._count = 0
        self._root: Node | None = None

    def take(self, text: str, loader: Loader) -> None:
        """Take the events of a parser of the text."""
        handlers: dict[type, Callable[[Any], None]] = {
            yaml.DocumentStartEvent: self._start_document,
            yaml.ScalarEvent: self._scalar,
            yaml.AliasEvent: self._alias,
            yaml.MappingStartEvent: self._start,
            yaml.SequenceStartEvent: self._start,
            yaml.MappingEndEvent: self._end,
            yaml.SequenceEndEvent: self._end,
        }
        parser = loader(text)
        try:
            while (event := parser.get_event()) is not None:  # None is behind the stream's end.
                handler = handlers.get(type(event))
                if handler is not None:
                    handler(event)
        except (ValueError, OverflowError) as error:
            # The parser in Python takes any number for the code of a character.
            problem = "found the escape of a character that does not exist"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=parser.get_mark()) from error
        finally:
            parser.dispose()

    def finish(self) -> Node | None:
        """Return the root of the document, or None if there is no document or an empty one."""
        root = self._root
        if root is None or (isinstance(root, ScalarNode) and root.plain and not root.text):
            self._problems.add("PG008", self._places.of_file(), "the file is empty")
            return None
        return root

    def _start_document(self, event: Any) -> None:
        if self._root is not None:
            span = self._places.at(position_of(event.start_mark), 3 if event.explicit else 0)
            raise self._give_up("PG008", span, "a second document begins here")

    def _scalar(self, event: Any) -> None:
        if event.tag is not None:
            self._report_tag(event)
        text, plain = event.value, not event.style
        written_out = text or not plain
        span = self._places.scalar(event) if written_out else self._empty_span(event)
        node = ScalarNode(resolve(text) if plain else text, text, plain, span)
        if not plain and not text.isascii() and _SURROGATE.search(text):
            message = "the text holds half of a surrogate pair, which is no character"
            raise self._give_up("PG004", span, message)
        self._add(1, span)
        if event.anchor is not None:
            self._anchors[event.anchor] = _Anchored(node, 1, 0)
        self._place(node, 0, span)

    def _alias(self, event: Any) -> None:
        name = event.anchor
        span = self._places.span(position_of(event.start_mark), position_of(event.end_mark))
        if name not in self._anchors:
            hint = "a text that starts with `*` needs quotes around it"
            raise self._give_up("PG004", span, f"no anchor `&{name}` stands before this", hint)
        anchored = self._anchors[name]
        if anchored is None:
            raise self._give_up("PG007", span, f"`*{name}` stands inside of what it repeats")
        self._add(anchored.count, span)
        self._check_depth(anchored.height, span)
        self._place(anchored.node, anchored.height, span)

    def _start(self, event: Any) -> None:
        if event.tag is not None:
            self._report_tag(event)
        begin = self._places.begin(event)
        span = self._places.at(begin, 1)
        self._add(1, span)
        self._check_depth(1, span)
        if event.anchor is not None:
            self._anchors[event.anchor] = None
        if isinstance(event, yaml.MappingStartEvent):
            self._open.append(OpenMapping(event, begin, self._count - 1, self._problems))
        else:
            self._open.append(OpenList(event, begin, self._count - 1))

    def _end(self, event: Any) -> None:
        done = self._open.pop()
        end = position_of(event.end_mark) if done.event.flow_style else done.end
        node = done.close(self._places.span(done.begin, end))
        if done.event.anchor is not None:
            count = self._count - done.counted
            self._anchors[done.event.anchor] = _Anchored(node, count, done.height)
        self._place(node, done.height, node.span)

    def _place(self, node: Node, height: int, span: Span) -> None:
        if self._open:
            self._open[-1].put(node, height, span)
        else:
            self._root = node

    def _report_tag(self, event: Any) -> None:
        tag, span = self._places.tag(event)
        self._problems.add("PG011", span, f"the tag `{tag}` is not allowed")

    def _check_depth(self, height: int, span: Span) -> None:
        if len(self._open) + height > GREATEST_DEPTH:
            raise self._give_up("PG010", span, _TOO_DEEP)

    def _add(self, count: int, span: Span) -> None:
        self._count += count
        if self._count > GREATEST_COUNT:
            message = f"with this, the file holds more than {GREATEST_COUNT} values"
            raise self._give_up("PG007", span, message)

    def _give_up(self, code: str, span: Span, message: str, hint: str | None = None) -> Exception:
        self._problems.add(code, span, message, hint)
        return _GiveUpError()

    def _empty_span(self, event: Any) -> Span:
        """Return the place of a value that was left out: right behind its key."""
        around = self._open[-1] if self._open else None
        end = around.end if isinstance(around, OpenMapping) else position_of(event.end_mark)
        return self._places.at(end, 0)


def _mark_hint(error: yaml.MarkedYAMLError, text: str) -> str | None:
    """Hint by what stands where the parser stopped."""
    mark, context = error.problem_mark, error.context_mark
    if mark is None:
        return None
    here = text[mark.index : mark.index + 1]
    if here in ("}", "]") and "expected key" in (error.problem or ""):
        return f"there is one `{here}` too many"
    if context is not None and "flow" in (error.context or ""):
        lines = text[context.index : mark.index].splitlines()
        if any(" #" in line for line in lines):
            return "a `#` behind a space begins a comment; a text that holds one needs quotes"
    return None


def _report_syntax(
    error: yaml.MarkedYAMLError, text: str, places: Places, problems: Problems
) -> None:
    """Report what the parser could not read, in its words."""
    mark = error.problem_mark or error.context_mark
    problem = error.problem or "this is not YAML"
    span = places.of_file() if mark is None else places.point(position_of(mark))
    if "nesting depth" in problem:  # libyaml reads ahead, and has a bound of its own.
        problems.add("PG010", span, _TOO_DEEP)
        return
    hint = next((hint for words, hint in _SYNTAX_HINTS.items() if words in problem), None)
    hint = _mark_hint(error, text) or hint
    notes = []
    if error.context is not None and error.context_mark is not None:
        notes.append((places.point(position_of(error.context_mark)), error.context))
    problems.add("PG004", span, problem, hint, notes)
