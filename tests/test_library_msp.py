"""MSP 1 and 2, beside yamspy."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import pytest
from compiled import protocol_of
from library_support import (
    FRAMES,
    cases_of,
    compare_frames,
    compare_recovery,
    encoded,
    engine_of,
    peer_module,
)

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER
from protogen.model.payload_plan import (
    AnyStep,
    ChooseStep,
    IntegerStep,
    RecordStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import without_constant
from protogen.model.types import Text

HELD = {
    **dict.fromkeys(("fc_variant", "board_info", "name", "uid"), "CONFIG"),
    **dict.fromkeys(("status", "status_ex"), "CONFIG"),
    **dict.fromkeys(("raw_gps", "comp_gps", "gps_statistics"), "GPS_DATA"),
    **dict.fromkeys(("raw_imu", "altitude", "sonar", "debug", "inav_debug"), "SENSOR_DATA"),
    **dict.fromkeys(("analog", "inav_analog"), "ANALOG"),
    "dataflash_summary": "DATAFLASH",
    "sdcard_summary": "SDCARD",
    "battery_state": "BATTERY_STATE",
    "battery_config": "BATTERY_CONFIG",
    "feature_config": "FEATURE_CONFIG",
    "board_alignment_config": "BOARD_ALIGNMENT_CONFIG",
    "mixer_config": "MIXER_CONFIG",
    "rx_config": "RX_CONFIG",
    "rssi_config": "RSSI_CONFIG",
    "arming_config": "ARMING_CONFIG",
    "failsafe_config": "FAILSAFE_CONFIG",
    "blackbox_config": "BLACKBOX",
    "advanced_config": "PID_ADVANCED_CONFIG",
    "filter_config": "FILTER_CONFIG",
    "pid_advanced": "ADVANCED_TUNING",
    "sensor_config": "SENSOR_CONFIG",
    "rc_tuning": "RC_TUNING",
    "motor_3d_config": "MOTOR_3D_CONFIG",
    "rc_deadband": "RC_DEADBAND_CONFIG",
    "sensor_alignment": "SENSOR_ALIGNMENT",
    "motor_config": "MOTOR_CONFIG",
    "gps_config": "GPS_CONFIG",
    "compass_config": "COMPASS_CONFIG",
    "gps_rescue": "GPS_RESCUE",
    "beeper_config": "BEEPER_CONFIG",
    "inav_misc": "MISC",
}
"""Messages whose values yamspy has by name, and where."""
LISTS = {
    "servo": ("servos", "SERVO_DATA"),
    "motor": ("motors", "MOTOR_DATA"),
    "box_ids": ("ids", "AUX_CONFIG_IDS"),
    "rx_map": ("rc_map", "RC_MAP"),
    "pid": ("pids", "PIDs"),
    "pid_v2": ("pids", "PIDs"),
    "voltage_meters": ("meters", "VOLTAGE_METERS"),
    "current_meters": ("meters", "CURRENT_METERS"),
    "voltage_meter_config": ("meters", "VOLTAGE_METER_CONFIGS"),
    "current_meter_config": ("meters", "CURRENT_METER_CONFIGS"),
    "mode_ranges": ("ranges", "MODE_RANGES"),
    "mode_ranges_extra": ("ranges", "MODE_RANGES_EXTRA"),
    "adjustment_ranges": ("ranges", "ADJUSTMENT_RANGES"),
    "rxfail_config": ("channels", "RXFAIL_CONFIG"),
    "servo_configurations": ("servos", "SERVO_CONFIG"),
}
"""Messages whose values yamspy has as a list, with the name of ours."""
UNREAD = {
    *("later", "number", "byte_count", "subframe_length", "voltage_tenths", "gyro_cycle_time"),
    *("vbat_min_cell_tenths", "vbat_max_cell_tenths", "vbat_warning_cell_tenths", "vario"),
    *("target_name_length", "board_name_length", "manufacturer_id_length", "revision", "unused"),
    *("gyro_lowpass_low", "dterm_setpoint_weight_low"),
}
"""Fields that yamspy counts with, skips or does not reach."""
ONLY_EX = {"cpuload", "flight_mode_flags", "arming_disable_count", "arming_disable_flags"}
"""Fields that yamspy reads of the longer state alone."""


class Port:
    """A line, with what is there to read and what was written."""

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.written = b""

    def read(self, size: int = 1) -> bytes:
        if len(self.data) < size:
            raise EOFError  # For what is cut off it would wait for ever.
        piece, self.data = self.data[:size], self.data[size:]
        return piece

    def write(self, data: bytearray) -> int:
        self.written = bytes(data)
        return len(data)


class Yamspy:
    """yamspy: what it sends is what a host does; what a controller sends differs in a character."""

    def __init__(self) -> None:
        self._package: Any = peer_module("yamspy")
        protocol = protocol_of(FOLDER / "msp.yaml")
        self._messages = {message.name: message for message in protocol.messages}

    def _pilot(self, port: Port, case: Case | None = None) -> Any:
        pilot = self._package.MSPy("none", logfilename=None, loglevel="CRITICAL")
        pilot.conn = port
        pilot.CONFIG["apiVersion"] = "1.42.0"
        pilot.INAV = case is not None and case.message.startswith("inav_")
        return pilot

    def _code(self, case: Case) -> int:
        """By its own table, where a message has a code of its own."""
        code: int = case.parts.get("code", 0)
        known: int = self._package.MSPy.MSPCodes.get(self._messages[case.message].title, code)
        return known

    def frame(self, case: Case) -> bytes:
        port = Port()
        pilot, values = self._pilot(port), case.values
        match case.message:
            case "eeprom_write":
                pilot.save2eprom()
            case "reboot":
                pilot.reboot()
            case "set_rx_map":
                pilot.set_RX_MAP(values["rc_map"])
            case "set_feature_config":
                pilot.set_FEATURE_CONFIG(values["features"])
            case "set_raw_rc":
                pilot.send_RAW_RC(values["channels"])
            case "set_motor":
                pilot.send_RAW_MOTORS(values["motors"])
            case "arming_disable":
                pilot.set_ARMING_DISABLE(*values.values())
            case _:
                steps = self._messages[case.message].plan.steps
                pilot.send_RAW_msg(self._code(case), self._bytes(steps, values))
        mark = ">" if case.sender.endswith("answer") else "<"
        mark = "!" if case.sender.endswith("error") else mark
        return port.written[:2] + mark.encode() + port.written[3:]

    def _bytes(self, steps: Sequence[AnyStep], values: Values) -> list[int]:
        convert = self._package.MSPy.convert
        return [byte for step in steps for byte in wire(convert, step, values[step.name], values)]

    def received(self, case: Case, frame: bytes) -> tuple[Any, Any]:
        """The message that it takes out of a frame, and itself."""
        pilot = self._pilot(Port(frame + bytes(1)), case)  # It reads a byte too many of MSP 2.
        return pilot, pilot.receive_msg()

    def values(self, case: Case, frame: bytes) -> Values:
        pilot, handler = self.received(case, frame)
        if case.sender.endswith("error"):
            assert handler["unsupported"] == 1
            return {}
        assert not handler["packet_error"]
        assert handler["code"] == self._code(case)
        steps = self._messages[case.message].plan.steps
        if case.message not in {*HELD, *LISTS, *OTHERS}:
            data = bytearray(handler["dataView"])
            read = {step.name: taken(pilot.readbytes, step, data, case.values) for step in steps}
            assert not data
            return read
        if case.message == "battery_state":
            del handler["dataView"][3]  # It does not know that byte: see the decision.
        assert pilot.process_recv_data(handler) >= 0
        theirs = held(case, pilot)
        return {step.name: self._ours(case, step, theirs) for step in steps}

    def _ours(self, case: Case, step: AnyStep | RestStep, theirs: dict[str, Any]) -> Any:
        value = case.values[step.name]
        unread = UNREAD | (ONLY_EX if case.message == "status" else set())
        if step.name in unread or value == []:
            return value
        return as_ours(step, value, theirs, case.message)

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What its reader takes out of a stream, message by message."""
        port = Port(data)
        pilot = self._pilot(port)
        while True:
            start = len(data) - len(port.data)
            try:
                handler = pilot.receive_msg()
            except EOFError:
                return
            except IndexError:
                continue
            if not handler["packet_error"]:
                size = handler["message_length_expected"]
                head = {1: 5, 2: 8}[handler["msp_version"]] + 2 * handler["messageIsJumboFrame"]
                start = data.index(b"$", start)
                yield data[start : start + head + size + 1]


def plain(name: str) -> str:
    return name.replace("_", "").lower()


def wire(convert: Any, step: AnyStep | RestStep, value: Any, values: Values) -> list[int]:
    """The bytes of a value, numbers as yamspy converts them."""
    step = without_constant(step)
    match step:
        case RecordStep():
            inner = value or {}
            parts = [wire(convert, it, inner[it.name], inner) for it in step.steps]
            return [byte for part in parts for byte in part]
        case RepeatStep():
            return [byte for item in value for byte in wire(convert, step.element, item, values)]
        case ChooseStep():
            chosen = step.case(values[step.expression.text])
            assert chosen is not None
            return wire(convert, chosen, value, values)
        case IntegerStep():
            converted: list[int] = convert([value], 8 * step.sizes.greatest)
            return converted
    if step.count.until is not None:
        return [*value.encode(), 0]
    if isinstance(step.type, Text):
        return list(value.encode().ljust(step.sizes.least, b"\0"))
    return list(bytes.fromhex(value))


def taken(readbytes: Any, step: AnyStep | RestStep, data: bytearray, values: Values) -> Any:
    """The value of a step, numbers as yamspy reads them, for a message that it leaves as bytes."""
    value, step = values[step.name], without_constant(step)
    match step:
        case RecordStep():
            return value and {it.name: taken(readbytes, it, data, value) for it in step.steps}
        case RepeatStep():
            return [taken(readbytes, step.element, data, {step.element.name: it}) for it in value]
        case ChooseStep():
            chosen = step.case(values[step.expression.text])
            assert chosen is not None
            return taken(readbytes, chosen, data, {chosen.name: value})
        case IntegerStep():
            bits = 8 * step.sizes.greatest
            if bits == 64:
                low, high = (readbytes(data, size=32, unsigned=True) for _ in range(2))
                return low | high << 32
            return readbytes(data, size=bits, unsigned=not step.type.signed)
    text = isinstance(step.type, Text)
    if step.count.until is not None:
        return bytes(iter(lambda: readbytes(data, size=8, unsigned=True), 0)).decode()
    size = max(len(value) if text else len(value) // 2, step.sizes.least)
    read = bytes(readbytes(data, size=8, unsigned=True) for _ in range(size))
    return read.rstrip(b"\0").decode() if text else read.hex()


def held(case: Case, pilot: Any) -> dict[str, Any]:
    """What yamspy has of a message by our names, in small letters."""
    name = case.message
    if name in LISTS:
        ours, attribute = LISTS[name]
        return {plain(ours): getattr(pilot, attribute)}
    if name in OTHERS:
        return OTHERS[name](pilot)
    theirs = {plain(key): value for key, value in getattr(pilot, HELD[name]).items()}
    if name == "compass_config":
        theirs["magdeclination"] *= 10  # It takes tenths for hundredths: see the decision.
    if name == "battery_state" and theirs["amperage"] >= 327.68:
        theirs["amperage"] -= 655.36  # It is signed, which yamspy does not know.
    if name == "inav_misc":
        theirs["batterycapacityunit"] = ["mAh", "mWh"].index(theirs["batterycapacityunit"])
    return theirs


def api_version(pilot: Any) -> dict[str, Any]:
    major, minor, _ = pilot.CONFIG["apiVersion"].split(".")
    version = pilot.CONFIG["mspProtocolVersion"]
    return {"mspprotocolversion": version, "apimajor": int(major), "apiminor": int(minor)}


def fc_version(pilot: Any) -> dict[str, Any]:
    numbers = map(int, pilot.CONFIG["flightControllerVersion"].split("."))
    return dict(zip(("major", "minor", "patch"), numbers, strict=True))


def build_info(pilot: Any) -> dict[str, Any]:
    build = pilot.CONFIG["buildInfo"]
    return {"date": build[:11], "time": build[12:]}


def attitude(pilot: Any) -> dict[str, Any]:
    return dict(zip(("roll", "pitch", "yaw"), pilot.SENSOR_DATA["kinematics"], strict=True))


def acc_trim(pilot: Any) -> dict[str, Any]:
    return dict(zip(("pitch", "roll"), pilot.CONFIG["accelerometerTrims"], strict=True))


def names_of(names: list[str]) -> dict[str, Any]:
    return {"names": "".join(f"{name};" for name in names)}


def satellites(pilot: Any) -> dict[str, Any]:
    keys = ("chn", "svid", "quality", "cno")
    rows = list(zip(*(pilot.GPS_DATA[key] for key in keys), strict=True))
    return {"numch": len(rows), "satellites": [dict(zip(keys, row, strict=True)) for row in rows]}


def ports(pilot: Any) -> dict[str, Any]:
    return {"ports": [port_of(pilot, port) for port in pilot.SERIAL_CONFIG["ports"]]}


OTHERS: dict[str, Callable[[Any], dict[str, Any]]] = {
    "api_version": api_version,
    "fc_version": fc_version,
    "build_info": build_info,
    "attitude": attitude,
    "acc_trim": acc_trim,
    "rc": lambda pilot: dict(pilot.RC),
    "box_names": lambda pilot: names_of(pilot.AUX_CONFIG),
    "pid_names": lambda pilot: names_of(pilot.PIDNAMES),
    "gps_sv_info": satellites,
    "cf_serial_config": ports,
}
"""Messages whose values yamspy has in another way. It leaves those of the rest as bytes."""


def port_of(pilot: Any, port: dict[str, Any]) -> dict[str, Any]:
    """A serial port with numbers in the place of its names."""
    bits = {pilot.SERIAL_PORT_FUNCTIONS[name] for name in port["functions"]}
    rates = {key: pilot.BAUD_RATES.index(port[key]) for key in port if key.endswith("baudrate")}
    return {**port, **rates, "functions": sum(1 << bit for bit in bits)}


def as_ours(step: AnyStep | RestStep, value: Any, theirs: Any, message: str) -> Any:
    """A value of yamspy, as we have it; ours if that is what it says."""
    if (
        isinstance(theirs, dict)
        and plain(step.name) not in theirs
        and isinstance(step, IntegerStep)
    ):
        return bits_of(step, value, theirs)
    found = theirs[plain(step.name)] if isinstance(theirs, dict) else theirs
    match step:
        case RepeatStep():
            found = found[: len(value)] if message == "debug" else found  # It has always eight.
            items = zip(value, found, strict=True)
            return [inner(step.element, ours, its, message) for ours, its in items]
        case IntegerStep():
            physical = float(value * step.field.scale + step.field.offset)
            agrees = math.isclose(found, physical, rel_tol=1e-9) or found == value
            return value if agrees else found
    if isinstance(found, list):
        return bytes(found).hex()
    return found.rstrip("\0")


def inner(step: AnyStep | RestStep, value: Any, theirs: Any, message: str) -> Any:
    """An element of a list: a struct, a number, or one of the numbers that a list has for one."""
    if not isinstance(step, RecordStep):
        return as_ours(step, value, theirs, message)
    if isinstance(theirs, list):
        return dict(zip((it.name for it in step.steps), theirs, strict=True))
    theirs = {plain(key): its for key, its in {**theirs, **theirs.get("range", {})}.items()}
    return {
        it.name: value[it.name]
        if it.name in UNREAD
        else as_ours(it, value[it.name], theirs, message)
        for it in step.steps
    }


def bits_of(step: IntegerStep, value: int, theirs: dict[str, Any]) -> int | None:
    """The value if each of its runs of bits is as yamspy has it."""
    flags = step.type.flags.bits if step.type.flags is not None else ()
    runs = [(flag.name, value >> flag.bit & 1) for flag in flags]
    runs += [(run.name, (value & run.mask) >> run.low) for run in step.type.bit_fields]
    assert runs, step.name
    return value if all(theirs[plain(name)] == bits for name, bits in runs) else None


def is_known(case: Case) -> bool:
    """True if yamspy has such values."""
    code, values = case.parts.get("code", 0), case.values
    if case.parts.get("flags", 0) != 0:
        return False
    match case.message:
        case "refused_v1":
            return code < 255
        case "cf_serial_config":
            rates = ("msp_baudrate", "gps_baudrate", "telemetry_baudrate", "blackbox_baudrate")
            ports = values["ports"]
            return all(max(port[rate] for rate in rates) < 16 for port in ports) and not any(
                port["functions"] & 0x100 for port in ports
            )
        case "box_names" | "pid_names":
            return not values["names"] or bool(values["names"].endswith(";"))
        case "inav_misc":
            return values["battery_capacity_unit"] in (0, 1)
    return True


@pytest.fixture(scope="module")
def yamspy() -> Yamspy:
    return Yamspy()


@pytest.fixture(scope="module")
def drawn() -> list[Case]:
    refused = Case("fc_v2_error", "refused_v2", {}, {"flags": 0, "code": 0x2002})
    names = [
        Case("fc_v1_answer", f"{kind}_names", {"names": "ARM;LEVEL;"}, {})
        for kind in ("box", "pid")
    ]
    return [refused, *names, *filter(is_known, cases_of("msp"))]


def test_both_make_and_read_the_same_frames(yamspy: Yamspy, drawn: list[Case]) -> None:
    """What it sends: MSP 1 for codes up to 254 and small payloads, MSP 2 for others."""
    sent = [case for case in drawn if sends(case)]
    assert len(sent) >= FRAMES
    messages = {message.name for message in protocol_of(FOLDER / "msp.yaml").messages}
    assert {case.message for case in sent} == messages
    compare_frames("msp", yamspy, sent)


def sends(case: Case) -> bool:
    frame = encoded("msp", case)
    known: bool = frame[3] < 255 if frame[1:2] == b"M" else frame[5] > 0
    return known


@pytest.mark.parametrize("sender", ["fc_jumbo_answer", "fc_v2_answer"])
def test_it_reads_what_it_does_not_send(yamspy: Yamspy, drawn: list[Case], sender: str) -> None:
    """Jumbo frames, and MSP 2 for the codes of MSP 1."""
    engine = engine_of("msp")
    read = [case for case in drawn if case.sender == sender]
    for case in read:
        frame = engine.frame(sender, case.message, case.values, case.parts)
        assert yamspy.values(case, frame) == case.values
    assert len(read) > 5


INSIDE = ("host_v2_in_v1", "fc_v2_in_v1_answer", "fc_v2_in_v1_error")


@pytest.mark.parametrize("sender", INSIDE)
def test_it_reads_what_is_around_and_what_is_inside(
    yamspy: Yamspy, drawn: list[Case], sender: str
) -> None:
    """MSP 2 inside of MSP 1: a message of the code 255, whose payload is all but the mark."""
    engine = engine_of("msp")
    inside = [case for case in drawn if case.sender == sender]
    for case in inside:
        frame = engine.frame(sender, case.message, case.values, case.parts)
        mark = frame[2:3]
        _, around = yamspy.received(case, frame[:2] + b">" + frame[3:])
        assert (around["code"], around["packet_error"]) == (255, 0)
        assert yamspy.values(case, b"$X" + mark + bytes(around["dataView"])) == case.values
        (event,) = engine.events(sender, [frame])
        assert (event.message, event.values) == (case.message, case.values)
    assert inside


def test_a_size_around_what_is_inside_stands_behind_its_own() -> None:
    """Of a setting of 249 zeros: 255 bytes are inside, and one more than MSP 1 can say."""
    inner = bytes.fromhex("00 03 10 F9 00")
    checksum = 0
    for byte in inner + bytes(249):
        checksum ^= byte
        for _ in range(8):
            checksum = checksum << 1 ^ (0x1D5 if checksum & 0x80 else 0)
    # The sizes FF 00, the code, the mark and the size of a jumbo frame: FF ^ FF ^ FF ^ 03 ^ 10 ^ F9
    around = 0xFF ^ 0x03 ^ 0x10 ^ 0xF9 ^ checksum
    head = b"$M>\xff\xff" + inner + b"\xff\x00"
    frame = head + bytes(249) + bytes((checksum, around))
    engine = engine_of("msp")
    sender = "fc_v2_in_jumbo_answer"
    made = engine.frame(sender, "inav_setting", {"value": bytes(249).hex()}, {"flags": 0})
    assert made == frame
    (event,) = engine.events(sender, [frame])
    assert event.message == "inav_setting"
    wrong = frame[:10] + b"\xfe" + frame[11:]
    assert not any(event.message for event in engine.events(sender, [wrong]))


@pytest.mark.parametrize("endpoint", ["host", "fc"])
def test_no_frame_is_lost_that_it_finds(yamspy: Yamspy, drawn: list[Case], endpoint: str) -> None:
    compare_recovery("msp", endpoint, yamspy, [case for case in drawn if sends(case)])
