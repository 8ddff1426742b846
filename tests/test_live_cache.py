"""Commands that read bytes use what an earlier one compiled, as long as it holds."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from cli_support import run

from protogen import program
from protogen.cli.wire import codec
from protogen.live import cache

STATUS = """\
protocol: link
title: Link
endpoints: {board: {title: Board}, pc: {title: PC}}
byte_order: little
frame:
  type: {type: uint8, id: true}
  payload: {}
  end: {literal: 0xC0}
transparency: slip
messages:
  status:
    id: 1
    from: board
    fields: {volts: {type: uint8}}
"""


def decode(folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Decode a frame of the schema in `folder`, in a process of its own."""
    code = (
        "import sys\nfrom protogen.cli import app\n"
        "try:\n    app(sys.argv[1:])\nfinally:\n"
        "    print('protogen.passes' in sys.modules, file=sys.stderr)"
    )
    words = ["decode", "link.yaml", "--sender", "board", "--hex", "01 7B C0", *options]
    return subprocess.run(
        [sys.executable, "-c", code, *words],
        capture_output=True,
        text=True,
        cwd=folder,
        check=False,
    )


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a schema; the cache is empty."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "link.yaml").write_text(STATUS, encoding="utf-8")
    return tmp_path


def fill(folder: Path) -> str:
    """Compile the schema in `folder` for the cache; returns what the command prints of a frame."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        result = run("decode", "link.yaml", "--sender", "board", "--hex", "01 7B C0")
    assert result.exit_code == 0, result.output
    return result.stdout


def kept(folder: Path) -> list[Path]:
    """The files of the cache."""
    return sorted((folder / "cache" / "protogen" / "schemas").iterdir())


def test_the_second_run_does_not_compile(folder: Path) -> None:
    first, second = decode(folder), decode(folder)
    assert "volts=123" in first.stdout
    assert first.stdout == second.stdout
    assert first.stderr == "True\n"
    assert second.stderr == "False\n"


def test_a_schema_that_changed_is_compiled(folder: Path) -> None:
    fill(folder)
    file = folder / "link.yaml"
    times = (file.stat().st_atime_ns, file.stat().st_mtime_ns)
    file.write_text(STATUS.replace("volts", "celsi"), encoding="utf-8")
    os.utime(file, ns=times)  # As large and as old as before.
    result = decode(folder)
    assert "celsi=123" in result.stdout
    assert result.stderr == "True\n"


def test_an_error_is_told_though_the_schema_was_good(folder: Path) -> None:
    fill(folder)
    (folder / "link.yaml").write_text(STATUS.replace("{type: uint8}}", "{type: nonsense}}"))
    result = decode(folder)
    assert result.returncode == 1
    assert "error[" in result.stderr


def test_the_base_of_a_dialect_that_changed(folder: Path) -> None:
    (folder / "link.yaml").rename(folder / "base.yaml")
    (folder / "link.yaml").write_text("protocol: dialect\nextends: base.yaml\n", encoding="utf-8")
    fill(folder)
    assert decode(folder).stderr == "False\n"
    (folder / "base.yaml").write_text(STATUS.replace("volts", "celsi"), encoding="utf-8")
    result = decode(folder)
    assert "celsi=123" in result.stdout
    assert result.stderr == "True\n"


def test_another_program_compiles(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    schema = Path("link.yaml")
    codec.open_codec(schema)
    assert cache.read(schema) is not None
    monkeypatch.setattr(program, "VERSION", "9.9.9")
    assert cache.read(schema) is None


@pytest.mark.parametrize("damage", [b"", b"protogen", None])
def test_damaged_contents_are_not_used(folder: Path, damage: bytes | None) -> None:
    first = fill(folder)
    (file,) = kept(folder)
    data = file.read_bytes()
    file.write_bytes(data[:-1] + bytes([data[-1] ^ 1]) if damage is None else damage)
    result = decode(folder)
    assert result.stdout == first
    assert result.stderr == "True\n"
    assert decode(folder).stderr == "False\n"


@pytest.mark.skipif(sys.platform == "win32", reason="the folders of a user are the user's there")
def test_what_others_could_have_written_is_not_used(folder: Path) -> None:
    fill(folder)
    (file,) = kept(folder)
    file.chmod(0o620)
    assert decode(folder).stderr == "True\n"
    file.parent.chmod(0o770)
    assert decode(folder).stderr == "True\n"


def test_without_a_folder_it_compiles(folder: Path) -> None:
    (folder / "cache").write_text("a file is here")
    assert "volts=123" in decode(folder).stdout
    assert "volts=123" in decode(folder).stdout


def test_the_same_name_in_another_folder_is_another_schema(folder: Path) -> None:
    fill(folder)
    other = folder / "other"
    other.mkdir()
    (other / "link.yaml").write_text(STATUS.replace("volts", "amps"), encoding="utf-8")
    assert "amps=123" in decode(other).stdout
    assert "volts=123" in decode(folder).stdout


def test_only_so_many_are_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setattr(cache, "_MOST", 2)
    schemas = [Path(f"link{number}.yaml") for number in range(3)]
    for age, schema in enumerate(schemas):
        schema.write_text(STATUS, encoding="utf-8")
        codec.open_codec(schema)
        for file in kept(folder):
            os.utime(file, ns=(0, file.stat().st_mtime_ns - 10**9 * (age + 1)))
    assert len(kept(folder)) == 2
    assert cache.read(schemas[2]) is not None
    assert cache.read(schemas[0]) is None
