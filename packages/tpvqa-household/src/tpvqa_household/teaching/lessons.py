"""What a user's examples teach: pictures, questions, and which answer is right where."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import TrainingError
from tpvqa.training.example import Example, together
from tpvqa_household.embedded.taught.folder import spoken

LEAST = 3
"""Pictures with *yes*, and with *no*, that a question needs."""


@dataclass(frozen=True)
class Lessons:
    """Examples as a table.

    Attributes:
        pictures: One example of each picture.
        questions: In words, as they are looked up.
        texts: The same as they were written, and those that were not learnt.
        predicates: What they ask about.
        labels: Pictures × questions: 1, 0, -1 for not known.
        unlearnt: Questions with too few pictures, each with why; not among the others.
        groups: Of each picture, what it shares with those that it is never taken apart from.
    """

    pictures: Sequence[Example]
    questions: Sequence[str]
    texts: Mapping[str, str]
    predicates: Sequence[str]
    labels: NDArray[np.int64]
    unlearnt: Mapping[str, str]
    groups: NDArray[np.str_]


def lessons_of(examples: Sequence[Example]) -> Lessons:
    """Sort examples into a table.

    Raises:
        TrainingError: No question has enough pictures with either answer, or one has no words.
    """
    pictures: dict[str, Example] = {}
    of = together(examples)
    asked: dict[str, Example] = {}
    said: dict[tuple[str, str], int] = {}
    for each in examples:
        question, truth = spoken(each.text), int(each.truth)
        if not question:
            raise TrainingError(f"The question {each.text!r} has no words. Write one that has")
        pictures.setdefault(each.picture, each)
        asked.setdefault(question, each)
        key = each.picture, question
        said[key] = truth if said.get(key, truth) == truth else -1
    table = np.array(
        [[said.get((picture, question), -1) for question in asked] for picture in pictures],
        np.int64,
    ).reshape(len(pictures), len(asked))
    counts = {
        question: (int((table[:, i] == 1).sum()), int((table[:, i] == 0).sum()))
        for i, question in enumerate(asked)
    }
    unlearnt = {q: _why(yes, no) for q, (yes, no) in counts.items() if min(yes, no) < LEAST}
    learnt = [(i, q) for i, q in enumerate(asked) if q not in unlearnt]
    if not learnt:
        told = "; ".join(f"{asked[q].text!r}: {y} yes, {n} no" for q, (y, n) in counts.items())
        raise TrainingError(
            f"Too few labelled pictures: every question needs {LEAST} where it is yes and {LEAST} "
            f"where it is no, besides those held back. Learnt from were {told:.600}. Label more"
        )
    return Lessons(
        list(pictures.values()),
        [question for _, question in learnt],
        {question: each.text for question, each in asked.items()},
        [asked[question].predicate for _, question in learnt],
        table[:, [i for i, _ in learnt]],
        unlearnt,
        np.array([of[picture] for picture in pictures]),
    )


def _why(yes: int, no: int) -> str:
    return f"taught with {yes} yes and {no} no; it needs {LEAST} of each"
