"""What came of a question that a server was asked."""

from dataclasses import dataclass

from tpvqa.chance import chance
from tpvqa.questions.question import Question, Way
from tpvqa.vlm.answer import Answer
from tpvqa.vlm.reading import Reading
from tpvqa.vlm.server import Retry

_LONGEST_PAUSE = 8.0
_OF_EFFECTS = (Way.EFFECT, Way.SUCCESSFUL, Way.DID)
Key = tuple[str, bool]
"""A question, and whether it is shown the picture before the action, too."""


@dataclass(frozen=True, slots=True)
class TimedReading:
    """What came of a question; where it is not `final`, it may do better when asked again."""

    reading: Reading
    seconds: float
    no_server: str = ""  # what an address does where nothing at it is a server
    final: bool = True  # a failure may pass; a reading stays


def key_of(question: Question, *, compares: bool) -> Key:
    """What an answer within a look is remembered by."""
    return question.text, compares and question.way in _OF_EFFECTS


def pause_before(retry: Retry, attempt: int, text: str) -> float:
    """Seconds until the next attempt: what the server asked for, or twice as long each time."""
    if retry.pause is not None:
        return retry.pause
    spread = 0.75 + 0.5 * chance(0, 0, "pause", text, attempt).random()
    return float(min(_LONGEST_PAUSE, 0.5 * 2**attempt * spread))


def answer_from(question: Question, outcome: TimedReading) -> Answer:
    """The answer to a question."""
    reading = outcome.reading
    return Answer(
        question=question,
        reply=reading.reply,
        p_yes=reading.p_yes,
        source=reading.source,
        text=reading.text,
        leftover=reading.leftover,
        seconds=outcome.seconds,
    )
