"""What does each message carry, and how is it told apart?"""

from __future__ import annotations

from protogen.model.fields import Field
from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.sizes import SizeSet
from protogen.model.types import ByteOrder, Fill, Octets
from protogen.passes.capacity import GREATEST_FRAME, is_delimited, payload_range
from protogen.passes.context import Context, Loc, about
from protogen.passes.draft import Draft
from protogen.passes.fields import FieldBuilder, Setting, payload_sizes
from protogen.passes.frames import FrameBuilder, byte_order_of
from protogen.passes.type_names import Layout
from protogen.problems import hint_for
from protogen.schema.syntax.messages import MessageSyntax

DATA = "data"
"""The only field of a message whose payload is not specified."""


def resolve_frames(context: Context, draft: Draft) -> None:
    """One frame for each sender."""
    byte_bits = context.syntax.byte_bits
    for sender in draft.senders:
        if not {sender, ""} & set(context.syntax.frame):
            text = f"`{sender}` sends messages but has no frame"
            context.error_at_key("PG157", ("frame",), text)
            continue
        layout = Layout(byte_bits=byte_bits, byte_order=byte_order_of(context, sender))
        frame = FrameBuilder(context, sender, layout).frame()
        if frame is not None:
            draft.frames[sender] = frame


def resolve_messages(context: Context, draft: Draft) -> None:
    """Fields, sizes and identity of each message."""
    builder = FieldBuilder(context, draft.named)
    for name, syntax in context.syntax.messages.items():
        frames = [draft.frames[sender] for sender in syntax.from_ if sender in draft.frames]
        if len(frames) != len(syntax.from_):
            continue
        _Resolution(context, name, syntax, frames, builder).add_to(draft)


class _Resolution:
    """One message on its way into the model."""

    def __init__(
        self,
        context: Context,
        name: str,
        syntax: MessageSyntax,
        frames: list[Frame],
        builder: FieldBuilder,
    ) -> None:
        self._context = context
        self._name = name
        self._syntax = syntax
        self._frames = frames
        self._builder = builder
        self._loc: Loc = ("messages", name)

    def add_to(self, draft: Draft) -> None:
        """Resolve the message and add it."""
        fields = self._fields()
        sizes = self._sizes(fields)
        syntax = self._syntax
        draft.messages[self._name] = Message(
            name=self._name,
            title=syntax.title or self._name,
            summary=syntax.summary or "",
            senders=syntax.from_,
            identity=self._identity(),
            fields=fields,
            sizes=sizes,
            unspecified=isinstance(syntax.fields, str),
            about=about(syntax.doc, syntax.source),
            span=self._context.find_key(self._loc),
        )

    # -- fields -------------------------------------------------------------------------------

    def _fields(self) -> tuple[Field, ...]:
        if isinstance(self._syntax.fields, str):
            return self._unspecified()
        self._bounds_misused()
        return self._builder.fields(self._syntax.fields, (*self._loc, "fields"), self._setting())

    def _setting(self) -> Setting:
        return Setting(
            layout=Layout(
                byte_bits=self._context.syntax.byte_bits,
                byte_order=self._byte_order(),
            ),
            capacity=self._capacity(),
            delimited=all(is_delimited(frame) for frame in self._frames),
            last=True,
            used=0,
            owner=self._name,
            outer={},
        )

    def _byte_order(self) -> ByteOrder | None:
        if self._syntax.byte_order is not None:
            return self._syntax.byte_order
        orders = {byte_order_of(self._context, sender) for sender in self._syntax.from_}
        if len(orders) > 1:
            text = f"the senders of `{self._name}` use different byte orders"
            self._context.error_at_key("PG109", self._loc, text, "set `byte_order` on the message")
        return next(iter(orders))

    def _capacity(self) -> int | None:
        ranges = [payload_range(frame) for frame in self._frames]
        bounds = [sizes.greatest for sizes in ranges if sizes is not None]
        return min(bounds) if bounds else None

    def _unspecified(self) -> tuple[Field, ...]:
        greatest = self._syntax.max_size
        capacity = self._capacity()
        if greatest is None and capacity is None:
            text = f"nothing bounds the unspecified payload of `{self._name}`"
            hint = "add `max_size`, the greatest number of bytes"
            self._context.error_at_key("PG155", self._loc, text, hint)
        bound = greatest if greatest is not None else capacity or 0
        byte_bits = self._context.syntax.byte_bits
        data = Octets(extent=Fill(greatest=bound), byte_bits=byte_bits)
        return (Field(name=DATA, type=data, position=0, unknown=True),)

    def _bounds_misused(self) -> None:
        for key in ("min_size", "max_size"):
            if getattr(self._syntax, key) is not None:
                text = f"`{key}` is for messages whose fields are unspecified"
                self._context.error_at_key("PG155", (*self._loc, key), text)

    # -- sizes --------------------------------------------------------------------------------

    def _sizes(self, fields: tuple[Field, ...]) -> SizeSet:
        sizes = payload_sizes(fields)
        if self._syntax.min_size is not None and isinstance(self._syntax.fields, str):
            if self._syntax.min_size > sizes.greatest:
                text = f"`min_size` is greater than the greatest size, {sizes.greatest}"
                self._context.error("PG115", (*self._loc, "min_size"), text)
            sizes = SizeSet.between(self._syntax.min_size, sizes.greatest)
        if sizes.greatest > GREATEST_FRAME:
            text = f"the payload can have {sizes.greatest} bytes; a frame is at most 1 MiB"
            self._context.error_at_key("PG122", self._loc, text)
        for sender, frame in zip(self._syntax.from_, self._frames, strict=True):
            self._fits(sizes, frame, sender)
        return sizes

    def _fits(self, sizes: SizeSet, frame: Frame, sender: str) -> None:
        """Whether the length part can state the payload's sizes."""
        allowed = payload_range(frame)
        if allowed is None:
            return
        length = frame.length
        assert length is not None
        if sizes.greatest > allowed.greatest:
            self._context.error_at_key(
                "PG137",
                self._loc,
                f"the payload can have {sizes.greatest} bytes, but `{length.name}` of {sender}'s "
                f"frame can't say more than {allowed.greatest}",
                "make the length part wider, or bound the message",
            )
        if sizes.least < allowed.least:
            text = f"the payload can have {sizes.least} bytes, but `{length.name}` says at least "
            self._context.error_at_key("PG148", self._loc, f"{text}{allowed.least}")

    # -- identity -----------------------------------------------------------------------------

    def _identity(self) -> tuple[int, ...]:
        identities = {self._identity_in(frame) for frame in self._frames}
        return next(iter(identities))

    def _identity_in(self, frame: Frame) -> tuple[int, ...]:
        parts = {part.name: part for part in frame.identity}
        given = dict(self._syntax.id or {})
        if set(given) == {""} and len(parts) == 1:
            given = dict.fromkeys(parts, given[""])
        if not self._names_parts(set(given), list(parts)):
            return ()
        for name, part in parts.items():
            if not part.least <= given[name] <= part.greatest:
                text = f"{given[name]} is no value of `{name}`: {part.least} to {part.greatest}"
                self._context.error("PG152", (*self._loc, "id"), text)
        return tuple(given[name] for name in parts)

    def _names_parts(self, given: set[str], parts: list[str]) -> bool:
        if given == {""}:
            how = ", ".join(f"{name}: ..." for name in parts)
            text = f"the frame has {len(parts)} identity parts"
            hint = f"write id: {{{how}}}" if parts else "leave out `id`"
            self._context.error("PG151", (*self._loc, "id"), text, hint)
            return False
        for name in sorted(given - set(parts)):
            text = f"`{name}` is no identity part of the frame"
            self._context.error_at_key(
                "PG151", (*self._loc, "id", name), text, hint_for(name, parts)
            )
        missing = [name for name in parts if name not in given]
        if missing:
            text = f"`{self._name}` does not say its identity: {', '.join(missing)}"
            self._context.error_at_key("PG151", self._loc, text, "add `id`")
        return given == set(parts)
