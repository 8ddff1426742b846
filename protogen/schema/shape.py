"""Data -> syntax tree, and errors of shape, as pydantic finds them, -> problems with places."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import msgspec
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from protogen.problems import Problems, Span, hint_for
from protogen.schema import hints
from protogen.schema.recovery import Loc, Recovery
from protogen.schema.syntax.base import Source
from protogen.schema.syntax.exchanges import Step
from protogen.schema.syntax.fields import FieldSyntax, NamedBit, NamedBits, NamedValue
from protogen.schema.syntax.forms import Form, keys_of
from protogen.schema.syntax.parts import Part, TransparencySyntax
from protogen.schema.syntax.protocol import SCHEMA, Endpoint, FrameForm, ProtocolSyntax

Find = Callable[..., Span]
Steps = Sequence[str | int]


class Shape(msgspec.Struct, frozen=True):
    """A schema as it was written, as far as it can be read."""

    syntax: ProtocolSyntax
    doubtful: frozenset[Loc] = frozenset()
    """Items of which something is missing, and those that depend on such items."""
    lost: frozenset[Loc] = frozenset()
    """Names that are written, but can't be referred to."""
    spoilt: bool = False
    """True if more than some examples could not be read."""


def read_shape(data: Any, find: Find, problems: Problems) -> Shape | None:
    """The syntax tree of a schema's data, or None; errors of shape are reported.

    What is wrong is left out of `data` where the rest still can be looked at.
    """
    try:
        return Shape(ProtocolSyntax.model_validate(data))
    except ValidationError as error:
        details = error.errors(include_url=False)
    reversed_pairs = {
        detail["loc"][:-1]
        for detail in details
        if detail["loc"][-1:] == ("[key]",) and isinstance(detail["input"], int)
    }
    for detail in details:
        is_key = detail["loc"][-1:] == ("[key]",)
        if is_key or detail["loc"][:-1] not in reversed_pairs:  # The name is behind its number.
            _report(detail, data, find, problems)
    return _without(data, details)


def _without(data: Any, details: Sequence[ErrorDetails]) -> Shape | None:
    recovery = Recovery(data)
    # Inner things first: where something around them is left out as well, they are gone with it.
    for detail in sorted(details, key=lambda detail: -len(detail["loc"])):
        unknown_key = detail["type"] == "extra_forbidden"
        if not recovery.drop(detail["loc"], unknown_key=unknown_key):
            return None
    try:
        syntax = ProtocolSyntax.model_validate(data)
    except ValidationError:
        return None
    spoilt = not all(map(_is_in_example, details))
    return Shape(syntax, recovery.consequences(syntax), frozenset(recovery.lost), spoilt)


def _is_in_example(detail: ErrorDetails) -> bool:
    loc = detail["loc"]
    return loc[0] == "messages" and loc[2:3] == ("examples",)


def _report(detail: ErrorDetails, data: Any, find: Find, problems: Problems) -> None:
    loc = detail["loc"]
    match detail["type"]:
        case "string_type" if loc[-1] == "[key]":
            hint = hints.pair_hint(loc[-3], _at(data, loc[:-2]))
            _report_name(loc, detail["input"], find, problems, hint)
        case "invalid_key":
            text = f"`{loc[-1]}` is no key"
            hint = "a decimal number has a point, such as 0.1; a comma ends a value"
            problems.add("PG100", find(loc, key=True), text, hint)
        case "extra_forbidden":
            known = keys_beside(loc)
            text = f"`{loc[-1]}` is no key here"
            around = _at(data, loc[:-1])
            hint = hints.indent_hint(around, str(loc[-1]), _mappings_at(loc[:-1]))
            hint = hint or hints.comma_hint(around, str(loc[-1]))
            hint = hint or hints.key_hint(str(loc[-1]), known) or _key_hint(str(loc[-1]), known)
            problems.add("PG100", find(loc, key=True), text, hint)
        case "missing":
            hint = hints.missing_hint(loc, data)
            problems.add("PG101", find(loc[:-1], key=True), f"`{loc[-1]}` is missing here", hint)
        case "string_pattern_mismatch":
            _report_name(loc, detail["input"], find, problems, hints.endpoint_hint(detail, data))
        case _:
            words = _form(detail) or _plain_words(detail["msg"])
            hint = _choice_hint(detail) or hints.form_hint(
                detail["msg"], _key(loc), detail["input"]
            )
            problems.add("PG102", find(loc), words, hint)


def _at(data: Any, loc: Steps) -> Any:
    """What stands at a place of the data; the label of a tagged union is no step."""
    for step in loc:
        if isinstance(data, dict):
            data = data.get(step, data)
        elif isinstance(data, list) and isinstance(step, int) and step < len(data):
            data = data[step]
    return data


def _mappings_at(loc: Steps) -> list[str]:
    """The keys at a place that hold names."""
    return [
        str(key)
        for model in _models_at(SCHEMA, loc)
        for key, form in keys_of(model).items()
        if form.names is not None
    ]


_FORMS: dict[type[BaseModel], str] = {
    FieldSyntax: "a field is the name of its type, such as `uint8`, or a mapping with a `type`, "
    "`fields` or a `switch`",
    Endpoint: "an endpoint is its title, or a mapping with a `title`",
    Part: "a part of a frame is a mapping, such as `{type: uint8, id: true}`; only the payload's "
    "may be empty: `{}`",
    NamedValue: "a name stands for a number or a character, or a mapping with a `value`",
    NamedBit: "a flag is the number of a bit, or a mapping with a `bit`",
    NamedBits: "a run of bits is a number, LOW..HIGH, or a mapping with `bits`",
    TransparencySyntax: "a transparency is the name of a preset, or a mapping with `substitute`, "
    "`escape`, `encoding` or `preset`",
    Step: "a step is the name of a message, or a mapping with a `message`",
    FrameForm: "a form of frame is a mapping with a `frame`",
    Source: "a source is the lines of the document, or a mapping",
}
"""Forms of what may stand where one of these is."""


_NAMES = {
    "messages": "`messages` is a mapping: each message's name, with its keys below",
    "forms": "`forms` is a mapping: each form's name, with its `frame` below",
    "frame": "`frame` is a mapping: each part's name, with its keys behind it",
    "endpoints": "`endpoints` is a mapping: each endpoint's name, with its title behind it",
    "types": "`types` is a mapping: each type's name, with its keys behind it",
    "values": "`values` is a mapping of names to numbers",
    "special": "`special` is a mapping of names to numbers",
    "flags": "`flags` is a mapping of names to bits",
    "bits": "`bits` is a mapping of names to bits",
    "cases": "`cases` is a mapping of values to fields",
}
"""Mappings of names."""


def _key(loc: Loc) -> str:
    """The key at the end of a place: no label of a tagged union, nor the frame of all senders."""
    return next((str(step) for step in reversed(loc) if step not in ("", "mapping")), "")


def _form(detail: ErrorDetails) -> str | None:
    """All forms that what stands here may have, where it has none of them."""
    loc = detail["loc"]
    if detail["type"] in ("model_type", "model_attributes_type"):
        models = _models_at(SCHEMA, loc)
        return next((_FORMS[model] for model in models if model in _FORMS), None)
    if detail["type"] == "dict_type" and _key(loc) in _NAMES:
        return _NAMES[_key(loc)]
    if detail["type"] == "dict_type" and "fields" in loc[-2:]:
        more = ", or `unspecified`" if loc[-1] == "mapping" else ""
        return f"`fields` is a mapping of names to fields{more}"
    return None


def _report_name(
    loc: Loc, written: object, find: Find, problems: Problems, hint: str | None
) -> None:
    if isinstance(written, bool):
        word = str(written).lower()
        text, hint = f"`{word}` is true or false to YAML, and no name", f'write `"{word}"`'
    else:
        text = f"`{written}` is no name: names are lower snake case, such as `left_motor`"
    problems.add("PG103", find(loc), text, hint)


def _key_hint(word: str, known: Sequence[str]) -> str | None:
    # `untis` is `unit` for two reasons at once, which no single word would be taken for.
    close = hint_for(word, known) or hint_for(word.removesuffix("s"), known)
    if close is not None or not known:
        return close
    return f"keys are {', '.join(known)}"


_CHOICE = re.compile(r"'([^']*)'|(True)")


def _choice_hint(detail: ErrorDetails) -> str | None:
    """The choice that was probably meant, where there are few; the message lists all of them."""
    written = detail["input"]
    if not isinstance(written, str):
        return None
    if detail["type"] == "bool_type":
        return hint_for(written, ("true", "false"))
    expected = str(detail.get("ctx", {}).get("expected", ""))
    return hint_for(written, [(text or word).lower() for text, word in _CHOICE.findall(expected)])


_YAML_WORDS = (
    (r"^Value error, ", ""),
    (r"^Dictionary should have at least 1 item.*", "there is nothing in it"),
    (r" or instance of \w+", ""),
    (r"^(Input|String|Dictionary) should", "this should"),
    (r"\bshould be greater than or equal to 0$", "can't be negative"),
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


def keys_beside(loc: Steps) -> tuple[str, ...]:
    """The keys that may be written where this one may not; other forms may have it."""
    models = map(keys_of, _models_at(SCHEMA, loc[:-1]))
    found = (key for keys in models if loc[-1] not in keys for key in keys)
    return tuple(dict.fromkeys(map(str, found)))


def _models_at(form: Form, loc: Steps) -> list[type[BaseModel]]:
    """The classes that describe what stands at `loc`, seen from what holds it."""
    if not loc:
        return form.models
    inner = form.inside(loc[0])
    # The label of a tagged union stands in the location, but not in the annotation.
    return _models_at(inner, loc[1:]) or (_models_at(inner, loc[2:]) if loc[1:] else [])
