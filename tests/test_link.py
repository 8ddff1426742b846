"""Links over pseudo-terminals: streams, requests, and what goes wrong."""

from __future__ import annotations

import asyncio
import os
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from pathlib import Path
from threading import Event, Thread
from types import ModuleType
from typing import Any

import pytest
from cli_support import PATIENCE
from link_board import SCHEMA, Answers, Behaviour, Board, flooded, obedient, silent
from link_wire import run_in_virtual_time, wire

import protogen
from protogen.link import (
    LinkClosedError,
    LinkError,
    NoReplyError,
    PortLostError,
    RefusedError,
    connect,
)
from protogen.link.device import SimulatedDevice
from protogen.link.ports.opening import open_port
from protogen.live.codec import kept_module

pytest.importorskip("serialx")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals are of POSIX")


def run(test: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(test, PATIENCE))


@asynccontextmanager
async def wired(rig: ModuleType, behaviour: Behaviour) -> AsyncIterator[tuple[Board, Any]]:
    """A board, and a link to it, over a wire in memory: for tests in virtual time."""
    here, there = wire()
    async with Board(rig, behaviour, there) as board, connect(rig, here, "host") as link:
        yield board, link


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    path = tmp_path_factory.mktemp("link") / "rig.yaml"
    path.write_text(SCHEMA)
    return kept_module(protogen.load(path))


@pytest.fixture
def schema(tmp_path: Path) -> Path:
    path = tmp_path / "rig.yaml"
    path.write_text(SCHEMA)
    return path


async def until(condition: Callable[[], bool]) -> None:
    while not condition():
        await asyncio.sleep(0.005)


class TestStreams:
    def test_messages_of_a_kind_come_as_they_are(self, rig: ModuleType) -> None:
        async def taken() -> None:
            async with (
                Board(rig, obedient(rig)) as board,
                rig.connect(board.port.name, "host") as link,
            ):
                states = link.messages(rig.State)
                both = link.messages(rig.State, rig.Pong)
                board.later(0, rig.encode(rig.State(n=1), counter=3))
                await link.request(rig.Ping(n=9), timeout=PATIENCE)
                board.later(0, rig.encode(rig.State(n=2), counter=4))
                assert [await states.get(PATIENCE), await states.get(PATIENCE)] == [
                    rig.State(n=1),
                    rig.State(n=2),
                ]
                assert {(await both.get(PATIENCE)).NAME for _ in range(3)} == {"state", "pong"}
                assert link.last(rig.State) == rig.State(n=2)
                assert link.last(rig.Value) is None

        run(taken())

    def test_events_have_times_and_show_what_is_no_message(self, rig: ModuleType) -> None:
        async def taken() -> None:
            async with (
                Board(rig, silent) as board,
                rig.connect(board.port.name, "host") as link,
            ):
                events = link.events()
                state = rig.encode(rig.State(n=1), counter=0)
                unknown = rig.PROTOCOL.encode_unknown("board", {"counter": 1, "kind": 99}, b"")
                board.later(0, b"noise" + state + unknown + state[:5])
                heard = [await events.get(PATIENCE) for _ in range(4)]
                kinds = [item.event.kind for item in heard]
                # The last is given up after the silence that the schema says.
                assert kinds == ["invalid", "message", "unknown", "invalid"]
                assert all(item.when > 1_600_000_000 * 10**9 for item in heard)
                assert link.counts.received == {
                    "invalid: noise": 1, "state": 1, "unknown": 1, "invalid: truncated": 1
                }  # fmt: skip

        run(taken())

    def test_a_full_stream_drops_its_oldest_and_counts_them(self, rig: ModuleType) -> None:
        async def flood() -> None:
            async with (
                Board(rig, silent) as board,
                rig.connect(board.port.name, "host") as link,
            ):
                states = link.messages(rig.State, limit=5)
                await flooded(rig, board.port, 20_000)
                await until(lambda: link.last(rig.State) == rig.State(n=19_999))
                assert [state.n for state in await states.take()] == list(range(19_995, 20_000))
                assert states.dropped == 19_995

        run(flood())

    def test_a_stream_that_waits_holds_the_sender_back_and_loses_nothing(
        self, rig: ModuleType
    ) -> None:
        async def flood() -> None:
            async with (
                Board(rig, silent) as board,
                rig.connect(board.port.name, "host") as link,
            ):
                states = link.messages(rig.State, limit=5, overflow="wait")
                writing = asyncio.create_task(flooded(rig, board.port, 20_000))
                await asyncio.sleep(0.2)
                assert not writing.done()
                assert link.counts.received["state"] < 10
                assert [(await anext(states)).n for _ in range(20_000)] == list(range(20_000))
                await writing

        run(flood())

    def test_a_stream_that_is_forgotten_holds_nobody_back(self, rig: ModuleType) -> None:
        async def begun() -> None:
            async with (
                Board(rig, silent) as board,
                rig.connect(board.port.name, "host") as link,
            ):
                board.later(0.05, rig.encode(rig.State(n=0), counter=0))
                async for state in link.messages(rig.State, limit=1, overflow="wait"):
                    assert state.n == 0
                    break
                await flooded(rig, board.port, 5_000)
                await until(lambda: link.last(rig.State) == rig.State(n=4_999))

        run(begun())

    def test_streams_end_with_the_link(self, rig: ModuleType) -> None:
        async def end() -> None:
            before = asyncio.all_tasks()
            async with Board(rig, silent) as board:
                async with rig.connect(board.port.name, "host") as link:
                    states = link.messages(rig.State)
                    taking = asyncio.create_task(anext(states, None))
                    await asyncio.sleep(0.01)
                assert await taking is None
                assert await anext(link.events(), None) is None
                with pytest.raises(LinkClosedError):
                    await link.request(rig.Ping(n=1))
            assert asyncio.all_tasks() == before

        run(end())


class TestRequests:
    def test_a_reply_a_refusal_and_a_value(self, rig: ModuleType) -> None:
        async def ask() -> None:
            async with (
                Board(rig, obedient(rig)) as board,
                rig.connect(board.port.name, "host") as link,
            ):
                assert await link.request(rig.Set(value=512)) == rig.Done(value=512)
                asked = [link.request(rig.Ask(which=n)) for n in (3, 4, 3)]
                assert [reply.value for reply in await asyncio.gather(*asked)] == [-3, -4, -3]
                with pytest.raises(
                    RefusedError, match=r"reset was refused: failed \(code=7\)"
                ) as no:
                    await link.request(rig.Reset())
                assert no.value.refusal == rig.Failed(code=7)
                assert (link.counts.replies, link.counts.refusals) == (4, 1)

        run(ask())

    def test_where_order_decides_a_late_answer_is_not_taken_for_the_next(
        self, rig: ModuleType
    ) -> None:
        def behave(event: Any) -> Answers:
            n = event.message.n
            is_first = n not in seen
            seen.add(n)
            yield 0.3 if is_first and n % 2 else 0.0, rig.encode(rig.Pong(n=n), counter=0)

        seen = set[int]()

        async def order() -> None:
            async with wired(rig, behave) as (_, link):
                pings = [link.request(rig.Ping(n=n)) for n in range(5)]
                assert [pong.n for pong in await asyncio.gather(*pings)] == [0, 1, 2, 3, 4]
                assert (link.counts.retries, link.counts.late) == (2, 2)

        run_in_virtual_time(order())

    def test_more_at_once_than_a_counter_tells_apart(self, rig: ModuleType) -> None:
        async def many() -> None:
            async with (
                Board(rig, obedient(rig)) as board,
                rig.connect(board.port.name, "host") as link,
            ):
                asked = [link.request(rig.Set(value=n), timeout=PATIENCE) for n in range(600)]
                assert [done.value for done in await asyncio.gather(*asked)] == list(range(600))
                assert link.counts.retries == 0

        run(many())

    def test_without_a_reply_it_says_what_came_instead(self, rig: ModuleType) -> None:
        async def unanswered() -> None:
            async with wired(rig, silent) as (board, link):
                with pytest.raises(NoReplyError, match="nothing came at all") as nothing:
                    await link.request(rig.Set(value=1), timeout=0.02, retries=1)
                assert (nothing.value.attempts, nothing.value.timeout) == (2, 0.02)
                assert board.arrived == {"set": 2}
                asked = asyncio.create_task(link.request(rig.Set(value=1), timeout=0.5, retries=0))
                await until(lambda: link.counts.sent["set"] == 3)
                wrong = rig.encode(rig.Done(value=1), counter=99)
                state = rig.encode(rig.State(n=1), counter=0)
                board.later(0, state + wrong + state + b"?" + state)
                with pytest.raises(NoReplyError) as other:
                    await asked
                assert str(other.value) == (
                    "no reply to set, sent once, waited 0.5 s: instead came 3 x state, "
                    "1 x done of another request, 1 x invalid: noise"
                )
                assert link.counts.unanswered == 2

        run_in_virtual_time(unanswered())

    def test_what_the_schema_does_not_say_is_not_waited_for(self, rig: ModuleType) -> None:
        async def ask() -> None:
            async with (
                Board(rig, silent) as board,
                rig.connect(board.port.name, "host") as link,
            ):
                with pytest.raises(LinkError, match="does not say what answers note") as caught:
                    await link.request(rig.Note(text="x"))
                assert "request: note" in str(caught.value.hint)
                await link.send(rig.Note(text="x"), counter=7)
                await until(lambda: board.arrived["note"] == 1)

        run(ask())

    def test_cancelled_it_leaves_nothing(self, rig: ModuleType) -> None:
        async def cancel() -> None:
            async with wired(rig, silent) as (_, link):
                before = asyncio.all_tasks()
                asked = asyncio.create_task(link.request(rig.Ping(n=1), timeout=0.1))
                waiting = asyncio.create_task(link.request(rig.Ping(n=2), timeout=0.1, retries=0))
                await until(lambda: link.counts.sent["ping"] == 1)
                asked.cancel()
                with pytest.raises(asyncio.CancelledError):
                    await asked
                # The one behind it goes on, once no late answer is expected.
                with pytest.raises(NoReplyError):
                    await waiting
                assert asyncio.all_tasks() == before

        run_in_virtual_time(cancel())

    def test_a_refusal_without_a_counter_is_of_the_request_that_waits(self) -> None:
        matty = kept_module(protogen.load(Path(__file__).parents[1] / "schemas" / "matty.yaml"))

        async def refuse() -> None:
            async with (
                await open_port("listen://127.0.0.1:0") as esp,
                matty.connect(esp.name, "pc") as link,
            ):
                asked = asyncio.create_task(link.request(matty.Stop(), timeout=PATIENCE))
                await esp.read()
                await esp.write(matty.encode(matty.Nack(), counter=200))
                with pytest.raises(RefusedError):
                    await asked
                asked = asyncio.create_task(link.request(matty.Stop(), timeout=PATIENCE))
                await esp.read()
                await esp.write(matty.encode(matty.Ack(), counter=1))
                assert await asked == matty.Ack()

        run(refuse())


class TestLibrary:
    @pytest.mark.parametrize(
        ("name", "device", "asked", "parts", "reply"),
        [
            # By the number of the command.
            ("mhz19", "sensor", "get_range", {}, "range_is"),
            ("mhz19", "sensor", "set_range", {"max": 2000}, "done"),
            # By the message that was asked for, and by the number that was acknowledged.
            ("ping", "device", "general_request", {"requested_id": 5}, "protocol_version"),
            ("ping", "device", "set_ping_interval", {"ping_interval": 9}, "ack"),
            # By the number of the servo.
            ("feetech", "servo", "read", {"address": 56, "size": 2, "id": 7}, "status"),
        ],
    )
    def test_a_simulated_device_answers_as_the_schema_says(
        self, name: str, device: str, asked: str, parts: dict[str, Any], reply: str
    ) -> None:
        path = Path(protogen.__file__).parent / "library" / f"{name}.yaml"
        module = kept_module(protogen.load(path))
        kind = module.MESSAGES[asked]
        fields = {key: value for key, value in parts.items() if key in kind.__fields__}
        parts = {key: value for key, value in parts.items() if key not in fields}
        with (
            SimulatedDevice(path, device) as simulated,
            connect(module, simulated.port, "host") as link,
        ):
            answer = link.request(kind(**fields), timeout=PATIENCE, **parts)
            assert type(answer) is module.MESSAGES[reply]
            assert link.counts.retries == 0


class TestPorts:
    def test_a_port_that_is_lost_fails_requests_and_the_link_goes_on(
        self, rig: ModuleType, tmp_path: Path
    ) -> None:
        port, news = tmp_path / "port", list[str]()

        async def lose() -> None:
            board = Board(rig, silent)
            port.symlink_to(board.port.name)
            async with rig.connect(str(port), "host", tell=news.append) as link:
                asked = asyncio.create_task(link.request(rig.Set(value=1), timeout=PATIENCE))
                await until(lambda: board.arrived["set"] == 1)
                port.unlink()  # Soon the port of another test may have the same name.
                await board.close()
                with pytest.raises(PortLostError, match="is gone"):
                    await asked
                with pytest.raises(PortLostError, match="nothing is sent until it is back"):
                    await link.request(rig.Set(value=1))
                async with Board(rig, obedient(rig)) as board:
                    port.symlink_to(board.port.name)
                    await until(lambda: len(news) == 2)
                    assert await link.request(rig.Set(value=2)) == rig.Done(value=2)
                assert link.counts.losses >= 1

        run(lose())

    def test_a_port_that_is_lost_for_good_ends_streams_with_the_error(
        self, rig: ModuleType
    ) -> None:
        async def lose() -> None:
            board = Board(rig, silent)
            async with rig.connect(board.port.name, "host", lasting=False) as link:
                states = link.messages(rig.State)
                await board.port.write(rig.encode(rig.State(n=1), counter=0))
                assert (await states.get(PATIENCE)).n == 1
                await board.close()
                with pytest.raises(PortLostError):
                    await anext(states)
                with pytest.raises(PortLostError):
                    await link.send(rig.Reset())

        run(lose())

    def test_who_is_no_endpoint_or_sends_nothing_is_told(self, rig: ModuleType) -> None:
        async def wrong() -> None:
            with pytest.raises(LinkError, match="rig has no endpoint 'hosts'") as caught:
                connect(rig, "x", "hosts")
            assert caught.value.hint == "there are host, board, viewer"
            alone = ModuleType("alone")
            vars(alone)["PROTOCOL"] = object()
            with pytest.raises(LinkError, match="alone carries a runtime of its own along"):
                connect(alone, "x", "host")
            async with Board(rig, silent) as board:
                async with connect(rig, board.port.name, "viewer") as link:
                    with pytest.raises(LinkError, match="viewer sends nothing"):
                        await link.send(rig.Reset())
                async with connect(rig, board.port.name, "host") as link:
                    with pytest.raises(LinkError, match="the other end sends no reset"):
                        link.messages(rig.Reset)

        run(wrong())


class TestBlocking:
    @pytest.fixture
    def board(self, rig: ModuleType) -> Any:
        """Name of the port of a board in another thread."""
        names, begun, loops = list[str](), Event(), list[Any]()

        async def serve() -> None:
            async with Board(rig, obedient(rig)) as board:
                stop = asyncio.Event()
                names.append(board.port.name)
                loops.append((asyncio.get_running_loop(), stop))
                begun.set()
                for n in range(10_000):
                    if stop.is_set():
                        break
                    board.later(0, rig.encode(rig.State(n=n), counter=0))
                    await asyncio.sleep(0.005)

        thread = Thread(target=lambda: asyncio.run(serve()))
        thread.start()
        assert begun.wait(PATIENCE)
        yield names[0]
        loop, stop = loops[0]
        loop.call_soon_threadsafe(stop.set)
        thread.join(PATIENCE)

    def test_the_same_without_async(self, rig: ModuleType, board: str) -> None:
        with rig.connect(board, "host") as link:
            assert link.request(rig.Set(value=3)) == rig.Done(value=3)
            with pytest.raises(RefusedError):
                link.request(rig.Reset())
            with link.messages(rig.State) as states:
                first = next(states).n
                assert [state.n for state, _ in zip(states, range(5), strict=False)] == list(
                    range(first + 1, first + 6)
                )
            with pytest.raises(TimeoutError):
                link.messages(rig.Pong).get(timeout=0.02)
            assert link.events().get(PATIENCE).event.kind == "message"
            link.send(rig.Note(text="x"))
            last = link.last(rig.State)
            assert last is not None
            assert link.counts.replies == 1
        with pytest.raises(LinkClosedError):
            link.request(rig.Set(value=3))

    def test_a_port_that_can_not_be_opened_is_told(self, rig: ModuleType) -> None:
        with pytest.raises(protogen.link.PortError, match="no such port"), rig.connect("/dev/no"):
            pass


class TestMistakes:
    """What a program gets wrong is told at once, with what would be right."""

    @pytest.mark.parametrize(
        ("options", "problem"),
        [
            ({"bauds": 9600}, "`connect` has no option `bauds`"),
            ({"timeout": 5}, "`connect` has no option `timeout`"),
            ({"baud": "9600"}, "'9600' is no baud rate"),
            ({"baud": -1}, "-1 is no baud rate"),
            ({"silence": -1}, "-1 is no silence"),
        ],
    )
    def test_options(self, rig: ModuleType, options: Any, problem: str) -> None:
        with pytest.raises(LinkError, match=problem) as caught:
            rig.connect("/dev/no_such_port", "host", **options)
        assert caught.value.hint

    def test_calls(self, rig: ModuleType, schema: Path) -> None:
        with SimulatedDevice(schema, "board") as board, rig.connect(board.port, "host") as link:
            calls: list[tuple[Callable[[], Any], str]] = [
                (lambda: link.request(rig.Set(value=1), timeout=0), "0 is no timeout"),
                (lambda: link.request(rig.Set(value=1), timeout=float("nan")), "nan is no timeout"),
                (lambda: link.request(rig.Set(value=1), retries=-1), "-1 is no number of retries"),
                (lambda: link.request({"value": 1}), r"\{'value': 1\} is no message"),
                (lambda: link.send(rig.Reset), "is no message"),
                (lambda: link.messages("state"), "sends no 'state'"),
                (lambda: link.messages(rig.State, overflow="block"), "'block' is no `overflow`"),
                (lambda: link.last(rig.Set), "the other end sends no set"),
            ]
            for call, problem in calls:
                with pytest.raises(LinkError, match=problem) as caught:
                    call()
                assert caught.value.hint, problem
            assert not link.counts.sent

    def test_a_path_is_a_port(self, rig: ModuleType, schema: Path) -> None:
        board = SimulatedDevice(schema, "board")
        with board, rig.connect(Path(board.port), "host") as link:
            assert link.last(rig.State) is None

    def test_a_link_without_async_works_where_a_loop_runs(
        self, rig: ModuleType, schema: Path
    ) -> None:
        """As in a notebook, whose cells run in a loop."""

        async def cell() -> None:
            board = SimulatedDevice(schema, "board")
            with board, rig.connect(board.port, "host") as link:
                link.send(rig.Note(text="hi"))

        asyncio.run(cell())

    def test_bytes_that_are_no_frame_are_not_nothing(self, rig: ModuleType) -> None:
        """As with a wrong baud rate: what came may yet be the beginning of a frame."""

        async def asked() -> None:
            here, there = wire()
            async with (
                Board(rig, silent, there) as board,
                connect(rig, here, "host", silence=None) as link,
            ):
                board.later(0, rig.encode(rig.State(n=1), counter=0)[:3])
                with pytest.raises(NoReplyError, match="no frame in 3 bytes") as caught:
                    await link.request(rig.Set(value=1), timeout=0.3, retries=0)
                assert "baud" in str(caught.value.hint)

        run_in_virtual_time(asked())
