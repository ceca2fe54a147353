"""Facts and actions → questions in words, by templates beside the domain."""

from tpvqa.questions.book import QuestionBook
from tpvqa.questions.fact_words import FactWords
from tpvqa.questions.question import Question, Way

__all__ = ["FactWords", "Question", "QuestionBook", "Way"]
