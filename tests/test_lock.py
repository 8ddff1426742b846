"""A lock holds what bytes and their meaning depend on, and gives it back."""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType

import pytest
from cli_support import run
from compiled import ROOT, SCHEMAS, module_at, name_of, protocol_of
from corpus import material_of

from protogen.evolution.findings import findings
from protogen.evolution.lock import LockError, lock_text, read_lock
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol


def locked(protocol: Protocol, folder: Path) -> Protocol:
    path = folder / "protogen.lock"
    path.write_text(lock_text({"a.yaml": protocol}), encoding="utf-8")
    (found,) = read_lock(path).values()
    return found


@pytest.mark.parametrize("path", SCHEMAS, ids=name_of)
def test_a_locked_protocol_is_the_same_protocol(path: Path, tmp_path: Path) -> None:
    protocol = protocol_of(path)
    back = locked(protocol, tmp_path)
    assert lock_text({"x": back}) == lock_text({"x": protocol})
    assert findings(protocol, back)[1] == []
    codec = module_of(back)
    for sender in protocol.senders:
        for frame in material_of(path, sender.name).frames[:20]:
            assert read(codec, sender.name, frame) == read(module_at(path), sender.name, frame)


def read(module: ModuleType, sender: str, frame: bytes) -> list[tuple[str, bytes, object]]:
    decoder = module.Decoder(sender)
    events = [*decoder.feed(frame), *decoder.flush()]
    names = [getattr(getattr(event, "message", None), "NAME", None) for event in events]
    return [(event.kind, event.raw, name) for event, name in zip(events, names, strict=True)]


def test_texts_for_people_are_left_out() -> None:
    text = lock_text({"rn1.yaml": protocol_of(ROOT / "schemas" / "rn1.yaml")})
    assert "RN#1 BRAIN, a mobile robot" not in text
    assert json.loads(text)["schemas"]["rn1.yaml"]["messages"].keys() >= {"gyro", "lidar"}


def test_a_message_has_a_hash_of_its_own(tmp_path: Path) -> None:
    text = (ROOT / "schemas" / "matty.yaml").read_text(encoding="utf-8")
    before = protocol_of(ROOT / "schemas" / "matty.yaml")
    after = protocol_of(ROOT / "schemas" / "dialects" / "matty_v4.yaml")
    differ = {
        message.name
        for message in before.messages
        if message.spec_hash != after.message(message.name).spec_hash
    }
    assert "status" in differ
    assert differ < {message.name for message in before.messages}
    assert text


@pytest.mark.parametrize(
    "text",
    ["", "{}", "[]", '{"form": 7}', '{"form": 1, "schemas": {"a": {"model": {"class": "X"}}}}'],
)
def test_what_is_no_lock_is_said_to_be_none(text: str, tmp_path: Path) -> None:
    path = tmp_path / "protogen.lock"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(LockError, match=r"protogen\.lock"):
        read_lock(path)


def test_breaking_against_a_lock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    schema = tmp_path / "rn1.yaml"
    text = (ROOT / "schemas" / "rn1.yaml").read_text(encoding="utf-8")
    schema.write_text(text, encoding="utf-8")
    assert run("lock", "rn1.yaml").exit_code == 0
    assert run("lock", "rn1.yaml", "--check").exit_code == 0
    assert run("breaking", "rn1.yaml", "--against-lock", "protogen.lock").exit_code == 0
    assert text.count("byte_order: little") == 1
    schema.write_text(text.replace("byte_order: little", "byte_order: big"), encoding="utf-8")
    assert run("lock", "rn1.yaml", "--check").exit_code == 1
    found = run("breaking", "rn1.yaml", "--against-lock", "protogen.lock")
    assert found.exit_code == 1
    assert "field-byte-order" in found.stdout
    assert run("breaking", "rn1.yaml", "--against-lock", "none.lock").exit_code == 2
