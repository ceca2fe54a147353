"""Fact or action → `FactQuestion`, `ActionQuestion`, in words of templates beside the domain."""

from tpvqa.questions.book import QuestionBook
from tpvqa.questions.fact_words import FactWords
from tpvqa.questions.question import (
    ActionQuestion,
    ActionWay,
    FactQuestion,
    FactWay,
    Question,
    Way,
)
from tpvqa.questions.wordings import Wording

__all__ = [
    "ActionQuestion",
    "ActionWay",
    "FactQuestion",
    "FactWay",
    "FactWords",
    "Question",
    "QuestionBook",
    "Way",
    "Wording",
]
