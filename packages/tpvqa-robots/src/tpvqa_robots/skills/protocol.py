"""The seam between skills and whatever carries them out: a simulation, or a robot behind topics."""

from collections.abc import Callable, Mapping
from threading import Event
from typing import Any, Protocol, runtime_checkable

from tpvqa.observation import Observation
from tpvqa.pddl import Action
from tpvqa.worlds import Execution


@runtime_checkable
class Robot(Protocol):
    """Something with an arm, a gripper and eyes that has skills of its own.

    Attributes:
        skills: The names of the PDDL actions that it can carry out, and what each does.
    """

    skills: Mapping[str, Any]

    def perform(
        self,
        action: Action,
        *,
        deadline: float,
        cancelled: Event,
        feedback: Callable[[str], None],
    ) -> Execution:
        """Carry out an action.

        Args:
            action: The ground action.
            deadline: Seconds by the robot's clock after which it stops.
            cancelled: Set from another thread to stop it; the arm stands within 0.2 s.
            feedback: Told in words what it is about.

        Returns:
            How it ended, and what gripper and joints feel then. What goes wrong is a report, not
            an exception.
        """

    def look(self, view: str) -> Observation:
        """Pictures, depth, intrinsics and stamp of a view."""

    def stop(self) -> None:
        """Have the arm stand still within 0.2 s."""

    def state(self) -> Mapping[str, float]:
        """Joints in radians, by name, and the gripper's opening in metres as `gripper`; also while
        a skill runs, from another thread."""
