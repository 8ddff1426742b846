"""Problems of several forms of frame on one line."""

from __future__ import annotations

from textwrap import indent

from protogen.problems.catalogue.code import Code

_HEAD = """\
protocol: demo
endpoints: {motor: Motor controller}
byte_order: big
"""

_SHORT = """\
short:
  frame:
    start:   {literal: 2}
    length:  {type: uint8, counts: payload}
    payload: {}
    end:     {literal: 3}
"""

_LONG = _SHORT.replace("short", "long").replace("literal: 2", "literal: 4")

_DECISION = """\
decisions:
  short_wins:
    question: Is a frame that begins with 2 a short one or a long one?
    document: Both begin so.
    choice: It is a short one, if it is a valid one.
    because: Short frames are sent all the time.
"""


def _with_forms(forms: str, *, message: str = "", more: str = "") -> str:
    """A schema with these forms of frame, and one message; `more` are keys of the root."""
    text = f"{_HEAD}forms:\n{indent(_protected(forms), '  ')}{more}"
    return f"{text}messages:\n  speed: {{from: motor, {message}fields: {{rpm: uint16}}}}\n"


def _protected(forms: str) -> str:
    """The forms with their delimiters kept out of the data."""
    return forms.replace("  frame:", "  transparency: {encoding: base16-upper}\n  frame:")


FORM_CODES: tuple[Code, ...] = (
    Code(
        "PG170",
        "unknown-form",
        "A form of frame that there is not",
        """\
A message or an example names a form of frame that does not stand under `forms`. Correct the
spelling, or add the form.
""",
        _with_forms(_SHORT + _LONG, message="forms: [shrot], "),
        _with_forms(_SHORT + _LONG, message="forms: [short], "),
    ),
    Code(
        "PG171",
        "frame-beside-forms",
        "A frame beside forms of frame",
        """\
With `forms`, each form has a `frame` and a `transparency` of its own, and the root has none. Forms
that only some endpoints send say so with `from`.
""",
        _with_forms(_SHORT, more="frame: {start: {literal: 5}, payload: {}, end: {literal: 6}}\n"),
        _with_forms(_SHORT),
    ),
    Code(
        "PG172",
        "message-in-no-form",
        "A message that no form of frame carries",
        """\
An endpoint sends the message, but none of its forms of frame is one that the message names. Name
one of them under the message's `forms`, or let the form be sent `from` that endpoint.
""",
        _with_forms(
            _SHORT + _LONG.replace("  frame:", "  from: [other]\n  frame:"),
            message="forms: [long], ",
        ).replace("motor: Motor controller", "motor: Motor controller, other: Other end"),
        _with_forms(
            _SHORT + _LONG.replace("  frame:", "  from: [other]\n  frame:"),
            message="forms: [short], ",
        ).replace("motor: Motor controller", "motor: Motor controller, other: Other end"),
    ),
    Code(
        "PG173",
        "forms-alike",
        "Two forms of frame that begin alike",
        """\
Some bytes could be a frame of either form: none of the bytes in front of the payload has to be
another one. Literals, constant bits, ranges of a length in the same place (a whole part or bits of
one), and a first byte of a range of its own are what a receiver can rely on. If the protocol is so,
write a decision, and name it with `behind` in the form that comes later: of bytes that are a valid
frame of both forms, the one above wins.
""",
        _with_forms(_SHORT + _LONG.replace("literal: 4", "literal: 2")),
        _with_forms(
            _SHORT
            + _LONG.replace("literal: 4", "literal: 2").replace(
                "  frame:", "  behind: short_wins\n  frame:"
            ),
            more=_DECISION,
        ),
    ),
    Code(
        "PG174",
        "forms-found-differently",
        "Forms of frame whose starts are found in different ways",
        """\
A receiver looks for the starts of all forms at once. That works where each begins with a literal,
or with a first byte of a range of its own. Forms without a mark at their start, such that share the
delimiter between two frames, and such that only a silence ends, go together only with others of
the same kind.
""",
        _with_forms(_SHORT + _LONG.replace("    start:   {literal: 4}\n", "")),
        _with_forms(_SHORT + _LONG),
    ),
)
"""The problems of forms of frame."""
