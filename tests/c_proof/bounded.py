"""Programs for a bounded model checker that give generated functions every possible input."""

from __future__ import annotations

import re
from dataclasses import dataclass

from c_proof.checked import MACROS, checked
from protogen.model.protocol import Protocol

MORE = 3
"""Bytes more than the greatest payload has: at least an element of each array."""
_HEAD = """#include <stddef.h>
#include <stdint.h>
#include <stdbool.h>
{macros}#define {upper}_FAST_FEED {fast}
{source}
static volatile uint8_t sink;

/* Any value, as no function of these names is there. */
bool nondet_bool(void);
uint8_t nondet_uint8_t(void);
uint16_t nondet_uint16_t(void);
uint32_t nondet_uint32_t(void);
size_t nondet_size_t(void);
"""
_DECODE = re.compile(
    r"enum \w+ (\w+)_decode\( ?(?:struct (\w+) \*message, )?const uint8_t \*payload, "
    r"size_t size((?:, \w+ \w+)*)\);"
)
_GREATEST = re.compile(r"#define (\w+)_PAYLOAD_MAX (\d+)[uU]")
_PAYLOAD = """
static void prove_{prefix}_decode(void) {{
    uint8_t bytes[{room}]; /* Any bytes, of which the payload is the last ones. */
    const size_t size = nondet_size_t();
{held}    {message}
    __ESBMC_assume(size <= {room}U);
    (void){prefix}_decode({given}&bytes[{room}U - size], size{arguments});
}}
"""
_ARRAY = re.compile(r"^    (\w+) (\w+)\[(\d+)\];\n", re.MULTILINE)
_STEP = """
static bool holds(const struct {prefix}_decoder *decoder);
static void {prefix}_run(struct {prefix}_decoder *decoder, bool is_end) {{
    (void)is_end; /* It goes on with one step, again and again. */
    __ESBMC_assert(holds(decoder), "what holds in front of a step");
}}
"""
_STEPS = """{helpers}
static bool holds(const struct {prefix}_decoder *decoder) {{
    if (decoder->count > {buffer}U || decoder->next > decoder->count) {{
        return false;
    }}
    switch (decoder->state) {{
    case {upper}_SEEKING:
        return {seeking};
    case {upper}_FAILED:
        return {failed};
    case {upper}_TAKING:
        return {taking};
    case {upper}_LOST:
        return {lost};
    default:
        return false;
    }}
}}

/* Both ends of a payload are there. */
static void take(void *user, const struct {prefix}_event *event) {{
    (void)user;
    if (event->payload_size > 0U) {{
        sink = event->payload[0];
        sink = event->payload[event->payload_size - 1U];
    }}
{reads}}}

struct {prefix}_decoder nondet_decoder(void);

int main(void) {{
{arrays}    struct {prefix}_decoder decoder = nondet_decoder();
    const uint8_t choice = nondet_uint8_t();
{points}    decoder.handler = take;
    decoder.user = &decoder;
    __ESBMC_assume(holds(&decoder));
    if (choice == 0U) {{
        {prefix}_step(&decoder, nondet_bool());
    }} else if (choice == 1U) {{
        {prefix}_decoder_push(&decoder, nondet_uint8_t());
    }} else if (choice == 2U) {{
        {prefix}_decoder_flush(&decoder);
    }} else if (choice == 3U) {{
        {prefix}_decoder_init(&decoder, take, &decoder);
    }} else {{
        const struct {prefix}_decoder zeros = {{0}};
        decoder = zeros;
    }}
    __ESBMC_assert(holds(&decoder), "what holds behind a step");
    return 0;
}}
"""

_WHOLE = """
static void take(void *user, const struct {prefix}_event *event) {{
    (void)user;
    if (event->payload_size > 0U) {{
        sink = event->payload[0];
        sink = event->payload[event->payload_size - 1U];
    }}
}}

struct {prefix}_decoder nondet_decoder(void);

int main(void) {{
{arrays}    struct {prefix}_decoder decoder = nondet_decoder();
    uint8_t bytes[{room}]; /* Any bytes, of which those that are fed are the last ones. */
    const size_t size = nondet_size_t();
{points}    decoder.handler = take;
    decoder.user = &decoder;
    __ESBMC_assume({prefix}_is_idle(&decoder) && size <= {room}U);
    __ESBMC_assert({prefix}_take_whole(&decoder, &bytes[{room}U - size], size) <= size,
                   "no more is taken than is there");
    return 0;
}}
"""


_ROOM = """
    __ESBMC_assert(goes_on || is_end || decoder->count < {buffer}U, "room for a byte");
"""
_READS = """
/* A frame still has the message that it was found to have. */
static bool reads_{form}(const struct {prefix}_{form}_candidate *candidate) {{
    enum {protocol}_message message;
    return {prefix}_{form}_candidate_read(candidate, &message, NULL, NULL) == {upper}_NO_REASON &&
           message == candidate->message;
}}
"""


@dataclass(frozen=True)
class Between:
    """What holds of a decoder between two of its steps, in each of its states."""

    taking: str
    seeking: str
    failed: str = "true"
    lost: str = "false"
    """Most decoders never are."""
    forms: tuple[str, ...] = ()
    """Those of a decoder of all forms, which has a candidate of each."""


@dataclass(frozen=True)
class Harness:
    """A program that calls generated functions, and the header that it takes."""

    text: str
    header: str


def decode_harness(protocol: Protocol, header: str, source: str, message: str) -> Harness:
    """Every payload that is not much greater than the greatest, for the `decode` of a message."""
    flat = re.sub(r"\s+", " ", header)
    greatest = {name: int(size) for name, size in _GREATEST.findall(flat)}
    prefix = f"{protocol.name}_{message}"
    [(struct, held)] = [found[1:] for found in _DECODE.findall(flat) if found[0] == prefix]
    names = re.findall(r"(\w+) (\w+)", held)
    text = _head(protocol, source) + _PAYLOAD.format(
        prefix=prefix,
        message=f"struct {struct} message;" if struct else "",
        given="&message, " if struct else "",
        room=greatest[prefix.upper()] + MORE,
        held="".join(f"    const {type_} {name} = nondet_{type_}();\n" for type_, name in names),
        arguments="".join(f", {name}" for _, name in names),
    )
    main = f"\nint main(void) {{\n    prove_{prefix}_decode();\n    return 0;\n}}\n"
    return Harness(text + main, header)


def step_harness(
    protocol: Protocol,
    texts: tuple[str, str],
    sender: str,
    between: Between,
    *,
    loads: bool,
) -> Harness:
    """One step of a decoder from any state in which something holds, that holds again behind it.

    It holds of a decoder that was initialised, so it holds after any number of bytes. Messages are
    loaded if asked for, which a proof of `decode` also covers where the payload is as it was
    received. Arrays of the decoder are objects of their own here, so that it is found where an
    access leaves one of them.
    """
    header, source = texts
    prefix, upper = f"{protocol.name}_{sender}", protocol.name.upper()
    changed, arrays = _apart(header, f"{prefix}_decoder")
    points = [f"decoder.{name} = {name};" for _, name, _ in arrays]
    for form in between.forms:
        changed, own = _apart(changed, f"{prefix}_{form}_candidate")
        points.append(f"decoder.form_{form}.buffer = nondet_bool() ? buffer : NULL;")
        points += [f"decoder.form_{form}.{name} = {form}_{name};" for _, name, _ in own]
        arrays += [(type_, f"{form}_{name}", size) for type_, name, size in own]
    given = {
        "helpers": "".join(
            _READS.format(form=form, prefix=prefix, protocol=protocol.name, upper=upper)
            for form in between.forms
        ),
        "reads": f"    {prefix}_dispatch(NULL, event);\n" if loads else "",
        "arrays": "".join(f"    {type_} {name}[{size}];\n" for type_, name, size in arrays),
        "points": "".join(f"    {point}\n" for point in points),
        "buffer": {name: size for _, name, size in arrays}["buffer"],
        "taking": between.taking,
        "seeking": between.seeking,
        "failed": between.failed,
        "lost": between.lost,
    }
    text = _STEPS.format(prefix=prefix, upper=upper, **given)
    stepped = _one_step(source, prefix, _ROOM.format(**given) if between.forms else "")
    return Harness(_head(protocol, stepped) + text, changed)


def whole_harness(protocol: Protocol, header: str, source: str, sender: str) -> Harness:
    """Any bytes, of up to one more than the greatest frame has, for what takes frames whole.

    So `feed` does with what is fed to a decoder between two frames.
    """
    prefix = f"{protocol.name}_{sender}"
    changed, arrays = _apart(header, f"{prefix}_decoder")
    greatest = re.search(rf"#define {prefix.upper()}_FRAME_MAX (\d+)", header)
    assert greatest is not None
    text = _WHOLE.format(
        prefix=prefix,
        arrays="".join(f"    {type_} {name}[{size}];\n" for type_, name, size in arrays),
        points="".join(f"    decoder.{name} = {name};\n" for _, name, _ in arrays),
        room=int(greatest[1]) + 1,
    )
    return Harness(_head(protocol, source, fast=True) + text, changed)


def _apart(header: str, name: str) -> tuple[str, list[tuple[str, str, str]]]:
    """The header with pointers for the arrays of a struct; their types, names and sizes."""
    struct = re.search(rf"^struct {name} \{{\n(?:.*\n)*?\}};\n", header, re.MULTILINE)
    assert struct is not None
    pointers = _ARRAY.sub(r"    \1 *\2;\n", struct.group())
    return header.replace(struct.group(), pointers), _ARRAY.findall(struct.group())


def _one_step(source: str, prefix: str, claim: str) -> str:
    """The loop that reads what is kept does one step; what calls it sees what holds in between."""
    loop = re.compile(
        rf"(static void {prefix}_)run(\((?:.*\n)*?    )while( \(goes_on\) \{{\n(?:.*\n)*?)\}}\n"
    )
    text, count = loop.subn(rf"\1step\2if\3{claim}}}\n{_STEP.format(prefix=prefix)}", source)
    assert count == 1
    return _one_end(text, prefix)


def _one_end(source: str, prefix: str) -> str:
    """The loop that ends what is left does so once: what holds in front of it holds behind it."""
    loop = re.compile(
        rf"(void {prefix}_decoder_flush\((?:.*\n){{1,3}}?    )while( \(decoder->state)"
    )
    return loop.sub(r"\1if\2", source)


def _head(protocol: Protocol, source: str, *, fast: bool = False) -> str:
    given = {"macros": MACROS, "upper": protocol.name.upper(), "fast": int(fast)}
    return _HEAD.format(source=checked(source, protocol.name), **given)
