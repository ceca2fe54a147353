"""Looking and asking as the paper's monitors do: a look, all questions, a majority."""

from collections.abc import Generator, Sequence
from typing import Any, Protocol

from tpvqa.errors import PluginError, cut
from tpvqa.events.decision import Decision
from tpvqa.monitors.majority import Majority
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.requests import Ask, Look, Request
from tpvqa.monitors.verdict import Verdict
from tpvqa.monitors.vote import vote
from tpvqa.questions import Question
from tpvqa.vlm import Answer

MOST = 100
"""Looks of a vote, at most."""
Asking = Generator[Request, Any, tuple[bool | None, list[Answer]]]
Telling = Generator[Request, Any, list[Answer]]


class Asks(Protocol):
    """Who has questions asked, and says what their answers come to."""

    def ask(self, questions: Sequence[Question]) -> Asking:
        """Whether the answers deny the action, and they; None where all of them abstain."""

    def tell(self, questions: Sequence[Question]) -> Telling:
        """What is answered, question by question."""


class Asker:
    """Asks all questions of a check and lets the majority of the answers decide.

    Args:
        majority: When answers deny an action.
        looks: How often to look again where every answer abstains, before stopping.
        votes: Looks at which every question is asked; each question's answer is the vote.

    Raises:
        PluginError: There are fewer votes than one or more than 100, or there is no such majority.
    """

    def __init__(
        self, *, majority: Majority | str = Majority.TIE_DENIES, looks: int = 3, votes: int = 1
    ):
        if votes < 1:
            raise PluginError(f"A vote over {votes} looks decides nothing; it takes one or more.")
        if votes > MOST:
            raise PluginError(f"A vote over {cut(votes)} looks is too long; take {MOST} at most.")
        self.majority, self.looks, self.votes = Majority.named(majority), looks, votes

    @property
    def words(self) -> list[str]:
        """What a specification says of it: nothing of one vote in which a tie denies."""
        votes = [] if self.votes == 1 else [str(self.votes)]
        return votes + ([] if self.majority is Majority.TIE_DENIES else [self.majority.value])

    def ask(self, questions: Sequence[Question]) -> Asking:
        """Whether the answers deny the action, and they; None where they still abstain.

        Where every answer abstains, it looks and asks again, a bounded number of times.
        """
        if not questions:
            return False, []
        for _ in range(1 + self.looks):
            rounds: list[list[Answer]] = []
            for _ in range(self.votes):
                yield Look()
                rounds.append((yield Ask(tuple(questions))))
            answers = vote(rounds)
            denied = self.majority.denies(answers)
            if denied is not None:
                return denied, answers
        return None, answers

    def tell(self, questions: Sequence[Question]) -> Telling:
        """What is answered, question by question; nothing is decided by it.

        A single vote goes by the latest look, more of them by new ones.
        """
        rounds: list[list[Answer]] = []
        for _ in range(self.votes):
            if self.votes > 1:
                yield Look()
            rounds.append((yield Ask(tuple(questions))))
        return vote(rounds)


def check_effects(asker: Asks, step: Step) -> Check:
    """Ask about all effects of an action: go on believing them, or repeat it."""
    questions = step.book.effects(step.action, step.state)
    denied, answers = yield from asker.ask(questions)
    if denied is None:
        return give_up(questions)
    if denied:
        return Verdict(Decision.REPEAT, tally("effects", answers))
    state = step.task.apply(step.state, step.action)
    return Verdict(Decision.GO_ON, tally("effects", answers), state)


def tally(what: str, answers: Sequence[Answer]) -> str:
    """How many of the answered questions agree, and which do not, in words."""
    votes = [answer for answer in answers if answer.agrees is not None]
    if not votes:
        return f"no {what} to ask about"
    denied = [answer.question.text for answer in votes if answer.agrees is False]
    count = f"{len(votes) - len(denied)} of {len(votes)} {what} hold"
    return count if not denied else f"{count}; denied: {' '.join(denied)}"


def give_up(questions: Sequence[Question]) -> Verdict:
    """The verdict where no question is answered, however often it is asked."""
    return Verdict(
        Decision.GIVE_UP,
        f"no answer to {len(questions)} question(s), also after looking again: stopped safely",
    )
