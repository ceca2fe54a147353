"""Facts in the words of an episode's questions: "bread on the plate" for (on bread plate)."""

import re
import tempfile
from functools import lru_cache
from pathlib import Path

from tpvqa.episodes.events import Started
from tpvqa.errors import TpvqaError
from tpvqa.pddl import Atom, Literal
from tpvqa.pddl.loading import task_from_text
from tpvqa.questions import QuestionBook

_ASKING = re.compile(r"^(?:Is|Are) (?:there )?(?:it true: )?(?:the |an? )?(?P<said>.+)\?$")

_PATIENCE = 30.0
"""Seconds after which a log is shown without words rather than not at all."""


class FactWords:
    """Says facts as they are asked about; as atoms where there are no words for them.

    Args:
        book: The questions of the episode's task, if there are any.
    """

    def __init__(self, book: QuestionBook | None = None):
        self._book = book

    @staticmethod
    def of(started: Started) -> "FactWords":
        """The words of an episode, from the files' texts that its log keeps."""
        if started.questions is None:
            return FactWords()
        try:
            return FactWords(_book(started.domain, started.problem, started.questions))
        except TpvqaError:  # a log of another version still has to be shown
            return FactWords()

    def say(self, fact: str) -> str:
        """A fact, given as PDDL, in words."""
        if self._book is None:
            return fact
        atom = Atom.parse(fact)
        if atom.predicate not in self._book.task.predicates:
            return fact
        question = self._book.fact(Literal(atom))
        asking = _ASKING.match(question.text)
        said = asking["said"] if asking else question.text
        # The words may leave out objects; then two facts would be called the same.
        unsaid = [
            self._book.name(argument)
            for place, argument in enumerate(atom.arguments)
            if any(other.arguments[place] != argument for other in question.alike)
        ]
        return f"{said} ({', '.join(unsaid)})" if unsaid else said


@lru_cache(maxsize=8)
def _book(domain: str, problem: str, questions: str) -> QuestionBook:
    """The questions, read once for all episodes of a task: reading PDDL takes a process."""
    task = task_from_text(domain, problem, timeout=_PATIENCE)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "questions.yaml"
        file.write_text(questions, encoding="utf-8")
        return QuestionBook.load(file, task)
