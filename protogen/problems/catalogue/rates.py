"""Problems of how often messages are sent by themselves."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_message
from protogen.problems.severity import Severity

_LINK = "\nlink: {baud: 1200}"


def _with(rate: str, link: str = "") -> str:
    return with_message(f"rate: {rate}\nfields: {{angle: uint16}}") + link.lstrip("\n")


RATE_CODES: tuple[Code, ...] = (
    Code(
        "PG330",
        "rate-of-nothing",
        "A rate of zero or less",
        """\
The `rate` of a message says how often it is sent by itself, or after what time again. What is sent
only if something happens, or as an answer, has no rate: leave the key out.
""",
        _with("0 Hz"),
        _with("50 Hz"),
    ),
    Code(
        "PG331",
        "rate-of-unknown-unit",
        "A rate in a unit that is not known",
        """\
The `rate` of a message is a number of times a second (`50`, `50 Hz`, `1.5 kHz`), or the time from
one to the next (`20 ms`, `500 us`, `60 s`). Other units have to be converted.
""",
        _with("3000 rpm"),
        _with("50 Hz"),
    ),
    Code(
        "PG332",
        "line-too-busy",
        "More is sent than the line can carry",
        """\
How long a frame takes follows from its size and from the `baud` of the `link`. The messages that an
endpoint sends by itself, each at its `rate`, take more than all of the time, even with the smallest
frames. Probably a rate or the baud rate is not that of the device. `protogen check` shows how busy
each endpoint keeps its line.
""",
        _with("50 Hz", _LINK),
        _with("5 Hz", _LINK),
        Severity.WARNING,
    ),
)
