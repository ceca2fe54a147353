"""What makes an action worth being a choice: that it would change something, and that it can."""

from collections.abc import Mapping

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.deciding.by_kind import Kinds
from tpvqa.belief.deciding.far_off import FarOff, Ranked
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.deciding.table import Choice
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.filtering.sight import Sight
from tpvqa.pddl import Action

IDLE = 0.97
"""An action that changes nothing with this probability is no choice."""
HIDDEN_IDLE = 0.99
"""The same where nothing shows what it does: what it costs tells how often it is worth doing."""
AGAIN_IDLE = 0.1
"""The same of an action that was just done, and of which nothing was expected any more."""
STILL = 0.02
"""Nothing is expected of what moves less of the belief."""
COME_FOR = 0.5
"""Who sets out a second time for what it left undone on arrival does it as long as so much of what
it was worth is left."""
FLOOR = 0.1
"""An action is no choice whose preconditions hold with less than this, where it is not done."""
BARELY = 0.02
"""The same of what is followed unseen: that a thing is at one of many places was reckoned with."""


class Doing:
    """Says what choices have to do.

    Args:
        model: Says which actions are one skill.
        ahead: How often skills fail.
        far: What actions do in joint states.
        sight: What can be seen.
    """

    def __init__(self, model: FaultModel, ahead: Outlook, far: FarOff, sight: Sight):
        self._model, self._ahead, self._far, self._sight = model, ahead, far, sight
        self._last: Action | None = None
        self._before: Mapping[int, float] = {}
        self._in_vain = False
        self._come_for: dict[Action, float] = {}
        self._left = set[Action]()

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers, before the next action."""
        self._model = model

    def acted(self, action: Action, ranked: Ranked) -> None:
        """Note that an action is executed, where joint states have some probabilities."""
        self._last, self._before, self._in_vain = action, dict(ranked), False
        self._left = (self._left | self._come_for.keys()) - {action}
        self._come_for = self._purposes(action, ranked)

    def predicted(self, after: Mapping[int, float]) -> None:
        """Note where that is expected to have led, before anything was seen of it."""
        self._in_vain = bool(self._before) and moved(list(after.items()), self._before) < STILL

    def of(self, choice: Choice, ranked: Ranked, kinds: Kinds, *, floor: float = FLOOR) -> Floats:
        """What a choice has to do in the joint states: what it would change, and what it can, each
        less how probable that has to be; shape (2, states).

        Q-MDP, which takes everything to be known after the next action, would wait for ever.
        """
        found = np.ones((2, len(ranked)))
        if choice.action is not None:
            # Who does in vain what nothing shows never learns that it is in vain.
            hidden = self._sight.hidden(choice.action)
            works = 1 - self._ahead.skill(choice.action).failure if hidden else 1.0
            idle = HIDDEN_IDLE if hidden else IDLE
            if self._last and self._model.same_skill(choice.action, self._last, choice.state):
                idle = AGAIN_IDLE if self._in_vain else idle
            least = 1 - idle
            if choice.action in self._left:
                least = min(least, COME_FOR * self._come_for.get(choice.action, 1.0))
            undone, possible = self._far.does(choice.action, ranked, kinds).T[:2]
            found[0] = works * undone * possible - least
            found[1] = undone * (possible - floor)
        return found

    def _purposes(self, action: Action, ranked: Ranked) -> dict[Action, float]:
        """What an action is done for where only improbable joint states want it: what they want
        next, with their probability."""
        found = dict[Action, float]()
        if self._ahead.next(ranked[0][0]) == action:
            return found
        for number, weight in ranked:
            if self._ahead.next(number) != action:
                continue
            intended = self._model.outcomes(action)[number].intended
            then = None if intended is None else self._ahead.next(intended)
            if then is not None:
                found[then] = found.get(then, 0.0) + weight
        return found


def moved(ranked: Ranked, before: Mapping[int, float]) -> float:
    """How much of a belief has moved since it was another one.

    Args:
        ranked: The joint states with their probabilities.
        before: Their probabilities then.
    """
    return sum(max(0.0, weight - before.get(number, 0.0)) for number, weight in ranked)
