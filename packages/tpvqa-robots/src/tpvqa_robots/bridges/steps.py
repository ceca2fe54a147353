"""A monitored trial that is gone through a request at a time, and may be paused between them."""

from collections.abc import Sequence
from threading import Event
from typing import TYPE_CHECKING

from tpvqa.drivers import Performer, SteppingTrial
from tpvqa.drivers.early import EARLY, concluded
from tpvqa.drivers.performing import Performed
from tpvqa.events import Ended, TrialState
from tpvqa.events.events import Acted
from tpvqa.events.records import answered_record
from tpvqa.monitors import Ask, Look
from tpvqa.trial import Act, Conclusion, Pending, Wait
from tpvqa.vlm import Answer, Reply
from tpvqa.worlds import Execution, Report
from tpvqa_robots.bridges.jobs import turn

if TYPE_CHECKING:
    from tpvqa import Trial
    from tpvqa.drivers.journal import Listener, Writer

PAUSED = "the trial was paused, and what was seen before counts no longer"


class PausableTrial:
    """A trial somebody else may have the robot of between two of its requests.

    After a pause the robot may be elsewhere. So nothing is done, and nothing asked, about what was
    seen before it: an action that was due is reported as cancelled, questions that were due are
    answered with *unknown*, until the trial has looked.

    Args:
        trial: The trial; it has not been run.
        writer: Where its events go; not closed here.
        patience: Seconds that world and VLM may be busy with something else.
        listeners: Told of every event.

    Attributes:
        pause: Set to stop the skill that is running.
        still: Set but for while a skill runs.
        ended: The last event, once there is one.
    """

    def __init__(
        self,
        trial: "Trial",
        writer: "Writer",
        *,
        patience: float,
        listeners: "Sequence[Listener]" = (),
    ):
        self.pause, self.still = Event(), Event()
        self.still.set()
        self.ended: Ended | None = None
        self._patience = patience
        self._trial, self._writer, self._listeners = trial, writer, listeners
        self._stepping: SteppingTrial | None = None
        self._performer: Performer = trial.performer(writer, cancel=self.pause)
        self._acting = turn("act", trial.world)
        self._seeing, self._answering = turn("see", trial.world), turn("ask", trial.vlm)
        self._stale = False

    @property
    def state(self) -> TrialState:
        """Where the trial stands."""
        return TrialState() if self._stepping is None else self._stepping.state

    def begin(self) -> None:
        """Go to the first request, which may take seconds.

        Raises:
            TpvqaError: The trial has run already, or a plug-in broke.
        """
        stepping: SteppingTrial = self._trial.stepping(self._writer, listeners=self._listeners)
        stepping.begin()
        self._stepping = stepping
        self._end_if_over(stepping)

    def step(self) -> None:
        """Do what is pending, unless paused, and go to the next request, or to the end.

        Raises:
            TpvqaError: A plug-in broke, or returned what it must not.
            TimeoutError: World or VLM was busy with something else.
        """
        stepping = self._stepping
        if stepping is None or stepping.pending is None or self.pause.is_set():
            return
        stepping.begun()
        try:
            stepping.send(self._paused(stepping.pending) or self._perform(stepping.pending))
        except EARLY as error:
            self.end(concluded(error))
        else:
            self._end_if_over(stepping)

    def resume(self) -> None:
        """Go on after a pause; what was pending is over."""
        self._stale = True
        self.pause.clear()

    def end(self, conclusion: Conclusion | None = None) -> None:
        """Write the last event, if there is a first; by default that it was cancelled.

        A second call does nothing.
        """
        if self.ended is None and self._stepping is not None:
            self._stepping.take_over()
            holds, unmet = self._performer.goal_holds(), self._performer.unmet()
            self.ended = self._stepping.end(conclusion, goal_holds=holds, unmet=unmet)

    def _end_if_over(self, stepping: SteppingTrial) -> None:
        if stepping.pending is None:
            self.end(stepping.conclusion)

    def _perform(self, pending: Pending) -> Performed:
        match pending.request:
            case Act() | Wait():
                with self._acting.waited_for(self._patience, "the robot"):
                    self.still.clear()
                    try:
                        return self._performer.perform(pending)
                    finally:
                        self.still.set()
            case Look():
                with self._seeing.waited_for(self._patience, "the camera"):
                    self._stale = False
                    return self._performer.perform(pending)
            case Ask():
                with self._answering.waited_for(self._patience, "the VLM"):
                    return self._performer.perform(pending)
        return self._performer.perform(pending)

    def _paused(self, pending: Pending) -> Performed | None:
        """What came of a request that rests on what was seen before a pause; None of another."""
        if not self._stale:
            return None
        match pending.request:
            case Act():
                self._stale = False  # whoever decides has been told
                refused = Execution(Report.CANCELLED, 0.0, PAUSED)
                acted = Acted(report=refused.report, seconds=0.0, message=PAUSED)
                return Performed(refused, acted)
            case Ask(questions):
                answers = [Answer(each, Reply.UNKNOWN, text=PAUSED) for each in questions]
                return Performed(answers, answered_record(answers, None))
        return None
