"""Runs a skill."""

from threading import Event
from time import monotonic

from tpvqa.drivers.plugged import called
from tpvqa.pddl import Action
from tpvqa.worlds import Execution, Report, World
from tpvqa_robots.bridges.jobs import Job, turn
from tpvqa_robots.bridges.trees.library import GRACE, Behaviour, Status, reason


class Act(Behaviour):
    """Runs the robot's skill behind an action.

    RUNNING while it runs; SUCCESS where the skill reports that it is done, which is not to say
    that it worked: let a `Check` follow. Where a branch of higher priority takes over, the skill
    is cancelled, and that tick waits for it to stand still. A robot does one thing at a time: what
    begins while another skill of the same world still runs waits for it as long.

    Args:
        name: Of the behaviour.
        world: Whose skill it is.
        action: The ground action.
        deadline: Seconds after which the world stops the skill; None for any time.
        grace: Seconds for a skill that was told to stop to stand still.

    Attributes:
        execution: What came of it last.
    """

    def __init__(
        self,
        name: str,
        world: World,
        action: Action,
        *,
        deadline: float | None = None,
        grace: float = GRACE,
    ):
        super().__init__(name)
        self._world, self._action = world, action
        self._deadline, self._grace = deadline, grace
        self._acting = turn("act", world)
        self.execution: Execution | None = None
        self._job: Job[Execution] | None = None
        self._since = 0.0

    def initialise(self) -> None:
        """Begin the skill as soon as the robot stands still."""
        self._job, self.execution = None, None
        self._since = monotonic()

    def update(self) -> Status:
        """Whether the skill has come to its end."""
        if self._job is None and not self._begun():
            self.feedback_message = "another skill still runs"
            late = monotonic() - self._since > self._grace
            return Status.FAILURE if late else Status.RUNNING
        assert self._job is not None
        if not self._job.over:
            return self._running(self._job)
        try:
            execution = self._job.result()
        except Exception as error:  # noqa: BLE001 — whatever a plug-in raises
            self.feedback_message = reason(error)
            return Status.FAILURE
        self.execution = execution
        said = f": {execution.message}" if execution.message else ""
        self.feedback_message = f"{self._action}: {execution.report}{said}"
        return Status.SUCCESS if execution.report is Report.DONE else Status.FAILURE

    def terminate(self, new_status: Status) -> None:
        """Cancel the skill where another branch takes over, and wait until it stands still."""
        if new_status is not Status.INVALID or self._job is None or self._job.over:
            return
        still = self._job.drop(self._grace)
        was = "stopped" if still else f"told to stop, and still runs after {self._grace:g} s"
        self.feedback_message = f"{self._action}: {was}"

    def shutdown(self) -> None:
        """The same."""
        self.terminate(Status.INVALID)

    def _begun(self) -> bool:
        """Begin the skill; whether the robot was free."""
        if not self._acting.lock.acquire(blocking=False):
            return False
        try:
            self._job = Job(self._execute, self.name)
        except BaseException:
            self._acting.lock.release()
            raise
        return True

    def _execute(self, cancel: Event) -> Execution:
        try:
            limits = {"deadline": self._deadline, "cancel": cancel}
            return called(self._world, "execute", Execution, self._action, **limits)
        finally:
            self._acting.lock.release()

    def _running(self, job: Job[Execution]) -> Status:
        self.feedback_message = f"{self._action}, for {job.seconds:.1f} s"
        if self._deadline is None or job.seconds < self._deadline + self._grace:
            return Status.RUNNING
        job.drop()
        self.feedback_message = f"{self._action}: does not end, though its deadline is over"
        return Status.FAILURE
