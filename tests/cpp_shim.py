"""The C functions that a driver calls, done by the header for C++.

The driver's source is compiled with the names of these functions changed, so that everything it
asks for goes through C++: its tests of C are tests of that header, too.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from c_engine import MACHINES
from program_store import kept
from tooling import require_compiler

from protogen.fuzzing.c_driver import Driver
from protogen.model.protocol import Protocol
from protogen.targets.c.cpp.view import (
    CppDecoder,
    CppForms,
    CppFrame,
    CppMessage,
    cpp_module,
)
from protogen.targets.c.emit import Unit, emit, unit_of
from protogen.targets.c.frame.numbers import ToldView
from protogen.targets.c.options import COptions

WARNINGS = (
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wshadow",
    "-Wold-style-cast",
    "-Werror",
    "-fno-exceptions",
    "-fno-rtti",
)
_HEAD = """#include "{file}.hpp"

#include <cstdlib>
#include <cstring>

/* Events of a buffer that was fed at once, to be asked for one after another. */
template <class Event> struct queue {{
    static constexpr size_t most = 4096;
    Event events[most];
    uint8_t *payloads[most];
    size_t count, next;

    void add(const Event &event) {{
        if (count == most) {{
            std::abort();
        }}
        payloads[count] = static_cast<uint8_t *>(std::malloc(event.payload_size + 1U));
        if (event.payload_size != 0U) {{
            std::memcpy(payloads[count], event.payload, event.payload_size);
        }}
        events[count] = event;
        events[count].payload = payloads[count];
        count++;
    }}

    bool take(Event &event) {{
        if (next != 0U) {{
            std::free(payloads[next - 1U]);
        }}
        if (next == count) {{
            next = count = 0;
            return false;
        }}
        event = events[next++];
        return true;
    }}
}};

/* A decoder as it was at each message that C++ took out of it, to be asked for again in C. */
template <class Decoder> struct replay {{
    static constexpr size_t most = 64;
    Decoder seen[most], last;
    enum {message} messages[most];
    size_t count, next;

    void add(const Decoder &decoder, enum {message} message) {{
        if (count == most) {{
            std::abort();
        }}
        seen[count] = decoder;
        messages[count++] = message;
    }}

    enum {message} start(Decoder &decoder, enum {message} none) {{
        last = decoder;
        return take(decoder, none);
    }}

    enum {message} take(Decoder &decoder, enum {message} none) {{
        if (next == count) {{
            decoder = last;
            next = count = 0;
            return none;
        }}
        decoder = seen[next];
        return messages[next++];
    }}
}};

extern "C" {{
"""


Function = tuple[str, str]
"""A function's name in C, and its text."""


class _Printer:
    def __init__(self, unit: Unit) -> None:
        self.cpp = cpp_module(unit.whole, unit.protocol, unit.names, unit.module, unit.framing)
        self.space, self.name = self.cpp.space, unit.module.name
        self.upper = unit.module.upper
        self.handlers = {
            dispatch.decoder.name: [handler.function for handler in dispatch.handlers]
            for dispatch in unit.framing.dispatches
        }

    def functions(self) -> Iterator[Function]:
        for message in self.cpp.messages:
            yield from self.payload(message)
        for frame in self.cpp.frames:
            yield from self.frames(frame)
        for decoder in self.cpp.decoders:
            yield from self.decoder(decoder)
        for forms in self.cpp.together:
            yield from self.forms(forms)

    def made(self, name: str, given: Sequence[str], call: str) -> Function:
        """A function that fills a buffer."""
        parameters = ", ".join([*given, "uint8_t *to", "size_t capacity", "size_t *size"])
        return (
            name,
            f"""
enum {self.name}_result cpp_{name}({parameters}) {{
    const {self.space}::encoded made = {self.space}::{call};
    if (made) {{
        if (made.data() != to || made.end() - made.begin() != static_cast<long>(made.size())) {{
            std::abort();
        }}
        *size = made.size();
    }}
    return {self.space}::raw(made.why());
}}""",
        )

    def framed(self, name: str, given: Sequence[str], call: str) -> Function:
        """A function that makes a frame."""
        parameters = ", ".join([*given, "uint8_t *to", "size_t capacity"])
        return (
            name,
            f"""
size_t cpp_{name}({parameters}) {{
    const {self.space}::framed made = {self.space}::{call};
    if (!made != (made.size() == 0) || made.data() != to ||
        made.end() - made.begin() != static_cast<long>(made.size())) {{
        std::abort();
    }}
    return made.size();
}}""",
        )

    def payload(self, item: CppMessage) -> Iterator[Function]:
        view, held = item.view, item.view.held
        yield self.made(view.encode, view.parameter, f"encode({self.sent(item)}, {{to, capacity}})")
        taken = "".join(f", {number.type} {number.name}" for number in held)
        given = "".join(f", {number.name}" for number in held)
        message = f"{view.struct} *message, " if view.struct else ""
        parameters = f"{message}const uint8_t *payload, size_t size{taken}"
        own = "" if view.struct else f"{self.space}::{item.name} own;"
        read = "*message" if view.struct else "own"
        yield (
            view.decode,
            f"""
enum {self.name}_result cpp_{view.decode}({parameters}) {{
    {own}
    return {self.space}::raw({self.space}::decode({read}, {{payload, size}}{given}));
}}""",
        )

    def sent(self, item: CppMessage) -> str:
        """The message that is given; one of its own where C has none."""
        return "*message" if item.view.struct else f"{self.space}::{item.name}()"

    def frames(self, frame: CppFrame) -> Iterator[Function]:
        item = frame.item
        given = [*item.view.parameter, *(f"{it.type} {it.name}" for it in item.arguments)]
        parts = "".join(f", {argument.name}" for argument in item.arguments)
        message = f"{self.sent(frame.message)}{parts}"
        call = f"{frame.frame}({message}, {{to, capacity}})"
        yield self.framed(item.called.function, given, call)
        if frame.send:
            name = item.called.send
            parameters = ", ".join([*given, f"{self.name}_put put", "void *user"])
            yield (
                name,
                f"""
enum {self.name}_result cpp_{name}({parameters}) {{
    return {self.space}::raw(
        {self.space}::{frame.send}({message}, [=](uint8_t byte) {{ put(user, byte); }}));
}}""",
            )

    # --- decoders ---------------------------------------------------------------------------------

    def decoder(self, item: CppDecoder) -> Iterator[Function]:
        prefix, calls = item.view.prefix, self.calls(item)
        yield self.dispatch(prefix, calls)
        yield from self.decoding(item, prefix, item.view.gives_more)
        yield from self.told(item.name, prefix, item.view.told_parts)

    def forms(self, item: CppForms) -> Iterator[Function]:
        calls = [call for form in item.forms for call in self.calls(form.decoder)]
        yield self.dispatch(item.view.prefix, calls)
        yield from self.decoding(item, item.view.prefix, True)
        yield from self.told(item.name, item.view.prefix, item.told_parts)

    def decoding(
        self, item: CppDecoder | CppForms, prefix: str, gives_more: bool
    ) -> Iterator[Function]:
        """The functions that take bytes."""
        if not item.polls:
            yield from self.called(item.name, item.event, prefix)
            return
        yield self.fed(item, prefix)
        if gives_more:
            yield from self.replayed(item, prefix)
        else:
            yield from self.polled(item, prefix)

    def calls(self, item: CppDecoder) -> list[str]:
        """A handler for each message, with its parts."""
        parts = f"const {self.space}::{item.parts} &parts"
        return [
            f"[user](const {self.space}::{received.message.name} &message, {parts}) "
            f"{{ (void)message; {handler}(user, {self.passed(received.message)}&parts); }}"
            for received, handler in zip(item.received, self.handlers[item.view.name], strict=True)
        ]

    def passed(self, item: CppMessage) -> str:
        """The message as an argument in front of others, where C has one."""
        return "&message, " if item.view.struct else ""

    def dispatch(self, prefix: str, calls: Sequence[str]) -> Function:
        given = "".join(f",\n        {call}" for call in calls)
        return (
            f"{prefix}_dispatch",
            f"""
void cpp_{prefix}_dispatch(void *user, const struct {prefix}_event *event) {{
    {self.space}::dispatch(*event{given});
}}""",
        )

    def called(self, name: str, event: str, prefix: str) -> Iterator[Function]:
        """The functions of a decoder that calls its handler, which C++ sets for each call."""
        for word, parameters, given in (
            ("push", ", uint8_t byte", "byte, "),
            ("feed", ", const uint8_t *data, size_t size", "{data, size}, "),
            ("flush", "", ""),
        ):
            yield (
                f"{prefix}_decoder_{word}",
                f"""
void cpp_{prefix}_decoder_{word}(struct {prefix}_decoder *decoder{parameters}) {{
    void (*const handler)(void *, const struct {prefix}_event *) = decoder->handler;
    void *const user = decoder->user;
    reinterpret_cast<{self.space}::{name} *>(decoder)->{word}(
        {given}[=](const {self.space}::{event} &event) {{ handler(user, &event); }});
    decoder->handler = handler;
    decoder->user = user;
}}""",
            )

    def polled(self, item: CppDecoder | CppForms, p: str) -> Iterator[Function]:
        """The functions of one that is polled, and has one message at most."""
        event = f"{self.space}::{item.event}"
        start = f"reinterpret_cast<{self.space}::{item.name} *>(decoder)->"
        for word, parameter, given in (("push", ", uint8_t byte", "byte, "), ("flush", "", "")):
            yield (
                f"{p}_decoder_{word}",
                f"""
enum {self.name}_message cpp_{p}_decoder_{word}(struct {p}_decoder *decoder{parameter}) {{
    enum {self.name}_message found = {self.upper}_NO_MESSAGE;
    {start}{word}({given}[&found](const {event} &event) {{ found = event.message; }});
    return found;
}}""",
            )

    def replayed(self, item: CppDecoder | CppForms, p: str) -> Iterator[Function]:
        """Those of one that may have several, of which C++ has taken all."""
        event, seen = f"{self.space}::{item.event}", f"seen_by_{p}"
        kind = f"enum {self.name}_message"
        start = f"reinterpret_cast<{self.space}::{item.name} *>(decoder)->"
        words = (("push", ", uint8_t byte", "byte, "), ("idle", "", ""))
        texts = {
            word: f"""
{kind} cpp_{p}_decoder_{word}(struct {p}_decoder *decoder{parameter}) {{
    {start}{word}(
        {given}[decoder](const {event} &event) {{ {seen}.add(*decoder, event.message); }});
    return {seen}.start(*decoder, {self.upper}_NO_MESSAGE);
}}"""
            for word, parameter, given in words
        }
        yield f"{p}_decoder_push", f"static replay<struct {p}_decoder> {seen};\n{texts['push']}"
        yield f"{p}_decoder_flush", texts["idle"].replace("_decoder_idle(", "_decoder_flush(", 1)
        yield (
            f"{p}_decoder_next",
            f"""
{kind} cpp_{p}_decoder_next(struct {p}_decoder *decoder) {{
    return {seen}.take(*decoder, {self.upper}_NO_MESSAGE);
}}""",
        )

    def fed(self, item: CppDecoder | CppForms, p: str) -> Function:
        """`feed` of one that is polled."""
        event = f"{self.space}::{item.event}"
        start = f"reinterpret_cast<{self.space}::{item.name} *>(decoder)->"
        return (
            f"{p}_decoder_feed",
            f"""
size_t cpp_{p}_decoder_feed(struct {p}_decoder *decoder, const uint8_t *data, size_t size,
                            struct {p}_event *event) {{
    static queue<{event}> found;
    if (found.count == 0U) {{
        {start}feed({{data, size}}, [](const {event} &one) {{ found.add(one); }});
    }}
    if (found.take(*event)) {{
        return 0U;
    }}
    event->message = {self.upper}_NO_MESSAGE;
    return size;
}}""",
        )

    def told(self, name: str, prefix: str, parts: Sequence[ToldView]) -> Iterator[Function]:
        for part in parts:
            type_, call = "bool" if part.is_length else "void", f"tell_{part.member}"
            yield (
                f"{prefix}_decoder_{call}",
                f"""
{type_} cpp_{prefix}_decoder_{call}(struct {prefix}_decoder *decoder, {part.type} value) {{
    return reinterpret_cast<{self.space}::{name} *>(decoder)->{call}(value);
}}""",
            )


def shim_of(unit: Unit) -> tuple[str, tuple[str, ...]]:
    """The source, and the functions of C that it has under names that begin with `cpp_`."""
    functions = tuple(_Printer(unit).functions())
    text = "\n".join(text for _, text in functions)
    file = unit.names.file
    head = _HEAD.format(file=file, message=f"{unit.module.name}_message")
    return f"{head}{text}\n}}\n", tuple(name for name, _ in functions)


def build_over_cpp(protocol: Protocol, options: COptions, standard: str) -> Callable[..., Path]:
    """What compiles a driver for `c_engine.Process`, by way of the header for C++."""

    def build(driver: Driver, folder: Path, command: Sequence[str], *machine: str) -> Path:
        text, functions = shim_of(unit_of(protocol, options))
        (folder / "shim.cc").write_text(text, encoding="utf-8")
        for file in emit([protocol], options):
            if file.path.suffix == ".hpp":
                (folder / file.path.name).write_bytes(file.bytes)
        changed = "".join(f"#define {name} cpp_{name}\n" for name in functions)
        driver.write(folder)
        (folder / "renamed.h").write_text(changed, encoding="utf-8")
        flags = [word for word in command[1:] if word.startswith(("-O", "-f", "--param"))]
        compiler = require_compiler("g++", standard, *flags)
        cpp = [compiler, standard, *WARNINGS, *flags]
        sources = [*sorted(folder.glob("*.*")), *(MACHINES / name for name in machine)]
        sources = [path for path in sources if path.name != "errors"]
        return kept(
            [*command, *cpp], sources, lambda: _linked(driver, folder, command, cpp, machine)
        )

    return build


def _linked(
    driver: Driver, folder: Path, c: Sequence[str], cpp: Sequence[str], machine: Sequence[str]
) -> Path:
    objects = []
    for number, source in enumerate((*driver.sources, "shim.cc", *machine)):
        path = MACHINES / source if source in machine else folder / source
        renaming = ["-include", "renamed.h"] if source == "driver.c" else []
        compiler = cpp if source == "shim.cc" else c
        objects.append(f"{number}.o")
        _run([*compiler, f"-I{folder}", *renaming, "-c", path, "-o", objects[-1]], folder)
    _run([*cpp, "-o", "driver", *objects], folder)
    return folder / "driver"


def _run(command: Sequence[str | Path], folder: Path) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    assert done.returncode == 0, done.stderr
