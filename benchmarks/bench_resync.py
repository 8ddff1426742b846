"""Frames that decoders find in noisy streams: protogen's in every framing, libsbp's, pymavlink's.

    python benchmarks/bench_resync.py [--seeds N]

Needs `pip install sbp pymavlink`. Writes benchmarks/resync.md.
"""

from __future__ import annotations

import argparse
import io
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from random import Random
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

import compiled  # noqa: E402
import corpus  # noqa: E402
import recovery_oracle  # noqa: E402

from protogen.runtime.framing.frame import FrameSpec  # noqa: E402
from protogen.version import VERSION  # noqa: E402

OUT = Path(__file__).with_name("resync.md")
PIECES = 100
SIZES = (9, 14, 26, 28, 42)
"""Payload sizes of the messages that are compared: those of the MAVLink messages below."""
FRAMES_OF_A_SEED = 400


@dataclass(frozen=True)
class Accepted:
    """A frame that a decoder took for valid."""

    offset: int
    raw: bytes
    kind: str = "message"


Decode = Callable[[bytes], Sequence[Any]]
"""A whole stream -> events or what is like them; those that are not `invalid` are accepted."""


@dataclass(frozen=True)
class Subject:
    """A decoder, and the frames that it is tried on."""

    name: str
    decode: Decode
    material: Callable[[Random], corpus.Material]
    spec: FrameSpec
    """Way its frames are found; of other libraries that of the framing most like theirs."""


@dataclass
class Figures:
    """Fates of the frames of all streams."""

    undamaged: int = 0
    due: int = 0
    found: int = 0
    false: int = 0
    sizes: int = 0

    @property
    def share(self) -> str:
        """Found frames among those that a receiver can find, never rounded up to all."""
        percent = int(self.found / self.due * 10_000) / 100
        return f"{percent:.2f} %" if self.found < self.due else "100 %"


def measure(subject: Subject, seeds: Iterable[int]) -> Figures:
    figures = Figures()
    for seed in seeds:
        dice = Random(f"{subject.name} {seed}")
        material = subject.material(dice)
        stream = corpus.stream_of(material, dice, PIECES)
        events = subject.decode(stream.data)
        fates = recovery_oracle.fates(subject.spec, stream, events)
        figures.undamaged += len(fates)
        figures.due += sum(fate is not recovery_oracle.Fate.NOT_DUE for fate in fates)
        figures.found += fates.count(recovery_oracle.Fate.FOUND)
        figures.false += len(recovery_oracle.false_frames(subject.spec, material.frames, events))
        figures.sizes += sum(len(frame) for _, frame in stream.frames)
    return figures


# --- protogen -------------------------------------------------------------------------------------


def own_subject(path: Path, sender: str, material: Callable[[Random], corpus.Material]) -> Subject:
    module = compiled.module_at(path)

    def decode(data: bytes) -> list[Any]:
        decoder = module.Decoder(sender)
        return [*decoder.feed(data), *decoder.flush()]

    name = path.stem if path in compiled.FRAMINGS else f"{path.stem}, {sender}"
    spec = module.PROTOCOL.sender(sender).frame
    return Subject(name.replace("_", " "), decode, material, spec)


def framings() -> Iterator[Subject]:
    """Framings with the same messages: an address and so many bytes of memory."""
    for path in compiled.FRAMINGS:
        yield own_subject(path, "station", partial(dumps, path))


def dumps(path: Path, dice: Random) -> corpus.Material:
    module = compiled.module_at(path)
    frames = []
    for _ in range(FRAMES_OF_A_SEED):
        address, *memory = dice.choices(range(256), k=dice.choice(SIZES) - 1)
        dump = module.Dump(address=address, memory=bytes(memory))
        number = {"number": 1 + address % 99} if path.stem == "hex_lines" else {}
        frames.append(module.encode(dump, "station", **number))
    return corpus.Material(tuple(frames), corpus.marks_of(path, "station"))


def documents() -> Iterator[Subject]:
    """The five documents and their dialects, with their own messages."""
    for path in [*compiled.DOCUMENTS, *compiled.DIALECTS]:
        for sender in compiled.protocol_of(path).senders:
            material = corpus.material_of(path, sender.name)
            yield own_subject(path, sender.name, partial(unchanged, material))


def unchanged(material: corpus.Material, dice: Random) -> corpus.Material:
    """The same frames for every seed."""
    return material


# --- other libraries ------------------------------------------------------------------------------


def alike() -> FrameSpec:
    """Sync, length and checksum, without stuffing: the shape of their frames."""
    path = next(path for path in compiled.FRAMINGS if path.stem == "sync_length_crc")
    spec: FrameSpec = compiled.module_at(path).PROTOCOL.sender("station").frame
    return spec


SILENCE = b"\xaa" * 300
"""Longer than their greatest frame: without a `flush` they wait for the rest of a false start."""


def placed(frames: Iterable[bytes], data: bytes) -> list[Accepted]:
    """The frames with their places in the stream. No frame is sent twice."""
    found = []
    place = 0
    for frame in frames:
        place = data.index(frame, place)
        found.append(Accepted(place, frame))
    return found


# --- libsbp ---------------------------------------------------------------------------------------


def libsbp() -> Subject:
    from sbp.client.framer import Framer
    from sbp.msg import SBP

    warnings.filterwarnings("ignore", category=DeprecationWarning)

    def decode(data: bytes) -> list[Accepted]:
        source = io.BytesIO(data + SILENCE)

        def read(size: int) -> bytes:
            found = source.read(size)
            if not found:
                raise OSError("the end")
            return found

        framer = Framer(read, None, dispatcher=lambda message: message)
        return placed((message.to_binary() for message, _ in framer), data + SILENCE)

    def material(dice: Random) -> corpus.Material:
        frames = []
        for _ in range(FRAMES_OF_A_SEED):
            payload = dice.randbytes(dice.choice(SIZES))
            frames.append(SBP(dice.randrange(1 << 16), 0x42, payload=payload).to_binary())
        return corpus.Material(tuple(frames), b"\x55\x00\x01\x42\xff")

    return Subject("libsbp", decode, material, alike())


# --- pymavlink ------------------------------------------------------------------------------------

_BITS = {"uint8_t": 8, "uint16_t": 16, "uint32_t": 32, "uint64_t": 64}
_SIGNED_BITS = {"int8_t": 8, "int16_t": 16, "int32_t": 32, "int64_t": 64}


def pymavlink() -> Subject:
    from pymavlink.dialects.v20 import common

    kinds = (
        common.MAVLink_heartbeat_message,
        common.MAVLink_ping_message,
        common.MAVLink_raw_imu_message,
        common.MAVLink_global_position_int_message,
        common.MAVLink_rc_channels_message,
    )

    def decode(data: bytes) -> list[Accepted]:
        parser = common.MAVLink(None)
        parser.robust_parsing = True
        found = [item for item in parser.parse_buffer(data + SILENCE) or [] if is_checked(item)]
        return placed((bytes(item.get_msgbuf()) for item in found), data + SILENCE)

    def is_checked(item: Any) -> bool:
        """It hands on messages of unknown types unchecked; nobody takes them for valid."""
        return item.get_type() != "BAD_DATA" and not item.get_type().startswith("UNKNOWN_")

    def material(dice: Random) -> corpus.Material:
        sender = common.MAVLink(None, srcSystem=1, srcComponent=1)
        frames = []
        for _ in range(FRAMES_OF_A_SEED):
            kind = dice.choice(kinds)
            types = [kind.fieldtypes[kind.fieldnames.index(name)] for name in kind.fieldnames]
            message = kind(*(_any_number(type_, dice) for type_ in types))
            frames.append(bytes(message.pack(sender)))
        return corpus.Material(tuple(frames), b"\xfd\xfe\x00\x01\xff")

    return Subject("pymavlink", decode, material, alike())


def _any_number(type_: str, dice: Random) -> int:
    if type_ in _BITS:
        return dice.getrandbits(_BITS[type_])
    bits = _SIGNED_BITS[type_]
    return dice.getrandbits(bits) - (1 << (bits - 1))


# --- the page -------------------------------------------------------------------------------------

PAGE = """\
# Frames found in noisy streams

<!-- Written by benchmarks/bench_resync.py, do not edit. -->

Made by `python benchmarks/bench_resync.py --seeds {seeds}`.

protogen {protogen}, libsbp {libsbp} and pymavlink {pymavlink} on Python {python}. Each decoder
reads {seeds} streams, seeds 0 to {last}, of {pieces} pieces each: 55 % undamaged frames; 25 %
damaged ones (bits flipped; bytes overwritten, dropped or inserted; the tail or the head lost);
20 % noise (random bytes; delimiters and escapes without sense; one byte again and again; the
beginning of a frame and then something else). `tests/corpus.py` makes a stream from its seed and
from frames of the decoder's own encoder.

* Undamaged: frames that arrived whole.
* Due: those of them that a receiver can find. Where nothing marks the start of a frame (cobs, hex
  lines, dagny, all "end only") it begins behind an end, and noise or damage without an end hides
  the frame that follows.
* Found: due frames that the decoder accepted.
* False: accepted frames that nobody sent.

## Equal messages

Payloads of {sizes} random bytes.

{equal}

libsbp and pymavlink wait for as many bytes as a false start announces. If the checksum is wrong
they drop them all, and the whole frames among them. protogen's decoder gives up the false start
alone and looks again inside. `sync length crc` has the shape of their frames. Messages of unknown
types, which pymavlink hands on unchecked, are not counted.

## The documents and their dialects

Their own messages, with boundary values. Damage that leaves a frame its shape goes unnoticed where
no checksum protects it (uherobot, rn1, dagny library) or not all of it (rflex), and now and then
where eight bits do (dagny, matty). In rn1, each byte from 80 to FE starts a frame, and in noise
mostly one of an unknown message.

{documents}
"""


def table(rows: Sequence[tuple[str, Figures]]) -> str:
    lines = [
        "| Decoder | Bytes a frame | Undamaged | Due | Found | Share of due | False |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for name, item in rows:
        mean = round(item.sizes / item.undamaged)
        lines.append(
            f"| {name} | {mean} | {item.undamaged:,} | {item.due:,} | {item.found:,} "
            f"| {item.share} | {item.false:,} |"
        )
    return "\n".join(lines)


def figures_of(subjects: Iterable[Subject], seeds: range) -> list[tuple[str, Figures]]:
    rows = []
    for subject in subjects:
        rows.append((subject.name, measure(subject, seeds)))
        print(f"{rows[-1][0]}: {rows[-1][1].share}", file=sys.stderr)
    return rows


def page(seeds: range) -> str:
    values: dict[str, Any] = {
        "seeds": len(seeds),
        "last": seeds[-1],
        "pieces": PIECES,
        "protogen": VERSION,
        "libsbp": version("sbp"),
        "pymavlink": version("pymavlink"),
        "python": f"{sys.version_info.major}.{sys.version_info.minor}",
        "sizes": ", ".join(map(str, SIZES[:-1])) + f" and {SIZES[-1]}",
        "equal": table(figures_of([*framings(), libsbp(), pymavlink()], seeds)),
        "documents": table(figures_of(documents(), seeds)),
    }
    return PAGE.format(**values)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--seeds", type=int, default=100, help="how many streams for each")
    if not (find_spec("sbp") and find_spec("pymavlink")):
        sys.exit("sbp and pymavlink are not there: pip install sbp pymavlink")
    OUT.write_text(page(range(arguments.parse_args().seeds)), encoding="utf-8")


if __name__ == "__main__":
    main()
