"""What a monitor decides, and why."""

from dataclasses import dataclass
from enum import StrEnum

from tpvqa.pddl import State


class Decision(StrEnum):
    """The ways in which a trial can go on from a check."""

    GO_ON = "go on"
    REPEAT = "repeat"
    REPLAN = "replan"
    DONE = "done"
    GIVE_UP = "give up"


@dataclass(frozen=True, slots=True)
class Verdict:
    """A decision with its reason.

    Attributes:
        decision: What to do.
        reason: Why, in one sentence.
        state: What is believed from now on; None where it has not changed. A replan starts
            from it.
        step: At which step of the plan to go on; None for the natural one (the action itself
            before it, the next one after it).
    """

    decision: Decision
    reason: str
    state: State | None = None
    step: int | None = None
