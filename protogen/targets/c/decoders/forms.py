"""A decoder for all forms of an endpoint's frames, which tries them at each place.

The C code follows the runtime's `framing/forms.py`. Each form has a candidate: the machine of its
own decoder, which reads bytes that are kept for all forms, and whose verdict waits for the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import groupby

import msgspec
from msgspec.structs import astuple

from protogen.model.frame_plan import StartRule
from protogen.model.protocol import Sender
from protogen.targets.c.decoders.candidate import Candidate
from protogen.targets.c.decoders.counting import bytes_kept
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.decoders.members import (
    ENDING,
    FOUND,
    POINTERS,
    SMALL_POINTER,
    Member,
    candidate_members,
)
from protogen.targets.c.decoders.named import NamedDecoder
from protogen.targets.c.decoders.push import PushDecoder
from protogen.targets.c.frame.numbers import ToldView
from protogen.targets.c.options import Events
from protogen.targets.c.spelling import Names

_COUNTERS = ("uint8_t", "uint16_t", "uint32_t")


class Form(msgspec.Struct, frozen=True):
    """One of the forms that a decoder finds."""

    name: str
    sender: str
    """The form as a sender."""
    member: str
    """Member of the parts of events."""
    constant: str
    candidate: Candidate

    @property
    def field(self) -> str:
        """Member of the decoder."""
        return f"form_{self.name}"


class _Search(PushDecoder, frozen=True, dict=True):
    """What all forms have in common of how the next start is found."""

    @property
    def prefix(self) -> str:
        """Prefix of the decoder's functions, not of those for one form."""
        return self.names.senders[self.name]

    @property
    def literals(self) -> dict[str, list[dict[str, int]]]:
        """States of an end that frames begin behind."""
        is_end = self.plan.start is StartRule.AFTER_END
        return {name: states for name, states in super().literals.items() if is_end}

    @property
    def counts_beginnings(self) -> bool:
        """False: starts are compared with what is kept."""
        return False

    @property
    def reads_beginnings(self) -> bool:
        """False, too."""
        return False


class FormsTold(msgspec.Struct, frozen=True):
    """A part that is not sent, of all forms that have one of its name."""

    part: ToldView
    """What all of them say about it."""
    fields: tuple[str, ...]
    """The candidates of these forms, as members of the decoder."""
    prefixes: tuple[str, ...]
    """Prefixes of their functions."""


class FormsDecoder(NamedDecoder, frozen=True, dict=True):
    """Everything that the templates print of a decoder for all forms, named as the endpoint."""

    forms: tuple[Form, ...]
    events: Events

    @property
    def all_events(self) -> bool:
        """True if invalid bytes and unknown frames are delivered, too."""
        return self.events == "all"

    @property
    def is_polled(self) -> bool:
        """True if `push` and all others return which message is complete, one at a time."""
        return self.events == "messages"

    @property
    def gives_more(self) -> bool:
        """True if messages may be left when `push` has returned one."""
        return self.is_polled

    # --- sizes ------------------------------------------------------------------------------------

    @property
    def _each(self) -> list[Candidate]:
        return [form.candidate for form in self.forms]

    @property
    def counter(self) -> str:
        """The type of what counts bytes, of which the buffer may hold more than any form's own."""
        room = next(bits for bits in (8, 16, 32) if self.buffer_size < (1 << bits) - 4)
        own = (item.counter for item in self._each)
        return max(f"uint{room}_t", *own, key=_COUNTERS.index)

    @property
    def greatest(self) -> int:
        """Bytes of the greatest frame on the wire."""
        return max(item.plan.greatest for item in self._each)

    @property
    def buffer_size(self) -> int:
        """Bytes of the buffer: a candidate of any form, at whose end a start of any form begins."""
        begun = max(item.start_size for item in self._each) - 1
        return max(item.plan.given_up_at for item in self._each) + max(begun, 0)

    @property
    def bytes_kept(self) -> tuple[str, str, str]:
        """For counters: bytes of a complete frame, behind it, and those kept where none is."""
        return bytes_kept(shares=self.search.plan.shares_delimiter)

    # --- what it is told --------------------------------------------------------------------------

    @cached_property
    def told(self) -> tuple[FormsTold, ...]:
        """The parts that are not sent."""
        found: dict[str, list[tuple[ToldView, Form]]] = {}
        for form in self.forms:
            for view in form.candidate.told_parts:
                found.setdefault(view.member, []).append((view, form))
        return tuple(
            FormsTold(
                part=items[0][0],
                fields=tuple(form.field for _, form in items),
                prefixes=tuple(form.candidate.prefix for _, form in items),
            )
            for items in found.values()
        )

    def told_once(self, form: Form) -> tuple[FormsTold, ...]:
        """What was told of a frame of this form, and holds no more behind it."""
        return tuple(it for it in self.told if it.part.once and form.field in it.fields)

    # --- the search -------------------------------------------------------------------------------

    @cached_property
    def search(self) -> _Search:
        """What all forms have in common: each is found in the same way."""
        _, _, *others = astuple(self.forms[0].candidate)
        return _Search(self.names, self.name, *others)

    @property
    def marks(self) -> bool:
        """True if something has to stand at the start of a frame of each form."""
        return all(item.begins for item in self._each)

    @property
    def waits(self) -> bool:
        """True if a start has several bytes, so that the first ones do not tell."""
        return any(item.begins and not item.begins_with_byte for item in self._each)

    @property
    def is_anywhere(self) -> bool:
        """True if nothing marks a start."""
        return self.search.plan.start is StartRule.ANYWHERE

    @property
    def is_after_end(self) -> bool:
        """True if the end of a frame is the only mark of the next."""
        return self.search.plan.start is StartRule.AFTER_END

    @property
    def members(self) -> tuple[Member, ...]:
        """The members in front of those of the forms, behind the handler where there is one."""
        counters = (
            (self.all_events, "noise", "Bytes of noise that are in no event yet."),
            (True, "count", "Bytes in the buffer."),
            (True, "next", "Place in the buffer of the byte to read next."),
            (True, "failed", "Bytes of the candidate that failed."),
        )
        shared = "Bytes of the candidate that ended the frame before."
        states = (
            (True, "state", FOUND if self.is_polled else "Seeking, taking, failed or lost."),
            (self.is_polled, "ending", ENDING),
            (self.is_polled, "form", "The form of the frame that is complete."),
            (self.all_events, "reason", "Why the candidate failed."),
            (self.is_after_end, "match", "Bytes of an end that the input ends with."),
            (self.search.plan.shares_delimiter, "shared", shared),
        )
        offset = "Offset of the first byte that is in no event yet."
        return (
            *([Member("uint32_t", "offset", offset)] if self.all_events else []),
            *(Member(self.counter, name, about) for is_there, name, about in counters if is_there),
            *(Member("uint8_t", name, about) for is_there, name, about in states if is_there),
        )

    @property
    def memory(self) -> int:
        """Bytes that it takes on an 8-bit controller."""
        kept = [member for item in self._each for member in candidate_members(item)]
        sizes = sum(member.size for member in (*self.members, *kept))
        pointers = len(self.forms) + (0 if self.is_polled else POINTERS)
        return pointers * SMALL_POINTER + sizes + self.buffer_size


def forms_decoders(
    names: Names, senders: Sequence[Sender], decoders: Sequence[DecoderView], events: Events
) -> tuple[FormsDecoder, ...]:
    """A decoder for each endpoint of which several forms were chosen."""
    views = dict(zip((sender.name for sender in senders), decoders, strict=True))
    found = []
    for endpoint, own in groupby(senders, key=lambda sender: sender.endpoint):
        forms = tuple(_form(names, item, views[item.name]) for item in own)
        if len(forms) > 1:
            found.append(FormsDecoder(names, endpoint, forms, events))
    return tuple(found)


def _form(names: Names, sender: Sender, view: DecoderView) -> Form:
    constant = f"{names.senders[sender.endpoint]}_form_{sender.form}".upper()
    candidate = Candidate(*astuple(view))
    return Form(sender.form, sender.name, names.member(sender.form), constant, candidate)
