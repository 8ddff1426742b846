"""Some 300 pairs of versions: what the gate says of each, and what decoding with both says.

A pair is a message of one kind of field, or a frame, and an edit with the reason for its verdict:

* `WIRE`: some frame of one version is lost, or cut into other raw values, by the other;
* `VALUE`: raw values are the same, and some of them mean something else;
* `PASS`: every frame has the same raw values, and quantities, in both.

The gate has to stop the first two and to let the third pass. Each verdict is derived a second time
from generated Python of both versions, which knows nothing of `protogen.evolution`.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from enum import Enum, Flag
from itertools import islice
from math import isfinite
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any, NamedTuple

import pytest
import yaml

from protogen.compiler import compile_file
from protogen.evolution.findings import Gate, findings
from protogen.fuzzing.samples import boundary_rounds, samples
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol
from protogen.runtime.attributes import arguments

Data = dict[str, Any]
Edit = Callable[[Data], Any]

BASE: Data = {
    "protocol": "demo",
    "endpoints": {"host": "Computer", "board": "Sensor board"},
    "byte_order": "little",
    "frame": {
        "start": {"literal": 0xAA},
        "kind": {"type": "uint8", "id": True},
        "number": {"type": "uint8", "default": 0},
        "payload": {},
        "crc": {
            "type": "uint16",
            "algorithm": "CRC-16/KERMIT",
            "covers": ["kind", "number", "payload"],
        },
    },
    "transparency": {
        "covers": "kind..crc",
        "escape": {"byte": 0xAB, "of": [0xAA, 0xAB], "transform": {"xor": 0x20}},
    },
    "messages": {
        "state": {"id": 1, "from": "board", "fields": {}},
        "beat": {"id": 2, "from": "board", "fields": {"tick": "uint8"}},
    },
}

KINDS: dict[str, Data] = {
    "uint8": {"x": {"type": "uint8"}},
    "uint16": {"x": {"type": "uint16"}},
    "sint16": {"x": {"type": "sint16", "scale": "1/16", "unit": "deg"}},
    "uint24": {"x": {"type": "uint24"}},
    "sint32": {"x": {"type": "sint32", "unit": "mm"}},
    "uint64": {"x": {"type": "uint64"}},
    "float32": {"x": {"type": "float32", "unit": "m"}},
    "float64": {"x": {"type": "float64"}},
    "char": {"x": {"type": "char"}},
    "bool": {"x": {"type": "bool"}},
    "enum": {"x": {"type": "uint8", "values": {"idle": 0, "run": 1, "stop": 2}}},
    "closed": {"x": {"type": "uint8", "values": {"shut": 0, "open": 1}, "closed": True}},
    "flags": {"x": {"type": "uint8", "flags": {"hot": 0, "wet": 1}}},
    "bits": {"x": {"type": "uint8", "bits": {"step": "0..2", "rest": "3..7"}}},
    "special": {"x": {"type": "uint16", "unit": "mm", "special": {"unseen": 0xFFFF}}},
    "ranged": {"x": {"type": "uint8", "range": [2, 9]}},
    "text": {"x": {"type": "ascii", "size": 4}},
    "octets": {"x": {"type": "bytes", "size": 4}},
    "array": {"x": {"type": "uint16", "count": 3}},
    "struct": {"x": {"fields": {"a": "sint16", "b": "uint8"}}},
    "counted": {"n": {"type": "uint8", "range": [0, 4]}, "x": {"type": "uint8", "count": "n"}},
    "packed": {"x": {"type": "uint11", "count": 5, "packed": "lsb_first"}},
    "run": {"x": {"packed": "msb_first", "fields": {"a": "uint3", "b": "sint9", "c": "bool"}}},
    "digits": {"x": {"type": "uint16", "digits": "base16-upper"}},
    "union": {
        "n": {"type": "uint8", "values": {"small": 0, "large": 1}, "closed": True},
        "x": {"switch": "n", "cases": {"small": "uint8", "large": "uint16"}},
    },
}
"""Fields of the message, which ends with a byte `z`."""


PARTS: dict[str, Data] = {
    "choice of literals": {"literal": {"any_of": [0x10, 0x20], "default": 0x10}},
    "digits of a part": {"type": "uint8", "digits": "base16-upper", "default": 0},
}
"""The part `number` of the frame, around the fields of `uint8`."""


class Pair(NamedTuple):
    kind: str
    name: str
    edit: Edit
    verdict: str
    reason: str


def fields(data: Data) -> Data:
    found: Data = data["messages"]["state"]["fields"]
    return found


def renamed(mapping: Data, before: str, after: str) -> Data:
    return {after if key == before else key: value for key, value in mapping.items()}


def rename_field(data: Data, before: str, after: str) -> None:
    data["messages"]["state"]["fields"] = renamed(fields(data), before, after)


def put(key: str, value: object) -> Edit:
    return lambda data: fields(data)["x"].update({key: value})


def rename_and_say(data: Data) -> None:
    rename_field(data, "x", "other_name")
    fields(data)["other_name"]["renamed_from"] = "x"


def swap(data: Data) -> None:
    items = list(fields(data).items())
    data["messages"]["state"]["fields"] = dict([*items[:-2], items[-1], items[-2]])


def drop_last(data: Data) -> None:
    fields(data).pop("z")


def drop(data: Data) -> None:
    fields(data).pop("x")


def change_id(data: Data) -> None:
    data["messages"]["state"]["id"] = 9


def delete(data: Data) -> None:
    del data["messages"]["state"]


def reserve(data: Data) -> None:
    delete(data)
    data["reserved"] = {"identities": [{"from": "board", "id": 1}]}


def rename_message(data: Data) -> None:
    data["messages"] = renamed(data["messages"], "state", "status")


def rename_all(data: Data) -> None:
    rename_message(data)
    names = {name: f"q{index}" for index, name in enumerate(data["messages"]["status"]["fields"])}
    text = yaml.safe_dump(data["messages"]["status"]["fields"], sort_keys=False)
    found = yaml.safe_load(text)
    for before, after in names.items():
        found = renamed(found, before, after)
    for item in found.values():
        if isinstance(item, dict):
            item |= {key: names[item[key]] for key in ("count", "switch") if item.get(key) in names}
    data["messages"]["status"]["fields"] = found


def of_every_kind(kind: str) -> Iterator[Pair]:
    def pair(name: str, edit: Edit, verdict: str, reason: str) -> Pair:
        return Pair(kind, name, edit, verdict, reason)

    yield pair("doc", lambda d: fields(d)["x"].update(doc="Words."), "PASS", "texts are no bytes")
    yield pair("say it", rename_and_say, "PASS", "the schema says that only the name changed")
    yield pair("rename", lambda d: rename_field(d, "x", "x_now"), "PASS", "the same bytes")
    yield pair("add", lambda d: fields(d).update(more="uint8"), "WIRE", "frames are longer")
    yield pair("drop the last", drop_last, "WIRE", "frames are shorter")
    yield pair("drop", drop, "WIRE", "what stands behind it moves")
    yield pair("swap", swap, "WIRE", "two fields change places")
    yield pair("id", change_id, "WIRE", "each side knows another identity")
    yield pair("delete", delete, "WIRE", "new receivers do not know the frame")
    yield pair("message", rename_message, "PASS", "the message is told by its identity")
    yield pair("rename all", rename_all, "WIRE", "nothing says that it means the same")


WIDER = {
    "uint8": "uint16", "uint16": "uint24", "sint16": "sint32", "uint24": "uint16",
    "sint32": "sint16", "uint64": "uint32", "float32": "float64", "float64": "float32",
    "enum": "uint16", "closed": "uint16", "flags": "uint16", "bits": "uint16", "special": "uint24",
    "ranged": "uint16", "array": "uint8", "char": "uint16", "bool": "uint16",
}  # fmt: skip
SIGNED = {
    "uint8": "sint8", "uint16": "sint16", "sint16": "uint16", "uint24": "sint24",
    "sint32": "uint32", "uint64": "sint64", "array": "sint16",
}  # fmt: skip
NUMBERS = ("uint8", "uint16", "sint16", "sint32", "float32", "ranged", "special")
ORDERED = (
    "uint16",
    "sint16",
    "uint24",
    "sint32",
    "uint64",
    "float32",
    "float64",
    "special",
    "array",
)


def of_types() -> Iterator[Pair]:
    for kind, type_ in WIDER.items():
        yield Pair(kind, "width", put("type", type_), "WIRE", "what follows moves")
    for kind, type_ in SIGNED.items():
        yield Pair(kind, "sign", put("type", type_), "WIRE", "the highest bit means another number")
    for kind in ORDERED:
        yield Pair(kind, "order", put("byte_order", "big"), "WIRE", "bytes are read backwards")
    for kind in NUMBERS:
        yield Pair(kind, "scale", put("scale", "1/7"), "VALUE", "the same number is less")
        yield Pair(kind, "offset", put("offset", 3), "VALUE", "the same number is 3 more")
        yield Pair(kind, "unit", put("unit", "kg"), "VALUE", "another quantity")
    for kind in ("uint16", "sint32"):
        yield Pair(kind, "const", put("special", {"absent": 5}), "VALUE", "5 is no number any more")
    for kind, size in (("text", 5), ("text", 3), ("octets", 6), ("octets", 2)):
        yield Pair(kind, f"size {size}", put("size", size), "WIRE", "what follows moves")
    yield Pair("array", "count", put("count", 4), "WIRE", "what follows moves")
    yield Pair("text", "as bytes", put("type", "bytes"), "PASS", "the same bytes, shown otherwise")
    yield Pair("octets", "as text", put("type", "ascii"), "PASS", "the same bytes, shown otherwise")
    for kind in ("uint8", "uint16", "sint16"):
        yield Pair(kind, "default", put("default", 7), "PASS", "for who says nothing")


def of_names() -> Iterator[Pair]:
    idle = {"idle": 0, "run": 1, "stop": 2}
    yield Pair("enum", "moved", put("values", idle | {"stop": 7}), "VALUE", "stop is 7 now")
    yield Pair("enum", "less", put("values", {"idle": 0, "run": 1}), "VALUE", "2 has no name")
    yield Pair("enum", "more", put("values", idle | {"back": 3}), "PASS", "3 was never named")
    yield Pair(
        "enum", "turned", put("values", {"run": 0, "idle": 1, "stop": 2}), "VALUE", "0 is run now"
    )
    yield Pair("enum", "closed", put("closed", True), "WIRE", "3 is refused")
    yield Pair("closed", "opened", put("closed", False), "WIRE", "old receivers refuse 2")
    yield Pair(
        "closed", "more", put("values", {"shut": 0, "open": 1, "jam": 2}), "WIRE", "2 was refused"
    )
    yield Pair("flags", "moved", put("flags", {"hot": 0, "wet": 2}), "VALUE", "wet is another bit")
    yield Pair("flags", "turned", put("flags", {"wet": 0, "hot": 1}), "VALUE", "bit 0 is wet now")
    yield Pair("flags", "less", put("flags", {"hot": 0}), "VALUE", "bit 1 has no name")
    yield Pair("flags", "more", put("flags", {"hot": 0, "wet": 1, "dry": 5}), "PASS", "a new name")
    runs = {"step": "0..3", "rest": "4..7"}
    yield Pair("bits", "moved", put("bits", runs), "VALUE", "step has a bit more")
    yield Pair(
        "bits", "order", put("bits", {"rest": "3..7", "step": "0..2"}), "PASS", "an order of keys"
    )
    yield Pair("special", "moved", put("special", {"unseen": 0}), "VALUE", "0 is no distance now")
    yield Pair("special", "gone", lambda d: fields(d)["x"].pop("special"), "VALUE", "65535 mm now")


QUANTITIES = [
    ("sint32", "m", "1/1000"), ("sint32", "cm", "1/10"), ("sint32", "um", "1000"),
    ("sint32", "km", "1/1000000"), ("float32", "mm", "1000"), ("float32", "cm", "100"),
    ("special", "m", "1/1000"), ("special", "cm", "1/10"),
]  # fmt: skip


def of_quantities() -> Iterator[Pair]:
    for kind, unit, scale in QUANTITIES:

        def edit(data: Data, unit: str = unit, scale: str = scale) -> None:
            fields(data)["x"] |= {"unit": unit, "scale": scale}

        yield Pair(kind, f"in {unit}", edit, "PASS", "the same length in another unit")


def frame(name: str, **keys: object) -> Edit:
    return lambda data: data["frame"][name].update(keys)


def of_frames() -> Iterator[Pair]:
    def start(data: Data) -> None:
        data["frame"]["start"]["literal"] = 0x55
        data["transparency"]["escape"]["of"] = [0x55, 0xAB]

    def covers(data: Data) -> None:
        data["frame"]["crc"]["covers"] = ["kind", "payload"]

    def escape(data: Data) -> None:
        data["transparency"]["escape"]["transform"] = {"xor": 0x40}

    def of(data: Data) -> None:
        data["transparency"]["escape"]["of"] = [0xAB, 0xAA]

    def more_of(data: Data) -> None:
        data["transparency"]["escape"]["of"] = [0x11, 0xAA, 0xAB]

    def less(data: Data) -> None:
        data["frame"].pop("number")
        data["frame"]["crc"]["covers"] = ["kind", "payload"]

    def parameters(data: Data) -> None:
        data["frame"]["crc"]["algorithm"] = {
            "width": 16, "poly": 0x1021, "init": 0, "refin": True, "refout": True, "xorout": 0,
        }  # fmt: skip

    edits: list[tuple[str, Edit, str, str]] = [
        ("start", start, "WIRE", "nobody finds a start"),
        ("crc", frame("crc", algorithm="CRC-16/XMODEM"), "WIRE", "no checksum agrees"),
        ("crc by parameters", parameters, "PASS", "the same polynomial and registers"),
        ("crc order", frame("crc", byte_order="big"), "WIRE", "no checksum agrees"),
        ("crc width", frame("crc", type="uint8", algorithm="xor-8"), "WIRE", "another sum"),
        ("covers", covers, "WIRE", "the sum runs over less"),
        ("escape", escape, "WIRE", "escaped bytes are others"),
        ("order of escaped", of, "PASS", "an order of bytes in a list"),
        ("more escaped", more_of, "WIRE", "0x11 is escaped, which old receivers refuse"),
        ("less parts", less, "WIRE", "the payload moves"),
        ("wider part", frame("number", type="uint16"), "WIRE", "the payload moves"),
        ("doc", frame("number", doc="Words."), "PASS", "texts are no bytes"),
        ("counter", lambda d: d["frame"].update(number={"type": "uint8", "counter": True}), "PASS",
         "receivers take any number"),
    ]  # fmt: skip
    for name, edit, verdict, reason in edits:
        for kind in ("uint8", "struct"):
            yield Pair(kind, f"frame {name}", edit, verdict, reason)


def of_bits_and_digits() -> Iterator[Pair]:
    def add(data: Data) -> None:
        fields(data)["x"]["fields"]["d"] = "bool"

    def turn(data: Data) -> None:
        fields(data)["x"]["fields"] = {"b": "sint9", "a": "uint3", "c": "bool"}

    def rename(data: Data) -> None:
        fields(data)["x"]["fields"] = {"a": "uint3", "b_now": "sint9", "c": "bool"}

    def number(data: Data) -> None:
        fields(data)["x"]["fields"]["c"] = "uint1"

    yield Pair("digits", "case", put("digits", "base16-lower"), "WIRE", "letters are others")
    yield Pair("digits", "chars", put("chars", 5), "WIRE", "what follows moves")
    yield Pair("digits", "base", put("digits", "base10"), "WIRE", "what follows moves")
    undone: Edit = lambda d: fields(d)["x"].pop("digits")  # noqa: E731
    yield Pair("digits", "no text", undone, "WIRE", "two bytes instead of four digits")
    yield Pair("digits", "width", put("type", "uint12"), "WIRE", "what follows moves")
    yield Pair("packed", "order", put("packed", "msb_first"), "WIRE", "bits are read backwards")
    yield Pair("run", "order", put("packed", "lsb_first"), "WIRE", "bits are read backwards")
    for kind in ("packed", "run"):
        unpacked: Edit = lambda d: fields(d)["x"].pop("packed")  # noqa: E731
        yield Pair(kind, "unpacked", unpacked, "WIRE", "each takes whole bytes")
    yield Pair("packed", "width", put("type", "uint12"), "WIRE", "what follows moves")
    yield Pair("packed", "sign", put("type", "sint11"), "WIRE", "the highest bit means another")
    yield Pair("packed", "count", put("count", 6), "WIRE", "what follows moves")
    yield Pair("run", "more", add, "WIRE", "old receivers refuse a bit behind the last number")
    yield Pair("run", "turned", turn, "WIRE", "numbers change places")
    yield Pair("run", "rename a member", rename, "PASS", "the same bits")
    yield Pair("run", "as number", number, "PASS", "the same bit, shown otherwise")


def of_parts() -> Iterator[Pair]:
    def number(**part: object) -> Edit:
        return lambda data: data["frame"].update(number=part)

    def several(literals: list[int], default: int) -> Edit:
        return number(literal={"any_of": literals, "default": default})

    edits: list[tuple[str, str, Edit, str, str]] = [
        ("choice of literals", "more", several([0x10, 0x20, 0x30], 0x10), "WIRE",
         "old receivers refuse the third"),
        ("choice of literals", "less", several([0x10, 0x30], 0x10), "WIRE",
         "new receivers refuse the second"),
        ("choice of literals", "order", several([0x20, 0x10], 0x10), "PASS",
         "an order of literals in a list"),
        ("choice of literals", "default", several([0x10, 0x20], 0x20), "PASS",
         "receivers take both"),
        ("choice of literals", "larger", number(literal={"any_of": [[0x10, 0], [0x20, 0]]}), "WIRE",
         "the payload moves"),
        ("choice of literals", "number", number(type="uint8", default=0x10), "WIRE",
         "old receivers refuse other numbers"),
        ("choice of literals", "one", number(literal=0x10), "WIRE",
         "new receivers refuse the other"),
        ("digits of a part", "case", frame("number", digits="base16-lower"), "WIRE",
         "letters are others"),
        ("digits of a part", "base", frame("number", digits="base10"), "WIRE",
         "the payload moves"),
        ("digits of a part", "chars", frame("number", chars=3), "WIRE", "the payload moves"),
        ("digits of a part", "code", number(type="uint8", code={"bits": 4, "add": 0x30}), "WIRE",
         "ten is a colon, and no A"),
        ("digits of a part", "width", frame("number", type="uint7"), "WIRE",
         "new receivers refuse 80 to FF"),
        ("digits of a part", "no text", number(type="uint8", default=0), "WIRE",
         "one byte instead of two digits"),
        ("digits of a part", "needed chars", frame("number", chars=2), "PASS", "two are needed"),
        ("digits of a part", "range", frame("number", range=[0, 100]), "PASS",
         "receivers take any number"),
        ("uint8", "crc in digits", frame("crc", digits="base16-upper", byte_order=None), "WIRE",
         "four digits instead of two bytes"),
        ("uint8", "several starts", lambda d: (
            d["frame"]["start"].update(literal={"any_of": [0xAA, 0xAC]}),
            d["transparency"]["escape"].update(of=[0xAA, 0xAB, 0xAC]),
         ), "WIRE", "old receivers find no start at the second"),
    ]  # fmt: skip
    for kind, name, edit, verdict, reason in edits:
        yield Pair(kind, f"part {name}", edit, verdict, reason)


PAIRS = [
    *(pair for kind in KINDS for pair in of_every_kind(kind)),
    *of_types(),
    *of_bits_and_digits(),
    *of_names(),
    *of_quantities(),
    *of_frames(),
    *of_parts(),
]


def compiled(path: Path, data: Data) -> Protocol:
    path.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
    compilation = compile_file(path)
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


def test_there_are_300_pairs() -> None:
    names = [(pair.kind, pair.name) for pair in PAIRS]
    assert len(set(names)) == len(names) >= 300


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: f"{pair.kind}, {pair.name}")
def test_the_gate_says_what_decoding_shows(pair: Pair, tmp_path: Path) -> None:
    before = copy.deepcopy(BASE)
    if pair.kind in PARTS:
        before["frame"]["number"] = copy.deepcopy(PARTS[pair.kind])
    kind = KINDS.get(pair.kind, KINDS["uint8"])
    fields(before).update(copy.deepcopy(kind), z={"type": "uint8"})
    after = copy.deepcopy(before)
    pair.edit(after)
    old, new = compiled(tmp_path / "old.yaml", before), compiled(tmp_path / "new.yaml", after)
    found = findings(old, new, Gate())[1]
    assert bool(found) == (pair.verdict != "PASS"), (pair.reason, found)
    categories = {item.category.value for item in found}
    assert pair.verdict == "PASS" or pair.verdict in categories, (pair.reason, categories)
    assert verdict(old, new, pair) == pair.verdict, pair.reason


# --- the verdict by decoding ----------------------------------------------------------------------


def verdict(old: Protocol, new: Protocol, pair: Pair) -> str:
    """Derive the verdict from what generated Python of one version reads of the other's frames."""
    if pair.name == "rename all":
        return "WIRE"  # Bytes can't show it: the names are all that tells the meaning.
    modules = module_of(old), module_of(new)
    seen = "PASS"
    for one, other, sender in ((0, 1, old), (1, 0, new)):
        for frame_ in frames(modules[one], sender):
            mine, theirs = read(modules[one], frame_), read(modules[other], frame_)
            if mine is None:
                continue
            if theirs is None or not have_same_values(mine, theirs):
                return "WIRE"
            pairs = zip(mine.meaning, theirs.meaning, strict=True)
            if not all(is_understood(*each, old_sends=one == 0) for each in pairs):
                seen = "VALUE"
    return seen


def frames(module: ModuleType, protocol: Protocol) -> Iterator[bytes]:
    """Frames of the message with identity 1, with each value at its bounds, and some more."""
    (sender,) = (item for item in protocol.senders if item.name == "board")
    for message in sender.messages:
        count = boundary_rounds(message, sender.frame) + 20
        for values, parts in islice(samples(message, sender.frame, Random(1)), count):
            made = module.MESSAGES[message.name].from_dict(values)
            yield module.encode(made, **arguments(parts))


class Read(NamedTuple):
    identity: object
    raw: dict[str, object]
    meaning: list[Meaning]


FACTORS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "km": 1e3}


def read(module: ModuleType, frame_: bytes) -> Read | None:
    decoder = module.Decoder(sender="board")
    events = [*decoder.feed(frame_), *decoder.flush()]
    if [event.kind for event in events] != ["message"]:
        return None
    message = events[0].message
    raw = {name: plain(getattr(message, name)) for name, _ in message.RULES}
    return Read(message.IDENTITY, raw, [*meanings(message)])


def have_same_values(mine: Read, theirs: Read) -> bool:
    """True if raw values are the same: by their names, or by their order where names are others."""
    if mine.identity != theirs.identity:
        return False
    if mine.raw.keys() == theirs.raw.keys():
        return mine.raw == theirs.raw
    return [*mine.raw.values()] == [*theirs.raw.values()]


def plain(value: object) -> object:
    if hasattr(value, "to_dict"):
        return plain(value.to_dict())
    if isinstance(value, dict):
        return [plain(item) for item in value.values()]
    if isinstance(value, list):
        return [plain(item) for item in value]
    if isinstance(value, str):
        return value.encode("latin-1", "replace").ljust(4, b"\0")
    if isinstance(value, bytes):
        return value.ljust(4, b"\0")
    if isinstance(value, float):
        return repr(value)  # No NaN equals another one.
    return value


class Meaning(NamedTuple):
    """What one value means."""

    names: frozenset[str]
    """Names of the value or of its set bits; empty where the schema gives it none."""
    quantity: object
    """Number and unit, in metres where it is a length; None where a name stands for none."""
    runs: tuple[tuple[str, int], ...]


def meanings(message: Any) -> Iterator[Meaning]:
    """What each value means, in the order of the fields."""
    for name, rule in message.RULES:
        value = getattr(message, name)
        runs = {word: f"{name}_{word}" for word in ("rest", "step")}
        found = tuple(
            (w, getattr(message, attr)) for w, attr in runs.items() if hasattr(message, attr)
        )
        special = {number: word for word, number in getattr(rule, "special", {}).items()}
        members = (
            getattr(rule, "named", None).__members__.items() if isinstance(value, Enum) else ()
        )
        names = frozenset(word for word, item in members if has(value, item))
        is_special = isinstance(value, int) and value in special
        if is_special:
            names = frozenset([special[value]])
        yield Meaning(names, None if is_special else quantity(rule, value), found)


def has(value: Any, member: Any) -> bool:
    """True if a value is a member, or has its bits."""
    return bool(value & member) if isinstance(value, Flag) else bool(value == member)


def quantity(rule: Any, value: object) -> object:
    if not hasattr(rule, "scale") or not isinstance(value, int | float) or not isfinite(value):
        return None
    unit = rule.unit or ""
    physical = (value * float(rule.scale) + float(rule.offset)) * FACTORS.get(unit, 1.0)
    return ("m" if unit in FACTORS else unit), float(f"{physical:.9g}")


def is_understood(mine: Meaning, theirs: Meaning, old_sends: bool) -> bool:
    """True if a receiver takes a value for what its sender meant.

    A name that is new is no loss to an old receiver, which shows the number.
    """
    known = mine.names <= theirs.names if old_sends else theirs.names <= mine.names
    return known and (mine.quantity, mine.runs) == (theirs.quantity, theirs.runs)
