"""A trial as an asynchronous iterator of its events: for robots, servers and pages."""

import asyncio
from collections.abc import AsyncIterator

from tpvqa.drivers.live import CANCELLED
from tpvqa.drivers.performing import Performed, Performer
from tpvqa.drivers.stepping import SteppingTrial
from tpvqa.errors import TpvqaError
from tpvqa.events import Event
from tpvqa.observation import Observation
from tpvqa.trial import Act
from tpvqa.worlds.goal import goal_holds


class AsynchronousTrial:
    """Runs a trial beside other tasks. What it wants done is done in threads.

    While an action runs a look can be taken, so that what must hold all the time can be seen to.

    Args:
        trial: The trial; not begun yet.
        performer: Does what is wanted. Its `cancel` ends the trial early.

    Example:
        >>> async def watch(trial):
        ...     async for event in trial.events():
        ...         print(event.kind)
    """

    def __init__(self, trial: SteppingTrial, performer: Performer):
        self._trial, self._performer = trial, performer
        self._events: asyncio.Queue[Event | None] = asyncio.Queue()
        self._seeing = asyncio.Lock()
        trial.journal.listen(self._events.put_nowait)

    async def events(self) -> AsyncIterator[Event]:
        """Run the trial, and tell its events as they happen.

        Whoever stops listening stops the trial: what is under way is cancelled and waited for.

        Raises:
            TpvqaError: A plug-in broke.
        """
        running = asyncio.create_task(self._run())
        running.add_done_callback(lambda _: self._events.put_nowait(None))
        try:
            while (event := await self._events.get()) is not None:
                yield event
            await running
        finally:
            if not running.done():
                self._performer.cancel.set()
                await asyncio.shield(running)

    async def look(self, view: str | None = None) -> Observation:
        """Look while an action runs.

        Raises:
            TpvqaError: No action is running, or the world broke.
        """
        async with self._seeing:
            if not self.acting:
                raise TpvqaError("No action is running: the monitor decides when to look.")
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
        trial, performer = self._trial, self._performer
        trial.begin()
        while trial.pending is not None and not performer.cancel.is_set():
            performed: Performed = await asyncio.to_thread(performer.perform, trial.pending)
            async with self._seeing:  # a look that began while an action ran comes before its end
                trial.send(performed)
        trial.take_over()
        goal = goal_holds(performer.parts.world, performer.parts.task.goal)
        trial.end(trial.conclusion or CANCELLED, goal_holds=goal)
