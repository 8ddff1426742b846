"""What payloads are written to byte by byte, where a frame is sent without a buffer."""

from __future__ import annotations

from protogen.model.protocol import Protocol


def is_stateless(protocol: Protocol) -> bool:
    """Whether what is sent goes out as it is: nothing is summed or stuffed on the way."""
    return not any(s.frame.checksums or s.frame.transparency for s in protocol.senders)


def writer_parameter(protocol: Protocol) -> str:
    """How functions take a writer: one without a state is two words, which stay in registers."""
    by = "" if is_stateless(protocol) else "*"
    return f"struct {protocol.name}_writer {by}writer"
