"""Histories of the five documents' protocols, as `protogen breaking` tells them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import yaml
from cli_support import ROOT, run
from compiled import protocol_of

from protogen.compiler import compile_file
from protogen.evolution.findings import Finding, findings
from protogen.evolution.witness import Harm, Witness
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol
from protogen.runtime.errors import DecodeError

SCHEMAS = ROOT / "schemas"
DIALECTS = SCHEMAS / "dialects"


def grave(old: Protocol, new: Protocol) -> list[Finding]:
    return [item for item in findings(old, new)[1] if item.category in ("WIRE", "VALUE")]


def of(found: Sequence[Finding], rule: str, place: str) -> Finding:
    (item,) = (f for f in found if (f.rule.name, f.change.place) == (rule, place))
    return item


def both_ways(item: Finding) -> tuple[Witness, Witness]:
    old, new = item.witnesses
    assert (old.old_sends, new.old_sends) == (True, False)
    return old, new


def written(path: Path, data: dict[str, Any]) -> Protocol:
    path.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
    compilation = compile_file(path)
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


def loaded(name: str) -> Any:
    return yaml.safe_load((SCHEMAS / name).read_text(encoding="utf-8"))


def check_rejected(old: Protocol, new: Protocol, item: Finding, reason: str) -> None:
    """Check that each side takes its own frame, and the other refuses it for that reason."""
    modules = {True: module_of(old), False: module_of(new)}
    assert (item.affected, item.harm) == ("both", "rejected")
    for witness in both_ways(item):
        assert witness.harm is Harm.REJECTED
        sender: Any = witness.sender
        mine = modules[witness.old_sends].decode(witness.frame, sender)
        assert witness.message == mine.NAME
        with pytest.raises(DecodeError, match=reason):
            modules[not witness.old_sends].decode(witness.frame, sender)


def test_the_drivers_of_rflex_cover_more_with_the_checksum() -> None:
    """Two programs that agree on every field and can't talk."""
    old = protocol_of(SCHEMAS / "rflex.yaml")
    new = protocol_of(DIALECTS / "rflex_drivers.yaml")
    found = grave(old, new)
    for sender in ("linux", "flex"):
        item = of(found, "frame-checksum-coverage", f"{sender} frame.checksum")
        assert item.category == "WIRE"
        check_rejected(old, new, item, "checksum")
        for witness in both_ways(item):
            check_rflex_sum(witness)


def check_rflex_sum(witness: Witness) -> None:
    """Work the checksum out by hand: XOR of the payload, or of the header, too."""
    inside = witness.frame[2:-2]
    content = inside.replace(b"\x1b\x00", b"\x1b").replace(b"\x7c\x1b\x01", b"\x7c")
    covered = content[5:-1] if witness.old_sends else content[:-1]
    total = 0
    for byte in covered:
        total ^= byte
    assert total == content[-1]


def test_mattys_status_grows_by_six_bytes() -> None:
    old, new = protocol_of(SCHEMAS / "matty.yaml"), protocol_of(DIALECTS / "matty_v4.yaml")
    found = grave(old, new)
    fields = [f.change.path for f in found if f.change.message == "status" and _is(f, "added")]
    assert fields == ["roll", "pitch", "yaw"]
    sizes = [protocol.message("status").sizes.greatest for protocol in (old, new)]
    assert sizes == [18, 24]
    for field in ("roll", "pitch", "yaw"):
        check_rejected(old, new, of(found, "field-added", f"status.{field}"), "size")
    check_rejected(old, new, of(found, "field-added", "stop.mode"), "size")


def _is(item: Finding, what: str) -> bool:
    return item.rule.name == f"field-{what}"


@pytest.mark.parametrize("is_first_in_old", [False, True])
def test_uherobots_leds_change_places(is_first_in_old: bool, tmp_path: Path) -> None:
    """The size is the same, so nobody notices."""
    data = loaded("uherobot.yaml")
    fields = data["messages"]["motors_servos_leds"]["fields"]
    first = {"leds": fields["leds"]} | {name: fields[name] for name in fields if name != "leds"}
    data["messages"]["motors_servos_leds"]["fields"] = first
    last = protocol_of(SCHEMAS / "uherobot.yaml")
    moved = written(tmp_path / "uherobot.yaml", data)
    old, new = (moved, last) if is_first_in_old else (last, moved)
    found = grave(old, new)
    names = {"motor_1", "motor_2", "servos", "leds"}
    assert {(f.rule.name, f.change.path) for f in found} == {("field-moved", n) for n in names}
    assert {protocol.message("motors_servos_leds").sizes.least for protocol in (old, new)} == {21}
    for item in found:
        assert (item.affected, item.harm) == ("both", "misread")
    modules = {True: module_of(old), False: module_of(new)}
    for witness in both_ways(of(found, "field-moved", "motors_servos_leds.leds")):
        sent = modules[witness.old_sends].decode(witness.frame, "daemon")
        received = modules[not witness.old_sends].decode(witness.frame, "daemon")
        payload = bytes.fromhex(witness.frame[1:-1].decode())[2:]
        ends = {int(sent.leds), int(received.leds)}
        assert ends == {payload[0], payload[-1]}
        assert len(ends) == 2


def test_the_firmware_of_rn1_has_the_high_bits_first() -> None:
    old, new = protocol_of(SCHEMAS / "rn1.yaml"), protocol_of(DIALECTS / "rn1_firmware.yaml")
    found = grave(old, new)
    turned = [item for item in found if item.rule.name == "field-byte-order"]
    assert [f.change.place for f in turned] == [
        "move_relative_twostep.angle",
        "move_relative_twostep.forward",
    ]
    modules = {True: module_of(old), False: module_of(new)}
    for item in turned:
        assert (item.affected, item.harm) == ("both", "misread")
        for witness in both_ways(item):
            frame = witness.frame
            sent = modules[witness.old_sends].decode(frame, "host")
            received = modules[not witness.old_sends].decode(frame, "host")
            at = 1 if item.change.path == "angle" else 3
            low_first, high_first = frame[at] | frame[at + 1] << 7, frame[at] << 7 | frame[at + 1]
            by_hand = [signed(low_first), signed(high_first)]
            assert item.change.path is not None
            seen = [getattr(sent, item.change.path), getattr(received, item.change.path)]
            assert seen == (by_hand if witness.old_sends else by_hand[::-1])
            assert seen[0] != seen[1]


def signed(number: int) -> int:
    return number - 0x4000 if number & 0x2000 else number


def test_dagnys_terminator(tmp_path: Path) -> None:
    old = protocol_of(SCHEMAS / "dagny.yaml")
    data = loaded("dagny.yaml")
    data["frame"]["end"]["literal"] = {"text": "\r"}
    for message in data["messages"].values():
        message.pop("examples", None)
    new = written(tmp_path / "dagny.yaml", data)
    found = grave(old, new)
    assert {(f.rule.name, f.change.place) for f in found} == {
        ("frame-literal", "host frame.end"),
        ("frame-literal", "robot frame.end"),
    }
    modules = {True: module_of(old), False: module_of(new)}
    for item in found:
        assert item.change.text == "from 0A to 0D"
        assert item.affected == "both"
        for witness in both_ways(item):
            sender: Any = witness.sender
            assert witness.frame[-1] == (0x0A if witness.old_sends else 0x0D)
            mine = modules[witness.old_sends].decode(witness.frame, sender)
            assert witness.message == mine.NAME
            with pytest.raises(DecodeError):
                modules[not witness.old_sends].decode(witness.frame, sender)


@pytest.mark.parametrize("dialect", ["rflex_drivers", "matty_v4", "rn1_firmware"])
def test_the_gate_refuses_these(dialect: str) -> None:
    base = dialect.partition("_")[0]
    done = run("breaking", str(SCHEMAS / f"{base}.yaml"), str(DIALECTS / f"{dialect}.yaml"))
    assert done.exit_code == 1
    assert "WIRE" in done.output
