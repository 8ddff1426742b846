"""The framing analysis of a protocol, for people and for programs."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

from protogen.cli.console import print_table

if TYPE_CHECKING:
    from rich.console import Console

    from protogen.model.framing import MessageFraming
    from protogen.model.protocol import Protocol, Sender

_INDENT = "  "


def print_analysis(out: Console, path: str, protocol: Protocol) -> None:
    """Print what the compiler worked out about each sender of a protocol."""
    from rich.text import Text

    out.print(Text.assemble((path, "bold cyan"), ": ", (protocol.title, "bold")))
    out.print(f"{_INDENT}{_contents(protocol)}")
    for sender in protocol.senders:
        title = next(item.title for item in protocol.endpoints if item.name == sender.endpoint)
        form = "" if sender.is_only_form else f", {sender.form}"
        out.print(Text.assemble(_INDENT, (f"{sender.endpoint}{form}", "bold"), f": {title}"))
        _print_properties(out, protocol, sender)
        _print_messages(out, sender)
    out.print()


def _contents(protocol: Protocol) -> str:
    verified, contradicting = count_examples(protocol)
    counts = [
        f"messages: {len(protocol.messages)}",
        f"examples verified: {verified}",
        f"examples that contradict the document: {contradicting}",
        f"decisions: {len(protocol.decisions)}",
    ]
    return ", ".join(counts)


def count_examples(protocol: Protocol) -> tuple[int, int]:
    """Return how many examples agree with the schema, and how many are known to differ."""
    examples = [example for message in protocol.messages for example in message.examples]
    contradicting = sum(example.contradicts is not None for example in examples)
    return len(examples) - contradicting, contradicting


def _print_properties(out: Console, protocol: Protocol, sender: Sender) -> None:
    from rich.text import Text

    for name, text in (*_properties(sender), *_busy(protocol, sender)):
        label = Text(f"{_INDENT * 2}{name:<20}", style="dim")
        out.print(label.append(text, style="default"))


def _properties(sender: Sender) -> Iterator[tuple[str, str]]:
    from protogen.model.sizes import SizeSet

    framing = sender.framing
    yield "start", framing.finds_start
    yield "end", framing.finds_end
    synchronising = "yes" if framing.self_synchronising else "no"
    yield "self-synchronising", f"{synchronising}: {framing.why_synchronising}"
    sizes = SizeSet.between(framing.least, framing.greatest)
    yield "frame", _bytes(str(sizes).replace("..", " to "))
    yield "overhead", _overhead(sender)
    for index, sentence in enumerate(framing.undetected or ("none",)):
        yield ("undetected errors" if index == 0 else ""), sentence


def _busy(protocol: Protocol, sender: Sender) -> Iterator[tuple[str, str]]:
    from protogen.model.load import line_load

    load = line_load(protocol, sender.endpoint)
    if load is not None and sender is protocol.forms(sender.endpoint)[0]:
        yield "busy line", f"{load.shown}, with the rates of its messages"


def _overhead(sender: Sender) -> str:
    from protogen.model.sizes import SizeSet

    code_bytes = sender.frame.code_size
    overhead = _bytes(str(sender.framing.overhead + SizeSet.exactly(code_bytes)))
    return f"{overhead}, {'with the first COBS code byte' if code_bytes else 'before any stuffing'}"


def _bytes(count: str) -> str:
    return "1 byte" if count == "1" else f"{count} bytes"


def _print_messages(out: Console, sender: Sender) -> None:
    rows = [
        (f"{_INDENT * 2}{item.message}", _size(item), _rate(item.per_second))
        for item in sender.framing.messages
    ]
    print_table(out, (f"{_INDENT * 2}message", "bytes", "frames/s"), rows)


def _size(item: MessageFraming) -> str:
    return str(item.least) if item.least == item.greatest else f"{item.least}..{item.greatest}"


def _rate(per_second: Fraction | None) -> str:
    return "-" if per_second is None else f"{float(per_second):.1f}"


def analysis(path: str, protocol: Protocol) -> dict[str, object]:
    """Return the same as an object that `json.dumps` takes."""
    verified, contradicting = count_examples(protocol)
    return {
        "file": path,
        "protocol": protocol.name,
        "messages": len(protocol.messages),
        "examples_verified": verified,
        "examples_contradicting": contradicting,
        "decisions": len(protocol.decisions),
        "busy": _busy_shares(protocol),
        "senders": [_sender_analysis(sender) for sender in protocol.senders],
    }


def _busy_shares(protocol: Protocol) -> dict[str, dict[str, float]]:
    """Shares of the time by endpoint, of those whose messages have rates."""
    from protogen.model.load import line_load

    loads = {endpoint: line_load(protocol, endpoint) for endpoint in protocol.sending}
    return {
        endpoint: {"least": round(float(load.least), 6), "greatest": round(float(load.greatest), 6)}
        for endpoint, load in loads.items()
        if load is not None
    }


def _sender_analysis(sender: Sender) -> dict[str, object]:
    framing = sender.framing
    form = {} if sender.is_only_form else {"form": sender.form}
    return {
        "sender": sender.endpoint,
        **form,
        "start": framing.finds_start,
        "end": framing.finds_end,
        "self_synchronising": framing.self_synchronising,
        "why_synchronising": framing.why_synchronising,
        "least": framing.least,
        "greatest": framing.greatest,
        "undetected": list(framing.undetected),
        "messages": [_message_analysis(item) for item in framing.messages],
    }


def _message_analysis(item: MessageFraming) -> dict[str, object]:
    rate = None if item.per_second is None else round(float(item.per_second), 3)
    return {
        "message": item.message,
        "least": item.least,
        "greatest": item.greatest,
        "per_second": rate,
    }
