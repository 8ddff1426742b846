"""Frames as the schema writes them: whose they are, and where their keys stand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypedDict

import msgspec

from protogen.schema.syntax.messages import MessageSyntax
from protogen.schema.syntax.parts import Part, TransparencySyntax
from protogen.schema.syntax.protocol import ALL_SENDERS, FrameForm, ProtocolSyntax

Loc = tuple[str | int, ...]
"""Place in the schema: keys and indexes from the root."""


class WrittenFrame(msgspec.Struct, frozen=True):
    """A frame of one endpoint as it is written; other endpoints may share it."""

    endpoint: str
    loc: Loc
    """Place of its parts."""
    parts: Mapping[str, Part]
    """Those that take bytes."""
    silences: Mapping[str, Part]
    """Those that are a silence of the line."""
    names: tuple[str, ...]
    """Names of all parts, in order."""
    transparency: TransparencySyntax | None = None
    transparency_loc: Loc = ()
    form: str = ""
    """Name of the form, where the schema has forms."""
    behind: str | None = None
    """The decision that accepts that forms above it win."""
    is_only: bool = True
    """True if the endpoint sends no other form."""
    limit: int | None = None
    """Wire bytes that no frame exceeds, where that is stated."""
    limit_loc: Loc = ()

    def carries(self, message: MessageSyntax) -> bool:
        """True if the endpoint sends the message in this form."""
        return self.endpoint in message.from_ and (
            message.forms is None or self.form in message.forms
        )


def written_frames(syntax: ProtocolSyntax) -> Iterator[tuple[str, WrittenFrame]]:
    """Yield each frame of each endpoint, under the name of the sender.

    That is the endpoint's, with the form's behind it where the endpoint has several.
    """
    if syntax.forms is not None:
        for endpoint in syntax.endpoints:
            yield from _forms_of(syntax, syntax.forms, endpoint)
        return
    for endpoint in syntax.endpoints or (ALL_SENDERS,):
        key = endpoint if endpoint in syntax.frame else ALL_SENDERS
        if key in syntax.frame:
            yield endpoint, _of_endpoint(syntax, endpoint, key)


def _forms_of(
    syntax: ProtocolSyntax, forms: Mapping[str, FrameForm], endpoint: str
) -> Iterator[tuple[str, WrittenFrame]]:
    own = [name for name, form in forms.items() if form.from_ is None or endpoint in form.from_]
    for name in own:
        form, loc = forms[name], ("forms", name)
        stated = (form.max_frame, (*loc, "max_frame"))
        limit, limit_loc = _limit(syntax, endpoint) if form.max_frame is None else stated
        yield (
            endpoint if len(own) == 1 else f"{endpoint}_{name}",
            WrittenFrame(
                endpoint=endpoint,
                loc=(*loc, "frame"),
                **_divided(form.frame),
                transparency=form.transparency,
                transparency_loc=(*loc, "transparency"),
                form=name,
                behind=form.behind,
                is_only=len(own) == 1,
                limit=limit,
                limit_loc=limit_loc,
            ),
        )


def _of_endpoint(syntax: ProtocolSyntax, endpoint: str, key: str) -> WrittenFrame:
    stuffing = endpoint if endpoint in syntax.transparency else ALL_SENDERS
    limit, limit_loc = _limit(syntax, endpoint)
    return WrittenFrame(
        endpoint=endpoint,
        loc=("frame", key),
        **_divided(syntax.frame[key]),
        transparency=syntax.transparency.get(stuffing),
        transparency_loc=("transparency", stuffing),
        limit=limit,
        limit_loc=limit_loc,
    )


class _Divided(TypedDict):
    parts: Mapping[str, Part]
    silences: Mapping[str, Part]
    names: tuple[str, ...]


def _divided(parts: Mapping[str, Part]) -> _Divided:
    return {
        "parts": {name: item for name, item in parts.items() if item.idle is None},
        "silences": {name: item for name, item in parts.items() if item.idle is not None},
        "names": tuple(parts),
    }


def _limit(syntax: ProtocolSyntax, endpoint: str) -> tuple[int | None, Loc]:
    """The greatest frame that the root states for an endpoint, and where."""
    limits, loc = syntax.max_frame, ("max_frame",)
    if endpoint in limits:
        return limits[endpoint], (*loc, endpoint)
    return limits.get(ALL_SENDERS), loc
