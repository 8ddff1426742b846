"""DFPlayer Mini players, beside dfplayer."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from struct import pack
from types import SimpleNamespace
from typing import Any

import pytest
from compiled import protocol_of
from library_support import (
    FRAMES,
    cases_of,
    compare_frames,
    compare_recovery,
    engine_of,
    peer_module,
)

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

PEER = "dfplayer"
SIZE = 10
COMMANDS: dict[str, Callable[[Any, Values], Any]] = {
    "next": lambda player, v: player.next(),
    "previous": lambda player, v: player.previous(),
    "play_track": lambda player, v: player.play(track=v["track"]),
    "louder": lambda player, v: player.volume_up(),
    "quieter": lambda player, v: player.volume_down(),
    "set_volume": lambda player, v: player.set_volume(-(-v["volume"] * 100 // 30)),
    "set_sound": lambda player, v: player.set_eq(v["sound"]),
    "loop_track": lambda player, v: player.loop(),
    "select_device": lambda player, v: player.set_media(v["device"]),
    "stand_by": lambda player, v: player.set_standby(True),
    "wake_up": lambda player, v: player.set_standby(False),
    "reset": lambda player, v: player.reset(),
    "play": lambda player, v: player.play(),
    "pause": lambda player, v: player.pause(),
    "play_in_folder": lambda player, v: player.play(v["folder"], v["file"]),
    "loop_all": lambda player, v: player.loop_all(v["on"]),
    "stop": lambda player, v: player.stop(),
    "play_random": lambda player, v: player.random(),
    "read_status": lambda player, v: player.get_status(),
    "read_volume": lambda player, v: player.get_volume(),
    "read_sound": lambda player, v: player.get_eq(),
    "count_files_in_folder": lambda player, v: player.num_files(folder=v["folder"]),
}
"""Commands that it has methods for."""
CODES = {
    "set_gain": 0x10,
    "play_mp3": 0x12,
    "advertise": 0x13,
    "play_in_large_folder": 0x14,
    "stop_advertisement": 0x15,
    "loop_folder": 0x17,
    "loop_current": 0x19,
    "set_output": 0x1A,
    "read_mode": 0x45,
    "read_version": 0x46,
    "count_files": None,
    "read_track": None,
    "count_folders": 0x4F,
}
"""Other commands; those without a number have several."""
REPORTS = {
    "inserted": 0x3A,
    "removed": 0x3B,
    "finished": None,
    "ready": 0x3F,
    "error": 0x40,
    "acknowledged": 0x41,
    "status": 0x42,
    "volume": 0x43,
    "sound": 0x44,
    "mode": 0x45,
    "version": 0x46,
    "files": None,
    "track": None,
    "files_in_folder": 0x4E,
    "folders": 0x4F,
}


class Port:
    """A serial port, with what is there to read and what was written."""

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.written = b""

    @property
    def in_waiting(self) -> int:
        return len(self.data)

    def read(self, size: int) -> bytes:
        piece, self.data = self.data[:size], self.data[size:]
        return piece

    def write(self, data: bytes) -> None:
        self.written += data


class DfPlayer:
    """Its player, on a port that is none."""

    def __init__(self) -> None:
        self._module: Any = peer_module("DFPlayer.DFPlayer")

    def _player(self, data: bytes = b"") -> tuple[Any, Port]:
        player = self._module.DFPlayer.__new__(self._module.DFPlayer)  # Else it opens a port.
        player._uart, player._latency = port, _ = Port(data), 0
        return player, port

    def frame(self, case: Case) -> bytes:
        player, port = self._player()
        if case.message in COMMANDS:
            COMMANDS[case.message](player, case.values)
        else:
            code = {**CODES, **REPORTS}[case.message] or case.parts["command"]
            high, low = content(case.values).to_bytes(2, "big")
            player._write_data(code, low, high)
        head, end = bytearray(port.written[:-1]), port.written[-1:]
        head[4] = case.parts["feedback"]  # it asks for none
        checksum = b"" if case.sender == "host_brief" else pack(">H", -sum(head[1:]) & 0xFFFF)
        return bytes(head) + checksum + end

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message not in REPORTS:
            return case.values  # it reads no command
        player, _ = self._player(frame)
        command, parameter = player._read_response()
        assert command == (REPORTS[case.message] or case.parts["command"])
        assert parameter == content(case.values)
        return case.values

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it reads at each start."""
        at = data.find(0x7E)
        while at >= 0:
            frame = data[at : at + SIZE]
            if self._player(frame)[0]._read_data():
                yield frame
                at += SIZE - 1
            at = data.find(0x7E, at + 1)


def content(values: Values) -> int:
    """The parameter of a command or a report, as one number."""
    if "place" in values:
        place = values["place"]
        return int(place["folder"] << 12 | place["file"])
    known = list(values.values())
    return int(known[0] << 8 | known[1] if len(known) == 2 else known[0])


def as_sent(case: Case) -> Case:
    """The case, as its methods have it."""
    values = dict(case.values)
    match case.message:
        case "loop_track":
            values["track"] = 0
        case "set_sound":
            values["sound"] %= 6
        case "count_files_in_folder":
            values["folder"] %= 256
    return replace(case, values=values)


@pytest.fixture(scope="module")
def dfplayer() -> Iterator[DfPlayer]:
    peer = DfPlayer()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(peer._module, "time", SimpleNamespace(sleep=lambda seconds: None))
        yield peer


def test_the_commands_are_those_of_the_schema() -> None:
    messages = {message.name for message in protocol_of(FOLDER / "dfplayer.yaml").messages}
    assert messages == {*COMMANDS, *CODES, *REPORTS}


def commands(sender: str) -> list[Case]:
    drawn = cases_of("dfplayer", [*COMMANDS, *CODES])
    return [as_sent(case) for case in drawn if case.sender == sender]


def test_both_make_the_same_commands(dfplayer: DfPlayer) -> None:
    drawn = commands("host_brief")
    assert len(drawn) >= FRAMES
    engine = engine_of("dfplayer")
    for case in drawn:
        frame = engine.frame(case.sender, case.message, case.values, case.parts)
        assert frame == dfplayer.frame(case)
        (event,) = engine.events(case.sender, [frame])
        assert (event.message, event.values) == (case.message, case.values)


def test_with_a_checksum_they_are_the_same_around_it(dfplayer: DfPlayer) -> None:
    compare_frames("dfplayer", dfplayer, commands("host_checked"))


def test_it_reads_the_reports_that_we_make(dfplayer: DfPlayer) -> None:
    compare_frames("dfplayer", dfplayer, cases_of("dfplayer", REPORTS))


def test_no_frame_is_lost_that_it_finds(dfplayer: DfPlayer) -> None:
    compare_recovery("dfplayer", "player", dfplayer, cases_of("dfplayer", REPORTS))
