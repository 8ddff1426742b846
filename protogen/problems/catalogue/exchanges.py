"""Problems of exchanges that say requests."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_framed

_FRAME = """
    id: {type: uint8, id: true}
    counter: {type: uint8, counter: true}
    payload: {}
    end: {literal: 0xC0}
"""

_MESSAGES = """
    go: {id: 1, from: host, fields: {speed: uint8, name: {type: ascii, size: 4}}}
    stop: {id: 2, from: host}
    ack: {id: 3, from: robot, fields: {of: uint8}}
    nack: {id: 4, from: robot}
"""


def _with(exchanges: str) -> str:
    return with_framed(_FRAME, _MESSAGES, more=f"transparency: slip\nexchanges: {exchanges}")


EXCHANGE_CODES: tuple[Code, ...] = (
    Code(
        "PG310",
        "exchange-form",
        "An exchange is neither a sequence nor a request",
        """\
An exchange has `steps`, which show a sequence of messages, or a `request` with its `reply`, which
programs go by. The keys `refusal`, `match`, `timeout` and `retries` are about requests;
`unmatched_refusal` is about a `refusal` beside a `match`.
""",
        _with("{drive: {request: go, timeout: 100 ms}}"),
        _with("{drive: {request: go, reply: ack, timeout: 100 ms}}"),
    ),
    Code(
        "PG311",
        "own-reply",
        "A reply comes from the end that asks",
        """\
What answers a request is sent by another endpoint than the request. Here only the endpoint that
asks sends the answer.
""",
        _with("{drive: {request: go, reply: stop}}"),
        _with("{drive: {request: go, reply: ack}}"),
    ),
    Code(
        "PG312",
        "reply-and-refusal",
        "A message is a reply and a refusal",
        """\
A reply settles a request, and a refusal is an error of it. A message can't be both. Where a field
of the reply says whether it was obeyed, the message is the reply, and the program looks at the
field.
""",
        _with("{drive: {request: go, reply: ack, refusal: ack}}"),
        _with("{drive: {request: go, reply: ack, refusal: nack}}"),
    ),
    Code(
        "PG313",
        "request-of-two-exchanges",
        "A message is the request of two exchanges",
        """\
Whoever sends a request waits for what its exchange says. A message is the request of one exchange;
that one can have several replies, of which any settles it.
""",
        _with("{drive: {request: go, reply: ack}, other: {request: go, reply: nack}}"),
        _with("{drive: {request: go, reply: [ack, nack]}}"),
    ),
    Code(
        "PG314",
        "unknown-match",
        "What is to be equal does not exist",
        """\
`match` names parts of the frame or fields of the messages: of each request in front, and of each
reply and refusal behind it. One of these messages has none of that name, or it is a constant. Parts
are those that events show: identities, counters and values. A refusal that has no such value is
`unmatched_refusal`.
""",
        _with("{drive: {request: go, reply: ack, match: {speed: off}}}"),
        _with("{drive: {request: go, reply: ack, match: {speed: of}}}"),
    ),
    Code(
        "PG315",
        "never-equal",
        "What is to be equal never is",
        """\
The values that `match` compares are both numbers, both texts or both bytes. Floats, arrays, structs
and tagged unions are not compared.
""",
        _with("{drive: {request: go, reply: ack, match: {name: of}}}"),
        _with("{drive: {request: go, reply: ack, match: {speed: of}}}"),
    ),
)
