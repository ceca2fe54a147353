"""Which facts the robot notices itself, as far as it was said beforehand or has shown."""

from collections.abc import Collection, Iterable, Sequence

from tpvqa.belief.filtering.sight import Sight
from tpvqa.observation import SensedFact
from tpvqa.pddl import Atom, Literal
from tpvqa.questions import QuestionBook


class Feeling:
    """Predicates of facts that the robot senses.

    Args:
        sight: Is told what shows facts.
        senses: Predicates that the robot is said to sense.
        noticed: Predicates of what skills themselves notice.
    """

    def __init__(self, sight: Sight, senses: Collection[str], noticed: Iterable[str]):
        self._sight = sight
        self._felt = {*senses, *noticed}
        self._sensed: set[str] = set()
        self._at_looks, self._looked = set(senses), False  # until a look has told
        self._book: QuestionBook | None = None

    def asked_by(self, book: QuestionBook) -> bool:
        """Note what is asked; whether that is new."""
        if self._book is book:
            return False
        self._book = book
        self._tell(book)
        return True

    def take(self, facts: Sequence[SensedFact], effects: Collection[Atom]) -> bool:
        """Note what was sensed; whether more is known to be shown now.

        Args:
            facts: What was sensed.
            effects: What the last action was to change: that is felt then, and perhaps never after.
        """
        told = len(self._sensed) + len(self._felt)
        for fact in facts:
            kind = self._felt if fact.atom in effects else self._sensed
            kind.add(fact.atom.predicate)
        if self._book is None or len(self._sensed) + len(self._felt) == told:
            return False
        self._tell(self._book)
        return True

    def looked(self, facts: Sequence[SensedFact]) -> None:
        """Note what a look has sensed."""
        told = {fact.atom.predicate for fact in facts}
        self._at_looks = self._at_looks | told if self._looked else told
        self._looked = True

    def by_a_look(self, atoms: Iterable[Atom]) -> list[Atom]:
        """Those of some facts that a look may sense."""
        return [atom for atom in atoms if atom.predicate in self._at_looks]

    def _tell(self, book: QuestionBook) -> None:
        sensed, felt = frozenset(self._sensed), frozenset(self._felt)
        self._sight.by(
            lambda atom: book.asked(Literal(atom)) or atom.predicate in sensed,
            lambda atom: atom.predicate in felt,
        )
