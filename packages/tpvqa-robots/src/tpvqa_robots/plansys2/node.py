"""A performer as a node of ROS 2, on PlanSys2's topics."""

import queue
from collections.abc import Callable
from threading import Event
from time import monotonic
from typing import Any

from tpvqa import Trial
from tpvqa.errors import PDDLError, TpvqaError
from tpvqa.pddl import Action, Task
from tpvqa_robots.interfaces.building import HERE
from tpvqa_robots.plansys2.grounded import Grounded
from tpvqa_robots.plansys2.hub import Kind, Performer, Said, Work
from tpvqa_robots.ros2.link import Link, said
from tpvqa_robots.ros2.typed import stamped

HUB, STATUS = "actions_hub", "performers_status"
BEAT = 1.0
"""Seconds between two signs of life, as PlanSys2's own performers give them."""
TICK = 0.2
"""Seconds between two looks at whether it is to end."""


class PerformerNode:
    """Does the actions of a task for PlanSys2, one at a time, in the thread of `run`.

    Args:
        trial: Gives task, questions, world and VLM; it is not run.
        name: Of the node, and of the performer.
        say: Told in words what happens.

    Raises:
        MissingExtraError: ROS 2 is not installed.
        TpvqaError: The messages are not built.
    """

    def __init__(self, trial: Trial, *, name: str = "tpvqa", say: Callable[[str], None] = print):
        self._link = Link(name)
        try:
            from plansys2_msgs.msg import ActionExecution, ActionPerformerStatus
        except ImportError as error:
            self._link.close()
            raise TpvqaError(
                "A performer needs the ROS 2 package plansys2_msgs: PlanSys2's own, or, where that "
                f"is not installed, what tpvqa build-interfaces builds of it ({HERE})."
            ) from error
        self._task: Task = trial.task
        self._grounded, self._told = Grounded(trial), say
        self._kind: Callable[..., Any] = ActionExecution
        self._status_kind: Any = ActionPerformerStatus
        self._works: queue.Queue[Work] = queue.Queue()
        self._over, self._about = Event(), ""
        self._performer = Performer(name, self._can, self._works.put, self._say, monotonic)
        self._hub = self._link.speaker(ActionExecution, HUB, said(100))
        self._statuses = self._link.speaker(ActionPerformerStatus, STATUS, said(100))
        self._link.listen(ActionExecution, HUB, self._hear, said(100))
        self._link.every(BEAT, self._beat)

    def run(self) -> None:
        """Perform until `close` is called.

        Raises:
            KeyboardInterrupt: Ctrl-C; what runs is stopped first.
        """
        self._link.start()
        try:
            while not self._over.is_set():
                try:
                    work = self._works.get(timeout=TICK)
                except queue.Empty:
                    continue
                self._perform(work)
        finally:
            self._performer.finish(success=False, status="the performer ended")
            self._link.close()

    def close(self) -> None:
        """Stop what runs, and end; from any thread."""
        self._over.set()
        work = self._performer.work
        if work is not None:
            work.cancelled.set()

    def _perform(self, work: Work) -> None:
        action = self._ground(work.action, work.arguments)
        assert action is not None
        self._told(f"begins {action.pddl()}")
        try:
            success, status = self._grounded.perform(action, work.cancelled, self._tell)
        except TpvqaError as error:
            success, status = False, str(error)
        if work.cancelled.is_set():
            success, status = False, f"cancelled: {status}"
        self._told(f"{action.pddl()}: {'done' if success else 'failed'}: {status}")
        self._performer.finish(success=success, status=status)

    def _ground(self, name: str, arguments: tuple[str, ...]) -> Action | None:
        try:
            return self._task.action(name, arguments)
        except PDDLError:
            return None

    def _can(self, name: str, arguments: tuple[str, ...]) -> bool:
        return not self._over.is_set() and self._ground(name, arguments) is not None

    def _tell(self, status: str) -> None:
        self._about = status
        self._performer.tell(status)

    def _say(self, told: Said) -> None:
        self._hub.publish(
            self._kind(
                type=int(told.kind),
                node_id=told.node,
                action=told.action,
                arguments=list(told.arguments),
                success=told.success,
                completion=float(told.completion),
                status=told.status,
            )
        )

    def _hear(self, message: Any) -> None:
        try:
            kind = Kind(message.type)
        except ValueError:  # of a later PlanSys2
            return
        self._performer.hear(Said(kind, message.node_id, message.action, tuple(message.arguments)))

    def _beat(self) -> None:
        work, known = self._performer.work, self._status_kind
        status = known(
            state=known.READY if work is None else known.RUNNING,
            action="" if work is None else work.action,
            node_name=self._performer.name,
        )
        self._statuses.publish(_stamp(status, self._link.now()))
        if work is not None:
            self._performer.tell(self._about)


def _stamp(status: Any, now: float) -> Any:
    stamped(status.status_stamp, now)
    return status
