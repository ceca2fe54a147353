"""Facts in the words of an episode's questions, from what its log keeps."""

import tempfile
from functools import lru_cache
from pathlib import Path

from tpvqa.errors import TpvqaError
from tpvqa.events.events import Started
from tpvqa.pddl.loading import task_from_text
from tpvqa.questions import FactWords, QuestionBook

_PATIENCE = 30.0
"""Seconds after which a log is shown without words rather than not at all."""


def words_of(started: Started) -> FactWords:
    """The words of an episode, from the files' texts that its log keeps."""
    try:
        return FactWords(_book(started.domain, started.problem, started.questions))
    except TpvqaError:  # a log of another version still has to be shown
        return FactWords()


@lru_cache(maxsize=8)
def _book(domain: str, problem: str, questions: str | None) -> QuestionBook:
    """The questions, read once for all episodes of a task: reading PDDL takes a process."""
    task = task_from_text(domain, problem, timeout=_PATIENCE)
    if questions is None:
        return QuestionBook.load(None, task)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "questions.yaml"
        file.write_text(questions, encoding="utf-8")
        return QuestionBook.load(file, task)
