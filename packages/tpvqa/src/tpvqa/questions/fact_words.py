"""Facts in the words of a task's questions: "bread on the plate" for (on bread plate)."""

import re

from tpvqa.errors import PDDLError
from tpvqa.pddl import Atom, Literal
from tpvqa.questions.book import QuestionBook

_ASKING = re.compile(r"^(?:Is|Are) (?:there )?(?:it true: )?(?:the |an? )?(?P<said>.+)\?$")


class FactWords:
    """Says facts as they are asked about; as atoms where there are no words for them.

    Args:
        book: The questions of the task, if there are any.
    """

    def __init__(self, book: QuestionBook | None = None):
        self.book = book
        self._said: dict[Atom, str] = {}

    def say(self, fact: str) -> str:
        """A fact, given as PDDL, in words; as it is, where it is none of the task's."""
        if self.book is None:
            return fact
        atom = Atom.parse(fact)
        if atom not in self._said:
            try:
                self.book.task.check_atom(atom)
            except PDDLError:
                return fact
        return self.of(atom)

    def of(self, atom: Atom) -> str:
        """A fact of the task in words."""
        if self.book is None:
            return str(atom)
        if atom not in self._said:
            question = self.book.fact(Literal(atom))
            asking = _ASKING.match(question.text)
            said = asking["said"] if asking else str(atom)
            # The words may leave out objects; then two facts would be called the same.
            unsaid = [
                self.book.name(argument)
                for place, argument in enumerate(atom.arguments)
                if any(other.arguments[place] != argument for other in question.alike)
            ]
            self._said[atom] = f"{said} ({', '.join(unsaid)})" if unsaid else said
        return self._said[atom]
