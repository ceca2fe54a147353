"""What a trial's answers were taken to be worth, and what knowing it better would save."""

from itertools import pairwise
from math import exp, log

from pydantic import ValidationError

from tpvqa.belief.answers.information import LATE, answers_to_be_sure
from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.learning.experience import Experience
from tpvqa.events import Ended, Event, Started, TrialState
from tpvqa.events.events import Acting, Answered, QuestionRecord
from tpvqa.vlm import Reply

BELIEF = "belief"
"""The monitor that goes by the default where it is given no calibration."""
LITTLE = 0.05
"""A share of questions that is not worth a sentence."""
MISTAKEN = 0.1
"""Answers that agree less often than they were taken to be right, by more than this, are worth
one."""
SURE = 0.95
"""From which probability on a fact counts as known."""
MOST = 0.5
"""The share of answers from which something is said of all."""
FEW = 10
"""Answers from which nothing is concluded."""


def weighs_answers(started: Started) -> bool:
    """Whether the trial's monitor went by what answers are worth."""
    return started.calibration is not None or started.monitor.partition(":")[0] == BELIEF


def calibration_used(started: Started) -> str:
    """Which calibration a trial went by, in a line; empty where its monitor weighs no answers."""
    if not weighs_answers(started):
        return ""
    if started.calibration is None:
        return "default: nothing was known of this VLM"
    known = _calibration(started)
    if known is None:
        return "of another version of tpvqa"
    said = f"of {known.vlm or 'a VLM without a name'}, learnt from {_answers(known)}"
    said = f"{said} ({known.fingerprint})"
    return said if known.vlm in ("", started.vlm) else f"{said}; {started.vlm} answered"


class AnswersWorth:
    """Counts in a trial how often answers agreed with what was believed before the next action.

    Where the belief came to be sure (`SURE`) of a fact, its answers are counted as right or wrong,
    and how often one was the last one again: what the VLM is like, by this one trial. Answers about
    what stayed in doubt are not: they may be worse, as they settled nothing.
    """

    def __init__(self) -> None:
        self._state = TrialState()
        self._open: dict[str, tuple[QuestionRecord, list[bool]]] = {}
        self._heard = self._right = self._answers = self._same = self._pairs = 0

    def take(self, event: Event) -> None:
        """Count an event."""
        self._state = self._state.after(event)
        match event:
            case Answered():
                for question, answer, _, person in self._state.latest:
                    if answer.reply in (Reply.YES, Reply.NO) and not person:
                        _, said = self._open.setdefault(question.text, (question, []))
                        said.append(answer.reply is Reply.YES)
                        self._heard += 1
            case Acting() | Ended():
                for question, said in self._open.values():
                    self._settle(question, said)
                self._open.clear()

    def _settle(self, question: QuestionRecord, said: list[bool]) -> None:
        atoms = (question.atom, *(question.alike or ()))
        likely = [p for atom in atoms if (p := self._state.belief.get(atom or "")) is not None]
        if not likely or 1 - SURE < max(likely) < SURE:
            return
        self._answers += len(said)
        self._right += said.count(max(likely) >= SURE)
        self._pairs += len(said) - 1
        self._same += sum(a is b for a, b in pairwise(said))

    def more_would_save(self) -> str:
        """What more labelled answers would save, in a sentence; empty where that is little.

        A plain estimate: how many answers it takes to be as sure of a fact as to act on it (Wald
        1945), as the answers were trusted at the start (at most `LATE` times as many as the
        calibration says, as questions are priced), beside how many it would take if it were
        known for certain how often they are right, and how often they only repeat the last one, as
        both were in this trial. Questions become fewer in that proportion, if the answers about
        what stayed in doubt are as good; where those are most, nothing is said of it.
        """
        started, questions = self._state.started, self._state.questions
        if started is None or not weighs_answers(started) or self._answers < FEW:
            return ""
        known = _calibration(started)
        if known is None:
            return ""
        rates = known.whole.rates
        taken = min(max((rates.yes_if_true + 1 - rates.yes_if_false) / 2, 0.51), 0.99)
        ratio = _trust(started, known).ratio(log(taken / (1 - taken)))
        trusted = min(1 / (1 + exp(-ratio)), taken)
        said = answers_to_be_sure(taken, known.repeat_same_view if known.rows else 0.0)
        now = min(answers_to_be_sure(trusted, known.repeat_same_view), LATE * said)
        right = self._right / self._answers
        then = answers_to_be_sure(right, self._repeat(right, known.repeat_same_view))
        saved = 1 - then / now
        told = (
            f"{self._right} of {self._answers} answers agreed with what was sure before the next "
            f"action, {right:.2f}, and {self._heard - self._answers} more were about what stayed "
            f"in doubt; all were taken to be right in {taken:.2f}, and trusted as in {trusted:.2f}"
        )
        if saved >= LITTLE and self._answers >= MOST * self._heard:
            return (
                f"{told}. If {right:.2f} were known for certain and held of those in doubt, too, "
                f"{then:.1f} instead of {now:.1f} answers to a question would do: about "
                f"{round(saved * questions)} of the {questions} questions less."
            )
        if saved >= LITTLE:
            return f"{told}: how many questions labels would save cannot be told from so few."
        if right < taken - MISTAKEN:
            return f"{told}: labels would say how far not to trust them."
        return ""

    def _repeat(self, right: float, otherwise: float) -> float:
        """How often an answer only repeated the last one, by this trial."""
        if self._pairs < FEW:
            return otherwise
        chance = right**2 + (1 - right) ** 2
        return min(max((self._same / self._pairs - chance) / (1 - chance + 1e-9), 0.0), 0.95)


def _calibration(started: Started) -> Calibration | None:
    """What the monitor was told; the default where that was nothing, None where it is no
    calibration of this version."""
    if started.calibration is None:
        return Calibration.default(started.vlm)
    try:
        return Calibration.model_validate(started.calibration)
    except ValidationError:
        return None


def _trust(started: Started, known: Calibration) -> Trust:
    """How far the monitor trusted it at the start."""
    try:
        learned = Experience.model_validate(started.experience).trusting()
    except ValidationError:
        learned = None
    return learned or Trust.after(known.rows)


def _answers(known: Calibration) -> str:
    """How many answers, and who said what was right."""
    said = f"{known.rows:,} answer{'' if known.rows == 1 else 's'}"
    if known.inferred:
        return f"{said} of which nobody said what was right"
    if known.by_hand:
        return f"{said}, by {known.by_hand:,} label{'' if known.by_hand == 1 else 's'}"
    return said
