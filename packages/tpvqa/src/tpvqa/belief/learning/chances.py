"""How often actions fail, learned from what came of them."""

from collections.abc import Iterable, Mapping, Sequence

from tpvqa.belief.answers.bounds import MOST
from tpvqa.belief.calibrating.beta import Beta
from tpvqa.belief.calibrating.counted import CountedFaults
from tpvqa.belief.filtering.faults import Rates
from tpvqa.belief.learning.skills import ALIKE, Skills, SkillState
from tpvqa.belief.learning.spread import SURE, alike
from tpvqa.pddl import Action

LEAST = 0.5
"""Cases of either kind that the common rate is known from at least."""
RARELY = 1e-3
"""What works loose is taken to do so at least so often, unless that is believed never to happen."""
FIRST = 3.0
"""Tries of one action that tell fully of the others."""


MOSTLY = 0.5
"""A skill that has failed oftener is taken to do so as surely as it was counted: if it might be
much harder still, it would not be worth trying at all."""


class Chances:
    """The rates of faults, learned while running from expected numbers of cases.

    Args:
        rates: What is believed beforehand.
        strength: How many cases that is worth.
        counted: What was counted in other trials.
    """

    def __init__(
        self,
        rates: Rates | None = None,
        strength: float = 12.0,
        counted: CountedFaults | None = None,
    ):
        rates, counted = rates or Rates(), counted or CountedFaults()
        self.failure = Beta(rates.failure * strength, (1 - rates.failure) * strength)
        self.disturbance = Beta(rates.disturbance * strength, (1 - rates.disturbance) * strength)
        self.spontaneous = Beta(rates.spontaneous * strength, (1 - rates.spontaneous) * strength)
        self.redone = Beta(rates.redone * strength, (1 - rates.redone) * strength)
        self.skills = Skills()
        tries = [count.at_most(strength) for count in counted.skills.values()]
        _expect(self.failure, (sum(failed for failed, _ in tries), sum(w for _, w in tries)))
        _expect(self.disturbance, counted.disturbance)
        _expect(self.spontaneous, counted.spontaneous)
        _expect(self.redone, counted.redone)
        self._counted = counted.skills
        self._learned: dict[str, tuple[float, float]] = {}
        self._sure = rates.failure in (0.0, 1.0)

    @property
    def rates(self) -> Rates:
        """The expected rates."""
        return self._rates(self.failure.mean)

    def skill(self, action: Action) -> SkillState:
        """What is known of how often an action fails."""
        if self._sure:  # a rate that is believed for certain is that of every skill
            return SkillState(self.failure.mean, 0.0, 1 / max(1 - self.failure.mean, 0.05))
        # Its own tries count by themselves, not by what the common rate has learned of them, too.
        yes, no = self._learned.get(action.name, (0.0, 0.0))
        yes, no = max(self.failure.yes - yes, LEAST), max(self.failure.no - no, LEAST)
        return self.skills.of(action, *self._beforehand(action.name, yes / (yes + no), yes + no))

    def _beforehand(self, skill: str, mean: float, strength: float) -> tuple[float, float, float]:
        """The rate of a skill before its tries in this trial, how many cases that is known from,
        and of how many tries of an action it tells."""
        count = self._counted.get(skill)
        if count is None:
            return mean, strength, ALIKE
        mean, told = (count.failed + ALIKE * mean) / (count.tries + ALIKE), alike(count)
        mostly = count.failed > MOSTLY * count.tries
        most = MOST if mostly else strength if told is None else SURE
        return mean, min(strength + count.tries, max(most, strength)), told or ALIKE

    def rates_of(self, action: Action) -> Rates:
        """The expected rates where an action is executed."""
        return self.skill(action).rates(self.rates)

    def _rates(self, failure: float) -> Rates:
        spontaneous, redone = (
            max(each.mean, RARELY) if each.yes > 0 else 0.0
            for each in (self.spontaneous, self.redone)
        )
        return Rates(failure, self.disturbance.mean, spontaneous, redone)

    def tried(self) -> Iterable[Action]:
        """The actions that were tried."""
        return self.skills.all()

    def learn(
        self,
        shares: Mapping[str, float],
        action: Action | None = None,
        earlier: Sequence[Mapping[str, float]] = (),
    ) -> None:
        """Learn from how an action came out, see `Belief.outcome_shares`.

        Args:
            shares: How it came out.
            action: What was done; None where only the common rates are to learn.
            earlier: How the actions before it came out, see `Belief.earlier_shares`.
        """
        telling = alive = 1.0
        if action is not None and not self._sure:
            # One action tried again and again tells ever less of others, one that is dead nothing.
            tried = self.skills.tried(action)
            telling = 1.0 if tried is None else FIRST / (FIRST + tried.times)
            self.skills.learn(action, shares, self.skill(action).failure, earlier)
            alive = 1 - self.skill(action).dead
        failed, worked = shares.get("failure", 0.0), shares.get("success", 0.0)
        yes, no = self.failure.yes, self.failure.no
        self.failure.learn(telling * alive * failed, telling * worked)
        if action is not None:
            before = self._learned.get(action.name, (0.0, 0.0))
            gained = self.failure.yes - yes, self.failure.no - no
            self._learned[action.name] = before[0] + gained[0], before[1] + gained[1]
        disturbed, undisturbed = shares.get("disturbed", 0.0), shares.get("undisturbed", 0.0)
        self.disturbance.learn(disturbed, alive * undisturbed)
        self.spontaneous.learn(shares.get("fell", 0.0), shares.get("stayed", 0.0))
        self.redone.learn(shares.get("slipped", 0.0), shares.get("kept", 0.0))


def _expect(beta: Beta, cases: tuple[float, float]) -> None:
    """Expect what was counted, no surer than before: a robot is not for ever what it was, and who
    was sure of it would look less closely. No rate that is believed for certain is changed.
    """
    known, counted = beta.yes + beta.no, sum(cases)
    if counted and beta.yes > 0 and beta.no > 0:
        fewer = known / (known + counted)
        beta.yes, beta.no = fewer * (beta.yes + cases[0]), fewer * (beta.no + cases[1])
