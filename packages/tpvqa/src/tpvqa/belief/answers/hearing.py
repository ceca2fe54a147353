"""What was heard of every question, as it counts now: carried along when it is asked for."""

from collections import deque
from collections.abc import Mapping
from typing import Protocol

import numpy as np

from tpvqa.belief.answers.heard import Heard
from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.last_answer import LastAnswer, Picture
from tpvqa.belief.answers.lasting import Columns
from tpvqa.belief.answers.led import Led, Places
from tpvqa.belief.answers.other_words import OtherWords
from tpvqa.pddl import Atom
from tpvqa.questions.question import FactQuestion
from tpvqa.vlm import Reply

LARGEST = 500.0
"""No logarithm of how many times as probable something is counts for more."""
REMEMBERED = 8
"""Actions after which it is forgotten what was heard of a question."""


class Truths(Protocol):
    """Says in which joint states any of some facts holds."""

    def truth(self, atoms: tuple[Atom, ...]) -> Mapping[int, bool]:
        """By their numbers."""


class Hearing:
    """Keeps what was heard.

    Args:
        words: How far the wordings of a question err alike.

    Attributes:
        last: The last answer to each question, by its text.
        acted: How many actions were executed.
        columns: Of which of all that is told apart of the noise it is known what was heard.
    """

    def __init__(self, words: OtherWords):
        self.last: dict[str, LastAnswer] = {}
        self.acted = 0
        self.columns: Columns = slice(None)
        self._words = words
        self._led: deque[Led | None] = deque(maxlen=REMEMBERED)

    def of(self, question: FactQuestion, view: str | None, truths: Truths) -> Heard | None:
        """What was heard of a question, in other words if not in these; None for nothing.

        Args:
            question: The question.
            view: From where it is asked now.
            truths: Says what holds in joint states.
        """
        if question.text in self.last:
            return self.now(self.last[question.text], view, truths)
        other = self._words.nearest(question)
        if other is None:
            return None
        heard = self.now(self.last[other.text], view, truths)
        return self._words.carried(heard, other, question)

    def now(self, last: LastAnswer, view: str | None, truths: Truths) -> Heard:
        """What was heard of a question, as it counts now from a view."""
        since = self.acted - last.acted
        if since:
            heard, led = last.heard[last.view], list(self._led)
            if since > len(led):
                heard = Heard()
            for each in led[len(led) - since :] if since <= len(led) else ():
                heard.acted(each, truths.truth(last.atoms))
            last.heard, last.acted = {last.view: heard}, self.acted
        return last.heard_from(view, self.columns)

    def moved(self, led: Led | None) -> None:
        """Note that an action was executed, and where it has led."""
        self._led.append(led)
        self.acted += 1
        for last in self.last.values():
            last.pictures.clear()
            if self.acted - last.acted == REMEMBERED + 1:  # forgotten: it need not be kept
                last.heard = {last.view: Heard()}

    def renumbered(self, numbers: Mapping[int, int]) -> None:
        """Go on with other numbers of the joint states."""
        for last in self.last.values():
            known = last.heard if last.acted == self.acted else {last.view: Heard()}
            for heard in known.values():
                heard.renumbered(numbers)
            last.heard, last.acted = known, self.acted
        self._led.clear()

    def tell_apart(self, columns: Columns, taken: Places) -> None:
        """Go on with others of all that is told apart of the noise.

        Args:
            columns: They.
            taken: Of each the place of the one whose part it takes among those until now.
        """
        self.columns = columns
        for last in self.last.values():
            for heard in last.heard.values():
                heard.tell_apart(taken)
        led = [each and each.told_apart(columns, taken) for each in self._led]
        self._led = deque(led, maxlen=REMEMBERED)

    def said(self, atom: Atom, *, holds: bool) -> bool:
        """Whether the last answer to some question about a fact was that it holds, or does not."""
        reply = Reply.YES if holds else Reply.NO
        return any(atom in last.atoms and last.reply is reply for last in self.last.values())

    def instead(self, one: int, other: int, truths: Truths) -> Floats | None:
        """How many times as probable what the VLM said in this scene is in another joint state.

        Args:
            one: The number of a joint state.
            other: That of the other one.
            truths: Says what holds in them.

        Returns:
            The logarithm of that, for everything that is told apart of the noise; None where all
            that was asked about is alike in both.
        """
        found: Floats | None = None
        for last in self.last.values():
            if last.acted != self.acted:
                continue
            said = [each.said for each in last.heard.values() if each.said is not None]
            truth = truths.truth(last.atoms) if said else {}
            for each in said:
                if truth[one] != truth[other]:
                    less = each[0] - each[1] if truth[other] else each[1] - each[0]
                    found = less if found is None else found + less
        return None if found is None else np.minimum(found, LARGEST)

    def asked_of(self, text: str, picture: Picture) -> bool:
        """Whether a question was answered on a picture since the last action."""
        last = self.last.get(text)
        return last is not None and picture in last.pictures
