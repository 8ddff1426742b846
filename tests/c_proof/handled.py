"""Contracts of decoders that call the application's handler with each event."""

from __future__ import annotations

import re

from c_proof.contracts import Contracts, identifies, room_of
from c_proof.whole import takes_whole

_BEHIND = re.compile(r"&content\[(\d+)U? \+ decoder->payload\]")
_APPLICATION = """
/*@ assigns \\nothing; */
static void {prefix}_application(void *user, const struct {prefix}_event *event);
"""


def handled(made: Contracts, prefix: str, upper: str) -> None:
    """What calls the application's handler, which is taken to leave the decoder as it is."""
    valid = r"requires \valid(decoder)"
    identifies(made, prefix, upper)
    made.put(f"{prefix}_invalid", valid, "assigns decoder->offset")
    if made.has(f"{prefix}_end_noise"):
        made.put(f"{prefix}_end_noise", valid, "assigns decoder->offset, decoder->noise")
    bytes_ = r"requires \valid_read(data + (0 .. size - 1))"
    feed = f"{prefix}_decoder_feed"
    made.put(f"{prefix}_decoder_push", valid, "assigns *decoder")
    made.functions.remove(f"{prefix}_decoder_push")
    made.put_safe(feed, valid, rf"{bytes_} && \separated(decoder, data + (0 .. size - 1))")
    kept = rf"index <= size && \valid(decoder) && {bytes_.removeprefix('requires ')}"
    kept = f"{kept} && \\separated(decoder, data + (0 .. size - 1))"
    made.keep(feed, kept)
    complete = f"{prefix}_complete"
    behind = [int(place) for place in _BEHIND.findall(made.body(complete))]
    room = room_of(made, prefix)
    made.put(complete, valid, f"requires decoder->payload < {room - max(behind)}")
    if made.has(f"{prefix}_take_whole"):
        takes_whole(made, prefix, valid, "assigns decoder->offset, decoder->noise", room)
    for name in ("invalid", "complete", "hand_over", "take_whole"):
        if made.has(f"{prefix}_{name}"):
            _delivers(made, f"{prefix}_{name}", f"{prefix}_application(")
    made.declare(_APPLICATION.format(prefix=prefix))


def _delivers(made: Contracts, function: str, call: str) -> None:
    """Where the application is called: an event of a message has what that asks for."""
    asserted = ["holds(event.message, event.payload, event.payload_size)"]
    if function in made.safe:
        asserted.append(r"\valid_read(event.payload + (0 .. event.payload_size - 1))")
    text = "".join(f"    //@ assert {claim};\n" for claim in asserted)
    body = made.body(function).replace("    decoder->handler(", f"{text}    {call}")
    made.change(function, body)
