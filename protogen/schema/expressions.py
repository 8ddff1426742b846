"""Text of expressions, read into trees.

expression = term of `or`, `and`, `not`, a comparison, `in [...]`, + - * // %, a sign
number     = 12, 0x1F, 'A'
name       = field, field.member, field.bits, or the name of a value
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

from protogen.model.expressions import (
    Arithmetic,
    Comparison,
    Expression,
    Junction,
    Membership,
    Minus,
    Not,
    Number,
    Operand,
)

GREATEST_LENGTH = 400
"""Characters of the longest expression."""
_GREATEST_DEPTH = 32
"""So deep may brackets be nested."""

_NAME = r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*"
_TOKEN = re.compile(
    rf"\s*(?:(?P<number>0x[0-9A-Fa-f]+|[0-9]+)(?![0-9A-Za-z_.])|(?P<character>'[^'\\]')"
    rf"|(?P<name>{_NAME}(?:\.{_NAME})*)(?![0-9A-Za-z_.])|(?P<sign>//|[=!<>]=|[-+*%<>()\[\],]))"
)
_WORDS = ("and", "or", "not", "in")
_COMPARISONS = ("==", "!=", "<", "<=", ">", ">=")
_MEANT = {
    "=": "`==` compares",
    "/": "`//` divides whole numbers",
    "&": "`and` joins conditions; name the bits of a number to ask for them",
    "|": "`or` joins conditions; name the bits of a number to ask for them",
    "!": "`not` turns a condition round",
    "^": "name the bits of a number to ask for them",
    ".": "a name stands on both sides of the point",
}
"""What stands here for signs of other languages."""


class ExpressionError(Exception):
    """A text that is no expression."""

    def __init__(self, text: str, at: int, hint: str | None = None) -> None:
        super().__init__(text)
        self.text = text
        self.at = at
        """Offset of what is wrong."""
        self.hint = hint


class _Token(NamedTuple):
    kind: str
    """`number`, `character`, `name`, `sign`, or `end`."""
    text: str
    at: int


def parse_expression(text: str) -> Expression:
    """The expression of a text, whose names are not looked up. Raises ExpressionError."""
    if len(text) > GREATEST_LENGTH:
        raise ExpressionError(f"an expression has at most {GREATEST_LENGTH} characters", 0)
    if re.fullmatch(_NAME, text):
        return Operand((text,))  # Whatever the field is called: `in` may be one.
    return _Parser(_tokens(text)).whole()


def _tokens(text: str) -> list[_Token]:
    found: list[_Token] = []
    at, end = 0, len(text.rstrip())
    while at < end:
        match = _TOKEN.match(text, at)
        if match is None:
            at += len(text[at:]) - len(text[at:].lstrip())
            raise _strange(text, at)
        kind = match.lastgroup or ""
        found.append(_Token(kind, match[kind], match.start(kind)))
        at = match.end()
    return [*found, _Token("end", "", end)]


def _strange(text: str, at: int) -> ExpressionError:
    sign = text[at]
    word = re.match(r"[0-9A-Za-z_.]+", text[at:])
    if word is not None:
        return ExpressionError(f"`{word[0]}` is neither a name nor a number", at)
    return ExpressionError(f"`{sign}` means nothing here", at, _MEANT.get(sign))


class _Parser:
    """Reads by recursive descent, the loosest operators first."""

    def __init__(self, tokens: list[_Token]) -> None:
        self._tokens = tokens
        self._next = 0
        self._depth = 0

    def whole(self) -> Expression:
        """The expression of all tokens."""
        found = self._either()
        if self._token.kind != "end":
            raise self._unexpected()
        return found

    @property
    def _token(self) -> _Token:
        return self._tokens[self._next]

    def _is(self, *texts: str) -> bool:
        is_known = self._token.kind == "sign" or self._token.text in _WORDS
        return is_known and self._token.text in texts

    def _take(self) -> _Token:
        token = self._token
        self._next += 1
        return token

    def _expect(self, text: str) -> None:
        if not self._is(text):
            raise self._unexpected(f"`{text}` is missing")
        self._take()

    def _unexpected(self, why: str = "") -> ExpressionError:
        token = self._token
        if token.kind == "end":
            return ExpressionError(why or "something is missing at the end", token.at)
        return ExpressionError(why or f"`{token.text}` is not expected here", token.at)

    # --- conditions -------------------------------------------------------------------------------

    def _either(self) -> Expression:
        left = self._both()
        while self._is("or"):
            at = self._take().at
            left = Junction("or", left, self._both(), at=at)
        return left

    def _both(self) -> Expression:
        left = self._negated()
        while self._is("and"):
            at = self._take().at
            left = Junction("and", left, self._negated(), at=at)
        return left

    def _negated(self) -> Expression:
        if not self._is("not"):
            return self._compared()
        at = self._take().at
        return Not(self._nested(self._negated), at=at)

    def _compared(self) -> Expression:
        left = self._sum()
        if self._is("in"):
            return self._listed(left)
        if self._is("not"):
            at = self._take().at
            if not self._is("in"):
                raise self._unexpected("`in` is missing")
            return Not(self._listed(left), at=at)
        if self._is(*_COMPARISONS):
            token = self._take()
            found = Comparison(token.text, left, self._sum(), at=token.at)  # type: ignore[arg-type]
            if self._is(*_COMPARISONS):
                hint = "join two comparisons by `and`"
                raise ExpressionError("comparisons do not follow each other", self._token.at, hint)
            return found
        return left

    def _listed(self, left: Expression) -> Expression:
        at = self._take().at
        self._expect("[")
        values = [self._sum()]
        while self._is(","):
            self._take()
            values.append(self._sum())
        self._expect("]")
        return Membership(left, tuple(values), at=at)

    # --- numbers ----------------------------------------------------------------------------------

    def _sum(self) -> Expression:
        left = self._product()
        while self._is("+", "-"):
            token = self._take()
            left = Arithmetic(token.text, left, self._product(), at=token.at)  # type: ignore[arg-type]
        return left

    def _product(self) -> Expression:
        left = self._signed()
        while self._is("*", "//", "%"):
            token = self._take()
            left = Arithmetic(token.text, left, self._signed(), at=token.at)  # type: ignore[arg-type]
        return left

    def _signed(self) -> Expression:
        if not self._is("-"):
            return self._single()
        at = self._take().at
        inner = self._nested(self._signed)
        return Number(-inner.value, at=at) if isinstance(inner, Number) else Minus(inner, at=at)

    def _single(self) -> Expression:
        if self._is("("):
            self._take()
            found = self._nested(self._either)
            self._expect(")")
            return found
        token = self._token
        if token.kind not in ("number", "character", "name") or token.text in _WORDS:
            raise self._unexpected()
        self._take()
        if token.kind == "number":
            return Number(int(token.text, 16 if "x" in token.text else 10), at=token.at)
        if token.kind == "character":
            return Number(self._code(token), name=token.text, at=token.at)
        return Operand(tuple(token.text.split(".")), at=token.at)

    def _code(self, token: _Token) -> int:
        code = ord(token.text[1])
        if code > 0xFF:
            raise ExpressionError(f"{token.text} is not one byte", token.at)
        return code

    def _nested(self, read: Callable[[], Expression]) -> Expression:
        """What stands inside of something else of its kind."""
        self._depth += 1
        if self._depth > _GREATEST_DEPTH:
            text = f"an expression is nested at most {_GREATEST_DEPTH} deep"
            raise ExpressionError(text, self._token.at)
        found = read()
        self._depth -= 1
        return found
