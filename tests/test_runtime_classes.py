"""Messages, parts, events and rules as Python's own tools take them: copy, pickle, match, repr."""

from __future__ import annotations

import copy
import inspect
import pickle
import sys
from importlib.util import module_from_spec, spec_from_file_location
from typing import Any, get_type_hints

import pytest

from generated.python import matty, rn1
from protogen.runtime.api import InvalidEvent, MessageEvent, UnknownEvent, as_dict, replace
from protogen.runtime.checksum import Crc
from protogen.runtime.payload.number import Number
from protogen.runtime.transparency import Substitution

# --- generated messages -------------------------------------------------------------------------


def gyro() -> rn1.Gyro:
    return rn1.Gyro(status=rn1.GyroStatus.OK, int_x=-5, int_y=0, int_z=812)


def test_a_message_is_its_fields() -> None:
    assert list(as_dict(gyro())) == ["status", "int_x", "int_y", "int_z"]
    assert as_dict(gyro()) == {"status": 1, "int_x": -5, "int_y": 0, "int_z": 812}
    assert replace(gyro(), int_y=7).int_y == 7
    assert repr(gyro()) == "Gyro(status=<GyroStatus.OK: 1>, int_x=-5, int_y=0, int_z=812)"


def test_a_message_is_compared_and_not_hashed() -> None:
    assert gyro() == gyro() != replace(gyro(), int_y=7)
    assert rn1.Xcel(status=1, int_x=0, int_y=0, int_z=0) != rn1.Gyro(
        status=1, int_x=0, int_y=0, int_z=0
    )
    with pytest.raises(TypeError, match="unhashable"):
        hash(gyro())
    with pytest.raises(AttributeError):
        gyro().speed = 1  # type: ignore[attr-defined]


def test_a_message_can_be_matched() -> None:
    match rn1.decode(rn1.encode(gyro()), "brain"):
        case rn1.Gyro(status=rn1.GyroStatus.OK, int_z=int_z):
            assert int_z == 812
        case other:
            pytest.fail(str(other))


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_messages_and_parts_are_pickled_and_copied(protocol: int) -> None:
    message = rn1.Maintenance(
        operation=rn1.MaintenanceOperation.RECONFIG_UART,
        argument=rn1.MaintenanceArgumentReconfigUart(baud_rate_register=300),
    )
    parts = matty.Parts(counter=3, command=0x47)
    for item in (message, parts, gyro()):
        assert pickle.loads(pickle.dumps(item, protocol)) == item
        assert copy.copy(item) == item
        assert copy.deepcopy(item) == item
    assert copy.deepcopy(message).magic is not message.magic == [66, 17, 122]


def test_parts_are_frozen_and_hashed() -> None:
    parts = matty.Parts(counter=3, command=0x47)
    with pytest.raises(AttributeError):
        parts.counter = 4  # type: ignore[misc]
    with pytest.raises(AttributeError):
        parts.number = 4  # type: ignore[attr-defined]
    assert {parts: 1}[matty.Parts(3, 0x47)] == 1


def test_changed_copies_by_the_protocol_of_later_pythons() -> None:
    # `copy.replace` of Python 3.13 calls it.
    replaced = copy.replace if sys.version_info >= (3, 13) else type(gyro()).__replace__
    assert replaced(gyro(), int_y=7) == replace(gyro(), int_y=7)


def test_the_types_of_arguments_can_be_looked_up() -> None:
    """As libraries do that validate arguments, or fill them in."""
    hints = get_type_hints(rn1.Lidar.__init__)
    assert hints == {
        "status": rn1.LidarStatus | int, "distances": list[int], "return": type(None),
    }  # fmt: skip
    signature = inspect.signature(rn1.Lidar, eval_str=True)
    assert signature.parameters["status"].annotation == rn1.LidarStatus | int


# --- events ---------------------------------------------------------------------------------------


def events() -> list[Any]:
    """A message, an unknown frame and noise."""
    sender = matty.PC_SENDER
    message = matty.encode(matty.Go(speed=1, steer=2), counter=3)
    unknown = matty.PROTOCOL.encode_unknown("pc", {"counter": 1, "command": 0x20}, b"ab")
    decoder = matty.Decoder(sender.name)
    return [*decoder.feed(message + unknown + b"noise"), *decoder.flush()]


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_events_are_values(protocol: int) -> None:
    kinds = [type(event) for event in events()]
    assert kinds == [MessageEvent, UnknownEvent, InvalidEvent]
    for event, again in zip(events(), events(), strict=True):
        assert event == again
        assert hash(event) == hash(again)
        assert copy.copy(event) == event
        moved = replace(event, offset=event.offset + 1)
        assert moved != event
        assert (moved.offset, moved.raw) == (event.offset + 1, event.raw)
        assert replace(moved, offset=event.offset) == event
        assert as_dict(event)["raw"] == event.raw
    for event in events()[2:]:
        assert pickle.loads(pickle.dumps(event, protocol)) == event
    assert len({*events(), *events()}) == 3


def test_parts_of_an_event_are_built_once() -> None:
    stops = b"".join(matty.encode(matty.Stop(), counter=place % 256) for place in range(600))
    in_bulk = matty.Decoder("pc").feed(stops)
    by_reference = matty.Decoder("pc", engine="construct").feed(stops[:5])
    assert len(in_bulk) == 600
    for event in (in_bulk[0], in_bulk[-1], *by_reference):
        assert isinstance(event, MessageEvent)
        assert event.parts is event.parts
        other = replace(event, numbers=(7, 0x53))
        assert (other.parts.counter, other.parts.command) == (7, 0x53)


def test_events_can_be_matched() -> None:
    message, unknown, invalid = events()
    match message:
        case MessageEvent(message=matty.Go(speed=speed), parts=matty.Parts(counter=counter)):
            assert (speed, counter) == (1, 3)
        case other:
            pytest.fail(str(other))
    match unknown, invalid:
        case UnknownEvent(payload=payload), InvalidEvent(raw=raw, reason="noise"):
            assert (payload, raw) == (b"ab", b"noise")
        case others:
            pytest.fail(str(others))


def test_dictionaries_of_events_hold_those_of_what_is_in_them() -> None:
    message, unknown, invalid = events()
    assert as_dict(message)["message"] == {"speed": 1, "steer": 2}
    assert as_dict(unknown)["parts"] == {"counter": 1, "command": 0x20}
    assert list(as_dict(invalid)) == ["offset", "raw", "sender", "reason", "problem"]


# --- what the runtime is made of ------------------------------------------------------------------


def test_declarations_are_values() -> None:
    table = {1: b"ab"}
    for item, other in (
        (Number(7, signed=True), Number(7)),
        (Crc(16, poly=0x1021), Crc(16, poly=0x8005)),
        (Substitution(table), Substitution(table, lenient=True)),
        (rn1.HOST_SENDER.frame, rn1.BRAIN_SENDER.frame),
        (matty.PC_SENDER.frame.parts[0], matty.PC_SENDER.frame.parts[1]),
    ):
        assert item == copy.copy(item) == copy.deepcopy(item) == pickle.loads(pickle.dumps(item))
        assert hash(item) == hash(copy.copy(item))
        assert item != other
    for item, name in (
        (Number(7), "bits"),
        (rn1.HOST_SENDER.frame, "start"),
        (matty.PC_SENDER.frame.parts[0], "name"),
    ):
        with pytest.raises(AttributeError, match=r"can't set|cannot assign"):
            setattr(item, name, 1)
        with pytest.raises(AttributeError, match=r"can't delete|cannot delete"):
            delattr(item, name)
    assert repr(Number(7)) == "Number(bits=7, signed=False, order='little', seven_bit=False)"
    with pytest.raises(ValueError, match="does not fit"):
        replace(Crc(8, poly=7), poly=256)


# --- FORMAT and RULES ---------------------------------------------------------------------------


def test_a_declaration_is_made_once() -> None:
    assert rn1.Gyro.FORMAT is rn1.Gyro.FORMAT is gyro().FORMAT
    assert rn1.Gyro.RULES is rn1.Gyro.RULES
    assert rn1.HOST_FORMAT is rn1.HOST_FORMAT
    with pytest.raises(AttributeError, match=r"'generated\.python\.rn1' has no attribute 'Gyros'"):
        _ = rn1.Gyros


def test_a_subclass_has_the_declarations_of_its_parent() -> None:
    class Mine(matty.Go):
        pass

    assert Mine.FORMAT is matty.Go.FORMAT
    mine = Mine(speed=1, steer=2)
    mine.steer_deg = 12.5
    assert mine.steer == 1250


def test_a_module_that_is_loaded_again_makes_its_frames_again() -> None:
    spec = spec_from_file_location("generated.python.loaded_again", matty.__file__)
    assert spec is not None
    assert spec.loader is not None
    module: Any = module_from_spec(spec)
    spec.loader.exec_module(module)
    before = module.PC_FORMAT
    spec.loader.exec_module(module)
    assert module.PC_FORMAT is not before
