"""Names that the templates use themselves, which nothing of a schema may come to."""

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


def claim_own_names(protocol: Protocol, names: Names) -> None:
    """Take the names before anything else can have them."""
    for word in _MACROS.split():
        names.claim_macro(word)
    for word in _FUNCTIONS_AND_TAGS.split():
        names.claim(word)
    for sender in protocol.senders:
        for word in _OF_A_SENDER.split():
            names.claim(sender.name, word)
        for word in _MACROS_OF_A_SENDER.split():
            names.claim_macro(sender.name, word)
