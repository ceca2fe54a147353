"""What to ask next, if anything: the questions whose answers save more than they cost."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from operator import mul

from tpvqa.belief.answers.information import (
    TIMES,
    Floats,
    Reliability,
    answers_to_know,
    gains,
    joint_gains,
    known_gain,
    opened,
    settled,
)
from tpvqa.belief.answers.last_answer import Picture
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.one_thread import one_thread
from tpvqa.belief.deciding.table import Table
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.weighing.evidence import PERSON, PERSONS_VIEW, Evidence
from tpvqa.questions.question import FactQuestion

DOUBT = 1e-3
"""Facts that are surer than this are not asked about, where as much as usual is at stake."""
TOGETHER = 4
"""Questions that are thought to be asked together, at most."""
SAYING = 0.02
"""A question whose further answers settle less of a doubt is exhausted in this scene."""
AT_ONCE = 8
"""Questions of which it is worked out at once what is expected of their answers."""
EQUAL = 1e-9
"""Savings that differ by less are equal: the last bits of a sum are the processor's."""


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
        weighted = table.weights[:, None] * table.costs
        work = table.weights[:, None] * table.work
        now = float(table.expected.min())
        # Q-MDP takes a mistake to be noticed at once; it is noticed so many answers later.
        late = self._evidence.late
        asking, looking = dearer * self._costs.question / late, dearer * self._costs.look / late
        doubt_from = DOUBT / stake
        truths = self._model.truths([each.atoms for each in questions], table.numbers)
        likely = (truths @ table.weights).tolist()
        if_true, work_if_true = truths @ weighted, truths @ work
        if_false = weighted.sum(axis=0) - if_true
        work_if_false = work.sum(axis=1)[:, None] - work_if_true
        known = opened(if_true, work_if_true).min(axis=1)
        known += opened(if_false, work_if_false).min(axis=1)
        most = (now - known).tolist()
        found: Inquiry | None = None
        doubted: list[_Doubted] = []
        worth: list[_Doubted] = []
        for place, question in enumerate(questions):
            if not doubt_from < likely[place] < 1 - doubt_from:
                continue
            unable = self._evidence.silent(question.text, PERSONS_VIEW)
            if person and self._costs.person is not None and not (unable or question.wording):
                one = slice(place, place + 1)
                told = gains(
                    if_true[one],
                    if_false[one],
                    work_if_true[:, one],
                    work_if_false[:, one],
                    _PERSONS,
                    (1,),
                )
                saving = float(told[0, 0]) - self._costs.person
                found = _better(found, Inquiry(question, 1, saving, person=True))
            open_views = views(question) if budget.questions > 0 else ()
            if not open_views:
                continue
            doubt = _Doubted(
                (-round(most[place], 6), round(abs(likely[place] - 0.5), 6)),
                place,
                question,
                likely[place],
                open_views[0],
                self._evidence,
            )
            doubted.append(doubt)
            if most[place] > asking:  # else even the truth would not be worth a question
                worth.append(doubt)
        if worth:
            found = self._alone(
                worth,
                (if_true, if_false, work_if_true, work_if_false),
                (now - if_true.min(axis=1) - if_false.min(axis=1)).tolist(),
                budget,
                picture,
                (asking, looking),
                found,
            )
        doubted = _once(doubted)
        if now > asking:
            doubted.sort(key=lambda each: each.urgent)
        first = list(islice(self._saying(doubted), TOGETHER))
        if len(first) > 1 and now > asking:
            own_truths = truths[[each.place for each in first]]
            found = self._together(
                first, own_truths, weighted, work, budget, asking, looking, found
            )
        ending, action = table.best.action is None, self._costs.action
        asks = person and self._costs.person is not None
        if len(doubted) > 1 and (ending or table.mistaken(action / 2) > 0.5):
            _expect(doubted)
            doubted.sort(key=lambda each: not _says(each.reliability))
            if not asks:
                doubted = [each for each in doubted if _says(each.reliability)]
        else:
            doubted = []
        if len(doubted) > 1:
            own_truths = truths[[each.place for each in doubted]]
            found = self._all(
                doubted,
                own_truths,
                weighted,
                work,
                budget,
                asking + looking
                if not ending
                else dearer * (self._costs.question + self._costs.look),
                self._costs.failure if ending else action,
                self._costs.person if person else None,
                found,
            )
        return found

    def _alone(
        self,
        worth: "Sequence[_Doubted]",
        costs: tuple[Floats, Floats, Floats, Floats],
        most: Sequence[float],
        budget: Budget,
        picture: Picture | None,
        prices: tuple[float, float],
        found: Inquiry | None,
    ) -> Inquiry | None:
        """The question whose answers save most by themselves.

        What is expected of answers is worked out for those first that may save most, and for no
        others than may still save more than what was found.

        Args:
            worth: The questions.
            costs: Of every question the first four arguments of `gains`.
            most: Of every question, what its answers may save at most, whatever they are worth.
            budget: What may still be asked.
            picture: The latest one.
            prices: Of a question, and of a look.
            found: What is asked otherwise.
        """
        asking, looking = prices
        best = 0.0 if found is None else found.saving
        order = sorted(range(len(worth)), key=lambda place: -most[worth[place].place])
        saved: dict[int, list[float]] = {}
        for begins in range(0, len(order), AT_ONCE):
            left = [
                place
                for place in order[begins : begins + AT_ONCE]
                if most[worth[place].place] - asking > best - 4 * EQUAL
            ]
            if not left:
                break
            asked = [worth[place] for place in left]
            for place, gained in zip(left, _gains(asked, costs), strict=True):
                text = worth[place].question.text
                seen = picture is not None and not self._evidence.asked_of(text, picture)
                saved[place] = []
                for times, gain in zip(TIMES, gained, strict=True):
                    looks = times - 1 if seen else times
                    if times > budget.questions or looks > budget.looks:
                        break
                    saved[place].append(gain - times * asking - looks * looking)
                best = max(best, *saved[place]) if saved[place] else best
        most_saved, chosen = 0.0 if found is None else found.saving, None
        for place, each in enumerate(worth):
            if place not in saved:
                self._evidence.keep(each.question, each.view)
            for times, saving in zip(TIMES, saved.get(place, ()), strict=False):
                if saving > most_saved + EQUAL:
                    most_saved, chosen = saving, (each.question, times)
        return found if chosen is None else Inquiry(chosen[0], max(1, chosen[1] // 4), most_saved)

    def _saying(self, doubted: "Sequence[_Doubted]") -> "Iterator[_Doubted]":
        """Those whose answers say anything."""
        for begins in range(0, len(doubted), TOGETHER):
            several = doubted[begins : begins + TOGETHER]
            _expect(several)
            yield from (each for each in several if _says(each.reliability))

    def _all(
        self,
        doubted: "Sequence[_Doubted]",
        truths: Floats,
        weighted: Floats,
        work: Floats,
        budget: Budget,
        price: float,
        stake: float,
        person: float | None,
        found: Inquiry | None,
    ) -> Inquiry | None:
        """The first question, where it is worth asking about all that is in doubt until it is
        known.

        Where a goal has many facts, each is likely and all together are not: none alone is worth a
        question then, nor are a few.
        """
        doubt = min(max(self._costs.question / stake, EQUAL), 0.5)  # a question may cost nothing
        answers = sum(answers_to_know(each.likely, doubt, each.reliability) for each in doubted)
        settles = _settled(doubted)
        saving, first = settles * known_gain(weighted, work, truths), doubted[0].question
        if person is not None and not self._evidence.silent(first.text, PERSONS_VIEW):
            told = Inquiry(first, 1, saving / settles - len(doubted) * person, person=True)
            found = _better(found, told)
        if answers > min(budget.questions, len(doubted) * budget.looks):
            return found
        return _better(found, Inquiry(first, 1, saving - answers * price))

    def _together(
        self,
        doubted: "Sequence[_Doubted]",
        truths: Floats,
        weighted: Floats,
        work: Floats,
        budget: Budget,
        asking: float,
        looking: float,
        found: Inquiry | None,
    ) -> Inquiry | None:
        """The first of several questions, where their answers together are worth more."""
        reliabilities = [each.reliability for each in doubted]
        saved = joint_gains(weighted, work, truths, reliabilities, TIMES).tolist()
        for times, gain in zip(TIMES, saved, strict=True):
            if times * len(doubted) > budget.questions or times > budget.looks:
                break
            saving = gain - times * (len(doubted) * asking + looking)
            found = _better(found, Inquiry(doubted[0].question, 1, saving))
        return found


@dataclass
class _Doubted:
    """A question whose answer is not known.

    Attributes:
        urgent: Orders them: what matters most first, then what is least known.
        place: Among all questions.
        likely: The probability that yes is right.
        view: From where it is asked next.
        evidence: Says what is expected of answers.
        expected: That, once it was worked out.
    """

    urgent: tuple[float, float]
    place: int
    question: FactQuestion
    likely: float
    view: str | None
    evidence: Evidence
    expected: Reliability | None = None

    @property
    def reliability(self) -> Reliability:
        """What is expected of the answers."""
        if self.expected is None:
            self.expected = self.evidence.expect(self.question, self.view)
        return self.expected


def _expect(doubted: "Sequence[_Doubted]") -> None:
    """Work out what is expected of the answers to several questions."""
    left = [each for each in doubted if each.expected is None]
    if left:
        told = left[0].evidence.expect_all([(each.question, each.view) for each in left])
        for each, expected in zip(left, told, strict=True):
            each.expected = expected


def _gains(
    asked: "Sequence[_Doubted]", costs: tuple[Floats, Floats, Floats, Floats]
) -> list[list[float]]:
    """`gains` of some questions."""
    _expect(asked)
    places, (if_true, if_false, work_if_true, work_if_false) = [each.place for each in asked], costs
    told: list[list[float]] = gains(
        if_true[places],
        if_false[places],
        work_if_true[:, places],
        work_if_false[:, places],
        [each.reliability for each in asked],
        TIMES,
    ).tolist()
    return told


def _once(doubted: "Sequence[_Doubted]") -> "list[_Doubted]":
    """Every fact once: in the words whose answers will settle most."""
    found: dict[str, _Doubted] = {}
    for each in doubted:
        known = found.setdefault(each.question.family, each)
        if known is not each and settled(each.reliability) > settled(known.reliability) + EQUAL:
            found[each.question.family] = each
    return list(found.values())


def _settled(doubted: Sequence[_Doubted]) -> float:
    """How far answers in this scene settle what is in doubt."""
    weights = [each.likely * (1 - each.likely) for each in doubted]
    told = [settled(each.reliability) for each in doubted]
    return float(max(sum(map(mul, weights, told)) / sum(weights), EQUAL))


def _says(each: Reliability) -> bool:
    """Whether further answers say anything: what was asked often enough in this scene does not."""
    return abs(each.yes_if_true - each.yes_if_false) > SAYING or settled(each) > SAYING


_PERSONS = (Reliability(PERSON, 1 - PERSON),)


def _better(found: Inquiry | None, other: Inquiry) -> Inquiry | None:
    if other.saving <= (0.0 if found is None else found.saving) + EQUAL:
        return found
    return other
