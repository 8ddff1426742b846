"""Protocols whose codecs are compared, and who is compared."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
FOLDER = ROOT / "benchmarks" / "c"
CACHE = ROOT / ".cache" / "bench"


@dataclass(frozen=True)
class Protocol:
    """Some messages of a schema that one program sends and receives."""

    name: str
    title: str
    schema: Path
    sender: str
    messages: tuple[str, ...]
    memory: int
    """Bytes for the greatest message."""
    timed: int
    """Frames in the stream of the timings."""
    marks: bytes
    """Bytes that mean something to a receiver, for the noise."""
    has_peers: bool = False
    """MAVLink C, nanopb and an expert with SSE2 have these messages, too."""

    @property
    def label(self) -> str:
        """The document, whatever the schema is called here."""
        return self.title.split()[0]


PROTOCOLS = (
    Protocol(
        "rn1",
        "rn1 gyro + lidar",
        ROOT / "schemas" / "rn1.yaml",
        "brain",
        ("gyro", "lidar"),
        736,
        64,
        b"\x80\x84\xff\xfe\x00\x01",
        has_peers=True,
    ),
    Protocol(
        "atrv",
        "rflex read_motor + sonar_data",
        FOLDER / "atrv.yaml",
        "flex",
        ("read_motor", "sonar_data"),
        96,
        256,
        b"\x1b\x02\x03\x7c\x00\x01\x04\x21",
        has_peers=True,
    ),
    Protocol(
        "matty",
        "matty status",
        ROOT / "schemas" / "matty.yaml",
        "esp",
        ("status",),
        32,
        256,
        b"\x55\x56\xa9\xaaI\x00\x01\xff",
        has_peers=True,
    ),
    Protocol(
        "uherobot",
        "uherobot status",
        ROOT / "schemas" / "uherobot.yaml",
        "board",
        ("status",),
        8,
        256,
        b"be08AF1\x00",
    ),
    Protocol(
        "dagny",
        "dagny motor + steering + reflex + power",
        ROOT / "schemas" / "dagny.yaml",
        "host",
        ("motor", "steering", "reflex", "power"),
        1,
        256,
        b"MSRP\n\x03\x45",
    ),
    Protocol(
        "rover",
        "rover state",
        FOLDER / "rover.yaml",
        "board",
        ("state",),
        8,
        256,
        b"\x00\x01\x02\x09\x81\x82\xff",
    ),
    Protocol(
        "probe",
        "probe attitude + power",
        FOLDER / "probe.yaml",
        "sensor",
        ("attitude", "power"),
        16,
        256,
        b"\xaa\x55\x0a\x05\x01\x02\x00\xff",
    ),
    Protocol(
        "tether",
        "tether report + alarm",
        FOLDER / "tether.yaml",
        "winch",
        ("report", "alarm"),
        16,
        256,
        b"\x7e\x7d\x5e\x5d\x10\x11\x00",
    ),
)

TOGETHER = Protocol(
    "all", "rn1, rflex and matty", FOLDER, "", (), PROTOCOLS[0].memory, 0, b"", has_peers=True
)
"""The messages of the documents that peers have, in one program."""

KINDS = {
    "messages": "protogen, `--events messages`",
    "all": "protogen, all events",
    "expert": "expert",
    "mavlink": "MAVLink C",
}
SMALL_KINDS = {
    "messages": KINDS["messages"],
    "included": "the same in one source",
    "all": KINDS["all"],
    "expert": KINDS["expert"],
    "inlined": "expert, inlined",
    "mavlink": KINDS["mavlink"],
    "nanopb": "nanopb, no framing",
}
"""Contenders on small machines."""
FED_KINDS = {**KINDS, "vector": "protogen, `NAME_SSE2`", "sse2": "expert with SSE2"}
"""Contenders that are fed whole buffers on this machine."""
PEERS = ("mavlink", "nanopb", "vector", "sse2")
HAS_SSE2 = platform.machine().lower() in ("x86_64", "amd64")


def takes_part(kind: str, protocol: Protocol) -> bool:
    """Whether this contender has the messages of a protocol."""
    return protocol.has_peers or kind not in PEERS
