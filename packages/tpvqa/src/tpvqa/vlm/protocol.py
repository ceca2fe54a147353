"""The seam that every VLM implements, and the one that only noise models are given."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from tpvqa.observation import Observation
from tpvqa.pddl import Action, Atom
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer


@runtime_checkable
class VLM(Protocol):
    """Answers yes/no questions about what is seen.

    What else it may be stands in `vlm.capabilities`.
    One call answers all questions on one observation. Within an observation the same question
    gets the same answer; another look is another observation.
    """

    @property
    def name(self) -> str:
        """What the log calls it, e.g. "embedded" or "oracle:0.8"."""

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order.

        Raises:
            AnswerError: The VLM cannot be asked at all. A single answer that is missing,
                malformed or late is `Reply.UNKNOWN` instead.
        """


@runtime_checkable
class TruthSource(Protocol):
    """What is true in a simulated world. Given to noise models and judges, to nothing else."""

    def holds(self, atom: Atom) -> bool:
        """Whether a fact is true now."""

    def visible(self, atom: Atom) -> bool:
        """Whether the last observation shows if it is true."""

    def possible(self, action: Action) -> bool:
        """Whether all preconditions of an action hold now."""

    def successful(self, action: Action) -> bool:
        """Whether all effects of an action hold now."""

    def scene(self) -> str:
        """Tells scenes apart: the same for the same true state, in every process, and no other.

        Only what errs the same in the same scene asks for it; see `vlm.scenes`.
        """


@runtime_checkable
class Remembering(TruthSource, Protocol):
    """What is true in a world that also knows what was true before the last action."""

    def earlier(self) -> TruthSource:
        """What was true before the last action; at first what is true now."""
