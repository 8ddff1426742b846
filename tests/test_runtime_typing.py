"""Findings of a type checker about code that uses a generated module."""

import os
import subprocess
import sys
from pathlib import Path

USE = """
from typing import assert_type

import handwritten_matty as matty
import handwritten_rn1 as rn1

assert_type(rn1.decode(b"", sender="brain"), rn1.Gyro | rn1.Lidar)
assert_type(matty.encode(matty.Ack(), counter=5), bytes)

for event in matty.Decoder(sender="pc").feed(b""):
    if event.kind == "message":
        assert_type(event.message, matty.Stop | matty.Mode | matty.Go)
        matty.encode(matty.Ack(), counter=event.parts.counter)
    elif event.kind == "unknown":
        assert_type(event.parts.command, int)
    else:
        print(event.reason, event.raw)


def any_sender(name: matty.Sender) -> None:
    for event in matty.Decoder(name).flush():
        match event:
            case matty.MessageEvent(message=matty.Status(status=status)):
                print(status)


go = matty.Go(speed=1, steer=2)
go.steer_deg = 12.5
assert_type(go.steer_deg, float)
matty.Encoder("esp").encode(matty.Ack(), counter=3)
matty.Go.FORMAT.parse(b"")
"""

GENERATED = """
from typing import assert_type

from generated.python import matty, rn1
from protogen.link import BlockingLink, Link
from protogen.runtime.api import FrameFormat, as_dict, replace
from protogen.runtime.constructs import Struct
from protogen.runtime.payload.records import FieldRules

gyro = rn1.Gyro(status=1, int_x=2, int_y=3, int_z=4)
assert_type(replace(gyro, status=2), rn1.Gyro)
print(as_dict(gyro))
match gyro:
    case rn1.Gyro(int_x=int_x):
        assert_type(int_x, int)
assert_type(rn1.Gyro.FORMAT, Struct)
rules: FieldRules = rn1.Gyro.RULES
assert_type(rn1.HOST_FORMAT, FrameFormat)
start = rn1.Parts(128).start


async def talk() -> None:
    async with matty.connect("/dev/ttyUSB0", "pc", baud=9600) as link:
        assert_type(link, Link[matty.PcMessage, matty.EspMessage])
        assert_type(await link.request(matty.Stop(), timeout=0.5), matty.EspMessage)
        assert_type(link.last(matty.Status), matty.Status | None)
        async for status in link.messages(matty.Status):
            assert_type(status.voltage, int)
        async for when, event in link.events():
            assert_type(when, int)


with matty.connect("COM3", "esp") as blocking:
    assert_type(blocking, BlockingLink[matty.EspMessage, matty.PcMessage])
    for command in blocking.messages(matty.Stop, limit=5, overflow="wait"):
        blocking.send(matty.Ack(), counter=3)
"""

GENERATED_MISUSE = """
from generated.python import rn1

rn1.Gyro(1, 2, 3, 4)
rn1.Maintenance(operation=81)
rn1.Facing(status="1", heading=2, speed=3)
rn1.Parts(start=128).start = 129
rn1.NONSENSE_FORMAT
rn1.connect("/dev/ttyUSB0", "robot")
with rn1.connect("/dev/ttyUSB0", "host") as link:
    link.send(rn1.Gyro(status=1, int_x=2, int_y=3, int_z=4))
rn1.connect("/dev/ttyUSB0", "host", bauds=9600)
"""

MISUSE = """
import handwritten_matty as matty

matty.Go(speed="fast", steer=0)
matty.Go(speed=1)
matty.encode(matty.Ack(), number=5)
matty.decode(b"", sender="robot")
matty.Decoder(sender="robot")
"""


def errors(code: str, folder: Path, root: Path) -> list[str]:
    """The lines of `code` that mypy complains about in its strict mode."""
    (folder / "use.py").write_text(code)
    run = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--hide-error-context",
         "--cache-dir", str(root / ".mypy_cache" / "use"), str(folder / "use.py")],
        env={**os.environ, "MYPYPATH": f"{root}{os.pathsep}{root / 'tests'}"},
        cwd=root, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert not run.stderr
    return [line for line in run.stdout.splitlines() if "error:" in line]


def test_right_use_is_accepted(tmp_path: Path, project_root: Path) -> None:
    assert errors(USE, tmp_path, project_root) == []


def test_wrong_use_is_reported(tmp_path: Path, project_root: Path) -> None:
    found = errors(MISUSE, tmp_path, project_root)
    assert len({line.split(":")[1] for line in found}) == 5


def test_generated_classes_are_typed(tmp_path: Path, project_root: Path) -> None:
    assert errors(GENERATED, tmp_path, project_root) == []
    found = errors(GENERATED_MISUSE, tmp_path, project_root)
    lines = sorted({int(line.split(":")[1]) for line in found})
    assert lines == [4, 5, 6, 7, 8, 9, 11, 12]
