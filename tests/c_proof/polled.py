"""Contracts of decoders that return the message that is complete: its event has what it needs.

What stands in the decoder's buffer when a message is returned is what `NAME_decoder_event` shows.
Of a decoder, they say what holds between two bytes, as far as its proof needs it.
"""

from __future__ import annotations

import re

from c_proof.contracts import Contracts, identifies, room_of
from c_proof.whole import takes_whole

_PAYLOAD_AT = re.compile(r"event->payload = &content\[(\d+)\];")
_PLACE = re.compile(r"content\[(\d+)\]")
_PAYLOAD_SIZE = re.compile(r"event->payload_size = ([^;]*);")
_SHOWN = re.compile(r"_show\(decoder->buffer, (.*), event\);")
_HEAD = re.compile(r"if \((content\[(\d+)\]) != ([^;{]*)\) \{")
_PART = re.compile(r"(event->parts\.\w+) = (content\[\d+\]);")
_MEMBER = re.compile(r"decoder->(\w+(?:\[\d+\])?)")
_CHANGED = re.compile(r"(decoder->\w+) = (\w+);")
_BEHIND_BUFFER = re.compile(r"decoder->buffer\[at - (\d)U\]")
_LEAST = re.compile(r"_complete\(decoder->buffer, \(\w+\)\(at - (\d+)U\)")
_RUN = re.compile(r"_run\(sum, (?:content|&content\[(\d+)U\]), (\d+)U \+ payload(?: - (\d+)U)?\)")
_AROUND = re.compile(r"(\d+)U \+ \(size_t\)decoder->payload")
_CALL = re.compile(r"\b(\w+)\(")
_DROPPED = "invariant to <= from && to <= count"
_LIMITS = re.compile(r"case (0x\w+)U:\n +limit = (\d+)U;")
"""Bytes of content that a frame with a start of its own has."""


def polled(made: Contracts, prefix: str, upper: str) -> None:
    """What returns messages, and what fills their events and hands them on."""
    decoder = _Decoder(made, prefix, upper)
    decoder.shows()
    if made.has(f"{prefix}_identify"):
        decoder.judges()
    else:
        decoder.completes()
    decoder.steps()
    decoder.begins()
    decoder.feeds()
    decoder.dispatches()


class _Decoder:
    """The decoder of a sender, whose functions get contracts."""

    def __init__(self, made: Contracts, prefix: str, upper: str) -> None:
        self._made = made
        self._prefix = prefix
        self._upper = upper
        self._none = f"{upper}_NO_MESSAGE"
        self._room = room_of(made, prefix)
        self._limits = _LIMITS.findall(made.body(f"{prefix}_decoder_push"))
        [self._at] = _PAYLOAD_AT.findall(made.body(f"{prefix}_show"))
        [self._size] = _PAYLOAD_SIZE.findall(made.body(f"{prefix}_show"))
        self._last = max(map(int, _PLACE.findall(made.body(f"{prefix}_show"))))
        payload = _SHOWN.search(made.body(f"{prefix}_decoder_event"))
        # All that it decodes may have one size, which is a number then.
        self._payload = payload[1] if payload else self._size
        self._message = f"holds(\\result, decoder->buffer + {self._at}, {self._payload})"
        self._event = "holds(event->message, event->payload, event->payload_size)"
        self._between = self._invariant()

    def _invariant(self) -> str:
        """What holds of the decoder between two bytes."""
        push = self._made.body(f"{self._prefix}_decoder_push")
        if self._has("set_payload"):
            members = ("content", "limit", "count")
            bounds = [f"decoder->{member} <= {self._room}" for member in members]
            return " && ".join([*bounds, f"decoder->payload <= {self._most()}"])
        if self._limits:
            of_starts = " || ".join(
                f"(decoder->buffer[0] == {start} && decoder->limit == {limit})"
                for start, limit in self._limits
            )
            return (
                f"(decoder->limit == 0 || (1 <= decoder->content && decoder->content <="
                f" decoder->limit && decoder->limit <= {self._room} && ({of_starts})))"
            )
        behind = _BEHIND_BUFFER.findall(push)
        least = _LEAST.findall(push)
        if "decoder->limit" in push and behind:
            most = self._room + int(behind[0])
            return (
                f"(decoder->limit == 0 || ({least[0]} <= decoder->limit &&"
                f" decoder->limit <= {most} && 1 <= decoder->content))"
            )
        return r"\true"

    def _has(self, name: str) -> bool:
        return self._made.has(f"{self._prefix}_{name}")

    def _put(self, name: str, *clauses: str) -> None:
        self._made.put(f"{self._prefix}_{name}", *clauses)

    def shows(self) -> None:
        """What fills an event with parts and payload of a frame's content."""
        show = self._made.body(f"{self._prefix}_show")
        self._put(
            "show",
            rf"requires \valid(event) && \separated(event, content + (0 .. {self._last}))",
            r"assigns event->payload, event->payload_size, event->parts",
            f"ensures event->payload == content + {self._at}",
            f"ensures event->payload_size == {self._size}",
            *(f"ensures {part} == {value}" for part, value in _PART.findall(show)),
        )
        self._put(
            "decoder_event",
            r"requires \valid_read(decoder) && \valid(event) && \separated(event, decoder)",
            f"requires holds(message, decoder->buffer + {self._at}, {self._payload})",
            "assigns *event",
            f"ensures {self._event}",
            f"ensures event->payload == decoder->buffer + {self._at}",
            f"ensures event->payload_size == {self._payload} && event->message == message",
        )

    def completes(self) -> None:
        """What tells which message a frame is, of a decoder that looks at no more than one."""
        more = []
        made, prefix = self._made, self._prefix
        if self._limits:
            sizes = (
                f"(content[0] == {start} && payload == {int(limit) - 1})"
                for start, limit in self._limits
            )
            more = [f"requires {' || '.join(sizes)}"]
        for begin, size, less in _RUN.findall(made.body(f"{prefix}_complete")):
            last = f"{int(begin or 0) + int(size) - int(less or 0)} + payload - 1"
            more.append(rf"requires \valid_read(content + (0 .. {last}))")
        told = self._payload.replace("decoder->buffer", "content")
        if told != self._payload:
            equal = _HEAD.findall(made.body(f"{prefix}_head_fits"))
            last = max(int(place) for _, place, _ in equal)
            head = rf"requires \valid_read(content + (0 .. {last}))"
            made.put_safe(
                f"{prefix}_head_fits",
                head,
                r"assigns \nothing",
                *(rf"ensures \result ==> {left} == {right}" for left, _, right in equal),
            )
            more.append(head)
            of_message = rf"0 <= \result && \result < {self._none}"
            more.append(f"ensures {of_message} ==> payload == {told}")
        self._put(
            "complete",
            *more,
            r"assigns \nothing",
            f"ensures holds(\\result, content + {self._at}, {self._size})",
        )

    def judges(self) -> None:
        """Steps that return why a candidate is no frame, or that it is one."""
        made, prefix, upper = self._made, self._prefix, self._upper
        identifies(made, prefix, upper, rf"ensures \result != {upper}_FRAME")
        kept = f"holds(decoder->message, decoder->buffer + {self._at}, decoder->payload)"
        frame = rf"\result == {upper}_FRAME"
        step = re.compile(
            rf"^static (\w+) ({prefix}_\w+)\((const )?struct {prefix}_decoder \*", re.MULTILINE
        )
        steps = [(found[1], found[2], bool(found[3])) for found in step.finditer(made.source)]
        for returned, name, is_constant in steps:
            if name in (f"{prefix}_judge", f"{prefix}_reset"):
                continue
            clauses = []
            if name == f"{prefix}_set_payload":
                clauses.append(f"requires size <= {self._most()}")
            if returned == "uint8_t":
                clauses.append(
                    f"ensures {frame} ==> {kept}"
                    if self._calls(name, "complete")
                    else rf"ensures \result != {upper}_FRAME"
                )
            made.put(
                name,
                rf"requires \valid(decoder) && {self._between}",
                r"assigns \nothing" if is_constant else "assigns *decoder",
                f"ensures {self._between}",
                *clauses,
            )
            places = [_DROPPED] if name == f"{prefix}_drop" else []
            made.loops(name, *places, f"invariant {self._between}", assigns=["*decoder"])
        self._put(
            "judge",
            rf"requires \valid(decoder) && {self._between}",
            f"requires reason == {upper}_FRAME ==> {kept}",
            "assigns *decoder",
            f"ensures {self._message}",
            f"ensures {self._between}",
        )

    def _calls(self, function: str, other: str) -> bool:
        """Whether a function calls another one, itself or by what it calls."""
        called = set(_CALL.findall(self._made.body(function)))
        return function == f"{self._prefix}_{other}" or any(
            self._calls(name, other)
            for name in called
            if name != function and name.startswith(self._prefix) and self._made.has(name)
        )

    def _most(self) -> int:
        """The greatest payload that fits in the buffer with what stands around it."""
        [around] = _AROUND.findall(self._made.body(f"{self._prefix}_complete"))
        return self._room - int(around)

    def steps(self) -> None:
        """What takes a byte, goes on, or ends the input."""
        made, prefix = self._made, self._prefix
        for name in ("give_up", "reset", "open"):
            if self._has(name) and f"{prefix}_{name}" not in made.functions:
                body = made.body(f"{prefix}_{name}")
                changed = _CHANGED.findall(body)
                ensured = [f"ensures {member} == {value}" for member, value in changed]
                if "return" in body:
                    ensured.append(rf"ensures \result == {self._none}")
                members = ", ".join(member for member, _ in changed)
                self._put(name, r"requires \valid(decoder)", f"assigns {members}", *ensured)
        for name in ("next", "push", "flush"):
            if self._has(f"decoder_{name}"):
                self._put(
                    f"decoder_{name}",
                    rf"requires \valid(decoder) && {self._between}",
                    "assigns *decoder",
                    f"ensures {self._message}",
                    f"ensures {self._between}",
                )
                kept = self._message.replace(r"\result", "message")
                kept = f"invariant {kept} && {self._between}"
                made.loops(f"{prefix}_decoder_{name}", kept, assigns=["*decoder"])

    def begins(self) -> None:
        """What holds of a decoder that was initialised out of anything, and of one of zeros."""
        members = dict.fromkeys(_MEMBER.findall(self._between))
        zeros = " && ".join(f"zeros->{member} == 0" for member in members) or r"\true"
        holds = self._between.replace("decoder->", "zeros->")
        self._put(
            "decoder_init",
            r"requires \valid(decoder)",
            "assigns *decoder",
            f"ensures {self._between}",
            rf"ensures \forall struct {self._prefix}_decoder *zeros; {zeros} ==> {holds}",
        )

    def feeds(self) -> None:
        """What takes several bytes, and fills the event of the first message."""
        made, prefix = self._made, self._prefix
        data = r"\valid_read(data + (0 .. size - 1))"
        apart = r"\valid(event) && \separated(decoder, event, data + (0 .. size - 1))"
        if self._has("take_whole"):
            takes_whole(
                made,
                prefix,
                rf"requires \valid(decoder) && {apart} && event->message == {self._none}",
                "assigns *event",
                self._room,
                f"ensures {self._event}",
                f"ensures event->message != {self._none} ==>"
                r" \valid_read(event->payload + (0 .. event->payload_size - 1))",
            )
        feed = f"{prefix}_decoder_feed"
        made.put_safe(
            feed,
            rf"requires \valid(decoder) && {self._between} && {data} && {apart}",
            "assigns *decoder, *event",
            r"ensures \result <= size",
            f"ensures {self._between}",
            f"ensures {self._event}",
        )
        kept = self._message.replace(r"\result", "message")
        made.loops(
            feed,
            f"invariant index <= size && {self._between} && {kept}",
            f"invariant event->message == {self._none}",
            assigns=["*decoder", "*event"],
        )

    def dispatches(self) -> None:
        """What hands the event of each message on to the application."""
        made, prefix = self._made, self._prefix
        if not self._has("decoder_dispatch"):
            return
        # Its handlers are the application's: what it does with the event is left to EVA.
        made.put(
            f"{prefix}_dispatch",
            r"requires \valid_read(event)",
            f"requires {self._event}",
            r"assigns \nothing",
        )
        made.functions.remove(f"{prefix}_dispatch")
        data = r"\valid_read(data + (0 .. size - 1))"
        apart = r"\separated(decoder, data + (0 .. size - 1))"
        made.put_safe(
            f"{prefix}_decoder_dispatch",
            rf"requires \valid(decoder) && {self._between} && {data} && {apart}",
            "assigns *decoder",
        )
        event = self._event.replace("event->", "event.")
        made.loops(
            f"{prefix}_decoder_dispatch",
            f"invariant taken <= size && {self._between} && {event}",
            assigns=["*decoder"],
        )
