"""Annotations in generated C that say where EVA has to look at values one by one.

They are comments: the program stays what a user compiles. `check` reads numbers that say where
the rest of a payload lies, and `load` reads them again. EVA knows that these are the same only
while it follows one value of them at a time, from the place where `check` reads it.
"""

from __future__ import annotations

import re

from c_proof.drivers import limited_in, stateful_in

OPTIONS = ("-eva-split-return=full", "-eva-domains=equality", "-eva-slevel=100000")
"""Ways through a function stay apart, and a number refines the byte that it was read from."""
SMALL = 8
"""Greater numbers are refused by all small payloads, and looked at together."""
_CHECK = re.compile(r"^static enum \w+ \w+_check\([^{]*\{\n(?:.*\n)*?\}\n", re.MULTILINE)
_BEGIN = re.compile(r"(size_t \*need\) \{\n)")
_NUMBER = re.compile(
    r"^( +)const (?:bool|u?int\d+_t) (\w+) =\s([^;]*\bpayload\b[^;]*);\n", re.MULTILINE
)
_BYTE = re.compile(r"(payload\[[^\]]*\])(?: != 0U)?")
_REFUSAL = re.compile(r" +if \([^{}]*\) \{\n +return [^;]*;\n +\}\n")
_ERROR = re.compile(r"^( +)(return \w+_ERROR_\w+;)\n", re.MULTILINE)
"""Ways that end with an error need not stay apart."""
_SEARCH = re.compile(r"^( +)while \(length < size && bytes\[length\] != end\) \{\n", re.MULTILINE)
_POLLED_FEED = re.compile(
    r"^(size_t (\w+)_decoder_feed\([^{]*\{\n(?:.*\n)*?    event->message = (\w+_NO_MESSAGE);\n)"
    r"(    while \(index < size)",
    re.MULTILINE,
)
_PAYLOAD_KNOWN = re.compile(
    r"if \(payload <= (\d+)U\) \{\n( +)decoder->payload = payload;\n(?= +return \w+_complete\()"
)
"""Where a frame's payload has a size, which it keeps while its event is filled."""
_ROOM = re.compile(r"^( +)if \(\(uint8_t\)\(at - 1U\) >= (\d+)U\) \{\n", re.MULTILINE)
"""A place that is neither nought nor behind the buffer, which one comparison tells."""
_SUM = re.compile(
    r"^static \w+ (\w+_run)\(\w+ sum, const uint8_t \*data,\s+size_t size\) \{\n"
    r"(?:.*\n)*?( +)(?=for \(; size > 0U; size--\)|do \{)",
    re.MULTILINE,
)
_CONTRACT = """\
/*@ requires \\valid_read(data + (0 .. size - 1)) && \\initialized(data + (0 .. size - 1));
    assigns \\result \\from sum, data[0 .. size - 1]; */
"""
_FIXED = re.compile(r"payload\[\d+\]")


def annotated(source: str) -> str:
    """Generated C with annotations where payloads are checked and texts end."""
    source = _CHECK.sub(lambda check: _annotated_check(check.group()), source)
    # A range can't leave out a byte in its middle, but those below and above it can do so.
    return _SEARCH.sub(lambda m: m.group() + _split(m[1] + "    ", "bytes[length] < end"), source)


def sums_in(source: str) -> list[str]:
    """The functions that run a checksum over bytes."""
    return [found[1] for found in _SUM.finditer(source)]


def contracted(source: str) -> str:
    """Generated C with what functions of checksums need, which is proved of them alone.

    A pointer and a size meet in them, which EVA knows only while it follows each byte: not at each
    call, for which it looks at their contract.
    """
    return _SUM.sub(lambda found: _CONTRACT + found[0], source)


def followed(source: str, most: int) -> str:
    """The same functions with a comment that has EVA follow so many bytes."""
    return _SUM.sub(lambda found: f"{found[0]}//@ loop unroll {most};\n{found[2]}", source)


def fed(source: str, header: str) -> str:
    """Generated C with annotations where `feed` looks whether an event was filled.

    It is filled, with a payload of that message, just where it has a message; and what `push` has
    found at a frame's end stays apart from decoders that never saw one, as places in a buffer do
    from those in front of it and behind it.
    """

    def splits(found: re.Match[str]) -> str:
        values = ["message"]
        if found[2] in stateful:  # Which message it is tells nothing else, and has any value.
            values = [f"message < {found[3]}", f"message > {found[3]}"]
        values += ["decoder->limit == 0"] * (found[2] in limited)
        splits = "".join(f"    //@ dynamic_split {value};\n" for value in values)
        return f"{found[1]}{splits}{found[4]}"

    limited, stateful = limited_in(header), stateful_in(header)
    source = _PAYLOAD_KNOWN.sub(
        lambda known: known[0] + _split(known[2], f"decoder->payload <= {known[1]}"), source
    )
    source = _ROOM.sub(_annotated_room, source)
    return _POLLED_FEED.sub(splits, source)


def _annotated_room(found: re.Match[str]) -> str:
    splits = (_split(found[1], value) for value in ("at == 0", f"at <= {found[2]}"))
    return "".join([*splits, found.group()])


def _annotated_check(text: str) -> str:
    for number in reversed(list(_NUMBER.finditer(text))):
        at = _behind_bounds(text, number)
        byte, value = _BYTE.fullmatch(number[3]), number[2]
        if byte and at == number.end():  # Then the byte has to be known before it is read.
            at, value = number.start(), byte[1]
        values = _values(text[number.end() :], number[2], value)
        annotations = "".join(_split(number[1], value) for value in values)
        text = text[:at] + annotations + text[at:]
    text = _ERROR.sub(r"\1//@ slevel merge;\n\1\2\n", text)
    return _BEGIN.sub(lambda begin: begin.group() + _split("    ", "size"), text, count=1)


def _behind_bounds(text: str, number: re.Match[str]) -> int:
    """The place behind the bounds of a number, but in front of what depends on its value."""
    at, own = number.end(), re.compile(rf"\b{number[2]}\b")
    stays = bool(_FIXED.fullmatch(number[3]))
    while (refusal := _REFUSAL.match(text, at)) and (stays or own.search(refusal.group())):
        at = refusal.end()
    return at


def _values(text: str, name: str, value: str) -> list[str]:
    """What is looked at one by one: all where something is worked out, cases, or small ones."""
    if re.search(rf"_t\)\(?{name}\b", text):
        return [value]
    switch = re.search(rf"^( +)switch \({name}\) \{{\n(?:.*\n)*?\1\}}\n", text, re.MULTILINE)
    cases = re.findall(r"case (\d+)U:", switch.group()) if switch else ()
    bounds = {int(case) - below for case in cases for below in (0, 1)} or set(range(SMALL + 1))
    return [f"{value} <= {bound}" for bound in sorted(bounds)]


def _split(indent: str, value: str) -> str:
    return f"{indent}//@ split {value};\n{indent};\n"
