"""Captures that several cores decode in parts: the tables of one decoder, wherever they are cut."""

from __future__ import annotations

import io
import os
import runpy
import subprocess
import sys
import threading
from pathlib import Path
from random import Random
from threading import Event, Thread, current_thread, main_thread
from time import sleep
from types import FrameType
from weakref import ref

import handwritten_streams
import pytest
from amounts import OF_TWO_ENGINES, STREAMS_OF_TWO_ENGINES
from capture_support import assert_same_tables
from cli_support import PATIENCE
from compiled import ROOT, SCHEMAS, module_at, name_of, protocol_of
from corpus import joined as pieces_joined
from corpus import marks_of, material_of, stream_of
from hypothesis import given, settings
from hypothesis import strategies as st
from test_recovery import drawn_pieces
from tooling import require_tool

from protogen.capture import batches, columns, gather, parallel
from protogen.capture import memory as lending
from protogen.capture.gather import gathered
from protogen.capture.memory import Blocks, Memory
from protogen.capture.native import NativeEngine, library_of
from protogen.capture.parallel import ROOM, ROWS, Parts
from protogen.native.library import WORDS, Library

RN1 = ROOT / "schemas" / "rn1.yaml"
SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
SENDERS = [
    (path, sender.name) for path in (*SCHEMAS, *SAMPLERS) for sender in protocol_of(path).senders
]
EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), SENDERS, ids=name_of)
SEEDS = range(STREAMS_OF_TWO_ENGINES)


@pytest.fixture(scope="module", autouse=True)
def _has_compiler() -> None:
    require_tool("cc")


def check(
    path: Path, sender: str, data: bytes, part: int, *, budget: int = 1 << 20, room: int = ROOM
) -> None:
    library = library_of(protocol_of(path), protocol_of(path).sender(sender))
    memory = Memory()
    engines = [NativeEngine(library, budget, memory) for _ in range(4)]
    found = gathered(Parts(memoryview(data), engines, part, room).tables(2), len(data), 2)
    whole = NativeEngine(library)
    expected = gathered([*whole.feed(data), *whole.flush()], None, 1)
    assert_same_tables(found, expected)


@EVERY_SENDER
def test_parts_of_noisy_streams_fit_together(path: Path, sender: str) -> None:
    material = material_of(path, sender, greatest=3000)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        stream = stream_of(material, dice, 100).data
        check(path, sender, stream, dice.choice([13, 64, 300, 1000, 5000]))


@EVERY_SENDER
def test_parts_of_telling_bytes_fit_together(path: Path, sender: str) -> None:
    """Delimiters and escapes everywhere: decoders agree late, or never."""
    marks = marks_of(path, sender)
    spec = module_at(path).PROTOCOL.sender(sender)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        data = bytes(dice.choice(marks) for _ in range(dice.randrange(1500)))
        check(path, sender, data, dice.choice([7, 100, 700]))
        data = handwritten_streams.random_stream(spec, dice, 40)
        check(path, sender, data, dice.choice([1, 5, 20]), budget=dice.choice([1, 1 << 20]))


@EVERY_SENDER
@settings(max_examples=OF_TWO_ENGINES)
@given(data=st.data())
def test_parts_of_any_mixture_fit_together(path: Path, sender: str, data: st.DataObject) -> None:
    stream = pieces_joined(data.draw(drawn_pieces(material_of(path, sender)))).data
    part = data.draw(st.integers(1, max(1, len(stream))))
    budget = data.draw(st.sampled_from([1, 300, 1 << 20]))
    check(
        path, sender, stream, part, budget=budget, room=data.draw(st.sampled_from([0, 100, ROOM]))
    )


def parts_of_some_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let readings be in parts whose sizes follow the rows that small streams have."""
    monkeypatch.setattr(parallel, "ROWS", 1000)
    monkeypatch.setattr(parallel, "PARTS", range(40, 3000))
    monkeypatch.setattr(parallel, "_SAMPLE", 500)
    monkeypatch.setattr(parallel, "_REACH", 100)


@EVERY_SENDER
def test_parts_of_sizes_that_follow_the_rows_fit_together(
    path: Path, sender: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stretches without a frame, whose parts may be long, and dense ones take turns."""
    parts_of_some_bytes(monkeypatch)
    material = material_of(path, sender, greatest=300)
    protocol = protocol_of(path)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        data = b""
        for _ in range(10):
            data += bytes(dice.randrange(4000)) + stream_of(material, dice, 40).data
        found = columns(data, protocol, sender, engine="native", workers=2)
        assert_same_tables(found, columns(data, protocol, sender, engine="native"))


def test_parts_are_smaller_where_rows_are_dense(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also behind a stretch that has none."""
    parts_of_some_bytes(monkeypatch)
    sizes: list[int] = []

    class Noting(NativeEngine):
        def run(self, data: memoryview, part: int, end: int) -> int:
            sizes.append(part)
            return super().run(data, part, end)

    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    frame = min(material_of(RN1, "brain").frames, key=len)
    data = bytes(30_000) + frame * 5000
    engines = [Noting(library) for _ in range(4)]
    found = gathered(Parts(memoryview(data), engines).tables(2), len(data), 2)
    assert_same_tables(found, columns(data, protocol_of(RN1), "brain"))
    assert sizes[0] == 2999
    assert max(sizes[-20:]) < 1000


def test_workers_give_what_one_gives(tmp_path: Path) -> None:
    protocol = protocol_of(RN1)
    data = stream_of(material_of(RN1, "brain"), Random(5), 4000).data
    capture = tmp_path / "run.bin"
    capture.write_bytes(data)
    expected = columns(data, protocol, "brain", engine="native")
    for source in (capture, data, io.BytesIO(data)):  # What is not in memory is read by one.
        assert_same_tables(columns(source, protocol, "brain", workers=3), expected)
    parts = list(batches(capture, protocol, "brain", chunk=10_000, workers=3))
    assert len(parts) > 20
    assert_same_tables(gathered(parts, None, 1), expected)
    assert columns(b"", protocol, "brain", workers=2).events == 0


def test_a_reader_that_stops_early_waits_for_nobody() -> None:
    data = stream_of(material_of(RN1, "brain"), Random(5), 2000).data
    reading = batches(data, protocol_of(RN1), "brain", chunk=1000, workers=2)
    assert next(reading).events
    reading.close()


def ended(program: str) -> str:
    """Output of a program that begins to read a capture, and comes to its end."""
    frame = min(material_of(RN1, "brain").frames, key=len)
    before = f"""
from threading import Thread, main_thread
from protogen.capture import batches, columns
data = {frame!r} * 400_000
RN1 = {str(RN1)!r}
"""
    done = subprocess.run(
        [sys.executable, "-c", before + program],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=True,
    )
    assert not done.stderr
    return done.stdout


def test_python_ends_in_the_middle_of_a_reading() -> None:
    program = """
reading = batches(data, RN1, "brain", chunk=1000, workers=2)
print(next(reading).events > 0)
"""
    assert ended(program) == "True\n"


def test_a_reading_goes_on_where_python_begins_no_threads_any_more() -> None:
    """Those that the user began may still be reading while Python waits for them to end."""
    program = """
def read():
    main_thread().join()
    reading = batches(data, RN1, "brain", chunk=100_000, workers=2)
    print(sum(tables.events for tables in reading))
    print(columns(data, RN1, "brain", workers=2).events)

Thread(target=read).start()
"""
    assert ended(program) == "400000\n400000\n"


def test_a_decoder_that_is_at_work_when_python_ends_keeps_its_memory() -> None:
    """As in a thread that Python does not wait for, whose objects it never lets go."""
    program = """
from ctypes import py_object, pythonapi
from protogen.api import load
from protogen.capture.native import NativeEngine, library_of

protocol = load(RN1)
library = library_of(protocol, protocol.sender("brain"))
library.free = print
engine = NativeEngine(library)
pythonapi.Py_IncRef(py_object(engine))
"""
    assert not ended(program)


def test_a_reading_may_be_closed_where_a_thread_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python may come upon it wherever it looks for what nobody refers to."""
    data = stream_of(material_of(RN1, "brain"), Random(5), 2000).data
    reading = batches(data, protocol_of(RN1), "brain", chunk=1000, workers=2)
    assert next(reading).events
    monkeypatch.setattr(Thread, "join", lambda *_: pytest.fail("what is held there is needed here"))
    reading.close()


@pytest.mark.filterwarnings("error")
def test_a_reading_may_be_closed_by_one_of_its_own_threads() -> None:
    """Python finds what nobody refers to wherever it looks for it."""

    class Closing(NativeEngine):
        def run(self, data: memoryview, part: int, end: int) -> int:
            if end >= 3000 and current_thread() is not main_thread():
                waiting.set()
                assert suspended.wait(PATIENCE)
            elif end >= 3000:  # Else all decoders might be taken before the thread comes on.
                assert waiting.wait(PATIENCE)
            return super().run(data, part, end)

        def start(self, offset: int, sequence: int = 0) -> None:
            super().start(offset, sequence)
            if suspended.is_set() and not threads:  # The thread has the lock.
                threads.append(current_thread())
                reading.close()
                closed.set()

    waiting, suspended, closed, threads = Event(), Event(), Event(), []
    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    data = min(material_of(RN1, "brain").frames, key=len) * 5000
    reading = Parts(memoryview(data), [Closing(library) for _ in range(6)], 1000).tables(2)
    assert next(reading).events
    suspended.set()
    assert closed.wait(PATIENCE)
    assert threads[0] is not main_thread()
    for thread in threading.enumerate():
        if thread.name.startswith("protogen-capture"):
            thread.join(PATIENCE)
    assert not list(reading)


@pytest.mark.parametrize("held", [0, 1])
def test_who_takes_the_tables_decodes_as_long_as_there_is_nothing_to_take(held: int) -> None:
    """The only other thread waits, in the first part or in one behind it, until that was seen."""

    class Waiting(NativeEngine):
        def run(self, data: memoryview, part: int, end: int) -> int:
            if current_thread() is main_thread():
                decoded.append(end)
                if len(decoded) == 2:
                    seen.set()
            elif end > held * 1000:
                assert seen.wait(PATIENCE)
            return super().run(data, part, end)

    seen, decoded = Event(), []
    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    data = min(material_of(RN1, "brain").frames, key=len) * 5000
    engines = [Waiting(library) for _ in range(4)]
    found = gathered(Parts(memoryview(data), engines, 1000).tables(2), None, 1)
    assert len(decoded) >= 2
    assert_same_tables(found, columns(data, protocol_of(RN1), "brain"))


def test_pages_of_a_part_are_given_back_also_where_it_has_no_frame(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Else a mapped capture that is all noise would come to be in memory as a whole."""
    places: list[tuple[int, int]] = []
    monkeypatch.setattr(parallel, "forget", lambda _, *place: places.append(place))
    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    frame = min(material_of(RN1, "brain").frames, key=len)
    for data in (bytes(20_500), frame * 5000, bytes(5500) + frame * 2000 + bytes(5000)):
        places.clear()
        for _ in Parts(memoryview(data), [NativeEngine(library) for _ in range(4)], 1000).tables(2):
            behind = max((stop for _, stop in places), default=0)
        assert behind >= len(data) - 5000
        given = {place for start, stop in places for place in range(start, stop)}
        assert given == set(range(len(data)))


def test_memory_is_used_again_when_nobody_looks_at_it() -> None:
    memory, dtype = Memory(), material_dtype()
    first = memory.rows(0, dtype, 1 << 18)
    place = first.ctypes.data
    second = memory.rows(0, dtype, 1 << 18)
    assert second.ctypes.data != place
    view = first[5:]
    del first
    assert memory.rows(0, dtype, 1 << 18).ctypes.data != place
    del view
    assert memory.rows(0, dtype, 1 << 18).ctypes.data == place


@pytest.mark.parametrize("fewer", [0, 1, -1])
def test_memory_that_somebody_looks_at_is_kept_however_python_counts(
    fewer: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Python 3.14 counts one reference fewer than those before it."""
    count = sys.getrefcount
    monkeypatch.setattr(sys, "getrefcount", lambda item: count(item) - fewer)
    memory, dtype = runpy.run_path(lending.__file__)["Memory"](), material_dtype()
    view = memory.rows(0, dtype, 1 << 18)[5:]
    place = view.ctypes.data - 5 * dtype.itemsize
    assert memory.rows(0, dtype, 1 << 18).ctypes.data != place
    del view
    assert memory.rows(0, dtype, 1 << 18).ctypes.data == place


class Scarce(Memory):
    """Memory that is all used, but for one table's."""

    def __init__(self) -> None:
        super().__init__()
        self.left = 1 << 30

    def rows(self, number: int, dtype, count: int):
        self.left -= 1
        if self.left < 0:
            raise MemoryError
        return super().rows(number, dtype, count)


def test_nothing_stays_lent_where_memory_ends() -> None:
    """Else the next rows would be written to where something else is by then."""
    frames = material_of(RN1, "brain").frames
    data = b"".join(frame for frame in frames if len(frame) < 20) * 200
    memory = Scarce()
    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    engine = NativeEngine(library, memory=memory)
    assert list(engine.feed(data))
    memory.left = 1
    with pytest.raises(MemoryError):
        engine.step(data)
    assert memory.left == -1
    words = engine._decoder._tables.tolist()
    assert not any(words[3::WORDS])  # The addresses of what is lent.


def test_rows_that_could_not_be_copied_are_no_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    failed = Event()

    def copy(*_: object) -> None:
        failed.set()
        raise MemoryError

    def each():
        yield from batches(data, protocol_of(RN1), "brain", chunk=len(data))
        assert failed.wait(PATIENCE)
        sleep(0.1)  # Until the copy is over, which says so before.
        yield from batches(b"", protocol_of(RN1), "brain")

    data = min(material_of(RN1, "brain").frames, key=len) * 100_000
    monkeypatch.setattr(gather, "_copy", copy)
    with pytest.raises(MemoryError):
        gathered(each(), None, 1)


class Watched(NativeEngine):
    """A decoder that tells how far off the numbers were that it began with."""

    def __init__(self, seen: list[int]) -> None:
        super().__init__(library_of(protocol_of(RN1), protocol_of(RN1).sender("brain")))
        self._seen = seen

    def renumber(self, more: int) -> None:
        self._seen.append(more)
        super().renumber(more)

    def tell(self, front: NativeEngine) -> None:
        """It is told by `join`: else it depends on the threads whether that sees anything."""

    def join(self, front: NativeEngine) -> bool:
        before = self.place[1]
        found = super().join(front)
        if found:
            self._seen.append(self.place[1] - before)
        return found


def missed(data: bytes, part: int | None) -> list[int]:
    """Errors of the foreseen numbers of parts, whose tables are those of one decoder."""
    seen: list[int] = []
    engines = [Watched(seen) for _ in range(4)]
    found = gathered(Parts(memoryview(data), engines, part).tables(2), len(data), 2)
    assert_same_tables(found, columns(data, protocol_of(RN1), "brain"))
    return seen


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
@pytest.mark.parametrize("goes_on", [False, True])
def test_a_process_that_is_forked_off_waits_for_no_threads(goes_on: bool) -> None:
    """It has none of them: it can end, but not read on."""
    program = """
import os, warnings
from protogen.capture import CaptureError
warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 warns of what is tried here.

def read():
    for _ in batches(data, RN1, "brain", chunk=1000, workers=2):
        child = os.fork()
        if child:
            os.waitpid(child, 0)
        elif GOES_ON:
            continue
        return

try:
    read()
except CaptureError as error:
    print(error)
"""
    said = ended(program.replace("GOES_ON", str(goes_on)))
    assert said == goes_on * "with workers, a capture is read on by the process that began to\n"


@pytest.mark.parametrize("part", [1000, 1001, None], ids=str)
def test_numbers_are_foreseen_where_frames_have_one_size(part: int | None) -> None:
    """Their rows need not be touched again, wherever parts begin inside frames."""
    frame = next(item for item in material_of(RN1, "brain").frames if len(item) == 8)
    seen = missed(frame * (3000 if part else 1_500_000), part)
    assert len(seen) >= 2
    assert not any(seen)


def test_numbers_that_were_not_foreseen_are_mended() -> None:
    frames = material_of(RN1, "brain").frames
    short, long = min(frames, key=len), max(frames, key=len)
    seen = missed(short * 1000 + long * 20 + short * 1000, 1500)
    assert min(seen) < 0 < max(seen)


def test_parts_are_small_where_short_frames_have_long_rows() -> None:
    """Else some megabytes of the capture for each worker would be gigabytes of rows."""
    matty = ROOT / "schemas" / "matty.yaml"
    frame = module_at(matty).encode(module_at(matty).Gps(nmea=""), counter=0)
    library = library_of(protocol_of(matty), protocol_of(matty).sender("esp"))
    memory = Memory()
    engines = [NativeEngine(library, memory=memory) for _ in range(5)]
    found = list(Parts(memoryview(frame * 120_000), engines).tables(2))
    assert sum(tables.events for tables in found) == 120_000
    greatest = max(tables.nbytes for tables in found)
    assert greatest < 1.1 * ROWS < sum(tables.nbytes for tables in found) / 2


def material_dtype():
    import numpy as np

    return np.dtype("u4")


def test_rows_that_were_not_foreseen_get_memory_of_their_own() -> None:
    """A capture that goes on otherwise than it began: of each table there are several blocks."""
    frames = material_of(RN1, "brain").frames
    early = b"".join(frame for frame in frames if len(frame) < 20) * 5
    late = b"".join(frame for frame in frames if len(frame) > 100) * 50
    engine = NativeEngine(library_of(protocol_of(RN1), protocol_of(RN1).sender("brain")))
    pieces = [tables for piece in (early, late, early) for tables in engine.feed(piece)]
    pieces += engine.flush()
    expected = columns(early + late + early, protocol_of(RN1), "brain", engine="python")
    assert_same_tables(gathered(pieces, len(early), 1), expected)


def joined(library: Library, data: memoryview, middle: int, engine: NativeEngine) -> bool:
    """True if the second of two parts joined the first; then their tables are those of one."""
    whole, front = NativeEngine(library), NativeEngine(library)
    expected = gathered([*whole.feed(data), *whole.flush()], None, 1)
    front.start(0)
    front.run(data, middle, middle)
    engine.start(middle, 7)  # Its number is not foreseen.
    engine.tell(front)
    taken = middle + engine.run(data[middle:], len(data) - middle, len(data))
    if engine.is_joined:
        rest = [front.take(), engine.take(), *engine.feed(data[taken:]), *engine.flush()]
        assert_same_tables(gathered(rest, None, 1), expected)
    return engine.is_joined


@EVERY_SENDER
def test_a_part_joins_the_one_in_front_while_it_is_decoded(path: Path, sender: str) -> None:
    """It is told where that one stopped, and numbers on whatever it had found until then."""
    library = library_of(protocol_of(path), protocol_of(path).sender(sender))
    plan = protocol_of(path).sender(sender).plan
    material = material_of(path, sender, greatest=3000)
    found = []
    for seed in SEEDS[:4]:
        data = memoryview(stream_of(material, Random(f"{path.stem} {sender} {seed}"), 800).data)
        found.append(joined(library, data, len(data) // 2, NativeEngine(library)))
    # What begins anywhere meets the frames again, but not where their place alone tells them, or
    # only a silence ends them, of which a capture has one.
    is_told = plan.start_words or plan.end_bytes or plan.checksums
    assert any(found) or not is_told or plan.ends_idle


def test_a_part_that_joined_may_become_full() -> None:
    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    frame = min(material_of(RN1, "brain").frames, key=len)
    data = memoryview(b"\x00" + frame * (600_000 // len(frame)))
    engine = NativeEngine(library, 1 << 20)
    assert joined(library, data, 100_000, engine)
    assert list(engine.feed(data[:400_000]))  # Now rows go into lent memory.
    engine._budget = 1 << 20
    assert joined(library, data, 100_001, engine)


def test_a_part_does_not_join_where_the_one_in_front_found_no_frame() -> None:
    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    frame = min(material_of(RN1, "brain").frames, key=len)
    front, engine = NativeEngine(library), NativeEngine(library)
    front.start(0)
    front.run(memoryview(frame), len(frame), len(frame))
    engine.start(len(frame))
    engine.tell(front)
    engine.run(memoryview(frame), len(frame), 2 * len(frame))
    assert not engine.is_joined
    assert not engine.join(front)


def test_blocks_are_given_back_but_for_some() -> None:
    blocks, dtype = Blocks(), material_dtype()
    used, *others = [blocks.rows(dtype, 1 << 18) for _ in range(4)]
    places = {rows.ctypes.data for rows in others}
    del others
    blocks.trim(3 << 20)
    again = [blocks.rows(dtype, 1 << 18) for _ in range(3)]
    assert len(places & {rows.ctypes.data for rows in again[:2]}) == 2
    assert used.ctypes.data not in {rows.ctypes.data for rows in again}


def test_blocks_are_not_kept_for_whoever_looks_at_them_last() -> None:
    """A list of all tables of a great capture is gone once it is."""
    blocks, dtype = Blocks(), material_dtype()
    views = [blocks.rows(dtype, 1 << 18)[5:] for _ in range(4)]
    bases = [ref(view.base) for view in views]
    unused = blocks.rows(dtype, 1 << 18).ctypes.data
    blocks.trim(3 << 20)
    assert all(base() is not None for base in bases)
    del views
    assert [base() is not None for base in bases].count(True) == 1
    assert blocks.rows(dtype, 1 << 18).ctypes.data == unused


def test_one_block_that_suits_nobody_is_given_back() -> None:
    blocks, dtype = Blocks(), material_dtype()
    base = ref(blocks.rows(dtype, 1 << 18).base)
    blocks.rows(dtype, 1 << 20)
    assert base() is None


def test_blocks_may_be_trimmed_and_asked_for_in_the_middle_of_looking_for_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By Python, which comes upon a reading that is over, and waits for the threads of another."""
    blocks, dtype = Blocks(), material_dtype()
    views = [blocks.rows(dtype, 1 << 18) for _ in range(4)]
    views[1:] = []
    count, asked = sys.getrefcount, []

    def interrupted(item: object) -> int:
        if not asked:
            asked.append(None)
            other = Thread(target=lambda: asked.append(blocks.rows(dtype, 1 << 18)))
            other.start()
            other.join(PATIENCE)
            blocks.trim(0)
        return count(item)

    monkeypatch.setattr(sys, "getrefcount", interrupted)
    views.append(blocks.rows(dtype, 1 << 18))
    views.append(asked[1])
    assert len({view.ctypes.data for view in views}) == 3


def test_no_thread_finds_a_block_before_it_is_used() -> None:
    """Whatever comes between two lines: a tracer here, another thread where there is no GIL."""
    blocks, dtype, found = Blocks(), material_dtype(), []

    def ask() -> None:
        found.append(blocks.rows(dtype, 1 << 18))

    def trace(frame: FrameType, *_: object) -> object:
        if frame.f_code.co_filename != lending.__file__:
            return None
        if blocks._blocks and not found:
            other = Thread(target=ask)
            other.start()
            other.join(PATIENCE)
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        rows = blocks.rows(dtype, 1 << 18)
    finally:
        sys.settrace(before)
    assert found[0].ctypes.data != rows.ctypes.data


def test_what_goes_wrong_in_a_thread_is_raised() -> None:
    class Broken(NativeEngine):
        def run(self, data: memoryview, part: int, end: int) -> int:
            if end > 5000:
                raise MemoryError
            return super().run(data, part, end)

    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    data = min(material_of(RN1, "brain").frames, key=len) * 3000
    parts = Parts(memoryview(data), [Broken(library) for _ in range(4)], 1000)
    with pytest.raises(MemoryError):
        list(parts.tables(2))


def test_nothing_stays_lent_where_a_part_can_not_be_decoded() -> None:
    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    data = min(material_of(RN1, "brain").frames, key=len) * 5000
    engine = NativeEngine(library)
    assert list(engine.feed(data))

    def fail(*_: int) -> int:
        raise MemoryError

    engine._decoder.feed_on = fail  # type: ignore[method-assign]
    with pytest.raises(MemoryError):
        engine.run(memoryview(data), len(data), len(data))
    assert not any(engine._decoder._tables.tolist()[3::WORDS])
