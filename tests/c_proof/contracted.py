"""ACSL contracts for generated C, which WP proves: an event has what its message needs.

EVA does not keep together an event's size and the count of an array that a check has tested with
it. Contracts do: each says of a payload what `load` asks of it. `check` ensures it, what fills an
event hands it on, and `dispatch` requires it. They are comments: the program stays what a user
compiles.
"""

from __future__ import annotations

import re

from c_proof.contracts import Contracts
from c_proof.handled import handled
from c_proof.needs import needs, predicates, sizes
from c_proof.polled import polled
from c_proof.portable import WORDS, portable
from c_proof.pure import purify
from c_proof.received import SHORT
from protogen.model.protocol import Protocol

_CHECK = re.compile(r"^static enum \w+ (\w+)_check\([^;{]*size_t \*need\) \{", re.MULTILINE)
_SENDER = re.compile(r"^(?:void|enum \w+) (\w+)_decoder_push\(", re.MULTILINE)


def contracted(protocol: Protocol, header: str, source: str) -> Contracts:
    """Contracts that say: an event of a message has a payload that `load` can read."""
    name, upper = protocol.name, protocol.name.upper()
    made = Contracts(header, portable(source))
    asked = needs(protocol, header)
    for found in _CHECK.findall(source):
        message = found.removeprefix(f"{name}_")
        if made.has(f"{found}_check"):
            fits = f"{message}_fits(payload, size)"
            # `dispatch` is analysed with payloads that fit. Long ones are left to `decode`, which
            # has to take them all.
            implies = "<==>" if _varies(header, found) > SHORT else "==>"
            made.put(
                f"{found}_check",
                r"assigns \nothing",
                rf"ensures 0 <= \result < 255 && (\result == {upper}_OK {implies} {fits})",
            )
    for prefix in _SENDER.findall(source):
        if f"{prefix}_handler" in header:
            handled(made, prefix, upper)
        else:
            polled(made, prefix, upper)
    _checked_loops(made)
    for function in list(made.functions):
        purify(made, function)
    made.declare("".join(WORDS.format(size=size, last=size - 1) for size in (4, 8)))
    made.define(predicates(asked, upper))
    return made


def _varies(header: str, prefix: str) -> int:
    """Size of a message's longest payload, if others are shorter."""
    least, most = sizes(header)[prefix.upper()]
    return most if least < most else 0


def _checked_loops(made: Contracts) -> None:
    """Bounds of what a check adds up."""
    made.source = re.sub(
        r"( +)while \(at < size\) \{\n +at \+= 3U;",
        r"\1//@ loop invariant at <= size + 2 && (at - 8) % 3 == 0; loop assigns at;\n\g<0>",
        made.source,
    )
