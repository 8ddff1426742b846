"""The Python target: what it prints, and that it prints the same everywhere."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
import venv
from pathlib import Path

import pytest
from compiled import SCHEMAS, protocol_of

from protogen.api import load, module_of
from protogen.model.names import unit_suffix
from protogen.runtime.errors import DecodeError, EncodeError
from protogen.targets.markdown.emit import emit as emit_markdown
from protogen.targets.python.emit import emit as emit_python
from protogen.targets.python.names import names_of
from protogen.targets.python.spelling import class_name
from protogen.targets.python.wrapping import docstring, remark, wrapped

ROOT = Path(__file__).parent.parent
GOLDEN = Path(__file__).parent / "golden"
SAMPLER = GOLDEN / "sampler.yaml"


@pytest.fixture(scope="module")
def sampler():
    return load(SAMPLER)


@pytest.fixture(scope="module")
def module(sampler):
    return module_of(sampler)


class TestGoldens:
    """Set PROTOGEN_UPDATE_GOLDENS=1 to write them anew; then review the difference."""

    @pytest.mark.parametrize(
        ("emit", "name"),
        [
            (emit_python, "sampler.py"),
            (emit_python, "_sampler_codec.py"),
            (emit_markdown, "sampler.md"),
        ],
    )
    def test_what_is_printed_is_what_was_reviewed(self, sampler, emit, name):
        printed = {str(file.path): file.content for file in emit([sampler])}[name]
        path = GOLDEN / f"{name}.txt"
        if os.environ.get("PROTOGEN_UPDATE_GOLDENS"):
            path.write_text(printed, "utf-8")
        assert printed == path.read_text("utf-8")

    def test_the_output_depends_on_nothing_but_the_schema(self, tmp_path):
        code = (
            "import sys, hashlib, protogen\n"
            "from protogen.targets import TARGETS\n"
            f"protocol = protogen.load({str(SAMPLER)!r})\n"
            "files = [f for t in TARGETS.values() for f in t.emit([protocol])]\n"
            "print(hashlib.sha256(b''.join(f.bytes for f in files)).hexdigest())\n"
        )
        printed = {
            subprocess.run(
                [sys.executable, "-c", code],
                cwd=folder,
                env={**os.environ, "PYTHONHASHSEED": seed, "LC_ALL": locale, "TZ": zone},
                capture_output=True,
                text=True,
                check=True,
            ).stdout
            for folder, seed, locale, zone in [
                (ROOT, "0", "C", "UTC"),
                (tmp_path, "77", "C.UTF-8", "Asia/Tokyo"),
            ]
        }
        assert len(printed) == 1


class TestSampler:
    def test_a_frame_by_hand(self, module):
        frame = module.encode(
            module.Choose(what=1, argument=module.ChooseArgumentAngle(angle=-16)), sequence=9
        )
        assert frame == bytes.fromhex(
            "AA 55"  # sync
            "04 00"  # length: group, what, two bytes of angle
            "03"  # group
            "09"  # sequence
            "01"  # address, the default
            "01"  # what = angle
            "F0 FF"  # -16, little-endian
            "7E D0"  # CRC-16/KERMIT of 04 00 03 09 01 01 F0 FF, big-endian
        )

    def test_names_that_imports_have_as_well(self, module):
        message = module.Move(
            str="ab", target=module.Point(x=1, y=-1), speed=0, flags=0, packed=0, on=True, extra=b""
        )
        assert (message.c, message.str, message.ratio) == (3, "ab", 0.5)
        assert module.Move.from_payload(message.to_payload()) == message

    def test_physical_values_and_bits_can_be_written(self, module):
        message = module.Move(
            str="", target=module.Point(x=0, y=0), speed=0, flags=0, packed=0, on=False, extra=b""
        )
        assert message.speed_deg_per_s == -5.0
        message.speed_deg_per_s = 10.04
        assert message.speed == 150
        message.speed = 4095
        assert message.speed_deg_per_s is None
        message.packed_mode = module.MovePackedMode.HARD
        assert message.packed == 0x10
        assert message.packed_mode is module.MovePackedMode.HARD

    def test_strict_about_what_is_sent(self, module):
        with pytest.raises(EncodeError) as error:
            module.encode(module.Path(n=2, points=[module.Point(x=1, y=40000)]), sequence=0)
        assert error.value.path == "points"
        with pytest.raises(EncodeError, match="sequence"):
            module.encode(module.Path(n=0, points=[]))

    def test_a_closed_enum_is_closed(self, module):
        good = module.encode(
            module.Report(state=module.State.MOVING, at=module.Point(x=5, y=6), strange=7)
        )
        # COBS: 03 52 01, then the rest; the state is the third byte of the frame.
        assert good[1:3] == b"R\x01"
        bad = good[:2] + b"\x09" + good[3:]
        with pytest.raises(DecodeError) as error:
            module.decode(bad, sender="slave")
        assert (error.value.reason, error.value.path, error.value.offset) == ("value", "state", 2)

    def test_a_construct_user_embeds_the_format(self, module):
        construct = pytest.importorskip("construct")
        both = construct.Struct("a" / module.Point.FORMAT, "b" / module.Point.FORMAT)
        parsed = both.parse(bytes.fromhex("0100 FFFF 0200 0300"))
        assert (parsed.a.x, parsed.a.y, parsed.b.x, parsed.b.y) == (1, -1, 2, 3)
        assert both.sizeof() == 8


def standalone(folder: Path, *schemas: Path) -> None:
    subprocess.run(
        [sys.executable, "-m", "protogen", "generate", *map(str, schemas), "--quiet",
         "-o", str(folder), "--standalone", "--target", "python"],
        check=True,
        cwd=ROOT,
    )  # fmt: skip


class TestStandalone:
    def test_it_needs_only_construct(self, tmp_path):
        """In an environment where protogen is not installed."""
        standalone(tmp_path / "out", SAMPLER)
        import construct

        packages = tmp_path / "packages"
        packages.mkdir()
        (packages / "construct").symlink_to(Path(construct.__file__).parent)
        code = (
            "import sampler, sys\n"
            "f = sampler.encode(sampler.Path(n=1, points=[sampler.Point(x=1, y=2)]), sequence=0)\n"
            "event, = sampler.Decoder(sender='master').feed(f)\n"
            "assert event.message.points[0].y == 2, event\n"
            "assert not [name for name in sys.modules if name.startswith('protogen')]\n"
        )
        env = {"PYTHONPATH": f"{tmp_path / 'out' / 'python'}{os.pathsep}{packages}"}
        bare = tmp_path / "bare"
        venv.create(bare, with_pip=False, symlinks=True)
        subprocess.run([bare / "bin" / "python", "-c", code], check=True, env=env, cwd=tmp_path)

    def test_strangers_find_nothing_to_complain_about(self, tmp_path):
        """By the rules that ruff and mypy have without any configuration of ours."""
        standalone(tmp_path, SAMPLER, ROOT / "schemas" / "rn1.yaml")
        complaints = [
            said(tmp_path, "ruff", "check", "--isolated", "--no-cache", "--quiet", "."),
            said(tmp_path, "mypy", "--strict", "--config-file=", "--no-error-summary",
                 "--cache-dir", str(ROOT / ".mypy_cache" / "standalone"),
                 "-p", "sampler", "-p", "rn1"),
        ]  # fmt: skip
        assert complaints == ["", ""]


def said(folder: Path, module: str, *arguments: str) -> str:
    """Output of a tool about the packages in a folder."""
    run = subprocess.run(
        [sys.executable, "-m", module, *arguments],
        cwd=folder / "python",
        capture_output=True,
        text=True,
        check=False,
    )
    return run.stdout + run.stderr


class TestWording:
    @pytest.mark.parametrize(
        ("unit", "suffix"),
        [("mm/s", "mm_per_s"), ("deg", "deg"), ("%", "percent"), (None, "scaled"), ("V", "v")],
    )
    def test_units_become_names(self, unit, suffix):
        assert unit_suffix(unit) == suffix

    def test_classes(self):
        assert class_name("move_2_manual") == "Move2Manual"

    def test_long_calls_have_a_line_for_each_argument(self):
        call = f'f("a, (b", {{{", ".join(str(n) for n in range(40))}}})'
        lines = wrapped(call, 4, 4).splitlines()
        assert lines[:3] == ["f(", '        "a, (b",', "        {"]
        assert lines[-1] == "    )"
        assert max(map(len, lines)) <= 100
        assert (
            "".join(line.strip() for line in lines)
            .replace(",)", ")")
            .replace(",}", "}")
            .replace(",", ", ")
            .replace(",  ", ", ")
            == call
        )

    def test_what_can_not_be_broken_stays(self):
        text = '"' + "x" * 200 + '"'
        assert wrapped(text, 0, 0) == text
        assert wrapped("a" * 120, 0, 0) == "a" * 120

    def test_a_docstring_starts_with_one_line(self):
        long = "This is a sentence. " * 8
        lines = docstring([long.strip()], 4).splitlines()
        assert lines[0] == '"""This is a sentence.'
        assert lines[1] == ""
        assert docstring(["word " * 60], 4).splitlines()[0].endswith("...")
        assert remark(["Short."], 4) == '"""Short."""'


class TestNames:
    @pytest.mark.parametrize("path", SCHEMAS, ids=lambda path: path.stem)
    def test_every_name_of_a_module_is_in_the_table(self, path: Path) -> None:
        protocol = protocol_of(path)
        generated = module_of(protocol)
        names = names_of(protocol)
        assert {*_public(generated)} - {"annotations"} <= names.module.things.keys()
        for record in (*protocol.structs, *protocol.messages):
            attributes = _public(getattr(generated, names.types[record.name], None))
            table = names.records[record.name].table
            assert {*filter(str.islower, attributes)} <= table.things.keys()
        parameters = inspect.signature(generated.encode).parameters
        assert parameters.keys() <= names.arguments.things.keys()

    def test_messages_may_be_called_like_what_a_module_does_not_use(self, tmp_path: Path) -> None:
        names = ["not_implemented", "warning", "encode", "protocol", "messages", "write", "on_it"]
        text = "protocol: demo\nendpoints: {host: Host}\ntransparency: slip\n"
        text += (
            "frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}\nmessages:\n"
        )
        for number, name in enumerate(names):
            text += f"  {name}: {{id: {number}, from: host, fields: {{x: uint8}}}}\n"
        path = tmp_path / "demo.yaml"
        path.write_text(text, encoding="utf-8")
        generated = module_of(load(path))
        for number, name in enumerate(names):
            message = generated.MESSAGES[name](x=7)
            assert message != 7  # Here, Python's own NotImplemented is asked for.
            assert generated.encode(message) == bytes([number, 7, 0xC0])
            assert generated.decode(bytes([number, 7, 0xC0]), "host") == message


def _public(owner: object) -> list[str]:
    return [name for name in dir(owner) if not name.startswith("_")]
