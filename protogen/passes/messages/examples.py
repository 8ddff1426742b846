"""Examples, which must say enough to be verified.

Whether an example decodes to its values is asked later, by the Python target's own output.
"""

from __future__ import annotations

from protogen.copying import replace
from protogen.model.frame import Frame
from protogen.model.messages import Contradiction, Example, Message
from protogen.model.parts import members_of
from protogen.passes.context import Context, Loc, about
from protogen.passes.draft import Draft
from protogen.passes.framing.bit_names import are_whole
from protogen.passes.framing.part_runs import written_out
from protogen.passes.framing.part_values import number_of
from protogen.passes.messages.byte_strings import with_byte_strings
from protogen.passes.messages.example_forms import likeliest_form
from protogen.problems import hint_for
from protogen.schema.syntax.messages import Example as ExampleSyntax


def attach_examples(context: Context, draft: Draft) -> None:
    """Add its examples to each message."""
    _content_known(context)
    for name, message in draft.messages.items():
        written = context.syntax.messages[name].examples or {}
        built = [
            _example(context, draft, message, key, item, ("messages", name, "examples", key))
            for key, item in written.items()
        ]
        known = tuple(example for example in built if example is not None)
        draft.messages[name] = replace(message, examples=known)


def _content_known(context: Context) -> None:
    """Check the default of `content`: parts of some frame at least, examples or not."""
    frames = [list(frame.parts) for frame in context.frames.values()]
    names = dict.fromkeys(name for frame in frames for name in frame)
    loc: Loc = ("content_covers",)
    for item in context.syntax.content_covers or ():
        ends = item.split("..")
        unknown = [name for name in ends if name not in names]
        for name in unknown:
            text = f"no frame has a part called `{name}`"
            context.error("PG132", loc, text, hint_for(name, names))
        if not unknown and not any(_in_order(frame, ends) for frame in frames):
            context.error("PG132", loc, f"in no frame does `{ends[-1]}` come behind `{ends[0]}`")


def _in_order(names: list[str], ends: list[str]) -> bool:
    """True if a frame of these parts has a run with these ends."""
    return set(ends) <= set(names) and names.index(ends[0]) <= names.index(ends[-1])


def _example(
    context: Context, draft: Draft, message: Message, name: str, item: ExampleSyntax, loc: Loc
) -> Example | None:
    if (item.frame is None) == (item.content is None):
        text = "an example has either `frame` (all bytes) or `content`"
        context.error_at_key("PG162", loc, text)
        return None
    endpoint = _endpoint(context, message, item, loc)
    if endpoint is None:
        return None
    sender = _sender(context, draft, message, endpoint, item, loc)
    if sender is None:
        return None
    covers = None
    if item.frame is None:
        covers = _covers(context, draft.frames[sender], item, loc)
    elif item.covers is not None:
        text = "`covers` says what `content` holds; a `frame` is all bytes"
        context.error_at_key("PG162", (*loc, "covers"), text)
        return None
    if item.content is not None and not covers:
        return None
    if not _parts_known(context, draft, sender, item, loc):
        return None
    return Example(
        name=name,
        sender=sender,
        bytes=item.frame if item.frame is not None else item.content or b"",
        covers=covers,
        values=None if item.values is None else with_byte_strings(message.fields, item.values),
        parts=_parts(context, draft.frames[sender], item, loc),
        contradicts=_contradiction(message, item),
        about=about(item.doc, item.source),
        span=context.find_key(loc),
    )


def _sender(
    context: Context, draft: Draft, message: Message, endpoint: str, item: ExampleSyntax, loc: Loc
) -> str | None:
    """The endpoint in the form of the example's frame."""
    own = {
        name: frame
        for name, frame in draft.frames.items()
        if context.frames[name].endpoint == endpoint and message.name in draft.carried[name]
    }
    if item.form is None:
        return likeliest_form(own, message, item.frame)
    chosen = next((name for name in own if context.frames[name].form == item.form), None)
    if chosen is None and item.form in (context.syntax.forms or {}):
        forms = ", ".join(context.frames[name].form for name in own)
        text = f"`{item.form}` carries no `{message.name}` from {endpoint}"
        context.error("PG162", (*loc, "form"), text, f"its forms of frame are {forms}")
    return chosen


def _endpoint(context: Context, message: Message, item: ExampleSyntax, loc: Loc) -> str | None:
    if item.sender is None:
        if len(message.senders) == 1:
            return message.senders[0]
        names = ", ".join(message.senders)
        text = f"`{message.name}` has several senders; the example must say which: {names}"
        context.error_at_key("PG162", loc, text, "add `sender`")
        return None
    if item.sender not in message.senders:
        text = f"`{item.sender}` does not send `{message.name}`"
        hint = hint_for(item.sender, message.senders)
        context.error("PG162", (*loc, "sender"), text, hint)
        return None
    return item.sender


def _covers(context: Context, frame: Frame, item: ExampleSyntax, loc: Loc) -> tuple[str, ...]:
    """The parts that `content` holds."""
    written = item.covers or context.syntax.content_covers
    if written is None:
        text = "nothing says which parts `content` holds"
        context.error_at_key("PG162", (*loc, "content"), text, "add `covers`, or `content_covers`")
        return ()
    place: Loc = (*loc, "covers") if item.covers else (*loc, "content")
    bits = {part.name: whole.name for whole in frame.parts for part in members_of(whole)}
    if not are_whole(context, bits, written, place):
        return ()
    return written_out(context, [part.name for part in frame.parts], written, place)


def _parts_known(
    context: Context, draft: Draft, sender: str, item: ExampleSyntax, loc: Loc
) -> bool:
    frame, written = draft.frames[sender], context.frames[sender]
    place = "part" if written.is_only else f"part of `{written.form}`"
    taken = f"the example is taken for a frame of `{written.form}`; `form:` names another"
    other = None if written.is_only or item.form is not None else taken
    known = [part.name for part in (*frame.caller_parts, *frame.identity)]
    unknown = [name for name in item.parts or {} if name not in known]
    for name in unknown:
        text = f"`{name}` is no {place} whose value a sender chooses"
        context.error_at_key("PG162", (*loc, "parts", name), text, hint_for(name, known) or other)
    return not unknown


def _parts(context: Context, frame: Frame, item: ExampleSyntax, loc: Loc) -> dict[str, int | str]:
    """The values of parts, as events show them."""
    known = {part.name: part for part in (*frame.identity, *frame.caller_parts)}
    found: dict[str, int | str] = {}
    for name, value in (item.parts or {}).items():
        if name in known:
            number = number_of(context, (*loc, "parts", name), known[name], value)
            found[name] = known[name].shown(number or 0)
    return found


def _contradiction(message: Message, item: ExampleSyntax) -> Contradiction | None:
    if item.contradicts is None:
        return None
    written = item.contradicts
    reads = None if written.reads is None else with_byte_strings(message.fields, written.reads)
    return Contradiction(fails=written.fails, why=written.why, reads=reads)
