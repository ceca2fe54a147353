"""What the right answer to a question is, from what a picture shows.

Three values, after Kleene: a conjunction is *no* as soon as one part visibly fails, *cannot see*
where none fails and some cannot be seen, else *yes*. What the words leave unsaid (which hand,
from where) is any: *yes* if some choice is. As numbers, no is 0, yes is 1 and cannot see ½, so
that "and" is the minimum, "or" the maximum and "not" the difference to 1.
"""

from collections.abc import Iterable, Sequence
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tpvqa.pddl import Action, Atom, Condition, Conjunction, Disjunction, Literal
from tpvqa.questions.question import Way
from tpvqa_household.training.facts import FactTable
from tpvqa_household.training.subjects import Subject, action_subject

Values = NDArray[np.float32]


class Label(IntEnum):
    """The right answer; *hard no* is a no although the thing asked about is in view."""

    NO = 0
    YES = 1
    CANNOT_SEE = 2
    HARD_NO = 3
    UNCLEAR = -1  # too small or too hidden to say whether it is in view: never asked


_MOVES = ("in_hand", "on", "pick_up", "place", "wash", "cut_in_half")


class Labels:
    """Right answers about the pictures of a table.

    Args:
        table: What is true and what is visible.
        actions: The ground actions that may be asked about.
    """

    def __init__(self, table: FactTable, actions: Iterable[Action]):
        self._size = len(table)
        self._seen = {
            atom: np.where(table.visible[:, i], table.true[:, i], 0.5).astype(np.float32)
            for i, atom in enumerate(table.atoms)
        }
        self._values = self._seen
        self._true = {atom: table.true[:, i] for i, atom in enumerate(table.atoms)}
        self._hands = sorted({a.arguments[1] for a in table.atoms if a.predicate == "in_hand"})
        self._items = sorted({a.arguments[0] for a in table.atoms if a.predicate == "in_hand"})
        self._actions: dict[tuple[str, tuple[str, ...]], list[Action]] = {}
        for action in actions:
            said = action_subject(Way.POSSIBLE, action)
            self._actions.setdefault((said.name, said.arguments), []).append(action)

    def of(self, subjects: Sequence[Subject]) -> NDArray[np.int8]:
        """Labels as numbers, pictures × subjects."""
        columns = [self.label(subject) for subject in subjects]
        return np.stack(columns, 1) if columns else np.zeros((self._size, 0), np.int8)

    def label(self, subject: Subject) -> NDArray[np.int8]:
        """The labels of one subject, a number for every picture."""
        values, other = self._with_unclear(0.0, subject), self._with_unclear(1.0, subject)
        labels = np.full(self._size, Label.CANNOT_SEE, np.int8)
        labels[values == 1] = Label.YES
        labels[values == 0] = Label.NO
        if subject.name in _MOVES:
            in_view = self._seen.get(Atom("near", subject.arguments[:1]), self._constant(0)) == 1
            labels[(values == 0) & in_view] = Label.HARD_NO
        labels[values != other] = Label.UNCLEAR
        return labels

    def _with_unclear(self, value: float, subject: Subject) -> Values:
        """What is right if things that may or may not be in view are taken to be, or not to be."""
        self._values = {
            atom: np.where(seen == 0.5, np.float32(value), seen)
            if atom.predicate == "near"
            else seen
            for atom, seen in self._seen.items()
        }
        if subject.form != "fact":
            return self._action(subject)
        if subject.name == "in_hand":
            item = subject.arguments[0]
            return self._any(self._value(Atom("in_hand", (item, h))) for h in self._hands)
        return self._value(Atom(subject.name, subject.arguments))

    def _constant(self, value: float) -> Values:
        return np.full(self._size, value, np.float32)

    def _value(self, atom: Atom) -> Values:
        if atom.predicate == "free":
            hand = atom.arguments[0]
            return 1 - self._any(self._value(Atom("in_hand", (x, hand))) for x in self._items)
        if atom.predicate == "=":
            return self._constant(float(atom.arguments[0] == atom.arguments[1]))
        found = self._values.get(atom)
        return self._constant(0.0) if found is None else found

    def _all(self, values: Iterable[Values]) -> Values:
        result: Values = np.minimum.reduce([self._constant(1.0), *values])
        return result

    def _any(self, values: Iterable[Values]) -> Values:
        result: Values = np.maximum.reduce([self._constant(0.0), *values])
        return result

    def _condition(self, condition: Condition) -> Values:
        match condition:
            case Literal(atom, positive):
                return self._value(atom) if positive else 1 - self._value(atom)
            case Conjunction(parts):
                return self._all(self._condition(part) for part in parts)
            case Disjunction(parts):
                return self._any(self._condition(part) for part in parts)

    def _action(self, subject: Subject) -> Values:
        if subject.form == Way.POSSIBLE and subject.name == "find":
            return self._findable(subject.arguments[0])
        actions = self._actions[subject.name, subject.arguments]
        if subject.form == Way.POSSIBLE:
            return self._any(self._condition(action.precondition) for action in actions)
        # A hand that is free again follows from what it let go of; words do not name it.
        return self._any(
            self._all(
                self._condition(effect.literal)
                for effect in action.effects
                if effect.literal.atom.predicate != "free"
            )
            for action in actions
        )

    def _findable(self, thing: str) -> Values:
        """Whether a thing can be found: it can, unless a container in view is shut upon it.

        The robot always comes from somewhere, and a container out of view speaks against nothing
        in the picture. Of one that is seen closed the truth decides: its content is hidden, but
        that apples usually lie there can be learned.
        """
        result = self._constant(1.0)
        for opened, values in self._values.items():
            inside = self._true.get(Atom("on", (thing, *opened.arguments)))
            if opened.predicate == "opened" and inside is not None:
                result[(values == 0) & inside] = 0.0
        return result
