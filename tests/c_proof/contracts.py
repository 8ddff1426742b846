"""ACSL contracts for generated C, which WP proves: an event has what its message needs.

EVA does not keep together an event's size and the count of an array that a check has tested with
it. Contracts do: each says of a payload what `load` asks of it. `check` ensures it, what fills an
event hands it on, and `dispatch` requires it. They are comments: the program stays what a user
compiles.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from c_proof.received import SHORT
from protogen.model.protocol import Protocol

NEEDS = {
    ("rn1", "maintenance"): "(payload[3] != 65 || size == 7) && (payload[3] != 83 || size == 5)",
    ("rn1_firmware", "maintenance"): "(payload[3] != 83 || size == 5)",
    ("rflex", "sonar_data"): "(size - 8) % 3 == 0",
    ("rflex_drivers", "sonar_data"): "(size - 8) % 3 == 0",
    ("rflex_drivers", "lcd_dump"): "size == 6 + payload[5]",
}
"""What `load` asks of a payload whose size is one of those that its message can have."""
_SIZES = re.compile(r"#define (\w+)_PAYLOAD_MIN (\d+)[uU]\s[^#]*#define \1_PAYLOAD_MAX (\d+)[uU]")
_CHECK = re.compile(r"^static enum \w+ (\w+)_check\([^;{]*size_t \*need\) \{", re.MULTILINE)
_HANDLED = re.compile(r"^ +decoder->handler\(decoder->user, &event\);\n", re.MULTILINE)
_SENDER = re.compile(r"^(?:void|enum \w+) (\w+)_decoder_push\(", re.MULTILINE)
_LOOP = re.compile(r"^( +)(?:for|while) \((?:(?:size_t|int) (\w+) = )?.*\{.*\n", re.MULTILINE)
_LOCAL = re.compile(r"^( +)(?!return|__m128i)(?:enum )?\w+ (\w+)(?: = [^;]*)?;\n", re.MULTILINE)
_PARAMETER = re.compile(r"(\w+)[,)]")
_CALL = re.compile(r"\b(\w+)\(")
_TO_WORD = re.compile(r"\(void\)memcpy\(&(\w+), ([^;]*), ([48])\);")
_FROM_WORD = re.compile(r"\(void\)memcpy\(([^;]*), &(\w+), ([48])\);")
_LEFT = r"invariant size <= \at(size, Pre) && data == \at(data, Pre) + (\at(size, Pre) - size)"
"""What holds of the bytes that are left, of which the first is at `data`."""
_IN_WORDS = r"invariant size == \at(size, Pre) && data == \at(data, Pre) && index <= size"
_IN_BLOCK = f"{_IN_WORDS} && index <= end && end <= size && (end - index) % 8 == 0"
_WORDS = """
/*@ requires \\valid_read(at + (0 .. {last})); assigns \\nothing; */
static uint64_t read_{size}(const uint8_t *at);

/*@ requires \\valid(at + (0 .. {last})); assigns at[0 .. {last}]; */
static void write_{size}(uint8_t *at, uint64_t word);
"""
_BEHIND = re.compile(r"&content\[(\d+)U? \+ decoder->payload\]")
_LIMIT = re.compile(r"left > (\d+)U\)")
_APPLICATION = """
/*@ assigns \\nothing; */
static void {prefix}_application(void *user, const struct {prefix}_event *event);
"""


@dataclass
class Contracts:
    """Generated C with contracts, and the functions that have them."""

    header: str
    source: str
    functions: list[str] = field(default_factory=list)
    safe: list[str] = field(default_factory=list)
    """Of which it is proved, too, that they access nothing out of bounds."""

    def has(self, name: str) -> bool:
        return _definition(name).search(self.source) is not None

    def body(self, name: str) -> str:
        text = self.source if self.has(name) else self.header
        found = _definition(name).search(text)
        assert found, name
        return text[found.start() : text.index("\n}\n", found.start()) + 3]

    def put(self, name: str, *clauses: str) -> None:
        """Put a contract in front of a function, which is to be proved."""
        contract = "/*@\n" + "".join(f"    {clause};\n" for clause in clauses) + "*/\n"
        self.change(name, contract + self.body(name))
        self.functions.append(name)

    def put_safe(self, name: str, *clauses: str) -> None:
        """The same, for a function that is to access nothing out of bounds either."""
        self.put(name, *clauses)
        self.safe.append(name)

    def change(self, name: str, body: str) -> None:
        """Put another text where that of a function is."""
        before = self.body(name)
        self.header = self.header.replace(before, body)
        self.source = self.source.replace(before, body)

    def loops(self, name: str, *clauses: str, assigns: Sequence[str] = ()) -> None:
        """Put the same clauses in front of each loop of a function, beside the names it changes."""
        body = self.body(name)

        def annotated(loop: re.Match[str]) -> str:
            own, before = loop[2], body[: loop.start()]
            given = _PARAMETER.findall(body[: body.index("{")])
            names = [own] if own else []
            names += [
                local[2]
                for local in _LOCAL.finditer(before)
                if _is_open(before[local.end() :], local)
            ]
            names += [
                name for name in given if re.search(rf"\b{name}(?: [-+|&^]?= |\+\+|--)", body)
            ]
            text = " ".join(f"loop {clause};" for clause in clauses)
            text += f" loop assigns {', '.join(dict.fromkeys([*names, *assigns]))};"
            return f"{loop[1]}//@ {text}\n{loop.group()}"

        self.change(name, _LOOP.sub(annotated, body))

    def declare(self, text: str) -> None:
        """Put text behind the header's inclusion."""
        found = re.search(r'#include "\w+\.h"\n', self.source)
        assert found
        self.source = self.source[: found.end()] + text + self.source[found.end() :]


def needs(protocol: Protocol, header: str) -> dict[str, str]:
    """What each message's `load` asks of a payload, in words that C and ACSL share."""
    flat = re.sub(r"\\\n", " ", header)
    found = {}
    for upper, least, most in _SIZES.findall(flat):
        message = upper.lower().removeprefix(f"{protocol.name}_")
        sizes = f"{least} <= size && size <= {most}"
        more = NEEDS.get((protocol.name, message))
        found[message] = f"{sizes} && {more}" if more else sizes
    return found


def contracted(protocol: Protocol, header: str, source: str) -> Contracts:
    """Contracts that say: an event of a message has a payload that `load` can read."""
    name, upper = protocol.name, protocol.name.upper()
    made = Contracts(header, portable(source))
    asked = needs(protocol, header)
    for found in _CHECK.findall(source):
        message = found.removeprefix(f"{name}_")
        if made.has(f"{found}_check"):
            fits = f"{message}_fits(payload, size)"
            # `dispatch` is analysed with payloads that fit. Long ones are left to `decode`, which
            # has to take them all.
            implies = "<==>" if _varies(made, found) > SHORT else "==>"
            made.put(
                f"{found}_check",
                r"assigns \nothing",
                rf"ensures 0 <= \result < 255 && (\result == {upper}_OK {implies} {fits})",
            )
    for prefix in _SENDER.findall(source):
        _handled(made, prefix, upper)
    _checked_loops(made)
    for function in list(made.functions):
        _purify(made, function)
    made.declare("".join(_WORDS.format(size=size, last=size - 1) for size in (4, 8)))
    made.declare(_predicates(asked, upper))
    return made


def _varies(made: Contracts, prefix: str) -> int:
    """Size of a message's longest payload, if others are shorter."""
    flat = re.sub(r"\\\n", " ", made.header)
    [(least, most)] = [
        (int(least), int(most))
        for name, least, most in _SIZES.findall(flat)
        if name == prefix.upper()
    ]
    return most if least < most else 0


def _handled(made: Contracts, prefix: str, upper: str) -> None:
    """What calls the application's handler, which is taken to leave the decoder as it is."""
    valid = r"requires \valid(decoder)"
    made.put(
        f"{prefix}_identify",
        r"requires \valid(message) && \separated(message, parts, payload + (0 .. size - 1))",
        "assigns *message",
        rf"ensures \result == {upper}_FINE ==> holds(*message, payload, size)",
    )
    made.put(f"{prefix}_invalid", valid, "assigns decoder->offset")
    if made.has(f"{prefix}_end_noise"):
        made.put(f"{prefix}_end_noise", valid, "assigns decoder->offset, decoder->noise")
    bytes_ = r"requires \valid_read(data + (0 .. size - 1))"
    feed = f"{prefix}_decoder_feed"
    made.put(f"{prefix}_decoder_push", valid, "assigns *decoder")
    made.functions.remove(f"{prefix}_decoder_push")
    made.put_safe(feed, valid, rf"{bytes_} && \separated(decoder, data + (0 .. size - 1))")
    kept = rf"index <= size && \valid(decoder) && {bytes_.removeprefix('requires ')}"
    kept = f"{kept} && \\separated(decoder, data + (0 .. size - 1))"
    made.change(
        feed, _LOOP.sub(lambda m: f"{m[1]}//@ loop invariant {kept};\n{m[0]}", made.body(feed))
    )
    complete = f"{prefix}_complete"
    behind = [int(place) for place in _BEHIND.findall(made.body(complete))]
    room = _room(made, prefix)
    made.put(complete, valid, f"requires decoder->payload < {room - max(behind)}")
    if made.has(f"{prefix}_take_whole"):
        _whole(made, prefix, valid, "assigns decoder->offset, decoder->noise", room)
    for name in ("invalid", "complete", "hand_over", "take_whole"):
        if made.has(f"{prefix}_{name}"):
            _delivers(made, f"{prefix}_{name}", f"{prefix}_application(")
    made.declare(_APPLICATION.format(prefix=prefix))


def _delivers(made: Contracts, function: str, call: str) -> None:
    """Where the application is called: an event of a message has what that asks for."""
    asserted = ["holds(event.message, event.payload, event.payload_size)"]
    if function in made.safe:
        asserted.append(r"\valid_read(event.payload + (0 .. event.payload_size - 1))")
    text = "".join(f"    //@ assert {claim};\n" for claim in asserted)
    body = made.body(function).replace("    decoder->handler(", f"{text}    {call}")
    made.change(function, body)


def _room(made: Contracts, prefix: str) -> int:
    """Bytes in a decoder's buffer."""
    found = re.search(
        rf"struct {prefix}_decoder \{{\n(?:(?!\}};).*\n)*? +uint8_t buffer\[(\d+)\];", made.header
    )
    assert found
    return int(found[1])


def _whole(made: Contracts, prefix: str, valid: str, changes: str, room: int) -> None:
    """What takes frames whole, out of bytes that are all there."""
    data = r"\valid_read(data + (0 .. size - 1))"
    buffer = f"decoder->buffer[0 .. {room - 1}]"
    most = 0
    if made.has(f"{prefix}_measure_head"):
        head = made.body(f"{prefix}_measure_head")
        [limit] = _LIMIT.findall(head) or ["255"]
        most = int(limit)
        last = max(map(int, re.findall(r"content\[(\d+)\]", head)))
        made.put_safe(
            f"{prefix}_measure_head",
            rf"requires \valid(payload) && \valid_read(content + (0 .. {last}))",
            r"requires \separated(payload, content + (0 .. 0))",
            "assigns *payload",
            rf"ensures \result ==> *payload <= {most}",
        )
    if made.has(f"{prefix}_unstuff_to"):
        changes = f"{changes}, {buffer}"
        made.put_safe(
            f"{prefix}_unstuff_one",
            rf"requires from <= size && {data} && \valid(unstuffed)",
            "assigns *unstuffed",
            r"ensures \result <= size && (\result == 0 || from < \result)",
        )
        made.put_safe(
            f"{prefix}_unstuff_to",
            f"requires 0 < from && from <= size && at <= need && need <= {room}",
            rf"requires \valid(decoder) && {data} && \separated(decoder, data + (0 .. size - 1))",
            f"assigns {buffer}",
            r"ensures \result <= size",
        )
        inside = "invariant 0 < from && from <= size && at <= need"
        made.loops(f"{prefix}_unstuff_to", inside, assigns=[buffer])
    if made.has(f"{prefix}_hand_over"):
        made.put_safe(
            f"{prefix}_hand_over",
            f"{valid} && content == decoder->buffer && payload <= {most}",
            "assigns decoder->offset, decoder->noise",
            r"ensures \result == 0 || \result == wire",
        )
    apart = rf"{data} && size > 0 && \separated(decoder, data + (0 .. size - 1))"
    made.put_safe(
        f"{prefix}_take_whole", f"{valid} && {apart}", changes, r"ensures \result <= size"
    )


def _purify(made: Contracts, function: str) -> None:
    """Contracts for what a function calls that changes nothing but its own variables."""
    for called in dict.fromkeys(_CALL.findall(made.body(function))):
        if called in made.functions or not made.has(called):
            continue
        head = made.body(called).partition("{")[0]
        if "*" in re.sub(r"const \w+ \*|const struct \w+ \*", "", head) or " put" in head:
            continue
        if re.search(r"const uint8_t \*data, size_t size\)", head):
            made.put_safe(
                called, r"requires \valid_read(data + (0 .. size - 1))", r"assigns \nothing"
            )
            _run_contract(made, called)
        else:
            made.put(called, r"assigns \nothing")
            made.loops(called)
        _purify(made, called)


def _run_contract(made: Contracts, run: str) -> None:
    """Bounds of the loops that take a checksum's bytes: words first on hosts, then what is left."""
    made.loops(run, _LEFT)
    lines = made.body(run).splitlines(keepends=True)
    for index, line in enumerate(lines[:-1]):
        if _LEFT in line and "index" in lines[index + 1]:
            bounds = _IN_BLOCK if "index < end" in lines[index + 1] else _IN_WORDS
            lines[index] = line.replace(_LEFT, bounds)
    made.change(run, "".join(lines))


def _is_open(behind: str, local: re.Match[str]) -> bool:
    """Whether the block of a local variable goes on."""
    return not re.search(rf"^ {{0,{len(local[1]) - 1}}}\}}", behind, re.MULTILINE)


def _checked_loops(made: Contracts) -> None:
    """Bounds of what a check adds up."""
    made.source = re.sub(
        r"( +)while \(at < size\) \{\n +at \+= 3U;",
        r"\1//@ loop invariant at <= size + 2 && (at - 8) % 3 == 0; loop assigns at;\n\g<0>",
        made.source,
    )


def _definition(name: str) -> re.Pattern[str]:
    return re.compile(rf"^(?=[a-zA-Z][^;{{}}()\n]*\b{name}\([^;{{}}]*\{{)", re.MULTILINE)


def portable(source: str) -> str:
    """Generated C without SSE2, in which copies of 8 and of 4 bytes are functions.

    These have the contract of `memcpy`, whose casts from one type of number to another are too much
    for WP's memory. Bits that are masked become a quotient, with which Z3 can reckon.
    """
    lines: list[str] = []
    depth, left_out = 0, False
    for line in source.splitlines(keepends=True):
        directive = line.split()[0] if line.startswith("#") else ""
        begins = directive.startswith("#if") and (depth > 0 or line.endswith("_SSE2\n"))
        depth += begins
        left_out = (left_out or begins) and not (depth == 1 and directive == "#else")
        if not left_out and not (depth == 1 and directive in ("#else", "#endif")):
            lines.append(line)
        if depth and directive == "#endif":
            depth -= 1
            left_out = left_out and depth > 0
    source = "".join(lines).replace(" & ~(size_t)7U);", " / 8U * 8U);")
    source = _TO_WORD.sub(r"\1 = read_\3(\2);", source)
    return _FROM_WORD.sub(r"write_\3(\1, \2);", source)


def _predicates(asked: dict[str, str], upper: str) -> str:
    predicates = [
        f"predicate {message}_fits(uint8_t *payload, integer size) = {needed};"
        for message, needed in asked.items()
    ]
    cases = [
        f"(message == {upper}_MESSAGE_{message.upper()} ==> {message}_fits(payload, size))"
        for message in asked
    ]
    holds = "predicate holds(integer message, uint8_t *payload, integer size) =\n        "
    predicates.append(holds + " &&\n        ".join(cases) + ";")
    return "/*@\n" + "".join(f"    {predicate}\n" for predicate in predicates) + "*/\n"
