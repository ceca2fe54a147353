"""A rival of beliefs: each fact is asked until yes or no is so many answers ahead, and believed.

That is Wald's sequential test of every fact by itself, without a calibration and without a memory.
"""

import re
from collections.abc import Sequence

from tpvqa.errors import PluginError
from tpvqa.monitors.asker import Asking, Telling
from tpvqa.monitors.correcting import CorrectingMonitor
from tpvqa.monitors.requests import Ask, Look
from tpvqa.monitors.vote import together
from tpvqa.questions import Question
from tpvqa.vlm import Answer, Reply

MOST = 100
"""Answers that a lead may be."""
SILENT = 3
"""Further looks at which no open question is answered, before they are left open."""
LOOKS = 100
"""Looks, times the square of the lead, after which a question is left open: a coin needs the
square of the lead on average."""


class Lead(CorrectingMonitor):
    """TPVQA that asks each fact until yes or no is so many answers ahead.

    A single fact that is denied denies the action, and no majority is asked; the goal is checked
    at the end.

    Args:
        lead: How many answers yes or no is to be ahead.
    """

    def __init__(self, lead: int):
        super().__init__(LeadAsker(lead), goal=True)
        self.lead = lead

    @classmethod
    def from_spec(cls, arguments: str = "") -> "Lead":
        """Make it from `lead:M`.

        Raises:
            PluginError: M is not a number of answers.
        """
        if not re.fullmatch(r"[0-9]{1,9}", arguments) or not 1 <= int(arguments) <= MOST:
            raise PluginError(
                f"'lead:{arguments}' is not understood. Write lead:M for M answers ahead, "
                f"e.g. lead:3; at most {MOST}."
            )
        return cls(int(arguments))

    @property
    def name(self) -> str:
        """What the log calls it."""
        return f"lead:{self.lead}"


class LeadAsker:
    """Asks every question until one answer is ahead.

    Args:
        lead: By how many.
    """

    def __init__(self, lead: int):
        self.lead = lead

    def ask(self, questions: Sequence[Question]) -> Asking:
        """Whether any answer denies the action; None where all questions stay open."""
        answers = (yield from self.tell(questions)) if questions else []
        decided = [answer.agrees for answer in answers if answer.agrees is not None]
        if questions and not decided:
            return None, answers
        return False in decided, answers

    def tell(self, questions: Sequence[Question]) -> Telling:
        """What is answered, question by question; *unknown*, or as last, where it stays open."""
        told: list[list[Answer]] = [[] for _ in questions]
        waiting = list(range(len(questions)))
        silent = 0
        for _ in range(LOOKS * self.lead**2):
            yield Look()
            answers: list[Answer] = yield Ask(tuple(questions[each] for each in waiting))
            for each, answer in zip(waiting, answers, strict=True):
                told[each].append(answer)
            silent = silent + 1 if all(answer.agrees is None for answer in answers) else 0
            waiting = [each for each in waiting if abs(_ahead(told[each])) < self.lead]
            if not waiting or silent > SILENT:
                break
        return [self._together(answers) for answers in told]

    def _together(self, answers: Sequence[Answer]) -> Answer:
        ahead = _ahead(answers)
        if abs(ahead) >= self.lead:
            reply = Reply.YES if ahead > 0 else Reply.NO
        else:
            decided = any(answer.reply in (Reply.YES, Reply.NO) for answer in answers)
            reply = Reply.UNKNOWN if decided else answers[-1].reply
        return together(answers, reply)


def _ahead(answers: Sequence[Answer]) -> int:
    """How many more answers say yes than no."""
    replies = [answer.reply for answer in answers]
    return replies.count(Reply.YES) - replies.count(Reply.NO)
