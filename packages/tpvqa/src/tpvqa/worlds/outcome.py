"""What truly came of an action, in a simulated world."""

from dataclasses import dataclass
from enum import StrEnum

from tpvqa.pddl import Atom, State
from tpvqa.worlds.protocol import Execution, Report


class Failure(StrEnum):
    """Why an action did not do what its effects say."""

    PRECONDITION = "precondition"  # one did not hold
    CHANCE = "chance"  # it was possible, and failed
    SCRIPT = "script"  # a script says so
    DEAD = "dead"  # the skill never works
    REFUSED = "refused"  # its effects held already, and the skill will not do it again

    @property
    def said(self) -> str:
        """In words."""
        return _SAID[self]


_SAID = {
    Failure.PRECONDITION: "a precondition did not hold",
    Failure.CHANCE: "the action failed",
    Failure.SCRIPT: "the action failed, as the script says",
    Failure.DEAD: "the skill never works",
    Failure.REFUSED: "it was done already, and is refused",
}


@dataclass(frozen=True, slots=True)
class Outcome:
    """What truly came of an action.

    Attributes:
        failure: Why it did not do what its effects say; None where it did, or they held already.
        undone: The achieved fact that a disturbance ended, if one did.
        undoing: How the world file says that.
        before: The true state before.
        after: The true state after.
    """

    failure: Failure | None
    undone: Atom | None
    undoing: str
    before: State
    after: State

    @property
    def succeeded(self) -> bool:
        """Whether the action did what its effects say, or they held already."""
        return self.failure is None

    def execution(self, seconds: float) -> Execution:
        """What the skill itself tells: it notices no fault, but knows what it refuses.

        Args:
            seconds: How long it took.
        """
        if self.failure is Failure.REFUSED:
            return Execution(Report.FAILED, seconds, self.failure.said)
        return Execution(Report.DONE, seconds)
