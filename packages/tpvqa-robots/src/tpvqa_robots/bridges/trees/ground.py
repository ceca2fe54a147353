"""Runs a whole monitored trial."""

from threading import Event
from typing import TYPE_CHECKING

from tpvqa.events import Ended
from tpvqa_robots.bridges.jobs import Job
from tpvqa_robots.bridges.steps import PausableTrial
from tpvqa_robots.bridges.trees.library import GRACE, PATIENCE, Behaviour, Status, reason

if TYPE_CHECKING:
    from tpvqa import Trial
    from tpvqa.drivers.journal import Writer


class Ground(Behaviour):
    """A whole monitored trial: it plans, asks and replans until its goal is reached.

    Every tick looks in on one request of the trial, which a thread performs. SUCCESS where it ended
    in the belief that its goal holds, by what the robot knows, in simulated worlds, too; otherwise
    FAILURE. `feedback_message` tells the step of the plan and the latest decision.

    Where a branch of higher priority takes over, the trial is paused: its skill is cancelled, and
    that tick waits for it to stand still. Begun again, it goes on, and does nothing before it has
    looked anew. One that has ended stays so: FAILURE, as nobody looks whether its goal still holds.
    So does one that broke; its log can be gone on with by `tpvqa resume`.

    Args:
        name: Of the behaviour.
        trial: The trial, which has not been run; not closed here.
        writer: Where its events go, as `tpvqa.episodes.EpisodeWriter`; not closed here.
        grace: Seconds for a skill that was told to stop to stand still.
        patience: Seconds that world and VLM, where other behaviours have them, too, may be busy.

    Attributes:
        ended: The last event; None before it.
    """

    def __init__(
        self,
        name: str,
        trial: "Trial",
        writer: "Writer",
        *,
        grace: float = GRACE,
        patience: float = PATIENCE,
    ):
        super().__init__(name)
        self._given, self._grace, self._patience = (trial, writer), grace, patience
        self._trial: PausableTrial | None = None
        self._job: Job[None] | None = None
        self._broke = ""

    @property
    def ended(self) -> Ended | None:
        """The last event of the trial."""
        return None if self._trial is None else self._trial.ended

    def initialise(self) -> None:
        """Begin the trial, or go on with it after a pause."""
        if self._trial is None:
            self._trial = PausableTrial(*self._given, patience=self._patience)
            self._job = Job(self._begin, self.name, self._trial.pause)

    def update(self) -> Status:
        """See to the trial's next request, where the last one is over."""
        trial, job = self._trial, self._job
        assert trial is not None
        if job is None:  # it has come to its end before
            return self._over(trial)
        if not job.over:
            self._tell(trial)
            return Status.RUNNING
        self._job = None
        try:
            job.result()
        except Exception as error:  # noqa: BLE001 — whatever a plug-in raises
            self._broke = reason(error)
            return self._over(trial)
        self._tell(trial)
        paused = trial.pause.is_set()
        if trial.ended is None:
            if paused:
                trial.resume()
            self._job = Job(self._step, self.name, trial.pause)
            return Status.RUNNING
        if paused:
            return self._over(trial)
        believed = trial.ended.believed_goal
        self.feedback_message = f"{trial.ended.because}: {trial.ended.message}".rstrip(": ")
        return Status.SUCCESS if believed else Status.FAILURE

    def terminate(self, new_status: Status) -> None:
        """Pause the trial where another branch takes over."""
        trial, job = self._trial, self._job
        if new_status is not Status.INVALID or trial is None or job is None:
            return
        trial.pause.set()
        if not trial.still.wait(self._grace):
            self.feedback_message = f"told to stop, and still moves after {self._grace:g} s"
        else:
            self.feedback_message = "paused"

    def shutdown(self) -> None:
        """End the trial, which can be gone on with: `tpvqa resume`."""
        trial, job = self._trial, self._job
        self.terminate(Status.INVALID)
        if trial is not None and not self._broke and (job is None or job.drop(self._grace)):
            trial.end()

    def _begin(self, _: Event) -> None:
        assert self._trial is not None
        self._trial.begin()

    def _step(self, _: Event) -> None:
        assert self._trial is not None
        self._trial.step()

    def _over(self, trial: PausableTrial) -> Status:
        ended = "" if trial.ended is None else f"the trial has ended ({trial.ended.because})"
        self.feedback_message = self._broke or f"{ended}; make another Ground to run it again"
        return Status.FAILURE

    def _tell(self, trial: PausableTrial) -> None:
        state = trial.state
        if state.plan is None:
            self.feedback_message = "planning"
            return
        steps, action = len(state.plan.plan), state.action
        said = "at its end" if action is None else f"step {state.index + 1}: {action.said}"
        decided = state.decided
        course = f"; {decided.when}: {decided.course}, {decided.reason}" if decided else ""
        self.feedback_message = f"plan of {steps}, {said}{course}"
