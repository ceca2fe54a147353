"""What a VLM answers."""

from dataclasses import dataclass
from enum import StrEnum

from tpvqa.questions.question import Question


class Reply(StrEnum):
    """Yes, no, or an abstention. Missing, malformed and late answers are *unknown*."""

    YES = "yes"
    NO = "no"
    UNKNOWN = "unknown"
    CANNOT_SEE = "cannot see"


CAMERA = "camera"
"""The source of an answer about a picture that shows nothing at all."""


@dataclass(frozen=True, slots=True)
class Answer:
    """One answer.

    Attributes:
        question: What was asked.
        reply: The answer.
        p_yes: P(yes | yes or no), between 0 and 1; None where the VLM gives none.
        source: How `p_yes` or the reply was obtained: "network", "logprobs", "classes",
            "likelihood", "word", "oracle", or `CAMERA`.
        text: The VLM's raw words, or why there is no answer.
        p_cannot_see: Probability that the picture does not show it, where the VLM tells.
        leftover: Probability mass on neither yes nor no (logprobs), where known.
        seconds: How long it took.
    """

    question: Question
    reply: Reply
    p_yes: float | None = None
    source: str = ""
    text: str = ""
    p_cannot_see: float | None = None
    leftover: float | None = None
    seconds: float = 0.0

    @property
    def agrees(self) -> bool | None:
        """Whether it agrees with what the question expects; None where the VLM abstains."""
        if self.reply is Reply.YES:
            return self.question.expected
        if self.reply is Reply.NO:
            return not self.question.expected
        return None
