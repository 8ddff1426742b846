"""`protogen import sbp` over the published definitions, and their published test vectors.

Both lie beside the repository, in `../shared/data/sbp`, or in such a folder further up, where this
is one of several working trees. A clone without them skips these tests.
"""

from __future__ import annotations

from base64 import b64decode
from binascii import crc_hqx
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from struct import pack
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import pytest
import yaml
from cli_support import ROOT, run

from protogen.compiler import compile_file
from protogen.layout.formatting import format_text
from protogen.live.codec import module_of

DATA = next(
    (data for above in ROOT.parents if (data := above / "shared" / "data" / "sbp").is_dir()), None
)
pytestmark = pytest.mark.skipif(DATA is None, reason="there is no ../shared/data/sbp")

OUT_OF_RANGE = {("TrackingChannelCorrelation", "I"): 37341 - 0x10000}
"""What a vector has where it gives a number that the type of its field, s16, can't hold."""
VECTORS = sorted(DATA.glob("vectors/**/*.yaml")) if DATA is not None else []


@cache
def imported(*options: str) -> tuple[dict[str, str], str]:
    """Texts of the schemas by name, and what the command prints."""
    with TemporaryDirectory() as folder:
        done = run("import", "sbp", str(DATA), "-o", folder, *options)
        assert done.exit_code == 0, done.output
        return {file.stem: file.read_text() for file in Path(folder).iterdir()}, done.output


@cache
def codec() -> ModuleType:
    """The codec of all messages, and of one more for each struct."""
    text = imported()[0]["sbp"]
    types = yaml.load(text, yaml.CSafeLoader)["types"]
    more = "\n".join(
        f"  struct_{name}: {{id: {0xE000 + number}, from: device, fields: {{it: {name}}}}}"
        for number, name in enumerate(types)
    )
    with TemporaryDirectory() as folder:
        Path(folder, "sbp.yaml").write_text(text)
        dialect = Path(folder, "more.yaml")
        dialect.write_text(f"protocol: more\nextends: sbp.yaml\nmessages:\n{more}\n")
        compilation = compile_file(dialect)
    assert compilation.protocol is not None, compilation.problems
    return module_of(compilation.protocol)


def vectors(file: Path) -> Iterator[dict[str, Any]]:
    """The vectors of a file: those of messages, and those of structs."""
    document = yaml.load(file.read_bytes(), yaml.CSafeLoader)
    yield from document.get("tests", ())
    yield from document.get("struct_tests", ())


def plain(name: str) -> str:
    """A name without what schemas and vectors spell differently."""
    return name.lower().replace("_", "")


def same(ours: Any, theirs: Any) -> bool:
    """True if a value is that of a vector, which has texts with the NULs that pad them."""
    if isinstance(theirs, Mapping):
        by_name = {plain(name): value for name, value in theirs.items()}
        assert by_name.keys() <= set(map(plain, ours))
        # Some vectors leave out what is reserved, which is 0 then.
        return all(
            same(value, by_name.get(plain(name), 0 if name == "reserved" else None))
            for name, value in ours.items()
        )
    if isinstance(theirs, list):
        return len(ours) == len(theirs) and all(map(same, ours, theirs))
    if isinstance(theirs, str):
        return bool(ours.rstrip("\0") == theirs.rstrip("\0"))
    if isinstance(theirs, float) or isinstance(ours, float):
        return ours == theirs or pack("<f", ours) == pack("<f", float(theirs))
    return bool(ours == theirs)


def in_our_names(fields: Any, ours: Any) -> Any:
    """The fields of a vector under the names that they have in what was decoded."""
    if isinstance(fields, Mapping):
        by_name = {plain(name): value for name, value in fields.items()}
        return {
            name: in_our_names(by_name.get(plain(name), value), value)
            for name, value in ours.items()
        }
    if isinstance(fields, list):
        return [in_our_names(value, inner) for value, inner in zip(fields, ours, strict=True)]
    if isinstance(fields, str) and not ours.endswith("\0"):
        return fields.rstrip("\0")
    return float(fields) if isinstance(ours, float) else fields


class TestDefinitions:
    def test_all_files_are_read(self) -> None:
        assert DATA is not None
        assert len(list(DATA.glob("spec/**/*.yaml"))) == 29
        lines = imported()[1].splitlines()
        # The folder holds the vectors, too.
        assert "29 files of definitions read, 126 other files passed over" in lines
        assert lines[0].endswith("sbp.yaml: 242 messages, 66 types")

    def test_what_is_not_in_the_schema_as_it_is_defined_is_named(self) -> None:
        lines = [line for line in imported()[1].splitlines() if line[:7] in ("left ou", "changed")]
        assert [line.partition(" (")[0] for line in lines] == [
            "left out: SBP",
            "changed: observation.yaml",
            "changed: observation.yaml",
            "changed: MSG_SETTINGS_WRITE_RESP.status",
        ]

    @pytest.mark.parametrize("options", [(), ("--split",)])
    def test_every_schema_compiles_with_nothing_to_report(
        self, options: tuple[str, ...], tmp_path: Path
    ) -> None:
        schemas = imported(*options)[0]
        assert len(schemas) == (26 if options else 1)
        for name, text in schemas.items():
            assert format_text(text) == text
            (tmp_path / f"{name}.yaml").write_text(text)
            assert compile_file(tmp_path / f"{name}.yaml").problems == ()


class TestVectors:
    def test_are_there(self) -> None:
        assert len(VECTORS) == 126

    @pytest.mark.parametrize("file", VECTORS, ids=lambda file: file.stem)
    def test_agree_both_ways(self, file: Path) -> None:
        count = 0
        for vector in vectors(file):
            if "encoded" in vector:
                name = f"struct_{vector['name']}"
                body = b64decode(vector["encoded"])
                corrected = {
                    field: OUT_OF_RANGE.get((vector["name"], field), value)
                    for field, value in vector["fields"].items()
                }
                packet, fields = framed(name, body), {"it": nested(corrected)}
            else:
                name = vector["msg"]["name"].removeprefix("Msg").removeprefix("msg")
                packet, fields = b64decode(vector["raw_packet"]), vector["msg"].get("fields") or {}
            check(name, packet, fields)
            count += 1
        assert count > 0


def check(name: str, packet: bytes, fields: Mapping[str, Any]) -> None:
    """Decode a packet, compare its fields, and make the packet of the fields again."""
    module = codec()
    (event,) = module.Decoder("device").feed(packet)
    assert plain(event.message.NAME).removesuffix("type") == plain(name)
    assert event.parts.sender == int.from_bytes(packet[3:5], "little")
    decoded = event.as_json()["fields"]
    assert same(decoded, fields), (decoded, fields)
    record = type(event.message).from_dict(in_our_names(fields, decoded))
    # Not all numbers in vectors are values of their enums.
    encoded = module.encode(record, sender_=event.parts.sender, strict=False)
    assert encoded.hex() == packet.hex()


def framed(name: str, body: bytes) -> bytes:
    """The packet of a struct that is all of a message."""
    kinds = {plain(kind.NAME): kind for kind in codec().PROTOCOL.sender("device").messages}
    kind = kinds.get(plain(name)) or kinds[plain(f"{name}_type")]
    (identity,) = kind.IDENTITY
    inner = bytes([*identity.to_bytes(2, "little"), 0x42, 0, len(body)]) + body
    return b"\x55" + inner + crc_hqx(inner, 0).to_bytes(2, "little")


def nested(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Fields of structs, which vectors write as `sid.sat` and `coefficients[0]`, too."""
    whole: dict[str, Any] = {}
    for path, value in fields.items():
        name, _, index = path.rstrip("]").partition("[")
        outer, _, inner = name.partition(".")
        if index:
            whole.setdefault(name, []).append(value)
        elif inner:
            whole.setdefault(outer, {})[inner] = value
        else:
            whole[name] = value
    return whole
