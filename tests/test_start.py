"""Modules that a program waits for when it imports a generated one, and those it does not."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SLOW = (
    "construct", "dataclasses", "decimal", "fractions", "inspect", "numpy", "pdb", "pickle",
    "traceback", "unittest",
)  # fmt: skip
"""Modules that take longer to import than a generated module may."""

REFERENCE = (
    "constructs", "framing.frame_format", "payload.number_rules", "payload.records",
    "payload.rules",
)  # fmt: skip
"""Modules of the runtime that only the reference needs, and that import what takes long."""

USES = {
    "rn1": ("brain", "Gyro(status=1, int_x=-5, int_y=0, int_z=812)"),
    "rflex": ("linux", "RequestSystemStatus(), number=7"),
    "matty": ("pc", "Go(speed=500, steer=-250), counter=1"),
    "dagny": ("host", "Motor(s=5)"),
    "uherobot": ("daemon", "MotorTest(motor_1=-1, motor_2=300)"),
}
"""For each protocol, an endpoint and a message that it sends, with the values of its frame."""


def imported(code: str, root: Path) -> set[str]:
    """The modules that a new process has imported behind `code`, without installed packages."""
    run = subprocess.run(
        [sys.executable, "-S", "-c", f"{code}\nimport sys\nprint(*sys.modules, sep='\\n')"],
        env={**os.environ, "PYTHONPATH": str(root)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    return set(run.stdout.split())


def unwanted(modules: set[str]) -> set[str]:
    return modules & {*SLOW, *(f"protogen.runtime.{name}" for name in REFERENCE)}


@pytest.mark.parametrize("protocol", USES)
def test_an_import_loads_nothing_slow(protocol: str, project_root: Path) -> None:
    modules = imported(f"import generated.python.{protocol}", project_root)
    assert f"generated.python.{protocol}" in modules
    assert unwanted(modules) == set()


@pytest.mark.parametrize("protocol", USES)
def test_clean_data_need_no_reference(protocol: str, project_root: Path) -> None:
    """Not even construct has to be installed for them."""
    sender, given = USES[protocol]
    code = f"""
from generated.python.{protocol} import *
frame = encode({given})
message = decode(frame, "{sender}")
decoder = Decoder("{sender}")
events = [*decoder.feed(frame[:2]), *decoder.feed(frame[2:] + frame), *decoder.flush()]
assert [event.message for event in events] == [message, message], events
assert [event.raw for event in events] == [frame, frame]
repr(events)
"""
    assert unwanted(imported(code, project_root)) == set()


def test_frames_are_imported_by_name(project_root: Path) -> None:
    """All public names at once would import construct with them."""
    code = "from generated.python.matty import *\nassert Go\nassert 'PC_FORMAT' not in globals()"
    assert unwanted(imported(code, project_root)) == set()
    code = f"import sys\nsys.path += {sys.path!r}\nfrom generated.python.matty import PC_FORMAT"
    assert "construct" in imported(code, project_root)


def test_the_reference_comes_with_what_is_not_in_order(project_root: Path) -> None:
    code = """
import sys
sys.path += {path!r}
from generated.python import rn1
events = rn1.Decoder("host").feed(bytes.fromhex("80 00 FF"))
assert [event.reason for event in events] == ["size"], events
"""
    modules = imported(code.format(path=sys.path), project_root)
    assert {"protogen.runtime.framing.machine", "protogen.runtime.framing.content"} <= modules


@pytest.mark.parametrize("name", ["api", "fast"])
def test_every_name_of_the_runtime_is_there(name: str) -> None:
    from importlib import import_module

    module = import_module(f"protogen.runtime.{name}")
    assert len(set(module.__all__)) == len(module.__all__)
    for public in module.__all__:
        assert getattr(module, public) is not None
    with pytest.raises(AttributeError, match=f"'protogen.runtime.{name}' has no attribute 'nope'"):
        _ = module.nope


def test_the_pieces_of_a_format_are_those_of_construct() -> None:
    from protogen.runtime import constructs, formats

    for name in constructs.__all__:
        assert getattr(formats, name) is getattr(constructs, name)
    assert formats.empty().build({}) == b""
    with pytest.raises(AttributeError, match="nope"):
        _ = formats.nope
    with pytest.raises(AttributeError, match="__path__"):
        _ = formats.__path__
