"""Going to where a goal can be seen: a goal out of sight is only believed."""

from collections import Counter
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.choices import Chooser
from tpvqa.belief.deciding.inquiry import DOUBT, Budget, Inquiry
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.learning.learned import Learned
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.belief.weighing.vantage import Vantage
from tpvqa.monitors.inspection import Inspection
from tpvqa.monitors.protocol import Step
from tpvqa.monitors.requests import PlanFrom, Request
from tpvqa.monitors.scrutiny import least_known
from tpvqa.monitors.ways import Ways
from tpvqa.pddl import Atom, Conjunction, Literal, State, Task
from tpvqa.pddl.conditions import literals
from tpvqa.planning import Plan
from tpvqa.questions import FactQuestion, FactWords, QuestionBook

OFTEN = 3
"""How often one and the same place is gone to, at most."""
ENOUGH = 20
"""Questions after which what has been come for is not asked about any more."""
Views = Callable[[FactQuestion], Sequence[str | None]]


@dataclass(frozen=True, slots=True)
class Errand:
    """An information-gathering subgoal: something that is brought about for the sake of a look.

    Attributes:
        ways: The ways there.
        why: What is to be looked at, in words.
        facts: What is looked at.
        needed: From where it is shown.
    """

    ways: Ways
    why: str
    facts: frozenset[Atom]
    needed: frozenset[Atom]

    def look(
        self, now: Inspection, belief: Belief, book: QuestionBook, budget: Budget, views: Views
    ) -> Inquiry | None:
        """What to ask where it is shown: that is what the robot has come for.

        That it will not be seen from the next place on, Q-MDP does not know.
        """
        there = belief.where(lambda state: self.needed <= state) >= 0.5
        if not there or now.questions >= ENOUGH:
            return None
        return least_known(self.facts, now, belief, book, budget, views, at_first=DOUBT)


class Errands:
    """Decides whether to go to where facts of the goal are shown, before the trial ends.

    It is worth it where what a wrong *done* is expected to cost, less what it would cost to mend
    it, as far as answers will tell, is more than the way there and back and the answers there. On
    the way something may come undone, and the less answers tell, the more of that stays.

    Args:
        task: The task.
        vantage: Knows from where facts are shown.
        costs: What things cost.
    """

    def __init__(self, task: Task, vantage: Vantage, costs: Costs):
        self._task, self._vantage, self._costs = task, vantage, costs
        self._gone: Counter[frozenset[Atom]] = Counter()
        self._left: dict[frozenset[Atom], float] = {}

    def seek(
        self,
        step: Step,
        belief: Belief,
        evidence: Evidence,
        chooser: Chooser,
        sight: Sight,
        chances: Learned,
    ) -> Generator[Request, Any, Errand | None]:
        """An errand that is worth its way; None where there is none.

        Args:
            step: Where the trial stands.
            belief: What is believed.
            evidence: What answers are worth.
            chooser: Knows what is left to do where the goal does not hold.
            sight: What can be seen at all.
            chances: Of failures.
        """
        state, book = belief.most_probable()[0], step.book
        if not self._vantage.limited or step.replans_left == 0:
            return None
        full = self._task.extend(state)
        savings = self._savings(belief, chooser, book)
        self._left |= {here: saving for here, saving in savings.items() if here <= full}
        asking = evidence.answers_to_be_sure() * (self._costs.question + self._costs.look)
        told = evidence.settling().share
        unseen = (1 - told) * chances.rates.undone * chooser.ahead.failure
        going = self._costs.action + unseen
        for needed, saving in sorted(savings.items(), key=lambda each: (-each[1], sorted(each[0]))):
            worth = told * saving - asking
            if worth <= going or self._gone[needed] >= OFTEN:
                continue
            if needed <= full or saving <= self._left.get(needed, 0.0):  # it would say the same
                continue
            there = yield PlanFrom(state, towards=needed)
            if not isinstance(there, Plan):
                continue
            back = yield from self._back(state, there)
            if back is None:
                continue
            steps = len(there.actions) + back
            too_many = step.actions_left is not None and steps > step.actions_left
            if too_many or worth <= steps * going:
                continue
            self._gone[needed] += 1
            task = replace(self._task, goal=Conjunction(tuple(map(Literal, sorted(needed)))))
            # At its end nothing is reported.
            costs = self._costs.model_copy(update={"misreport": 0.0})
            towards = Chooser(belief.model, costs, sight, task)
            towards.ahead.learned(chances.skill, chances.rates)
            ways = Ways(task, towards, chances, self._costs, towards=needed)
            ways.take(there, state)
            there_shown = self._vantage.needed
            seen = [g for g in self._doubted(belief, book) if there_shown(g.atom) == needed]
            why = " and ".join(self._said(goal, belief, book) for goal in seen)
            facts = frozenset(goal.atom for goal in seen)
            return Errand(ways, f"{why} cannot be seen from here", facts, needed)
        return None

    def _savings(
        self, belief: Belief, chooser: Chooser, book: QuestionBook
    ) -> Mapping[frozenset[Atom], float]:
        """What it would save to see each place from which some doubted goal is shown."""
        lost = chooser.ahead.failure
        doubted: dict[frozenset[Atom], list[Literal]] = {}
        for goal in self._doubted(belief, book):
            needed = self._vantage.needed(goal.atom)
            if needed:
                doubted.setdefault(needed, []).append(goal)
        found = {}
        for needed, goals in doubted.items():
            found[needed] = sum(
                weight * max(0.0, lost - chooser.ahead.to_go(number))
                for number, weight in belief.weights.items()
                if not self._hold(goals, belief.model.state(number))
            )
        return found

    def _hold(self, goals: Sequence[Literal], state: State) -> bool:
        """Whether some goals hold in a state, derived ones too."""
        full = self._task.extend(state)
        return all(goal.holds(full) for goal in goals)

    def _doubted(self, belief: Belief, book: QuestionBook) -> list[Literal]:
        """Parts of the goal that are not sure, and that can be asked about."""
        return [
            goal
            for goal in dict.fromkeys(literals(self._task.goal))
            if DOUBT < belief.probability(goal.atom) < 1 - DOUBT and book.asked(Literal(goal.atom))
        ]

    def _said(self, goal: Literal, belief: Belief, book: QuestionBook) -> str:
        """A part of the goal with its probability."""
        holds = belief.probability(goal.atom)
        words = FactWords(book).of(goal.atom)
        return f"{words} {holds:.2f}" if goal.positive else f"not {words} {1 - holds:.2f}"

    def _back(self, state: State, there: Plan) -> Generator[Request, Any, int | None]:
        """Actions from where a plan leads to the goal; None where there is no way."""
        for action in there.actions:
            state = self._task.apply(state, action)
        if self._task.goal_holds(state):
            return 0
        back = yield PlanFrom(state)
        return len(back.actions) if isinstance(back, Plan) else None
