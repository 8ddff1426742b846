"""`from_payload` and `to_payload` go through generated code, and say what construct says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from compiled import DOCUMENTS, SCHEMAS, module_at, name_of
from hypothesis import given
from hypothesis import strategies as st

from protogen.runtime.constructs import PayloadError
from protogen.runtime.errors import DecodeError, EncodeError
from protogen.runtime.payload.message import build_payload

EVERY_SCHEMA = pytest.mark.parametrize("path", SCHEMAS, ids=name_of)


def read_as_reference(kind: Any, payload: bytes) -> Any:
    try:
        return repr(kind.parse_payload(payload))
    except PayloadError as error:
        return error.reason, error.problem, error.offset, error.path


def read(kind: Any, payload: bytes) -> Any:
    try:
        return repr(kind.from_payload(payload))
    except DecodeError as error:
        return error.reason, error.problem, error.offset, error.path


def written(write: Any, *arguments: Any) -> Any:
    try:
        return write(*arguments)
    except EncodeError as error:
        return error.path, error.problem


@EVERY_SCHEMA
@given(data=st.data())
def test_payloads_are_what_construct_makes_of_them(path: Path, data: Any) -> None:
    kind = data.draw(st.sampled_from(list(module_at(path).MESSAGES.values())))
    least, greatest = kind.SIZES.least, kind.SIZES.greatest
    some = st.binary(min_size=least, max_size=min(greatest, least + 40))
    payload = data.draw(some | st.binary(min_size=max(least - 2, 0), max_size=greatest + 2))
    for given_ in (payload, bytes(byte & 0x7F for byte in payload), bytes(len(payload))):
        due = read_as_reference(kind, given_)
        assert read(kind, given_) == read(kind, bytearray(given_)) == due
        if isinstance(due, str):
            message = kind.from_payload(given_)
            for strict in (True, False):
                made = written(message.to_payload, strict)
                assert made == written(build_payload, message, strict)
                assert type(made) in (bytes, tuple)


def never(*_: Any) -> Any:
    raise AssertionError("the reference is asked about what is plainly in order")


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_the_reference_is_not_asked(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """At least where a payload of zero bytes is in order."""
    kinds = module_at(path).MESSAGES.values()
    zero = [
        kind for kind in kinds if isinstance(read_as_reference(kind, bytes(kind.SIZES.least)), str)
    ]
    monkeypatch.setattr("protogen.runtime.payload.message.build_payload", never)
    monkeypatch.setattr("protogen.runtime.payload.message.Message.parse_payload", never)
    assert zero
    for kind in zero:
        payload = bytes(kind.SIZES.least)
        if kind.__write__ is not None:
            assert kind.from_payload(payload).to_payload() == payload


def test_a_derived_class_leaves_it_to_the_reference() -> None:
    status = module_at(next(path for path in DOCUMENTS if path.stem == "matty")).Status

    class Derived(status):  # type: ignore[misc, valid-type]
        """Has what its base has, but is no message of the module."""

    payload = bytes(status.SIZES.least)
    derived = Derived.from_payload(payload)
    assert type(derived) is Derived
    assert derived.to_payload() == payload
