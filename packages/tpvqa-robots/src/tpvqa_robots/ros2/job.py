"""A skill that a server is asked for, and whoever is told what comes of it."""

import threading
from dataclasses import dataclass, field
from time import monotonic
from typing import Protocol

from tpvqa.pddl import Action
from tpvqa.worlds import Execution


class Teller(Protocol):
    """Tells whoever asked for a skill what comes of it."""

    def feedback(self, message: str) -> None:
        """What the robot is about."""

    def refused(self, why: str) -> None:
        """It was not begun."""

    def ended(self, done: Execution, at: float) -> None:
        """How it ended, and when by the clock of the pictures' stamps."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """A skill as it is asked for; None is what was not said, or not understood.

    Attributes:
        by: The controller that asks.
        id: Another one for every skill.
        action: As PDDL writes it.
        deadline: Seconds that it has.
        seen: The stamp of the picture that it rests on.
    """

    by: str
    id: str
    action: str | None
    deadline: float | None
    seen: float | None


@dataclass
class Job:
    """A skill that was accepted."""

    id: str
    action: Action
    deadline: float
    teller: Teller
    cancelled: threading.Event = field(default_factory=threading.Event)
    began: float = field(default_factory=monotonic)


@dataclass(frozen=True, slots=True)
class Standing:
    """How a skill server stands: its name, who has the robot, what it is at, and why it is idle."""

    server: str
    holder: str | None
    running: str | None
    stopped: str


class Commands(Protocol):
    """What a skill server lets its topics and its action ask for."""

    def beat(self, by: str) -> None:
        """A controller was heard; where nobody has the robot, it has it now."""

    def release(self, by: str) -> None:
        """A controller gives the robot back."""

    def cancel(self, by: str | None, name: str) -> None:
        """Stop a skill; `by` is None where the asker is known by its goal alone."""

    def do(self, wanted: Wanted, teller: Teller) -> None:
        """Begin a skill, or say why not."""
