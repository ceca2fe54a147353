"""Yes/no questions about what a picture shows: about a fact, or about a whole action."""

import typing
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import ClassVar, TypeAlias

from tpvqa.pddl import Action, Atom, Literal


class Way(StrEnum):
    """The ways of asking that the paper compares."""

    PRECONDITION = "precondition"  # a fact an action needs
    EFFECT = "effect"  # a fact an action brings about or ends
    ALTERNATIVE = "alternative"  # where else a thing may be, once a fact is denied
    POSSIBLE = "possible"  # "Is it possible to <action> here?"
    SUCCESSFUL = "successful"  # "Was <action> successful?"
    DID = "did"  # "Did the robot successfully <action>?"


FactWay: TypeAlias = typing.Literal[Way.PRECONDITION, Way.EFFECT, Way.ALTERNATIVE]
"""How a fact is asked about."""

ActionWay: TypeAlias = typing.Literal[Way.POSSIBLE, Way.SUCCESSFUL, Way.DID]
"""How a whole action is asked about."""


@dataclass(frozen=True, slots=True)
class FactQuestion:
    """A question about a fact, and the answer that agrees with what is believed.

    Attributes:
        text: What the VLM is asked.
        way: The way of asking.
        atom: The fact asked about.
        expected: The answer (yes is True) that agrees with the literal the author wrote:
            a negative literal is the positive question with the answer *no* expected.
        alike: Other facts that the words do not tell from `atom`: asked whether a thing is in a
            robot's hand, yes is right whichever hand it is in.
        wording: Which of the wordings that a file gives of it, counted from 0.
        first: What it is in the first of them; "" where this is the first.
        still_shown: Whether a picture may show the fact though it does not hold any more.
    """

    text: str
    way: FactWay
    atom: Atom
    expected: bool = True
    alike: tuple[Atom, ...] = ()
    wording: int = 0
    first: str = ""
    still_shown: bool = field(default=False, compare=False)

    def __hash__(self) -> int:
        return hash((self.text, self.way))

    @property
    def atoms(self) -> tuple[Atom, ...]:
        """The facts of which any one makes yes right: the one asked about and those alike."""
        return (self.atom, *self.alike)

    @property
    def family(self) -> str:
        """The same for all wordings of it: what it is in the first."""
        return self.first or self.text

    @property
    def literal(self) -> Literal:
        """What the expected answer says of the fact."""
        return Literal(self.atom, self.expected)

    @property
    def subject(self) -> str:
        """The predicate asked about."""
        return self.atom.predicate

    def true_in(self, holds: Callable[[Atom], bool]) -> bool:
        """Whether yes is right, by whether facts hold."""
        return any(map(holds, self.atoms))


@dataclass(frozen=True, slots=True)
class ActionQuestion:
    """A question about a whole action.

    Attributes:
        text: What the VLM is asked.
        way: The way of asking.
        action: The action asked about.
        expected: Yes, always: the answer where all goes well.
    """

    text: str
    way: ActionWay
    action: Action
    expected: ClassVar[bool] = True

    def __hash__(self) -> int:
        return hash((self.text, self.way))

    @property
    def subject(self) -> str:
        """The name of the action asked about."""
        return self.action.name


Question: TypeAlias = FactQuestion | ActionQuestion
"""What a VLM is asked."""
