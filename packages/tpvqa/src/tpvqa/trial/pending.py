"""What passes between a trial and whatever drives it."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

from tpvqa.events import Event, TrialState
from tpvqa.events.events import Acting, Asked, EndedBecause
from tpvqa.monitors import Request
from tpvqa.observation import Observation
from tpvqa.pddl import Action


@dataclass(frozen=True, slots=True)
class Act:
    """An action is to be executed; answered with an `Execution`."""

    action: Action


@dataclass(frozen=True, slots=True)
class Wait:
    """Time is to pass while actions run; answered with what the world's clock shows then.

    Attributes:
        until: What it is to show; None for no time at all, to read it.
    """

    until: float | None = None


@dataclass(frozen=True, slots=True)
class Pending:
    """Something that a trial wants done, before it can go on.

    Attributes:
        request: What is to be done.
        announced: What the log has to say before it is begun, if anything.
        look: The number of the next look.
        seen: The latest observation, which questions are about; None before the first.
        seconds: What the limit of time leaves for it; None for any time.
    """

    request: Request | Act | Wait
    announced: Asked | Acting | None = None
    look: int = 0
    seen: Observation | None = None
    seconds: float | None = None


@dataclass(frozen=True, slots=True)
class Result:
    """What came of what was pending.

    Attributes:
        value: An `Observation`, answers, a `PlanningResult`, an `Answer`, an `Execution`
            or a time.
        state: Where the trial stands with it.
    """

    value: Any
    state: TrialState


@dataclass(frozen=True, slots=True)
class Conclusion:
    """How a trial ended.

    Attributes:
        because: Why.
        message: More about it.
        believes_goal: Whether it ended in the belief that the goal holds.
    """

    because: EndedBecause
    message: str = ""
    believes_goal: bool = False


class Unwatched(Exception):  # noqa: N818
    """Thrown into a trial at a request: it comes back to a world that cannot be put back and may
    have changed while nobody watched. It looks, and does again what it was about to do.

    Attributes:
        state: Where the trial stands. An action that it says is `acting` was begun, and what came
            of it is not known.
    """

    def __init__(self, state: TrialState):
        super().__init__("the world may have changed")
        self.state = state


Steps = Generator[Event | Pending, Any, Conclusion]
"""A trial under way. It yields events, and is sent the `TrialState` after each; and what is
pending, and is sent a `Result` for it, or `Unwatched` is thrown in. It returns how it ended."""
