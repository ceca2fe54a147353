"""A trial as an asynchronous iterator of its events: for robots, servers and pages."""

import asyncio
from collections.abc import AsyncIterator
from typing import Self

from tpvqa.drivers.early import EARLY, concluded
from tpvqa.drivers.performing import Performed, Performer
from tpvqa.drivers.stepping import SteppingTrial
from tpvqa.errors import TpvqaError
from tpvqa.events import Event
from tpvqa.observation import Observation
from tpvqa.trial import Act, Conclusion


class AsynchronousTrial:
    """Runs a trial beside other tasks. What it wants done is done in threads.

    While an action runs a look can be taken, so that what must hold all the time can be seen to.
    Use it as an asynchronous context manager: whoever leaves it has stopped the trial. What is
    under way is cancelled and waited for, and the log is ended; it can be gone on with.

    Args:
        trial: The trial; not begun yet.
        performer: Does what is wanted. Its `cancel` ends the trial early.

    Example:
        >>> async def watch(trial, writer):
        ...     async with trial.asynchronous(writer) as running:
        ...         async for event in running.events():
        ...             print(event.kind)
    """

    def __init__(self, trial: SteppingTrial, performer: Performer):
        self._trial, self._performer = trial, performer
        self._events: asyncio.Queue[Event | None] = asyncio.Queue()
        self._seeing = asyncio.Lock()
        self._running: asyncio.Task[None] | None = None
        trial.journal.listen(self._events.put_nowait)

    async def events(self) -> AsyncIterator[Event]:
        """Run the trial, and tell its events as they happen, recorded ones first.

        Raises:
            TpvqaError: A plug-in broke, or the trial has been run already.
        """
        if self._running is not None:
            raise TpvqaError("This trial has run already. Make another Trial to run it again.")
        self._running = asyncio.create_task(self._run())
        self._running.add_done_callback(lambda _: self._events.put_nowait(None))
        try:
            while (event := await self._events.get()) is not None:
                yield event
            await self._running
        finally:
            await self.stop()

    async def stop(self) -> None:
        """Cancel what is under way, and wait for the trial's end."""
        self._performer.cancel.set()
        if self._running is not None and not self._running.done():
            await asyncio.wait([self._running])

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.stop()

    async def look(self, view: str | None = None) -> Observation | None:
        """Look while an action runs; None where none is running (any more).

        Raises:
            TpvqaError: The world broke.
        """
        return await asyncio.shield(asyncio.ensure_future(self._look(view)))

    async def _look(self, view: str | None) -> Observation | None:
        async with self._seeing:
            if not self.acting:
                return None
            number = self._trial.state.looks
            seen = await asyncio.to_thread(self._performer.look, view, number, during=True)
            self._trial.journal.write(seen.event)
        observation: Observation = seen.value
        return observation

    @property
    def acting(self) -> bool:
        """Whether an action is running."""
        pending = self._trial.pending
        return pending is not None and isinstance(pending.request, Act)

    async def _run(self) -> None:
        trial, performer, stopped = self._trial, self._performer, False
        loop = asyncio.get_running_loop()
        conclusion: Conclusion | None = None
        trial.begin()
        while trial.pending is not None and not performer.cancel.is_set():
            trial.begun()
            # no task, which a loop that shuts down would cancel while its thread goes on
            doing = loop.run_in_executor(None, performer.perform, trial.pending)
            try:
                performed: Performed = await asyncio.shield(doing)
            except asyncio.CancelledError:  # the loop is shut down: the robot is not left acting
                performer.cancel.set()
                performed, stopped = await doing, True
            except EARLY as error:
                conclusion = concluded(error)
                break
            async with self._seeing:  # a look that began while an action ran comes before its end
                trial.send(performed)
        trial.take_over()
        trial.end(conclusion, goal_holds=performer.goal_holds(), unmet=performer.unmet())
        if stopped:
            raise asyncio.CancelledError
