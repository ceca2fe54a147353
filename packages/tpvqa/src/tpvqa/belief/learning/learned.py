"""What was learned of faults, by how far the VLM can be trusted.

How an action came out is known from answers. Where they are worth little, little was learned; so
when answers turn out to be, what they taught goes, too.
"""

from collections.abc import Iterable
from copy import deepcopy

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.kinds import KINDS
from tpvqa.belief.answers.trust import GRID
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import Rates
from tpvqa.belief.learning.chances import Chances
from tpvqa.belief.learning.skills import SkillState
from tpvqa.belief.states.rebinding import as_skill
from tpvqa.pddl import Action

BOUNDS = (0.2, 0.7)
"""Factors of trust between which it is told apart what was learned."""
LEAST = 0.01
"""What is less probable does not count."""


class Learned:
    """The rates of faults, learned for every range of trust by itself.

    Args:
        chances: What is known beforehand.
        belief: Says how actions came out, and how far answers can be trusted.
        trusts: Whether that is learned.
    """

    def __init__(self, chances: Chances, belief: Belief, *, trusts: bool):
        self._belief = belief
        ranges = np.digitize(GRID, BOUNDS) if trusts else np.zeros(1)
        self._parts: list[NDArray[np.bool_]] = [
            np.repeat(ranges == each, len(KINDS)) for each in range(len(BOUNDS) + 1)
        ]
        self._parts = [part for part in self._parts if part.any()]
        self._chances = [deepcopy(chances) for _ in self._parts]
        self._skills: dict[Action, Action] = {}
        self._known: tuple[Floats | None, list[tuple[float, Chances]]] = None, []

    def _weighed(self) -> list[tuple[float, Chances]]:
        """How probable each range is, the most probable first."""
        noise = self._belief.noise
        if self._known[0] is not noise:
            self._known = noise, self._ranges(noise)
        return self._known[1]

    def _ranges(self, noise: Floats) -> list[tuple[float, Chances]]:
        weights = (
            [float(noise[part].sum()) for part in self._parts] if len(self._parts) > 1 else [1.0]
        )
        found = [each for each in zip(weights, self._chances, strict=True) if each[0] >= LEAST]
        total = sum(weight for weight, _ in found)
        found = [(weight / total, chances) for weight, chances in found]
        return sorted(found, key=lambda each: -each[0])

    @property
    def likeliest(self) -> Chances:
        """What was learned, by as far as answers are most probably to be trusted."""
        return self._weighed()[0][1]

    @property
    def rates(self) -> Rates:
        """The expected rates."""
        told = [(weight, chances.rates) for weight, chances in self._weighed()]
        return Rates(
            sum(weight * each.failure for weight, each in told),
            sum(weight * each.disturbance for weight, each in told),
            sum(weight * each.spontaneous for weight, each in told),
            sum(weight * each.redone for weight, each in told),
        )

    def skill(self, action: Action) -> SkillState:
        """What is known of how often an action fails."""
        action = self._as_skill(action)
        told = [(weight, chances.skill(action)) for weight, chances in self._weighed()]
        if len(told) == 1:
            return told[0][1]
        return SkillState(
            *(
                sum(weight * getattr(each, name) for weight, each in told)
                for name in SkillState.__dataclass_fields__
            )
        )

    def rates_of(self, action: Action) -> Rates:
        """The expected rates where an action is executed."""
        return self.skill(action).rates(self.rates)

    def tried(self) -> Iterable[Action]:
        """The actions that were tried, without the arguments that their skills do not take."""
        return self.likeliest.tried()

    def times(self, action: Action) -> tuple[float, float]:
        """See `Skills.times`."""
        return self.likeliest.skills.times(self._as_skill(action))

    def tries(self, action: Action) -> int:
        """See `Skills.tries`."""
        return self.likeliest.skills.tries(self._as_skill(action))

    @property
    def learned(self) -> tuple[int, int]:
        """Another one whenever something was learned, or what was learned counts otherwise."""
        likeliest = self.likeliest
        return likeliest.skills.learned, self._chances.index(likeliest)

    def learn(self, action: Action) -> None:
        """Learn from how an action came out, after all that was seen since."""
        action = self._as_skill(action)
        for part, chances in zip(self._parts, self._chances, strict=True):
            weights = self._belief.weights
            if len(self._parts) > 1:
                weights = self._belief.where_noise(part)
            shares = self._belief.outcome_shares(weights)
            chances.learn(shares, action, self._belief.earlier_shares(weights))

    def carried(self, last: Action | None) -> Chances:
        """What the next trial may begin with.

        Args:
            last: The last action, where it was not learned yet how it came out.
        """
        chances = deepcopy(self.likeliest)
        if last is not None:
            shares, last = self._belief.outcome_shares(), self._as_skill(last)
            chances.learn(shares, last, self._belief.earlier_shares())
        return chances

    def _as_skill(self, action: Action) -> Action:
        found = self._skills.get(action)
        if found is None:
            found = self._skills[action] = as_skill(action, self._belief.model.rebind)
        return found
