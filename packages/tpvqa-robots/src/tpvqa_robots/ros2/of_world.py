"""Any world as a `Robot`, so that a skill server can offer it: the simulated ones above all."""

import threading
from collections.abc import Callable, Mapping
from typing import Any, Protocol, runtime_checkable

from tpvqa.observation import Observation
from tpvqa.pddl import Action, Task
from tpvqa.worlds import Execution, World
from tpvqa_robots.ros2.kept import Kept
from tpvqa_robots.skills.protocol import Robot


@runtime_checkable
class _HasRobot(Protocol):
    """A world that tells which robot is in it."""

    @property
    def robot(self) -> object: ...


class WorldRobot:
    """A world behind `skills.protocol.Robot`.

    Args:
        world: The world; where it has a `robot`, that one's joints are told.
        task: Names its actions.
        kept: Keeps the world's state after every action; nothing does by default.
    """

    def __init__(self, world: World, task: Task, kept: Kept | None = None):
        self._world, self._kept = world, kept
        self.skills: Mapping[str, Any] = {schema.name: schema for schema in task.schemas}
        self._cancelled: threading.Event | None = None

    def perform(
        self,
        action: Action,
        *,
        deadline: float,
        cancelled: threading.Event,
        feedback: Callable[[str], None],
    ) -> Execution:
        """Execute it in the world; see `Robot.perform`."""
        feedback(f"begins {action.pddl()}")
        self._cancelled = cancelled
        try:
            done = self._world.execute(action, deadline=deadline, cancel=cancelled)
        except BaseException:  # what it was at must not go on
            if isinstance(self._world, _HasRobot) and isinstance(self._world.robot, Robot):
                self._world.robot.stop()
            raise
        if self._kept is not None:
            self._kept.keep()
        return done

    def look(self, view: str) -> Observation:
        """Observe the world."""
        return self._world.observe(view)

    def stop(self) -> None:
        """Cancel what is running."""
        if self._cancelled is not None:
            self._cancelled.set()

    def state(self) -> Mapping[str, float]:
        """The joints of the world's robot; none where it has none."""
        robot = self._world.robot if isinstance(self._world, _HasRobot) else None
        return robot.state() if isinstance(robot, Robot) else {}
