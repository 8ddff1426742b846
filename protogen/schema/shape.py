"""Data -> syntax tree, and errors of shape, as pydantic finds them, -> problems with places."""

from __future__ import annotations

import re
import types
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from protogen.problems import Problems, Span, hint_for
from protogen.schema.syntax.protocol import ProtocolSyntax

Find = Callable[..., Span]
Steps = Sequence[str | int]
Loc = tuple[str | int, ...]

_APART = frozenset(
    {"messages", "overloads", "exchanges", "decisions", "endpoints", "link", "source", "reserved"}
)
"""Keys of the root under which an item with an unknown key leaves the rest of the schema clear."""
_SPARED = frozenset({"messages", "overloads", "exchanges", "reserved", "link", "source"})
"""Those whose items can be left out as a whole, so that the rest is still looked at."""


@dataclass(frozen=True, slots=True)
class Shape:
    """What was written, without unknown keys and without items that can't be read."""

    syntax: ProtocolSyntax
    doubtful: frozenset[Loc] = frozenset()
    """The items that something was left out of, and those that may name what is not there."""


def read_shape(data: Any, find: Find, problems: Problems) -> Shape | None:
    """The syntax tree of a schema's data, or None; errors of shape are reported.

    Unknown keys, and messages that can't be read, are dropped from `data` where that leaves the
    rest of the schema clear.
    """
    try:
        return Shape(ProtocolSyntax.model_validate(data))
    except ValidationError as error:
        details = error.errors(include_url=False)
    for detail in details:
        _report(detail, find, problems)
    dropped = [_droppable(detail) for detail in details]
    return _without(data, [loc for loc in dropped if loc]) if all(dropped) else None


def _droppable(detail: ErrorDetails) -> Loc:
    """What to leave out so that the rest can be looked at; nothing where that is not possible."""
    loc = detail["loc"]
    if detail["type"] == "extra_forbidden":
        return loc if len(loc) > 1 and loc[0] in _APART else ()
    return loc[:2] if len(loc) > 1 and loc[0] in _SPARED else ()


def _without(data: Any, dropped: Sequence[Loc]) -> Shape | None:
    for loc in dropped:
        _drop(data, loc)
    try:
        syntax = ProtocolSyntax.model_validate(data)
    except ValidationError:
        return None
    return Shape(syntax, _doubtful(syntax, dropped)) if syntax.messages else None


def _drop(data: Any, loc: Steps) -> None:
    """Drop a key; a step of its location that leads nowhere is the label of a tagged union."""
    for step in loc[:-1]:
        if isinstance(data, dict):
            data = data.get(step, data)
        elif isinstance(data, list) and isinstance(step, int):
            data = data[step]
    if isinstance(data, dict):
        data.pop(loc[-1], None)


def _doubtful(syntax: ProtocolSyntax, dropped: Sequence[Loc]) -> frozenset[Loc]:
    """What a dropped key may have changed; sizes of messages also decide about overloads."""
    items = {loc[:2] for loc in dropped}
    if any(loc[0] == "messages" for loc in items):
        items |= {("overloads", name) for name in syntax.overloads}
        items |= {("exchanges", name) for name in syntax.exchanges}
    return frozenset(items)


def _report(detail: ErrorDetails, find: Find, problems: Problems) -> None:
    loc = detail["loc"]
    match detail["type"]:
        case "string_type" if loc[-1] == "[key]":
            _report_name(loc, detail["input"], find, problems)
        case "extra_forbidden":
            known = keys_at(loc[:-1])
            text = f"`{loc[-1]}` is no key here"
            problems.add("PG100", find(loc, key=True), text, _key_hint(str(loc[-1]), known))
        case "missing":
            problems.add("PG101", find(loc[:-1], key=True), f"`{loc[-1]}` is missing here")
        case "string_pattern_mismatch":
            _report_name(loc, detail["input"], find, problems)
        case _:
            problems.add("PG102", find(loc), _plain_words(detail["msg"]))


def _report_name(loc: Loc, written: object, find: Find, problems: Problems) -> None:
    text = f"`{written}` is no name: names are lower snake case, such as `left_motor`"
    problems.add("PG103", find(loc), text)


def _key_hint(word: str, known: Sequence[str]) -> str | None:
    close = hint_for(word, known)
    if close is not None or not known:
        return close
    return f"keys are {', '.join(known)}"


_YAML_WORDS = (
    (r"^Value error, ", ""),
    (r"^Dictionary should have at least 1 item.*", "there is nothing in it"),
    (r" or instance of \w+", ""),
    (r"^(Input|String|Dictionary) should", "this should"),
    (r" after validation, not .*$", ""),
    (r"\ba valid boolean", "true or false"),
    (r"\ba valid integer", "an integer"),
    (r"\ba valid ", "a "),
    (r"\bdictionary\b", "mapping"),
    (r"\bstring\b", "text"),
    (r"\btuple\b", "list"),
    (r"\bTrue\b", "true"),
)


def _plain_words(words: str) -> str:
    """Pydantic's own sentence, in the words of YAML."""
    for pattern, plain in _YAML_WORDS:
        words = re.sub(pattern, plain, words)
    return words


def keys_at(loc: Steps) -> tuple[str, ...]:
    """The keys that may be written at a place of the schema."""
    found: list[str] = []
    for model in _models_at(ProtocolSyntax, loc):
        found.extend(field.alias or name for name, field in model.model_fields.items())
    return tuple(dict.fromkeys(found))


def _models_at(annotation: Any, loc: Steps) -> list[type[BaseModel]]:
    """The classes that describe what stands at `loc`, seen from a type annotation."""
    found: list[type[BaseModel]] = []
    for plain in _alternatives(annotation):
        if isinstance(plain, type) and issubclass(plain, BaseModel):
            found.extend(_inside_model(plain, loc) if loc else [plain])
        elif get_origin(plain) in (dict, tuple, list) and loc:
            item = get_args(plain)[-1 if get_origin(plain) is dict else 0]
            # The label of a tagged union stands in the location, but not in the annotation.
            found.extend(_models_at(item, loc[1:]) or _models_at(item, loc[2:]))
    return found


def _inside_model(model: type[BaseModel], loc: Steps) -> list[type[BaseModel]]:
    for name, field in model.model_fields.items():
        if (field.alias or name) == loc[0]:
            return _models_at(field.annotation, loc[1:]) or _models_at(field.annotation, loc[2:])
    return []


def _alternatives(annotation: Any) -> Iterator[Any]:
    """The members of a union, without the metadata around them."""
    origin = get_origin(annotation)
    if origin is Annotated:
        yield from _alternatives(get_args(annotation)[0])
    elif origin in (Union, types.UnionType):
        for member in get_args(annotation):
            yield from _alternatives(member)
    else:
        yield annotation
