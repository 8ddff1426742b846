"""Writers that take payloads byte by byte, where a frame is sent without a buffer."""

from __future__ import annotations

from protogen.model.protocol import Protocol


def is_stateless(protocol: Protocol) -> bool:
    """True if what is sent goes out as it is: nothing is summed or stuffed on the way."""
    return not any(s.frame.checksums or s.frame.transparency for s in protocol.senders)


def writer_parameter(protocol: Protocol) -> str:
    """Parameters for a writer.

    One without a state is the function and what it is given: compilers see through two parameters
    where they would not look into a struct, and can put the function in where it is called.
    """
    if is_stateless(protocol):
        return f"{protocol.name}_put put, void *user"
    return f"struct {protocol.name}_writer *writer"


def writer_argument(protocol: Protocol) -> str:
    """Arguments with which functions hand on the writer that they were given."""
    return "put, user" if is_stateless(protocol) else "writer"
