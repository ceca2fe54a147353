"""A yes/no question about what a picture shows."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from tpvqa.pddl import Action, Atom


class Way(StrEnum):
    """The ways of asking that the paper compares."""

    PRECONDITION = "precondition"  # a fact an action needs
    EFFECT = "effect"  # a fact an action brings about or ends
    ALTERNATIVE = "alternative"  # where else a thing may be, once a fact is denied
    POSSIBLE = "possible"  # "Is it possible to <action> here?"
    SUCCESSFUL = "successful"  # "Was <action> successful?"
    DID = "did"  # "Did the robot successfully <action>?"


@dataclass(frozen=True, slots=True)
class Question:
    """A question and the answer that agrees with what is believed.

    Attributes:
        text: What the VLM is asked.
        way: The way of asking.
        atom: The fact asked about; None for questions about a whole action.
        action: The action asked about; None for questions about a fact alone.
        expected: The answer (yes is True) that agrees with the literal the author wrote:
            a negative literal is the positive question with the answer *no* expected.
        alike: Other facts that the words do not tell from `atom`: asked whether a thing is in a
            robot's hand, yes is right whichever hand it is in.
    """

    text: str
    way: Way
    atom: Atom | None = None
    action: Action | None = None
    expected: bool = True
    alike: tuple[Atom, ...] = ()

    def __hash__(self) -> int:
        return hash((self.text, self.way))

    def true_in(self, holds: Callable[[Atom], bool]) -> bool | None:
        """Whether yes is right, by whether facts hold; None for questions about actions."""
        if self.atom is None:
            return None
        return holds(self.atom) or any(map(holds, self.alike))
