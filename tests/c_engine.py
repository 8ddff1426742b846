"""Generated C in a process of its own, under sanitizers, and what Python says to the same."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from functools import cache, cached_property
from itertools import chain, zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any, TypeVar
from weakref import finalize

import c_reference
import pytest
from c_library import FLAGS, held_of
from compiled import protocol_of
from program_store import kept
from tooling import require_compiler

from protogen.copying import replace
from protogen.fuzzing.c_calls import Call, Calls, CEvent, Step
from protogen.fuzzing.c_driver import Driver
from protogen.fuzzing.c_values import Answers
from protogen.fuzzing.trips import same
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol
from protogen.runtime.values import as_dict
from protogen.targets.c.fuzz_driver.driver import driver_of
from protogen.targets.c.options import COptions

MACHINES = Path(__file__).with_name("c_engine_machines")
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
_SHORTCUTS = ("-fuse-ld=gold", "--param=asan-instrumentation-with-call-threshold=0")
"""A quicker linker; and checks of memory that are called, not written out at each access."""

T = TypeVar("T")


def build(driver: Driver, folder: Path, command: Sequence[str | Path], *machine: str) -> Path:
    """Compile a driver with the sources of the machine that it runs on; returns the program."""
    program = folder / "driver"
    sources = [*driver.write(folder), *(MACHINES / name for name in machine)]
    done = subprocess.run(
        [*command, f"-I{folder}", "-o", program, *sources],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return program


def build_once(driver: Driver, folder: Path, command: Sequence[str | Path], *machine: str) -> Path:
    """Result of `build`, unless the same was compiled before, by whichever worker."""
    driver.write(folder)
    sources = [*sorted(folder.glob("*.[ch]")), *(MACHINES / name for name in machine)]
    return kept(command, sources, lambda: build(driver, folder, command, *machine))


@cache
def shortcuts(compiler: str) -> tuple[str, ...]:
    """Options that make the same program in less time, of compilers that are known."""
    with TemporaryDirectory(prefix="protogen-c-") as folder:
        command = [compiler, *SANITIZERS, *_SHORTCUTS, "-x", "c", "-o", f"{folder}/program", "-"]
        done = subprocess.run(command, input=b"int main(void) {}", capture_output=True, check=False)
    return () if done.returncode or done.stderr else _SHORTCUTS


class Process:
    """A driver that takes calls one by one. Fails as soon as a sanitizer has something to say."""

    def __init__(
        self,
        protocol: Protocol,
        options: COptions = COptions(),  # noqa: B008
        flags: Sequence[str] = ("-O0", *SANITIZERS),
        compile: Callable[..., Path] = build,
    ) -> None:
        self.options = options
        self.driver = driver_of(protocol, options)
        self.calls = Calls(self.driver)
        self._folder = TemporaryDirectory(prefix="protogen-c-")
        folder = Path(self._folder.name)
        compiler = require_compiler("cc", *flags)
        command = [compiler, *FLAGS, *flags, *shortcuts(compiler)]
        self._errors = (folder / "errors").open("w+")
        self._process = subprocess.Popen(
            [compile(self.driver, folder, command, "streams.c")],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
        )
        assert self._process.stdout is not None
        self._answers = Answers(self._process.stdout)
        finalize(self, _end, self._process)

    @cached_property
    def module(self) -> ModuleType:
        """Python of what the driver was printed of."""
        return module_of(self.driver.protocol)

    def do(self, call: Call[T]) -> T:
        """Make a call."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(call.request)
            self._process.stdin.flush()
            return call.read(self._answers)
        except (EOFError, BrokenPipeError):
            self._process.wait()
            self._errors.seek(0)
            raise AssertionError(f"{call.request.hex(' ')}: {self._errors.read()}") from None

    def close(self) -> None:
        """End the process, which has to go well: it may have leaked."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        assert self._process.wait() == 0
        self._folder.cleanup()


def _end(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait()


def process_of(path: Path, options: COptions = COptions()) -> Process:  # noqa: B008
    """The driver of a schema, compiled once; where that fails, it fails at once ever after."""
    found = _process_or_error(path, options)
    if isinstance(found, AssertionError):
        raise found
    return found


@cache
def _process_or_error(path: Path, options: COptions) -> Process | AssertionError:
    try:
        return Process(protocol_of(path), options, compile=build_once)
    except AssertionError as error:
        return error


# --- what Python says -----------------------------------------------------------------------------


def python_events(module: Any, sender: str, steps: Iterable[Step]) -> list[list[CEvent]]:
    """The events of each step, as C should have them."""
    decoder = module.Decoder(sender)
    has_forms = len(module.PROTOCOL.forms(sender)) > 1
    found = []
    for step in steps:
        if step[0] == "clear":
            decoder = module.Decoder(sender)
        if step[0] == "tell":
            _tell(module, sender, decoder, step[1])
            found.append([])
            continue
        events = decoder.feed(step[1]) if len(step) == 2 else decoder.flush()
        found.append([_event(event, has_forms=has_forms) for event in events])
    return found


def _tell(module: Any, sender: str, decoder: Any, data: bytes) -> None:
    """Tell Python what the bytes of a step tell C: the number of a part, and its value."""
    parts = [part for spec in module.PROTOCOL.forms(sender) for part in spec.frame.told]
    names = list(dict.fromkeys(part.name for part in parts))
    with suppress(ValueError):  # A length that no frame has, which C does not take either.
        decoder.tell(**{names[data[0]]: int.from_bytes(data[1:], "big")})


def _event(event: Any, *, has_forms: bool = False) -> CEvent:
    if event.kind == "invalid":
        return CEvent(event.kind, event.offset, event.size, event.reason)
    plain = CEvent(
        event.kind, event.offset, event.size, parts=as_dict(event.parts), payload=event.payload
    )
    if has_forms:
        plain = replace(plain, form=event.form)
    if event.kind == "unknown":
        return plain
    return replace(plain, message=event.message.NAME, values=event.message.to_dict())


def comparable(protocol: Protocol, steps: Sequence[Sequence[CEvent]]) -> int | None:
    """Number of Python's events that C has to have, too; None: all of them.

    A number that counts more than its range allows, or less, is a violation that Python keeps. No
    struct of C has room for it, so C refuses the frame, and may find others inside.
    """
    for number, event in enumerate(event for events in steps for event in events):
        if event.kind == "message" and event.payload is not None:
            try:
                message = protocol.message(event.message)
                c_reference.check(message, event.payload, held_of(message, event.values))
            except c_reference.Wrong as wrong:
                if wrong.count:
                    return number
    return None


def messages_of(steps: Sequence[Sequence[CEvent]]) -> list[list[CEvent]]:
    """The events that `--events messages` leaves."""
    return [
        [replace(event, offset=None, size=None) for event in events if event.kind == "message"]
        for events in steps
    ]


def same_events(found: Sequence[CEvent], expected: Sequence[CEvent]) -> bool:
    """True if events are equal, where one NaN is like another."""
    return len(found) == len(expected) and all(
        replace(one, values=None) == replace(other, values=None) and same(one.values, other.values)
        for one, other in zip(found, expected, strict=True)
    )


def check_events(process: Process, module: Any, sender: str, steps: Sequence[Step]) -> None:
    """C gives the events that Python gives, or the messages among them, each in the same step.

    Where messages alone are asked for, Python knows no longer frame than theirs, as C does.
    """
    only_messages = process.options.events == "messages"
    everything = python_events(process.module if only_messages else module, sender, steps)
    count = comparable(process.driver.protocol, everything)
    if count is not None:
        events = list(chain.from_iterable(everything))[:count]
        everything = [events]
    expected = messages_of(everything) if only_messages else everything
    found = process.do(process.calls.events(sender, steps))
    if count is not None:
        found = [list(chain.from_iterable(found))[: len(expected[0])]]
    assert_same_steps(found, expected)


def assert_same_steps(
    found: Sequence[Sequence[CEvent]], expected: Sequence[Sequence[CEvent]]
) -> None:
    """Each step gives the same events, so none comes earlier or later."""
    for number, (one, other) in enumerate(zip(found, expected, strict=True)):
        if not same_events(one, other):
            pytest.fail(f"step {number}: {first_difference(one, other)}", pytrace=False)


def first_difference(found: Sequence[CEvent], expected: Sequence[CEvent]) -> str:
    """The first events that differ."""
    for one, other in zip_longest(found, expected):
        if one is None or other is None or not same_events([one], [other]):
            return f"C has\n{one},\nPython\n{other}"
    raise AssertionError("no events differ")
