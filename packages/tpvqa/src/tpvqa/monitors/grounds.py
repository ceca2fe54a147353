"""What a decision is made of, for saying why."""

from collections.abc import Mapping, Set
from dataclasses import dataclass

from tpvqa.belief.calibrating.risk import RiskBound
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.filtering.belief import Belief
from tpvqa.monitors.inspection import Inspection, Noticed, Replies
from tpvqa.monitors.protocol import Step
from tpvqa.pddl import Atom, Literal
from tpvqa.questions import FactWords


@dataclass(frozen=True, slots=True)
class Grounds:
    """What a decision is made of.

    Attributes:
        step: Where the trial stands.
        words: Says facts.
        belief: What is believed.
        now: What was seen, answered and noticed since the last action.
        plan: The plan that is followed, with its needs.
        acted: Whether the step's action was just executed.
        unseen: The questions that found no answer since the last action.
        questions_left: Whether anything more may be asked.
        actions_left: Actions that the trial still allows; None for any number.
        failing: That the step's skill seems never to work, in words; empty where it does.
        settles: How far answers are expected to settle what is in doubt.
        followed: Whether they say nothing, so that what was decided is followed to its end.
        risk: Where "done" may be reported; None for where the goal is likely.
    """

    step: Step
    words: FactWords
    belief: Belief
    now: Inspection
    plan: AnnotatedPlan | None
    acted: bool
    unseen: Set[str]
    questions_left: bool
    actions_left: int | None
    failing: str = ""
    settles: float = 1.0
    followed: bool = False
    risk: RiskBound | None = None

    @property
    def told(self) -> Mapping[str, Replies]:
        """What was answered since the last action, by question."""
        return self.now.replies

    @property
    def noticed(self) -> Mapping[Atom, Noticed]:
        """What the robot's own skill and sensors told since then, by fact."""
        return self.now.noticed

    @property
    def next(self) -> int:
        """The step of the plan that would be next if all had gone well; its length for the goal."""
        return self.step.index + self.acted

    def probability(self, literal: Literal) -> float:
        """How probable a literal is."""
        p = self.belief.probability(literal.atom)
        return p if literal.positive else 1 - p

    def say(self, literal: Literal) -> str:
        """A literal in words."""
        said = self.words.of(literal.atom)
        return said if literal.positive else f"not {said}"

    def answers(self, atom: Atom) -> Replies | None:
        """What was answered about a fact, or about those alike."""
        return next((told for told in self.told.values() if atom in told.atoms), None)

    def out_of_view(self, atom: Atom) -> bool:
        """Whether a question about this very fact found no answer."""
        own = self.now.about(frozenset((atom,)), self.step.book)
        return any(question.text in self.unseen for question in own)

    def known(self, atom: Atom) -> bool:
        """Whether anything was answered or noticed about a fact."""
        return self.answers(atom) is not None or atom in self.noticed
