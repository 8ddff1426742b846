"""Names of a protocol's C: those that templates use themselves, and those of writers.

A writer takes payloads byte by byte, where a frame is sent without a buffer.
"""

from __future__ import annotations

from protogen.model.protocol import Protocol
from protogen.targets.c.spelling import Names

_MACROS = """
ok error_size error_value error_encoding error_range error_space spec_hash version h implementation
message unknown invalid no_message no_reason size value encoding noise checksum length stuffing
truncated seeking taking failed known open searching measuring empty needless before inside after
frame stuffed
"""
_FUNCTIONS_AND_TAGS = """
result message event_kind reason writer write put follow float64
"""
_OF_A_SENDER = """
accept add_noise begins close close_at_flush close_open complete cross decide decoder decoder_feed
decoder_flush decoder_init decoder_push drop end end_noise ends_early enter_payload event find_size
finish_region handler identify invalid judge measure open parts pass payload read_length release
reopen reset resume room search seek seek_on send_head send_tail set_payload start stuff surplus
take take_head take_tail unstuff wire_end wrap write
"""
_MACROS_OF_A_SENDER = "frame_max"


def names_of(protocol: Protocol) -> Names:
    """The names of a protocol; nothing of its schema may come to those that templates use."""
    names = Names(protocol.name, writer_parameter(protocol), _writer_argument(protocol))
    for word in _MACROS.split():
        names.claim_macro(word)
    for word in _FUNCTIONS_AND_TAGS.split():
        names.claim(word)
    for sender in protocol.senders:
        for word in _OF_A_SENDER.split():
            names.claim(sender.name, word)
        for word in _MACROS_OF_A_SENDER.split():
            names.claim_macro(sender.name, word)
    return names


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


def _writer_argument(protocol: Protocol) -> str:
    """Arguments with which functions hand on the writer that they were given."""
    return "put, user" if is_stateless(protocol) else "writer"
