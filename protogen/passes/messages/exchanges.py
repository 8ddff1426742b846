"""Exchanges: sequences of messages, and requests whose replies can be told."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from protogen.model.frame import Frame
from protogen.model.messages import Exchange, Message, Step
from protogen.model.types import Field, Octets, Text, is_integer
from protogen.passes.context import Context, Loc, about
from protogen.passes.draft import Draft
from protogen.problems import hint_for
from protogen.schema.syntax.exchanges import Exchange as ExchangeSyntax

_OF_REQUESTS = ("reply", "refusal", "match", "unmatched_refusal", "timeout", "retries")


def resolve_exchanges(context: Context, draft: Draft) -> None:
    """The exchanges, of which each request is in one at most."""
    written = context.syntax.exchanges
    asking = {name: item for name, item in written.items() if _is_request(context, name, item)}
    for name, item in asking.items():
        _check_ends(context, draft, name, item)
        _check_match(context, draft, name, item)
    _check_alone(context, asking)
    draft.exchanges = tuple(_exchange(name, item) for name, item in written.items())


def _exchange(name: str, item: ExchangeSyntax) -> Exchange:
    return Exchange(
        name=name,
        title=item.title or name,
        steps=tuple(
            Step(message=step.message, example=step.example, about=about(step.doc, step.source))
            for step in item.steps or ()
        ),
        requests=item.request or (),
        replies=item.reply or (),
        refusals=item.refusal or (),
        match=tuple((item.match or {}).items()),
        is_refusal_matched=not item.unmatched_refusal,
        timeout=item.timeout,
        retries=item.retries or 0,
        about=about(item.doc, item.source),
    )


# --- keys -----------------------------------------------------------------------------------------


def _is_request(context: Context, name: str, item: ExchangeSyntax) -> bool:
    """Check that it is a sequence or a request; True if it is a request with its reply."""
    loc: Loc = ("exchanges", name)
    if item.steps is not None:
        for key in ("request", *_OF_REQUESTS):
            if getattr(item, key) is not None:
                text = f"`{key}` is not for a sequence of messages"
                context.error_at_key("PG310", (*loc, key), text, "give it in another exchange")
        return False
    if item.request is None or item.reply is None:
        missing = "`steps`, or a `request` with its `reply`" if item.request is None else "`reply`"
        if item.request is None and item.reply is not None:
            missing = "`request`"
        context.error_at_key("PG310", loc, f"the exchange `{name}` lacks {missing}")
        return False
    if item.unmatched_refusal and (item.refusal is None or item.match is None):
        lacking = "refusal" if item.refusal is None else "match"
        text = f"`unmatched_refusal` says nothing without `{lacking}`"
        context.error_at_key("PG310", (*loc, "unmatched_refusal"), text)
    return True


# --- messages -------------------------------------------------------------------------------------


def _check_ends(context: Context, draft: Draft, name: str, item: ExchangeSyntax) -> None:
    """Check that each answer comes from another end, and is a reply or a refusal."""
    messages = draft.messages
    asking = [end for one in item.request or () if one in messages for end in messages[one].senders]
    for key in ("reply", "refusal"):
        for place, answer in _placed(context, name, key, getattr(item, key)):
            if answer not in messages:
                continue
            senders = messages[answer].senders
            alone = next((end for end in asking if set(senders) == {end}), None)
            if alone is not None:
                text = f"`{answer}` is sent by `{alone}` alone, which also asks"
                context.error("PG311", place, text)
    for place, answer in _placed(context, name, "refusal", item.refusal):
        if answer in (item.reply or ()):
            text = f"`{answer}` is a reply and a refusal, so that nothing tells which"
            context.error("PG312", place, text)


def _check_alone(context: Context, written: Mapping[str, ExchangeSyntax]) -> None:
    """Check that a message is the request of one exchange."""
    found: dict[str, str] = {}
    for name, item in written.items():
        for place, request in _placed(context, name, "request", item.request):
            if request in found:
                text = f"`{request}` is a request of `{found[request]}` already"
                hint = "name both replies there: `reply: [.., ..]`"
                context.error("PG313", place, text, hint)
            found.setdefault(request, name)


def _placed(
    context: Context, name: str, key: str, messages: Sequence[str] | None
) -> Iterator[tuple[Loc, str]]:
    """Yield the messages of a key with their places: that of the key's value where it is one."""
    loc: Loc = ("exchanges", name, key)
    is_list = isinstance(context.data["exchanges"][name].get(key), list)
    for index, message in enumerate(messages or ()):
        yield ((*loc, index) if is_list else loc), message


# --- match ----------------------------------------------------------------------------------------


def _check_match(context: Context, draft: Draft, name: str, item: ExchangeSyntax) -> None:
    """Check that all messages have what is to be equal, and that it can be."""
    is_short = not isinstance(context.data["exchanges"][name].get("match"), dict)
    loc: Loc = ("exchanges", name, "match")
    answers = item.reply or ()
    if not item.unmatched_refusal:
        answers = (*answers, *(item.refusal or ()))
    for of_request, of_reply in (item.match or {}).items():
        place = loc if is_short else (*loc, of_request)
        asked = _kinds(context, draft, item.request or (), of_request, place, at_key=not is_short)
        answered = _kinds(context, draft, answers, of_reply, place, at_key=False)
        if len({*asked, *answered}) > 1 and "" not in (*asked, *answered):
            kinds = " and ".join(dict.fromkeys((*asked, *answered)))
            context.error("PG315", place, f"these are never equal: {kinds}")


def _kinds(
    context: Context,
    draft: Draft,
    messages: Sequence[str],
    name: str,
    place: Loc,
    *,
    at_key: bool,
) -> list[str]:
    """What kind of value the messages have there; empty where one is reported to have none."""
    report = context.error_at_key if at_key else context.error
    found = []
    for message in (draft.messages[item] for item in messages if item in draft.messages):
        values = _values(draft, message)
        kind = values.get(name)
        if kind is None:
            text = f"`{message.name}` has no field and no part `{name}`"
            report("PG314", place, text, hint_for(name, values))
        elif not kind:
            report("PG315", place, f"`{name}` of `{message.name}` is no number, text or bytes")
        found.append(kind or "")
    return found


def _values(draft: Draft, message: Message) -> Mapping[str, str]:
    """The fields and parts that an event of a message shows, with the kinds of their values."""
    frames = [
        frame for sender, frame in draft.frames.items() if message.name in draft.carried[sender]
    ]
    parts = [_parts(frame) for frame in frames]
    shared = {
        name: kind
        for name, kind in (parts[0] if parts else {}).items()
        if all(name in other for other in parts)
    }
    fields = {field.name: _kind(field) for field in message.fields if field.is_stored}
    return {**shared, **fields}


def _parts(frame: Frame) -> dict[str, str]:
    return {part.name: "a text" if part.type.is_text else "a number" for part in frame.shown_parts}


def _kind(field: Field) -> str:
    if is_integer(field.type):
        return "a number"
    if isinstance(field.type, Text):
        return "a text"
    return "bytes" if isinstance(field.type, Octets) else ""
