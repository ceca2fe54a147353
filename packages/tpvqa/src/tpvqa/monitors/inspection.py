"""What was seen and answered since the last action."""

from collections import Counter
from dataclasses import dataclass, field

from tpvqa.belief.answers.last_answer import Picture
from tpvqa.pddl import Action, Atom, Literal
from tpvqa.questions import FactQuestion, FactWay, QuestionBook, Way
from tpvqa.vlm import Reply


@dataclass(slots=True, eq=False)
class Replies:
    """What was answered to a question since the last action.

    Attributes:
        atoms: The fact that it is about, and those alike.
        before: How probable it was before the first answer.
        replies: The answers.
    """

    atoms: tuple[Atom, ...]
    before: float
    replies: list[Reply] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class Noticed:
    """What the robot itself noticed of a fact since the last action.

    Attributes:
        before: How probable the fact was before it.
        by: What noticed it: `REPORTED`, `SENSED`, or both.
    """

    before: float
    by: list[str] = field(default_factory=list)


REPORTED, SENSED = "as the skill reports", "as sensed"


@dataclass(slots=True, eq=False)
class Inspection:
    """What happened since the last action; a new one begins with every action.

    Attributes:
        action: That action; None before the first.
        view: Where the next look is taken from.
        picture: What tells the latest look from others; None before the first.
        looks: Looks so far.
        questions: Questions so far.
        learned: Whether it was learned already how the action came out.
        replies: What was answered to each question.
        heard: How often the VLM gave each answer to each text.
        noticed: What the robot's own skill and sensors told of facts.
        controls: What was asked about though it is known, to see what answers are worth.
    """

    action: Action | None = None
    view: str | None = None
    picture: Picture | None = None
    looks: int = 0
    questions: int = 0
    learned: bool = False
    replies: dict[str, Replies] = field(default_factory=dict)
    heard: Counter[tuple[str, Reply]] = field(default_factory=Counter)
    noticed: dict[Atom, Noticed] = field(default_factory=dict)
    controls: list[FactQuestion] = field(default_factory=list)
    _about: dict[frozenset[Atom], list[FactQuestion]] = field(default_factory=dict)

    def about(self, atoms: frozenset[Atom], book: QuestionBook) -> list[FactQuestion]:
        """The questions about some facts; of what the action was to change, as of its effects.

        Those in other words than the first come last.
        """
        if atoms not in self._about:
            questions: dict[str, FactQuestion] = {}
            for atom in sorted(atoms):
                effect = atom in self.effects
                if book.asked(Literal(atom), self.action if effect else None):
                    way: FactWay = Way.EFFECT if effect else Way.PRECONDITION
                    question = book.fact(Literal(atom), way=way)
                    questions.setdefault(question.text, question)
            for question in list(questions.values()):
                for other in book.in_other_words(question):
                    questions.setdefault(other.text, other)
            self._about[atoms] = list(questions.values())
        return self._about[atoms]

    def notice(self, atom: Atom, before: float, after: float, by: str) -> None:
        """Note that skill or sensors told something of a fact, where that shows in two digits."""
        if abs(before - after) < 0.005:
            return
        first = (told.before for told in self.replies.values() if told.atoms == (atom,))
        noticed = self.noticed.setdefault(atom, Noticed(next(first, before)))
        if by not in noticed.by:
            noticed.by.append(by)

    @property
    def effects(self) -> frozenset[Atom]:
        """The facts that the action was to change."""
        if self.action is None:
            return frozenset()
        return frozenset(effect.literal.atom for effect in self.action.effects)
