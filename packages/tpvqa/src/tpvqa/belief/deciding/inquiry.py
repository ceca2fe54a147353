"""What to ask next, if anything: the questions whose answers save more than they cost."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import islice

from tpvqa.belief.answers.information import TIMES, Reliability, answers_to_know
from tpvqa.belief.answers.last_answer import Picture
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.doubted import (
    EQUAL,
    TOGETHER,
    Doubted,
    expect,
    once,
    saying,
    says,
    settled_by,
)
from tpvqa.belief.deciding.one_thread import one_thread
from tpvqa.belief.deciding.stakes import Stakes
from tpvqa.belief.deciding.table import Table
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.weighing.evidence import PERSON, PERSONS_VIEW, Evidence
from tpvqa.questions.question import FactQuestion

DOUBT = 1e-3
"""Facts that are surer than this are not asked about, where as much as usual is at stake."""
AT_ONCE = 8
"""Questions of which it is worked out at once what is expected of their answers."""
_PERSONS = (Reliability(PERSON, 1 - PERSON),)


@dataclass(frozen=True, slots=True)
class Inquiry:
    """What to ask.

    Attributes:
        question: The question.
        times: How often to ask it, each time at a new look, before thinking again.
        saving: How much less the best decision is then expected to cost, less what asking costs.
        person: Whether to ask a person.
    """

    question: FactQuestion
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

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model

    @one_thread
    def best(
        self,
        questions: Sequence[FactQuestion],
        table: Table,
        budget: Budget,
        *,
        picture: Picture | None,
        views: Callable[[FactQuestion], Sequence[str | None]],
        person: bool = False,
        dearer: float = 1.0,
        stake: float = 1.0,
    ) -> Inquiry | None:
        """What to ask next; None where no answer is worth its price.

        Args:
            questions: About facts that matter.
            table: What can be done, and what it costs.
            budget: What may still be asked.
            picture: The latest one since the last action; None where there was none.
            views: From where a question may find an answer, the next one first.
            person: Whether a person can be asked.
            dearer: How many times its price a question of the VLM has to be worth.
            stake: How many times as much as usual a failed task costs; so much surer is a fact that
                is not asked about, as a goal of thirty sure facts is in doubt.
        """
        if budget.questions <= 0 and not person:
            return None
        truths = self._model.truths([each.atoms for each in questions], table.numbers)
        stakes = Stakes(table, truths)
        search = _Search(self._evidence, self._costs, stakes, budget, dearer, person=person)
        most = stakes.of_truth()
        doubted: list[Doubted] = []
        for place, question in enumerate(questions):
            likely = stakes.likely[place]
            if not DOUBT / stake < likely < 1 - DOUBT / stake:
                continue
            search.of_person(question, place)
            open_views = views(question) if budget.questions > 0 else ()
            if open_views:
                urgent = (-round(most[place], 6), round(abs(likely - 0.5), 6))
                doubted.append(
                    Doubted(urgent, place, question, likely, open_views[0], self._evidence)
                )
        worth = [each for each in doubted if most[each.place] > search.asking]
        search.alone(worth, picture)  # of others not even the truth would be worth a question
        doubted = once(doubted)
        if stakes.now > search.asking:
            doubted.sort(key=lambda each: each.urgent)
            search.together(list(islice(saying(doubted), TOGETHER)))
        ending = table.best.action is None
        if len(doubted) > 1 and (ending or table.mistaken(self._costs.action / 2) > 0.5):
            search.all(doubted, ending=ending)
        return search.found


class _Search:
    """What saves most so far, of all that can be asked now.

    Args:
        evidence: Says what an answer is worth.
        costs: What asking costs.
        stakes: What answers can save.
        budget: What may still be asked.
        dearer: How many times its price a question of the VLM has to be worth.
        person: Whether a person can be asked.

    Attributes:
        found: That; None where nothing saves anything.
        asking: What a question is reckoned to cost.
    """

    def __init__(
        self,
        evidence: Evidence,
        costs: Costs,
        stakes: Stakes,
        budget: Budget,
        dearer: float,
        *,
        person: bool,
    ):
        self._evidence, self._costs, self._stakes, self._budget = evidence, costs, stakes, budget
        # Q-MDP takes a mistake to be noticed at once; it is noticed so many answers later.
        late = evidence.late
        self.asking, self._looking = dearer * costs.question / late, dearer * costs.look / late
        self._dearer = dearer
        self._persons_price = costs.person if person else None
        self.found: Inquiry | None = None

    def of_person(self, question: FactQuestion, place: int) -> None:
        """A person's word on one fact, in its first wording."""
        price = self._persons_price
        unable = self._evidence.silent(question.text, PERSONS_VIEW)
        if price is not None and not (unable or question.wording):
            ((saving,),) = self._stakes.alone([place], _PERSONS, (1,))
            self._take(Inquiry(question, 1, saving - price, person=True))

    def alone(self, worth: Sequence[Doubted], picture: Picture | None) -> None:
        """The question whose answers save most by themselves.

        What is expected of answers is worked out for those first that may save most, and for no
        others than may still save more than what was found.

        Args:
            worth: The questions.
            picture: The latest one.
        """
        if not worth:
            return
        most, budget = self._stakes.bounds(), self._budget
        best = self._least
        order = sorted(range(len(worth)), key=lambda place: -most[worth[place].place])
        saved: dict[int, list[float]] = {}
        for begins in range(0, len(order), AT_ONCE):
            left = [
                place
                for place in order[begins : begins + AT_ONCE]
                if most[worth[place].place] - self.asking > best - 4 * EQUAL
            ]
            if not left:
                break
            asked = [worth[place] for place in left]
            expect(asked)
            gained_by_each = self._stakes.alone(
                [each.place for each in asked], [each.reliability for each in asked]
            )
            for place, gained in zip(left, gained_by_each, strict=True):
                text = worth[place].question.text
                seen = picture is not None and not self._evidence.asked_of(text, picture)
                saved[place] = []
                for times, gain in zip(TIMES, gained, strict=True):
                    looks = times - 1 if seen else times
                    if times > budget.questions or looks > budget.looks:
                        break
                    saved[place].append(gain - times * self.asking - looks * self._looking)
                best = max(best, *saved[place]) if saved[place] else best
        for place, each in enumerate(worth):
            if place not in saved:
                self._evidence.keep(each.question, each.view)
            for times, saving in zip(TIMES, saved.get(place, ()), strict=False):
                self._take(Inquiry(each.question, max(1, times // 4), saving))

    def together(self, doubted: Sequence[Doubted]) -> None:
        """The first of several questions, where their answers together are worth more."""
        if len(doubted) < 2:
            return
        places = [each.place for each in doubted]
        saved = self._stakes.together(places, [each.reliability for each in doubted])
        for times, gain in zip(TIMES, saved, strict=True):
            if times * len(doubted) > self._budget.questions or times > self._budget.looks:
                break
            saving = gain - times * (len(doubted) * self.asking + self._looking)
            self._take(Inquiry(doubted[0].question, 1, saving))

    def all(self, doubted: Sequence[Doubted], *, ending: bool) -> None:
        """The first question, where it is worth asking about all that is in doubt until it is
        known.

        Where a goal has many facts, each is likely and all together are not: none alone is worth a
        question then, nor are a few.

        Args:
            doubted: The questions.
            ending: Whether the trial would end here.
        """
        expect(doubted)
        doubted = sorted(doubted, key=lambda each: not says(each.reliability))
        if self._persons_price is None:
            doubted = [each for each in doubted if says(each.reliability)]
        if len(doubted) < 2:
            return
        costs, budget, first = self._costs, self._budget, doubted[0].question
        price, stake = self.asking + self._looking, costs.action
        if ending:
            price, stake = self._dearer * (costs.question + costs.look), costs.failure
        doubt = min(max(costs.question / stake, EQUAL), 0.5)  # a question may cost nothing
        answers = sum(answers_to_know(each.likely, doubt, each.reliability) for each in doubted)
        settles = settled_by(doubted)
        saving = settles * self._stakes.known([each.place for each in doubted])
        person = self._persons_price
        if person is not None and not self._evidence.silent(first.text, PERSONS_VIEW):
            self._take(Inquiry(first, 1, saving / settles - len(doubted) * person, person=True))
        if answers <= min(budget.questions, len(doubted) * budget.looks):
            self._take(Inquiry(first, 1, saving - answers * price))

    @property
    def _least(self) -> float:
        return 0.0 if self.found is None else self.found.saving

    def _take(self, other: Inquiry) -> None:
        if other.saving > self._least + EQUAL:
            self.found = other
