"""Uses that other programs make of protogen."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

import protogen

GOOD = """\
protocol: tiny
endpoints: {a: A, b: B}
byte_order: little
frame:
  start: {literal: 0x55}
  ident: {type: uint8, id: true}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: ident..payload}
messages:
  ping: {id: 1, from: a, fields: {number: uint8}}
decisions:
  start_in_data: {question: May 55 occur inside?, document: Silent, choice: Yes, because: It can.}
"""


@pytest.fixture
def schema(tmp_path: Path) -> Path:
    file = tmp_path / "schemas" / "tiny.yaml"
    file.parent.mkdir()
    text = GOOD.replace("{literal: 0x55}", "{literal: 0x55, unprotected: start_in_data}")
    file.write_text(text)
    return file


def test_every_public_name_is_there() -> None:
    for name in protogen.__all__:
        assert getattr(protogen, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = protogen.nothing


def test_load(schema: Path) -> None:
    protocol = protogen.load(schema)
    assert protocol.name == "tiny"
    assert protocol.message("ping").identity == (1,)


def test_load_raises_with_every_problem(schema: Path) -> None:
    schema.write_text(schema.read_text().replace("uint8, id", "uint99, id").replace("sum-8", "s"))
    with pytest.raises(protogen.SchemaError) as caught:
        protogen.load(schema)
    assert [problem.span.line for problem in caught.value.problems] == [6, 8]
    assert str(schema) in str(caught.value)
    other = pickle.loads(pickle.dumps(caught.value))  # As it comes back from another process.
    assert (str(other), other.problems) == (str(caught.value), caught.value.problems)


def test_load_verifies_examples_on_demand(schema: Path) -> None:
    example = "{number: uint8}, examples: {wrong: {frame: {hex: 55 01 02 04}, values: {number: 2}}}"
    schema.write_text(schema.read_text().replace("{number: uint8}", example))
    assert protogen.load(schema).message("ping").examples
    with pytest.raises(protogen.SchemaError, match="example"):
        protogen.load(schema, examples=True)


def test_generate_takes_files_and_folders(schema: Path, tmp_path: Path) -> None:
    of_folder = protogen.generate([schema.parent], tmp_path / "one")
    of_file = protogen.generate([schema], tmp_path / "two", targets=["python"])
    assert set(of_file) == {"python"} < set(of_folder)
    module = (tmp_path / "one/python/tiny.py").read_bytes()
    assert module == (tmp_path / "two/python/tiny.py").read_bytes()


def test_generate_says_where_no_schema_is(tmp_path: Path) -> None:
    with pytest.raises(protogen.NoSchemaError, match="there is no file or folder"):
        protogen.generate([tmp_path / "nowhere"], tmp_path)
    with pytest.raises(protogen.NoSchemaError, match="holds no"):
        protogen.generate([tmp_path], tmp_path)


def test_module_of_is_the_codec(schema: Path) -> None:
    module = protogen.module_of(protogen.load(schema))
    # By hand: 01 + 02 = 03.
    assert module.encode(module.Ping(number=2)) == bytes.fromhex("55 01 02 03")


SECOND = "  pong: {id: 2, from: a, fields: {data: {type: bytes, size: 9}}}\n"


def test_select_leaves_some_messages(schema: Path) -> None:
    schema.write_text(schema.read_text().replace("decisions:", f"{SECOND}decisions:"))
    protocol = protogen.load(schema)
    small = protogen.select(protocol, messages=["ping"])
    assert [message.name for message in small.messages] == ["ping"]
    assert protocol.sender("a").framing.greatest == 12  # 55, identity, 9 bytes, sum
    assert small.sender("a").framing.greatest == 4  # 55, identity, 1 byte, sum
    assert small.spec_hash == protocol.spec_hash
    assert protogen.select(protocol) is protocol
    with pytest.raises(KeyError):
        protogen.select(protocol, messages=["pang"])
    with pytest.raises(KeyError):
        protogen.select(protocol, senders=["b"])


def test_a_decoder_of_a_selection_does_not_know_the_rest(schema: Path) -> None:
    schema.write_text(schema.read_text().replace("decisions:", f"{SECOND}decisions:"))
    module = protogen.module_of(protogen.select(protogen.load(schema), messages=["ping"]))
    decoder = module.Decoder(sender="a")
    # By hand: a pong of nine bytes 00, whose sum is 02; then a ping.
    data = bytes.fromhex("55 02 00 00 00 00 00 00 00 00 00 02 55 01 07 08")
    events = [*decoder.feed(data), *decoder.flush()]
    assert b"".join(event.raw for event in events) == data
    assert [event.message.number for event in events if event.kind == "message"] == [7]
