"""An event loop in a thread of its own, for programs without one, or with another one."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from contextlib import suppress
from threading import Thread
from typing import Any, TypeVar

from protogen.link.errors import LinkClosedError

ResultT = TypeVar("ResultT")


class LoopThread:
    """An event loop in a thread, which other threads ask to do something."""

    def __init__(self, name: str) -> None:
        """`name` is that of the thread."""
        self._name = name
        self._loop = asyncio.new_event_loop()
        self._thread = Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def do(self, work: Coroutine[Any, Any, ResultT], timeout: float | None = None) -> ResultT:
        """Wait for the result of some work. Interrupted, the work is cancelled.

        Raises TimeoutError after `timeout` seconds, and LinkClosedError once the loop is closed.
        """
        try:
            future = asyncio.run_coroutine_threadsafe(work, self._loop)
        except RuntimeError:
            work.close()
            raise LinkClosedError(f"the {self._name} is closed") from None
        try:
            return future.result(timeout)
        except BaseException:
            future.cancel()
            raise

    def call(self, work: Callable[[], None]) -> None:
        """Have something done soon, if the loop has not ended."""
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(work)

    def begin(self, work: Coroutine[Any, Any, ResultT]) -> asyncio.Task[ResultT]:
        """Begin some work that goes on by itself; `end` ends it."""

        async def begun() -> asyncio.Task[ResultT]:
            return asyncio.create_task(work)

        return self.do(begun())

    def end(self, task: asyncio.Task[Any], timeout: float) -> None:
        """Cancel some work, and wait until it has cleaned up. Raises what ended it before."""

        async def ended() -> None:
            task.cancel()
            await asyncio.wait({task})

        self.do(ended(), timeout)
        if not task.cancelled():
            task.result()

    def close(self) -> None:
        """End the thread. Does nothing where it has ended."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join()

    def _run(self) -> None:
        # All of it here: the thread that closes it may have a running loop of its own.
        try:
            self._loop.run_forever()
            self._loop.run_until_complete(self._loop.shutdown_asyncgens())
        finally:
            self._loop.close()
