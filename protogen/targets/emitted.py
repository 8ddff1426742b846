"""Check that no target would give one name to two things, before anything is written."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.model.protocol import Protocol
from protogen.passes.context import Context, Loc
from protogen.targets.c.protocol_names import names_of
from protogen.targets.naming import PROTOCOL, Clash, Thing
from protogen.targets.python.names import tables_of


def check_emitted_names(context: Context, protocol: Protocol) -> None:
    """Report each pair of things that come to the same name, and each name that is taken."""
    told: set[tuple[Thing, Thing]] = set()
    for language, clash in _clashes(protocol):
        if (clash.first, clash.second) not in told:
            told.add((clash.first, clash.second))
            _report(context, language, clash)


def _clashes(protocol: Protocol) -> Iterator[tuple[str, Clash]]:
    names = names_of(protocol)
    for table in (names.files, names.others, names.tags, names.members):
        yield from (("C", clash) for clash in table.clashes)
    for table in tables_of(protocol):
        yield from (("Python", clash) for clash in table.clashes)


def _report(context: Context, language: str, clash: Clash) -> None:
    first, second, name = clash.first, clash.second, clash.name
    if not first.place:
        whole = second == PROTOCOL
        own = context.syntax.protocol if whole else second.place[-1]
        becomes = "" if own == name else f" would be `{name}`, which"
        hint = f"another name, such as `{own}_{'value' if second.place[2:] else 'data'}`"
        report = context.error if whole else context.error_at_key
        report("PG106", _place(context, second), f"`{own}`{becomes} {first.what}", hint)
        return
    spans = {thing: context.find_key(_place(context, thing)) for thing in (first, second)}
    if spans[first].file == spans[second].file:
        first, second = sorted((first, second), key=lambda thing: spans[thing].line)
    text = f"{second.what} and {first.what} would both be `{name}` in {language}"
    note = (spans[first], "the other one")
    context.error_at_key("PG107", _place(context, second), text, "rename one of them", note)


def _place(context: Context, thing: Thing) -> Loc:
    """Keys of the schema: those of a type inside of a field begin with the field's."""
    if len(thing.place) == 1:
        return thing.place
    kind, name, *rest = map(str, thing.place)
    if kind == "frame":
        return (*context.frames[name].loc, *rest)
    if kind != "records":
        return thing.place
    if name in context.syntax.types:
        return ("types", name, *rest)
    return (*context.places.get(name, ("messages", name)), *rest)
