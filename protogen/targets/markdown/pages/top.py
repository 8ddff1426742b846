"""The top of a page: what the protocol is, and the line that it runs on."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from protogen.model.protocol import Link, Protocol
from protogen.targets.escape import markdown
from protogen.targets.markdown.text.origin import about_line, link
from protogen.targets.markdown.text.words import code, number, plural, rate


def facts(protocol: Protocol) -> Iterator[tuple[str, str]]:
    """Yield labels and texts that say what the protocol is; a text can be empty."""
    yield "Protocol", code(protocol.name)
    yield "Version", markdown(protocol.version or "")
    yield "Extends", markdown(", ".join(protocol.files[1:]))
    source = protocol.source
    if source:
        yield "Document", markdown(source.document or "")
        yield "Revision", markdown(source.revision or "")
        yield "Source", link(source.url) if source.url else ""
        yield "Licence", markdown(source.license or "")
        yield "Note", markdown(source.note or "")
    yield "Spec hash", code(protocol.spec_hash)


def link_lines(line: Link) -> Iterator[str]:
    """Yield paragraphs about the line."""
    stop = plural(line.stop_bits, "stop bit")
    form = f"{line.data_bits} data bits, parity {line.parity}, {stop}"
    if line.baud is None:
        yield f"No rate is given; {form}."
    else:
        yield f"{line.baud} baud, {form}. {_byte_time(line.baud, line.bits_per_byte)}"
    if line.idle_timeout is not None:
        idle = number(line.idle_timeout * 1000)
        yield f"After {idle} ms of silence a receiver treats what it holds as ended."
    about = about_line(line.about)
    if about:
        yield about


def _byte_time(baud: int, bits: int) -> str:
    microseconds = number(Fraction(round(Fraction(bits * 10_000_000, baud)), 10))
    return f"A byte takes {microseconds} µs, {rate(Fraction(baud, bits))} bytes a second."
