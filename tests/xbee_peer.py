"""digi-xbee, as the tests of both modes of XBee's API use it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from ipaddress import IPv4Address
from types import SimpleNamespace
from typing import Any

from library_support import encoded, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PACKETS = {
    "transmit_64": "raw.TX64Packet",
    "transmit_16": "raw.TX16Packet",
    "at": "common.ATCommPacket",
    "at_queue": "common.ATCommQueuePacket",
    "transmit": "common.TransmitPacket",
    "explicit_transmit": "common.ExplicitAddressingPacket",
    "remote_at": "common.RemoteATCommandPacket",
    "transmit_sms": "cellular.TXSMSPacket",
    "transmit_ipv4": "network.TXIPv4Packet",
    "create_source_route": "zigbee.CreateSourceRoutePacket",
    "register_joining_device": "zigbee.RegisterJoiningDevicePacket",
    "send_data_request": "devicecloud.SendDataRequestPacket",
    "device_response": "devicecloud.DeviceResponsePacket",
    "user_data_relay": "relay.UserDataRelayPacket",
    "socket_create": "socket.SocketCreatePacket",
    "socket_option": "socket.SocketOptionRequestPacket",
    "socket_connect": "socket.SocketConnectPacket",
    "socket_close": "socket.SocketClosePacket",
    "socket_send": "socket.SocketSendPacket",
    "socket_send_to": "socket.SocketSendToPacket",
    "socket_bind": "socket.SocketBindListenPacket",
    "receive_64": "raw.RX64Packet",
    "receive_16": "raw.RX16Packet",
    "at_response": "common.ATCommResponsePacket",
    "transmit_16_status": "raw.TXStatusPacket",
    "modem_status": "common.ModemStatusPacket",
    "transmit_status": "common.TransmitStatusPacket",
    "route_information": "digimesh.RouteInformationPacket",
    "receive": "common.ReceivePacket",
    "explicit_receive": "common.ExplicitRXIndicatorPacket",
    "node_identification": "base.UnknownXBeePacket",
    "remote_at_response": "common.RemoteATCommandResponsePacket",
    "io_sample_64": "raw.RX64IOPacket",
    "io_sample_16": "raw.RX16IOPacket",
    "io_sample": "common.IODataSampleRxIndicatorPacket",
    "receive_sms": "cellular.RXSMSPacket",
    "ota_update_status": "zigbee.OTAFirmwareUpdateStatusPacket",
    "route_record": "zigbee.RouteRecordIndicatorPacket",
    "register_joining_device_status": "zigbee.RegisterDeviceStatusPacket",
    "user_data_relay_output": "relay.UserDataRelayOutputPacket",
    "receive_ipv4": "network.RXIPv4Packet",
    "send_data_response": "devicecloud.SendDataResponsePacket",
    "device_request": "devicecloud.DeviceRequestPacket",
    "device_response_status": "devicecloud.DeviceResponseStatusPacket",
    "socket_create_response": "socket.SocketCreateResponsePacket",
    "socket_option_response": "socket.SocketOptionResponsePacket",
    "socket_connect_response": "socket.SocketConnectResponsePacket",
    "socket_close_response": "socket.SocketCloseResponsePacket",
    "socket_listen_response": "socket.SocketListenResponsePacket",
    "socket_new_client": "socket.SocketNewIPv4ClientPacket",
    "socket_receive": "socket.SocketReceivePacket",
    "socket_receive_from": "socket.SocketReceiveFromPacket",
    "socket_state": "socket.SocketStatePacket",
    "frame_error": "devicecloud.FrameErrorPacket",
}
"""Its class for each message; the arguments are in the order of the fields."""
DERIVED = {
    *("number_of_hops", "path_length", "content_type_length", "target_length", "reserved"),
    *("transport", "flags", "length"),
}
"""Fields that are no argument: it works them out, or always sends the same."""
ALWAYS_ZERO = {
    *(("socket_send", "options"), ("socket_send_to", "options"), ("transmit_sms", "options")),
    *(("receive_ipv4", "status"), ("socket_receive", "status"), ("socket_receive_from", "status")),
    *(("device_response", "reserved"), ("device_request", "transport")),
    ("route_information", "reserved"),
    *(("device_request", "flags"), ("send_data_request", "transport")),
}
"""Fields that digi-xbee sends as 0."""
LIMITS: dict[tuple[str, str], tuple[int, ...]] = {
    **dict.fromkeys(ALWAYS_ZERO, (0,)),
    ("route_information", "cause"): (0x11, 0x12),
    ("node_identification", "role"): (0, 1, 2),
}
"""Fields of which digi-xbee knows a few values only."""
PROPERTIES = {
    "source_64": "x64bit_source_addr",
    "source_16": "x16bit_source_addr",
    "destination_64": "x64bit_dest_addr",
    "destination_16": "x16bit_dest_addr",
    "cause": "src_event",
    "responder_64": "responder_addr",
    "successor_64": "successor_addr",
    "additional": "_RouteInformationPacket__additional_data",
    "device_64": "registrant_address",
    "updater_16": "x16bit_updater_addr",
    "target_64": "x64bit_target_addr",
    "destination_endpoint": "dest_endpoint",
    "destination_port": "dest_port",
    "destination_address": "dest_address",
    "address": "dest_address",
    "address_type": "dest_address_type",
    "bootloader_message": "bootloader_msg_type",
    "retries": "transmit_retry_count",
    "delivery": "transmit_status",
    "discovery": "discovery_status",
    "data": "rf_data",
    "text": "data",
    "file": "file_data",
    "response": "request_data",
}
"""Its names for fields that it calls otherwise."""
OF_MESSAGE = {
    # Its property of that name returns the other endpoint.
    ("explicit_transmit", "source_endpoint"): "_ExplicitAddressingPacket__src_ed",
    ("create_source_route", "options"): "route_cmd_options",
    ("register_joining_device", "options"): "options",
    ("send_data_request", "options"): "options",
    ("route_information", "source_64"): "src_addr",
    ("route_information", "destination_64"): "dst_addr",
    ("at_response", "value"): "command_value",
    ("at_response", "status"): "real_status",
    ("remote_at_response", "value"): "command_value",
    ("remote_at_response", "status"): "real_status",
    ("socket_option", "value"): "option_data",
    ("socket_option_response", "value"): "option_data",
    ("socket_send", "data"): "payload",
    ("socket_send_to", "data"): "payload",
    ("socket_receive", "data"): "payload",
    ("socket_receive_from", "data"): "payload",
    ("transmit_16_status", "status"): "transmit_status",
    ("modem_status", "status"): "modem_status",
    ("transmit_ipv4", "protocol"): "ip_protocol",
    ("receive_ipv4", "protocol"): "ip_protocol",
    ("user_data_relay", "destination"): "dest_interface",
    ("user_data_relay_output", "source"): "src_interface",
    ("device_request", "data"): "request_data",
    ("transmit_ipv4", "data"): "data",
    ("receive_ipv4", "data"): "data",
    ("user_data_relay", "data"): "data",
    ("user_data_relay_output", "data"): "data",
}
"""Its names for fields, where they are those of one message."""
ENUMS = {
    ("transmit_16_status", "status"): "status.TransmitStatus",
    ("modem_status", "status"): "status.ModemStatus",
    ("transmit_status", "delivery"): "status.TransmitStatus",
    ("transmit_status", "discovery"): "status.DiscoveryStatus",
    ("register_joining_device", "options"): "options.RegisterKeyOptions",
    ("register_joining_device_status", "status"): "status.ZigbeeRegisterStatus",
    ("ota_update_status", "bootloader_message"): "status.EmberBootloaderMessageType",
    ("transmit_ipv4", "protocol"): "protocol.IPProtocol",
    ("receive_ipv4", "protocol"): "protocol.IPProtocol",
    ("socket_create", "protocol"): "protocol.IPProtocol",
    ("send_data_request", "options"): "options.SendDataRequestOptions",
    ("send_data_response", "status"): "status.DeviceCloudStatus",
    ("device_response_status", "status"): "status.DeviceCloudStatus",
    ("frame_error", "error"): "status.FrameError",
    ("user_data_relay", "destination"): "options.XBeeLocalInterface",
    ("user_data_relay_output", "source"): "options.XBeeLocalInterface",
    ("socket_option", "option"): "options.SocketOption",
    ("socket_option_response", "option"): "options.SocketOption",
    ("socket_option_response", "status"): "status.SocketStatus",
    ("socket_create_response", "status"): "status.SocketStatus",
    ("socket_connect_response", "status"): "status.SocketStatus",
    ("socket_close_response", "status"): "status.SocketStatus",
    ("socket_listen_response", "status"): "status.SocketStatus",
    ("socket_state", "state"): "status.SocketState",
}
"""Fields whose values are of an enumeration of its own."""


CALLS = [
    Case("host", "transmit_sms", {"frame_id": 1, "options": 0, **call}, {})
    for call in (
        {"phone_number": "+4915112345678", "text": "hi"},
        {"phone_number": "1", "text": "~}"},
    )
] + [Case("module", "receive_sms", {"phone_number": "+4915112345678", "text": "hi"}, {})]
"""Short messages: samples of text seldom hold a number that digi-xbee takes."""


class DigiXbee:
    """digi-xbee in one mode: packets, and the port that finds them in a stream."""

    def __init__(self, *, escaped: bool) -> None:
        modes = peer_module("digi.xbee.models.mode").OperatingMode
        self._mode = modes.ESCAPED_API_MODE if escaped else modes.API_MODE
        self._escaped = escaped
        self._base: Any = peer_module("digi.xbee.packets.base")
        self._factory: Any = peer_module("digi.xbee.packets.factory")
        self._address: Any = peer_module("digi.xbee.models.address")

    def _enum(self, case: Case, field: str) -> Any:
        name = ENUMS.get((case.message, field))
        if name is None:
            return None
        module, _, kind = name.partition(".")
        return getattr(peer_module(f"digi.xbee.models.{module}"), kind)

    def knows(self, case: Case) -> bool:
        """True if it has the values of a case."""
        if case.message.startswith("io_sample"):
            return has_lines(case.values)
        for field, value in case.values.items():
            kind = self._enum(case, field)
            if kind is not None and value not in [it.code for it in kind if it.name != "UNKNOWN"]:
                return False
            if value not in LIMITS.get((case.message, field), (value,)):
                return False
            if field == "command" and len(value) != 2:
                return False
            if field == "phone_number" and not re.fullmatch(r"\+?\d{1,18}", value):
                return False
            if field == "address" and (isinstance(value, str) or not value["value"]):
                return False
        return True

    def _class(self, case: Case) -> Any:
        module, _, kind = PACKETS[case.message].partition(".")
        return getattr(peer_module(f"digi.xbee.packets.{module}"), kind)

    def frame(self, case: Case) -> bytes:
        if case.message.startswith("io_sample"):
            return self._sample_frame(case)
        if case.message == "node_identification":
            payload = bytearray(encoded("xbee1", case)[4:-1])  # It makes none of values.
            packet = self._base.UnknownXBeePacket(0x95, payload, op_mode=self._mode)
            return bytes(packet.output(escaped=self._escaped))
        without = {field for message, field in ALWAYS_ZERO if message == case.message} | DERIVED
        if case.message.startswith("socket_receive"):
            without.discard("frame_id")
        given = [
            self._given(case, field, value)
            for field, value in case.values.items()
            if field not in without
        ]
        made = self._class(case)(*given, op_mode=self._mode)
        return bytes(made.output(escaped=self._escaped))

    def _sample_frame(self, case: Case) -> bytes:
        """It makes no samples: those of ours go into a packet of it."""
        fields = [field for field in case.values if field in HEADS]
        size = sum(HEADS[field] for field in fields)
        samples = encoded("xbee1", case)[4 + size : -1]
        given = [self._given(case, field, case.values[field]) for field in fields]
        packet = self._class(case)(*given, bytearray(samples), op_mode=self._mode)
        return bytes(packet.output(escaped=self._escaped))

    def _given(self, case: Case, field: str, value: Any) -> Any:
        kind = self._enum(case, field)
        if kind is not None:
            return kind.get(value)
        if field == "hops":
            return [self._short(hop) for hop in value]
        if field.endswith("_64"):
            return self._address.XBee64BitAddress(bytearray(value.to_bytes(8, "big")))
        if field.endswith("_16"):
            return self._short(value)
        if isinstance(value, dict):
            inner = value["value"]
            return inner if isinstance(inner, str) else bytearray(inner)
        if isinstance(value, list):
            return IPv4Address(bytes(value))
        if field in BYTES:
            data = bytearray.fromhex(value)
            return data if field == "additional" else data or None
        return value.encode() if field == "text" else value

    def _short(self, value: int) -> Any:
        return self._address.XBee16BitAddress(bytearray(value.to_bytes(2, "big")))

    def values(self, case: Case, frame: bytes) -> Values:
        raw = self._base.XBeeAPIPacket.unescape_data(frame) if self._escaped else bytearray(frame)
        packet = self._class(case).create_packet(raw, self._mode)
        if case.message == "node_identification":
            return case.values | self._identified(raw[15:-1])
        if not case.message.startswith("io_sample"):
            return {field: self._ours(case, packet, field) for field in case.values}
        heads = {it: self._ours(case, packet, it) for it in case.values if it in HEADS}
        return heads | self._sampled(case.values, packet.io_sample)

    def _identified(self, data: bytearray) -> Values:
        """What its network takes of a node that identifies itself, from the address on."""
        kind: Any = peer_module("digi.xbee.devices").XBeeNetwork
        zigbee = peer_module("digi.xbee.models.protocol").XBeeProtocol.ZIGBEE
        network = SimpleNamespace(_local_xbee=SimpleNamespace(get_protocol=lambda: zigbee))
        read = kind._XBeeNetwork__get_data_for_remote
        remote_16, remote_64, name, role, parent = read(network, data)
        return {
            "remote_16": as_ours(0, remote_16, "remote_16"),
            "remote_64": as_ours(0, remote_64, "remote_64"),
            "name": name,
            "parent_16": as_ours(0, parent, "parent_16"),
            "role": role.id,
        }

    def _sampled(self, values: Values, sample: Any) -> Values:
        """The fields of a sample, ours where it has the same lines at the same levels."""
        lines: Any = peer_module("digi.xbee.io").IOLine
        high: Any = peer_module("digi.xbee.io").IOValue.HIGH
        digital, analog = masks(values)
        found = sample.digital_mask, sample.analog_mask
        assert found == (digital, analog), (found, values)
        theirs = {f"ad{index}": sample.get_analog_value(lines.get(index)) for index in range(6)}
        theirs["supply"] = sample.power_supply_value if values.get("supply") is not None else None
        for index in range(16):
            if digital >> index & 1:
                level = sample.get_digital_value(lines.get(index)) == high
                assert level == bool(values["levels"] >> index & 1), index
        assert (values["levels"] is None) == (digital == 0)
        masked = {"sets", "channels", "digital_channels", "analog_channels", "levels"}
        return {
            field: value if field in masked else theirs[field]
            for field, value in values.items()
            if field not in HEADS
        }

    def _ours(self, case: Case, packet: Any, field: str) -> Any:
        value = case.values[field]
        if field in DERIVED or (case.message, field) in ALWAYS_ZERO:
            return value
        name = OF_MESSAGE.get((case.message, field)) or PROPERTIES.get(field, field)
        if field == "options" and (case.message, field) not in OF_MESSAGE:
            name = "transmit_options" if case.sender == "host" else "receive_options"
        theirs = getattr(packet, name)
        return as_ours(value, theirs, field)

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """The frames that its port reads and its factory takes."""
        port = port_class()(data)
        while not port.at_end:
            raw = port.wait_for_frame(self._mode)
            if raw is None:
                continue
            try:
                packet = self._factory.build_frame(raw, self._mode)
            except Exception:  # They are of many kinds where a frame is damaged.
                continue
            yield bytes(packet.output(escaped=self._escaped))


BYTES = {"additional", "data", "parameter", "value", "key", "file", "response"}
"""Fields of bytes."""


HEADS = {"source_64": 8, "source_16": 2, "rssi": 1, "options": 1}
"""Fields in front of a sample, and their bytes."""


def masks(values: Values) -> tuple[int, int]:
    """The digital and the analog lines of a sample, a bit each."""
    if "channels" in values:
        return values["channels"] & 0x1FF, values["channels"] & 0x7E00
    return values["digital_channels"], values["analog_channels"]


def has_lines(values: Values) -> bool:
    """True if there is a line, and all are lines that there are."""
    if "channels" in values:
        return bool(0 < values["channels"] < 0x8000)
    digital, analog = masks(values)
    return digital < 0x2000 and analog & 0x70 == 0 and (digital, analog) != (0, 0)


def as_ours(value: Any, theirs: Any, field: str) -> Any:
    """A value of digi-xbee, as we have it."""
    if field == "hops":
        return [int.from_bytes(hop.address, "big") for hop in theirs]
    if field.endswith(("_64", "_16")):
        return int.from_bytes(theirs.address, "big")
    if isinstance(theirs, IPv4Address):
        return list(theirs.packed)
    if hasattr(theirs, "code"):
        return theirs.code
    if field in BYTES:  # In one, it leaves the checksum at the end.
        return bytes(theirs[:-1] if field == "additional" else theirs or b"").hex()
    if isinstance(value, dict):
        return {"value": theirs if isinstance(theirs, str) else list(theirs)}
    if isinstance(theirs, bytes | bytearray):
        return theirs.rstrip(b"\0").decode()
    return theirs or "" if isinstance(value, str) else theirs


def port_class() -> Callable[[bytes], Any]:
    """Its serial port, which reads from memory."""
    serial: Any = peer_module("digi.xbee.serial").XBeeSerialPort

    class Port(serial):  # type: ignore[misc]
        def __init__(self, data: bytes) -> None:
            self._data = data
            self._is_reading = False

        @property
        def at_end(self) -> bool:
            return not self._data

        def read(self, size: int = 1) -> bytes:
            piece, self._data = self._data[:size], self._data[size:]
            return piece

        def __del__(self) -> None:
            pass  # There is no port to close.

    return Port
