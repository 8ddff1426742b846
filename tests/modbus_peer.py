"""What pymodbus makes of the messages of Modbus."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from typing import Any

import msgspec
from compiled import protocol_of
from library_support import cases_of, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

ENDPOINTS = ["client", "server"]
DIAGNOSTICS = {
    0: "ReturnQueryData",
    1: "RestartCommunicationsOption",
    2: "ReturnDiagnosticRegister",
    3: "ChangeAsciiInputDelimiter",
    4: "ForceListenOnlyMode",
    10: "ClearCounters",
    11: "ReturnBusMessageCount",
    12: "ReturnBusCommunicationErrorCount",
    13: "ReturnBusExceptionErrorCount",
    14: "ReturnDeviceMessageCount",
    15: "ReturnDeviceNoResponseCount",
    16: "ReturnDeviceNAKCount",
    17: "ReturnDeviceBusyCount",
    18: "ReturnDeviceBusCharacterOverrunCount",
    20: "ClearOverrunCount",
}
IDENTIFICATION = 14


class Kind(msgspec.Struct, frozen=True):
    """A message: its class in a module of pymodbus, and what that has of its values."""

    module: str
    name: str
    given: Callable[[Values], Values]
    """The attributes, of the values of a JSON line."""
    read: Callable[[Any], Values]
    """The values, of an object of the class."""


def plain(module: str, name: str, **attributes: str) -> Kind:
    """A message that has the same numbers under other names."""
    return Kind(
        module,
        name,
        lambda values: {theirs: values[ours] for ours, theirs in attributes.items()},
        lambda pdu: {ours: getattr(pdu, theirs) for ours, theirs in attributes.items()},
    )


def bits_of(data: str) -> list[bool]:
    return [bool(byte >> bit & 1) for byte in bytes.fromhex(data) for bit in range(8)]


def bytes_of(bits: list[bool]) -> bytes:
    return sum(bit << at for at, bit in enumerate(bits)).to_bytes((len(bits) + 7) // 8, "little")


def bits(name: str) -> Kind:
    return Kind(
        "bit",
        name,
        lambda values: {"bits": bits_of(values["states"])},
        lambda pdu: {"bytes": len(pdu.bits) // 8, "states": bytes_of(pdu.bits).hex()},
    )


def registers(name: str) -> Kind:
    return Kind(
        "register",
        name,
        lambda values: {"registers": values["registers"]},
        lambda pdu: {"bytes": 2 * len(pdu.registers), "registers": pdu.registers},
    )


def records(name: str, given: Callable[[Values], Any], read: Callable[[Any], Values]) -> Kind:
    """A message with groups of registers, each of which is a FileRecord."""
    return Kind(
        "file",
        name,
        lambda values: {"records": [given(record) for record in values["records"]]},
        lambda pdu: {"records": [read(record) for record in pdu.records]},
    )


def file_record(**attributes: Any) -> Any:
    return peer_module("pymodbus.pdu.file_message").FileRecord(**attributes)


def words(registers: list[int]) -> bytes:
    return b"".join(register.to_bytes(2, "big") for register in registers)


def numbers(data: bytes) -> list[int]:
    return [int.from_bytes(data[at : at + 2], "big") for at in range(0, len(data), 2)]


COIL = Kind(
    "bit",
    "WriteSingleCoil",
    lambda values: {"address": values["address"], "bits": [values["value"] == 0xFF00]},
    lambda pdu: {"address": pdu.address, "value": 0xFF00 if pdu.bits[0] else 0},
)
REGISTER = Kind(
    "register",
    "WriteSingleRegister",
    lambda values: {"address": values["address"], "registers": [values["value"]]},
    lambda pdu: {"address": pdu.address, "value": pdu.registers[0]},
)
MASK = plain(
    "register", "MaskWriteRegister", address="address", and_mask="and_mask", or_mask="or_mask"
)
WRITTEN_RECORDS = records(
    "WriteFileRecord",
    lambda record: file_record(
        file_number=record["file"],
        record_number=record["record"],
        record_data=words(record["registers"]),
    ),
    lambda record: {
        "reference_type": 6,
        "file": record.file_number,
        "record": record.record_number,
        "quantity": record.record_length,
        "registers": numbers(record.record_data),
    },
)
READ_BITS = {"start": "address", "quantity": "count"}
REQUESTS = {
    "read_coils": plain("bit", "ReadCoils", **READ_BITS),
    "read_discrete_inputs": plain("bit", "ReadDiscreteInputs", **READ_BITS),
    "write_single_coil": COIL,
    "write_multiple_coils": Kind(
        "bit",
        "WriteMultipleCoils",
        lambda values: {
            "address": values["start"],
            "bits": bits_of(values["coils"]["states"])[: values["quantity"]],
        },
        lambda pdu: {
            "start": pdu.address,
            "quantity": pdu.count,
            "bytes": pdu.byte_count,
            "coils": {"states": bytes_of(pdu.bits).hex()},
        },
    ),
    "read_holding_registers": plain("register", "ReadHoldingRegisters", **READ_BITS),
    "read_input_registers": plain("register", "ReadInputRegisters", **READ_BITS),
    "write_single_register": REGISTER,
    "write_multiple_registers": Kind(
        "register",
        "WriteMultipleRegisters",
        lambda values: {
            "address": values["start"],
            "count": values["quantity"],
            "registers": values["registers"]["values"],
        },
        lambda pdu: {
            "start": pdu.address,
            "quantity": pdu.count,
            "bytes": pdu.byte_count,
            "registers": {"values": pdu.registers},
        },
    ),
    "mask_write_register": MASK,
    "read_write_multiple_registers": Kind(
        "register",
        "ReadWriteMultipleRegisters",
        lambda values: {
            "read_address": values["read_start"],
            "read_count": values["read_quantity"],
            "write_address": values["write_start"],
            "write_count": values["write_quantity"],
            "write_byte_count": values["bytes"],
            "write_registers": values["registers"]["values"],
        },
        lambda pdu: {
            "read_start": pdu.read_address,
            "read_quantity": pdu.read_count,
            "write_start": pdu.write_address,
            "write_quantity": pdu.write_count,
            "bytes": pdu.write_byte_count,
            "registers": {"values": pdu.write_registers},
        },
    ),
    "read_fifo_queue": plain("file", "ReadFifoQueue", address="address"),
    "read_file_record": records(
        "ReadFileRecord",
        lambda record: file_record(
            file_number=record["file"],
            record_number=record["record"],
            record_length=2 * record["quantity"],
        ),
        lambda record: {
            "reference_type": 6,
            "file": record.file_number,
            "record": record.record_number,
            "quantity": 2 * record.record_length,  # It takes their number for one of bytes.
        },
    ),
    "write_file_record": WRITTEN_RECORDS,
    "read_exception_status": plain("other", "ReadExceptionStatus"),
    "get_comm_event_counter": plain("other", "GetCommEventCounter"),
    "get_comm_event_log": plain("other", "GetCommEventLog"),
    "report_server_id": plain("other", "ReportDeviceId"),
}
"""But for diagnostics and the identification of devices."""
RESPONSES = {
    "coils": bits("ReadCoils"),
    "discrete_inputs": bits("ReadDiscreteInputs"),
    "write_single_coil": COIL,
    "multiple_coils_written": plain("bit", "WriteMultipleCoils", **READ_BITS),
    "holding_registers": registers("ReadHoldingRegisters"),
    "input_registers": registers("ReadInputRegisters"),
    "write_single_register": REGISTER,
    "multiple_registers_written": plain("register", "WriteMultipleRegisters", **READ_BITS),
    "mask_write_register": MASK,
    "multiple_registers_read": registers("ReadWriteMultipleRegisters"),
    "fifo_queue": Kind(
        "file",
        "ReadFifoQueue",
        lambda values: {"values": values["queue"]["registers"]},
        lambda pdu: {
            "bytes": 2 + 2 * len(pdu.values),
            "queue": {"quantity": len(pdu.values), "registers": pdu.values},
        },
    ),
    "file_record": records(
        "ReadFileRecord",
        lambda record: file_record(record_data=words(record["registers"])),
        lambda record: {
            "bytes": len(record.record_data) + 1,
            "reference_type": 6,
            "registers": numbers(record.record_data),
        },
    ),
    "write_file_record": WRITTEN_RECORDS,
    "exception_status": plain("other", "ReadExceptionStatus", outputs="status"),
    "comm_event_counter": Kind(
        "other",
        "GetCommEventCounter",
        lambda values: {"status": values["state"] == 0, "count": values["events"]},
        lambda pdu: {"state": 0 if pdu.status else 0xFFFF, "events": pdu.count},
    ),
    "comm_event_log": Kind(
        "other",
        "GetCommEventLog",
        lambda values: {
            "status": values["state"] == 0,
            "event_count": values["events"],
            "message_count": values["messages"],
            "events": values["log"],
        },
        lambda pdu: {
            "bytes": 6 + len(pdu.events),
            "state": 0 if pdu.status else 0xFFFF,
            "events": pdu.event_count,
            "messages": pdu.message_count,
            "log": pdu.events,
        },
    ),
    "server_id": Kind(
        "other",
        "ReportDeviceId",
        lambda values: {
            "identifier": bytes.fromhex(values["data"])[:-1],
            "status": values["data"].endswith("ff"),
        },
        lambda pdu: {
            "bytes": pdu.byte_count,
            "data": pdu.identifier.hex() + ("ff" if pdu.status else "00"),
        },
    ),
}


class Pymodbus:
    """A framer of it, `rtu` or `ascii`, and its classes of messages."""

    def __init__(self, framing: str) -> None:
        framers: Any = peer_module("pymodbus.framer")
        pdu: Any = peer_module("pymodbus.pdu")
        framer = framers.FRAMER_NAME_TO_CLASS[framers.FramerType(framing)]
        self._is_rtu = framing == "rtu"
        self._exception = pdu.ExceptionResponse
        self._decoders = {name: pdu.DecodePDU(name == "client") for name in ENDPOINTS}
        self._framers = {name: framer(self._decoders[name]) for name in ENDPOINTS}

    def frame(self, case: Case) -> bytes:
        framer, address = self._framers[case.sender], case.parts["address"]
        if case.message in ("diagnostics", "diagnostics_response"):
            pdu = self._diagnostics(case)
        elif case.message == "exception_response":
            pdu = self._exception(case.parts["function"], case.values["code"])
        elif case.message not in kinds(case):
            kind, data = case.values["mei_type"], case.values["data"]
            if kind != IDENTIFICATION:
                content = bytes((0x2B, kind)) + bytes.fromhex(raw(data))
                frame: bytes = framer.encode(content, address, 0)
                return frame
            pdu = self._identification(case, data)
        else:
            kind = kinds(case)[case.message]
            pdu = self._new(kind.module, kind.name, case)
            for name, value in kind.given(case.values).items():
                setattr(pdu, name, value)
        pdu.dev_id = address
        whole: bytes = framer.buildFrame(pdu)
        return whole

    def _new(self, module: str, name: str, case: Case) -> Any:
        word = "Request" if case.sender == "client" else "Response"
        return getattr(peer_module(f"pymodbus.pdu.{module}_message"), name + word)()

    def _diagnostics(self, case: Case) -> Any:
        code, data = case.values["sub_function"], case.values["data"]
        if code in DIAGNOSTICS and (code != 4 or case.sender == "client"):
            pdu = self._new("diag", DIAGNOSTICS[code], case)
        else:
            pdu = peer_module("pymodbus.pdu").DiagnosticBase()
            pdu.sub_function_code = code
        pdu.message = diagnostic_bytes(data)
        return pdu

    def _identification(self, case: Case, data: Values) -> Any:
        pdu = self._new("mei", "ReadDeviceInformation", case)
        pdu.read_code = data["code"]
        if case.sender == "client":
            pdu.object_id = data["object"]
            return pdu
        pdu.conformity = data["conformity"]
        pdu.more_follows = data["more"]
        pdu.next_object_id = data["next"]
        pdu.information = {
            item["id"]: item["value"].encode("latin-1").ljust(item["size"], b"\0")
            for item in data["objects"]
        }
        return pdu

    def values(self, case: Case, frame: bytes) -> Values:
        if not is_read(case):
            return case.values
        if not self._is_rtu or is_cut(case):
            used, pdu = self._framers[case.sender].handleFrame(frame, 0, 0)
            assert used == len(frame)
            assert pdu.dev_id == case.parts["address"]
        else:
            pdu = self._decoders[case.sender].decode(frame[1:-2])
        if case.message == "exception_response":
            assert pdu.function_code == case.parts["function"]
            return {"code": pdu.exception_code}
        if case.message in kinds(case):
            return {**case.values, **kinds(case)[case.message].read(pdu)}
        if case.message in ("diagnostics", "diagnostics_response"):
            sent = self._diagnostics(case).message
            got = pdu.message if isinstance(pdu.message, bytes) else words([pdu.message])
            assert (pdu.sub_function_code, got) == (case.values["sub_function"], sent)
            return case.values
        return {"mei_type": pdu.sub_function_code, "data": identification(case, pdu)}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It takes one frame of what comes between two silences, or behind a colon."""
        framer = self._framers[endpoint]
        bursts = [data] if self._is_rtu else [b":" + line for line in data.split(b":")[1:]]
        for burst in bursts:
            try:
                _, address, _, pdu = framer.decode(burst)
            except ValueError:  # It does not expect an address of other characters than digits.
                continue
            if pdu and self._decoders[endpoint].decode(pdu) is not None:
                yield framer.encode(pdu, address, 0)


def kinds(case: Case) -> dict[str, Kind]:
    return REQUESTS if case.sender == "client" else RESPONSES


def raw(data: Any) -> str:
    """The bytes of a value that is not known, or of one that is bytes."""
    return data if isinstance(data, str) else data["value"]


def diagnostic_bytes(data: Any) -> bytes:
    if isinstance(data, str):
        return bytes.fromhex(data)
    if "value" not in data:
        return bytes((data["delimiter"], data["zero"]))
    value = data["value"]
    return words(value if isinstance(value, list) else [value])


def identification(case: Case, pdu: Any) -> Values:
    if case.sender == "client":
        return {"code": pdu.read_code, "object": pdu.object_id}
    return {
        "code": pdu.read_code,
        "conformity": pdu.conformity,
        "more": pdu.more_follows,
        "next": pdu.next_object_id,
        "count": pdu.number_of_objects,
        "objects": [
            {"id": name, "size": len(value), "value": value.rstrip(b"\0").decode("latin-1")}
            for name, value in pdu.information.items()
        ],
    }


def is_read(case: Case) -> bool:
    """False for what pymodbus has no class for, and for what its class does not read rightly."""
    values = case.values
    if "mei_type" in values:
        return bool(values["mei_type"] == IDENTIFICATION)
    if case.message == "read_file_record":
        return all(record["quantity"] % 2 == 0 for record in values["records"])
    return "sub_function" not in values or not isinstance(values["data"], str)


def is_cut(case: Case) -> bool:
    """False where its framer looks for the CRC in another place."""
    if case.values.get("sub_function") == 0:
        return len(case.values["data"]["value"]) == 1
    return case.message != "fifo_queue"


def understood(case: Case) -> Case:
    """The case, with what pymodbus makes of it: less than the document leaves open."""
    values = case.values
    if case.message == "write_multiple_coils":
        states = bits_of(values["coils"]["states"])[: values["quantity"]]
        values = {**values, "coils": {"states": bytes_of(states).hex()}}
    elif "state" in values:
        values = {**values, "state": 0 if values["state"] % 2 else 0xFFFF}
    elif case.message == "server_id":
        data = values["data"][:-2] + ("ff" if values["bytes"] % 2 else "00")
        values = {"bytes": len(data) // 2, "data": data}
    elif "objects" in values.get("data", ()):
        objects = {item["id"]: item for item in values["data"]["objects"]}
        data = {**values["data"], "count": len(objects), "objects": list(objects.values())}
        values = {**values, "data": data}
    return replace(case, values=values)


def cases_from(name: str, endpoint: str, messages: list[str] | None = None) -> list[Case]:
    """Values that pymodbus can say, of some messages or of all: it also reads 500 at least."""
    if messages is None:
        sender = protocol_of(FOLDER / f"{name}.yaml").sender(endpoint)
        messages = [message.name for message in sender.messages]
    drawn: list[Case] = []
    seeds = count(1)
    while sum(map(is_read, drawn)) < 500:
        cases = cases_of(name, messages, next(seeds))
        drawn += [understood(case) for case in cases if case.sender == endpoint]
    return drawn
