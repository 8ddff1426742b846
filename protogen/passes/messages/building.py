"""Messages: what each carries, and how it is told apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from protogen.model.frame import Frame
from protogen.model.identities import Identities
from protogen.model.messages import Message
from protogen.model.sizes import SizeSet
from protogen.model.types import ByteOrder, Field, Fill, Octets, total
from protogen.passes.context import Context, Loc, about
from protogen.passes.draft import Draft
from protogen.passes.framing.capacity import (
    GREATEST_FRAME,
    amount,
    is_delimited,
    payload_range,
    stated_range,
    unclear_behind_stuffing,
)
from protogen.passes.messages.identity_reader import IdentityReader
from protogen.passes.messages.rates import rate_of
from protogen.passes.messages.stated_sizes import greatest_stated, least_stated
from protogen.passes.messages.virtual_values import virtual_values
from protogen.passes.types.fields import FieldBuilder
from protogen.passes.types.separators import separator_of
from protogen.passes.types.setting import Setting
from protogen.passes.types.type_names import Layout
from protogen.schema.syntax.messages import MessageSyntax

DATA = "data"
"""The only field of a message whose payload is not specified."""


def resolve_messages(context: Context, draft: Draft) -> None:
    """Fields, sizes and identity of each message whose senders all have a frame."""
    builder = FieldBuilder(context, draft.named)
    frames = {name: _frames_of(context, draft, name) for name in context.syntax.messages}
    stated = {sender: payload_range(frame) for sender, frame in draft.frames.items()}
    begun = [
        _Resolution(context, name, syntax, frames[name], stated)
        for name, syntax in context.syntax.messages.items()
        if frames[name]
    ]
    for resolution in begun:
        resolution.resolve_fields(builder)
    draft.used_types = builder.followed
    for resolution in begun:
        resolution.add_to(draft)
    draft.senders = tuple(sender for sender in draft.senders if draft.carried[sender])


def _frames_of(context: Context, draft: Draft, name: str) -> dict[str, Frame]:
    """The frames that carry a message, by sender; none where one is not known."""
    written = context.syntax.messages[name]
    senders = [sender for sender in draft.senders if name in draft.carried[sender]]
    reached = {context.frames[sender].endpoint for sender in senders if sender in context.frames}
    left_out = [endpoint for endpoint in written.from_ if endpoint not in reached]
    if context.syntax.forms is not None:
        _report_uncarried(context, name, [e for e in left_out if e in context.syntax.endpoints])
    if left_out or not draft.frames.keys() >= set(senders):
        return {}
    return {sender: draft.frames[sender] for sender in senders}


def _report_uncarried(context: Context, name: str, endpoints: Sequence[str]) -> None:
    """Report each endpoint that has no form of frame for a message which it sends."""
    forms = context.syntax.forms or {}
    if not forms.keys() >= set(context.syntax.messages[name].forms or ()):
        return  # Which is reported: there is no such form.
    for endpoint in endpoints:
        own = [item.form for item in context.frames.values() if item.endpoint == endpoint]
        text = f"no form of frame carries `{name}` from {endpoint}"
        hint = f"the forms of {endpoint} are {', '.join(own)}" if own else None
        context.error_at_key("PG172", ("messages", name), text, hint)


class _Resolution:
    """One message on its way into the model."""

    def __init__(
        self,
        context: Context,
        name: str,
        syntax: MessageSyntax,
        frames: Mapping[str, Frame],
        stated: Mapping[str, SizeSet | None],
    ) -> None:
        self._context = context
        self._name = name
        self._syntax = syntax
        self._frames = frames
        """By sender."""
        self._stated = {sender: stated[sender] for sender in frames}
        """The payload sizes that each frame can carry."""
        self._loc: Loc = ("messages", name)
        self._fields: tuple[Field, ...] = ()
        self._sound = True

    def resolve_fields(self, builder: FieldBuilder) -> None:
        """Resolve the fields; named types get their bounds when those of all messages are."""
        before = self._context.tally.errors
        if isinstance(self._syntax.fields, str):
            self._fields = self._unspecified()
        else:
            self._bounds_misused()
            loc = (*self._loc, "fields")
            self._fields = builder.fields(self._syntax.fields, loc, self._setting())
        self._sound = self._context.tally.errors == before

    def add_to(self, draft: Draft) -> None:
        """Add the message."""
        syntax = self._syntax
        self._fields = draft.named.settled(self._fields)
        identities = self._identities()
        sizes = self._sizes(draft)
        self._leave_out(draft, sizes)
        if identities is None:
            draft.unidentified.add(self._name)
        draft.messages[self._name] = Message(
            name=self._name,
            title=syntax.title or self._name,
            summary=syntax.summary or "",
            senders=syntax.from_,
            forms=syntax.forms or (),
            identity=identities.first if identities else (),
            identities=identities if identities and identities.count > 1 else None,
            fields=self._fields,
            sizes=sizes,
            unspecified=isinstance(syntax.fields, str),
            rate=rate_of(self._context, self._loc, syntax.rate),
            virtual=virtual_values(self._context, self._name, syntax, self._frames),
            renamed_from=syntax.renamed_from,
            about=about(syntax.doc, syntax.source),
            span=self._context.find_key(self._loc),
        )

    # -- fields -------------------------------------------------------------------------------

    def _setting(self) -> Setting:
        separator = separator_of(self._context, self._syntax, self._loc)
        # Fields that tell a payload's size by themselves do it by what they say, not by the room.
        delimited = all(map(is_delimited, self._frames.values()))
        capacity = self._capacity() if delimited else None
        if capacity is None and any(map(unclear_behind_stuffing, self._frames.values())):
            capacity = GREATEST_FRAME  # They are refused: what is due then bounds payloads as well.
        return Setting(
            layout=Layout(
                byte_bits=self._context.syntax.byte_bits,
                byte_order=self._byte_order(),
                separator=None if separator is None else separator.byte,
            ),
            leads=separator is None or separator.in_front,
            capacity=capacity,
            owner=self._name,
            delimited=delimited,
        )

    def _byte_order(self) -> ByteOrder | None:
        if self._syntax.byte_order is not None:
            return self._syntax.byte_order
        orders = {self._context.byte_order(sender) for sender in self._syntax.from_}
        if len(orders) > 1:
            text = f"the senders of `{self._name}` use different byte orders"
            self._context.error_at_key("PG109", self._loc, text, "set `byte_order` on the message")
        return next(iter(orders))

    def _capacity(self) -> int | None:
        """The greatest payload that one of the senders can send, where all frames bound it."""
        bounds = [stated.greatest for stated in self._stated.values() if stated is not None]
        return max(bounds) if len(bounds) == len(self._frames) else None

    def _unspecified(self) -> tuple[Field, ...]:
        separator_of(self._context, self._syntax, self._loc)  # For its problem only.
        stated = self._syntax.max_size
        capacity = self._capacity()
        if stated is None and capacity is None:
            text = f"nothing bounds the unspecified payload of `{self._name}`"
            hint = "add `max_size`, the greatest number of bytes"
            self._context.error_at_key("PG155", self._loc, text, hint)
        greatest = stated if stated is not None else capacity or 0
        extent = Fill(greatest=greatest, stated=stated is not None)
        data = Octets(extent=extent, byte_bits=self._context.syntax.byte_bits)
        return (Field(name=DATA, type=data, position=0, unknown=True),)

    def _bounds_misused(self) -> None:
        for key in ("min_size", "max_size"):
            if getattr(self._syntax, key) is not None:
                text = f"`{key}` is for messages whose fields are unspecified"
                self._context.error_at_key("PG155", (*self._loc, key), text)

    # -- sizes --------------------------------------------------------------------------------

    def _sizes(self, draft: Draft) -> SizeSet:
        sizes = self._stated_sizes()
        if self._sound:
            for endpoint in self._syntax.from_:
                self._fits(sizes, endpoint)
        sizes = self._sendable(sizes)
        if sizes.greatest > GREATEST_FRAME:
            text = f"the payload can have {amount(sizes.greatest)} bytes; a frame is at most 1 MiB"
            self._context.error("PG122", self._greatest(), text)
            draft.too_large.add(self._name)
            return sizes.within(0, GREATEST_FRAME) or SizeSet.exactly(0)
        return sizes

    def _leave_out(self, draft: Draft, sizes: SizeSet) -> None:
        """Leave the message to the other forms of frame where the length of one can't say it."""
        if self._context.syntax.forms is None:
            return
        for sender, stated in self._stated.items():
            if stated is not None and not stated.meets(sizes):
                draft.carried[sender] -= {self._name}

    def _greatest(self) -> Loc:
        """The place of what makes the payload as long as it can be."""
        if isinstance(self._syntax.fields, str):
            return (*self._loc, "max_size")
        greatest = max(self._fields, key=lambda field: field.sizes.greatest).name
        loc = (*self._loc, "fields", greatest)
        written = self._syntax.fields[greatest].model_fields_set
        return next(((*loc, key) for key in ("count", "size", "until") if key in written), loc)

    def _stated_sizes(self) -> SizeSet:
        sizes = total(self._fields)
        least = self._least_unspecified()
        if least > sizes.greatest:
            text = f"`min_size` is greater than the greatest size, {sizes.greatest}"
            self._context.error("PG115", (*self._loc, "min_size"), text)
        return SizeSet.between(least, sizes.greatest) if least else sizes

    def _least_unspecified(self) -> int:
        is_unspecified = isinstance(self._syntax.fields, str)
        return (self._syntax.min_size or 0) if is_unspecified else 0

    def _sendable(self, sizes: SizeSet) -> SizeSet:
        """The sizes that some sender's length part can state; an encoder refuses the others."""
        known = [stated for stated in self._stated.values() if stated is not None]
        if len(known) < len(self._frames):
            return sizes
        low = min(allowed.least for allowed in known)
        return sizes.within(low, max(allowed.greatest for allowed in known)) or sizes

    def _fits(self, sizes: SizeSet, endpoint: str) -> None:
        """Check that a frame of an endpoint can carry each size that the schema insists on.

        Of several forms of frame, each size needs one.
        """
        written = self._context.frames
        own = [name for name in self._frames if written[name].endpoint == endpoint]
        carried = [(self._frames[name], self._stated[name]) for name in own]
        known = [(frame, sizes) for frame, sizes in carried if sizes is not None]
        if len(known) < len(own):
            return
        largest, most = max(known, key=lambda item: item[1].greatest)
        smallest, fewest = min(known, key=lambda item: item[1].least)
        greatest = max(greatest_stated(self._fields), sizes.least)
        least = self._least_unspecified() or least_stated(self._fields)
        if greatest > most.greatest:
            self._too_long(endpoint, largest, greatest, most.greatest)
        elif least < fewest.least and smallest.length is not None:
            text = f"the payload can have {amount(least)} bytes, but {_lengths(smallest)}"
            text = f"{text} {'says' if len(smallest.lengths) == 1 else 'say'}"
            text = f"{text} at least {fewest.least}"
            self._context.error_at_key("PG148", self._loc, text)

    def _too_long(self, endpoint: str, frame: Frame, greatest: int, most: int) -> None:
        """Report a payload that is longer than the frame with the most room can carry."""
        text = f"the payload can have {amount(greatest)} bytes, "
        stated = stated_range(frame)
        if frame.length is not None and stated is not None and stated.greatest == most:
            text = f"{text}but {_lengths(frame)} of {endpoint}'s frame can't say more than"
            hint = "make the length part wider, or bound the message"
            self._context.error_at_key("PG137", self._loc, f"{text} {most}", hint)
        else:
            text = f"{text}and {most} fit a frame of {endpoint}, which has at most {frame.limit}"
            hint = "raise `max_frame`, or bound the message"
            self._context.error_at_key("PG182", self._loc, text, hint)

    # -- identity -----------------------------------------------------------------------------

    def _identities(self) -> Identities | None:
        reader = IdentityReader(self._context, self._loc, f"`{self._name}`")
        found = [reader.read(self._syntax.id, frame) for frame in self._frames.values()]
        known = [identities for identities in found if identities is not None]
        if len(known) < len(found):
            return None
        return known[0] if self._is_one(known) else None

    def _is_one(self, identities: Sequence[Identities]) -> bool:
        if len(set(identities)) == 1:
            return True
        text = f"the frames of `{self._name}`'s senders have the identity parts in different orders"
        hint = "order the parts alike, or write a message for each sender"
        self._context.error("PG151", (*self._loc, "id"), text, hint)
        return False


def _lengths(frame: Frame) -> str:
    """The lengths of a frame by name, which together bound its payload."""
    return " and ".join(f"`{part.name}`" for part in frame.lengths)
