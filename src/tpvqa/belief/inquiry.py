"""What to ask next, if anything: the questions whose answers save more than they cost."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tpvqa.belief.choices import Table
from tpvqa.belief.costs import Costs
from tpvqa.belief.evidence import PERSON, PERSONS_VIEW, Evidence, Picture
from tpvqa.belief.faults import FaultModel
from tpvqa.belief.information import TIMES, Floats, Reliability, gains, joint_gains
from tpvqa.questions.question import Question

DOUBT = 1e-3
"""Facts that are surer than this are not asked about."""
TOGETHER = 4
"""Questions that are thought to be asked together, at most."""


@dataclass(frozen=True, slots=True)
class Inquiry:
    """What to ask.

    Attributes:
        question: The question.
        times: How often to ask it, each time at a new look, before thinking again.
        saving: How much less the best decision is then expected to cost, less what asking costs.
        person: Whether to ask a person.
    """

    question: Question
    times: int
    saving: float
    person: bool = False


@dataclass(frozen=True, slots=True)
class Budget:
    """What may still be asked and looked at before the next action."""

    questions: int
    looks: int


class Inquirer:
    """Finds what is worth asking.

    Args:
        model: Says what holds in a joint state.
        evidence: Says what an answer is worth.
        costs: What asking costs.
    """

    def __init__(self, model: FaultModel, evidence: Evidence, costs: Costs):
        self._model, self._evidence, self._costs = model, evidence, costs
        self._truths: dict[str, dict[int, float]] = {}

    def best(
        self,
        questions: Sequence[Question],
        table: Table,
        budget: Budget,
        *,
        picture: Picture | None,
        views: Callable[[Question], Sequence[str | None]],
        person: bool = False,
    ) -> Inquiry | None:
        """What to ask next; None where no answer is worth its price.

        Args:
            questions: About facts that matter.
            table: What can be done, and what it costs.
            budget: What may still be asked.
            picture: The latest one since the last action; None where there was none.
            views: From where a question may find an answer, the next one first.
            person: Whether a person can be asked.
        """
        if budget.questions <= 0:
            return None
        weighted = table.weights[:, None] * table.costs
        total = weighted.sum(axis=0)
        now = float(total.min())
        # Q-MDP takes a mistake to be noticed at once; it is noticed so many answers later.
        late = self._evidence.answers_to_be_sure()
        asking, looking = self._costs.question / late, self._costs.look / late
        found: Inquiry | None = None
        doubted: list[tuple[float, float, Question, Floats, Reliability]] = []
        for question in questions:
            truth = self._truth(question, table)
            true = float(truth @ table.weights)
            if not DOUBT < true < 1 - DOUBT:
                continue
            if_true = truth @ weighted
            if_false = total - if_true
            most = now - float(if_true.min()) - float(if_false.min())
            unable = self._evidence.silent(question.text, PERSONS_VIEW)
            if person and self._costs.person is not None and not unable:
                told = gains(if_true, if_false, Reliability(PERSON, 1 - PERSON), (1,))
                saving = float(told[0]) - self._costs.person
                found = _better(found, Inquiry(question, 1, saving, person=True))
            open_views = views(question)
            if not open_views:
                continue
            reliability = self._evidence.expect(question, open_views[0])
            doubted.append((-round(most, 6), abs(true - 0.5), question, truth, reliability))
            if most <= asking:
                continue  # even the truth would not be worth a question
            seen = picture is not None and not self._evidence.asked_of(question.text, picture)
            saved = gains(if_true, if_false, reliability, TIMES).tolist()
            for times, gain in zip(TIMES, saved, strict=True):
                looks = times - 1 if seen else times
                if times > budget.questions or looks > budget.looks:
                    break
                saving = gain - times * asking - looks * looking
                found = _better(found, Inquiry(question, max(1, times // 4), saving))
        if len(doubted) > 1 and now > asking:
            doubted.sort(key=lambda each: each[:2])
            found = self._together(doubted[:TOGETHER], weighted, budget, asking, looking, found)
        return found

    def _together(
        self,
        doubted: Sequence[tuple[float, float, Question, Floats, Reliability]],
        weighted: Floats,
        budget: Budget,
        asking: float,
        looking: float,
        found: Inquiry | None,
    ) -> Inquiry | None:
        """The first of several questions, where their answers together are worth more."""
        truths = np.array([each[3] for each in doubted])
        reliabilities = [each[4] for each in doubted]
        saved = joint_gains(weighted, truths, reliabilities, TIMES).tolist()
        for times, gain in zip(TIMES, saved, strict=True):
            if times * len(doubted) > budget.questions or times > budget.looks:
                break
            saving = gain - times * (len(doubted) * asking + looking)
            found = _better(found, Inquiry(doubted[0][2], 1, saving))
        return found

    def _truth(self, question: Question, table: Table) -> Floats:
        """In which joint states yes is right: ones and zeros."""
        assert question.atom is not None
        known = self._truths.setdefault(question.text, {})
        atoms = (question.atom, *question.alike)
        for number in table.numbers:
            if number not in known:
                known[number] = float(not self._model.state(number).isdisjoint(atoms))
        return np.array([known[number] for number in table.numbers])


def _better(found: Inquiry | None, other: Inquiry) -> Inquiry | None:
    if other.saving <= 1e-9 or (found is not None and found.saving >= other.saving):
        return found
    return other
