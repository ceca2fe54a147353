"""A trial one request at a time: for environments, for debugging, and under the other drivers."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from tpvqa.drivers.journal import Journal
from tpvqa.drivers.performing import Performed
from tpvqa.drivers.replaying import Recording
from tpvqa.errors import EpisodeError, TpvqaError
from tpvqa.events import Ended, Event, Resumed, TrialState
from tpvqa.pddl import Literal
from tpvqa.protocols import short
from tpvqa.trial import Conclusion, Pending, Result, Steps, Unwatched
from tpvqa.vlm.usage import Usage

CANCELLED = Conclusion("cancelled")

Restore = Callable[[Mapping[str, Mapping[str, Any]]], bool]
"""Puts "world" and "vlm" back into recorded states; whether the world is as the log left it."""


class SteppingTrial:
    """Goes through a trial from request to request; somebody else does what is pending.

    A trial that is gone on with first plays back what was recorded: what is pending then is the
    first thing that is not in the log.

    Args:
        steps: The trial.
        journal: Where its events go.
        recording: What was recorded of it, if it is gone on with.
        restore: Called once all of that is played back.

    Attributes:
        pending: What is to be done now; None once the trial has come to its end.
        conclusion: How it ended; None before.

    Example:
        >>> def through(trial, performer):
        ...     trial.begin()
        ...     while trial.pending is not None:
        ...         trial.begun()
        ...         trial.send(performer.perform(trial.pending))
        ...     return trial.end(goal_holds=performer.goal_holds(), unmet=performer.unmet())
    """

    def __init__(
        self,
        steps: Steps,
        journal: Journal,
        *,
        recording: Recording | None = None,
        restore: Restore = lambda snapshots: True,
    ):
        self._steps, self.journal, self._restore = steps, journal, restore
        self._recording = recording
        if recording is not None:
            recording.tell(journal.take)
        self._unwatched = self._announced = False
        self.pending: Pending | None = None
        self.conclusion: Conclusion | None = None

    @property
    def state(self) -> TrialState:
        """Where the trial stands."""
        return self.journal.state

    @property
    def replaying(self) -> bool:
        """Whether recorded events are still to be played back."""
        return bool(self._recording)

    def begin(self) -> None:
        """Go to the first thing that is to be done."""
        self._advance(None)

    def begun(self) -> None:
        """Say in the log, before anything happens, that what is pending is being done."""
        if self.pending is not None and self.pending.announced is not None and not self._announced:
            self.journal.write(self.pending.announced)
        self._announced = True

    def send(self, performed: Performed) -> None:
        """Go on with what came of what was pending, to the next thing that is to be done.

        Raises:
            TpvqaError: It is something else, or nothing is pending.
        """
        if not isinstance(performed, Performed):
            raise TpvqaError(
                "A trial goes on with a Performed, as `Performer.perform` gives it, not "
                f"{short(performed)}"
            )
        if self.pending is None:
            raise TpvqaError("Nothing is pending: begin the trial first, or end it.")
        self.begun()
        self.journal.write(performed.event)
        self._advance(Result(performed.value, self.state))

    def end(
        self,
        conclusion: Conclusion | None = None,
        *,
        goal_holds: bool | None = None,
        unmet: Sequence[Literal] = (),
    ) -> Ended:
        """Write the last event.

        Args:
            conclusion: How the trial was ended; by default as it ended itself, or "cancelled".
            goal_holds: Whether the goal holds in truth; None where nobody knows.
            unmet: For want of what it does not; kept in the log where it is believed to hold.

        Raises:
            EpisodeError: The trial is gone on with, and ends before its log does.
        """
        if self._recording:
            raise EpisodeError(
                "the log goes on where this version would end the trial: it cannot be resumed, "
                "only shown"
            )
        self.take_over()
        conclusion = conclusion or self.conclusion or CANCELLED
        state, believes = self.state, conclusion.believes_goal
        usage, started = state.usage, state.started
        prices = None if started is None else started.config.vlm.prices
        cost = None
        if usage is not None and prices is not None:
            cost = Usage.of(usage.model_dump()).cost(*prices)
        ended = Ended(
            because=conclusion.because,
            message=conclusion.message,
            believed_goal=believes,
            goal_holds=goal_holds,
            completed=None if goal_holds is None else goal_holds and believes,
            unmet=tuple(each.pddl() for each in unmet) if believes and unmet else None,
            actions=state.actions,
            questions=state.questions,
            looks=state.looks,
            repeats=state.repeats,
            replans=state.replans,
            usage=usage,
            cost=cost,
        )
        written = self.journal.write(ended)
        assert isinstance(written, Ended)
        return written

    def take_over(self) -> None:
        """Put world and VLM where the log left them, once it has been played back."""
        if self._recording is not None and not self._recording:
            self._unwatched = not self._restore(self._recording.snapshots)
            self._recording = None

    def _advance(self, sent: TrialState | Result | None) -> None:
        self.pending, self._announced, unwatched = None, False, None
        while True:
            try:
                step = self._steps.throw(unwatched) if unwatched else self._steps.send(sent)
            except StopIteration as end:
                self.conclusion = end.value
                return
            sent, unwatched = None, None
            if not isinstance(step, Pending):
                sent = self._say(step)
                continue
            self._announced = False
            try:
                sent = self._replayed(step)
            except Unwatched as error:
                unwatched = error
            else:
                if sent is None:
                    self.pending = step
                    return

    def _say(self, event: Event) -> TrialState:
        """Write an event of the trial, or take the recorded one in its place."""
        if self._recording:
            self._recording.say(event)
        else:
            self.take_over()
            self.journal.write(event)
        return self.state

    def _replayed(self, pending: Pending) -> Result | None:
        """What came of a request, from the record; None where it is to be done now.

        Raises:
            Unwatched: The world may have changed since the log was written.
        """
        announced, record = pending.announced, self._recording
        if record:
            if record.resumed():
                raise Unwatched(self.state)
            if announced is not None:
                record.say(announced)
                self._announced = True
                if record.resumed():
                    raise Unwatched(self.state)
            if record:
                return Result(record.value(pending), self.state)
        self.take_over()
        if self._unwatched:
            self._unwatched = False
            self.journal.write(Resumed())
            raise Unwatched(self.state)
        return None
