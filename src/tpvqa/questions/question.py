"""A yes/no question about what a picture shows."""

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
    """

    text: str
    way: Way
    atom: Atom | None = None
    action: Action | None = None
    expected: bool = True
