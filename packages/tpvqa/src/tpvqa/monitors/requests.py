"""What a monitor asks to have done for it. Whatever drives the trial does it, and logs it."""

from dataclasses import dataclass

from tpvqa.pddl import Action, Atom, State
from tpvqa.pddl.lasting import Running
from tpvqa.questions import Question


@dataclass(frozen=True, slots=True)
class Look:
    """A new look at the world; answered with the `Observation`."""

    view: str | None = None


@dataclass(frozen=True, slots=True)
class Ask:
    """Questions about the latest look; answered with a list of `Answer`, in order."""

    questions: tuple[Question, ...]


@dataclass(frozen=True, slots=True)
class PlanFrom:
    """A plan from a state; answered with a `PlanningResult`.

    Attributes:
        state: Where it begins.
        followed: Whether it is to be followed, or only considered.
        without: Actions that must not be in it.
        towards: Facts that it is to bring about; none for the task's goal.
        running: What is running meanwhile, and how much longer.
    """

    state: State
    followed: bool = False
    without: frozenset[Action] = frozenset()
    towards: frozenset[Atom] = frozenset()
    running: tuple[Running, ...] = ()


@dataclass(frozen=True, slots=True)
class AskPerson:
    """A question to a person; answered with an `Answer`, *unknown* where nobody is there."""

    question: Question


Request = Look | Ask | PlanFrom | AskPerson
