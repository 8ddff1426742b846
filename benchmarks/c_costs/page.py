"""The page of results."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from itertools import chain

from c_costs.cycles import FRAMES
from c_costs.host_tables import (
    FED,
    fed_fast,
    feed_table,
    misses,
    recovery_table,
    speed_table,
    time_ratios,
)
from c_costs.measure import OPENED, Results
from c_costs.nanopb import NANOPB, nanopb_version
from c_costs.protocols import KINDS, PROTOCOLS
from c_costs.tables import (
    BYTE,
    TARGET,
    bytes_table,
    cycles_table,
    memory_table,
    ratios,
    rover_line,
    slow_bytes,
)
from c_costs.toolchains import ARM, AVR, HOST, ORDINARY
from protogen.version import VERSION


def page(results: Results, rounds: int, seeds: int) -> str:
    return PAGE.format(
        nanopb=nanopb_version(),
        carrier=f"`{NANOPB}`",
        rounds=rounds,
        fed=FED,
        seeds=seeds,
        versions=versions(),
        avr=memory_table(results.avr),
        arm=memory_table(results.arm),
        avr_cycles=cycles_table(results.avr_cycles),
        arm_cycles=cycles_table(results.arm_cycles),
        unicorn=version("unicorn"),
        per_byte=bytes_table(results),
        rover=rover_line(results),
        slow=slow_bytes(results),
        byte=BYTE,
        push=speed_table(results, "push"),
        feed=feed_table(results),
        fast=fed_fast(results),
        encode=speed_table(results, "encode"),
        recovery=recovery_table(results),
        misses=misses(chain(ratios(results), time_ratios(results))),
        flash_spenders=spenders_text(results.spenders, ",.0f"),
        cycle_spenders=spenders_text(results.cycle_spenders, ".1f"),
        frames=FRAMES,
        target=TARGET,
        pieces=100,
    )


PAGE = """\
# What generated C costs

<!-- Written by benchmarks/bench_c.py, do not edit. -->

Made by `python benchmarks/bench_c.py --rounds {rounds} --seeds {seeds}`.

{versions}

These programs send and receive the same messages:

* protogen with `--only` these messages, once with `--events messages` and once with all events.
* protogen in one source is the first of these, included into the application with `NAME_API` as
  `static inline` and `NAME_APART` as `static`.
* The expert is C by hand in [c/expert](c/expert/expert_atrv.c), specialised to these messages, with
  the same checks: no heap, bounded, ranges checked before anything is written, resynchronisation.
  Its frames are compared with protogen's, byte for byte, before anything is measured. It returns
  from `push` which message is complete, and needs no handler. Nor do protogen's decoders with
  `--events messages`, which are measured with their own interface: `push`, `next` and `feed` return
  what is complete. Those with all events call a handler.
* The inlined expert is the same text, included into the application and `static inline`: what a
  library of headers alone is, and about what `-flto` makes of the other.
* MAVLink C is mavgen's, version 2 of the wire, from the dialects in [c/mavlink](c/mavlink/rn1.xml),
  with `MAVLINK_MAX_PAYLOAD_LEN` as small as the messages allow and one channel. It has other bytes
  on the wire: 12 more for each frame. A lidar turn does not fit its payload and goes out in four.
* nanopb {nanopb}, of 2016, as the npm package {carrier} carries it: nanopb's own packages
  on PyPI have no C sources (0.3.9.8, 0.4.0, 0.4.7 and 0.4.9.1 were looked at). Its messages are in
  [c/nanopb](c/nanopb/messages.proto), the tables by hand as its generator makes them. It frames
  nothing: a payload is handed over with the number of its message. No start, length, checksum or
  resynchronisation is in its figures, nor the buffer for a frame.
* The expert with SSE2 takes messages out of whole buffers, 16 bytes at a time: delimiters by
  `movemask`, runs between escapes as they are, checksums and numbers in vectors. Out of clean and
  noisy streams, whole and in pieces of 1, 17 and 1,000 bytes, it takes the very messages that the
  expert takes byte by byte, and so do both programs of protogen; that is tried before the timings.

All five documents are here, three of them with what MAVLink and nanopb have messages for, too; and
three protocols that show other framings and checksums: `rover` of the [README](../README.md) (COBS,
CRC-16/KERMIT), [probe](c/probe.yaml) (a synchronisation word, a length, CRC-32; a false start is
given up and its bytes are read again), and [tether](c/tether.yaml) (HDLC, CRC-16/X-25). For
checksums the expert takes what is best on the machine: `_crc_ccitt_update` of avr-libc, two tables
of 16 for CRC-32 on the ATmega, one on the Cortex-M0.

rflex's sonar_data has room for the 17 sonars of an ATRV-Jr here ([c/atrv.yaml](c/atrv.yaml)), in
every program. Which of dagny's commands is sent varies while its programs run, and one function
encodes them all, which is given the identity. The aim, with `--events messages`, is {target} times
the expert's at most in the same ordinary build and on this machine, and no more than the expert's
with `-flto`. In parentheses are ratios to that expert, which are held against the aim as they are
printed.

## Where the aim is missed

{misses}

{fast}

## Flash and RAM

Bytes of a linked program that decodes and encodes, with decoder and framing, less an empty one. An
ordinary build is `-Os -ffunction-sections -fdata-sections` and `--gc-sections`; the other has
`-flto` as well, and there `NAME_APART` is `static`, as a generated source tells its user to define
it. RAM is what stands there all the time (`.data` and `.bss`): the decoder, and the addresses of
handler and user where it has them. Messages belong to the application and are not counted. The
lidar is sent byte by byte on these machines. The last program has three links: protogen and the
expert have a decoder for each protocol, MAVLink one dialect with three channels.

### ATmega328P

{avr}

### Cortex-M0

{arm}

## Cycles on an ATmega328P

The programs above in simavr: pushing all bytes of a frame and decoding its message into a struct,
less the harness's loop, and encoding it again. Medians of {frames} frames of random values. nanopb
decodes a payload that lies in memory, of other bytes than a frame's; bytes are those of protogen's
frame.

{avr_cycles}

### Decoding, for each byte

{rover}
{slow}

{per_byte}

## Cycles on a Cortex-M0

The same programs in Unicorn {unicorn}, with the cycles of each instruction as Arm's manual has them
(DDI 0432C, 3.3): memory without wait states, and the fast multiplier.

{arm_cycles}

## This machine

`-O2`, one core, a clean stream of frames of random values, messages decoded into a struct. Medians
of {rounds} rounds; in each round every program has its turn. The ratio is that to the expert, in
time for a frame: less is faster. It is the median of the rounds' ratios, which need not be the
ratio of the medians.

### push, byte by byte

{push}

### feed, a whole buffer

The aim for protogen is {fed:,} MB/s and half the speed of the expert with SSE2: the last column is
the time of protogen with `NAME_SSE2`, which is `--events messages` too, to twice that expert's.

{feed}

### Encoding a frame

{encode}

## Frames found in noisy streams

{seeds} streams of {pieces} pieces as in [resync.md](resync.md): frames, damaged frames and noise.
Found are undamaged frames behind whose last byte the message was delivered. MAVLink C of rn1 has
gyro frames only. Frames of dagny and rover have an end and no start of their own: one that stands
right behind noise is a part of that. Of probe, a frame inside of what looks like the start of
another is delivered later, when that was given up, and not counted here.

{recovery}

## What the flash is spent on

The largest functions on the ATmega328P by `avr-nm`, in bytes, without link-time optimisation and
with nothing inlined, so that each function shows. They add up to more than the table above.

{flash_spenders}

## What the cycles are spent on

Cycles for one byte in each function of the same programs while frames of the first message are
decoded, in simavr. Calls cost more here than above, where they are inlined.

{cycle_spenders}
"""


def versions() -> str:
    compilers = (AVR[ORDINARY], ARM[ORDINARY], HOST)
    return (
        f"protogen {VERSION}, pymavlink {version('pymavlink')} on Python "
        f"{platform.python_version()}; {', '.join(item.version() for item in compilers)}. "
        f"{os.cpu_count()} CPUs."
    )


def spenders_text(found: Mapping[tuple[str, str], Sequence[tuple[str, float]]], form: str) -> str:
    lines = []
    for protocol in PROTOCOLS:
        lines += [f"* {protocol.title}"]
        for kind in OPENED:
            items = [f"`{name}` {size:{form}}" for name, size in found[kind, protocol.name]]
            lines += [f"  * {KINDS[kind]}: {', '.join(items)}"]
    return "\n".join(lines)
