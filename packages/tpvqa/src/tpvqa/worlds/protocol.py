"""The seam between the loop and whatever a robot acts in."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from threading import Event
from typing import Protocol, runtime_checkable

from tpvqa.observation import Observation, SensedFact
from tpvqa.pddl import Action


class Report(StrEnum):
    """What a skill itself reports; never the truth."""

    DONE = "done"  # the skill ran to its end
    FAILED = "failed"  # the skill noticed that it failed
    CANCELLED = "cancelled"
    LATE = "late"  # the deadline passed
    UNAVAILABLE = "unavailable"  # the world has no such skill, or cannot show its outcome


@dataclass(frozen=True, slots=True)
class Execution:
    """What came of executing an action, as far as the robot's skill can tell.

    Attributes:
        report: How the skill ended.
        seconds: How long it took.
        message: What the skill says besides, for people.
        facts: What the robot's own sensors tell once it is over.
    """

    report: Report
    seconds: float
    message: str = ""
    facts: Sequence[SensedFact] = ()


@runtime_checkable
class World(Protocol):
    """Somewhere to act and to look.

    Every call of `observe` is a new look; the loop counts them. What else a world may be stands in
    `worlds.capabilities`.
    """

    def views(self) -> Sequence[str]:
        """The views that `observe` can take, the default one first."""

    def observe(self, view: str | None = None) -> Observation:
        """Look, from the default view unless one is named.

        Raises:
            UnknownNameError: The world has no such view.
        """

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        """Run the skill behind an action.

        Args:
            action: The ground action.
            deadline: Seconds after which the skill is stopped.
            cancel: Set from another thread to stop the skill.
        """

    def close(self) -> None:
        """Let go of everything. Can be called twice."""
